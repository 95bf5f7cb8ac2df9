/* Known bugs of other tools, found again: nearest halves, a padding that is too small. */
#include "tests/hard/made.h"
#include "tests/hard/parts.h"

#include <math.h>

/* Rays at points beside vertices of a sphere, inside their triangles: bounds rounded inward by half
 * a step of float16 lose some. */
static void make_nearest(struct hard_made *made)
{
    struct hard_part *sphere = part_open(made, "sphere:n=8");
    struct rng rng = rng_make(79, 0);
    /* Triangle 0 lies elsewhere: the paper's record loses it. */
    struct hard_part *part = part_add(made, "sphere");
    part_triangle(part, -99, -99, -99, -98, -99, -99, -99, -98, -99);
    part_split(part, sphere);
    for (uint32_t i = 0; i < 1000 && !part->failed; i++) {
        float v[3][3], from[3], to[3];
        scene_tri(&part->scene, 1 + rng_below(&rng, part->scene.tri_count - 1), v);
        uint32_t c = rng_below(&rng, 3);
        random_far(&rng, 10, from);
        for (int k = 0; k < 3; k++)
            to[k] = 0.998f * v[c][k] + 0.001f * v[(c + 1) % 3][k] + 0.001f * v[(c + 2) % 3][k];
        part_ray(part, ray_at(from, to));
    }
}

/* Returns the float next to t d, which is exact in double (31 bits and 13 bits). *org is the
 * rounding error: from there the plane is hit at exactly t. */
static float plane_at(double t, float d, float *org)
{
    double product = t * (double)d;
    float plane = (float)product;
    *org = (float)((double)plane - product);
    return plane;
}

/* The ray meets an edge of a triangle's box in one point, where the near plane of x and the far
 * plane of y are both exactly at t. 1 / dx and the difference in x are rounded up, 1 / dy and that
 * in y down, each by nearly half a step. */
static void make_padding(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "corners");
    struct rng rng = rng_make(80, 0);
    const float dx = 0x1.da2p+0f, dy = 0x1.da7ap+0f, most = 0x1.cp-24f;
    part->leaf = 1;
    for (int i = 0; i < 400 && !part->failed;) {
        float ox, oy, z = 4 * (float)i;
        double t = i == 0 ? 0x1.1582bf04p0 : 1 + ldexp((double)rng_below(&rng, 1u << 30), -32);
        float x = plane_at(t, dx, &ox), y = plane_at(t, dy, &oy);
        if (ox < most || oy > -most)
            continue;
        part_triangle(part, x, y, z - 1, x, y, z + 1, x + 2, y - 2, z);
        part_ray(part, ray_of(ox, oy, z, dx, dy, 0));
        i++;
    }
}

const struct hard_case hard_known_cases[] = {
    {
        .number = 79,
        .name = "nearest-halves",
        .recipe = "rays at points a thousandth beside the vertices of a sphere",
        .expected = "what brute force hits: boxes hold their triangles",
        .source = "gkjohnson/three-mesh-bvh#169; RTRS's F11, rf.rs:87",
        .make = make_nearest,
        .defect = {{.fault = "bounds rounded to the nearest half",
                    .cause = CAUSE_ROUNDED_INWARD,
                    .members = "closest.cpu.*",
                    .layout = &layout_rf16_nearest},
                   {.fault = "RTRS's fault F11: bounds rounded to the nearest half",
                    .cause = CAUSE_ROUNDED_INWARD,
                    .members = "closest.*.rtrs_rf_paper.median.robust.mt"}},
    },
    {
        .number = 80,
        .name = "padding-4u",
        .recipe =
            "rays that touch an edge of a box at a t of 31 bits, near x and far y exactly equal",
        .expected = "what brute force hits: a far plane times 1.00000024 (1 + 4 u) loses some",
        .source = "numerics.md 3.4: nanort, Yocto/GL; the factor is attributed to Ize 2013",
        .make = make_padding,
        .defect = {{.fault = "the far plane times 1.00000024",
                    .cause = CAUSE_BOX_PADDING_TOO_SMALL,
                    .members = "closest.padded_4u.*.mt",
                    .engine = &engine_padded_4u}},
    },
    {0},
};
