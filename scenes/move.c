#include "scenes/move.h"

#include "ref/base/rng.h"

#include <math.h>

/* A hash of a position. -0 and 0 give the same hash. */
static uint64_t place_of(const float p[3])
{
    uint64_t place = 0;
    for (int k = 0; k < 3; k++) {
        struct rng mixed = rng_make(place, float_bits(p[k] + 0.0f));
        place = rng_u64(&mixed);
    }
    return place;
}

static double longest_side(const struct box *bounds)
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, (double)bounds->hi[k] - (double)bounds->lo[k]);
    return most;
}

void scene_move(struct scene *scene, float amount, uint64_t seed)
{
    if (!(amount > 0) || scene->tri_count == 0)
        return;
    struct box bounds = scene_bounds(scene);
    double most = (double)amount * longest_side(&bounds);
    for (size_t i = 0; i < scene->vertex_count; i++) {
        float *p = scene->vertex + 3 * i;
        struct rng rng = rng_make(seed, place_of(p));
        for (int k = 0; k < 3; k++) {
            double moved = (double)p[k] + most * (2 * (double)rng_float(&rng) - 1);
            p[k] = (float)fmin(fmax(moved, -(double)FLT_MAX), (double)FLT_MAX);
        }
    }
}
