/* An engine that does what a test tells it. Include after cmocka.h. */
#ifndef TESTS_MADE_UP_H
#define TESTS_MADE_UP_H

#include "ref/engines/cpu_rays.h"
#include "ref/trace/trace.h"

#include "tests/support/matched.h"

/* What the made-up engine does next, and what was done to it. */
static struct script {
    enum status open, prepare, trace;
    void (*spoil)(const struct match *match, struct hit *hit);
    const struct match *match;
    const struct job *job;
    unsigned opened, prepared, traced, closed;
} script;

static inline enum status act(enum status status, const char *what, struct reason *reason)
{
    /* In parentheses, since CMocka has a macro of that name. */
    return status ? (fail)(reason, status, "made up: %s", what) : STATUS_OK;
}

static enum status made_up_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *reason)
{
    (void)engine, (void)options;
    script.opened++;
    *self = script.open ? NULL : &script;
    return act(script.open, "open", reason);
}

static enum status made_up_prepare(void *self, const struct job *job, struct reason *reason)
{
    assert_ptr_equal(self, &script);
    script.prepared++;
    script.job = job;
    return act(script.prepare, "prepare", reason);
}

static enum status made_up_trace(void *self, const struct ray *ray, size_t ray_count,
                                 struct hit *hit, struct trace_report *report,
                                 struct reason *reason)
{
    const struct match *match = script.match;
    assert_ptr_equal(self, &script);
    script.traced++;
    *report = (struct trace_report){.ns = 1000, .memory_bytes = 77, .device_clock = true};
    if (script.trace)
        return act(script.trace, "trace", reason);
    for (size_t i = 0; i < ray_count; i++)
        if (trace_ray(&(struct job){.scene = match->scene,
                                    .packed = &match->packed,
                                    .box = match->options.box,
                                    .tri = match->options.tri,
                                    .query = match->options.query},
                      &ray[i], &hit[i], NULL))
            return STATUS_DEVICE;
    if (script.spoil)
        script.spoil(match, hit);
    return STATUS_OK;
}

static struct model made_up_model(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    struct model model = cpu_rays_model(engine, self, tri);
    model.bits = true;
    return model;
}

static void made_up_close(void *self)
{
    assert_ptr_equal(self, &script);
    script.closed++;
}

static const struct engine made_up = {
    .name = "made_up",
    .needs_packed = true,
    .open = made_up_open,
    .prepare = made_up_prepare,
    .trace = made_up_trace,
    .model = made_up_model,
    .close = made_up_close,
};

static inline struct fixture *begin(void)
{
    struct fixture *f = play("soup:n=500", "median", 4);
    script = (struct script){.match = &f->match};
    return f;
}

#endif
