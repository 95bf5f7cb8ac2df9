/* raydiff bench: a table of benchmarks. */
#include "bench/cmd_bench.h"

#include "ref/command.h"

#include <string.h>

static const char help[] =
    "usage: raydiff bench [NAME] [OPTIONS]\n"
    "Measures. Speeds are taken in one run with all contestants interleaved: median of the rounds\n"
    "with least and most; ratios are medians of per-round ratios. What was wrong stands beside\n"
    "each speed.\n\n"
    "  NAME            one benchmark                                             [all]\n"
    "  --scene S,..    scenes instead of the benchmark's own, separated by ';'\n"
    "  --count N       rays per trace, 1 or more                                 [262144]\n"
    "  --rounds N      1 to 99                                                   [9]\n"
    "  --csv FILE      all rows, for machines\n" ENGINE_OPTIONS_HELP
    "\nexit codes: 0 measured, 1 an answer was not allowed, 2 bad input, 3 engine failed\n"
    "example: raydiff bench layouts --scene 'sphere:n=50;scenes/fetched/bunny.obj'\n"
    "benchmarks:\n";

static const struct benchmark *const benchmarks[] = {&bench_layouts, &bench_builders, NULL};

static void print_help(void)
{
    fputs(help, stdout);
    for (size_t i = 0; benchmarks[i]; i++)
        printf("  %-12s %s\n", benchmarks[i]->name, benchmarks[i]->summary);
}

enum { OPT_SCENE = 256, OPT_COUNT, OPT_ROUNDS, OPT_CSV };

static enum status take_scenes(struct bench *bench, char *text, struct reason *reason)
{
    for (char *at = strtok(text, ";"); at; at = strtok(NULL, ";")) {
        if (bench->scene_count == BENCH_SCENES)
            return fail(reason, STATUS_INPUT, "--scene: at most %d scenes", BENCH_SCENES);
        bench->scene[bench->scene_count++] = at;
    }
    return STATUS_OK;
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct bench *bench = user;
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
    default:
        return engine_option_take(option, text, &bench->engines, reason);
    }
}

static int run_benchmarks(struct bench *bench, const char *name)
{
    const char *csv = bench->csv_path;
    struct reason reason = {""};
    int code = EXIT_AGREE;
    size_t run = 0;
    if (csv && file_out_open(csv, &bench->csv, &reason))
        return usage_error("bench", "%s", reason.text);
    for (size_t i = 0; benchmarks[i]; i++) {
        if (name && strcmp(name, benchmarks[i]->name) != 0)
            continue;
        run++;
        code = exit_worse(code, benchmarks[i]->run(bench));
    }
    progress_end(&bench->progress);
    if (run == 0) {
        file_out_discard(&bench->csv);
        return usage_error("bench", "unknown benchmark '%s'", name);
    }
    if (csv && file_out_commit(&bench->csv, &reason)) {
        fprintf(stderr, "raydiff bench: %s\n", reason.text);
        return EXIT_USAGE;
    }
    return code;
}

int cmd_bench(int argc, char **argv)
{
    static const struct option long_options[] = {{"scene", 1, NULL, OPT_SCENE},
                                                 {"count", 1, NULL, OPT_COUNT},
                                                 {"rounds", 1, NULL, OPT_ROUNDS},
                                                 {"csv", 1, NULL, OPT_CSV},
                                                 ENGINE_OPTIONS};
    struct bench bench = {.ray_count = 262144,
                          .rounds = 9,
                          .engines = engine_options_default(),
                          .progress = progress_make("bench")};
    int first, code = options_take("bench", print_help, long_options, take_option, &bench, argc,
                                   argv, &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("bench", "one benchmark at a time");
    return run_benchmarks(&bench, first < argc ? argv[first] : NULL);
}
