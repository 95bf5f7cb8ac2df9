/* Where instances are placed. */
#include "fuzz/gen/gen_world.h"

#include "fuzz/gen/gen_sketch.h"

#include <string.h>

static float draw_signed(struct rng *rng)
{
    return 2.0f * rng_float(rng) - 1.0f;
}

static void set_diagonal(struct instance *out, float x, float y, float z)
{
    const float diagonal[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->m[i][j] = i == j ? diagonal[i] : 0.0f;
}

/* A rotation of a quaternion divided by its squared length, so that no angle is a round one. */
static void set_turned(struct rng *rng, struct instance *out)
{
    float q[4], length2 = 0;
    for (int k = 0; k < 4; k++)
        q[k] = draw_signed(rng);
    q[3] += q[3] < 0 ? -0.25f : 0.25f; /* never 0 as a whole */
    for (int k = 0; k < 4; k++)
        length2 += q[k] * q[k];
    const float twice = 2.0f / length2;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out->m[i][i] = 1.0f - twice * (q[j] * q[j] + q[k] * q[k]);
        out->m[i][j] = twice * (q[i] * q[j] - q[k] * q[3]);
        out->m[i][k] = twice * (q[i] * q[k] + q[j] * q[3]);
    }
}

/* Rows of M times a number each. */
static void scale_rows(struct instance *out, const float by[3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->m[i][j] *= by[i];
}

static void set_scaled(struct rng *rng, struct instance *out)
{
    float size = power_of_two((int)rng_below(rng, 25) - 12);
    set_diagonal(out, size, size, size);
}

/* Along each axis by another power of two, or by any number. */
static void set_stretched(struct rng *rng, struct instance *out)
{
    float by[3];
    bool powers = rng_below(rng, 2);
    for (int k = 0; k < 3; k++) {
        float any = 0.001f + rng_float(rng);
        by[k] = power_of_two((int)rng_below(rng, 13) - 6);
        by[k] = powers ? by[k] : by[k] * any;
    }
    set_diagonal(out, by[0], by[1], by[2]);
}

static void set_tiny(struct rng *rng, struct instance *out)
{
    static const float small[3] = {1e-6f, 1e-6f, 1e-6f};
    set_turned(rng, out);
    scale_rows(out, small);
}

static void set_mirrored(struct rng *rng, struct instance *out)
{
    float by[3] = {1, 1, 1};
    by[rng_below(rng, 3)] = -1.0f;
    if (rng_below(rng, 2))
        set_turned(rng, out);
    scale_rows(out, by);
}

/* Axes are exchanged, some with the other sign. */
static void set_permuted(struct rng *rng, struct instance *out)
{
    uint32_t bits = (uint32_t)rng_u64(rng), first = (bits >> 8) % 3;
    set_diagonal(out, 0, 0, 0);
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t j = bits & 8 ? (first + i) % 3 : (first + 3 - i) % 3;
        out->m[i][j] = bits >> i & 1 ? -1.0f : 1.0f;
    }
}

static void set_sheared(struct rng *rng, struct instance *out)
{
    for (int i = 0; i < 2; i++)
        for (int j = i + 1; j < 3; j++) {
            float whole = (float)rng_below(rng, 5) - 2.0f, any = 2.0f * draw_signed(rng);
            out->m[i][j] = rng_below(rng, 2) ? whole : any;
        }
}

/* The third row is a sum of the others, but for a little. */
static void set_thin(struct rng *rng, struct instance *out)
{
    int exponent = -4 - (int)rng_below(rng, 20);
    set_sheared(rng, out);
    for (int j = 0; j < 3; j++)
        out->m[2][j] = out->m[0][j] + 0.5f * out->m[1][j];
    out->m[2][rng_below(rng, 3)] += power_of_two(exponent);
}

/* Any numbers. */
static void set_any(struct rng *rng, struct instance *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->m[i][j] = draw_signed(rng);
}

static void set_linear(struct rng *rng, struct instance *out)
{
    static void (*const how[])(struct rng *, struct instance *) = {
        set_scaled,   set_stretched, set_turned,  set_turned, set_tiny,
        set_mirrored, set_permuted,  set_sheared, set_thin,   set_any};
    set_diagonal(out, 1, 1, 1);
    if (rng_below(rng, 3) > 0)
        how[rng_below(rng, ARRAY_COUNT(how))](rng, out);
}

static float extent_of(const struct box *box, int k)
{
    float extent = box->hi[k] - box->lo[k];
    return float_is_finite(extent) ? extent : 1.0f;
}

/* Within some sizes of the mesh, on a lattice in half of the cases; one in 16 a million of them
 * away. */
static void set_moved(struct rng *rng, const struct box *box, struct instance *out)
{
    bool lattice = rng_below(rng, 2), far = rng_below(rng, 16) == 0;
    for (int k = 0; k < 3; k++) {
        float steps = (float)rng_below(rng, 5) - 2.0f, any = 2.0f * draw_signed(rng);
        float size = extent_of(box, k) * (far ? 0x1p20f : 1.0f);
        out->m[k][3] = (lattice ? steps : any) * size;
    }
}

/* As it is placed before, moved along an axis of the mesh by its size there: their boxes touch. */
static void set_touching(struct rng *rng, const struct box *box, const struct instance *before,
                         struct instance *out)
{
    int axis = (int)rng_below(rng, 3);
    float by = rng_below(rng, 2) ? extent_of(box, axis) : -extent_of(box, axis);
    memcpy(out->m, before->m, sizeof out->m);
    for (int k = 0; k < 3; k++)
        out->m[k][3] += out->m[k][axis] * by;
}

bool gen_transform_is_good(const struct instance *instance)
{
    for (int k = 0; k < 12; k++)
        if (!float_is_finite(instance->m[k / 4][k % 4]))
            return false;
    return instance_det_sign(instance->m) != 0;
}

void gen_place(struct rng *rng, const struct box *box, const struct instance *before,
               struct instance *out)
{
    uint32_t how = rng_below(rng, 8);
    set_diagonal(out, 1, 1, 1);
    for (int k = 0; k < 3; k++)
        out->m[k][3] = 0;
    if (before && how < 2) {
        set_touching(rng, box, before, out);
    } else if (before && how == 2) {
        memcpy(out->m, before->m, sizeof out->m);
    } else {
        set_linear(rng, out);
        if (how != 3)
            set_moved(rng, box, out);
    }
    if (gen_transform_is_good(out))
        return;
    set_diagonal(out, 1, 1, 1);
    for (int k = 0; k < 3; k++)
        out->m[k][3] = 0;
}

void gen_instance_members(struct rng *rng, uint32_t index, struct instance *out)
{
    static const uint32_t forced[] = {
        0, 0, 0, 0, 0, 0, ABI_INSTANCE_FORCE_OPAQUE, ABI_INSTANCE_FORCE_NO_OPAQUE};
    static const uint32_t facing[] = {0, 0, 0, 0, 1, 1, 2, 3}; /* CULL_DISABLE, FLIP_FACING */
    uint32_t mask = rng_below(rng, 8), bits = rng_below(rng, 256), bit = rng_below(rng, 8);
    uint32_t custom = rng_below(rng, 4), any = rng_below(rng, ABI_CUSTOM_MOST + 1);
    out->mask = mask < 5 ? 0xFF : mask == 5 ? 1u << bit : bits;
    out->flags = facing[rng_below(rng, ARRAY_COUNT(facing))];
    out->flags |= forced[rng_below(rng, ARRAY_COUNT(forced))];
    out->custom = custom < 2 ? index : custom == 2 ? any : ABI_CUSTOM_MOST - index;
    if (rng_below(rng, 16) == 0)
        out->mesh = WORLD_NO_MESH;
}

struct filter_rule gen_filter(struct rng *rng)
{
    static const enum filter_kind kinds[] = {FILTER_ALL, FILTER_ALL, FILTER_NONE, FILTER_TRIANGLES,
                                             FILTER_CELLS};
    struct filter_rule filter = {.share = 128};
    filter.kind = kinds[rng_below(rng, ARRAY_COUNT(kinds))];
    filter.seed = rng_below(rng, 1024);
    return filter;
}
