/* raydiff conform: the conformance suite, its names made from the tables. */
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "cmd/conform/cmd_conform_hard.h"
#include "cmd/conform/cmd_conform_report.h"
#include "cmd/conform/cmd_conform_suite.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: raydiff conform [PATTERN] [OPTIONS]\n"
    "Runs the conformance suite. Without PATTERN a covering array: few trials such that every two\n"
    "members of different tables (engine, layout, builder, box test, triangle test, query, scene,\n"
    "ray set) meet in one; pairs that met only where nothing ran are counted. With PATTERN (shell\n"
    "wildcards) every trial of the whole product whose name matches; a complete name runs "
    "whatever\n"
    "it names, also a mesh file. A pattern without a match fails; one of fewer than nine fields\n"
    "means layouts beyond the first few only if a field names them.\n\n"
    "  name            query.engine.layout.builder.box.tri.scene.rays.seed, '-' where an engine\n"
    "                  has no tree; the name is the reproduction\n"
    "  --list          print the names, run nothing (not those that stand in for trials refused);\n"
    "                  of hard cases also how many there are, on standard error\n"
    "  --count N       rays per trial                        [1000; with --all 200]\n"
    "  --brute N       ray-triangle tests that brute force may spend      [1e8]\n"
    "  --engine E,..   only these engines; pipe:COMMAND is one, too       [all]\n"
    "  --layout L,..   only these layouts; so --builder, --box and --tri  [every]\n"
    "  --store S,..    triangle storages; others than indexed are named as in f32:compact\n"
    "                                                                     [indexed]\n"
    "  --all           every combination of members once, scenes and ray sets by turns\n"
    "  --require E,..  engines whose skips are failures; watertight: a trial fails\n"
    "                  if it loses a hit inside a closed fan\n"
    "  --displacement U  how far vertices may have to move to make an answer of an unknown "
    "formula\n"
    "                  right, in 2^-24 of their distance                  [32]\n"
    "  --hard          the hard cases, on the layouts f32, rf16 and RTRS's and the builders\n"
    "                  median and rtrs, all others by turns; or on those of --layout, --builder,\n"
    "                  --box and --tri alone (one from outside, too): names\n"
    "                  hard.NN-CASE.query.engine.layout.builder.box.tri.\n"
    "                  A PATTERN that begins with 'hard.' means them too. Not with --count,\n"
    "                  --brute, --store, --all, --displacement, --require watertight\n"
    "  --quick         without members of which two parts or more are as published\n"
    "  --summary       the hard cases as a matrix\n"
    "  --markdown FILE the matrix as Markdown\n"
    "  --html FILE     the matrix as a web page\n"
    "  --waivers FILE  lines 'PATTERN [@VERSION] REASON LINK': failures that are known\n"
    "                  [none; hard cases: those that are part of raydiff]\n"
    "  --verbose       a line per trial\n"
    "  --tap           TAP 13 on standard output\n"
    "  --junit FILE    JUnit XML\n" ENGINE_OPTIONS_HELP
    "\nexit codes: 0 passed, 1 a trial failed, 2 usage or nothing matches, 3 engine failed,\n"
    "            77 everything was skipped\n"
    "example: raydiff conform 'closest.vulkan.rf16.median.robust.woop.sphere.*'\n";

struct conform_options {
    const char *pattern, *junit, *waivers, *markdown, *html;
    bool list_only, verbose, tap, hard, summary, quick;
    struct list list[TABLE_COUNT], require;
    bool everything[TABLE_COUNT]; /* list[] is "all", so that none of it is named */
    bool all, brute_given;
    struct match_demands demands;
    uint64_t count, brute;
    struct engine_options engines;
};

enum {
    OPT_LIST = 256,
    OPT_COUNT,
    OPT_BRUTE,
    OPT_ENGINE,
    OPT_LAYOUT,
    OPT_STORE,
    OPT_BUILDER,
    OPT_BOX,
    OPT_TRI,
    OPT_ALL,
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
                                             {"layout", 1, NULL, OPT_LAYOUT},
                                             {"builder", 1, NULL, OPT_BUILDER},
                                             {"box", 1, NULL, OPT_BOX},
                                             {"tri", 1, NULL, OPT_TRI},
                                             {"all", 0, NULL, OPT_ALL},
                                             {"waivers", 1, NULL, OPT_WAIVERS},
                                             {"verbose", 0, NULL, OPT_VERBOSE},
                                             {"tap", 0, NULL, OPT_TAP},
                                             {"junit", 1, NULL, OPT_JUNIT},
                                             {"hard", 0, NULL, OPT_HARD},
                                             {"summary", 0, NULL, OPT_SUMMARY},
                                             {"quick", 0, NULL, OPT_QUICK},
                                             {"markdown", 1, NULL, OPT_MARKDOWN},
                                             {"html", 1, NULL, OPT_HTML},
                                             {"store", 1, NULL, OPT_STORE},
                                             {"displacement", 1, NULL, OPT_DISPLACEMENT},
                                             ENGINE_OPTIONS};

static enum status take_list(struct conform_options *o, enum table table, const char *flag,
                             const char *text, struct reason *reason)
{
    o->everything[table] = strcmp(text, "all") == 0 || strcmp(text, "every") == 0;
    return table_parse(table, flag, text, &o->list[table], reason);
}

/* Engines, and watertight among them, which is no engine. */
static enum status take_require(struct conform_options *o, const char *text, struct reason *reason)
{
    static const char word[] = "watertight";
    static char rest[4096];
    const size_t length = sizeof word - 1;
    const char *at = text;
    while ((at = strstr(at, word)) != NULL &&
           !((at == text || at[-1] == ',') && strchr(",", at[length])))
        at++;
    if (!at)
        return table_parse(TABLE_ENGINES, "--require", text, &o->require, reason);
    enum status status = demand_take(OPT_DEMAND, word, &o->demands, reason);
    if (status || strcmp(text, word) == 0)
        return status;
    const size_t before = (size_t)(at - text), last = at[length] == '\0';
    if (snprintf(rest, sizeof rest, "%.*s%s", (int)(before - last), text, at + length + !last) >=
        (int)sizeof rest)
        return fail(reason, STATUS_INPUT, "--require: longer than %zu characters", sizeof rest - 1);
    return table_parse(TABLE_ENGINES, "--require", rest, &o->require, reason);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct conform_options *o = user;
    switch (option) {
    case OPT_LIST:
        o->list_only = true;
        break;
    case OPT_COUNT:
        return parse_count("--count", text, 1, 1u << 30, &o->count, reason);
    case OPT_BRUTE:
        o->brute_given = true;
        return parse_count("--brute", text, 0, UINT64_MAX, &o->brute, reason);
    case OPT_ENGINE:
        return take_list(o, TABLE_ENGINES, "--engine", text, reason);
    case OPT_LAYOUT:
        return take_list(o, TABLE_LAYOUTS, "--layout", text, reason);
    case OPT_STORE:
        return take_list(o, TABLE_STORES, "--store", text, reason);
    case OPT_BUILDER:
        return take_list(o, TABLE_BUILDERS, "--builder", text, reason);
    case OPT_BOX:
        return take_list(o, TABLE_BOX_TESTS, "--box", text, reason);
    case OPT_TRI:
        return take_list(o, TABLE_TRI_TESTS, "--tri", text, reason);
    case OPT_ALL:
        o->all = true;
        break;
    case OPT_REQUIRE:
        return take_require(o, text, reason);
    case OPT_DISPLACEMENT:
        return demand_take(option, text, &o->demands, reason);
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

/* Whether a trial was judged, and whether one of an unknown formula was. */
struct use_of {
    bool judged, unknown;
};

/* Runs the trials of the suite from `first` on into the report; ran[i] is whether trial i came to
 * be judged. */
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

/* Pairs that met only where nothing ran meet once more, where the rest runs with most; what then is
 * left cannot meet. */
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
        fprintf(o->tap ? stderr : stdout,
                "%zu pairs of members met, %zu of them only in trials that were refused or "
                "skipped%s%s\n",
                pairs, unmet, unmet ? ": " : "", example);
    return status;
}

/* What was named: "all" is not. */
static void named_of(const struct conform_options *o, struct list named[TABLE_COUNT])
{
    for (enum table t = 0; t < TABLE_COUNT; t++)
        named[t] = o->everything[t] ? (struct list){.count = 0} : o->list[t];
}

static int run_and_report(const struct conform_options *o, struct suite *suite,
                          struct reason *reason)
{
    struct conform_report report;
    struct use_of use = {false, false};
    bool covering = suite->kind == SUITE_COVERING;
    bool whole = suite->kind != SUITE_PATTERN && o->list[TABLE_ENGINES].count == 0;
    bool *ran = alloc_zeroed(suite->count, sizeof *ran);
    enum status status =
        ran ? conform_report_open(&report, covering ? 0 : suite->count, whole, o->waivers, o->junit,
                                  reason)
            : fail(reason, STATUS_MEMORY, "no memory for %zu trials", suite->count);
    int code = exit_of_status(status);
    if (!status) {
        static struct list named[TABLE_COUNT];
        named_of(o, named);
        conform_report_expect(&report, named);
        report.verbose = o->verbose;
        report.tap = o->tap;
        report.options = o->engines;
        run_suite(o, suite, 0, &report, ran, &use);
        if (covering && fill_and_print(o, suite, &report, &ran, &use))
            fprintf(stderr, "raydiff conform: no memory to count pairs\n");
        code = conform_report_close(&report);
        if (o->demands.displacement > 0.0f && use.judged && !use.unknown)
            code = exit_worse(
                code,
                usage_error("conform", "--displacement: no engine here has an unknown formula"));
    } else {
        fprintf(stderr, "raydiff conform: %s\n", reason->text);
    }
    free(ran);
    return code;
}

/* -1: a trial of the suite uses what is demanded. */
static int check_demands(const struct conform_options *o, const struct suite *suite)
{
    struct reason why;
    bool used = o->demands.displacement == 0.0f;
    for (size_t i = 0; i < suite->count && !used; i++) {
        const struct list engine = list_of_engine(suite->trial[i].engine);
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
    int code;
    if (status) {
        fprintf(stderr, "raydiff conform: %s\n", reason.text);
        code = exit_of_status(status);
    } else {
        code = check_demands(o, &suite);
        if (code < 0)
            code = o->list_only ? list_suite(&suite) : run_and_report(o, &suite, &reason);
    }
    suite_free(&suite);
    return code;
}

static void print_help(void)
{
    fputs(help, stdout);
}

/* A trial's whole name says who plays; members from outside are brought by options. */
static int check_name(const struct conform_options *o)
{
    struct list engine, layout = {.count = 0};
    struct trial trial;
    struct reason why;
    char never[100];
    if (trial_parse(o->pattern, &trial, &why))
        return -1; /* it is no name, as is said later */
    engine = list_of_engine(trial.engine);
    const bool outside = trial.layout && trial.layout->outside;
    snprintf(never, sizeof never, "%s%s store builder box tri hard quick summary markdown html",
             engine_is_peer(trial.engine) ? "" : "engine ", outside ? "" : "layout");
    const struct option_use use = {.by = "a trial's whole name",
                                   .never = never,
                                   .engine = &engine,
                                   .layout = outside ? &o->list[TABLE_LAYOUTS] : &layout};
    return options_refused("conform", &use);
}

/* What was named that this run does not use. -1: nothing. */
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
                   "html threads driver device workgroup peer-time peer-memory"
                 : ""},
        {.by = "a PATTERN, whose trials are all played", .never = o->pattern ? "all" : ""},
        {.by = "--tap, which has a line per trial", .never = o->tap ? "verbose summary" : ""},
        {.engine = o->list[TABLE_ENGINES].count ? &o->list[TABLE_ENGINES] : &engine,
         .layout = o->list[TABLE_LAYOUTS].count ? &o->list[TABLE_LAYOUTS] : &layout},
    };
    int code = named ? check_name(o) : -1;
    for (size_t i = 0; i < ARRAY_COUNT(modes) - named && code < 0; i++)
        code = options_refused("conform", &modes[i]);
    return code;
}

int cmd_conform(int argc, char **argv)
{
    struct conform_options o = {.brute = 100000000, .engines = engine_options_default()};
    int first, code = options_take("conform", print_help, long_options, take_option, &o, argc, argv,
                                   &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("conform", "one pattern at a time; '%s' is a second", argv[first + 1]);
    o.pattern = first < argc ? argv[first] : NULL;
    for (size_t i = 0; i < o.require.count; i++) {
        const struct engine *engine = engines[o.require.index[i]];
        if (o.list[TABLE_ENGINES].count > 0 && !list_names(&o.list[TABLE_ENGINES], engine))
            return usage_error("conform", "--require %s: --engine leaves it out", engine->name);
    }
    bool hard = o.hard || (o.pattern && strncmp(o.pattern, "hard.", 5) == 0);
    static struct list named[TABLE_COUNT];
    named_of(&o, named);
    code = check_use(&o, hard);
    if (code >= 0)
        return code;
    if (hard && o.demands.watertight)
        return usage_error("conform", "--require watertight: not used by the hard cases");
    if (hard)
        return conform_hard(&(struct conform_hard_options){.pattern = o.pattern,
                                                           .junit = o.junit,
                                                           .waivers = o.waivers,
                                                           .markdown = o.markdown,
                                                           .html = o.html,
                                                           .list = o.list_only,
                                                           .verbose = o.verbose,
                                                           .tap = o.tap,
                                                           .summary = o.summary,
                                                           .quick = o.quick,
                                                           .engine = o.list[TABLE_ENGINES],
                                                           .list_of = o.list,
                                                           .named = named,
                                                           .require = o.require,
                                                           .engines = o.engines});
    if (o.count == 0)
        o.count = o.all && !o.pattern ? 200 : 1000;
    return conform(&o);
}
