/* Bugs of Vulkan drivers, each on the driver that has it (make drivers) and on others. */
#include "tests/hard/driver.h"
#include "tests/hard/parts.h"

#define LAVAPIPE_BOX "Mesa's lvp_build_intersect_ray_box: 1 / 0 is FLT_MAX, no padding"

/* A flat grid of 16 x 16 quads around 0 and rays straight at its borders. */
static void make_borders(struct hard_made *made)
{
    static const char *const names[] = {"least x", "least y", "greatest x", "greatest y"};
    for (int side = 0; side < 4; side++) {
        struct hard_part *part = part_add(made, "%s", names[side]);
        part_grid(part, 16, 2, 0, 1, -8);
        for (int i = 0; i <= 32; i++) {
            float along = 0.5f * (float)i - 8, across = side < 2 ? -8.0f : 8.0f;
            struct ray ray =
                side % 2 ? ray_of(along, across, -1, 0, 0, 1) : ray_of(across, along, -1, 0, 0, 1);
            expect_t(part, HARD_ALL, ray, 1);
        }
    }
}

/* Rays that Embree's robust mode loses: the first of 62 among 200,000 rays like those below. */
static const float robust_loses[][2][3] = {
    {{0x1.1d4c2p-4f, -0x1.72f8c4p-3f, -0x1.208b9p-5f},
     {-0x1.db048ap-1f, 0x1.7cc148p-2f, -0x1.c41acep-2f}},
    {{-0x1.c64d9p-3f, 0x1.0d5a28p-3f, 0x1.004be8p-3f},
     {0x1.9e1b82p-2f, -0x1.0b5d2ep+0f, -0x1.f60f68p-2f}},
    {{-0x1.b5b9p-7f, 0x1.a9e3cp-3f, -0x1.9fbb7p-5f},
     {-0x1.48d53cp-1f, -0x1.34d9e8p-2f, 0x1.999bdcp-1f}},
    {{0x1.4d3498p-3f, -0x1.634468p-3f, -0x1.ad9d94p-3f},
     {-0x1.1a388p-1f, 0x1.0c3152p+0f, 0x1.0097e8p-1f}},
    {{-0x1.6f28bcp-3f, 0x1.7ea07p-5f, -0x1.09168p-3f},
     {0x1.69a33p-1f, 0x1.61df64p-1f, 0x1.1a267p-1f}},
    {{-0x1.fdd8cp-5f, 0x1.73a288p-4f, 0x1.660944p-3f},
     {0x1.0ea2f2p+0f, -0x1.4b5cccp-3f, -0x1.a8fb7ap-4f}},
    {{-0x1.810e5p-3f, 0x1.5fad2p-6f, -0x1.61073cp-3f},
     {0x1.094cecp-2f, -0x1.0432ep+0f, 0x1.f292c4p-3f}},
    {{0x1.e24a68p-3f, -0x1.a8a38cp-3f, -0x1.35bbp-3f},
     {-0x1.1063p+0f, 0x1.329616p-2f, 0x1.683bbp-1f}},
};

/* From inside a closed sphere at its vertices. The direction is the rounded difference, so that
 * most rays pass very close to the vertex. */
static void make_vertices(struct hard_made *made)
{
    struct hard_part *part = part_open(made, "sphere:n=16");
    struct rng rng = rng_make(82, 0);
    for (uint32_t i = 0; i < 800 && !part->failed; i++) {
        float from[3], to[3];
        part_corner(part, rng_below(&rng, part->scene.vertex_count), to);
        random_point(&rng, -0.25f, 0.25f, from);
        expect_hit(part, HARD_FANS, ray_at(from, to));
    }
    for (size_t i = 0; i < ARRAY_COUNT(robust_loses); i++) {
        const float *o = robust_loses[i][0], *d = robust_loses[i][1];
        struct ray ray = ray_of(o[0], o[1], o[2], d[0], d[1], d[2]);
        expect_hit(part, HARD_FANS, ray);
    }
}

#define PACK_RECIPE   "packHalf2x16 of 196,608 floats of all exponents"
#define PACK_EXPECTED "the nearest half, ties to even"
#define PACK_SOURCE   "Vulkan, Precision of conversions; GPUOpen FSR#21, DirectXMath#104"
#define LOOP_RECIPE   "loops of 100,000 rounds: one, two in turn, two nested"
#define LOOP_EXPECTED "every round is run"
#define LOOP_SOURCE   "Mesa's LP_MAX_TGSI_LOOP_ITERATIONS, dropped by merge request 31426"

const struct hard_case hard_drivers_cases[] = {
    {
        .number = 81,
        .name = "borders-mesa25",
        .recipe = "rays along z exactly at the four borders of a flat grid, on driver mesa25",
        .expected = "a hit at t = 1 on all of them",
        .source = LAVAPIPE_BOX "; RenderKit/embree#589",
        .flags = HARD_NO_TREES,
        .driver = "mesa25",
        .make = make_borders,
        .defect = {{.fault = "lavapipe's ray query loses rays on the maximum border of a flat grid",
                    .cause = CAUSE_PARALLEL_AXIS,
                    .members = "*.rayquery.*",
                    .version = "Mesa 25."},
                   {.fault = "Embree loses rays on the maximum border of a flat grid",
                    .cause = CAUSE_PARALLEL_AXIS,
                    .members = "*.embree*",
                    .version = "Embree 3..4.3.3"}},
    },
    {
        .number = 82,
        .name = "vertices-mesa25",
        .recipe = "rays from inside a closed sphere at its vertices, on driver mesa25",
        .expected =
            "a hit: watertight tests promise it, Vulkan says \"should\", so does Embree's robust",
        .source = LAVAPIPE_BOX "; RenderKit/embree#181",
        .flags = HARD_NO_TREES,
        .driver = "mesa25",
        .make = make_vertices,
        .defect = {{.fault = "lavapipe's ray query leaks at vertices",
                    .cause = CAUSE_OUTSIDE,
                    .members = "*.rayquery.*",
                    .version = "Mesa 25."},
                   {.fault = "Embree's robust mode shoots through vertices",
                    .cause = CAUSE_OUTSIDE,
                    .members = "*.embree_robust.*",
                    .version = "Embree 3..4.3.3",
                    .rare = true}},
    },
    {
        .number = 83,
        .name = "pack-swiftshader",
        .recipe = PACK_RECIPE ", on driver swiftshader",
        .expected = PACK_EXPECTED,
        .source = PACK_SOURCE,
        .driver = "swiftshader",
        .probe = driver_packs_halves,
        .defect = {{.fault = "SwiftShader's packHalf2x16",
                    .members = "closest.vulkan.*",
                    .version = "SwiftShader"}},
    },
    {
        .number = 84,
        .name = "pack-stock",
        .recipe = PACK_RECIPE ", on driver stock",
        .expected = PACK_EXPECTED,
        .source = PACK_SOURCE,
        .driver = "stock",
        .probe = driver_packs_halves,
    },
    {
        .number = 85,
        .name = "pack-mesa25",
        .recipe = PACK_RECIPE ", on driver mesa25",
        .expected = PACK_EXPECTED,
        .source = PACK_SOURCE,
        .driver = "mesa25",
        .probe = driver_packs_halves,
    },
    {
        .number = 86,
        .name = "loop-stock",
        .recipe = LOOP_RECIPE ", on driver stock",
        .expected = LOOP_EXPECTED,
        .source = LOOP_SOURCE,
        .driver = "stock",
        .probe = driver_runs_loops,
        .defect = {{.fault = "lavapipe's loops end after 65,535 rounds",
                    .members = "closest.vulkan.*",
                    .version = "Mesa 22.3.6"}},
    },
    {
        .number = 87,
        .name = "loop-mesa25",
        .recipe = LOOP_RECIPE ", on driver mesa25",
        .expected = LOOP_EXPECTED,
        .source = LOOP_SOURCE,
        .driver = "mesa25",
        .probe = driver_runs_loops,
    },
    {
        .number = 88,
        .name = "loop-swiftshader",
        .recipe = LOOP_RECIPE ", on driver swiftshader",
        .expected = LOOP_EXPECTED,
        .source = LOOP_SOURCE,
        .driver = "swiftshader",
        .probe = driver_runs_loops,
    },
    {0},
};
