/* raydiff judge and verify: judge answers given in the text form. */
#include "ref/outside/pipe_text.h"
#include "ref/outside/recorded.h"
#include "cmd/check/cmd_check.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define STANDARD_INPUT "/dev/stdin"

struct judge_options {
    uint64_t seed, brute;
    struct match_demands demands;
    struct screen_options screen;
    const char *json;
};

#define ROWS_OF struct judge_options

static const struct option_row seed_rows[] = {
    SCENE_SEED_ROW(seed),
    {0},
};

static const struct option_row rows[] = {
    {"brute", "N", "ray-triangle pairs that brute force may decide", OF_COUNT(brute, 0, UINT64_MAX),
     .value = "2e8"},
    {"json", "FILE", "the row, for machines, as check writes it", OF_DATA(json)},
    {0},
};

#define NOTES                                                                                      \
    "A formula that is unknown is judged by how far vertices must move to make an answer right."
#define CODES "0 agree, 1 mismatch or vacuous, 2 bad input, 3 the tracer refused, 4 internal"

static const struct option_set judge_set = {
    .command = "judge",
    .usage = "judge MESH RAYS HITS [OPTIONS]",
    .about =
        "Judges answers of a tracer that cannot be run here: MESH is a mesh file or a generator; "
        "RAYS and HITS are text files, or '-' for the standard input, with lines\n"
        "  RAYS  r OX OY OZ TMIN DX DY DZ TMAX   a ray; what raydiff gen writes will do\n"
        "        query closest    or any; closest if there is no such line\n"
        "  HITS  h T U V TRIANGLE  what ray 0, 1, ... hits; triangles count from 0\n"
        "        m                or that it hits nothing\n"
        "        formula mt ieee  if that is known, before or after the hits: formula unknown, "
        "mt, woop, embree, embree_robust, pluecker, baldwin_webber; rounding one of ieee, flushed, "
        "vulkan, vulkan_rte, embree\n"
        "        flags open watertight unnamed  those that hold: ends of the range are no hits; "
        "closed meshes stay closed; any-hits name no triangle\n"
        "Numbers are decimals or hexadecimal floats, 0x1.8p+1; '#' begins a comment. U weighs a "
        "triangle's second vertex, V its third.",
    .group = {GROUP(seed_rows), GROUP(rows), GROUP_AT(displacement_rows, demands),
              GROUP_AT(watertight_rows, demands), GROUP_AT(screen_rows, screen)},
    .notes = NOTES,
    .codes = CODES,
    .example = "gen sphere:n=4 --decimal --count 100 >rays.txt\n"
               "         awk -f fuzz/samples/tracer.awk rays.txt >hits.txt\n"
               "judge sphere:n=4 rays.txt hits.txt",
};

static const struct option_set verify_set = {
    .command = "verify",
    .usage = "gen SCENE ... | TRACER | raydiff verify [OPTIONS]",
    .about = "Judges the answers on its standard input to the rays that raydiff gen wrote. They "
             "hold the 'from' line of the request, by which scene and rays are made again, and "
             "per ray 'h T U V TRIANGLE' or 'm'; see raydiff judge --help.",
    .group = {GROUP(rows), GROUP_AT(displacement_rows, demands), GROUP_AT(watertight_rows, demands),
              GROUP_AT(screen_rows, screen)},
    .notes = NOTES,
    .codes = CODES,
    .example = "gen sphere:n=8 --decimal | awk -f fuzz/samples/tracer.awk |\n"
               "             raydiff verify",
};

/* A judgement. Owns everything except the names. */
struct judge_run {
    const char *command;
    const struct judge_options *options;
    const char *spec, *ray_name; /* names of scene and rays as given by the user */
    uint64_t seed;
    struct scene scene;
    struct pipe_text request; /* rays and query */
    struct pipe_text answer;
};

static void judging_free(struct judge_run *j)
{
    scene_free(&j->scene);
    pipe_text_free(&j->request);
    pipe_text_free(&j->answer);
}

static const char *path_of(const char *argument)
{
    return strcmp(argument, "-") == 0 ? STANDARD_INPUT : argument;
}

static const char *name_of(const char *path)
{
    return strcmp(path, STANDARD_INPUT) == 0 ? "standard input" : file_label(path);
}

/* Reads a whole file. Error messages call /dev/stdin "standard input". */
static enum status read_all(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    enum status status = file_read(path, bytes, size, reason);
    if (status == STATUS_INPUT && strcmp(path, STANDARD_INPUT) == 0)
        status = fail(reason, status, "standard input: is empty or cannot be read");
    return status;
}

/* Parses the hits of a file, one per ray. */
static enum status parse_answer(struct judge_run *j, const char *name, const char *bytes,
                                size_t size, struct reason *reason)
{
    struct pipe_limits limits = {j->request.ray_count, j->scene.tri_count};
    enum status status = pipe_text_parse(name, bytes, size, &limits, &j->answer, reason);
    if (status)
        return status;
    const struct pipe_text *a = &j->answer;
    if (a->ray_count || a->scene.vertex_count)
        return fail(reason, STATUS_INPUT, "%s: has v, t or r lines: is it a request?", name);
    if (a->refused[0])
        return fail(reason, STATUS_DEVICE, "%s: the tracer refused: %s", name, a->refused);
    if (a->hit_count < j->request.ray_count)
        return fail(reason, STATUS_INPUT, "%s:%" PRIu64 ": ends after %zu of %zu answers", name,
                    a->last_line, a->hit_count, j->request.ray_count);
    return STATUS_OK;
}

static enum status read_answer(struct judge_run *j, const char *path, struct reason *reason)
{
    char *bytes;
    size_t size;
    enum status status = read_all(path, &bytes, &size, reason);
    if (status)
        return status;
    status = parse_answer(j, name_of(path), bytes, size, reason);
    free(bytes);
    return status;
}

/* Reads the rays of a file. If the file also holds a scene, it must be the named one. */
static enum status read_rays(struct judge_run *j, const char *path, struct reason *reason)
{
    const struct pipe_limits limits = {SIZE_MAX, UINT32_MAX};
    const char *name = name_of(path);
    char *bytes;
    size_t size;
    enum status status = read_all(path, &bytes, &size, reason);
    if (status)
        return status;
    status = pipe_text_parse(name, bytes, size, &limits, &j->request, reason);
    free(bytes);
    if (status)
        return status;
    const struct scene *with = &j->request.scene;
    if (j->request.hit_count)
        return fail(reason, STATUS_INPUT, "%s: has h or m lines: is it an answer?", name);
    if (j->request.ray_count == 0)
        return fail(reason, STATUS_INPUT, "%s: has no ray", name);
    if (with->vertex_count && pipe_hash(with, NULL, 0, 0) != pipe_hash(&j->scene, NULL, 0, 0))
        return fail(reason, STATUS_INPUT, "%s: has v and t lines for another scene than %.80s",
                    name, j->spec);
    return STATUS_OK;
}

static enum status play(struct judge_run *j, struct row *row, struct reason *reason)
{
    const struct pipe_text *a = &j->answer;
    struct recorded recorded = {.ray = j->request.ray,
                                .hit = a->hit,
                                .count = a->hit_count,
                                .formula = a->formula,
                                .rounding = a->rounding,
                                .flags = a->flags};
    struct match_options options = {.builder = builders[0],
                                    .build = build_options_default(),
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = j->request.query,
                                    .demands = j->options->demands,
                                    .repeats = 1,
                                    .brute_budget = j->options->brute};
    struct pool pool = {.options = engine_options_default()};
    struct match match;
    const struct engine *engine;
    enum status status = recorded_engine(&recorded, &engine, reason);
    if (!status)
        status = match_make(&j->scene, j->request.ray, j->request.ray_count, &options, &pool,
                            &match, reason);
    if (status) {
        pool_free(&pool);
        return status;
    }
    match_run(&match, engine, row);
    if (j->options->demands.displacement > 0.0f && !row->unknown)
        status = fail(reason, STATUS_INPUT, "--displacement: the formula is known");
    for (int i = 0; i < 3; i++)
        row->mrays[i] = 0; /* nothing was traced */
    pool_free(&pool);
    match_free(&match);
    return status;
}

/* Judges and prints; returns the exit code. */
static int judge_all(struct judge_run *j)
{
    struct row row;
    struct reason reason = {""};
    struct check_scene result = {.spec = j->spec,
                                 .tri_count = j->scene.tri_count,
                                 .vertex_count = j->scene.vertex_count,
                                 .rays = j->ray_name,
                                 .ray_count = j->request.ray_count,
                                 .seed = j->seed,
                                 .row = &row,
                                 .row_count = 1};
    enum status status = play(j, &row, &reason);
    const bool judged = status == STATUS_OK;
    int code = EXIT_AGREE;
    if (!status) {
        const struct screen screen = screen_make(&j->options->screen);
        check_print(&result, &screen);
        code = check_exit(&result, false, true);
    }
    if (!status && j->options->json)
        status = check_write_json(j->options->json, &result, 1, &(struct turnout){.count = 0}, code,
                                  &reason);
    code = exit_worse(code, exit_with_reason(j->command, status, &reason));
    if (judged) {
        const struct screen screen = screen_make(&j->options->screen);
        check_print_conclusion(&result, 1, code, &screen);
    }
    return code;
}

/* Judges, or prints why the input could not be read. Returns the exit code. */
static int finish(struct judge_run *j, enum status status, const struct reason *reason)
{
    int code = exit_with_reason(j->command, status, reason);
    if (!status)
        code = judge_all(j);
    judging_free(j);
    return code;
}

int cmd_judge(int argc, char **argv)
{
    struct judge_options o = {.json = NULL};
    struct reason reason = {""};
    int first, code = options_read(&judge_set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc - first != 3)
        return usage_error("judge", "MESH, RAYS and HITS are needed, not %d names", argc - first);
    const char *rays = path_of(argv[first + 1]), *hits = path_of(argv[first + 2]);
    if (strcmp(rays, STANDARD_INPUT) == 0 && strcmp(hits, rays) == 0)
        return usage_error("judge", "RAYS and HITS cannot both be '-'");
    const struct option_use use = {.scene = argv + first, .scene_count = 1};
    code = options_refused("judge", &use);
    if (code >= 0)
        return code;
    struct judge_run j = {.command = "judge",
                          .options = &o,
                          .spec = argv[first],
                          .ray_name = argv[first + 1],
                          .seed = o.seed};
    enum status status = scene_open(j.spec, o.seed, &j.scene, &reason);
    if (!status)
        status = read_rays(&j, rays, &reason);
    if (!status)
        status = read_answer(&j, hits, &reason);
    return finish(&j, status, &reason);
}

/* Rebuilds scene and rays from the answer's 'from' line. */
static enum status make_again(struct judge_run *j, const struct pipe_text *look,
                              struct reason *reason)
{
    const struct pipe_from *from = &look->from;
    const struct ray_set *set = ray_set_find(from->rays);
    if (from->spec[0] == '\0')
        return fail(reason, STATUS_INPUT,
                    "standard input: has no 'from' line: a tracer copies it from its request, "
                    "which raydiff gen writes");
    if (!set || from->count < 1 || from->count > 1u << 30)
        return fail(reason, STATUS_INPUT, "standard input: 'from' names no ray set of any count");
    if (look->refused[0])
        return fail(reason, STATUS_DEVICE, "standard input: the tracer refused: %s", look->refused);
    if (look->hit_count < from->count) /* checked before that many rays are generated */
        return fail(reason, STATUS_INPUT,
                    "standard input:%" PRIu64 ": ends after %zu of %" PRIu64 " answers",
                    look->last_line, look->hit_count, from->count);
    j->ray_name = set->name;
    j->spec = from->spec;
    j->seed = from->seed;
    enum status status = scene_open(from->spec, from->seed, &j->scene, reason);
    if (status)
        return status;
    j->request.ray_count = (size_t)from->count;
    status = ray_set_new(set, &j->scene, from->seed, j->request.ray_count, &j->request.ray, reason);
    for (j->request.query = QUERY_CLOSEST; !status && j->request.query <= QUERY_ANY;
         j->request.query++)
        if (pipe_hash(&j->scene, j->request.ray, j->request.ray_count, j->request.query) ==
            from->hash)
            return STATUS_OK;
    return status ? status
                  : fail(reason, STATUS_INPUT,
                         "standard input: 'from' is for another scene or other rays than '%.80s' "
                         "gives now",
                         from->spec);
}

static enum status read_piped(struct judge_run *j, struct pipe_text *look, struct reason *reason)
{
    const struct pipe_limits limits = {SIZE_MAX, UINT32_MAX};
    char *bytes;
    size_t size;
    enum status status = read_all(STANDARD_INPUT, &bytes, &size, reason);
    if (status)
        return status;
    status = pipe_text_parse("standard input", bytes, size, &limits, look, reason);
    if (!status)
        status = make_again(j, look, reason);
    if (!status) /* parse again, now with the limits of the scene and rays */
        status = parse_answer(j, "standard input", bytes, size, reason);
    free(bytes);
    return status;
}

int cmd_verify(int argc, char **argv)
{
    struct judge_options o = {.json = NULL};
    struct reason reason = {""};
    int first, code = options_read(&verify_set, &o, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc != first)
        return usage_error("verify", "the standard input is read; unexpected argument '%s'",
                           argv[first]);
    struct judge_run j = {.command = "verify", .options = &o};
    struct pipe_text look = {0};
    enum status status = read_piped(&j, &look, &reason);
    code = finish(&j, status, &reason);
    pipe_text_free(&look);
    return code;
}
