/* The fast traversal on all cores, of trees in the form of ref/fast/tiny_block.h. */
#include "ref/engines/fast_inner.h"

static const struct fast_form *form(void)
{
    return &fast_forms[2];
}

static enum status tiny_open(const struct engine_options *options, void **self,
                             struct reason *reason)
{
    return fast_engine_open(options, form(), self, reason);
}

static void tiny_describe(const struct engine_options *options, char *text, size_t text_bytes)
{
    fast_engine_describe(options, form(), text, text_bytes);
}

extern const struct engine engine_fast_tiny;
const struct engine engine_fast_tiny = {
    .name = "fast_tiny",
    .summary = "fast on a quarter of the memory: vertices on a grid (--store quantised); test woop",
    .needs_packed = true,
    .own_tri = true,
    .tri_name = "woop",
    .own_tree = true,
    .open = tiny_open,
    .prepare = fast_prepare,
    .trace = fast_trace,
    .trace_all = fast_trace_all,
    .model = fast_model,
    .close = fast_close,
    .describe = tiny_describe,
};
