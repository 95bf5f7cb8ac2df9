/* mikedh/trimesh#457: all hits are asked for one after the other, each from behind the last. What
 * lies nearer than the step behind a hit is in no list. */
#define SPOIL_LIST list_stepping
#include "tests/reported/reported_tracer.h"

static int list_stepping(void *self, const ray_in *ray, size_t count, uint32_t capacity,
                         hit_out *hit, uint32_t *hit_count, char *reason)
{
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        ray_in from = ray[i];
        hit_out one;
        hit_count[i] = 0;
        while (walk(self, &from, false, &one, false, 1)) {
            if (hit_count[i] < capacity)
                hit[i * capacity + hit_count[i]] = one;
            hit_count[i]++;
            from.tmin = one.t + 0.01f * (fabsf(one.t) + 0.01f);
            if (from.tmin > from.tmax)
                break;
        }
    }
    return RAYDIFF_ENGINE_OK;
}
