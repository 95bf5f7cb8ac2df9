/* RenderKit/embree#149: a stream of rays gets other answers than its rays alone, and again others
 * in reverse order. Eight rays share a walk, which takes over the distance of the first. */
#define SPOIL_TRACE trace_stream
#include "tests/reported/reported_tracer.h"

static int trace_stream(void *self, const ray_in *ray, size_t count, uint32_t query, hit_out *hit,
                        char *reason)
{
    for (size_t i = 0; i < count; i++) {
        ray_in one = ray[i];
        const hit_out *first = &hit[i - i % 8];
        if (i % 8 && first->triangle != RAYDIFF_ENGINE_NONE && first->t >= one.tmin)
            one.tmax = fminf(one.tmax, first->t);
        trace(self, &one, 1, query, &hit[i], reason);
    }
    return RAYDIFF_ENGINE_OK;
}
