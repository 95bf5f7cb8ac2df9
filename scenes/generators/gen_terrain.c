#include "scenes/generators/pen.h"

enum { K, ROUGHNESS, HEIGHT };

/* (n + 1) x (n + 1) heights, stored in the y of the scene's vertices. */
struct terrain_field {
    struct scene *scene;
    int n;
};

static float *height_at(const struct terrain_field *field, int x, int z)
{
    return &field->scene->vertex[3 * ((size_t)z * ((size_t)field->n + 1) + (size_t)x) + 1];
}

/* Mean of the four points at distance `half` along the axes or diagonals, without those outside the
 * field. */
static float mean_around(const struct terrain_field *field, int x, int z, int half, bool diagonal)
{
    static const int8_t step[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}},
                                         {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    float sum = 0.0f;
    int count = 0;
    for (int i = 0; i < 4; i++) {
        int a = x + half * step[diagonal][i][0], b = z + half * step[diagonal][i][1];
        if (a < 0 || b < 0 || a > field->n || b > field->n)
            continue;
        sum += *height_at(field, a, b);
        count++;
    }
    return sum / (float)count;
}

/* Diamond-square: first the centres of the squares, then the middles of their sides. */
static void raise_field(const struct terrain_field *field, float roughness, float amplitude,
                        struct rng *rng)
{
    int n = field->n;
    for (int i = 0; i < 4; i++)
        *height_at(field, i & 1 ? n : 0, i & 2 ? n : 0) = rng_range(rng, -amplitude, amplitude);
    for (int half = n / 2; half >= 1; half /= 2) {
        for (int z = half; z < n; z += 2 * half)
            for (int x = half; x < n; x += 2 * half)
                *height_at(field, x, z) =
                    mean_around(field, x, z, half, true) + rng_range(rng, -amplitude, amplitude);
        for (int z = 0; z <= n; z += half)
            for (int x = z / half % 2 ? 0 : half; x <= n; x += 2 * half)
                *height_at(field, x, z) =
                    mean_around(field, x, z, half, false) + rng_range(rng, -amplitude, amplitude);
        amplitude *= roughness;
    }
}

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = 1u << (uint32_t)value[K];
    enum status status = pen_start(pen, PEN_QUAD_VERTICES(n), 2 * (uint64_t)n * n, reason);
    if (status)
        return status;
    pen_quad(pen, (const double[3]){-0.5, 0, 0.5}, (const double[3]){1, 0, 0},
             (const double[3]){0, 0, -1}, n);
    raise_field(&(struct terrain_field){pen->scene, (int)n}, (float)value[ROUGHNESS],
                (float)value[HEIGHT], &pen->rng);
    return STATUS_OK;
}

const struct generator gen_terrain = {
    .name = "terrain",
    .summary = "fractal terrain over the unit square, y up, 2 * 4^k triangles",
    .param = {[K] = {"k", "the grid has 2^k quads a side", 5, 0, 11, true},
              [ROUGHNESS] = {"roughness", "factor of the amplitude from one scale to the next", 0.5,
                             0, 1, false},
              [HEIGHT] = {"height", "amplitude of the largest scale", 0.25, 0, 1e6, false}},
    .make = make,
};
