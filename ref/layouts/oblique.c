#include "ref/layouts/oblique.h"

#include <math.h>

/* Of the magnitudes of a place along an axis: two roundings of the sum, in double. */
#define PLACE_SLACK 0x1p-51

const tilt_axes tilts[TILTS] = {
    /* 45 degrees about an axis, then 37 both ways */
    {{1, 0, 0}, {0, 1, 1}, {0, -1, 1}},
    {{1, 0, 1}, {0, 1, 0}, {-1, 0, 1}},
    {{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}},
    {{1, 0, 0}, {0, 4, 3}, {0, -3, 4}},
    {{1, 0, 0}, {0, 4, -3}, {0, 3, 4}},
    {{4, 0, 3}, {0, 1, 0}, {-3, 0, 4}},
    {{4, 0, -3}, {0, 1, 0}, {3, 0, 4}},
    {{4, 3, 0}, {-3, 4, 0}, {0, 0, 1}},
    {{4, -3, 0}, {3, 4, 0}, {0, 0, 1}},
    /* about the four diagonals of a cube */
    {{2, -1, 2}, {2, 2, -1}, {-1, 2, 2}},
    {{2, 1, -2}, {-2, 2, -1}, {1, 2, 2}},
    {{2, 1, 2}, {1, 2, -2}, {-2, 2, 1}},
    {{2, -1, -2}, {-1, 2, -2}, {2, 2, 1}},
    {{6, -2, 3}, {3, 6, -2}, {-2, 3, 6}},
    {{6, 2, -3}, {-3, 6, -2}, {2, 3, 6}},
    {{6, 2, 3}, {-3, 6, 2}, {-2, -3, 6}},
    {{6, -2, -3}, {3, 6, 2}, {2, -3, 6}},
};

static float down(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static float up(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

static void extend(struct spans *s, uint32_t t, uint32_t j, float lo, float hi)
{
    s->lo[t][j] = lo < s->lo[t][j] ? lo : s->lo[t][j];
    s->hi[t][j] = hi > s->hi[t][j] ? hi : s->hi[t][j];
}

/* Extends the bounds by a point. Products are exact in double: 24 bits by 4. Two sums round by
 * 2^-53 of what they sum up each, so 2^-51 of it is more than both and its own rounding. */
static void add_point(struct spans *s, const float v[3])
{
    for (uint32_t t = 0; t < TILTS; t++)
        for (uint32_t j = 0; j < 3; j++) {
            const int8_t *a = tilts[t][j];
            double x = a[0] * (double)v[0], y = a[1] * (double)v[1], z = a[2] * (double)v[2];
            double at = x + y + z, off = (fabs(x) + fabs(y) + fabs(z)) * PLACE_SLACK;
            extend(s, t, j, down(at - off), up(at + off));
        }
}

void spans_add_triangle(struct spans *s, const struct scene *scene, uint32_t prim)
{
    float v[3][3];
    scene_tri(scene, prim, v);
    bool is_box = v[0][0] == v[2][0] && v[0][1] == v[2][1] && v[0][2] == v[2][2];
    for (uint32_t corner = 0; corner < (is_box ? 8 : 3); corner++) {
        float at[3];
        for (uint32_t k = 0; k < 3; k++)
            at[k] = is_box ? v[corner >> k & 1][k] : v[corner][k];
        add_point(s, at);
    }
}

void spans_add(struct spans *s, const struct spans *other)
{
    for (uint32_t t = 0; t < TILTS; t++)
        for (uint32_t j = 0; j < 3; j++)
            extend(s, t, j, other->lo[t][j], other->hi[t][j]);
}

void spans_clear(struct spans *s)
{
    for (uint32_t n = 0; n < 3 * TILTS; n++) {
        s->lo[n / 3][n % 3] = INFINITY;
        s->hi[n / 3][n % 3] = -INFINITY;
    }
}

static double area(const double e[3])
{
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

double spans_area(const struct spans *s, uint32_t t)
{
    double extent[3];
    for (uint32_t j = 0; j < 3; j++) {
        const int8_t *a = tilts[t][j];
        extent[j] = ((double)s->hi[t][j] - (double)s->lo[t][j]) /
                    sqrt((double)(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
    }
    return area(extent);
}
