/* The fate of spawned rays, and the least offset. */
#include "bench/measure/spawn.h"

#include <math.h>

/* Least offsets are searched step by step up to STEPS_TRIED, then by doubling and halving. */
#define STEPS_TRIED 64u
#define STEPS_MOST  (1u << 23)

/* True if the ray hits its own triangle. Directions are never in its plane. */
static bool hits(const struct oracle *oracle, const struct ray *ray, uint32_t prim)
{
    struct oracle_pair pair;
    oracle_pair(oracle, ray, prim, &pair);
    return oracle_is_hit(&pair) && oracle_in_range(&pair, ORACLE_CLOSED);
}

/* Returns x . (y cross z), and in *size the sum of the sizes of its products. */
static double triple(const double x[3], const double y[3], const double z[3], double *size)
{
    double sum = 0;
    *size = 0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        sum += x[k] * (y[a] * z[b] - y[b] * z[a]);
        *size += fabs(x[k]) * (fabs(y[a] * z[b]) + fabs(y[b] * z[a]));
    }
    return sum;
}

/* True if `org` is certainly behind the plane of the hit's triangle, seen from the side to leave.
 * Differences of near floats are exact in double; products and sums are bounded as in numerics.md
 * 1.2. */
static bool is_behind(const struct scene *scene, const struct spawn_hit *hit, const float org[3])
{
    float v[3][3];
    double e1[3], e2[3], from[3], out[3], size, facing_size;
    scene_tri(scene, hit->hit.prim, v);
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
        from[k] = (double)org[k] - (double)v[0][k];
        out[k] = (double)hit->dir[k];
    }
    double side = triple(from, e1, e2, &size);
    double facing = triple(out, e1, e2, &facing_size); /* its sign is certain: never flat */
    return fabs(side) > 12.0 * 0x1p-53 * size && (side > 0) != (facing > 0);
}

/* Moves p by an offset to *out. True if the exact ray from there is free. */
static bool frees(const struct oracle *oracle, const struct scene *scene,
                  const struct spawn_hit *hit, const float p[3], float offset, float out[3])
{
    spawn_constant(p, hit->normal, offset, out);
    struct ray ray = spawn_ray(hit, out);
    return !hits(oracle, &ray, hit->hit.prim) && !is_behind(scene, hit, out);
}

uint32_t spawn_least(const struct oracle *oracle, const struct scene *scene,
                     const struct spawn_hit *hit, const float p[3], float out[3])
{
    float largest = fmaxf(fmaxf(fabsf(p[0]), fabsf(p[1])), fabsf(p[2]));
    float step = nextafterf(largest, INFINITY) - largest;
    for (uint32_t k = 0; k <= STEPS_TRIED; k++)
        if (frees(oracle, scene, hit, p, (float)k * step, out))
            return k;
    uint32_t low = STEPS_TRIED, high = 2 * low; /* low is too small */
    while (high <= STEPS_MOST && !frees(oracle, scene, hit, p, (float)high * step, out)) {
        low = high;
        high *= 2;
    }
    if (high > STEPS_MOST) {
        for (int k = 0; k < 3; k++)
            out[k] = p[k];
        return SPAWN_NEVER;
    }
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (frees(oracle, scene, hit, p, (float)middle * step, out))
            high = middle;
        else
            low = middle;
    }
    spawn_constant(p, hit->normal, (float)high * step, out);
    return high;
}

/* Sum of the sizes of a vector's coordinates. */
static double size_of(const double x[3])
{
    return fabs(x[0]) + fabs(x[1]) + fabs(x[2]);
}

/* The three edge functions, the determinant and t's numerator for the ray from the exact point,
 * with bounds on the effect of the point's fuzz and double's rounding. */
struct edges {
    double w[3], w_err[3], det, det_err, t, t_err;
};

static struct edges edges_of(float v[3][3], const struct spawn_hit *hit)
{
    double a[3][3], d[3], size;
    struct edges e = {.det = 0};
    for (int k = 0; k < 3; k++) {
        d[k] = (double)hit->dir[k];
        for (int c = 0; c < 3; c++)
            a[c][k] = (double)v[c][k] - hit->at[k];
    }
    /* A fuzz f in every coordinate changes x . (y cross z) by at most f times the sum over pairs of
     * 2 |x|1 |y|1, plus higher powers of f, which the factor has room for. */
    for (int c = 0; c < 3; c++) {
        const double *b = a[(c + 1) % 3], *next = a[(c + 2) % 3];
        e.w[c] = triple(d, b, next, &size);
        e.w_err[c] =
            4 * hit->fuzz * size_of(d) * (size_of(b) + size_of(next) + hit->fuzz) + 0x1p-49 * size;
        e.det += e.w[c];
        e.det_err += e.w_err[c] + 0x1p-52 * fabs(e.w[c]);
    }
    e.t = triple(a[0], a[1], a[2], &size);
    double pairs = size_of(a[0]) * size_of(a[1]) + size_of(a[1]) * size_of(a[2]) +
                   size_of(a[2]) * size_of(a[0]);
    double sums = size_of(a[0]) + size_of(a[1]) + size_of(a[2]);
    e.t_err = 4 * hit->fuzz * (pairs + hit->fuzz * (sums + hit->fuzz)) + 0x1p-49 * size;
    return e;
}

enum spawn_meets spawn_meets(const struct scene *scene, const struct spawn_hit *hit, uint32_t prim,
                             double *distance)
{
    float v[3][3];
    scene_tri(scene, prim, v);
    struct edges e = edges_of(v, hit);
    bool positive = false, negative = false, open = false;
    for (int c = 0; c < 3; c++) {
        positive = positive || e.w[c] > e.w_err[c];
        negative = negative || e.w[c] < -e.w_err[c];
        open = open || fabs(e.w[c]) <= e.w_err[c];
    }
    if (positive && negative)
        return SPAWN_MISSES;
    double sign = positive ? 1 : -1;
    if ((positive || negative) && sign * e.t < -e.t_err)
        return SPAWN_MISSES; /* behind the point; the determinant has the sign of its parts */
    double length =
        sqrt((double)hit->dir[0] * (double)hit->dir[0] + (double)hit->dir[1] * (double)hit->dir[1] +
             (double)hit->dir[2] * (double)hit->dir[2]);
    double det = fabs(e.det);
    if (open || fabs(e.t) <= e.t_err || det <= e.det_err) {
        *distance = fmax(0, fabs(e.t) - e.t_err) / (det + e.det_err) * length;
        return SPAWN_UNDECIDED;
    }
    *distance = fabs(e.t) / det * length;
    return SPAWN_MEETS;
}

/* True if on some axis the triangle is further than `reach` from the point. */
static bool is_far(const struct scene *scene, const struct spawn_hit *hit, uint32_t prim,
                   double reach)
{
    float v[3][3];
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++) {
        float lo = fminf(fminf(v[0][k], v[1][k]), v[2][k]);
        float hi = fmaxf(fmaxf(v[0][k], v[1][k]), v[2][k]);
        if ((double)lo - hit->at[k] > reach || hit->at[k] - (double)hi > reach)
            return true;
    }
    return false;
}

struct spawn_near spawn_near_find(const struct scene *scene, const struct spawn_hit *hit,
                                  double reach)
{
    struct spawn_near near = {.prim = ABI_NO_PRIM, .distance = reach};
    double open = INFINITY; /* least distance at which an undecided triangle may be met */
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        double distance = INFINITY;
        if (i == hit->hit.prim || is_far(scene, hit, i, reach))
            continue;
        enum spawn_meets meets = spawn_meets(scene, hit, i, &distance);
        if (meets == SPAWN_UNDECIDED)
            open = fmin(open, distance);
        if (meets == SPAWN_MEETS && distance < near.distance) {
            near.prim = i;
            near.distance = distance;
        }
    }
    near.undecided = open <= near.distance;
    return near;
}

/* True if two triangles share a point. */
static bool touch(const struct scene *scene, const struct topology *topology, uint32_t a,
                  uint32_t b)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (topology->point[scene->index[3 * (size_t)a + (size_t)i]] ==
                topology->point[scene->index[3 * (size_t)b + (size_t)k]])
                return true;
    return false;
}

struct spawn_fate spawn_fate_answer(const struct scene *scene, const struct topology *topology,
                                    const struct spawn_hit *hit, const struct spawn_near *near,
                                    const float org[3], uint32_t prim)
{
    const uint32_t own = hit->hit.prim;
    bool some = prim < scene->tri_count;
    double distance;
    struct spawn_fate fate = {.self = prim == own};
    fate.near =
        !near->undecided && near->prim != ABI_NO_PRIM && near->distance < spawn_offset(hit, org);
    fate.beside = some && !fate.self && touch(scene, topology, own, prim) &&
                  spawn_meets(scene, hit, prim, &distance) == SPAWN_MISSES;
    fate.skipped = fate.near && !fate.self && !(some && touch(scene, topology, near->prim, prim));
    return fate;
}

struct spawn_fate spawn_fate_exact(const struct oracle *oracle, const struct scene *scene,
                                   const struct topology *topology, const struct spawn_hit *hit,
                                   const struct spawn_near *near, const float org[3],
                                   const struct oracle_answer *truth)
{
    const uint32_t own = hit->hit.prim;
    struct ray ray = spawn_ray(hit, org);
    bool self = truth->tie_count > 1 && truth->prim != own && hits(oracle, &ray, own) &&
                oracle_compare(oracle, &ray, own, truth->prim) == 0;
    return spawn_fate_answer(scene, topology, hit, near, org, self ? own : truth->prim);
}
