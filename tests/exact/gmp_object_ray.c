#include "tests/exact/gmp_object_ray.h"

#include "tests/exact/exact_gmp_replay.h"
#include "tests/exact/gmp_world.h"

#include <math.h>

static void init_three(mpq_t x[3])
{
    mpq_inits(x[0], x[1], x[2], NULL);
}
static void clear_three(mpq_t x[3])
{
    mpq_clears(x[0], x[1], x[2], NULL);
}

/* a by b, rounded once. */
static float rounded(void (*operation)(mpq_t, const mpq_t, const mpq_t), float a, float b)
{
    mpq_t x, y;
    mpq_inits(x, y, NULL);
    mpq_set_d(x, (double)a);
    mpq_set_d(y, (double)b);
    operation(x, x, y);
    float result = exact_gmp_round(x);
    mpq_clears(x, y, NULL);
    return result;
}

/* (w0 x0 + w1 x1) + w2 x2; not finite if a number on the way is not. */
static float row_of(const float w[3], const float x[3])
{
    float term[3], first;
    for (int j = 0; j < 3; j++) {
        term[j] = rounded(mpq_mul, w[j], x[j]);
        if (!float_is_finite(term[j]))
            return term[j];
    }
    first = rounded(mpq_add, term[0], term[1]);
    return float_is_finite(first) ? rounded(mpq_add, first, term[2]) : first;
}

/* The inverse of M; each number in `exact`, if that is not NULL, and rounded once. */
static void inverse_of(const struct instance *instance, float w[3][3], double exact[3][3])
{
    mpq_t column[3];
    init_three(column);
    for (int j = 0; j < 3; j++) {
        const float axis[3] = {j == 0, j == 1, j == 2};
        gmp_world_object_direction(instance, axis, column);
        for (int k = 0; k < 3; k++) {
            w[k][j] = exact_gmp_round(column[k]);
            if (exact)
                exact[k][j] = mpq_get_d(column[k]); /* cut towards 0 */
        }
    }
    clear_three(column);
}

static bool stays_where_it_is(const struct instance *instance)
{
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            if (instance->m[k][j] != (j == k ? 1.0f : 0.0f))
                return false;
    return true;
}

bool gmp_object_ray(const struct instance *instance, const struct ray *ray, struct ray *out)
{
    float w[3][3], x[3];
    *out = *ray;
    if (stays_where_it_is(instance))
        return true;
    inverse_of(instance, w, NULL);
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        x[k] = rounded(mpq_sub, ray->org[k], instance->m[k][3]);
        finite &= float_is_finite(x[k]);
        for (int j = 0; j < 3; j++)
            finite &= float_is_finite(w[k][j]);
    }
    for (int k = 0; k < 3 && finite; k++) {
        out->org[k] = row_of(w[k], x);
        out->dir[k] = row_of(w[k], ray->dir);
        finite = float_is_finite(out->org[k]) && float_is_finite(out->dir[k]);
    }
    return finite;
}

double gmp_kappa(const struct instance *instance)
{
    float w[3][3];
    double exact[3][3], m = 0, inverse = 0;
    inverse_of(instance, w, exact);
    for (int k = 0; k < 3; k++) {
        double row = 0, inverse_row = 0;
        for (int j = 0; j < 3; j++) {
            row += fabs((double)instance->m[k][j]);
            inverse_row += fabs(exact[k][j]);
        }
        m = fmax(m, row);
        inverse = fmax(inverse, inverse_row);
    }
    return m * inverse * (1 + 0x1p-45);
}
