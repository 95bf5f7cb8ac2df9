/* The grid family (ref/layouts/grid.h): numbers against all codes, and every member over scenes
 * that press on its frames. */
#include "tests/tree/grid_fixture.h"

static bool is_stored(const struct number_format *format, uint32_t code)
{
    uint32_t magnitude = code & ~format->sign;
    return code == 0 || (magnitude >= format->first && magnitude <= format->last);
}

/* Where a code stands, exactly: in the frames of this test a double holds the sum. */
static double place(const struct number_format *format, const struct number_frame *frame,
                    uint32_t code)
{
    return (double)frame->origin[0] +
           ldexp((double)format->number(code), (int)frame->scale[0] - 127);
}

/* The best bound of all codes, HUGE_VAL or -HUGE_VAL if there is none. */
static double best_of_all(const struct number_format *format, const struct number_frame *frame,
                          float bound, bool up)
{
    double best = up ? HUGE_VAL : -HUGE_VAL;
    for (uint32_t code = 0; code >> format->bits == 0; code++) {
        if (!is_stored(format, code))
            continue;
        double at = place(format, frame, code);
        if (!is_subnormal(at) &&
            (up ? at >= (double)bound && at < best : at <= (double)bound && at > best))
            best = at;
    }
    return best;
}

static void check_encoding(const struct number_format *format, const struct number_frame *frame,
                           float bound)
{
    for (int up = 0; up < 2; up++) {
        uint32_t code;
        double best = best_of_all(format, frame, bound, up);
        bool found = number_encode(format, frame, 0, bound, up, &code);
        assert_int_equal(found, isfinite(best));
        if (!found)
            continue;
        assert_true(is_stored(format, code));
        if (place(format, frame, code) != best)
            fail_msg("%s, origin %a scale 2^%d, %s of %a: code %x at %a, not %a", format->name,
                     (double)frame->origin[0], (int)frame->scale[0] - 127, up ? "above" : "below",
                     (double)bound, code, place(format, frame, code), best);
    }
}

/* Bounds on codes, beside them, between, and where nothing is left. */
static void encoding_is_the_best_of_all_codes(void **state)
{
    (void)state;
    static const struct {
        float origin;
        int scale; /* of a number whose top bit is 2^15 */
    } frames[] = {{0, 0}, {1, -20}, {-1000.25f, -8}, {3e-38f, -126}, {-0x1.8p-120f, -112}};
    struct rng rng = rng_make(11, 0);
    for (size_t f = 0; number_formats[f]; f++) {
        const struct number_format *format = number_formats[f];
        if (format->bits > 16)
            continue;
        for (size_t i = 0; i < ARRAY_COUNT(frames); i++) {
            if (format->top > 15 && frames[i].origin != 0)
                continue; /* no double holds such sums */
            int scale = format->top > 15 ? 0 : frames[i].scale + 15 - format->top;
            scale = scale < format->scale_low ? format->scale_low : scale;
            struct number_frame frame = {{frames[i].origin, 0, 0}, {(uint32_t)(scale + 127), 1, 1}};
            for (int k = 0; k < 8; k++) {
                uint32_t code = (uint32_t)rng_u64(&rng) & ((1u << format->bits) - 1);
                if (!is_stored(format, code) || (k == 0 && (code = format->last)))
                    code = k % 2 ? format->first : 0;
                float at = (float)place(format, &frame, code);
                check_encoding(format, &frame, at);
                check_encoding(format, &frame, nextafterf(at, -1e38f));
                check_encoding(format, &frame, nextafterf(at, 1e38f));
            }
            check_encoding(format, &frame, 0);
            check_encoding(format, &frame, FLT_MIN);
            check_encoding(format, &frame, -1e-40f);
        }
    }
}

/* A sum may be rounded either way. */
static void decoding_is_outward_in_every_rounding(void **state)
{
    (void)state;
    struct rng rng = rng_make(12, 0);
    for (size_t f = 0; number_formats[f]; f++)
        for (int round = 0; round < 4000; round++) {
            const struct number_format *format = number_formats[f];
            struct box box;
            float around = rng_scaled(&rng, -1, 1, -126, 250);
            float size = rng_scaled(&rng, 0, 1, -126, 250);
            for (int k = 0; k < 3; k++) {
                box.lo[k] = around - (k == 1 ? 0 : size);
                box.hi[k] = around + (k == 2 ? 0 : size);
            }
            struct number_frame frame;
            assert_true(number_frame_make(format, &box, &frame));
            for (int k = 0; k < 3; k++) {
                float inner = box.lo[k] + rng_float(&rng) * (box.hi[k] - box.lo[k]);
                inner = inner > box.hi[k] ? box.hi[k] : inner;
                uint32_t lo, hi;
                assert_true(number_encode(format, &frame, k, inner, false, &lo));
                assert_true(number_encode(format, &frame, k, inner, true, &hi));
                assert_int_equal(fesetround(FE_UPWARD), 0);
                float most = number_decode(format, &frame, k, lo);
                assert_int_equal(fesetround(FE_DOWNWARD), 0);
                float least = number_decode(format, &frame, k, hi);
                assert_int_equal(fesetround(FE_TONEAREST), 0);
                if (!(most <= inner && inner <= least) || is_subnormal((double)most) ||
                    is_subnormal((double)least))
                    fail_msg("%s: %a is between %a and %a", format->name, (double)inner,
                             (double)most, (double)least);
            }
        }
}

/* The scale is the smallest: half of it would not reach. And nothing beyond the range is taken. */
static void frames_are_as_small_as_they_can_be(void **state)
{
    (void)state;
    struct rng rng = rng_make(13, 0);
    for (size_t f = 0; number_formats[f]; f++) {
        const struct number_format *format = number_formats[f];
        for (int round = 0; round < 1000; round++) {
            float lo = rng_scaled(&rng, -1, 1, -30, 60);
            float size = rng_scaled(&rng, 1, 2, -30, 60);
            struct box box = {{lo, lo, lo}, {lo + size, lo + size, lo + size}};
            struct number_frame frame;
            uint32_t code;
            assert_true(number_frame_make(format, &box, &frame));
            for (int k = 0; k < 3 && (int)frame.scale[k] - 127 > format->scale_low; k++) {
                struct number_frame half = frame;
                half.scale[k]--;
                assert_false(number_encode(format, &half, k, box.lo[k], false, &code) &&
                             number_encode(format, &half, k, box.hi[k], true, &code));
            }
        }
        struct box large = {{0, 0, -0x1p126f}, {1, 1, 0x1p126f}};
        struct number_frame frame;
        assert_true(number_frame_make(format, &large, &frame));
        large.hi[1] = 0x1.000002p126f;
        assert_false(number_frame_make(format, &large, &frame));
    }
}

/* Where the shader finds the codes of a slot and an axis (grid_codes): what it asks of the places
 * is true of all. */
static void codes_lie_where_the_shader_reads_them(void **state)
{
    (void)state;
    for (uint32_t slot = 0; slot < 8; slot++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            uint32_t first = 2 * axis, second = 2 * axis + 1;
            assert_true((first < 3) == (first < 4) && (first < 3) == (first <= 3));
            assert_true((second < 3) == (second < 2));
            uint32_t bit = (3 * slot + axis) * 24 & 31;
            assert_true(bit % 8 == 0 && (bit & 30) == bit);
            assert_true(((32 - bit) & 30) == ((32 - bit) & 31));
            if (bit <= 9) /* the two end in their word; what comes from the next is above them */
                assert_true(bit + 24 <= 32 && (bit == 0 || 32 - bit >= 24));
            else
                assert_true(bit > 9 && bit + 24 > 32);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(encoding_is_the_best_of_all_codes),
        cmocka_unit_test(decoding_is_outward_in_every_rounding),
        cmocka_unit_test(frames_are_as_small_as_they_can_be),
        cmocka_unit_test(codes_lie_where_the_shader_reads_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
