#include "ref/twin/twin.h"
#include "ref/base/invariant.h"

#include "ref/base/base.h"
#include "ref/twin/twin_lanes.h"

#include <math.h>

#include "ref/twin/twin_scalar.h"

enum twin_formula twin_of_tri(uint32_t id)
{
    static const enum twin_formula formulas[] = {[ABI_TRI_MT_RTRS] = TWIN_MT_RTRS,
                                                 [ABI_TRI_MT] = TWIN_MT,
                                                 [ABI_TRI_WOOP] = TWIN_WOOP,
                                                 [ABI_TRI_PLUECKER] = TWIN_PLUECKER,
                                                 [ABI_TRI_BALDWIN_WEBBER] = TWIN_BALDWIN_WEBBER};
    invariant(id < ARRAY_COUNT(formulas));
    return formulas[id];
}

struct model model_of_tri(const struct tri_test *tri, struct rounding rounding, bool bits)
{
    return (struct model){.formula = twin_of_tri(tri->id),
                          .rounding = rounding,
                          .bits = bits,
                          .watertight = tri->watertight && rounding_is_nearest(rounding),
                          .open = tri->open};
}

void twin_axes(enum twin_formula formula, const struct ray *ray, int axis[3])
{
    for (int k = 0; k < 3; k++)
        axis[k] = k;
    if (formula != TWIN_WOOP)
        return;
    struct tri_ray r = tri_ray_make(ray);
    axis[0] = r.kx;
    axis[1] = r.ky;
    axis[2] = r.kz;
}

struct twin twin_eval(enum twin_formula formula, struct rounding rounding, const struct ray *ray,
                      float v[3][3])
{
    const struct rules rules = rules_of(&rounding);
    struct input in;
    int axis[3];
    twin_axes(formula, ray, axis);
    for (int k = 0; k < 3; k++) {
        in.o[k] = exact(ray->org[axis[k]]);
        in.d[k] = exact(ray->dir[axis[k]]);
        for (int c = 0; c < 3; c++)
            in.v[c][k] = exact(v[c][axis[k]]);
    }
    return conclude(formula, ray, evaluate(formula, &rules, &in));
}

/* --- many --------------------------------------------------------------------------------------
 */

static const struct twin_kernel *kernel_best(void)
{
#if defined(TWIN_VECTORS)
    if (twin_avx512.runs())
        return &twin_avx512;
    if (twin_avx2.runs())
        return &twin_avx2;
#endif
    return NULL;
}

static void put_lane(enum twin_formula formula, const struct scene *scene,
                     const struct twin_pair *pair, int lane, struct twin_input *in)
{
    float v[3][3];
    int axis[3];
    scene_tri(scene, pair->prim, v);
    twin_axes(formula, pair->ray, axis);
    for (int k = 0; k < 3; k++) {
        in->o[k][lane] = pair->ray->org[axis[k]];
        in->d[k][lane] = pair->ray->dir[axis[k]];
        for (int c = 0; c < 3; c++)
            in->v[c][k][lane] = v[c][axis[k]];
    }
}

static struct twin take_lane(enum twin_formula formula, const struct ray *ray,
                             const struct twin_output *out, int lane)
{
    struct bounded value[TWIN_OUTPUTS];
    for (int i = 0; i < TWIN_OUTPUTS; i++)
        value[i] = (struct bounded){NAN, out->x[i][lane], out->e[i][lane]};
    return conclude(formula, ray,
                    (struct outcome){.edge = {value[0], value[1], value[2]},
                                     .det = value[TWIN_DET],
                                     .t = value[TWIN_T],
                                     .u = value[TWIN_U],
                                     .v = value[TWIN_V],
                                     .t_running = out->t_running[lane],
                                     .band = out->band[lane],
                                     .det_alone = formula == TWIN_EMBREE_ROBUST});
}

void twin_eval_by(const struct twin_kernel *kernel, enum twin_formula formula,
                  struct rounding rounding, const struct scene *scene, const struct twin_pair *pair,
                  size_t count, struct twin *out)
{
    struct twin_input in;
    struct twin_output result;
    for (size_t first = 0; first < count; first += TWIN_LANES) {
        size_t left = count - first;
        int lanes = left < TWIN_LANES ? (int)left : TWIN_LANES;
        for (int lane = 0; lane < TWIN_LANES; lane++) /* the last one fills up what is left over */
            put_lane(formula, scene, &pair[first + (size_t)(lane < lanes ? lane : lanes - 1)], lane,
                     &in);
        kernel->evaluate(formula, &rounding, &in, &result);
        for (int lane = 0; lane < lanes; lane++)
            out[first + (size_t)lane] =
                take_lane(formula, pair[first + (size_t)lane].ray, &result, lane);
    }
}

void twin_eval_many(enum twin_formula formula, struct rounding rounding, const struct scene *scene,
                    const struct twin_pair *pair, size_t count, struct twin *out)
{
    const struct twin_kernel *kernel = kernel_best();
    if (kernel) {
        twin_eval_by(kernel, formula, rounding, scene, pair, count, out);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, pair[i].prim, v);
        out[i] = twin_eval(formula, rounding, pair[i].ray, v);
    }
}
