/* The fast traversal on all cores, of trees in the form of ref/fast/small_tree.h. */
#include "ref/engines/fast_inner.h"

static const struct fast_form *form(void)
{
    return &fast_forms[1];
}

static enum status small_open(const struct engine_options *options, void **self,
                              struct reason *reason)
{
    return fast_engine_open(options, form(), self, reason);
}

static void small_describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    fast_engine_describe(options, form(), text, text_bytes);
}

extern const struct engine engine_fast_small;
const struct engine engine_fast_small = {
    .name = "fast_small",
    .summary = "fast on half the memory: nodes of 80 bytes, vertices as differences; test woop",
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
