/* The engines of all modes of Embree, an independent ray tracer. */
#include "ref/engines/embree_device.h"
#include "ref/engines/embree_modes.h"
#include "ref/engines/embree_named.h"
#include "ref/twin/model.h"

static enum status embree_open(const struct engine *engine, const struct engine_options *options,
                               void **self, struct reason *reason)
{
    (void)engine;
    const struct embree_mode mode = {0};
    return embree_open_mode(options, &mode, self, reason);
}

static enum status embree_robust_open(const struct engine *engine,
                                      const struct engine_options *options, void **self,
                                      struct reason *reason)
{
    (void)engine;
    const struct embree_mode mode = {.robust = true};
    return embree_open_mode(options, &mode, self, reason);
}

static enum status embree_packets_open(const struct engine *engine,
                                       const struct engine_options *options, void **self,
                                       struct reason *reason)
{
    (void)engine;
    const struct embree_mode mode = {.packet = 16};
    return embree_open_mode(options, &mode, self, reason);
}

static enum status embree_high_open(const struct engine *engine,
                                    const struct engine_options *options, void **self,
                                    struct reason *reason)
{
    (void)engine;
    const struct embree_mode mode = {.quality = EMBREE_HIGH};
    return embree_open_mode(options, &mode, self, reason);
}

/* Each mode of Embree has one triangle test, whatever `tri` is. */
static struct model embree_model(const struct engine *engine, void *self,
                                 const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){
        .formula = TWIN_EMBREE, .rounding = ROUNDING_EMBREE, .slab = true, .any_unnamed = true};
}

static struct model embree_robust_model(const struct engine *engine, void *self,
                                        const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){
        .formula = TWIN_EMBREE_ROBUST, .rounding = ROUNDING_EMBREE, .any_unnamed = true};
}

static const char *embree_called(const void *self)
{
    (void)self;
    return "rtcIntersect1 or rtcOccluded1";
}

static const char *embree_16_called(const void *self)
{
    (void)self;
    return "rtcIntersect16 or rtcOccluded16";
}

const struct engine engine_embree = {
    .name = "embree",
    .summary = "Embree, default mode: fast, leaks at edges",
    .library = true,
    .own_tri = true,
    .open = embree_open,
    .prepare = embree_prepare,
    .move = embree_move,
    .trace = embree_trace,
    .trace_all = embree_trace_all,
    .worlds = &embree_worlds,
    .model = embree_model,
    .called = embree_called,
    .close = embree_close,
    .plain_of = embree_named_plain,
    .describe = embree_describe,
};

const struct engine engine_embree_robust = {
    .name = "embree_robust",
    .summary = "Embree with RTC_SCENE_FLAG_ROBUST",
    .library = true,
    .own_tri = true,
    .open = embree_robust_open,
    .prepare = embree_prepare,
    .move = embree_move,
    .trace = embree_trace,
    .trace_all = embree_trace_all,
    .worlds = &embree_worlds,
    .model = embree_robust_model,
    .called = embree_called,
    .close = embree_close,
    .describe = embree_describe,
};

static const struct engine engine_embree_packets = {
    .name = "embree_16",
    .summary = "Embree, default mode, in packets of 16 rays",
    .library = true,
    .own_tri = true,
    .open = embree_packets_open,
    .prepare = embree_prepare,
    .move = embree_move,
    .trace = embree_trace,
    .model = embree_model,
    .called = embree_16_called,
    .close = embree_close,
    .describe = embree_describe,
};

static const struct engine engine_embree_high = {
    .name = "embree_high",
    .summary = "Embree, default mode, build quality high: spatial splits",
    .library = true,
    .own_tri = true,
    .open = embree_high_open,
    .prepare = embree_prepare,
    .move = embree_move,
    .trace = embree_trace,
    .model = embree_model,
    .called = embree_called,
    .close = embree_close,
    .describe = embree_describe,
};

const struct engine *const embree_modes[] = {&engine_embree_packets, &engine_embree_high, NULL};
