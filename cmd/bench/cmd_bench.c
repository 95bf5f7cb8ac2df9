/* raydiff bench: a table of benchmarks. */
#include "cmd/bench/cmd_bench.h"

#include "gpu/build/device_builders.h"
#include "bench/frames/frames.h"
#include "ref/base/nearest_name.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"

#include <stdlib.h>
#include <string.h>

static const struct benchmark *const benchmarks[] = {
    &bench_layouts, &bench_error,     &bench_spawn,  &bench_builders, &bench_oracle,
    &bench_fuzz,    &bench_frames,    &bench_paper,  &bench_special,  &bench_fast,
    &bench_matrix,  &bench_tightness, &bench_worlds, &bench_traffic,  NULL};

/* Prints "takes --a --b ..." and breaks the lines before column 80. */
static void print_takes(const char *takes)
{
    size_t column = (size_t)printf("  %-12s  takes", "");
    for (const char *at = takes; *at;) {
        size_t length = strcspn(at, " ");
        if (column + length + 3 > 79)
            column = (size_t)printf("\n  %-12s       ", "") - 1;
        column += (size_t)printf(" --%.*s", (int)length, at);
        at += length + strspn(at + length, " ");
    }
    putchar('\n');
}

static void print_benchmarks(void)
{
    char line[200];
    puts("benchmarks:");
    for (size_t i = 0; benchmarks[i]; i++) {
        snprintf(line, sizeof line, "  %-12s  %s", benchmarks[i]->name, benchmarks[i]->summary);
        options_text(line, 0);
        print_takes(benchmarks[i]->takes);
        if (benchmarks[i]->alone)
            puts("                runs only if it is named");
    }
    for (size_t i = 0; benchmarks[i]; i++)
        if (benchmarks[i]->about) {
            printf("\n%s: ", benchmarks[i]->name);
            options_text(benchmarks[i]->about, strlen(benchmarks[i]->name) + 2);
        }
}

static enum status take_scenes(void *options, const struct option_value *given,
                               struct reason *reason)
{
    struct bench *bench = options;
    for (char *at = strtok(given->text, ";"); at; at = strtok(NULL, ";")) {
        if (bench->scene_count == BENCH_SCENES)
            return fail(reason, STATUS_INPUT, "--scene: at most %d scenes", BENCH_SCENES);
        bench->scene[bench->scene_count++] = at;
    }
    return STATUS_OK;
}

static enum status take_size(void *options, const struct option_value *given, struct reason *reason)
{
    struct bench *bench = options;
    const char *text = given->text;
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

static const char *const profiles[] = {"repaired", "rtrs", NULL};

#define ROWS_OF struct bench

static const struct option_row all_rows[] = {
    {"scene", "S;..", "scenes instead of the benchmark's own", OF_OWN(take_scenes), .file = true,
     .repeats = true},
    {"count", "N", "rays per trace, 1 or more", OF_COUNT(ray_count, 1, 1u << 28),
     .shown = "the benchmark's own"},
    {"instances", "N", "of the mesh in a world", OF_COUNT(instances, 1, 1u << 20),
     .shown = "100000"},
    {"rounds", "N", "measurements of each", OF_COUNT(rounds, 1, BENCH_ROUNDS), .value = "9"},
    {"csv", "FILE", "all rows, for machines; '-': the standard output, alone", OF_DATA(csv_path)},
    {0},
};

static const struct option_row own_rows[] = {
    {"engine", "E,..", "engines, or 'all'; inside:FILE.so is a tracer of your own",
     OF_LIST(engine, TABLE_ENGINES), .shown = "every engine that can run here"},
    {"layout", "L,..", "node layouts, or 'all'", OF_LIST(layout, TABLE_LAYOUTS),
     .shown = "all but those of RTRS"},
    {"store", "S,..", "triangle storages", OF_LIST(store, TABLE_STORES), .shown = "indexed"},
    {"tri", "T,..", "triangle tests, or 'all'", OF_LIST(tri, TABLE_TRI_TESTS),
     .shown = "all but that of RTRS"},
    {"box", "B,..", "box tests, or 'all'", OF_LIST(box, TABLE_BOX_TESTS),
     .shown = "robust; watertight for watertight tests"},
    {"rays", "R,..", "ray sets, or 'all'", OF_LIST(rays, TABLE_RAY_SETS),
     .shown = "the benchmark's own"},
    SEED_ROW(seed),
    {"json", "FILE", "all rows, for machines; '-' likewise", OF_DATA(json_path)},
    {"svg", "FILE", "a plot of what was measured", OF_WRITTEN(svg_path)},
    {"bvh", "FILE", "a tree of the one --scene, as JSON, in place of a builder's", OF_FILE(bvh)},
    {"frames", "N", "frames drawn and measured", OF_COUNT(picture.frames, 1, FRAMES_MOST),
     .shown = "200, or the benchmark's own"},
    {"size", "WxH", "pixels", OF_OWN(take_size), .shown = "384x288"},
    {"out", "BASE", "names the files: BASE.csv, BASE.json; charts BASE.svg and BASE.png",
     OF_OUTPUT(picture.out)},
    {"turns", "N", "around the camera's target in all frames",
     OF_COUNT(picture.turns, 0, FRAMES_MOST), .standard = FRAMES_TURNS},
    {"warm-up", "N", "frames before them, dropped", OF_COUNT(picture.warm_up, 0, FRAMES_MOST),
     .standard = FRAMES_WARM_UP},
    {"bounces", "N", "segments of a path", OF_COUNT(picture.bounces, 0, FRAME_BOUNCES_MOST),
     .value = "4"},
    {"profile", "P", "repaired, or rtrs: as the published shader",
     OF_CHOICE(picture.profile, profiles), .value = "repaired"},
    {"quick", NULL, "small pictures, few frames: to see that it works", OF_FLAG(quick)},
    {0},
};

static const struct option_set set = {
    .command = "bench",
    .usage = "bench [NAME] [OPTIONS]",
    .about = "Measures. Speeds are taken in one run with all contestants interleaved: median of "
             "the rounds with least and most; ratios are medians of per-round ratios. Wrong "
             "answers are printed beside each speed.\n"
             "NAME is one benchmark; without it all run except those that must be named.",
    .group = {GROUP(all_rows),
              {.row = own_rows, .title = "and where the benchmark takes them:"},
              GROUP_AT(traffic_rows, traffic),
              GROUP_AT(engine_rows, engines),
              GROUP_AT(outside_rows, engines),
              GROUP_AT(compiler_rows, compilers),
              GROUP_AT(screen_rows, screen)},
    .codes = "0 measured, 1 an answer was not allowed or a run proved nothing, 2 bad input, 3 "
             "engine failed, 77 a named engine cannot run here; 128 + the signal that ended a run "
             "of frames: its files hold the frames measured until then",
    .example = "bench layouts --scene 'sphere:n=20;soup:n=1000' --count 2000\n"
               "bench layouts --compiler opt,size --scene sphere",
    .more = print_benchmarks,
};

static enum status unknown(const char *name, struct reason *reason)
{
    char known[200] = "", hint[NEAREST_HINT];
    size_t used = 0;
    struct nearest_name nearest = nearest_make(name, strlen(name));
    for (size_t i = 0; benchmarks[i] && used < sizeof known; i++) {
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "",
                                 benchmarks[i]->name);
        nearest_try(&nearest, benchmarks[i]->name);
    }
    return fail(reason, STATUS_INPUT, "unknown benchmark '%.60s'; benchmarks are: %s%s", name,
                known, nearest_hint(&nearest, hint));
}

/* Returns `named`, or all members of the table if none was named. */
static const struct list *or_all(const struct list *named, enum table table, struct list *all)
{
    *all = table_all(table);
    return named->count ? named : all;
}

/* True if `name` is this benchmark's; for NULL, true unless it runs only if it is named. */
static bool is_meant(const struct benchmark *benchmark, const char *name)
{
    return name ? strcmp(name, benchmark->name) == 0 : !benchmark->alone;
}

/* Rejects options that the chosen benchmarks would ignore. */
static enum status check_given(const struct bench *bench, const char *name, struct reason *reason)
{
    struct list engine, layout;
    char takes[2000] = "", by[80];
    const struct benchmark *known = NULL;
    for (size_t i = 0; benchmarks[i]; i++) {
        if (!is_meant(benchmarks[i], name))
            continue;
        known = benchmarks[i];
        size_t used = strlen(takes);
        snprintf(takes + used, sizeof takes - used, " %s", benchmarks[i]->takes);
    }
    if (!known)
        return unknown(name, reason);
    const bool undrawn = name && known->undrawn;
    snprintf(by, sizeof by, "benchmark %s", name ? name : "all");
    const char *spec = bench->scene_count ? bench->scene[0] : undrawn ? known->scenes : NULL;
    const struct option_use use = {.by = by,
                                   .only = takes,
                                   .engine = or_all(&bench->engine, TABLE_ENGINES, &engine),
                                   .layout = or_all(&bench->layout, TABLE_LAYOUTS, &layout),
                                   .scene = undrawn ? (char *const *)(uintptr_t)&spec : NULL,
                                   .scene_count = undrawn,
                                   .unnamed = bench->engine.count == 0,
                                   .seeded = !undrawn};
    device_builders_use(&bench->engines);
    enum status status = options_check(&use, reason);
    if (!status && bench->bvh && bench->scene_count != 1)
        return fail(reason, STATUS_INPUT,
                    "--bvh: a tree belongs to one scene: name it with --scene");
    return status;
}

static enum status write_json(struct bench *bench, struct reason *reason)
{
    json_t *root = json_pack("{s:s, s:i, s:O}", "raydiff", RAYDIFF_VERSION, "exit", bench->code,
                             "rows", bench->rows);
    return json_write(bench->json_path, root, 9, reason);
}

/* With --out BASE, fills in BASE.csv, .json and .svg where the user gave no name. Only for
 * benchmarks with rows_out. */
static enum status name_files(struct bench *bench, const char *name, struct reason *reason)
{
    const char *out = bench->picture.out;
    bool rows = false;
    for (size_t i = 0; benchmarks[i] && name && out; i++)
        rows = rows || (benchmarks[i]->rows_out && is_meant(benchmarks[i], name));
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

/* The conclusion; a benchmark that could not finish has said why. */
static void conclude(const struct bench *bench, const struct benchmark *benchmark)
{
    const bool shown = bench->code == EXIT_AGREE;
    if (!shown && (bench->code != EXIT_MISMATCH || !benchmark->refuted))
        return;
    screen_record(&bench->screen_is,
                  !shown               ? PAINT_BAD
                  : benchmark->refuted ? PAINT_GOOD
                                       : PAINT_PLAIN,
                  "bench %s: %zu row%s: %s\n", benchmark->name, bench->row_count,
                  plural(bench->row_count), shown ? benchmark->shown : benchmark->refuted);
}

/* Runs one, and merges its exit code. */
static void run_one(struct bench *bench, const struct benchmark *benchmark)
{
    int before = bench->code;
    bench->code = EXIT_AGREE;
    bench->row_count = 0;
    bench_worse(bench, benchmark->run ? benchmark->run(bench) : bench_each(bench, benchmark));
    progress_end(&bench->progress);
    conclude(bench, benchmark);
    int own = bench->code;
    bench->code = before;
    bench_worse(bench, own);
}

static int run_benchmarks(struct bench *bench, const char *name)
{
    struct reason reason = {""};
    if (check_given(bench, name, &reason))
        return usage_error("bench", "%s", reason.text);
    const int code =
        compilers_apply("bench", &bench->compilers, option_was_given("engine"), &bench->engine);
    if (code >= 0)
        return code;
    /* Once more, of the engines that are left. */
    if (check_given(bench, name, &reason) || name_files(bench, name, &reason) ||
        (bench->csv_path && options_out(bench->csv_path, &bench->csv, &reason)))
        return usage_error("bench", "%s", reason.text);
    if (bench->json_path || bench->svg_path)
        bench->rows = json_array();
    if (bench->picture.width == 0) {
        bench->picture.width = bench->quick ? 96 : 384;
        bench->picture.height = bench->quick ? 72 : 288;
    }
    for (size_t i = 0; benchmarks[i]; i++)
        if (is_meant(benchmarks[i], name))
            run_one(bench, benchmarks[i]);
    enum status status = bench->csv_path ? file_out_commit(&bench->csv, &reason) : STATUS_OK;
    if (status == STATUS_OK && bench->json_path)
        status = write_json(bench, &reason);
    json_decref(bench->rows);
    bench_failed(bench, NULL, status, &reason);
    return bench->code;
}

int cmd_bench(int argc, char **argv)
{
    struct bench bench = {.picture = {.turns = FRAMES_TURNS, .warm_up = FRAMES_WARM_UP},
                          .traffic = traffic_options_default(),
                          .engines = engine_options_default(),
                          .progress = progress_make("bench")};
    int first, code = options_read(&set, &bench, argc, argv, &first);
    if (code >= 0)
        return code;
    bench.screen_is = screen_make(&bench.screen);
    if (argc - first > 1)
        return usage_error("bench",
                           "one benchmark at a time, and '%.60s' is a second (a scene: --scene)",
                           argv[first + 1]);
    return run_benchmarks(&bench, first < argc ? argv[first] : NULL);
}
