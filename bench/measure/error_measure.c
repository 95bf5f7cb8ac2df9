#include "bench/measure/error_measure.h"
#include "ref/base/base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The triangle relative to the ray's origin, in double: differences of floats within 2^29 of each
 * other are exact. */
struct measure_frame {
    double v[3][3];
    double d[3];
    double size;      /* M: largest |v - o| */
    double direction; /* |d|max */
};

static struct measure_frame frame_make(const struct scene *scene, const struct ray *ray,
                                       uint32_t prim)
{
    struct measure_frame f = {.size = 0};
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++) {
        f.d[k] = (double)ray->dir[k];
        f.direction = fmax(f.direction, fabs(f.d[k]));
        for (int c = 0; c < 3; c++) {
            f.v[c][k] = (double)v[c][k] - (double)ray->org[k];
            f.size = fmax(f.size, fabs(f.v[c][k]));
        }
    }
    return f;
}

static double plane_error(const struct measure_frame *f, double t)
{
    double n[3], square = 0, off = 0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = (f->v[1][a] - f->v[0][a]) * (f->v[2][b] - f->v[0][b]) -
               (f->v[1][b] - f->v[0][b]) * (f->v[2][a] - f->v[0][a]);
        square += n[k] * n[k];
    }
    if (!(square > 0))
        return NAN; /* a triangle without area has no plane */
    for (int k = 0; k < 3; k++)
        off += n[k] * (t * f->d[k] - f->v[0][k]);
    return fabs(off) / (sqrt(square) * ERROR_UNIT * f->size);
}

static double point_error(const struct measure_frame *f, const struct hit *answer)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double at = f->v[0][k] + (double)answer->u * (f->v[1][k] - f->v[0][k]) +
                    (double)answer->v * (f->v[2][k] - f->v[0][k]);
        most = fmax(most, fabs((double)answer->t * f->d[k] - at));
    }
    return most / (ERROR_UNIT * f->size);
}

static enum error_kind kind_of(const struct oracle *oracle, const struct ray *ray,
                               const struct oracle_answer *truth, const struct hit *answer,
                               const struct oracle_pair *pair)
{
    if (answer->prim == truth->prim)
        return ERROR_RIGHT;
    if (answer->prim == ABI_NO_PRIM)
        return ERROR_LOST;
    if (pair->class == ORACLE_IN_PLANE && pair->range != ORACLE_BELOW &&
        pair->range != ORACLE_ABOVE)
        return ERROR_FREE;
    if (truth->prim == ABI_NO_PRIM)
        return ERROR_PHANTOM;
    if (oracle_is_hit(pair) && truth->tie_count > 1 &&
        oracle_compare(oracle, ray, answer->prim, truth->prim) == 0)
        return ERROR_RIGHT;
    return ERROR_WRONG;
}

struct error_one error_measure(const struct oracle *oracle, const struct scene *scene,
                               const struct ray *ray, const struct oracle_answer *truth,
                               const struct hit *answer)
{
    struct error_one out = {ERROR_REFUSED, NAN, NAN, NAN};
    struct oracle_pair pair = {.class = ORACLE_MISS};
    if (truth->flags & ORACLE_REFUSED)
        return out;
    if (answer->prim != ABI_NO_PRIM && answer->prim >= scene->tri_count) {
        out.kind = truth->prim == ABI_NO_PRIM ? ERROR_PHANTOM : ERROR_WRONG;
        return out; /* no such triangle: nothing to measure */
    }
    if (answer->prim != ABI_NO_PRIM)
        oracle_pair(oracle, ray, answer->prim, &pair);
    out.kind = kind_of(oracle, ray, truth, answer, &pair);
    if (answer->prim == ABI_NO_PRIM)
        return out;
    struct measure_frame frame = frame_make(scene, ray, answer->prim);
    if (!float_is_finite(answer->t) || !float_is_finite(answer->u) || !float_is_finite(answer->v)) {
        out.forward = out.plane = out.point = INFINITY;
        return out;
    }
    if (!(frame.size > 0))
        return out; /* all three vertices are at the ray's origin */
    out.plane = plane_error(&frame, (double)answer->t);
    if (!oracle_is_hit(&pair))
        return out;
    double t = 0.5 * (pair.t_lo + pair.t_hi);
    out.forward = fabs((double)answer->t - t) * frame.direction / (ERROR_UNIT * frame.size);
    out.point = point_error(&frame, answer);
    return out;
}

struct quantiles quantiles_of(double *value, size_t count)
{
    struct quantiles out = {0, NAN, NAN, NAN};
    for (size_t i = 0; i < count; i++)
        if (!isnan(value[i]))
            value[out.count++] = value[i];
    if (out.count == 0)
        return out;
    sort_doubles(value, out.count);
    out.p50 = value[rank_of(out.count, 500)];
    out.p99 = value[rank_of(out.count, 990)];
    out.most = value[out.count - 1];
    return out;
}

enum status error_sum_make(const struct oracle *oracle, const struct scene *scene,
                           const struct ray *ray, const struct oracle_answer *truth,
                           const struct hit *answer, size_t count, struct error_sum *out,
                           struct reason *reason)
{
    *out = (struct error_sum){0};
    struct error_one *one = alloc_zeroed(count, sizeof *one);
    double *value = alloc_zeroed(3 * count, sizeof *value);
    if (!one || !value) {
        free(one);
        free(value);
        return fail(reason, STATUS_MEMORY, "no memory to measure %zu answers", count);
    }
#pragma omp parallel for schedule(dynamic, 64)
    for (long long i = 0; i < (long long)count; i++)
        one[i] = error_measure(oracle, scene, &ray[i], &truth[i], &answer[i]);
    for (size_t i = 0; i < count; i++) {
        out->kind[one[i].kind]++;
        out->rays += one[i].kind != ERROR_REFUSED;
        out->hits += one[i].kind != ERROR_REFUSED && answer[i].prim != ABI_NO_PRIM;
        value[i] = one[i].forward;
        value[count + i] = one[i].plane;
        value[2 * count + i] = one[i].point;
    }
    out->forward = quantiles_of(value, count);
    out->plane = quantiles_of(value + count, count);
    out->point = quantiles_of(value + 2 * count, count);
    free(one);
    free(value);
    return STATUS_OK;
}

void error_rate_text(size_t events, size_t count, char *text, size_t text_bytes)
{
    double rate = 1e6 * (double)(events ? events : 3) / (double)count;
    if (count == 0)
        snprintf(text, text_bytes, "-");
    else
        snprintf(text, text_bytes, rate < 999.5 ? "%s%.3g" : "%s%.0f", events ? "" : "<", rate);
}
