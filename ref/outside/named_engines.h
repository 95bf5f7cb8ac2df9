/* Engines that are named while the program runs. An engine is a constant table of functions, and
 * none of these is told its name before it is opened: so each name is bound to one of a few tables,
 * a place. A file with such engines defines these two, then ENGINE_PLACES(ENGINE_PLACE) and its
 * tables:
 *   static enum status open_place(size_t place, const struct engine_options *options, void **self,
 *                                 struct reason *reason);
 *   static void describe_place(size_t place, const struct engine_options *options, char *text,
 *                              size_t text_bytes); */
#ifndef NAMED_ENGINES_H
#define NAMED_ENGINES_H

#include "ref/engine.h"

#define ENGINE_PLACES(each) each(0) each(1) each(2) each(3)
_Static_assert(ENGINES_OUTSIDE_MOST == 4, "a place for each");

#define ENGINE_PLACE(n)                                                                            \
    static enum status open_##n(const struct engine_options *options, void **self,                 \
                                struct reason *reason)                                             \
    {                                                                                              \
        return open_place(n, options, self, reason);                                               \
    }                                                                                              \
    static void describe_##n(const struct engine_options *options, char *text, size_t text_bytes)  \
    {                                                                                              \
        describe_place(n, options, text, text_bytes);                                              \
    }

/* Adds the engine of place *count, whose name is set, and counts it. Errors: those of engine_add.
 * *out and *count are unchanged on error. */
static inline enum status engine_place_take(const struct engine *place, size_t *count,
                                            const struct engine **out, struct reason *reason)
{
    enum status status = engine_add(&place[*count], reason);
    if (!status)
        *out = &place[(*count)++];
    return status;
}

#endif
