/* raydiff fuzz: runs a campaign on this machine. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_fuzz.h"
#include "cmd/fuzz/cmd_selftest.h"

#include "gpu/build/device_builders.h"
#include "fuzz/play/fuzz_turns.h"
#include "gpu/engines/compiled.h"
#include "ref/outside/plugin_guard.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

static enum status make_rules(struct fuzz_command *c, struct reason *reason)
{
    struct work_rules *rules = &c->campaign.rules;
    const struct engine *engine[LIST_MOST];
    const struct layout *layout[LIST_MOST];
    list_engines(&c->engine, engine);
    list_layouts(&c->layout, layout);
    rules->builder_count = c->builder.count;
    for (size_t i = 0; i < c->builder.count; i++)
        rules->builder[i] = builders_all[c->builder.index[i]];
    rules->seed = c->seed;
    rules->gen = (struct gen_options){.triangles_least = c->triangles_least,
                                      .triangles_most = c->triangles_most,
                                      .rays = c->rays,
                                      .faithful = c->faithful,
                                      .worlds = c->worlds,
                                      .steps = c->steps};
    rules->corpus = c->corpus_trials.trial;
    rules->corpus_count = c->corpus_trials.count;
    c->engines.threads = 1;
    c->engines.driver = c->driver[0] ? c->driver : NULL;
    if (!c->engines.peer_ms) /* a peer times out before its worker does */
        c->engines.peer_ms = (uint32_t)(c->trial_s * 1e3);
    plugin_limits(c->engines.peer_ms, c->engines.peer_mb);
    enum status status =
        c->pairs > 0 ? fuzz_field_draw(engine, c->engine.count, &c->engines, &rules->field, reason)
                     : fuzz_field_make(engine, c->engine.count, layout, c->layout.count,
                                       &c->engines, &rules->field, reason);
    if (!status && c->turns && fuzz_turns_share(&rules->field, compiled_other_memory) == 0)
        status = fail(reason, STATUS_INPUT,
                      "--turns: not used here: no two engines differ only in --buffers");
    return status ? status : fuzz_pairs_make(c, reason);
}

static enum status make_campaign(struct fuzz_command *c, struct reason *reason)
{
    bool sharded = c->shards > 0;
    struct campaign_options *o = &c->campaign;
    o->folder = c->folder;
    o->identity = c->identity;
    o->trials = c->trials;
    o->seconds = c->trials > 0 && !option_was_given("time") ? 0 : c->seconds;
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

/* Drops trials of scenes in a campaign of worlds and the other way round, and unless members as
 * published take part, those that use them: their faults are known. */
static void keep_fitting(const struct fuzz_command *c, struct feedback_list *list)
{
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct fuzz_trial *trial = &list->trial[i];
        bool faithful = trial->builder->faithful || trial->box->faithful || trial->tri->faithful;
        if (trial->world.is != c->worlds || (faithful && !c->faithful))
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

/* Without --corpus the folder may be missing: an installed program has no corpus. */
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
    if (!status)
        keep_fitting(c, &c->corpus_trials);
    return status;
}

/* Reports files that cannot be written before the campaign instead of after it. */
static enum status try_outputs(const struct fuzz_command *c, struct reason *reason)
{
    const char *const path[] = {c->json, c->junit, c->tap, c->jsonl};
    bool there;
    enum status status = folder_has(findings_folder(c->findings), "stats.json", &there, reason);
    for (size_t i = 0; i < ARRAY_COUNT(path) && !status; i++)
        status = output_try(path[i], reason);
    return status;
}

/* Findings name their engine. */
static enum status check_names(const struct fuzz_command *c, struct reason *reason)
{
    for (size_t i = 0; i < c->engine.count; i++) {
        const char *name = engines[c->engine.index[i]]->name;
        if (!fuzz_signature_holds(name))
            return fail(reason, STATUS_INPUT,
                        "%.40s...: findings hold engines' names of up to %zu characters, this has "
                        "%zu",
                        name, sizeof((struct fuzz_signature *)0)->engine - 2, strlen(name));
    }
    return STATUS_OK;
}

/* What is wrong without looking into the folder of findings, which is not made then. */
static enum status check_options(const struct fuzz_command *c, struct reason *reason)
{
    struct stat what;
    if (c->pairs > 0 && (c->shards > 0 || c->feedback || names_corpus(c)))
        return fail(reason, STATUS_INPUT,
                    "--pairs: draws members at random, so not with --shard, --feedback or "
                    "--corpus");
    if (c->pairs > 0 && c->turns)
        return fail(reason, STATUS_INPUT, "--turns: not used with --pairs, which draws engines");
    if (c->pairs > 0 && c->worlds)
        return fail(reason, STATUS_INPUT,
                    "--pairs: draws members for scenes, so not with --worlds");
    if (c->steps && c->pairs > 0)
        return fail(reason, STATUS_INPUT, "--steps: not used with --pairs, which draws motions");
    if (names_corpus(c) && (stat(c->corpus, &what) != 0 || !S_ISDIR(what.st_mode)))
        return fail(reason, STATUS_INPUT, "--corpus: %.200s is no folder", c->corpus);
    return check_names(c, reason);
}

/* Engines that trace scenes alone have no part in a campaign of worlds. */
static enum status check_engines(const struct fuzz_command *c, struct reason *reason)
{
    for (size_t i = 0; i < c->engine.count && c->worlds; i++) {
        const struct engine *engine = engines[c->engine.index[i]];
        void *self = NULL;
        if (!engine->worlds)
            return fail(reason, STATUS_UNSUPPORTED, "%.80s traces scenes, not worlds",
                        engine->name);
        if (!engine->worlds->traces)
            continue;
        enum status status = engine_open(engine, &c->engines, &self, reason);
        const bool traces = !status && engine_traces_worlds(engine, self);
        engine->close(self);
        if (status || !traces)
            return status
                       ? status
                       : fail(reason, STATUS_UNSUPPORTED,
                              "%.80s traces scenes, not worlds: its flags have no 8", engine->name);
    }
    return STATUS_OK;
}

static enum status prepare(struct fuzz_command *c, struct reason *reason)
{
    enum status status = check_options(c, reason);
    if (!status)
        status = findings_open(c->folder, &c->findings, reason);
    if (!status && findings_said(c->findings)[0])
        fprintf(stderr, "raydiff fuzz: %s\n", findings_said(c->findings));
    if (!status)
        status = try_outputs(c, reason); /* after findings_open: some may be in its folder */
    if (!status)
        status = fuzz_identify(c, reason);
    if (!status) {
        const struct list own = table_all(TABLE_ENGINES);
        const struct option_use use = {.engine = option_was_given("engine") ? &c->engine : &own,
                                       .layout = &c->layout,
                                       .builder = &c->builder,
                                       .unnamed = !option_was_given("engine"),
                                       .seeded = true};
        device_builders_use(&c->engines);
        status = options_check(&use, reason);
    }
    if (!status)
        status = check_options(c, reason); /* with those of the folder */
    if (!status)
        status = check_engines(c, reason);
    if (!status)
        status = read_corpus(c, reason);
    if (!status)
        status = make_campaign(c, reason);
    return status;
}

/* The screen is redrawn in place, which a dumb terminal does not support. */
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
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) /* not under nohup */
        sigaction(SIGHUP, &action, NULL);
}

static int finish(struct fuzz_command *c, enum status status, const struct reason *reason)
{
    fuzz_show_end(c);
    const int code = exit_with_reason("fuzz", status, reason);
    findings_close(c->findings);
    feedback_list_free(&c->corpus_trials);
    pair_coverage_close(c->pair_coverage);
    baseline_close(&c->baseline);
    return status ? code : c->code;
}

/* Without --engine those of the default engines that have shaders. Returns -1 to continue. */
static int apply_compilers(struct fuzz_command *c)
{
    struct reason reason;
    const bool named = option_was_given("engine");
    if ((c->compilers.list || c->compilers.memory) && !named &&
        table_parse(TABLE_ENGINES, "--engine", FUZZ_ENGINES, &c->engine, &reason))
        return usage_error("fuzz", "%s", reason.text);
    return compilers_apply("fuzz", &c->compilers, named, &c->engine);
}

int cmd_fuzz(int argc, char **argv)
{
    static struct fuzz_command c;
    struct reason reason = {""};
    if (argc > 1 && strcmp(argv[1], "--self-test") == 0)
        return cmd_selftest(argc - 1, argv + 1);
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    c = (struct fuzz_command){.engines = engine_options_default(), .terminal = has_screen()};
    c.jobs = cores < 1 ? 1 : cores > CAMPAIGN_JOBS_MOST ? CAMPAIGN_JOBS_MOST : (uint32_t)cores;
    baseline_today(c.today);
    if (baseline_open(&c.baseline, &reason))
        return finish(&c, STATUS_INTERNAL, &reason);
    int first, code = options_read(&fuzz_set, &c, argc, argv, &first);
    if (code < 0 && first < argc)
        code = usage_error("fuzz", "'%s': only options are expected", argv[first]);
    if (code < 0)
        code = apply_compilers(&c);
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
