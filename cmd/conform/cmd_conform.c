/* raydiff conform: the conformance suite. Trial names are built from the tables. */
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "cmd/conform/cmd_conform_hard.h"
#include "cmd/conform/cmd_conform_report.h"
#include "cmd/conform/cmd_conform_suite.h"
#include "cmd/conform/cmd_conform_worlds.h"
#include "cmd/conform/cmd_world_trial.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

/* Parses a list of engines that may also contain the word "watertight". */
static enum status take_require(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct conform_options *o = options;
    const char *text = given->text;
    static const char word[] = "watertight";
    static char rest[4096];
    const size_t length = sizeof word - 1;
    const char *at = text;
    while ((at = strstr(at, word)) != NULL &&
           !((at == text || at[-1] == ',') && strchr(",", at[length])))
        at++;
    if (!at)
        return table_parse(TABLE_ENGINES, "--require", text, &o->require, reason);
    o->demands.watertight = true;
    if (strcmp(text, word) == 0)
        return STATUS_OK;
    const size_t before = (size_t)(at - text), last = at[length] == '\0';
    if (snprintf(rest, sizeof rest, "%.*s%s", (int)(before - last), text, at + length + !last) >=
        (int)sizeof rest)
        return fail(reason, STATUS_INPUT, "--require: longer than %zu characters", sizeof rest - 1);
    return table_parse(TABLE_ENGINES, "--require", rest, &o->require, reason);
}

#define ROWS_OF struct conform_options

static const struct option_row rows[] = {
    {"list", NULL,
     "print the names, run nothing (not those that stand in for refused trials); of hard cases "
     "also how many there are, on standard error",
     OF_FLAG(list_only)},
    {"count", "N", "rays per trial; below 200 some trials hit nothing, which fails them",
     OF_COUNT(count, 1, 1u << 30), .shown = "1000; with --all 200"},
    {"brute", "N", "ray-triangle tests that brute force may spend", OF_COUNT(brute, 0, UINT64_MAX),
     .value = "1e8"},
    {"engine", "E,..",
     "only these engines; pipe:COMMAND, FILE.so, embree:MODE and rayquery:VARIANT are such, too",
     OF_LIST(list[TABLE_ENGINES], TABLE_ENGINES), .shown = "all"},
    {"layout", "L,..", "only these layouts", OF_LIST(list[TABLE_LAYOUTS], TABLE_LAYOUTS),
     .shown = "every"},
    {"builder", "B,..", "only these builders", OF_LIST(list[TABLE_BUILDERS], TABLE_BUILDERS),
     .shown = "every"},
    {"box", "B,..", "only these box tests", OF_LIST(list[TABLE_BOX_TESTS], TABLE_BOX_TESTS),
     .shown = "every"},
    {"tri", "T,..", "only these triangle tests", OF_LIST(list[TABLE_TRI_TESTS], TABLE_TRI_TESTS),
     .shown = "every"},
    {"store", "S,..", "triangle storages; others than indexed are named as in f32:compact",
     OF_LIST(list[TABLE_STORES], TABLE_STORES), .shown = "indexed"},
    {"all", NULL, "every combination of members once, scenes and ray sets by turns", OF_FLAG(all)},
    {"require", "E,..",
     "engines whose skips are failures; watertight: a trial fails if it loses a hit inside a "
     "closed fan",
     OF_OWN(take_require), .table = 1 + TABLE_ENGINES},
    {"hard", NULL,
     "the hard cases, on the layouts f32, rf16 and those of RTRS and the builders median and "
     "rtrs, all others by turns; or on those of --layout, --builder, --box and --tri alone (one "
     "from outside, too): names hard.NN-CASE.query.engine.layout.builder.box.tri. A PATTERN that "
     "begins with 'hard.' means them too. Not with --count, --brute, --store, --all, "
     "--displacement, --require watertight",
     OF_FLAG(hard)},
    {"worlds", NULL,
     "a covering array of worlds: transforms, masks, flags, opacity, filters, ray flags, numbers "
     "of "
     "instances, and the members that trace them. A PATTERN that begins with 'world.' takes those "
     "of it whose name matches, a whole name whatever it names",
     OF_FLAG(worlds)},
    {"quick", NULL, "hard cases without members of which two parts or more are as published",
     OF_FLAG(quick)},
    {"summary", NULL, "the hard cases as a matrix", OF_FLAG(summary)},
    {"markdown", "FILE", "the matrix as Markdown", OF_WRITTEN(markdown)},
    {"html", "FILE", "the matrix as a web page", OF_WRITTEN(html)},
    {"waivers", "FILE", "lines 'PATTERN [@VERSION] REASON LINK': failures that are known",
     OF_FILE(waivers), .shown = "none; hard cases: those that are part of raydiff"},
    {"verbose", NULL, "a line per trial", OF_FLAG(verbose)},
    {"tap", NULL, "TAP 13 on standard output", OF_FLAG(tap)},
    {"junit", "FILE", "JUnit XML", OF_WRITTEN(junit)},
    {0},
};

static const struct option_set set = {
    .command = "conform",
    .usage = "conform [PATTERN] [OPTIONS]",
    .about =
        "Runs the conformance suite. Without PATTERN a covering array: few trials such that every "
        "two members of different tables (engine, layout, builder, box test, triangle test, "
        "query, scene, ray set) meet in one; pairs that met only where nothing ran are counted. "
        "With PATTERN (shell wildcards) every trial of the whole product whose name matches; a "
        "complete name runs whatever it names, also a mesh file. A pattern without a match fails; "
        "one of fewer than nine fields means layouts beyond the first few only if a field names "
        "them.\n"
        "A name is query.engine.layout.builder.box.tri.scene.rays.seed, with '-' where an engine "
        "has no tree; it is the reproduction. Lists of all hits are played where PATTERN begins "
        "with 'all.'.",
    .group = {GROUP(rows), GROUP_AT(displacement_rows, demands), GROUP_AT(engine_rows, engines),
              GROUP_AT(outside_rows, engines), GROUP_AT(compiler_rows, compilers),
              GROUP_AT(screen_rows, screen)},
    .codes = "0 passed, 1 a trial failed, 2 usage or nothing matches, 3 engine failed, 77 "
             "everything was skipped",
    .example = "conform 'closest.vulkan.rf16.median.robust.woop.sphere.*'\nconform --engine vulkan "
               "--compiler opt,size",
};

/* Whether any trial was judged, and whether any of an unknown formula was. */
struct use_of {
    bool judged, unknown;
};

/* Runs the trials of the suite from `first` on and adds them to the report. ran[i] is set if trial
 * i was judged. */
static void run_suite(const struct conform_options *o, const struct suite *suite, size_t first,
                      struct conform_report *report, bool *ran, struct use_of *use)
{
    struct trial_stage stage = {.pool = {.options = o->engines},
                                .ray_count = (size_t)o->count,
                                .brute_budget = o->brute,
                                .demands = o->demands};
    struct progress progress = progress_make("conform");
    for (size_t i = first; i < suite->count; i++) {
        char name[TRIAL_NAME_MOST];
        struct row row;
        struct reason reason = {""};
        const struct trial *trial = &suite->trial[i];
        trial_print(trial, name);
        progress_done(&progress, i - first, suite->count - first, NULL);
        if (!o->tap)
            progress_step(&progress, "%zu of %zu: %s", i + 1, suite->count, name);
        uint64_t start = time_ns();
        enum status status = trial_stage_run(&stage, trial, &row, &reason);
        ran[i] = !status && row.status != ROW_REFUSED && row.status != ROW_SKIPPED;
        use->judged = use->judged || (!status && row.status == ROW_OK);
        use->unknown = use->unknown || (!status && row.status == ROW_OK && row.unknown);
        if (!o->tap)
            progress_end(&progress);
        conform_report_add(report, name, status, &row, &reason,
                           list_names(&o->require, trial->engine),
                           (double)(time_ns() - start) * 1e-9);
    }
    trial_stage_free(&stage);
}

static int list_suite(const struct suite *suite)
{
    for (size_t i = 0; i < suite->count; i++) {
        char name[TRIAL_NAME_MOST];
        trial_print(&suite->trial[i], name);
        puts(name);
    }
    return EXIT_AGREE;
}

static void print_pairs(const struct conform_options *o, const struct conform_report *report,
                        size_t pairs, size_t unmet, const char *example)
{
    static const char only[] = "of them only in trials that were refused or skipped";
    const char *before = unmet ? ": " : "";
    if (o->tap)
        fprintf(stderr, "%s of members met, %zu %s%s%s\n", COUNTED(pairs, "pair"), unmet, only,
                before, example);
    else
        screen_record(&report->screen, PAINT_PLAIN, "%s of members met, %zu %s%s%s\n",
                      COUNTED(pairs, "pair"), unmet, only, before, example);
}

/* Pairs that met only in trials that did not run get another trial, with the other members that run
 * with most. Pairs still left after that cannot meet. */
static enum status fill_and_print(const struct conform_options *o, struct suite *suite,
                                  struct conform_report *report, bool **ran, struct use_of *use)
{
    char example[160];
    size_t pairs, unmet, first = suite->count;
    struct suite more = {.kind = SUITE_COVERING};
    enum status status = suite_pairs(suite, *ran, &pairs, &unmet, example, sizeof example, &more);
    if (!status)
        status = suite_append(suite, ran, &more);
    suite_free(&more);
    if (status)
        return status;
    run_suite(o, suite, first, report, *ran, use);
    status = suite_pairs(suite, *ran, &pairs, &unmet, example, sizeof example, NULL);
    if (!status)
        print_pairs(o, report, pairs, unmet, example);
    return status;
}

/* The members named by options; "all" names none. */
static void named_of(const struct conform_options *o, struct list named[TABLE_COUNT])
{
    for (enum table t = 0; t < TABLE_COUNT; t++)
        named[t] = o->list[t].all || o->list[t].every ? (struct list){.count = 0} : o->list[t];
}

static int run_and_report(const struct conform_options *o, struct suite *suite,
                          struct reason *reason)
{
    static struct list named[TABLE_COUNT];
    struct conform_report report;
    struct use_of use = {false, false};
    bool covering = suite->kind == SUITE_COVERING;
    bool whole = suite->kind != SUITE_PATTERN && o->list[TABLE_ENGINES].count == 0;
    bool *ran = alloc_zeroed(suite->count, sizeof *ran);
    named_of(o, named);
    enum status status =
        ran ? conform_report_open(&report, o, covering ? 0 : suite->count, whole, named, reason)
            : fail(reason, STATUS_MEMORY, "no memory for %zu trials", suite->count);
    int code = exit_with_reason("conform", status, reason);
    if (!status) {
        run_suite(o, suite, 0, &report, ran, &use);
        if (covering && fill_and_print(o, suite, &report, &ran, &use))
            fprintf(stderr, "raydiff conform: no memory to count pairs\n");
        code = conform_report_close(&report);
        if (o->demands.displacement > 0.0f && use.judged && !use.unknown)
            code = exit_worse(
                code,
                usage_error("conform", "--displacement: no engine here has an unknown formula"));
    }
    free(ran);
    return code;
}

/* Rejects demands that no trial of the suite uses. Returns -1 if there are none. */
static int check_demands(const struct conform_options *o, const struct suite *suite)
{
    struct reason why;
    bool used = o->demands.displacement == 0.0f;
    for (size_t i = 0; i < suite->count && !used; i++) {
        const struct list engine = list_of_one(TABLE_ENGINES, suite->trial[i].engine);
        const struct option_use use = {.engine = &engine};
        used = used || option_is_used(&use, "displacement", &why);
    }
    return used ? -1 : usage_error("conform", "%s", why.text);
}

static int conform(const struct conform_options *o)
{
    struct suite suite = {.kind = o->pattern ? SUITE_PATTERN
                                  : o->all   ? SUITE_PRODUCT
                                             : SUITE_COVERING,
                          .pattern = o->pattern};
    struct reason reason = {""};
    memcpy(suite.list, o->list, sizeof suite.list);
    enum status status = suite_make(&suite, &reason);
    int code = exit_with_reason("conform", status, &reason);
    if (!status) {
        code = check_demands(o, &suite);
        if (code < 0)
            code = o->list_only ? list_suite(&suite) : run_and_report(o, &suite, &reason);
    }
    suite_free(&suite);
    return code;
}

/* A complete trial name determines all members. Options only load external ones. */
static int check_name(const struct conform_options *o)
{
    struct list engine, layout = {.count = 0};
    struct trial trial;
    struct reason why;
    char never[180];
    if (trial_parse(o->pattern, &trial, &why))
        return -1; /* not a valid name: suite_make reports that */
    engine = list_of_one(TABLE_ENGINES, trial.engine);
    const bool outside = trial.layout && trial.layout->outside;
    snprintf(never, sizeof never,
             "%s%s store builder box tri hard worlds quick summary markdown html compiler decorate "
             "buffers",
             engine_is_peer(trial.engine) ? "" : "engine ", outside ? "" : "layout");
    const struct option_use use = {.by = "a trial's whole name",
                                   .never = never,
                                   .engine = &engine,
                                   .layout = outside ? &o->list[TABLE_LAYOUTS] : &layout};
    return options_refused("conform", &use);
}

/* Rejects options that this run does not use. Returns -1 if there are none. */
static int check_use(const struct conform_options *o, bool hard)
{
    struct list engine = table_all(TABLE_ENGINES), layout = table_all(TABLE_LAYOUTS);
    const bool named =
        o->pattern && strpbrk(o->pattern, "*?[") == NULL && strncmp(o->pattern, "hard.", 5) != 0;
    const struct option_use modes[] = {
        {.by = "the hard cases", .never = hard ? "count brute all store displacement" : ""},
        {.by = "--list",
         .never =
             o->list_only
                 ? "count brute require displacement waivers verbose tap junit summary markdown "
                   "html threads driver device workgroup peer-time peer-memory wide color"
                 : ""},
        {.by = "a PATTERN, whose trials are all played", .never = o->pattern ? "all" : ""},
        {.by = "a PATTERN that does not begin with 'world.'", .never = o->pattern ? "worlds" : ""},
        {.by = "--tap, which has a line per trial",
         .never = o->tap ? "verbose summary wide color" : ""},
        {.engine = o->list[TABLE_ENGINES].count ? &o->list[TABLE_ENGINES] : &engine,
         .layout = o->list[TABLE_LAYOUTS].count ? &o->list[TABLE_LAYOUTS] : &layout},
    };
    int code = named ? check_name(o) : -1;
    for (size_t i = 0; i < ARRAY_COUNT(modes) - named && code < 0; i++)
        code = options_refused("conform", &modes[i]);
    return code;
}

/* The same of worlds. */
static int check_worlds(const struct conform_options *o)
{
    struct list engine = table_all(TABLE_ENGINES), layout = table_all(TABLE_LAYOUTS);
    const struct option_use use = {
        .by = "the trials of worlds",
        .never = "all store displacement hard quick summary markdown html",
        .engine = o->list[TABLE_ENGINES].count ? &o->list[TABLE_ENGINES] : &engine,
        .layout = o->list[TABLE_LAYOUTS].count ? &o->list[TABLE_LAYOUTS] : &layout};
    const struct option_use list = {
        .by = "--list",
        .never = "count brute require waivers verbose tap junit threads driver device workgroup "
                 "peer-time peer-memory wide color"};
    int code = options_refused("conform", &use);
    if (code < 0 && o->list_only)
        code = options_refused("conform", &list);
    return code < 0 && o->demands.watertight
               ? usage_error("conform", "--require watertight: not used by the trials of worlds")
               : code;
}

int cmd_conform(int argc, char **argv)
{
    struct conform_options o = {.engines = engine_options_default()};
    int first, code = options_read(&set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("conform", "one pattern at a time; '%s' is a second", argv[first + 1]);
    o.pattern = first < argc ? argv[first] : NULL;
    code = compilers_apply("conform", &o.compilers, option_was_given("engine"),
                           &o.list[TABLE_ENGINES]);
    if (code >= 0)
        return code;
    for (size_t i = 0; i < o.require.count; i++) {
        const struct engine *engine = engines[o.require.index[i]];
        if (o.list[TABLE_ENGINES].count > 0 && !list_names(&o.list[TABLE_ENGINES], engine))
            return usage_error("conform", "--require %s: --engine leaves it out", engine->name);
    }
    const bool worlds =
        o.pattern ? strncmp(o.pattern, WORLD_TRIAL_PREFIX, strlen(WORLD_TRIAL_PREFIX)) == 0
                  : o.worlds;
    bool hard = o.hard || o.summary || o.quick || o.markdown || o.html ||
                (o.pattern && strncmp(o.pattern, "hard.", 5) == 0);
    static struct list named[TABLE_COUNT];
    named_of(&o, named);
    code = worlds ? check_worlds(&o) : check_use(&o, hard);
    if (code >= 0)
        return code;
    if (worlds) {
        o.count = o.count ? o.count : 1000;
        return conform_worlds(&o, named);
    }
    if (hard && o.demands.watertight)
        return usage_error("conform", "--require watertight: not used by the hard cases");
    if (hard)
        return conform_hard(&o, named);
    if (o.count == 0)
        o.count = o.all && !o.pattern ? 200 : 1000;
    return conform(&o);
}
