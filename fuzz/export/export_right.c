/* The right answers: found by calling the judge, so that no rule is written twice. */
#include "fuzz/export/export_inner.h"
#include "ref/judge/ray_triangle.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* An answer being widened. */
struct asking {
    const struct judge *judge;
    const struct ray *ray;
    const struct ray_mode *mode; /* in a world, else NULL */
    uint32_t tag;                /* in a world: what is answered beside the hit */
    const struct oracle_answer *truth;
    float v[3][3]; /* of the triangle that is answered */
    bool follow;   /* the formula is not known: only t is looked for, with u and v of the ray's
                      point at t, or else of the triangle's point nearest to its line */
    float line_u, line_v; /* the latter */
    bool no_memory;
};

/* The point of the edge from corner a to corner b nearest to p, as weights; its squared distance.
 */
static double nearest_on_edge(double corner[3][3], int a, int b, const double p[3],
                              double weight[3])
{
    double edge[3], to[3], rest[3];
    for (int k = 0; k < 3; k++) {
        edge[k] = corner[b][k] - corner[a][k];
        to[k] = p[k] - corner[a][k];
    }
    double length = judge_dot(edge, edge), s = length > 0 ? judge_dot(to, edge) / length : 0;
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    for (int k = 0; k < 3; k++)
        rest[k] = to[k] - s * edge[k];
    weight[0] = weight[1] = weight[2] = 0;
    weight[a] = 1 - s;
    weight[b] += s;
    return judge_dot(rest, rest);
}

/* u and v of the point of the triangle nearest to the ray's point at t: above the triangle that of
 * its plane (by cross products: normal equations fail on slivers), else one of an edge. */
static void follow(const struct asking *asking, struct hit *hit)
{
    double p[3], corner[3][3], b[3], c[3], to[3], n[3], over_c[3], over_b[3], best = INFINITY;
    for (int k = 0; k < 3; k++) {
        p[k] = (double)asking->ray->org[k] + (double)hit->t * (double)asking->ray->dir[k];
        for (int i = 0; i < 3; i++)
            corner[i][k] = (double)asking->v[i][k];
        b[k] = corner[1][k] - corner[0][k];
        c[k] = corner[2][k] - corner[0][k];
        to[k] = p[k] - corner[0][k];
    }
    judge_cross(b, c, n);
    judge_cross(to, c, over_c);
    judge_cross(b, to, over_b);
    double area = judge_dot(n, n), u = judge_dot(over_c, n) / area, v = judge_dot(over_b, n) / area;
    if (!(area > 0 && u >= 0 && v >= 0 && u + v <= 1))
        for (int i = 0; i < 3; i++) {
            double weight[3], far = nearest_on_edge(corner, i, (i + 1) % 3, p, weight);
            if (far < best) {
                best = far;
                u = weight[1];
                v = weight[2];
            }
        }
    hit->u = (float)u;
    hit->v = (float)v;
}

static void judge_it(struct asking *asking, const struct hit *hit, struct judgement *out)
{
    enum status status =
        asking->mode ? judge_world_answer(asking->judge, asking->ray, *asking->mode, asking->truth,
                                          hit, hit->prim == ABI_NO_PRIM ? 0 : asking->tag, out)
                     : judge_answer(asking->judge, asking->ray, asking->truth, hit, out);
    asking->no_memory = asking->no_memory || status != STATUS_OK;
}

static bool takes(struct asking *asking, struct hit *hit)
{
    struct judgement judgement;
    if (asking->follow)
        follow(asking, hit);
    judge_it(asking, hit, &judgement);
    if (asking->follow && judgement.wrong == WRONG_BARYCENTRIC) {
        hit->u = asking->line_u;
        hit->v = asking->line_v;
        judge_it(asking, hit, &judgement);
    }
    return judgement.verdict != VERDICT_WRONG;
}

/* Floats in their order as integers, and back. */
static int64_t place_of(float x)
{
    uint32_t bits = float_bits(x);
    return bits >> 31 ? -(int64_t)(bits & 0x7FFFFFFFu) : (int64_t)bits;
}

static float float_at(int64_t place)
{
    return place < 0 ? float_from_bits(0x80000000u | (uint32_t)-place)
                     : float_from_bits((uint32_t)place);
}

/* The last number on the way from *x, a member of `hit` that is taken, to `end` with which it still
 * is. What is taken is an interval around the exact value. */
static float widen(struct asking *asking, struct hit *hit, float *x, float end)
{
    const float from = *x;
    int64_t good = place_of(from), bad = place_of(end);
    *x = end;
    if (takes(asking, hit))
        good = bad;
    while (llabs(bad - good) > 1) {
        int64_t middle = (good + bad) / 2;
        *x = float_at(middle);
        if (takes(asking, hit))
            good = middle;
        else
            bad = middle;
    }
    *x = from;
    return float_at(good);
}

static void widen_both(struct asking *asking, struct hit *hit, float *x, float out[2])
{
    out[0] = widen(asking, hit, x, -FLT_MAX);
    out[1] = widen(asking, hit, x, FLT_MAX);
}

static enum status add(struct export_case *the, const struct export_right *right)
{
    void *array = the->right;
    if (array_reserve(&array, &the->right_capacity, the->right_count + 1, sizeof *right))
        return fail(the->reason, STATUS_MEMORY, "no memory for what is right");
    the->right = array;
    the->right[the->right_count++] = *right;
    return STATUS_OK;
}

/* Adds the answer and all that is taken around it. */
static enum status add_around(struct export_case *the, struct asking *asking, uint32_t i,
                              struct hit hit)
{
    struct export_right right = {.ray = i, .prim = hit.prim};
    if (asking->mode) {
        struct hit same = hit;
        const uint32_t tag = asking->tag;
        asking->tag = tag ^ ABI_TAG_FRONT;
        const bool other = takes(asking, &same);
        right.front = other || (tag & ABI_TAG_FRONT);
        right.back = other || !(tag & ABI_TAG_FRONT);
        asking->tag = tag;
    }
    widen_both(asking, &hit, &hit.t, right.t);
    if (asking->follow) {
        right.u[0] = right.v[0] = -INFINITY;
        right.u[1] = right.v[1] = INFINITY;
    } else {
        widen_both(asking, &hit, &hit.u, right.u);
        widen_both(asking, &hit, &hit.v, right.v);
    }
    return add(the, &right);
}

/* Where the line of the ray and the edge from a to b are nearest: multiples of the direction and of
 * the edge, and the square of their distance there. */
struct right_nearest {
    double t, s, square;
};

static struct right_nearest nearest_of(const struct ray *ray, const float a[3], const float b[3])
{
    struct right_nearest out = {0};
    double d[3], edge[3], to[3], at[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->dir[k];
        edge[k] = (double)b[k] - (double)a[k];
        to[k] = (double)ray->org[k] - (double)a[k];
    }
    double dd = judge_dot(d, d), de = judge_dot(d, edge), ee = judge_dot(edge, edge);
    double across = dd * ee - de * de;
    out.s = across > 0 ? (dd * judge_dot(edge, to) - de * judge_dot(d, to)) / across : 0;
    out.s = out.s < 0 ? 0 : out.s > 1 ? 1 : out.s;
    for (int k = 0; k < 3; k++)
        at[k] = out.s * edge[k] - to[k];
    out.t = judge_dot(at, d) / dd;
    for (int k = 0; k < 3; k++)
        out.square += (at[k] - out.t * d[k]) * (at[k] - out.t * d[k]);
    return out;
}

/* u and v of the triangle's point that is nearest to the line of the ray; *edge_t: the multiples of
 * the direction that are nearest to each edge. */
static void follow_line(struct asking *asking, const struct twin *twin, double edge_t[3])
{
    double u = twin->u_near, v = twin->v_near, least = INFINITY;
    bool inside = u >= 0 && v >= 0 && u + v <= 1;
    for (int c = 0; c < 3; c++) {
        double weight[3] = {0, 0, 0};
        struct right_nearest nearest =
            nearest_of(asking->ray, asking->v[c], asking->v[(c + 1) % 3]);
        weight[c] = 1 - nearest.s;
        weight[(c + 1) % 3] = nearest.s;
        edge_t[c] = nearest.t;
        if (!inside && nearest.square < least) {
            least = nearest.square;
            u = weight[1];
            v = weight[2];
        }
    }
    asking->line_u = float_is_finite((float)u) ? (float)u : 0;
    asking->line_v = float_is_finite((float)v) ? (float)v : 0;
}

/* Where the ray hits the triangle, exactly, or else its plane; not finite if it is parallel. */
static double plane_t(const struct export_case *the, struct asking *asking, uint32_t prim)
{
    struct oracle_pair pair;
    oracle_pair(the->oracle, asking->ray, prim, &pair);
    if (oracle_is_hit(&pair))
        return 0.5 * (pair.t_lo + pair.t_hi);
    return judge_plane_t(asking->ray, asking->v);
}

/* The nearest float that the range of the ray, without its ends where they are none, has. */
static float in_range(const struct export_case *the, const struct ray *ray, float t)
{
    float least = the->model.open ? nextafterf(ray->tmin, INFINITY) : ray->tmin;
    float most = the->model.open ? nextafterf(ray->tmax, -INFINITY) : ray->tmax;
    return t < least ? least : t > most ? most : t;
}

/* Tries answers for a triangle until the judge allows one: the exact numbers and those that C
 * computes. Neither need be near if the ray lies in the triangle's plane or passes beside it, so
 * also where the ray is nearest to the edges, and where it begins. And as early as the formula may
 * find it: only that may be near enough to a triangle that it hides. */
static enum status ask_triangle(struct export_case *the, struct asking *asking, uint32_t i,
                                uint32_t prim)
{
    enum twin_formula formula = asking->follow ? TWIN_WOOP : the->model.formula;
    const struct ray *ray = asking->ray;
    float(*v)[3] = asking->v;
    double edge_t[3];
    export_tri(the, prim, v);
    struct twin twin = twin_eval(formula, the->model.rounding, ray, v);
    if (!asking->follow && !twin.possible)
        return STATUS_OK;
    float u_near = (float)twin.u_near, v_near = (float)twin.v_near;
    follow_line(asking, &twin, edge_t);
    double earliest = twin.t_near - (twin.t_err - twin.t_off) * (1.0 - 0x1p-20);
    float early = (float)earliest;
    early = (double)early < earliest ? nextafterf(early, INFINITY) : early;
    struct hit tried[] = {{(float)twin.t_near, u_near, v_near, prim},
                          {(float)plane_t(the, asking, prim), u_near, v_near, prim},
                          {twin.t, twin.u, twin.v, prim},
                          {(float)edge_t[0], u_near, v_near, prim},
                          {(float)edge_t[1], u_near, v_near, prim},
                          {(float)edge_t[2], u_near, v_near, prim},
                          {ray->tmin, 0, 0, prim},
                          {early, u_near, v_near, prim}};
    for (size_t k = 0; k < ARRAY_COUNT(tried); k++) {
        tried[k].t = in_range(the, ray, tried[k].t);
        if (!float_is_finite(tried[k].u) || !float_is_finite(tried[k].v))
            tried[k].u = tried[k].v = 0.0f;
        if (takes(asking, &tried[k]))
            return add_around(the, asking, i, tried[k]);
    }
    return STATUS_OK;
}

/* In a world as its front and, if that is not right, as its back. */
static enum status ask_sides(struct export_case *the, struct asking *asking, uint32_t i,
                             uint32_t prim)
{
    const size_t before = the->right_count;
    if (!the->world)
        return ask_triangle(the, asking, i, prim);
    const uint32_t custom = the->world->instance[world_instance_of(the->world, prim)].custom;
    asking->tag = custom | ABI_TAG_FRONT;
    enum status status = ask_triangle(the, asking, i, prim);
    asking->tag = custom;
    if (!status && the->right_count == before)
        status = ask_triangle(the, asking, i, prim);
    return status;
}

/* Every triangle, the exact nearest one first. */
static enum status ask_triangles(struct export_case *the, struct asking *asking, uint32_t i)
{
    uint32_t first = asking->truth->prim;
    enum status status = first == ABI_NO_PRIM ? STATUS_OK : ask_sides(the, asking, i, first);
    for (uint32_t prim = 0; prim < export_tri_count(the) && !status; prim++)
        if (prim != first)
            status = ask_sides(the, asking, i, prim);
    return status;
}

static enum status ask_ray(struct export_case *the, const struct judge *judge, uint32_t i)
{
    struct asking asking = {.judge = judge,
                            .ray = &the->ray[i],
                            .mode = the->mode ? &the->mode[i] : NULL,
                            .truth = &the->truth[i]};
    struct hit miss = {.prim = ABI_NO_PRIM}, hit = {.prim = 0};
    struct judgement judgement;
    enum status status = STATUS_OK;
    judge_it(&asking, &miss, &judgement);
    /* An instance that is ill-conditioned excuses a miss, but no hit of another one. */
    bool any = judgement.verdict == VERDICT_OUT_OF_CONTRACT && !judgement.ill_conditioned;
    if (asking.no_memory || any)
        return asking.no_memory ? fail(the->reason, STATUS_MEMORY, "no memory to judge a ray")
                                : STATUS_OK;
    if (!export_is_unnamed(the)) {
        asking.follow = export_is_followed(the);
        status = ask_triangles(the, &asking, i);
    } else if (takes(&asking, &hit)) {
        status = add(the, &(struct export_right){.ray = i, .prim = 0});
    }
    if (!status && judgement.verdict != VERDICT_WRONG)
        status = add(the, &(struct export_right){.ray = i, .prim = ABI_NO_PRIM});
    return asking.no_memory ? fail(the->reason, STATUS_MEMORY, "no memory to judge a ray") : status;
}

enum status export_find_right(struct export_case *the, const struct judge *judge)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < the->ray_count && !status; i++)
        status = ask_ray(the, judge, i);
    return status;
}

static bool is_within(float x, const float interval[2])
{
    return x >= interval[0] && x <= interval[1];
}

bool export_is_right(const struct export_case *the, uint32_t i, const struct hit *hit)
{
    bool judged = false;
    for (size_t k = 0; k < the->right_count; k++) {
        const struct export_right *right = &the->right[k];
        if (right->ray != i)
            continue;
        judged = true;
        if (right->prim == hit->prim && (hit->prim == ABI_NO_PRIM || (is_within(hit->t, right->t) &&
                                                                      is_within(hit->u, right->u) &&
                                                                      is_within(hit->v, right->v))))
            return true;
    }
    return !judged;
}
