/* How many numbers of a format are looked at to encode bounds and to find frames, by value: a
 * search that begins elsewhere ends at the same code, later. */
#include "ref/base/rng.h"
#include "ref/layouts/grid_number.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#define TRIALS 2000

static const struct number_format *counted_of;
static uint64_t looked;

static float counted_number(uint32_t code)
{
    looked++;
    return counted_of->number(code);
}

/* Numbers looked at by: frames of boxes; bounds in these frames; bounds without a frame, and how
 * many of these have a code. */
struct number_work {
    const char *format;
    uint64_t frames, within, plain, found;
};

static struct number_work work_of(const struct number_format *format)
{
    struct number_work work = {.format = format->name};
    struct number_format counting = *format;
    struct rng rng = rng_make(31, 0);
    counted_of = format;
    counting.number = counted_number;
    for (int i = 0; i < TRIALS; i++) {
        struct number_frame frame;
        struct box box;
        uint32_t code;
        for (int k = 0; k < 3; k++) {
            float at = rng_scaled(&rng, 0.5f, 1, -20, 40) - 16,
                  size = rng_scaled(&rng, 0.5f, 1, -24, 30);
            box.lo[k] = at;
            box.hi[k] = i % 7 == 0 ? at : at + size;
        }
        looked = 0;
        assert_true(number_frame_make(&counting, &box, &frame));
        work.frames += looked;
        looked = 0;
        for (int k = 0; k < 3; k++)
            assert_true(number_encode(&counting, &frame, k, i % 2 ? box.lo[k] : box.hi[k],
                                      i % 2 == 0, &code));
        work.within += looked;
        looked = 0;
        uint32_t found = 0;
        for (int k = 0; k < 3; k++)
            found += number_encode(&counting, NULL, k, (i % 4 < 2 ? 1.0f : -1.0f) * box.lo[k],
                                   i % 2, &code);
        work.plain += looked;
        work.found += found;
    }
    return work;
}

static void searches_look_at_few_numbers(void **state)
{
    (void)state;
    static const struct number_work wanted[] = {
        {"f32", 78000, 38999, 39000, 6000},  {"f16", 95793, 38991, 38347, 5791},
        {"bf16", 78031, 39000, 38990, 6000}, {"u8", 86158, 27109, 21283, 4110},
        {"u10", 85695, 26937, 21501, 4177},  {"u12", 85352, 26779, 21715, 4245},
        {"u16", 84758, 26472, 22153, 4394},
    };
    size_t i = 0;
    for (; number_formats[i]; i++) {
        struct number_work work = work_of(number_formats[i]);
        print_message("{\"%s\", %llu, %llu, %llu, %llu},\n", work.format,
                      (unsigned long long)work.frames, (unsigned long long)work.within,
                      (unsigned long long)work.plain, (unsigned long long)work.found);
        assert_string_equal(work.format, wanted[i].format);
        assert_int_equal(work.frames, wanted[i].frames);
        assert_int_equal(work.within, wanted[i].within);
        assert_int_equal(work.plain, wanted[i].plain);
        assert_int_equal(work.found, wanted[i].found);
    }
    assert_int_equal(i, ARRAY_COUNT(wanted));
}

/* The ends of floats, and all between them by powers of two: every box within the limit has a
 * frame. */
static void every_box_has_a_frame(void **state)
{
    (void)state;
    float place[4 * 276 + 1];
    size_t count = 0;
    for (int exponent = -149; exponent <= NUMBER_FRAME_MOST; exponent++)
        for (int side = -1; side < 2; side += 2) {
            float power = (float)side * ldexpf(1, exponent);
            place[count++] = power;
            place[count++] = nextafterf(power, 0);
        }
    place[count++] = 0;
    for (size_t i = 0; number_formats[i]; i++)
        for (size_t a = 0; a < count; a++)
            for (size_t b = a % 13; b < count; b += 13) {
                float lo = fminf(place[a], place[b]), hi = fmaxf(place[a], place[b]);
                const struct box box = {{lo, lo, lo}, {hi, hi, hi}};
                struct number_frame frame;
                assert_true(number_frame_make(number_formats[i], &box, &frame));
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(searches_look_at_few_numbers),
        cmocka_unit_test(every_box_has_a_frame),
    };
    return cmocka_run_group_tests_name("number_work", tests, NULL, NULL) ? 1 : 0;
}
