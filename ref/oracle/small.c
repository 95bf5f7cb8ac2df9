#include "ref/oracle/small.h"

#include "ref/base/base.h"
#include "ref/integers/oracle_grid.h"

/* --- input ------------------------------------------------------------------------------------ */

/* Of several numbers: the lowest bit set in any, as an exponent, and the largest, as its bits. */
struct ends {
    int low;
    uint32_t most;
};

#define NO_BITS 1000 /* above every exponent */

static inline void ends_add(struct ends *ends, float x)
{
    uint32_t size = float_bits(x) & 0x7FFFFFFFu, field = size >> 23;
    uint32_t m = (size & 0x7FFFFFu) | (uint32_t)(field != 0) << 23;
    int low = m ? (int)(field ? field : 1) - 150 + __builtin_ctz(m) : NO_BITS;
    ends->low = low < ends->low ? low : ends->low;
    ends->most = size > ends->most ? size : ends->most;
}

/* As grid_of, but that subnormal numbers count as the least normal one: they fit anyway. */
static inline struct oracle_grid ends_grid(const struct ends *ends)
{
    if (ends->most == 0)
        return (struct oracle_grid){0, 0};
    return (struct oracle_grid){ends->low, (int)(ends->most >> 23) - 126 - ends->low};
}

/* A multiple of 2^-exponent of fewer than 62 bits, in these units. */
static inline int64_t on_grid(float x, double units)
{
    return (int64_t)((double)x * units);
}

static inline uint64_t size_of(int64_t x)
{
    return (uint64_t)(x < 0 ? -x : x);
}

static inline int bits_of(uint64_t x)
{
    return x ? 64 - __builtin_clzll(x) : 0;
}

bool small_make(const struct ray *ray, float v[3][3], struct small *out)
{
    struct ends place_ends = {NO_BITS, 0}, way_ends = {NO_BITS, 0};
    for (int k = 0; k < 3; k++) {
        ends_add(&way_ends, ray->dir[k]);
        ends_add(&place_ends, ray->org[k]);
        for (int c = 0; c < 3; c++)
            ends_add(&place_ends, v[c][k]);
    }
    struct oracle_grid place = ends_grid(&place_ends), way = ends_grid(&way_ends);
    if (place.bits > 60 || way.bits > 60)
        return false;
    double place_units = power_of_two(-place.exponent), way_units = power_of_two(-way.exponent);
    uint64_t place_size = 0, way_size = 0;
    for (int k = 0; k < 3; k++) {
        int64_t o = on_grid(ray->org[k], place_units);
        out->d[k] = on_grid(ray->dir[k], way_units);
        way_size |= size_of(out->d[k]);
        for (int c = 0; c < 3; c++) {
            out->a[c][k] = on_grid(v[c][k], place_units) - o;
            place_size |= size_of(out->a[c][k]);
        }
    }
    out->place_bits = bits_of(place_size);
    out->way_bits = bits_of(way_size);
    out->scale = place.exponent - way.exponent;
    return true;
}

/* --- products --------------------------------------------------------------------------------- */

static inline void cross(const int64_t x[3], const int64_t y[3], __int128 out[3])
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = (__int128)x[i] * y[j] - (__int128)x[j] * y[i];
    }
}

static inline __int128 dot(const int64_t x[3], const __int128 y[3])
{
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/* Sums: |w| <= 6 * 2^(b_d + 2 b_p), |D| <= 18 * the same, |T| <= 6 * 2^(3 b_p); all below 2^127
 * under the conditions tested here. */
bool small_multiply(const struct small *small, struct small_products *out)
{
    if (small->way_bits + 2 * small->place_bits > 122 || 3 * small->place_bits > 124)
        return false;
    __int128 n[3];
    for (int i = 0; i < 3; i++) {
        int c = (i + 1) % 3; /* 0 last: T has its n */
        cross(small->a[(c + 1) % 3], small->a[(c + 2) % 3], n);
        out->w[c] = dot(small->d, n);
    }
    out->det = out->w[0] + out->w[1] + out->w[2];
    out->t = dot(small->a[0], n);
    return true;
}

/* --- in the plane ------------------------------------------------------------------------------
 */

void overlap_add(const struct fraction *t, bool *any, struct fraction *in, struct fraction *out)
{
    if (!*any || fraction_compare(t, in) < 0)
        *in = *t;
    if (!*any || fraction_compare(t, out) > 0)
        *out = *t;
    *any = true;
}

/* |d| < 2^60 and |a| < 2^61, so that sides and normals stay below 2^126; the ends of the overlap
 * are made of products of three. */
bool small_in_plane(const struct small *s, bool *any, struct fraction *in, struct fraction *out)
{
    __int128 n[3], side[3];
    int64_t e1[3], e2[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = s->a[1][k] - s->a[0][k];
        e2[k] = s->a[2][k] - s->a[0][k];
    }
    cross(e1, e2, n);
    int drop = n[0] ? 0 : n[1] ? 1 : 2, i = (drop + 1) % 3, j = (drop + 2) % 3;
    for (int c = 0; c < 3; c++)
        side[c] = (__int128)s->d[i] * s->a[c][j] - (__int128)s->d[j] * s->a[c][i];
    *any = false;
    if (2 * s->place_bits + s->way_bits > 122 || s->place_bits + 2 * s->way_bits > 122)
        return false;
    int measure = s->d[i] ? i : j;
    struct fraction t = {.scale = s->scale};
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3, one = sign_of(side[c]), two = sign_of(side[e]);
        __int128 num = s->a[c][measure], den = s->d[measure];
        if (one != 0) { /* the vertex is beside the line */
            if (one != -two)
                continue;
            num = s->a[e][measure] * side[c] - s->a[c][measure] * side[e];
            den = (side[c] - side[e]) * s->d[measure];
        }
        wide_set(num, &t.num);
        wide_set(den, &t.den);
        overlap_add(&t, any, in, out);
    }
    return true;
}
