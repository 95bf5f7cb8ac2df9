#include "ref/oracle/oracle.h"

#include "ref/oracle/environment.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/pair.h"

#include <math.h>
#include <stdlib.h>

const char *oracle_class_name(enum oracle_class class)
{
    static const char *const name[ORACLE_CLASS_COUNT] = {"miss",   "inside",   "edge",
                                                         "vertex", "in_plane", "zero_area"};
    return class < ORACLE_CLASS_COUNT ? name[class] : "unknown";
}

enum status oracle_make(const struct scene *scene, struct oracle **out, struct reason *reason)
{
    *out = NULL;
    enum status status = oracle_environment(reason);
    if (status)
        return status;
    struct oracle *oracle = alloc_zeroed(1, sizeof *oracle);
    if (!oracle)
        return fail(reason, STATUS_MEMORY, "oracle: no memory");
    oracle->scene = scene;
    oracle->flat = alloc_zeroed(scene->tri_count, 1);
    if (!oracle->flat) {
        oracle_free(oracle);
        return fail(reason, STATUS_MEMORY, "oracle: no memory for %u triangles", scene->tri_count);
    }
    for (uint32_t prim = 0; prim < scene->tri_count; prim++) {
        float v[3][3];
        scene_tri(scene, prim, v);
        oracle->flat[prim] = exact_no_area(v);
    }
    *out = oracle;
    return STATUS_OK;
}

void oracle_free(struct oracle *oracle)
{
    if (!oracle)
        return;
    free(oracle->flat);
    free(oracle);
}

bool oracle_takes(const struct ray *ray)
{
    for (int k = 0; k < 3; k++)
        if (!float_is_finite(ray->org[k]) || !float_is_finite(ray->dir[k]))
            return false;
    return float_is_finite(ray->tmin) && ray->tmin <= ray->tmax; /* false if tmax is NaN */
}

void oracle_pair(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                 struct oracle_pair *out)
{
    struct oracle_stats unused = {0};
    struct decided pair;
    __auto_type saved = environment_enter();
    pair_decide(oracle->scene, oracle->flat[prim], ray, prim, PAIR_FULL, &pair, &unused);
    environment_leave(saved);
    *out = pair.pair;
}

int oracle_compare(const struct oracle *oracle, const struct ray *ray, uint32_t a, uint32_t b)
{
    struct oracle_stats unused = {0};
    struct decided one, two;
    __auto_type saved = environment_enter();
    pair_decide(oracle->scene, oracle->flat[a], ray, a, PAIR_FULL, &one, &unused);
    pair_decide(oracle->scene, oracle->flat[b], ray, b, PAIR_FULL, &two, &unused);
    int sign = one.pair.t_lo > two.pair.t_hi ? 1
               : one.pair.t_hi < two.pair.t_lo
                   ? -1
                   : fraction_compare(pair_t(oracle->scene, ray, a, &one),
                                      pair_t(oracle->scene, ray, b, &two));
    environment_leave(saved);
    return sign;
}

bool oracle_rational(const struct oracle *oracle, const struct ray *ray, uint32_t prim, char *text,
                     size_t text_bytes)
{
    struct oracle_stats unused = {0};
    struct decided pair;
    __auto_type saved = environment_enter();
    pair_decide(oracle->scene, oracle->flat[prim], ray, prim, PAIR_FULL, &pair, &unused);
    bool written = pair_is_hit(&pair.pair) &&
                   fraction_text(pair_t(oracle->scene, ray, prim, &pair), text, text_bytes);
    environment_leave(saved);
    return written;
}
