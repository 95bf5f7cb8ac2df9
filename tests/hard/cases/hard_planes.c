/* Hard cases of lattices: rays exactly on borders, grid lines, vertices, planes and range ends. All
 * numbers are small multiples of powers of two, so that the triangle tests compute without an
 * error: every true hit must be found. */
#include "tests/hard/parts.h"

#define N 16 /* cells of the grid */

static uint32_t cell(uint32_t i, uint32_t j)
{
    return 2 * (i + N * j);
}

/* Writes the triangles of the grid with an edge on the line x = i (across) or y = i, between whole
 * lines: one on the border, else two. Returns how many. */
static uint32_t on_line(int across, uint32_t i, uint32_t at, uint32_t id[2])
{
    uint32_t n = 0;
    if (i > 0) /* the cell before it: its lower right triangle ends at x = i, the other at y = i */
        id[n++] = across ? cell(at, i - 1) + 1 : cell(i - 1, at);
    if (i < N)
        id[n++] = across ? cell(at, i) : cell(i, at) + 1;
    return n;
}

static void aim_at_lines(struct hard_part *part, struct rng *rng, uint32_t i)
{
    for (int across = 0; across < 2; across++)
        for (int sign = 0; sign < 4; sign++) {
            float at = off_lines(rng, N), zero = sign & 1 ? -0.0f : 0.0f,
                  d = sign & 2 ? -1.0f : 1.0f;
            float x = across ? at : (float)i, y = across ? (float)i : at;
            uint32_t id[2], n = on_line(across, i, (uint32_t)at, id);
            part_ray(part, ray_of(x, y, 1 - d, zero, zero, d));
            want_ids(part, HARD_ALL, n, id);
            want_t(part, HARD_ALL, 1);
        }
}

static void make_border(struct hard_made *made)
{
    static const char *const names[] = {"minimum", "maximum"};
    for (uint32_t side = 0; side < 2; side++) {
        struct hard_part *part = part_add(made, "%s border", names[side]);
        struct rng rng = rng_make(3, side);
        part_grid(part, N, 2, 1, 1, 0);
        for (int i = 0; i < 8; i++)
            aim_at_lines(part, &rng, side * N);
        for (int corner = 0; corner < 2; corner++) { /* the two corners on this side */
            float y = corner ? N : 0.0f;
            for (int sign = 0; sign < 2; sign++)
                expect_t(part, HARD_ALL, ray_of((float)(side * N), y, 0, sign ? -0.0f : 0.0f, 0, 1),
                         1);
        }
    }
}

static void make_lines(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(4, 0);
    for (uint32_t i = 1; i < N; i++)
        aim_at_lines(part, &rng, i);
    for (int i = 0; i < 32; i++) { /* diagonals of cells */
        uint32_t c = rng_below(&rng, N), r = rng_below(&rng, N);
        float f = 0.125f * (1 + whole(&rng, 7));
        struct ray ray = ray_of((float)c + f, (float)r + f, 0, 0, 0, 1);
        part_ray(part, ray);
        want_range(part, HARD_ALL, cell(c, r), 2);
    }
}

static void make_grid_vertices(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    for (uint32_t j = 1; j < N; j++)
        for (uint32_t i = 1; i < N; i++) {
            uint32_t id[6] = {cell(i, j),         cell(i, j) + 1,         cell(i - 1, j),
                              cell(i, j - 1) + 1, cell(i - 1, j - 1) + 1, cell(i - 1, j - 1)};
            float d = (i + j) % 2 ? -1.0f : 1.0f;
            struct ray ray = ray_of((float)i, (float)j, 1 - d, 0, 0, d);
            part_ray(part, ray);
            want_ids(part, HARD_ALL, 6, id);
            want_t(part, HARD_ALL, 1);
        }
}

static void make_in_plane(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(11, 0);
    for (int i = 0; i < 64; i++) {
        float dx = i % 2 ? 1.0f : -1.0f, dy = whole(&rng, 5) - 2;
        struct ray ray =
            ray_of(dx > 0 ? -3.0f : N + 3.0f, 0.125f * whole(&rng, 8 * N), 1, dx, 0.25f * dy, 0);
        ray.dir[2] = i & 4 ? -0.0f : 0.0f;
        expect_miss(part, HARD_OWN, ray);
    }
    part = part_open(made, "soup:n=200,size=1"); /* a plane that is not a lattice plane */
    for (int i = 0; i < 200 && !part->failed; i++) {
        float v[3][3], from[3], to[3];
        scene_tri(&part->scene, (uint32_t)i, v);
        for (int k = 0; k < 3; k++) {
            float half = 0.5f * (v[1][k] + v[2][k]);
            to[k] = half;
            from[k] = v[0][k] - 2 * (half - v[0][k]);
        }
        part_ray(part, ray_at(from, to));
    }
}

static void make_along_edge(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    for (uint32_t i = 0; i <= N; i++)
        for (int way = 0; way < 4; way++) {
            float from = way & 1 ? -3.0f : N + 3.0f, d = way & 1 ? 1.0f : -1.0f;
            struct ray ray =
                way & 2 ? ray_of(from, (float)i, 1, d, 0, 0) : ray_of((float)i, from, 1, 0, d, 0);
            expect_miss(part, HARD_OWN, ray);
        }
    part = part_add(made, "cube");
    part_cube(part, 0, 4);
    for (int way = 0; way < 8; way++) { /* along edges of a cube: its end faces are hit */
        float d = way & 1 ? 1.0f : -1.0f;
        struct ray ray =
            ray_of(way & 1 ? -4.0f : 8.0f, way & 2 ? 4.0f : 0, way & 4 ? 4.0f : 0, d, 0, 0);
        expect_t(part, HARD_OWN, ray, 4);
    }
}

static void make_near_plane(struct hard_made *made)
{
    static const float slopes[] = {1e-5f, 1e-6f, 1e-7f};
    for (size_t s = 0; s < ARRAY_COUNT(slopes); s++) {
        float slope = slopes[s];
        struct hard_part *part = part_add(made, "%g", (double)slope);
        struct rng rng = rng_make(13, s);
        part_grid(part, N, 2, 1, 1, 0);
        for (int i = 0; i < 64; i++) {
            float x = rng_range(&rng, 1, N - 1), y = rng_range(&rng, 1, N - 1);
            float dy = rng_range(&rng, -0.2f, 0.2f);
            float from[3] = {x - 8, y - 8 * dy, 1 + (i % 2 ? 8 : -8) * slope};
            part_ray(part, ray_at(from, (const float[3]){x, y, 1}));
        }
    }
}

static void make_lattice(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "lattice soup");
    struct rng rng = rng_make(16, 0);
    for (int i = 0; i < 300; i++) {
        float v[3][3], at[3];
        for (int k = 0; k < 3; k++)
            at[k] = whole(&rng, 13) - 6;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                v[c][k] = at[k] + whole(&rng, 5) - 2;
        part_tri_of(part, v);
    }
    for (int i = 0; i < 400; i++) {
        struct ray ray = ray_of(0, 0, 0, 0, 0, 0);
        for (int k = 0; k < 3; k++) {
            ray.org[k] = whole(&rng, 17) - 8;
            ray.dir[k] = whole(&rng, 5) - 2;
        }
        if (ray.dir[0] == 0 && ray.dir[1] == 0 && ray.dir[2] == 0)
            ray.dir[2] = 1;
        part_ray(part, ray);
    }
}

static void make_on_surface(struct hard_made *made)
{
    static const float first[] = {0, 0x1p-149f, 1e-30f, 0x1p-24f};
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(17, 0);
    for (int i = 0; i < 48; i++)
        for (size_t s = 0; s < ARRAY_COUNT(first); s++) {
            float dx = i % 3 ? 0.5f : 0, dz = i % 2 ? 1.0f : -1.0f;
            float y = off_lines(&rng, N), x = off_lines(&rng, N);
            struct ray ray = ray_of(x, y, 1, dx, 0, dz);
            ray.tmin = first[s];
            part_ray(part, ray);
            if (s == 0)
                want(part, HARD_OWN, WANT_ENDS);
            else if (s > 1)
                want(part, HARD_OWN, WANT_MISS);
        }
}

static void make_on_vertex(struct hard_made *made)
{
    struct hard_part *part = part_floor(made, "grid", N, 1);
    struct rng rng = rng_make(18, 0);
    for (int i = 0; i < 96; i++) {
        float dy = whole(&rng, 3) - 1, dx = whole(&rng, 3) - 1;
        float y = whole(&rng, N + 1), x = whole(&rng, N + 1);
        struct ray ray = ray_of(x, y, 1, dx, dy, (float)(i % 3) - 1);
        part_ray(part, ray);
        want(part, HARD_OWN, ray.dir[2] != 0 ? WANT_ENDS : WANT_MISS);
    }
}

const struct hard_case hard_planes_cases[] = {
    {
        .number = 3,
        .name = "border",
        .recipe = "d = (+-0, +-0, +-1), origin exactly over the least and the greatest border",
        .expected = "the border's triangle at t = 1, on both sides alike",
        .source = "RenderKit/embree#589, jbikker/tinybvh#286, NVIDIA/warp#1530: 1/0 made finite",
        .defect = {{.fault = "Embree loses rays on the maximum border of a flat grid",
                    .cause = CAUSE_PARALLEL_AXIS,
                    .members = "*.embree*.-.-.-.*",
                    .version = "Embree 3..4.3.3"},
                   {.fault = "lavapipe's ray query loses rays on the maximum border of a flat grid",
                    .cause = CAUSE_PARALLEL_AXIS,
                    .members = "*.rayquery.-.-.-.*",
                    .version = "Mesa 25."}},
        .make = make_border,
    },
    {
        .number = 4,
        .name = "grid-lines",
        .recipe = "d along z, origin exactly over inner grid lines and diagonals",
        .expected = "one of the two triangles, t = 1",
        .source = "jbikker/tinybvh#168: gaps on an integer mesh",
        .make = make_lines,
    },
    {
        .number = 5,
        .name = "grid-vertices",
        .recipe = "d along z, origin exactly over every inner vertex of the grid",
        .expected = "one of the six triangles, t = 1",
        .source = "RenderKit/embree#181, #174: rays through vertices",
        .make = make_grid_vertices,
    },
    {
        .number = 11,
        .name = "in-plane",
        .recipe = "rays in the plane of a triangle, across it: exactly (grid) and rounded (soup)",
        .expected = "grid: a miss; soup: a miss, or t within the overlap",
        .source = "RenderKit/embree#387 (t = 12291), #298: the determinant is noise",
        .make = make_in_plane,
    },
    {
        .number = 12,
        .name = "along-edge",
        .recipe = "rays in the plane along shared edges of a grid, and along the edges of a cube",
        .expected = "grid: a miss; cube: the end face's corner at t = 4",
        .source = "numerics.md 4, 12; aevyrie/bevy_mod_raycast#119: NaN on edges",
        .make = make_along_edge,
    },
    {
        .number = 13,
        .name = "near-plane",
        .recipe = "rays of 11 rotated out of the plane by 1e-5, 1e-6, 1e-7",
        .expected = "what the oracle says, within the proven bounds",
        .source = "RenderKit/embree#387: phantom hits of grazing rays",
        .make = make_near_plane,
    },
    {
        .number = 16,
        .name = "lattice",
        .recipe =
            "triangles, origins and directions of small whole numbers: exact zeros everywhere",
        .expected = "one of the exact nearest set",
        .source = "jbikker/tinybvh#168; numerics.md 4, 16: filter fall-through, double counting",
        .make = make_lattice,
    },
    {
        .number = 17,
        .name = "on-surface",
        .recipe = "the origin on a triangle, exactly; tmin = 0, the smallest float, 1e-30, 2^-24",
        .expected = "tmin = 0: a hit where ends count, else a miss; a miss for 1e-30 and 2^-24",
        .source = "RenderKit/embree#133; Cycles T43835, T54284: rays that start on a surface",
        .make = make_on_surface,
    },
    {
        .number = 18,
        .name = "on-vertex",
        .recipe = "the origin is a vertex; directions out of the plane, in it, and zero",
        .expected = "t = 0: a hit where ends count; in the plane a miss",
        .source = "numerics.md 4, 18: 0 / 0",
        .make = make_on_vertex,
    },
    {0},
};
