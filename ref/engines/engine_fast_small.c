/* The fast traversal on all cores, of trees in the forms of ref/fast/small_tree.h. */
#include "ref/engines/fast_inner.h"

#include "ref/engines/cpu_rays.h"
#include "ref/twin/model.h"

#include <stdio.h>

static enum status small_open(const struct engine *engine, const struct engine_options *options,
                              void **self, struct reason *reason)
{
    (void)engine;
    return fast_engine_open(options, true, self, reason);
}

static void small_describe(const struct engine *engine, const struct engine_options *options,
                           char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, kernel %s, triangle test woop",
             cpu_rays_threads(options), fast_small_kernel_best()->name);
}

extern const struct engine engine_fast_small;
const struct engine engine_fast_small = {
    .name = "fast_small",
    .summary = "fast on half the memory, with --store quantised on a quarter; test woop",
    .needs_packed = true,
    .own_tri = true,
    .tri_name = "woop",
    .own_tree = true,
    .open = small_open,
    .prepare = fast_prepare,
    .trace = fast_trace,
    .trace_all = fast_trace_all,
    .model = fast_model,
    .close = fast_close,
    .describe = small_describe,
};
