/* raydiff bisect: which pass of a compiler of shaders, and which instruction that it changed, makes
 * answers other than those under another compiler. */
#include "cmd/bisect/cmd_bisect.h"

#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/primitives/primitives.h"

#include <stdio.h>
#include <string.h>

static const char *const symptoms[] = {"first", "wrong", "bits", "precise", NULL};

#define ROWS_OF struct bisect_options

static const struct option_row rows[] = {
    {"compiler", "C",
     "under which it shows: opt, size, passes:A+B (passes of spirv-opt; ./PROGRAM is one of your "
     "own), cross, hlsl, shaderc; see raydiff check",
     OF_TEXT(bad), .shown = "that of the subject"},
    {"good", "C", "under which it does not", OF_TEXT(good), .value = "raw"},
    {"symptom", "S",
     "wrong: answers that are WRONG under the one alone; bits: answers with other bits; precise: "
     "NoContraction that was asked for is lost, or rounding opened; first: the first of them that "
     "shows",
     OF_CHOICE(symptom, symptoms), .value = "first"},
    {"tries", "N", "most modules that are tried in each of the searches",
     OF_COUNT(tries, 1, 1000000), .value = "1000"},
    {"time", "S", "seconds that the engine may take for a module", OF_COUNT(seconds, 1, 86400),
     .value = "60"},
    {"rays", "SET", "ray set, as raydiff check takes it", OF_MEMBER(rays, TABLE_RAY_SETS),
     .value = "mixed"},
    {"count", "N", "its rays", OF_COUNT(count, 1, 1u << 22), .value = "1000"},
    SEED_ROW(seed),
    {"engine", "E", "engine whose shaders are compiled", OF_MEMBER(engine, TABLE_ENGINES),
     .value = "vulkan", .shown = "vulkan, or that of the subject"},
    {"layout", "L", "layout", OF_MEMBER(layout, TABLE_LAYOUTS), .value = "f32",
     .shown = "f32, or that of the subject"},
    {"store", "S", "triangle storage, see raydiff list storages", OF_MEMBER(store, TABLE_STORES),
     .value = "indexed"},
    {"builder", "B", "builder", OF_MEMBER(builder, TABLE_BUILDERS), .value = "median"},
    {"box", "B", "box test", OF_MEMBER(box, TABLE_BOX_TESTS), .value = "robust"},
    {"tri", "T", "triangle test", OF_MEMBER(tri, TABLE_TRI_TESTS), .value = "mt"},
    {"query", "Q", "closest or any", OF_ONE(query, TABLE_QUERIES), .value = "closest"},
    {"json", "FILE", "the result, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "bisect",
    .usage = "bisect SCENE --compiler C [OPTIONS]\n"
             "bisect TRIAL [--compiler C] [OPTIONS]     (a name of raydiff conform)\n"
             "bisect FILE.trial [--compiler C] [OPTIONS]     (a finding)",
    .about = "Where answers differ under two compilers of the shaders, finds the shortest list of "
             "passes that brings it, and of what the last of them changes the least part: the "
             "function and the instruction. Modules between are played in child processes.",
    .group = {GROUP(rows), GROUP_AT(leaf_rows, build), GROUP_AT(engine_rows, engines),
              GROUP_AT(screen_rows, screen)},
    .notes = "A translator (cross, hlsl, shaderc) cannot be taken apart: of it the decorations are "
             "found that cure the symptom when they are put back. docs/drivers.md has an example.",
    .codes = "0 nothing shows, 1 it shows and is bisected, 2 bad input, 3 the engine crashed, hung "
             "or could not finish, 77 the engine or a tool cannot run here",
    .example = "bisect sphere:n=8 --compiler opt:final",
};

/* A run: the subject's answers under the compiler that is good, and the search. */
struct bisecting {
    struct bisect_options options;
    struct bisect_subject subject;
    struct bisect_stage stage;
    struct bisect_answers good;
    struct compiled made[2]; /* good, bad */
    struct bisect_result result;
    struct progress progress;
    struct reason stopped; /* of play_one */
    enum status stopped_status;
};

/* --- symptoms --------------------------------------------------------------------------------- */

static bool same_bits(const struct bisecting *b, const struct bisect_answers *bad, size_t i)
{
    const struct bisect_answers *good = &b->good;
    return memcmp(&good->hit[i], &bad->hit[i], sizeof good->hit[i]) == 0 &&
           (!b->subject.is_world || good->tag[i] == bad->tag[i]);
}

/* Counts the rays whose answers show it. */
static struct bisect_shown count_shown(const struct bisecting *b, enum symptom symptom,
                                       const struct bisect_answers *bad)
{
    struct bisect_shown shown = {.symptom = symptom, .of = b->subject.ray_count};
    for (size_t i = 0; i < shown.of; i++) {
        const bool is = symptom == SYMPTOM_WRONG
                            ? bad->wrong[i] && !b->good.wrong[i]
                            : !same_bits(b, bad, i) && ray_in_contract(&b->subject.ray[i]);
        if (is && shown.count++ == 0)
            shown.first = i;
    }
    shown.is = shown.count > 0;
    return shown;
}

static enum status count_lost(const struct bisecting *b, struct bisect_shown *shown,
                              struct reason *reason)
{
    const struct compiler *compiler[2] = {&b->subject.good, &b->subject.bad};
    const struct compiled *bad = &b->made[1];
    unsigned loss[2] = {0, 0};
    enum status status = STATUS_OK;
    for (int i = 0; i < 2 && !status; i++)
        status = bisect_loses(compiler[i], &b->stage.shader, b->made[i].word, b->made[i].count,
                              &loss[i], reason);
    loss[1] &= ~loss[0];
    *shown = (struct bisect_shown){.is = loss[1] != 0,
                                   .loss = loss[1] & LOSS_OPEN ? LOSS_OPEN : loss[1],
                                   .symptom = SYMPTOM_PRECISE,
                                   .count = bad->ops - bad->kept,
                                   .of = bad->ops,
                                   .open = bad->foreign};
    return status;
}

static enum status find_symptom(struct bisecting *b, const struct bisect_answers *bad,
                                struct reason *reason)
{
    struct bisect_shown *shown = &b->result.shown;
    const size_t wanted = b->options.symptom;
    enum status status = STATUS_OK;
    for (enum symptom symptom = 0; symptom < SYMPTOM_COUNT && !shown->is && !status; symptom++)
        if (wanted != 0 && wanted != 1 + (size_t)symptom)
            continue;
        else if (symptom == SYMPTOM_PRECISE)
            status = count_lost(b, shown, reason);
        else
            *shown = count_shown(b, symptom, bad);
    return status;
}

/* --- modules ---------------------------------------------------------------------------------- */

static enum delta_answer play_one(void *user, const uint32_t *word, size_t count)
{
    struct bisecting *b = user;
    struct bisect_answers answers;
    struct reason reason = {""};
    enum status status = bisect_stage_play(&b->stage, word, count, true, &answers, &reason);
    if (status == STATUS_MEMORY || status == STATUS_INTERNAL) {
        b->stopped_status = status;
        b->stopped = reason;
        return DELTA_STOP;
    }
    if (status)
        return DELTA_UNRESOLVED;
    const bool shows = count_shown(b, b->result.shown.symptom, &answers).is;
    answers_free(&answers);
    return shows ? DELTA_SHOWS : DELTA_SHOWS_NOT;
}

static void step(void *user, const char *what, size_t tries)
{
    struct bisecting *b = user;
    progress_step(&b->progress, "%s, %zu tried", what, tries);
}

/* Plays a compiler's module; the reason says whose. */
static enum status play_compiled(struct bisecting *b, int which, struct bisect_answers *out,
                                 struct reason *reason)
{
    const char *name = which ? b->subject.bad_name : b->subject.good_name;
    const struct compiled *made = &b->made[which];
    struct reason why = {""};
    enum status status = bisect_stage_play(&b->stage, made->word, made->count, false, out, &why);
    return status ? fail(reason, status, "%s under compiler %.100s: %.180s",
                         b->options.engine->name, name, why.text)
                  : STATUS_OK;
}

/* Whether the compiler of BAD promises the bits: as in gpu/engines/compiled.c. */
static bool promises(const struct bisecting *b)
{
    const struct compiler *bad = &b->subject.bad;
    const struct compiled *made = &b->made[1];
    const uint32_t loose = made->ops - made->kept - made->signs + made->foreign;
    return bad->decorate != DECORATE_NONE && (!compiler_translates(bad) || loose == 0);
}

/* Learns which shader it is, compiles it twice and plays both. */
static enum status play_both(struct bisecting *b, struct bisect_answers *bad, struct reason *reason)
{
    struct bisect_answers raw;
    enum status status = bisect_stage_play(&b->stage, NULL, 0, false, &raw, reason);
    if (status)
        return status;
    answers_free(&raw);
    status = compiler_run(&b->subject.good, &b->stage.shader, &b->made[0], reason);
    if (!status)
        status = compiler_run(&b->subject.bad, &b->stage.shader, &b->made[1], reason);
    if (status)
        return status;
    b->result.shader = b->stage.shader.name;
    b->stage.promised = promises(b);
    status = play_compiled(b, 0, &b->good, reason);
    return status ? status : play_compiled(b, 1, bad, reason);
}

/* --- translators ------------------------------------------------------------------------------ */

static bool shows_under(struct bisecting *b, const struct compiler *compiler, bool *known)
{
    struct compiled made;
    struct reason reason = {""};
    unsigned loss = 0;
    *known = !compiler_run(compiler, &b->stage.shader, &made, &reason);
    if (!*known)
        return false;
    if (b->result.shown.symptom != SYMPTOM_PRECISE)
        return play_one(b, made.word, made.count) == DELTA_SHOWS;
    *known = !bisect_loses(compiler, &b->stage.shader, made.word, made.count, &loss, &reason);
    return (loss & b->result.shown.loss) != 0;
}

/* A translator is two tools: the same GLSL through another front end says which it is. */
static void name_tool(struct bisecting *b)
{
    struct compiler other = b->subject.bad;
    const bool shaderc = other.kind == COMPILER_SHADERC;
    const char *front = shaderc ? "glslc" : "glslangValidator";
    char *text = b->result.tool;
    const size_t bytes = sizeof b->result.tool;
    bool known = false, shows = false;
    if (!compiler_translates(&b->subject.bad))
        return;
    other.kind = shaderc ? COMPILER_CROSS : COMPILER_SHADERC;
    if (b->subject.bad.kind != COMPILER_HLSL)
        shows = shows_under(b, &other, &known);
    if (!known)
        snprintf(text, bytes, "spirv-cross or %s", front);
    else if (shows)
        snprintf(text, bytes, "spirv-cross: %s shows it, too",
                 shaderc ? "glslangValidator behind it" : "glslc behind it");
    else
        snprintf(text, bytes, "%s: %s behind the same spirv-cross does not show it", front,
                 shaderc ? "glslangValidator" : "glslc");
}

/* --- the run ---------------------------------------------------------------------------------- */

static enum status search(struct bisecting *b, struct reason *reason)
{
    const struct bisect_job job = {.compiler = b->subject.bad,
                                   .shader = b->stage.shader,
                                   .symptom = b->result.shown.symptom,
                                   .loss = b->result.shown.loss,
                                   .play = play_one,
                                   .step = step,
                                   .user = b,
                                   .most = b->options.tries};
    enum status status = bisect_run(&job, &b->result.bisect, reason);
    if (status && b->stopped_status) {
        *reason = b->stopped;
        status = b->stopped_status;
    }
    if (!status)
        name_tool(b);
    b->result.crashed = b->stage.crashed;
    b->result.hung = b->stage.hung;
    return status;
}

static enum status run(struct bisecting *b, int *code, struct reason *reason)
{
    const struct screen screen = screen_make(&b->options.screen);
    struct bisect_answers bad = {0};
    enum status status = bisect_stage_open(&b->options, &b->subject, &b->stage, reason);
    if (!status)
        status = play_both(b, &bad, reason);
    if (!status)
        status = find_symptom(b, &bad, reason);
    answers_free(&bad);
    if (!status && b->result.shown.is)
        status = search(b, reason);
    progress_end(&b->progress);
    if (status)
        return status;
    *code = b->result.shown.is ? EXIT_MISMATCH : EXIT_AGREE;
    bisect_print(&b->result, &screen);
    return b->options.json ? bisect_write_json(b->options.json, &b->result, *code, reason)
                           : STATUS_OK;
}

/* Options that this run does not use. Returns -1 if there are none. */
static int check_use(const struct bisect_options *o, char *const *spec)
{
    const struct list engine = list_of_one(TABLE_ENGINES, o->engine);
    const struct list layout = list_of_one(TABLE_LAYOUTS, o->layout);
    const struct list builder = list_of_one(TABLE_BUILDERS, o->builder);
    const struct option_use use = {.engine = &engine,
                                   .layout = &layout,
                                   .builder = &builder,
                                   .seeded = !o->rays->seedless,
                                   .scene = spec,
                                   .scene_count = 1};
    return options_refused("bisect", &use);
}

int cmd_bisect(int argc, char **argv)
{
    static struct bisecting b;
    struct reason reason = {""};
    b = (struct bisecting){
        .options = {.build = build_options_default(), .engines = engine_options_default()},
        .progress = progress_make("bisect")};
    int first, code = options_read(&set, &b.options, argc, argv, &first);
    if (code >= 0)
        return code;
    if (b.options.query == QUERY_ALL)
        return usage_error("bisect", "--query: closest or any can be bisected, not all");
    if (argc - first != 1)
        return usage_error("bisect", argc == first ? "no scene given" : "one scene at a time");
    b.result.options = &b.options;
    b.result.subject = &b.subject;
    enum status status = bisect_subject_open(&b.options, argv[first], &b.subject, &reason);
    if (status == STATUS_INPUT)
        code = usage_error("bisect", "%s", reason.text);
    else if (!status)
        code = check_use(&b.options, argv + first);
    if (code < 0) {
        code = EXIT_AGREE;
        if (!status)
            status = run(&b, &code, &reason);
        code = exit_worse(code, exit_with_reason("bisect", status, &reason));
    }
    bisect_free(&b.result.bisect);
    answers_free(&b.good);
    bisect_stage_close(&b.stage);
    bisect_subject_free(&b.subject);
    return code;
}
