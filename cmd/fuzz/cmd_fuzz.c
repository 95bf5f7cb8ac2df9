/* raydiff fuzz: a campaign on this machine. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_fuzz.h"
#include "cmd/fuzz/cmd_selftest.h"

#include "ref/outside/plugin_guard.h"
#include "fuzz/findings/findings_report.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEFAULT_SECONDS 60u

static const char help[] =
    "usage: raydiff fuzz [OPTIONS]\n"
    "Plays random trials on engines and layouts, and keeps what they get wrong: a folder for each\n"
    "distinct finding, with the first and the smallest trial that shows it. A folder that is "
    "there\n"
    "is resumed, also after a kill; its campaign's options need not be given again.\n\n"
    "  --time S          seconds of this run                    [60; none with --trials]\n"
    "  --trials N        trials of the whole campaign, the same on any number of workers\n"
    "  --until N         end after N distinct findings that the baseline does not know\n"
    "  --dir DIR         where findings are kept                [findings]\n"
    "  --seed S          of the campaign                        [1]\n"
    "  --jobs N          worker processes                       [cores]\n"
    "  --shard I/N       only the blocks of shard I of N; join with raydiff merge\n"
    "  --engine E,...    engines, also pipe:COMMAND             [cpu,vulkan,embree_robust]\n"
    "  --layout L,...    layouts                                [f32,rf16]\n"
    "  --builder B,...   builders                               [as generated]\n"
    "  --faithful        builders and tests as published take part, too\n"
    "  --rays N          rays of a trial                        [500]\n"
    "  --triangles A-B   triangles of an ordinary trial         [16-64]\n"
    "  --corpus DIR      trials that are played first; none     [fuzz/corpus]\n"
    "  --feedback        mutate what reached rare states also with --trials or --shard\n"
    "  --pairs N         draws members anew for each block: those of the pair (of engine, layout,\n"
    "                    builder, storage, triangle test, box test, reinsertion, motion) that met\n"
    "                    in the fewest trials; every pair is to meet in N\n"
    "  --no-shrink       leave findings as they are (raydiff min shrinks them later)\n"
    "  --baseline FILE   known findings, besides those that are part of raydiff\n"
    "  --trial-time S    seconds that an engine may take for a trial  [10]\n"
    "  --memory MIB      that a worker may hold, 0 is no limit  [4096]\n"
    "  --driver NAME, --device N, --workgroup N, --peer-time S, --peer-memory MB, --shader FILE\n"
    "                    of engines and layouts from outside, as in raydiff check\n"
    "  --json FILE, --junit FILE, --tap FILE, --jsonl FILE\n"
    "                    results, for machines\n"
    "  --self-test       is every planted bug found? (raydiff fuzz --self-test --help)\n\n"
    "exit codes: 0 nothing that the baseline does not know, 1 a finding outside it or a pair that\n"
    "            met in fewer than --pairs, 2 bad input,\n"
    "            3 an engine cannot be opened, 4 internal error, 77 an engine cannot run here,\n"
    "            128 + the signal that ended it before all of --trials were played and shrunk;\n"
    "            run again, the campaign ends as one that nothing interrupted\n"
    "example: raydiff fuzz --time 60\n"
    "         raydiff fuzz --time 3600 --pairs 1000\n";

enum {
    OPT_TIME = 256,
    OPT_TRIALS,
    OPT_UNTIL,
    OPT_DIR,
    OPT_JOBS,
    OPT_CORPUS,
    OPT_FEEDBACK,
    OPT_NO_SHRINK,
    OPT_BASELINE,
    OPT_TRIAL_TIME,
    OPT_MEMORY,
    OPT_JSON,
    OPT_JUNIT,
    OPT_TAP,
    OPT_JSONL,
    OPT_KEYS, /* + enum fuzz_key */
};

static const struct option long_options[] = {{"time", 1, NULL, OPT_TIME},
                                             {"trials", 1, NULL, OPT_TRIALS},
                                             {"until", 1, NULL, OPT_UNTIL},
                                             {"dir", 1, NULL, OPT_DIR},
                                             {"jobs", 1, NULL, OPT_JOBS},
                                             {"corpus", 1, NULL, OPT_CORPUS},
                                             {"feedback", 0, NULL, OPT_FEEDBACK},
                                             {"no-shrink", 0, NULL, OPT_NO_SHRINK},
                                             {"baseline", 1, NULL, OPT_BASELINE},
                                             {"trial-time", 1, NULL, OPT_TRIAL_TIME},
                                             {"memory", 1, NULL, OPT_MEMORY},
                                             {"json", 1, NULL, OPT_JSON},
                                             {"junit", 1, NULL, OPT_JUNIT},
                                             {"tap", 1, NULL, OPT_TAP},
                                             {"jsonl", 1, NULL, OPT_JSONL},
                                             {"seed", 1, NULL, OPT_KEYS + KEY_SEED},
                                             {"shard", 1, NULL, OPT_KEYS + KEY_SHARD},
                                             {"engine", 1, NULL, OPT_KEYS + KEY_ENGINE},
                                             {"layout", 1, NULL, OPT_KEYS + KEY_LAYOUT},
                                             {"builder", 1, NULL, OPT_KEYS + KEY_BUILDER},
                                             {"faithful", 0, NULL, OPT_KEYS + KEY_FAITHFUL},
                                             {"rays", 1, NULL, OPT_KEYS + KEY_RAYS},
                                             {"triangles", 1, NULL, OPT_KEYS + KEY_TRIANGLES},
                                             {"driver", 1, NULL, OPT_KEYS + KEY_DRIVER},
                                             {"device", 1, NULL, OPT_KEYS + KEY_DEVICE},
                                             {"workgroup", 1, NULL, OPT_KEYS + KEY_WORKGROUP},
                                             {"pairs", 1, NULL, OPT_KEYS + KEY_PAIRS},
                                             {"shader", 1, NULL, OPT_SHADER},
                                             {"peer-time", 1, NULL, OPT_PEER_TIME},
                                             {"peer-memory", 1, NULL, OPT_PEER_MEMORY},
                                             {"help", 0, NULL, OPT_HELP},
                                             {NULL, 0, NULL, 0}};

static void print_help(void)
{
    fputs(help, stdout);
}

static enum status take_number(struct fuzz_command *c, int option, const char *text,
                               struct reason *reason)
{
    uint64_t value = 0;
    float real = 0;
    enum status status = STATUS_OK;
    switch (option) {
    case OPT_TIME:
        c->seconds_given = true;
        return parse_count("--time", text, 1, 1000000000, &c->seconds, reason);
    case OPT_TRIALS:
        return parse_count("--trials", text, 1, (uint64_t)1 << 60, &c->trials, reason);
    case OPT_UNTIL:
        status = parse_count("--until", text, 1, 1000000, &value, reason);
        c->until = (uint32_t)value;
        return status;
    case OPT_JOBS:
        status = parse_count("--jobs", text, 1, CAMPAIGN_JOBS_MOST, &value, reason);
        c->jobs = (uint32_t)value;
        return status;
    case OPT_MEMORY:
        return parse_count("--memory", text, 0, (uint64_t)1 << 30, &c->memory_mib, reason);
    default: /* OPT_TRIAL_TIME */
        status = parse_float("--trial-time", text, &real, reason);
        if (!status && !(real >= 0.1f && real <= 86400.0f))
            status =
                fail(reason, STATUS_INPUT, "--trial-time: '%.40s' is not in [0.1, 86400]", text);
        c->trial_s = (double)real;
        return status;
    }
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct fuzz_command *c = user;
    if (option >= OPT_KEYS && option < OPT_KEYS + KEY_COUNT) {
        c->given[option - OPT_KEYS] = true;
        return fuzz_key_set(c, (enum fuzz_key)(option - OPT_KEYS), text ? text : "yes", reason);
    }
    switch (option) {
    case OPT_DIR:
        c->folder = text;
        return STATUS_OK;
    case OPT_CORPUS:
        c->corpus = text;
        return STATUS_OK;
    case OPT_FEEDBACK:
        c->feedback = true;
        return STATUS_OK;
    case OPT_NO_SHRINK:
        c->no_shrink = true;
        return STATUS_OK;
    case OPT_BASELINE:
        return baseline_add_file(&c->baseline, text, reason);
    case OPT_JSON:
        c->json = text;
        return STATUS_OK;
    case OPT_JUNIT:
        c->junit = text;
        return STATUS_OK;
    case OPT_TAP:
        c->tap = text;
        return STATUS_OK;
    case OPT_JSONL:
        c->jsonl = text;
        return STATUS_OK;
    case OPT_SHADER:
    case OPT_PEER_TIME:
    case OPT_PEER_MEMORY:
        return engine_option_take(option, text, &c->engines, reason);
    default:
        return take_number(c, option, text, reason);
    }
}

static volatile sig_atomic_t stop, signalled;

static void on_signal(int number)
{
    signalled = number;
    stop = stop ? 2 : 1;
}

static bool is_known(void *user, const struct findings_entry *entry)
{
    struct fuzz_command *c = user;
    struct baseline_answer answer;
    baseline_ask(&c->baseline, &entry->signature, entry->versions, c->today, &answer);
    return answer.state == BASELINE_KNOWN;
}

/* The rules of the campaign. */
static enum status make_rules(struct fuzz_command *c, struct reason *reason)
{
    struct work_rules *rules = &c->campaign.rules;
    const struct engine *engine[LIST_MOST];
    const struct layout *layout[LIST_MOST];
    for (size_t i = 0; i < c->engine.count; i++)
        engine[i] = engines[c->engine.index[i]];
    for (size_t i = 0; i < c->layout.count; i++)
        layout[i] = layouts_all[c->layout.index[i]];
    rules->builder_count = c->builder.count;
    for (size_t i = 0; i < c->builder.count; i++)
        rules->builder[i] = builders_all[c->builder.index[i]];
    rules->seed = c->seed;
    rules->gen = (struct gen_options){.triangles_least = c->triangles_least,
                                      .triangles_most = c->triangles_most,
                                      .rays = c->rays,
                                      .faithful = c->faithful};
    rules->corpus = c->corpus_trials.trial;
    rules->corpus_count = c->corpus_trials.count;
    c->engines.threads = 1;
    c->engines.driver = c->driver[0] ? c->driver : NULL;
    if (!c->engines.peer_ms) /* a peer's time is over before its worker's is */
        c->engines.peer_ms = (uint32_t)(c->trial_s * 1e3);
    plugin_limits(c->engines.peer_ms, c->engines.peer_mb);
    enum status status =
        c->pairs > 0 ? fuzz_field_draw(engine, c->engine.count, &c->engines, &rules->field, reason)
                     : fuzz_field_make(engine, c->engine.count, layout, c->layout.count,
                                       &c->engines, &rules->field, reason);
    return status ? status : fuzz_pairs_make(c, reason);
}

static enum status make_campaign(struct fuzz_command *c, struct reason *reason)
{
    bool sharded = c->shards > 0;
    struct campaign_options *o = &c->campaign;
    o->folder = c->folder;
    o->identity = c->identity;
    o->trials = c->trials;
    o->seconds = c->trials > 0 && !c->seconds_given ? 0 : c->seconds;
    o->shard = sharded ? c->shard : 1;
    o->shards = sharded ? c->shards : 1;
    o->jobs = c->jobs;
    o->mutate = c->feedback || (c->trials == 0 && !sharded && c->pairs == 0);
    o->shrink = c->no_shrink || sharded ? CAMPAIGN_SHRINK_NEVER
                : c->trials > 0         ? CAMPAIGN_SHRINK_AT_END
                                        : CAMPAIGN_SHRINK_SOON;
    o->until = c->until;
    o->trial_ms = (uint32_t)(c->trial_s * 1e3);
    o->memory_bytes = c->memory_mib << 20;
    o->is_known = is_known;
    o->tick = fuzz_show;
    o->user = c;
    o->stop = &stop;
    c->signalled = &signalled;
    enum status status = make_rules(c, reason);
    o->pair_coverage = c->pair_coverage;
    return status;
}

/* Leaves out trials of members as published, whose faults are known. */
static void keep_repaired(struct feedback_list *list)
{
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct fuzz_trial *trial = &list->trial[i];
        if (trial->builder->faithful || trial->box->faithful || trial->tri->faithful)
            fuzz_trial_free(&list->trial[i]);
        else
            list->trial[kept++] = list->trial[i];
    }
    list->count = kept;
}

static bool names_corpus(const struct fuzz_command *c)
{
    return c->corpus && strcmp(c->corpus, "none") != 0;
}

/* If no folder is named there may be none: an installed program has no corpus. */
static enum status read_corpus(struct fuzz_command *c, struct reason *reason)
{
    const char *folder = c->corpus ? c->corpus : "fuzz/corpus";
    struct folder open;
    struct stat what;
    if (c->pairs > 0 || (c->corpus && !names_corpus(c)))
        return STATUS_OK;
    if (stat(folder, &what) != 0 || !S_ISDIR(what.st_mode))
        return c->corpus ? fail(reason, STATUS_INPUT, "--corpus: %.200s is no folder", folder)
                         : STATUS_OK;
    enum status status = folder_open(folder, false, &open, reason);
    if (!status)
        status = feedback_load(&open, FEEDBACK_BYTES, &c->corpus_trials, reason);
    folder_close(&open);
    if (!status && c->corpus_trials.left_out > 0)
        fprintf(stderr, "raydiff fuzz: corpus: %zu files left out: %s\n", c->corpus_trials.left_out,
                c->corpus_trials.said.text);
    if (!status && !c->faithful)
        keep_repaired(&c->corpus_trials);
    return status;
}

/* So that a file that cannot be written is told before a night's work, not after it. */
static enum status try_outputs(const struct fuzz_command *c, struct reason *reason)
{
    const char *const path[] = {c->json, c->junit, c->tap, c->jsonl};
    bool there;
    enum status status = folder_has(findings_folder(c->findings), "stats.json", &there, reason);
    for (size_t i = 0; i < ARRAY_COUNT(path) && !status; i++)
        status = output_try(path[i], reason);
    return status;
}

static enum status prepare(struct fuzz_command *c, struct reason *reason)
{
    enum status status = findings_open(c->folder, &c->findings, reason);
    if (!status && findings_said(c->findings)[0])
        fprintf(stderr, "raydiff fuzz: %s\n", findings_said(c->findings));
    if (!status)
        status = try_outputs(c, reason); /* some may be in the folder */
    if (!status)
        status = fuzz_identify(c, reason);
    if (!status) {
        const struct list own = table_all(TABLE_ENGINES);
        const struct option_use use = {.engine = c->given[KEY_ENGINE] ? &c->engine : &own,
                                       .layout = &c->layout,
                                       .seeded = true};
        status = options_check(&use, reason);
    }
    if (!status && c->pairs > 0 && (c->shards > 0 || c->feedback || names_corpus(c)))
        status = fail(reason, STATUS_INPUT,
                      "--pairs: members are drawn, not with --shard, --feedback or --corpus");
    if (!status)
        status = read_corpus(c, reason);
    if (!status)
        status = make_campaign(c, reason);
    return status;
}

/* A screen is drawn again and again; a dumb terminal cannot. */
static bool has_screen(void)
{
    const char *kind = getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && kind && strcmp(kind, "dumb") != 0;
}

static void catch_signals(void)
{
    struct sigaction before, action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) /* as by nohup */
        sigaction(SIGHUP, &action, NULL);
}

static int finish(struct fuzz_command *c, enum status status, const struct reason *reason)
{
    fuzz_show_end(c);
    if (status)
        fprintf(stderr, "raydiff fuzz: %s\n", reason->text);
    findings_close(c->findings);
    feedback_list_free(&c->corpus_trials);
    pair_coverage_close(c->pair_coverage);
    baseline_close(&c->baseline);
    return status ? exit_of_status(status) : c->code;
}

int cmd_fuzz(int argc, char **argv)
{
    static struct fuzz_command c;
    struct reason reason = {""};
    if (argc > 1 && strcmp(argv[1], "--self-test") == 0)
        return cmd_selftest(argc - 1, argv + 1);
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    int first;
    c = (struct fuzz_command){.seed = 1,
                              .rays = 500,
                              .triangles_least = 16,
                              .triangles_most = 64,
                              .seconds = DEFAULT_SECONDS,
                              .trial_s = 10,
                              .memory_mib = 4096,
                              .folder = "findings",
                              .engines = engine_options_default(),
                              .terminal = has_screen()};
    c.jobs = cores < 1 ? 1 : cores > CAMPAIGN_JOBS_MOST ? CAMPAIGN_JOBS_MOST : (uint32_t)cores;
    baseline_today(c.today);
    if (baseline_open(&c.baseline, &reason))
        return finish(&c, STATUS_INTERNAL, &reason);
    int code = options_take("fuzz", print_help, long_options, take_option, &c, argc, argv, &first);
    if (code < 0 && first < argc)
        code = usage_error("fuzz", "'%s': only options are expected", argv[first]);
    if (code >= 0) {
        baseline_close(&c.baseline);
        return code;
    }
    enum status status = prepare(&c, &reason);
    if (!status) {
        catch_signals();
        status = campaign_run(&c.campaign, c.findings, fuzz_report, &reason);
    }
    if (!status && c.failed_status) {
        status = c.failed_status;
        reason = c.failed;
    }
    return finish(&c, status, &reason);
}
