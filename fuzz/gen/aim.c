#include "fuzz/gen/aim_inner.h"

#include "fuzz/gen/gen_sketch.h"
#include "ref/base/half.h"

/* A random triangle; three corners of the scene's box if there is none. */
static void any_triangle(const struct aim *aim, struct rng *rng, float v[3][3])
{
    if (aim->scene->tri_count > 0) {
        scene_tri(aim->scene, rng_below(rng, aim->scene->tri_count), v);
        return;
    }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = c == k ? aim->all.hi[k] : aim->all.lo[k];
}

static void target_vertex(const struct aim *aim, struct rng *rng, struct target *out)
{
    float v[3][3];
    any_triangle(aim, rng, v);
    uint32_t c = rng_below(rng, 3);
    for (int k = 0; k < 3; k++)
        out->at[k] = v[c][k];
}

static void target_edge(const struct aim *aim, struct rng *rng, struct target *out)
{
    float v[3][3];
    any_triangle(aim, rng, v);
    uint32_t bits = (uint32_t)rng_u64(rng), a = bits % 3, b = (a + 1) % 3;
    /* The middle, where a lattice stays exact; near an end; anywhere. */
    float s = (float)(bits >> 8) * 0x1p-24f;
    if ((bits & 0xC) == 0)
        s = 0.5f;
    else if ((bits & 0xC) == 4)
        s *= 0x1p-8f;
    for (int k = 0; k < 3; k++)
        out->at[k] = v[a][k] + s * (v[b][k] - v[a][k]);
}

static void target_inside(const struct aim *aim, struct rng *rng, struct target *out)
{
    float v[3][3];
    any_triangle(aim, rng, v);
    float a = rng_float(rng), b = rng_float(rng);
    if (a + b > 1.0f) {
        a = 1.0f - a;
        b = 1.0f - b;
    }
    for (int k = 0; k < 3; k++)
        out->at[k] = v[0][k] + a * (v[1][k] - v[0][k]) + b * (v[2][k] - v[0][k]);
}

/* Corners, edges (one coordinate between) and faces (two) of a box. */
static void target_box(const struct aim *aim, struct rng *rng, uint32_t between, struct target *out)
{
    const struct box *box = &aim->box[rng_below(rng, aim->box_count)];
    uint64_t bits = rng_u64(rng);
    out->axis = (int)(bits >> 60 & 3) % 3;
    for (int k = 0; k < 3; k++) {
        int from_axis = (k - out->axis + 3) % 3;
        bool open = from_axis > 0 && (uint32_t)from_axis <= between;
        float s = (float)(bits >> (16 * k) & 0xFFFF) * 0x1p-16f;
        if (!open)
            s = s < 0.5f ? 0.0f : 1.0f;
        out->at[k] = s == 1.0f ? box->hi[k] : box->lo[k] + s * (box->hi[k] - box->lo[k]);
    }
}

/* Near a bound: on the float16 that it is rounded to, outward, inward or to nearest, beside that,
 * or between the two. The other coordinates are those of a triangle's corner that makes a bound, or
 * of a point nearby in the triangle, so that a hit is lost if the box is smaller than it should be.
 */
static void target_half(const struct aim *aim, struct rng *rng, struct target *out)
{
    float v[3][3];
    any_triangle(aim, rng, v);
    uint32_t bits = (uint32_t)rng_u64(rng), c = 0;
    int axis = (int)(bits % 3);
    float sign = bits & 0x10000u ? 1.0f : -1.0f;
    for (uint32_t other = 1; other < 3; other++)
        if (sign * v[other][axis] > sign * v[c][axis])
            c = other;
    float bound = v[c][axis];
    out->axis = axis;
    /* Towards the middle of the triangle, by far less than a step of float16 or by up to that. */
    float part = power_of_two(-9 - (int)(bits >> 20 & 7));
    uint32_t a = (c + 1) % 3, b = (c + 2) % 3;
    for (int k = 0; k < 3; k++)
        out->at[k] = v[c][k] + part * ((v[a][k] - v[c][k]) + (v[b][k] - v[c][k]));
    if (bits & 0x20000u)
        return;
    struct half code = half_nearest(bound);
    if (bits & 0x40000u)
        code = bits & 0x80000u ? half_bound_up(bound) : half_bound_down(bound);
    float step = half_to_float(code);
    if (bound <= 65536.0f && bound >= -65536.0f && float_is_finite(step))
        out->at[axis] = float_step(step, (int)(bits >> 24 & 3) - 1);
}

/* Shared by the rays of a run: branches that a processor can predict halve the time. */
struct aim_plan {
    enum aim_kind kind;
    enum approach approach;
    uint32_t between; /* AIM_CORNER: 0 corners, 1 edges; AIM_FACE: 2 */
    uint32_t moved;   /* 0: by steps of a float, 1: by a part of the scene, else not */
    uint32_t range;   /* of 64, see limit() */
};

/* By a few steps of a float or a small part of the scene. */
static void displace(const struct aim *aim, struct rng *rng, bool steps, struct target *target)
{
    uint64_t bits = rng_u64(rng);
    float reach = aim->extent * power_of_two(-6 - (int)(bits >> 8 & 15));
    for (int k = 0; k < 3; k++) {
        uint32_t piece = (uint32_t)(bits >> (16 + 16 * k)) & 0xFFFFu;
        if (steps)
            target->at[k] = float_step(target->at[k], (int)(piece % 5) - 2);
        else
            target->at[k] += reach * ((float)piece * 0x1p-15f - 1.0f);
    }
}

/* The range: t of the target is `t`. */
static void limit(struct rng *rng, uint32_t how, float t, struct ray *out)
{
    if (how < 44)
        return;
    float beside = float_step(t, (int)rng_below(rng, 3) - 1);
    if (how < 52)
        out->tmax = float_from_bits(0x7F800000u);
    else if (how < 55)
        out->tmax = beside;
    else if (how < 57)
        out->tmin = beside;
    else if (how < 60)
        out->tmax = 2.0f * t;
    else
        out->tmin = 0.5f * t;
}

static void random_ray(const struct aim *aim, struct rng *rng, bool axis, struct ray *out)
{
    float at[3], dir[3];
    aim_direction(rng, at);
    aim_direction(rng, dir);
    for (int k = 0; k < 3; k++)
        at[k] = aim->centre[k] + 0.75f * aim->extent * at[k];
    if (axis) {
        uint32_t along = rng_below(rng, 3);
        for (uint32_t k = 0; k < 3; k++)
            dir[k] = k == along ? dir[k] : float_from_bits(float_bits(dir[k]) & 0x80000000u);
        if (dir[along] == 0)
            dir[along] = 1.0f;
    }
    aim_set(at, dir, out);
}

/* Through a point of a triangle along a line of its plane; in half of the rays slightly out of it.
 */
static void grazing_ray(const struct aim *aim, struct rng *rng, struct target *target,
                        struct ray *out)
{
    float v[3][3], org[3], dir[3], along[3];
    any_triangle(aim, rng, v);
    uint32_t bits = (uint32_t)rng_u64(rng);
    float a = (float)((int)(bits & 7) - 4) * 0.5f, b = (float)((int)(bits >> 3 & 7) - 4) * 0.5f;
    float off = bits & 0x100u ? aim->extent * power_of_two(-8 - (int)(bits >> 9 & 15)) : 0.0f;
    aim_direction(rng, along);
    for (int k = 0; k < 3; k++) {
        float start = v[0][k] + 0.25f * (v[1][k] - v[0][k]) + 0.25f * (v[2][k] - v[0][k]);
        target->at[k] = start;
        org[k] = start + a * (v[1][k] - v[0][k]) + b * (v[2][k] - v[0][k]) + off * along[k];
        dir[k] = start - org[k];
    }
    aim_clamp_origin(org);
    aim_set(org, dir, out);
}

/* Rays of one kind in a row. */
#define RUN 4u

/* Of 64 rays, how many are of each kind or one before it: 48 are aimed at features. */
static const uint8_t kind_end[AIM_KINDS] = {13, 26, 31, 37, 48, 54, 58, 60, 63, 64};

/* Of 16 rays, how many come in each way or one before it; those at bounds mostly along them. */
static const uint8_t to_points[APPROACHES] = {5, 8, 10, 11, 12, 13, 15, 16};
static const uint8_t to_bounds[APPROACHES] = {2, 3, 4, 6, 11, 14, 15, 16};

static uint32_t choose(const uint8_t *end, uint32_t at)
{
    uint32_t i = 0;
    while (at >= end[i])
        i++;
    return i;
}

static struct aim_plan plan_run(struct rng *rng)
{
    uint64_t bits = rng_u64(rng);
    struct aim_plan plan = {.kind = (enum aim_kind)choose(kind_end, bits & 63)};
    bool bounds = plan.kind == AIM_CORNER || plan.kind == AIM_FACE || plan.kind == AIM_HALF;
    plan.approach = (enum approach)choose(bounds ? to_bounds : to_points, bits >> 8 & 15);
    plan.between = plan.kind == AIM_FACE ? 2 : bits >> 16 & 1;
    plan.moved = plan.kind == AIM_HALF ? 2 : bits >> 24 & 3;
    plan.range = bits >> 32 & 63;
    return plan;
}

static void aim_planned(const struct aim *aim, struct rng *rng, const struct aim_plan *plan,
                        struct ray *out, struct target *to)
{
    if (plan->kind == AIM_VERTEX)
        target_vertex(aim, rng, to);
    else if (plan->kind == AIM_EDGE)
        target_edge(aim, rng, to);
    else if (plan->kind == AIM_HALF)
        target_half(aim, rng, to);
    else if (plan->kind == AIM_INSIDE)
        target_inside(aim, rng, to);
    else
        target_box(aim, rng, plan->between, to);
    if (plan->moved < 2)
        displace(aim, rng, plan->moved == 0, to);
    float t = aim_approach(aim, rng, to, plan->approach, out);
    limit(rng, plan->range, t, out);
}

static void make_ray(const struct aim *aim, struct rng *rng, const struct aim_plan *plan,
                     struct ray *out, float target[3])
{
    struct target to = {.axis = (int)rng_below(rng, 3)};
    if (plan->kind == AIM_RANDOM || plan->kind == AIM_AXIS)
        random_ray(aim, rng, plan->kind == AIM_AXIS, out);
    else if (plan->kind == AIM_DEGENERATE)
        aim_degenerate(aim, rng, out);
    else if (plan->kind == AIM_GRAZING)
        grazing_ray(aim, rng, &to, out);
    else
        aim_planned(aim, rng, plan, out, &to);
    for (int k = 0; k < 3; k++)
        target[k] = to.at[k];
}

enum aim_kind aim_ray(const struct aim *aim, struct rng *rng, struct ray *out, float target[3])
{
    struct aim_plan plan = plan_run(rng);
    make_ray(aim, rng, &plan, out, target);
    return plan.kind;
}

void aim_rays(const struct aim *aim, struct rng *rng, struct ray *out, uint32_t count)
{
    for (uint32_t first = 0; first < count; first += RUN) {
        struct aim_plan plan = plan_run(rng);
        float target[3];
        for (uint32_t i = first; i < first + RUN && i < count; i++)
            make_ray(aim, rng, &plan, &out[i], target);
    }
}
