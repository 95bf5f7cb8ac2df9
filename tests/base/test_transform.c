/* Laws of scenes/transform.h: what each step does to a point, in which order steps are done, and
 * which steps are refused. */
#include "ref/base/rng.h"
#include "scenes/transform.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static struct reason reason;

static void assert_point(const struct transform *t, float x, float y, float z, float ex, float ey,
                         float ez)
{
    float in[3] = {x, y, z}, out[3], expected[3] = {ex, ey, ez};
    transform_point(t, in, out);
    for (int k = 0; k < 3; k++)
        if (out[k] != expected[k])
            fail_msg("(%g %g %g) becomes (%.9g %.9g %.9g), not (%g %g %g)", (double)x, (double)y,
                     (double)z, (double)out[0], (double)out[1], (double)out[2], (double)ex,
                     (double)ey, (double)ez);
}

static struct transform rotation(float x, float y, float z, float degrees)
{
    struct transform out;
    const float axis[3] = {x, y, z};
    assert_int_equal(transform_rotate(axis, degrees, &out, &reason), STATUS_OK);
    return out;
}

static struct transform scaling(float x, float y, float z)
{
    struct transform out;
    const float by[3] = {x, y, z};
    assert_int_equal(transform_scale(by, &out, &reason), STATUS_OK);
    return out;
}

static struct transform translation(float x, float y, float z)
{
    const float by[3] = {x, y, z};
    return transform_translate(by);
}

static void the_identity_keeps_every_bit(void **state)
{
    (void)state;
    struct transform identity = transform_identity();
    const float odd[3] = {-0.0f, FLT_MIN / 3, -FLT_MAX};
    float out[3];
    transform_point(&identity, odd, out);
    assert_memory_equal(out, odd, sizeof out);
    identity = transform_then(&identity, &identity);
    assert_false(identity.any);
    struct transform step = translation(1, 2, 3), both = transform_then(&identity, &step);
    assert_memory_equal(&both, &step, sizeof both);
    both = transform_then(&step, &identity);
    assert_memory_equal(&both, &step, sizeof both);
}

static void quarter_turns_are_exact(void **state)
{
    (void)state;
    for (int turns = -4; turns <= 4; turns += 4) { /* whole turns change nothing */
        float whole = 90.0f * (float)turns;
        struct transform t = rotation(0, 0, 2, whole + 90);
        assert_point(&t, 1.1f, 2.2f, 3.3f, -2.2f, 1.1f, 3.3f);
        t = rotation(3, 0, 0, whole + 90);
        assert_point(&t, 1.1f, 2.2f, 3.3f, 1.1f, -3.3f, 2.2f);
        t = rotation(0, 0.1f, 0, whole + 90);
        assert_point(&t, 1.1f, 2.2f, 3.3f, 3.3f, 2.2f, -1.1f);
        t = rotation(0, -1, 0, whole + 90);
        assert_point(&t, 1.1f, 2.2f, 3.3f, -3.3f, 2.2f, 1.1f);
        t = rotation(0, 0, 1, whole + 180);
        assert_point(&t, 1.1f, 2.2f, 3.3f, -1.1f, -2.2f, 3.3f);
        t = rotation(0, 0, 1, whole - 90);
        assert_point(&t, 1.1f, 2.2f, 3.3f, 2.2f, -1.1f, 3.3f);
    }
    /* About (1, 1, 1) by a third of a turn the axes change places. */
    struct transform t = rotation(1, 1, 1, 120);
    assert_point(&t, 1, 2, 4, 4, 1, 2);
}

/* Lengths, the axis and the side of every rotation, beside another way: the angle between a point
 * across the axis and where it goes. */
static void rotations_turn_by_their_angle(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 300; i++) {
        struct rng rng = rng_make(11, i);
        float axis[3], point[3], moved[3], degrees = rng_range(&rng, -179, 179);
        for (int k = 0; k < 3; k++) {
            axis[k] = rng_range(&rng, -1, 1);
            point[k] = rng_range(&rng, -1, 1);
        }
        struct transform t = rotation(axis[0], axis[1], axis[2], degrees);
        assert_false(t.mirrors);
        transform_point(&t, point, moved);
        double a[3], p[3], m[3], length = 0, ap = 0, am = 0;
        for (int k = 0; k < 3; k++)
            length += (double)axis[k] * (double)axis[k];
        for (int k = 0; k < 3; k++) {
            a[k] = (double)axis[k] / sqrt(length);
            ap += a[k] * (double)point[k];
            am += a[k] * (double)moved[k];
        }
        double dot = 0, pp = 0, mm = 0, side = 0;
        for (int k = 0; k < 3; k++) { /* what is left across the axis */
            p[k] = (double)point[k] - ap * a[k];
            m[k] = (double)moved[k] - am * a[k];
            dot += p[k] * m[k], pp += p[k] * p[k], mm += m[k] * m[k];
        }
        for (int k = 0; k < 3; k++)
            side += a[k] * (p[(k + 1) % 3] * m[(k + 2) % 3] - p[(k + 2) % 3] * m[(k + 1) % 3]);
        assert_true(fabs(ap - am) < 1e-6);
        assert_true(fabs(sqrt(pp) - sqrt(mm)) < 1e-6);
        double angle = atan2(side, dot) * 57.295779513082323;
        if (pp > 0.01 && fabs(angle - (double)degrees) > 1e-3)
            fail_msg("%g degrees, not %g", angle, (double)degrees);
    }
}

static void steps_are_done_in_order(void **state)
{
    (void)state;
    struct transform move = translation(1, 0, 0), grow = scaling(2, 3, 4);
    struct transform turn = rotation(0, 0, 1, 90);
    struct transform t = transform_then(&move, &grow);
    assert_point(&t, 1, 1, 1, 4, 3, 4);
    t = transform_then(&grow, &move);
    assert_point(&t, 1, 1, 1, 3, 3, 4);
    t = transform_then(&move, &turn);
    t = transform_then(&t, &grow); /* (1 1 1), (2 1 1), (-1 2 1), (-2 6 4) */
    assert_point(&t, 1, 1, 1, -2, 6, 4);
}

static void matrices_are_rows_for_columns(void **state)
{
    (void)state;
    const float number[16] = {1, 2, 3, 10, 0, 1, 4, 20, 5, 6, 0, 30, 0, 0, 0, 1}; /* det 1 */
    struct transform t;
    assert_int_equal(transform_matrix(number, &t, &reason), STATUS_OK);
    assert_false(t.mirrors);
    assert_point(&t, 1, 1, 1, 16, 25, 41);
    assert_point(&t, 1, 0, 0, 11, 20, 35);
    float mirrored[16];
    memcpy(mirrored, number, sizeof number);
    for (int k = 0; k < 4; k++)
        mirrored[k] = number[4 + k], mirrored[4 + k] = number[k];
    assert_int_equal(transform_matrix(mirrored, &t, &reason), STATUS_OK);
    assert_true(t.mirrors);
    struct transform back = scaling(-1, 1, 1), flip = scaling(-1, -1, -1);
    assert_true(back.mirrors && flip.mirrors);
    t = transform_then(&t, &back);
    assert_false(t.mirrors);
    t = transform_then(&t, &flip);
    assert_true(t.mirrors);
    assert_false(scaling(-1, 1, -1).mirrors);
    /* As small as floats go, the side is still known. */
    struct transform tiny = scaling(-1e-38f, 1e-38f, 1e-38f), all = transform_identity();
    for (int i = 0; i < 5; i++)
        all = transform_then(&all, &tiny);
    assert_true(all.mirrors);
}

static void bad_steps_are_refused(void **state)
{
    (void)state;
    const float zero[3] = {0, -0.0f, 0}, flat[3] = {1, 0, 1};
    const float low[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1};
    const float weight[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2};
    const float plane[16] = {1, 2, 3, 0, 2, 4, 6, 0, 1, 0, 0, 0, 0, 0, 0, 1};
    const float nothing[16] = {[15] = 1};
    struct transform t;
    assert_int_equal(transform_rotate(zero, 10, &t, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "an axis of length 0");
    assert_false(t.any);
    assert_int_equal(transform_scale(flat, &t, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "a factor of 0 flattens the model");
    const float *const rows[] = {low, weight};
    for (size_t i = 0; i < ARRAY_COUNT(rows); i++) {
        assert_int_equal(transform_matrix(rows[i], &t, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "must be 0 0 0 1"));
    }
    const float *const flats[] = {plane, nothing};
    for (size_t i = 0; i < ARRAY_COUNT(flats); i++) {
        assert_int_equal(transform_matrix(flats[i], &t, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "determinant is 0"));
    }
    /* Small is not flat. */
    const float small[16] = {1e-30f, 0, 0, 0, 0, 1e-30f, 0, 0, 0, 0, 1e-30f, 0, 0, 0, 0, 1};
    assert_int_equal(transform_matrix(small, &t, &reason), STATUS_OK);
    struct transform huge = scaling(FLT_MAX, 1, 1);
    float out[3], in[3] = {2, 1, 1};
    transform_point(&huge, in, out);
    assert_false(float_is_finite(out[0]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_identity_keeps_every_bit),  cmocka_unit_test(quarter_turns_are_exact),
        cmocka_unit_test(rotations_turn_by_their_angle), cmocka_unit_test(steps_are_done_in_order),
        cmocka_unit_test(matrices_are_rows_for_columns), cmocka_unit_test(bad_steps_are_refused),
    };
    return cmocka_run_group_tests_name("transform", tests, NULL, NULL);
}
