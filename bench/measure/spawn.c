#include "bench/measure/spawn.h"

#include "bench/measure/error_measure.h"
#include "ref/twin/twin.h"
#include "scenes/rays/rays_stage.h"
#include "ref/primitives/test_run.h"

#include <math.h>

/* Sine of the flattest direction used. Flatter directions meet the other side of their own triangle
 * by the rounding of the direction alone. */
#define FLATTEST 1e-3

#define GAMMA_7 (7.0 * ERROR_UNIT / (1.0 - 7.0 * ERROR_UNIT))

const char *spawn_point_name(enum spawn_point point)
{
    return point == SPAWN_ALONG ? "o+td" : "bary";
}

/* Normal of the triangle in double, not normalised. */
static void normal_of(float v[3][3], double n[3])
{
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = ((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
               ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]);
    }
}

/* Computes the unit normal as a renderer does. False if the cross product of the edges is 0 in
 * float32. */
static bool float_normal(float v[3][3], float n[3])
{
    float e1[3], e2[3], square = 0;
    for (int k = 0; k < 3; k++) {
        e1[k] = v[1][k] - v[0][k];
        e2[k] = v[2][k] - v[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = e1[a] * e2[b] - e1[b] * e2[a];
        square += n[k] * n[k];
    }
    float length = sqrtf(square);
    if (!(length > 0.0f) || !float_is_finite(length))
        return false;
    for (int k = 0; k < 3; k++)
        n[k] /= length;
    return true;
}

/* Chooses a cosine-distributed direction, as the sum of the normal and a uniform unit vector. */
static bool choose_direction(struct rng *rng, const double exact_normal[3], struct spawn_hit *out)
{
    double size = sqrt(exact_normal[0] * exact_normal[0] + exact_normal[1] * exact_normal[1] +
                       exact_normal[2] * exact_normal[2]);
    for (int tries = 0; tries < 16; tries++) {
        float ball[3], square = 0;
        stage_direction(rng, ball);
        for (int k = 0; k < 3; k++) {
            out->dir[k] = out->normal[k] + ball[k];
            square += out->dir[k] * out->dir[k];
        }
        float length = sqrtf(square);
        if (!(length > 1e-3f))
            continue;
        double height = 0;
        for (int k = 0; k < 3; k++) {
            out->dir[k] /= length;
            height += exact_normal[k] * (double)out->dir[k];
        }
        if (height > FLATTEST * size)
            return true;
    }
    return false; /* the float32 normal differs too much from the exact one */
}

bool spawn_hit_make(const struct oracle *oracle, const struct scene *scene,
                    const struct tri_test *tri, const struct ray *ray,
                    const struct oracle_answer *truth, struct rng *rng, struct spawn_hit *out)
{
    struct tri_ray prepared = tri_ray_make(ray);
    struct oracle_pair pair;
    float v[3][3];
    double n[3], facing = 0;
    *out = (struct spawn_hit){.primary = *ray};
    if (truth->prim == ABI_NO_PRIM)
        return false;
    scene_tri(scene, truth->prim, v);
    if (!tri_test_run(tri->id, &prepared, v, &out->hit) || !float_normal(v, out->normal))
        return false;
    out->hit.prim = truth->prim;
    out->t_err = twin_eval(twin_of_tri(tri->id), ROUNDING_IEEE, ray, v).t_err;
    if (!isfinite(out->t_err))
        return false;
    oracle_pair(oracle, ray, truth->prim, &pair);
    double t = 0.5 * (pair.t_lo + pair.t_hi);
    normal_of(v, n);
    for (int k = 0; k < 3; k++) {
        double along = t * (double)ray->dir[k];
        out->at[k] = (double)ray->org[k] + along;
        out->fuzz = fmax(out->fuzz, 0x1p-39 * fabs(along) + 0x1p-51 * fabs((double)ray->org[k]));
        facing += n[k] * (double)ray->dir[k];
    }
    double same = 0;
    for (int k = 0; k < 3; k++) {
        n[k] = facing > 0 ? -n[k] : n[k];
        same += n[k] * (double)out->normal[k];
    }
    for (int k = 0; k < 3; k++)
        out->normal[k] = same < 0 ? -out->normal[k] : out->normal[k];
    return choose_direction(rng, n, out);
}

/* Rounds a double up to a float. */
static float round_up(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

void spawn_point_make(const struct spawn_hit *hit, const struct scene *scene,
                      enum spawn_point point, float p[3], float error[3])
{
    float v[3][3];
    const float u = hit->hit.u, w = hit->hit.v, rest = 1.0f - u - w;
    scene_tri(scene, hit->hit.prim, v);
    for (int k = 0; k < 3; k++) {
        if (point == SPAWN_ALONG) {
            float along = hit->hit.t * hit->primary.dir[k];
            p[k] = hit->primary.org[k] + along;
            double bound = fabs((double)hit->primary.dir[k]) * hit->t_err +
                           ERROR_UNIT * (fabs((double)along) + fabs((double)p[k]));
            error[k] = round_up(bound * (1.0 + 0x1p-20) + 0x1p-149);
        } else {
            float a = rest * v[0][k], b = u * v[1][k], c = w * v[2][k];
            p[k] = a + b + c;
            double sum = fabs((double)a) + fabs((double)b) + fabs((double)c);
            error[k] = round_up(GAMMA_7 * sum + 0x1p-147);
        }
    }
}

void spawn_constant(const float p[3], const float n[3], float c, float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = p[k] + c * n[k];
}

void spawn_bound(const float p[3], const float error[3], const float n[3], float out[3])
{
    float d = fabsf(n[0]) * error[0] + fabsf(n[1]) * error[1] + fabsf(n[2]) * error[2];
    for (int k = 0; k < 3; k++) {
        float offset = d * n[k];
        out[k] = p[k] + offset;
        if (offset > 0.0f)
            out[k] = nextafterf(out[k], INFINITY);
        else if (offset < 0.0f)
            out[k] = nextafterf(out[k], -INFINITY);
    }
}

void spawn_integer(const float p[3], const float n[3], float out[3])
{
    for (int k = 0; k < 3; k++) {
        int32_t steps = (int32_t)(256.0f * n[k]);
        if (fabsf(p[k]) < 1.0f / 32.0f)
            out[k] = p[k] + 0x1p-16f * n[k];
        else /* larger bits are further from 0 */
            out[k] = float_from_bits(float_bits(p[k]) + (uint32_t)(p[k] < 0 ? -steps : steps));
    }
}

struct ray spawn_ray(const struct spawn_hit *hit, const float org[3])
{
    struct ray ray = {.tmax = RAY_TMAX};
    for (int k = 0; k < 3; k++) {
        ray.org[k] = org[k];
        ray.dir[k] = hit->dir[k];
    }
    return ray;
}

double spawn_offset(const struct spawn_hit *hit, const float org[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += ((double)org[k] - hit->at[k]) * ((double)org[k] - hit->at[k]);
    return sqrt(square);
}
