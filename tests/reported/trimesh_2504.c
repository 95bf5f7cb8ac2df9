/* mikedh/trimesh#2504: all hits are asked for one after the other, each by a ray that begins a
 * little behind the last. Far from the origin the little is lost in rounding, and the same hit
 * comes until the limit of a list. */
#define SPOIL_LIST list_again
#include "tests/reported/reported_tracer.h"

#define MOST 20u

static int list_again(void *self, const ray_in *ray, size_t count, uint32_t capacity, hit_out *hit,
                      uint32_t *hit_count, char *reason)
{
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        ray_in from = ray[i];
        float gone = 0;
        hit_out one;
        hit_count[i] = 0;
        while (hit_count[i] < MOST && walk(self, &from, false, &one, false, 1)) {
            const float step = one.t + 1e-6f;
            one.t += gone;
            if (hit_count[i] < capacity)
                hit[i * capacity + hit_count[i]] = one;
            hit_count[i]++;
            for (int k = 0; k < 3; k++)
                from.origin[k] += step * from.direction[k];
            gone += step;
            from.tmin = 0;
            from.tmax = ray[i].tmax - gone;
            if (from.tmax < 0)
                break;
        }
    }
    return RAYDIFF_ENGINE_OK;
}
