/* raydiff conform: the conformance suite, its names made from the tables. */
#include "ref/cmd_options.h"
#include "ref/command.h"
#include "tests/cmd_conform_hard.h"
#include "tests/cmd_conform_report.h"
#include "tests/cmd_trial.h"

#include "scenes/scenes.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: raydiff conform [PATTERN] [OPTIONS]\n"
    "Runs the conformance suite. Without PATTERN a default suite that pairs every combination of\n"
    "engine, layout, builder, box test, triangle test and query with a scene and a ray set, and\n"
    "every scene with every ray set. With PATTERN (shell wildcards) every trial of the whole\n"
    "product whose name matches; a complete name runs whatever it names, also a mesh file. A\n"
    "pattern without a match fails.\n\n"
    "  name            query.engine.layout.builder.box.tri.scene.rays.seed, '-' where an engine\n"
    "                  has no tree; the name is the reproduction\n"
    "  --list          print the names, run nothing\n"
    "  --count N       rays per trial                                     [1000]\n"
    "  --brute N       ray-triangle tests that brute force may spend      [1e8]\n"
    "  --engine E,..   only these engines; pipe:COMMAND is one, too       [all]\n"
    "  --require E,..  engines whose skips are failures\n"
    "  --hard          the hard cases, on every member: names hard.NN-CASE.query.engine.layout.\n"
    "                  builder.box.tri; a PATTERN that begins with 'hard.' means them too\n"
    "  --quick         without members of which two parts or more are as published\n"
    "  --summary       the hard cases as a matrix\n"
    "  --markdown FILE the matrix as Markdown\n"
    "  --html FILE     the matrix as a web page\n"
    "  --waivers FILE  lines 'PATTERN [@VERSION] REASON LINK': failures that are known\n"
    "                  [none; hard cases: tests/waivers.txt, if it is here]\n"
    "  --verbose       a line per trial\n"
    "  --tap           TAP 13 on standard output\n"
    "  --junit FILE    JUnit XML\n" ENGINE_OPTIONS_HELP
    "\nexit codes: 0 passed, 1 a trial failed, 2 usage or nothing matches, 3 engine failed,\n"
    "            77 everything was skipped\n"
    "example: raydiff conform 'closest.vulkan.rf16.median.robust.woop.sphere.*'\n";

struct suite {
    struct trial *trial;
    size_t count, capacity;
    const char *pattern; /* NULL: take all */
    struct list engine;  /* none: take all */
    bool failed;         /* no memory */
};

static bool named(const struct list *list, const struct engine *engine)
{
    for (size_t i = 0; i < list->count; i++)
        if (engines[list->index[i]] == engine)
            return true;
    return false;
}

static void suite_add(struct suite *suite, const struct trial *trial)
{
    char name[TRIAL_NAME_MOST];
    if (suite->engine.count && !named(&suite->engine, trial->engine))
        return;
    trial_print(trial, name);
    if (suite->pattern && fnmatch(suite->pattern, name, 0) != 0)
        return;
    void *trials = suite->trial;
    if (array_reserve(&trials, &suite->capacity, suite->count + 1, sizeof *trial)) {
        suite->failed = true;
        return;
    }
    suite->trial = trials;
    suite->trial[suite->count++] = *trial;
}

static size_t count_of(enum table table)
{
    size_t n = 0;
    while (table_member(table, n, NULL))
        n++;
    return n;
}

static void place(struct trial *trial, size_t scene, size_t rays)
{
    strcpy(trial->scene, generators[scene % count_of(TABLE_GENERATORS)]->name);
    trial->rays = ray_sets[rays % count_of(TABLE_RAY_SETS)];
    trial->seed = 1;
}

/* Calls `visit` with every combination of members that are not scene or rays. */
static void each_combination(struct suite *suite,
                             void (*visit)(struct suite *, struct trial *, size_t serial))
{
    size_t serial = 0;
    for (size_t b = 0; builders[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++)
            for (size_t l = 0; layouts[l]; l++)
                for (size_t x = 0; box_tests[x]; x++)
                    for (size_t q = 0; q <= QUERY_ANY; q++)
                        for (size_t e = 0; engines[e]; e++) {
                            struct trial trial = {.query = (enum query)q,
                                                  .engine = engines[e],
                                                  .layout = layouts[l],
                                                  .builder = builders[b],
                                                  .box = box_tests[x],
                                                  .tri = tri_tests[t]};
                            if (engines[e]->needs_packed) {
                                visit(suite, &trial, serial);
                            } else if (l == 0 && x == 0 && b == 0) {
                                trial.layout = NULL;
                                trial.builder = NULL;
                                trial.box = NULL;
                                visit(suite, &trial, serial);
                            }
                            serial += e == 0; /* engines share scene and rays */
                        }
}

static void add_everywhere(struct suite *suite, struct trial *trial, size_t serial)
{
    (void)serial;
    for (size_t s = 0; generators[s]; s++)
        for (size_t r = 0; ray_sets[r]; r++) {
            place(trial, s, r);
            suite_add(suite, trial);
        }
}

/* Default suite: each combination once, scenes and rays taken in turn; the repaired parts and the
 * engines without a tree everywhere. */
static void add_default(struct suite *suite, struct trial *trial, size_t serial)
{
    if (strcmp(trial->engine->name, "brute") == 0)
        return; /* it is what the others are compared with */
    bool plain = trial->query == QUERY_CLOSEST && !trial->tri->faithful;
    if (trial->layout)
        plain =
            plain && !trial->layout->faithful && !trial->builder->faithful && !trial->box->faithful;
    if (plain) {
        add_everywhere(suite, trial, serial);
    } else {
        place(trial, serial, serial / count_of(TABLE_GENERATORS));
        suite_add(suite, trial);
    }
}

static int by_stage(const void *a, const void *b)
{
    const struct trial *x = a, *y = b;
    int order = strcmp(x->scene, y->scene);
    if (order == 0)
        order = strcmp(x->rays->name, y->rays->name);
    if (order == 0)
        order = strcmp(x->tri->name, y->tri->name);
    if (order == 0)
        order = strcmp(x->builder ? x->builder->name : "", y->builder ? y->builder->name : "");
    if (order == 0)
        order = strcmp(x->layout ? x->layout->name : "", y->layout ? y->layout->name : "");
    if (order == 0)
        order = strcmp(x->box ? x->box->name : "", y->box ? y->box->name : "");
    if (order == 0)
        order = (x->query > y->query) - (x->query < y->query);
    return order ? order : strcmp(x->engine->name, y->engine->name);
}

/* Neighbours share scene, rays, reference and tree, so sorting saves most of the time. */
static enum status suite_make(struct suite *suite, struct reason *reason)
{
    struct trial one;
    if (suite->pattern && strpbrk(suite->pattern, "*?[") == NULL) {
        enum status status = trial_parse(suite->pattern, &one, reason);
        if (status)
            return status;
        suite_add(suite, &one);
    } else {
        each_combination(suite, suite->pattern ? add_everywhere : add_default);
    }
    if (suite->failed)
        return fail(reason, STATUS_MEMORY, "no memory for the list of trials");
    if (suite->count == 0)
        return fail(reason, STATUS_INPUT, "no trial matches '%s'%s",
                    suite->pattern ? suite->pattern : "*",
                    suite->engine.count ? " and --engine" : "");
    qsort(suite->trial, suite->count, sizeof *suite->trial, by_stage);
    return STATUS_OK;
}

struct conform_options {
    const char *pattern, *junit, *waivers, *markdown, *html;
    bool list, verbose, tap, hard, summary, quick;
    struct list engine, require;
    uint64_t count, brute;
    struct engine_options engines;
};

enum {
    OPT_LIST = 256,
    OPT_COUNT,
    OPT_BRUTE,
    OPT_ENGINE,
    OPT_REQUIRE,
    OPT_WAIVERS,
    OPT_VERBOSE,
    OPT_TAP,
    OPT_JUNIT,
    OPT_HARD,
    OPT_SUMMARY,
    OPT_QUICK,
    OPT_MARKDOWN,
    OPT_HTML
};

static const struct option long_options[] = {{"list", 0, NULL, OPT_LIST},
                                             {"count", 1, NULL, OPT_COUNT},
                                             {"brute", 1, NULL, OPT_BRUTE},
                                             {"require", 1, NULL, OPT_REQUIRE},
                                             {"engine", 1, NULL, OPT_ENGINE},
                                             {"waivers", 1, NULL, OPT_WAIVERS},
                                             {"verbose", 0, NULL, OPT_VERBOSE},
                                             {"tap", 0, NULL, OPT_TAP},
                                             {"junit", 1, NULL, OPT_JUNIT},
                                             {"hard", 0, NULL, OPT_HARD},
                                             {"summary", 0, NULL, OPT_SUMMARY},
                                             {"quick", 0, NULL, OPT_QUICK},
                                             {"markdown", 1, NULL, OPT_MARKDOWN},
                                             {"html", 1, NULL, OPT_HTML},
                                             ENGINE_OPTIONS};

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct conform_options *o = user;
    switch (option) {
    case OPT_LIST:
        o->list = true;
        break;
    case OPT_COUNT:
        return parse_count("--count", text, 1, 1u << 30, &o->count, reason);
    case OPT_BRUTE:
        return parse_count("--brute", text, 0, UINT64_MAX, &o->brute, reason);
    case OPT_ENGINE:
        return table_parse(TABLE_ENGINES, "--engine", text, &o->engine, reason);
    case OPT_REQUIRE:
        return table_parse(TABLE_ENGINES, "--require", text, &o->require, reason);
    case OPT_WAIVERS:
        o->waivers = text;
        break;
    case OPT_VERBOSE:
        o->verbose = true;
        break;
    case OPT_TAP:
        o->tap = true;
        break;
    case OPT_JUNIT:
        o->junit = text;
        break;
    case OPT_HARD:
        o->hard = true;
        break;
    case OPT_SUMMARY:
        o->hard = o->summary = true;
        break;
    case OPT_QUICK:
        o->hard = o->quick = true;
        break;
    case OPT_MARKDOWN:
        o->hard = true;
        o->markdown = text;
        break;
    case OPT_HTML:
        o->hard = true;
        o->html = text;
        break;
    default:
        return engine_option_take(option, text, &o->engines, reason);
    }
    return STATUS_OK;
}

/* Runs all trials of the suite into the report. */
static void run_suite(const struct conform_options *o, const struct suite *suite,
                      struct conform_report *report)
{
    struct stage stage = {
        .pool = {.options = o->engines}, .ray_count = (size_t)o->count, .brute_budget = o->brute};
    struct progress progress = progress_make("conform");
    for (size_t i = 0; i < suite->count; i++) {
        char name[TRIAL_NAME_MOST];
        struct row row;
        struct reason reason = {""};
        const struct trial *trial = &suite->trial[i];
        trial_print(trial, name);
        if (!o->tap)
            progress_step(&progress, "%zu of %zu: %s", i + 1, suite->count, name);
        uint64_t start = time_ns();
        enum status status = trial_stage_run(&stage, trial, &row, &reason);
        if (!o->tap)
            progress_end(&progress);
        conform_report_add(report, name, status, &row, &reason, named(&o->require, trial->engine),
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

static int conform(const struct conform_options *o)
{
    struct suite suite = {.pattern = o->pattern, .engine = o->engine};
    struct conform_report report;
    struct reason reason = {""};
    enum status status = suite_make(&suite, &reason);
    int code = EXIT_AGREE;
    if (status == STATUS_OK && !o->list) {
        status =
            conform_report_open(&report, suite.count, o->pattern == NULL && o->engine.count == 0,
                                o->waivers, o->junit, &reason);
        report.verbose = o->verbose;
        report.tap = o->tap;
        report.options = o->engines;
        if (status == STATUS_OK) {
            run_suite(o, &suite, &report);
            code = conform_report_close(&report);
        }
    } else if (status == STATUS_OK) {
        code = list_suite(&suite);
    }
    free(suite.trial);
    if (status) {
        fprintf(stderr, "raydiff conform: %s\n", reason.text);
        return exit_of_status(status);
    }
    return code;
}

static void print_help(void)
{
    fputs(help, stdout);
}

int cmd_conform(int argc, char **argv)
{
    struct conform_options o = {
        .count = 1000, .brute = 100000000, .engines = engine_options_default()};
    int first, code = options_take("conform", print_help, long_options, take_option, &o, argc, argv,
                                   &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("conform", "one pattern at a time; '%s' is a second", argv[first + 1]);
    o.pattern = first < argc ? argv[first] : NULL;
    if (o.hard || (o.pattern && strncmp(o.pattern, "hard.", 5) == 0))
        return conform_hard(&(struct conform_hard_options){.pattern = o.pattern,
                                                           .junit = o.junit,
                                                           .waivers = o.waivers,
                                                           .markdown = o.markdown,
                                                           .html = o.html,
                                                           .list = o.list,
                                                           .verbose = o.verbose,
                                                           .tap = o.tap,
                                                           .summary = o.summary,
                                                           .quick = o.quick,
                                                           .engine = o.engine,
                                                           .require = o.require,
                                                           .engines = o.engines});
    return conform(&o);
}
