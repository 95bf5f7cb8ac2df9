/* raydiff bench: a table of benchmarks. */
#include "cmd/bench/cmd_bench.h"

#include "bench/frames/frames.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_use.h"
#include "ref/frame.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: raydiff bench [NAME] [OPTIONS]\n"
    "Measures. Speeds are taken in one run with all contestants interleaved: median of the rounds\n"
    "with least and most; ratios are medians of per-round ratios. What was wrong stands beside\n"
    "each speed.\n\n"
    "  NAME            one benchmark                      [all that need not be named]\n"
    "  --scene S,..    scenes instead of the benchmark's own, separated by ';'\n"
    "  --count N       rays per trace, 1 or more                     [the benchmark's own]\n"
    "  --rounds N      1 to 99                                                   [9]\n"
    "  --csv FILE      all rows, for machines; '-': the standard output, alone\n"
    "and where the benchmark says so:\n"
    "  --engine E,..   engines, or 'all'                  [every engine that can run here]\n"
    "  --layout L,..   node layouts, or 'all'             [all but RTRS's]\n"
    "  --store S,..    triangle storages                                     [indexed]\n"
    "  --tri T,..      triangle tests, or 'all'           [all but RTRS's]\n"
    "  --box B,..      box tests, or 'all'       [robust; watertight for watertight tests]\n"
    "  --rays R,..     ray sets, or 'all'                 [the benchmark's own]\n"
    "  --seed S        of rays and generators                                    [1]\n"
    "  --json FILE     all rows, for machines; '-' likewise\n"
    "  --svg FILE      a plot of what was measured\n"
    "  --bvh FILE      a tree of the one --scene, as JSON, in place of a builder's\n"
    "  --frames N      frames drawn and measured           [200, or the benchmark's own]\n"
    "  --size WxH      pixels                                              [384x288]\n"
    "  --out BASE      names the files: BASE.csv, BASE.json; charts BASE.svg and BASE.png\n"
    "  --turns N       around the camera's target in all frames                  [5]\n"
    "  --warm-up N     frames before them, dropped                               [3]\n"
    "  --bounces N     segments of a path, 0 to 64                               [4]\n"
    "  --profile P     repaired, or rtrs: as the published shader         [repaired]\n"
    "  --quick         small pictures, few frames: to see that it works\n" ENGINE_OPTIONS_HELP
    "\nexit codes: 0 measured, 1 an answer was not allowed or a run proved nothing, 2 bad input,\n"
    "3 engine failed, 77 a named engine cannot run here; 128 + the signal that ended a run of "
    "frames:\n"
    "its files hold the frames measured until then\n"
    "example: raydiff bench layouts --scene 'sphere:n=50;scenes/fetched/bunny.obj'\n"
    "benchmarks:\n";

static const struct benchmark *const benchmarks[] = {
    &bench_layouts, &bench_error,     &bench_spawn, &bench_builders, &bench_oracle,
    &bench_fuzz,    &bench_frames,    &bench_paper, &bench_special,  &bench_fast,
    &bench_matrix,  &bench_tightness, NULL};

/* "takes --a --b", in lines. */
static void print_takes(const char *takes)
{
    size_t column = (size_t)printf("  %-12s takes", "");
    for (const char *at = takes; *at;) {
        size_t length = strcspn(at, " ");
        if (column + length + 3 > 96)
            column = (size_t)printf("\n  %-12s      ", "") - 1;
        column += (size_t)printf(" --%.*s", (int)length, at);
        at += length + strspn(at + length, " ");
    }
    putchar('\n');
}

static void print_help(void)
{
    fputs(help, stdout);
    for (size_t i = 0; benchmarks[i]; i++) {
        printf("  %-12s %s\n", benchmarks[i]->name, benchmarks[i]->summary);
        print_takes(benchmarks[i]->takes);
        if (benchmarks[i]->alone)
            printf("  %-12s runs only if it is named\n", "");
    }
    for (size_t i = 0; benchmarks[i]; i++)
        if (benchmarks[i]->about)
            printf("\n%s: %s", benchmarks[i]->name, benchmarks[i]->about);
}

enum {
    OPT_SCENE = 256,
    OPT_COUNT,
    OPT_ROUNDS,
    OPT_CSV,
    OPT_ENGINE,
    OPT_LAYOUT,
    OPT_TRI,
    OPT_BOX,
    OPT_RAYS,
    OPT_SEED,
    OPT_SVG,
    OPT_JSON,
    OPT_FRAMES,
    OPT_SIZE,
    OPT_OUT,
    OPT_TURNS,
    OPT_WARM_UP,
    OPT_BOUNCES,
    OPT_PROFILE,
    OPT_QUICK,
    OPT_STORE
};

static enum status take_scenes(struct bench *bench, char *text, struct reason *reason)
{
    for (char *at = strtok(text, ";"); at; at = strtok(NULL, ";")) {
        if (bench->scene_count == BENCH_SCENES)
            return fail(reason, STATUS_INPUT, "--scene: at most %d scenes", BENCH_SCENES);
        bench->scene[bench->scene_count++] = at;
    }
    return STATUS_OK;
}

static enum status take_size(const char *text, struct bench *bench, struct reason *reason)
{
    const char *by = strchr(text, 'x');
    char width[16];
    if (!by || (size_t)(by - text) >= sizeof width)
        return fail(reason, STATUS_INPUT, "--size: '%.40s' is not WIDTHxHEIGHT", text);
    snprintf(width, sizeof width, "%.*s", (int)(by - text), text);
    enum status status =
        parse_count("--size", width, 1, FRAME_SIDE_MOST, &bench->picture.width, reason);
    return status
               ? status
               : parse_count("--size", by + 1, 1, FRAME_SIDE_MOST, &bench->picture.height, reason);
}

/* Options of measured frames. */
static enum status take_picture(int option, char *text, struct bench *bench, struct reason *reason)
{
    switch (option) {
    case OPT_FRAMES:
        return parse_count("--frames", text, 1, FRAMES_MOST, &bench->picture.frames, reason);
    case OPT_SIZE:
        return take_size(text, bench, reason);
    case OPT_TURNS:
        return parse_count("--turns", text, 0, FRAMES_MOST, &bench->picture.turns, reason);
    case OPT_WARM_UP:
        return parse_count("--warm-up", text, 0, FRAMES_MOST, &bench->picture.warm_up, reason);
    case OPT_BOUNCES:
        return parse_count("--bounces", text, 0, FRAME_BOUNCES_MOST, &bench->picture.bounces,
                           reason);
    case OPT_PROFILE:
        bench->picture.rtrs = strcmp(text, "rtrs") == 0;
        if (!bench->picture.rtrs && strcmp(text, "repaired") != 0)
            return fail(reason, STATUS_INPUT, "--profile: '%.40s' is neither repaired nor rtrs",
                        text);
        return STATUS_OK;
    case OPT_OUT:
        bench->picture.out = text;
        return STATUS_OK;
    default:
        bench->quick = true;
        return STATUS_OK;
    }
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct bench *bench = user;
    if (option >= OPT_FRAMES && option <= OPT_QUICK)
        return take_picture(option, text, bench, reason);
    switch (option) {
    case OPT_SCENE:
        return take_scenes(bench, text, reason);
    case OPT_COUNT:
        return parse_count("--count", text, 1, 1u << 28, &bench->ray_count, reason);
    case OPT_ROUNDS:
        return parse_count("--rounds", text, 1, BENCH_ROUNDS, &bench->rounds, reason);
    case OPT_CSV:
        bench->csv_path = text;
        return STATUS_OK;
    case OPT_ENGINE:
        return table_parse(TABLE_ENGINES, "--engine", text, &bench->engine, reason);
    case OPT_LAYOUT:
        return table_parse(TABLE_LAYOUTS, "--layout", text, &bench->layout, reason);
    case OPT_STORE:
        return table_parse(TABLE_STORES, "--store", text, &bench->store, reason);
    case OPT_TRI:
        return table_parse(TABLE_TRI_TESTS, "--tri", text, &bench->tri, reason);
    case OPT_BOX:
        return table_parse(TABLE_BOX_TESTS, "--box", text, &bench->box, reason);
    case OPT_RAYS:
        return table_parse(TABLE_RAY_SETS, "--rays", text, &bench->rays, reason);
    case OPT_SEED:
        return parse_count("--seed", text, 0, UINT64_MAX, &bench->seed, reason);
    case OPT_SVG:
        bench->svg_path = text;
        return STATUS_OK;
    case OPT_JSON:
        bench->json_path = text;
        return STATUS_OK;
    case OPT_BVH:
        bench->bvh = text;
        return STATUS_OK;
    default:
        return engine_option_take(option, text, &bench->engines, reason);
    }
}

static enum status unknown(const char *name, struct reason *reason)
{
    char known[160] = "";
    size_t used = 0;
    for (size_t i = 0; benchmarks[i] && used < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "",
                                 benchmarks[i]->name);
    return fail(reason, STATUS_INPUT, "unknown benchmark '%.60s'; benchmarks are: %s", name, known);
}

/* What was named, or all that could be. */
static const struct list *or_all(const struct list *named, enum table table, struct list *all)
{
    *all = table_all(table);
    return named->count ? named : all;
}

/* An option that the named benchmark, or each of all, would ignore is refused. */
static enum status check_given(const struct bench *bench, const char *name, struct reason *reason)
{
    struct list engine, layout;
    char takes[2000] = "", by[80];
    bool known = false;
    for (size_t i = 0; benchmarks[i]; i++) {
        if (name ? strcmp(name, benchmarks[i]->name) != 0 : benchmarks[i]->alone)
            continue;
        known = true;
        size_t used = strlen(takes);
        snprintf(takes + used, sizeof takes - used, " %s", benchmarks[i]->takes);
    }
    if (!known)
        return unknown(name, reason);
    snprintf(by, sizeof by, "benchmark %s", name ? name : "all");
    const struct option_use use = {.by = by,
                                   .only = takes,
                                   .engine = or_all(&bench->engine, TABLE_ENGINES, &engine),
                                   .layout = or_all(&bench->layout, TABLE_LAYOUTS, &layout),
                                   .seeded = true};
    enum status status = options_check(&use, reason);
    if (!status && bench->bvh && bench->scene_count != 1)
        return fail(reason, STATUS_INPUT, "--bvh: a tree is of one scene: name it with --scene");
    return status;
}

/* The CSV is written from the start. */
static enum status open_csv(struct bench *bench, struct reason *reason)
{
    return bench->csv_path ? options_out(bench->csv_path, &bench->csv, reason) : STATUS_OK;
}

static enum status write_json(struct bench *bench, int code, struct reason *reason)
{
    json_t *root =
        json_pack("{s:s, s:i, s:O}", "raydiff", RAYDIFF_VERSION, "exit", code, "rows", bench->rows);
    return json_write(bench->json_path, root, 9, reason);
}

/* --out BASE of benchmarks that write rows: BASE.csv, .json and .svg, where no name was given. */
static enum status name_files(struct bench *bench, const char *name, struct reason *reason)
{
    const char *out = bench->picture.out;
    bool rows = false;
    for (size_t i = 0; benchmarks[i] && name && out; i++)
        rows = rows || (benchmarks[i]->rows_out && strcmp(name, benchmarks[i]->name) == 0);
    if (!rows)
        return STATUS_OK;
    if (strlen(out) + 6 > sizeof bench->picture.csv)
        return fail(reason, STATUS_INPUT, "--out: too long a name");
    snprintf(bench->picture.csv, sizeof bench->picture.csv, "%s.csv", out);
    snprintf(bench->picture.json, sizeof bench->picture.json, "%s.json", out);
    snprintf(bench->picture.svg, sizeof bench->picture.svg, "%s.svg", out);
    bench->csv_path = bench->csv_path ? bench->csv_path : bench->picture.csv;
    bench->json_path = bench->json_path ? bench->json_path : bench->picture.json;
    bench->svg_path = bench->svg_path ? bench->svg_path : bench->picture.svg;
    return STATUS_OK;
}

/* A signal's code stands for a run in which nothing else was wrong. */
static int worse_or_signal(int code, int other)
{
    if (other > 128)
        return code == EXIT_AGREE ? other : code;
    return code > 128 ? code : exit_worse(code, other);
}

static int run_benchmarks(struct bench *bench, const char *name)
{
    struct reason reason = {""};
    int code = EXIT_AGREE;
    if (check_given(bench, name, &reason) || name_files(bench, name, &reason) ||
        open_csv(bench, &reason))
        return usage_error("bench", "%s", reason.text);
    if (bench->json_path)
        bench->rows = json_array();
    for (size_t i = 0; benchmarks[i]; i++)
        if (name ? strcmp(name, benchmarks[i]->name) == 0 : !benchmarks[i]->alone)
            code = worse_or_signal(code, benchmarks[i]->run(bench));
    progress_end(&bench->progress);
    enum status status = bench->csv_path ? file_out_commit(&bench->csv, &reason) : STATUS_OK;
    if (status == STATUS_OK && bench->json_path)
        status = write_json(bench, code, &reason);
    json_decref(bench->rows);
    if (status == STATUS_OK)
        return code;
    fprintf(stderr, "raydiff bench: %s\n", reason.text);
    return exit_worse(code, exit_of_status(status));
}

int cmd_bench(int argc, char **argv)
{
    static const struct option long_options[] = {{"scene", 1, NULL, OPT_SCENE},
                                                 {"count", 1, NULL, OPT_COUNT},
                                                 {"rounds", 1, NULL, OPT_ROUNDS},
                                                 {"csv", 1, NULL, OPT_CSV},
                                                 {"engine", 1, NULL, OPT_ENGINE},
                                                 {"layout", 1, NULL, OPT_LAYOUT},
                                                 {"store", 1, NULL, OPT_STORE},
                                                 {"tri", 1, NULL, OPT_TRI},
                                                 {"box", 1, NULL, OPT_BOX},
                                                 {"rays", 1, NULL, OPT_RAYS},
                                                 {"seed", 1, NULL, OPT_SEED},
                                                 {"svg", 1, NULL, OPT_SVG},
                                                 {"json", 1, NULL, OPT_JSON},
                                                 {"frames", 1, NULL, OPT_FRAMES},
                                                 {"size", 1, NULL, OPT_SIZE},
                                                 {"out", 1, NULL, OPT_OUT},
                                                 {"turns", 1, NULL, OPT_TURNS},
                                                 {"warm-up", 1, NULL, OPT_WARM_UP},
                                                 {"bounces", 1, NULL, OPT_BOUNCES},
                                                 {"profile", 1, NULL, OPT_PROFILE},
                                                 {"quick", 0, NULL, OPT_QUICK},
                                                 TREE_OPTION,
                                                 ENGINE_OPTIONS};
    struct bench bench = {
        .rounds = 9,
        .seed = 1,
        .picture = {.turns = FRAMES_TURNS, .warm_up = FRAMES_WARM_UP, .bounces = 4},
        .engines = engine_options_default(),
        .progress = progress_make("bench")};
    int first, code = options_take("bench", print_help, long_options, take_option, &bench, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("bench",
                           "one benchmark at a time, and '%.60s' is a second (a scene: --scene)",
                           argv[first + 1]);
    return run_benchmarks(&bench, first < argc ? argv[first] : NULL);
}
