/* Motions of vertices, harmless and nasty. */
#include "scenes/life_steps.h"

#include "ref/base/rng.h"
#include "scenes/move.h"

#include <math.h>

#define JITTERS 12u /* amounts of MOTION_JITTER */
#define FARS    24u /* and of MOTION_FAR */
#define AXES    3u

const char *motion_name(enum life_motion motion)
{
    static const char *const name[MOTIONS] = {
        "still", "jitter", "one",     "mirror", "swap",     "far",    "point", "zero",  "subnormal",
        "drift", "turn",   "reflect", "scale",  "exchange", "gather", "away",  "masks", "hide"};
    return name[motion];
}

static double longest_side(const struct scene *scene)
{
    struct box box = scene_bounds(scene);
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, (double)box.hi[k] - (double)box.lo[k]);
    return most;
}

static void put(float *x, double to)
{
    float rounded = (float)to;
    *x = float_is_finite(rounded) ? rounded : *x;
}

static void move_one(struct scene *scene, uint64_t seed)
{
    struct rng rng = rng_make(seed, 1);
    float *p = scene->vertex + 3 * (size_t)rng_below(&rng, scene->vertex_count);
    double side = longest_side(scene);
    for (int k = 0; k < 3; k++)
        put(&p[k], (double)p[k] + side * (2 * (double)rng_float(&rng) - 1));
}

static void mirror(struct scene *scene, uint64_t seed)
{
    for (size_t i = 0; i < scene->vertex_count; i++)
        scene->vertex[3 * i + seed % AXES] = -scene->vertex[3 * i + seed % AXES];
}

static void swap(struct scene *scene, uint64_t seed)
{
    struct rng rng = rng_make(seed, 2);
    const uint32_t a = rng_below(&rng, scene->tri_count), b = rng_below(&rng, scene->tri_count);
    for (size_t c = 0; c < 3; c++) {
        float *p = scene->vertex + 3 * (size_t)scene->index[3 * (size_t)a + c];
        float *q = scene->vertex + 3 * (size_t)scene->index[3 * (size_t)b + c];
        for (int k = 0; k < 3; k++) {
            float kept = p[k];
            p[k] = q[k];
            q[k] = kept;
        }
    }
}

static void move_far(struct scene *scene, uint64_t seed)
{
    double by = ldexp(longest_side(scene), 1 + (int)(seed % FARS));
    size_t axis = seed / FARS % AXES;
    for (size_t i = 0; i < scene->vertex_count; i++)
        put(&scene->vertex[3 * i + axis], (double)scene->vertex[3 * i + axis] + by);
}

static void collapse(struct scene *scene, uint64_t seed)
{
    const float *at = scene->vertex + 3 * (size_t)(seed % scene->vertex_count);
    const float to[3] = {at[0], at[1], at[2]};
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertex[i] = to[i % 3];
}

/* Seeds that are even change one axis, others all. Zeros keep their sign; other numbers give 0 or
 * -0, or a subnormal, by their bits: what was at one place stays so. */
static void make_tiny(struct scene *scene, uint64_t seed, bool subnormal)
{
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        uint32_t bits = float_bits(scene->vertex[i]);
        struct rng rng = rng_make(seed, bits);
        if (seed % 2 == 0 && i % AXES != seed / 2 % AXES)
            continue;
        bits &= 0x80000000u;
        bits |= subnormal ? (uint32_t)(rng_u64(&rng) >> 41) : 0;
        scene->vertex[i] = float_from_bits(bits);
    }
}

void motion_apply(const struct step *step, struct scene *scene)
{
    if (scene->tri_count == 0)
        return;
    switch (step->motion) {
    case MOTION_JITTER:
        scene_move(scene, ldexpf(1.0f, -(int)(step->seed % JITTERS)), step->seed);
        break;
    case MOTION_ONE:
        move_one(scene, step->seed);
        break;
    case MOTION_MIRROR:
        mirror(scene, step->seed);
        break;
    case MOTION_SWAP:
        swap(scene, step->seed);
        break;
    case MOTION_FAR:
        move_far(scene, step->seed);
        break;
    case MOTION_POINT:
        collapse(scene, step->seed);
        break;
    case MOTION_ZERO:
    case MOTION_SUBNORMAL:
        make_tiny(scene, step->seed, step->motion == MOTION_SUBNORMAL);
        break;
    default: /* still, or of instances */
        break;
    }
}
