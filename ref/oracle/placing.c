#include "ref/oracle/placing.h"

#include "ref/integers/oracle_grid.h"

#include <math.h>

struct located placing_locate(const struct placing *placing, uint32_t instance, uint32_t prim)
{
    const struct world *world = placing->world;
    const struct instance *at = &world->instance[instance];
    return (struct located){placing->mesh[at->mesh],
                            placing->inverse[instance].identity ? NULL : at,
                            prim - world->first[instance]};
}

/* --- the inverse ------------------------------------------------------------------------------ */

/* m[a][c] m[b][d] - m[a][d] m[b][c] */
static void minor_of(struct oracle_wide m[3][3], int a, int b, int c, int d,
                     struct oracle_wide *out)
{
    struct oracle_wide left, right;
    wide_mul(&m[a][c], &m[b][d], &left);
    wide_mul(&m[a][d], &m[b][c], &right);
    wide_sub(&left, &right, out);
}

/* W is the matrix of cofactors, transposed, over the determinant. In units of the grid of M, which
 * is at least 2^-149: numbers of M are below 2^277, so det M is below 2^834 and at least 1, and a
 * cofactor below 2^555. */
void placing_invert(const float m[3][4], struct inverse *out)
{
    struct odd odd[9];
    struct oracle_wide x[3][3], cofactor[3][3], term;
    for (int i = 0; i < 9; i++)
        odd[i] = odd_of(m[i / 3][i % 3]);
    struct oracle_grid grid = grid_of(odd, 9);
    for (int i = 0; i < 9; i++)
        grid_wide(grid, odd[i], &x[i / 3][i % 3]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            minor_of(x, (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3, &cofactor[i][j]);
    struct fraction share = {.scale = -grid.exponent};
    for (int j = 0; j < 3; j++) {
        wide_mul(&x[0][j], &cofactor[0][j], &term);
        wide_add(&share.den, &term, &share.den);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double above;
            wide_copy(&cofactor[j][i], &share.num);
            fraction_enclose(&share, &out->w[i][j], &above);
        }
    out->det_sign = (int8_t)share.den.sign;
    out->identity = false;
}

/* --- boxes ------------------------------------------------------------------------------------ */

static float float_below(double x)
{
    float nearest = (float)x; /* infinite, if all floats are nearer to 0 */
    return (double)nearest > x ? nextafterf(nearest, -INFINITY) : nearest;
}

struct box placing_bounds(const float m[3][4], const struct box *box)
{
    struct box out;
    for (int k = 0; k < 3; k++) {
        double lo = 0, hi = 0, size = 0, t = (double)m[k][3];
        for (int j = 0; j < 3; j++) {
            double a = (double)m[k][j] * (double)box->lo[j];
            double b = (double)m[k][j] * (double)box->hi[j];
            lo += fmin(a, b);
            hi += fmax(a, b);
            size += fmax(fabs(a), fabs(b));
        }
        double pad = PLACING_PAD * (size + fabs(t));
        out.lo[k] = float_below(lo + t - pad);
        out.hi[k] = -float_below(-(hi + t + pad));
    }
    return out;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* W x, and the bound of its error. */
static void turn(const double w[3][3], const double x[3], double out[3], double err[3])
{
    for (int i = 0; i < 3; i++) {
        double sum = 0, size = 0;
        for (int j = 0; j < 3; j++) {
            double term = w[i][j] * x[j];
            sum += term;
            size += fabs(term);
        }
        out[i] = sum;
        err[i] = SIGHT_PAD * size;
    }
}

void sight_make(const struct inverse *inverse, const struct instance *instance,
                const struct ray *ray, struct sight *out)
{
    double x[3], d[3];
    for (int k = 0; k < 3; k++) {
        x[k] = (double)ray->org[k] - (double)instance->m[k][3];
        d[k] = (double)ray->dir[k];
    }
    turn(inverse->w, x, out->o, out->o_err);
    turn(inverse->w, d, out->d, out->d_err);
}
