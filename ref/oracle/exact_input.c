#include "ref/oracle/exact_input.h"

#include "ref/integers/oracle_grid.h"

#define MEDIUM_BITS 120 /* of a sum, so that its terms fit an __int128 in any order */

struct exact_numbers {
    const struct instance *at; /* NULL: the vertices are where they are */
    struct odd o[3], d[3], v[3][3], m[3][4];
    struct oracle_grid corner, turn; /* placed: of the vertices' numbers and of M's */
    struct oracle_grid place, way;
};

/* The grid of M v + T - o: three products and two numbers of `rest`. */
static struct oracle_grid placed_grid(struct oracle_grid turn, struct oracle_grid corner,
                                      struct oracle_grid rest)
{
    struct oracle_grid product = {turn.exponent + corner.exponent, turn.bits + corner.bits + 2};
    if (corner.bits == 0)
        product = rest;
    else if (rest.bits == 0)
        rest = product;
    int low = rest.exponent < product.exponent ? rest.exponent : product.exponent;
    int rest_top = rest.exponent + rest.bits, top = product.exponent + product.bits;
    return (struct oracle_grid){low, (rest_top > top ? rest_top : top) - low + 2};
}

static void read_input(const struct ray *ray, float v[3][3], const struct instance *at,
                       struct exact_numbers *in)
{
    struct odd all[12], turn[9];
    in->at = at;
    for (int k = 0; k < 3; k++) {
        in->o[k] = all[k] = odd_of(ray->org[k]);
        in->d[k] = odd_of(ray->dir[k]);
        for (int c = 0; c < 3; c++)
            in->v[c][k] = all[3 + 3 * c + k] = odd_of(v[c][k]);
    }
    in->way = grid_of(in->d, 3);
    if (!at) {
        in->place = grid_of(all, 12);
        return;
    }
    in->corner = grid_of(all + 3, 9);
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            in->m[k][j] = turn[3 * k + j] = odd_of(at->m[k][j]);
        in->m[k][3] = all[3 + k] = odd_of(at->m[k][3]);
    }
    in->turn = grid_of(turn, 9);
    in->place = placed_grid(in->turn, in->corner, grid_of(all, 6));
}

/* --- 128 bits --------------------------------------------------------------------------------- */

/* Coordinate k of vertex c. */
static __int128 int_corner(const struct exact_numbers *in, int c, int k)
{
    if (!in->at)
        return grid_int(in->place, in->v[c][k]);
    __int128 sum = 0;
    for (int j = 0; j < 3; j++)
        sum += grid_int(in->turn, in->m[k][j]) * grid_int(in->corner, in->v[c][j]);
    if (sum)
        sum *= (__int128)1 << (in->turn.exponent + in->corner.exponent - in->place.exponent);
    return sum + grid_int(in->place, in->m[k][3]);
}

static int bits_of(unsigned __int128 x)
{
    uint64_t above = (uint64_t)(x >> 64), below = (uint64_t)x;
    return above ? 128 - __builtin_clzll(above) : below ? 64 - __builtin_clzll(below) : 0;
}

bool input_medium(const struct ray *ray, float v[3][3], const struct instance *at,
                  struct medium_input *out, int *scale)
{
    struct exact_numbers in;
    unsigned __int128 place = 0, way = 0;
    read_input(ray, v, at, &in);
    *scale = in.place.exponent - in.way.exponent;
    if (in.place.bits > MEDIUM_BITS || in.way.bits > MEDIUM_BITS)
        return false;
    for (int k = 0; k < 3; k++) {
        __int128 o = grid_int(in.place, in.o[k]), d = grid_int(in.way, in.d[k]);
        out->d[k] = d;
        way |= (unsigned __int128)(d < 0 ? -d : d);
        for (int c = 0; c < 3; c++) {
            __int128 a = int_corner(&in, c, k) - o;
            out->a[c][k] = a;
            place |= (unsigned __int128)(a < 0 ? -a : a);
        }
    }
    out->place_bits = bits_of(place);
    out->way_bits = bits_of(way);
    return true;
}

bool input_small(const struct ray *ray, float v[3][3], const struct instance *at, struct small *out,
                 int *scale)
{
    struct medium_input medium;
    if (!at) {
        bool fits = small_make(ray, v, out);
        *scale = out->scale;
        return fits;
    }
    if (!input_medium(ray, v, at, &medium, scale) || medium.place_bits > 61 || medium.way_bits > 60)
        return false;
    for (int k = 0; k < 3; k++) {
        out->d[k] = (int64_t)medium.d[k];
        for (int c = 0; c < 3; c++)
            out->a[c][k] = (int64_t)medium.a[c][k];
    }
    out->place_bits = medium.place_bits;
    out->way_bits = medium.way_bits;
    out->scale = *scale;
    return true;
}

/* --- wide ------------------------------------------------------------------------------------- */

static void wide_corner(const struct exact_numbers *in, int c, int k, struct oracle_wide *out)
{
    struct oracle_wide m, v, term;
    if (!in->at) {
        grid_wide(in->place, in->v[c][k], out);
        return;
    }
    wide_set(0, out);
    for (int j = 0; j < 3; j++) {
        grid_wide(in->turn, in->m[k][j], &m);
        grid_wide(in->corner, in->v[c][j], &v);
        wide_mul(&m, &v, &term);
        wide_add(out, &term, out);
    }
    if (out->sign)
        wide_shift_left(out,
                        (unsigned)(in->turn.exponent + in->corner.exponent - in->place.exponent));
    grid_wide(in->place, in->m[k][3], &term);
    wide_add(out, &term, out);
}

void input_wide(const struct ray *ray, float v[3][3], const struct instance *at,
                struct wide_input *out, int *scale)
{
    struct exact_numbers in;
    read_input(ray, v, at, &in);
    *scale = in.place.exponent - in.way.exponent;
    for (int k = 0; k < 3; k++) {
        struct oracle_wide o;
        grid_wide(in.place, in.o[k], &o);
        grid_wide(in.way, in.d[k], &out->d[k]);
        for (int c = 0; c < 3; c++) {
            wide_corner(&in, c, k, &out->a[c][k]);
            wide_sub(&out->a[c][k], &o, &out->a[c][k]);
        }
    }
}
