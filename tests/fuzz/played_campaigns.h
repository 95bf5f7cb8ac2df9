/* Campaigns that are really played, on engine cpu and one that dies as planned. Include after
 * cmocka.h, fuzz/campaign/campaign.h, ref/base/rng.h, ref/trace/trace.h, ref/files/file.h and
 * stdatomic.h; needs _GNU_SOURCE. */
#ifndef TESTS_PLAYED_CAMPAIGNS_H
#define TESTS_PLAYED_CAMPAIGNS_H

#include "tests/fuzz/campaigns.h"

#include <signal.h>
#include <time.h>

#define TRIALS       640u
#define PLAN_WORK_MS 60

/* --- an engine that dies ---------------------------------------------------------------------- */

enum plan {
    PLAN_LIVE,
    PLAN_DIE,
    PLAN_HANG,
    PLAN_ONCE,
    PLAN_MISS_ONCE,
    PLAN_EAT,
    PLAN_STOP,
    PLAN_STOP_ONCE,
    PLAN_WORK, /* PLAN_WORK_MS of a processor's time */
    PLAN_NEVER_OPEN,
    PLAN_DIE_OPEN
};
static enum plan plan;
static atomic_uint *deaths; /* shared */
static struct job given;

static enum status fragile_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *why)
{
    (void)engine, (void)options;
    *self = &given;
    if (plan == PLAN_DIE_OPEN)
        _exit(7);
    return plan == PLAN_NEVER_OPEN ? (fail)(why, STATUS_UNSUPPORTED, "not on this machine")
                                   : STATUS_OK;
}

static enum status fragile_prepare(void *self, const struct job *job, struct reason *why)
{
    (void)self;
    (void)why;
    given = *job;
    return STATUS_OK;
}

static bool work(void)
{
    clock_t start = clock();
    while ((double)(clock() - start) < 1e-3 * PLAN_WORK_MS * CLOCKS_PER_SEC)
        ;
    return false;
}

/* What the plan has for some scenes on layout f32. True: to miss every triangle. */
static bool act(void)
{
    /* The first of these scenes is none that the other layout cannot hold. */
    bool scene = given.scene->tri_count % 16 == (plan == PLAN_MISS_ONCE ? 14 : 5);
    bool now = scene && given.packed->layout == layout_find("f32");
    if (plan == PLAN_MISS_ONCE && scene && !now)
        return true; /* every time */
    bool once = plan == PLAN_ONCE || plan == PLAN_MISS_ONCE || plan == PLAN_STOP_ONCE;
    if (plan == PLAN_LIVE || !now || (once && atomic_load(deaths) > 0))
        return false;
    atomic_fetch_add(deaths, 1);
    if (plan == PLAN_MISS_ONCE)
        return true;
    if (plan == PLAN_WORK)
        return work();
    if (plan == PLAN_STOP || plan == PLAN_STOP_ONCE)
        return raise(SIGSTOP) != 0;
    if (plan == PLAN_HANG)
        for (;;)
            pause();
    if (plan == PLAN_EAT) {
        size_t bytes = (size_t)600 << 20;
        char *much = malloc(bytes);
        for (size_t i = 0; much && i < bytes; i += 4096)
            *(volatile char *)(much + i) = 1;
        for (;;)
            pause();
    }
    _exit(3);
}

static enum status fragile_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *why)
{
    (void)self;
    (void)report;
    (void)why;
    bool blind = act();
    for (size_t i = 0; i < count; i++)
        if (blind)
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        else if (trace_ray(&(struct job){.scene = given.scene,
                                         .packed = given.packed,
                                         .box = given.box,
                                         .tri = given.tri,
                                         .query = given.query},
                           &ray[i], &hit[i], NULL))
            return STATUS_DEVICE;
    return STATUS_OK;
}

static struct model fragile_model(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    (void)engine, (void)self;
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = ROUNDING_IEEE,
                          .watertight = tri->watertight,
                          .open = tri->open};
}

static void fragile_close(void *self)
{
    (void)self;
}

static void fragile_describe(const struct engine *engine, const struct engine_options *options,
                             char *text, size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, "fragile 1");
}

static const struct engine fragile = {.name = "fragile",
                                      .needs_packed = true,
                                      .open = fragile_open,
                                      .prepare = fragile_prepare,
                                      .trace = fragile_trace,
                                      .model = fragile_model,
                                      .close = fragile_close,
                                      .describe = fragile_describe};

/* --- running one ------------------------------------------------------------------------------ */

/* The last view, but what it points to. */
static struct campaign_view last;
static struct campaign_mark marks[200];
static size_t last_news, last_flaky;

static void remember(void *user, const struct campaign_view *view)
{
    (void)user;
    last = *view;
    last_news = campaign_news(view, &last_flaky);
    memcpy(marks, view->mark, findings_count(view->findings) * sizeof *marks);
}

/* Engine cpu, and the fragile one if asked, on a layout that is wrong in many ways and a right one.
 */
static inline struct campaign_options options_of(const char *folder, bool with_fragile)
{
    const struct engine *engine[] = {engine_find("cpu"), &fragile};
    const struct layout *layout[] = {layout_find("f32"), layout_find("rtrs_rf")};
    const struct engine_options how = {.device = -1, .threads = 1};
    struct campaign_options options = {
        .folder = folder,
        .identity = "gen=test",
        .trials = TRIALS,
        .shard = 1,
        .shards = 1,
        .jobs = 1,
        .trial_ms = 500,
        .rules = {
            .seed = 5,
            .gen = {.triangles_least = 16, .triangles_most = 64, .rays = 12, .faithful = true}}};
    if (fuzz_field_make(engine, with_fragile ? 2 : 1, layout, 2, &how, &options.rules.field,
                        &reason))
        fail_msg("%s", reason.text);
    return options;
}

static inline enum status run(const struct campaign_options *options)
{
    struct findings *findings;
    mkdir(options->folder, 0777);
    enum status status = findings_open(options->folder, &findings, &reason);
    if (status)
        return status;
    status = campaign_run(options, findings, remember, &reason);
    findings_close(findings);
    return status;
}

static inline void assert_run(const struct campaign_options *options)
{
    reason.text[0] = '\0';
    if (run(options))
        fail_msg("%s", reason.text);
}

/* Merged alone, a folder is in the form in which folders are compared. */
static inline const char *normal(const char *folder)
{
    static char to[8][500];
    static int next, made_normal;
    next = (next + 1) % 8;
    snprintf(to[next], sizeof to[next], "%.400s-normal%d", folder, ++made_normal);
    assert_merge(&folder, 1, to[next]);
    return to[next];
}

static inline size_t distinct(const char *folder)
{
    struct findings *findings = look(folder);
    size_t count = findings_count(findings);
    assert_true(count > 3); /* or there is nothing to compare */
    findings_close(findings);
    return count;
}

#endif
