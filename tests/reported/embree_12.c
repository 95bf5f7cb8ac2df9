/* RenderKit/embree#12: a function that collects all hits is called for the first one only. */
#define SPOIL_LIST list_one
#include "tests/reported/reported_tracer.h"

static int list_one(void *self, const ray_in *ray, size_t count, uint32_t capacity, hit_out *hit,
                    uint32_t *hit_count, char *reason)
{
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        hit_out one;
        hit_count[i] = walk(self, &ray[i], false, &one, false, 1) ? 1 : 0;
        if (hit_count[i] && capacity)
            hit[i * capacity] = one;
    }
    return RAYDIFF_ENGINE_OK;
}
