/* From where a ray comes to its target. */
#include "fuzz/gen/aim_inner.h"

#include "fuzz/gen/gen_sketch.h"

static float size_of(float x)
{
    return float_from_bits(float_bits(x) & 0x7FFFFFFFu);
}

static float zero_like(float x)
{
    return float_from_bits(float_bits(x) & 0x80000000u);
}

void aim_direction(struct rng *rng, float dir[3])
{
    /* 20 bits a component of one draw; x decides if all are small. */
    uint64_t bits = rng_u64(rng);
    for (int k = 0; k < 3; k++)
        dir[k] = (float)((int)(bits >> (20 * k) & 0xFFFFF) - 0x80000) * 0x1p-19f;
    if (size_of(dir[0]) < 0.03125f && size_of(dir[1]) < 0.03125f && size_of(dir[2]) < 0.03125f)
        dir[bits % 3] = 1.0f;
}

float aim_set(const float org[3], const float dir[3], struct ray *out)
{
    float largest = 0;
    for (int k = 0; k < 3; k++) {
        float size = size_of(dir[k]);
        largest = size > largest ? size : largest;
        out->org[k] = org[k];
        out->dir[k] = dir[k];
    }
    out->tmin = 0;
    out->tmax = 1e30f;
    if (!(largest > 0)) {
        out->dir[2] = 1.0f;
        return 1.0f;
    }
    float near = largest < 0x1p-90f ? 0x1p60f : 1.0f; /* subnormals have no exponent */
    int exponent = (int)(float_bits(largest * near) >> 23) - 127, shift = 0;
    if (exponent > 30)
        shift = 30 - exponent;
    else if (exponent < -30)
        shift = -30 - exponent;
    float least = 0x1p-59f * largest;
    for (int k = 0; k < 3; k++) {
        if (size_of(out->dir[k]) < least)
            out->dir[k] = zero_like(out->dir[k]);
        out->dir[k] = out->dir[k] * near * power_of_two(shift);
    }
    return power_of_two(-shift) / near;
}

/* The nearest multiple of the quantum, where floats are finer. */
static float snap(float x, float quantum)
{
    float steps = x / quantum;
    if (!(size_of(steps) < 0x1p23f))
        return x;
    int32_t whole = (int32_t)(steps < 0 ? steps - 0.5f : steps + 0.5f);
    return (float)whole * quantum;
}

static void from_feature(const struct aim *aim, struct rng *rng, float org[3])
{
    uint64_t bits = rng_u64(rng);
    if ((bits & 1) && aim->scene->tri_count > 0) {
        float v[3][3];
        scene_tri(aim->scene, rng_below(rng, aim->scene->tri_count), v);
        for (int k = 0; k < 3; k++)
            org[k] = v[bits >> 1 & 1][k];
        return;
    }
    const struct box *box = &aim->box[rng_below(rng, aim->box_count)];
    for (int k = 0; k < 3; k++)
        org[k] = bits >> (2 + k) & 1 ? box->hi[k] : box->lo[k];
}

void aim_clamp_origin(float org[3])
{
    for (int k = 0; k < 3; k++)
        org[k] = aim_clamped(org[k], 0x1p39f);
}

float aim_approach(const struct aim *aim, struct rng *rng, const struct target *target,
                   enum approach approach, struct ray *out)
{
    float org[3], dir[3], far = aim->extent;
    aim_direction(rng, dir);
    if (approach == APPROACH_NEAR)
        far *= power_of_two(-(int)rng_below(rng, 14));
    for (int k = 0; k < 3; k++) {
        if (approach == APPROACH_AXIS && k != target->axis)
            dir[k] = 0;
        else if (approach == APPROACH_PLANE && k == target->axis)
            dir[k] = 0;
        else if (approach == APPROACH_NEARLY && k == target->axis)
            dir[k] *= 0x1p-14f;
    }
    if (approach == APPROACH_ANY)
        for (int k = 0; k < 3; k++)
            org[k] = aim->centre[k] + 0.75f * far * dir[k];
    else if (approach == APPROACH_OUTSIDE || approach == APPROACH_LATTICE)
        for (int k = 0; k < 3; k++)
            org[k] = aim->centre[k] + 2.0f * far * dir[k];
    else if (approach == APPROACH_FEATURE)
        from_feature(aim, rng, org);
    else
        for (int k = 0; k < 3; k++)
            org[k] = target->at[k] - far * dir[k];
    if (approach == APPROACH_LATTICE)
        for (int k = 0; k < 3; k++)
            org[k] = snap(org[k], aim->quantum);
    aim_clamp_origin(org);
    uint64_t signs = rng_u64(rng);
    for (int k = 0; k < 3; k++) {
        dir[k] = target->at[k] - org[k];
        if (dir[k] == 0 && (signs >> k & 1))
            dir[k] = -0.0f;
    }
    return aim_set(org, dir, out);
}

/* --- rays that may be out of contract
 * ---------------------------------------------------------------------
 */

void aim_degenerate(const struct aim *aim, struct rng *rng, struct ray *out)
{
    static const float odd[] = {0.0f, -0.0f, 0x1p-149f, 0x1p-130f, 0x1p-126f, 1e-19f, 0x1p-61f};
    const struct target target = {{aim->centre[0], aim->centre[1], aim->centre[2]}, 0};
    aim_approach(aim, rng, &target, (enum approach)rng_below(rng, APPROACHES), out);
    uint32_t kind = rng_below(rng, 16), k = rng_below(rng, 3);
    uint32_t which = rng_below(rng, ARRAY_COUNT(odd));
    int exponent = (int)rng_below(rng, 240) - 120;
    float sign = rng_below(rng, 2) ? 1.0f : -1.0f;
    if (kind < 6) { /* a component that is zero, subnormal or negligible */
        out->dir[k] = sign * odd[which];
    } else if (kind < 8) {
        out->dir[k] = sign * odd[which];
        out->dir[(k + 1) % 3] = out->dir[k];
    } else if (kind < 11) { /* as fast or slow as float32 can be */
        for (int c = 0; c < 3; c++) {
            float scaled = out->dir[c] * power_of_two(exponent);
            out->dir[c] = float_is_finite(scaled) ? scaled : out->dir[c];
        }
    } else if (kind == 11) {
        out->dir[0] = out->dir[1] = out->dir[2] = 0;
    } else if (kind == 12) {
        out->tmin = 1.0f, out->tmax = 0.5f;
    } else if (kind == 13) {
        out->tmin = out->tmax = 1.0f;
    } else if (kind == 14) {
        out->tmin = -1.0f;
    } else { /* no numbers: one ray in some thousand */
        static const uint32_t none[] = {0x7FC00000u, 0x7F800000u, 0xFF800000u};
        float *place[] = {&out->org[k], &out->dir[k], &out->tmin, &out->tmax};
        uint32_t bits = none[rng_below(rng, 3)];
        *place[rng_below(rng, 4)] = float_from_bits(bits);
    }
}
