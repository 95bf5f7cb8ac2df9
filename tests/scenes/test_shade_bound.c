/* Is the bound of a pixel one? The C renderer once more, with a pow that errs as much as Vulkan
 * allows: its colours must stay within the bound, and its pixels may differ near borders alone. */
#include <math.h>

static float other_pow(float x, float y);
#define powf other_pow
#include "scenes/render/shade.c" /* in place of the library's */
#undef powf

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "scenes/render/diff_frames.h"
#include "tests/support/pictures.h"

/* Which way every step of pow errs; 0: not at all. */
static double way;

static float other_pow(float x, float y)
{
    if (way == 0)
        return powf(x, y);
    double l = log2((double)x);
    l += way * (x >= 0.5f && x <= 2.0f ? 0x1p-21 : 3 * 0x1p-24 * fabs(l)) * (y < 0 ? -1 : 1);
    double z = (double)y * l;
    return (float)(exp2(z) * (1 + way * 0x1p-24 * (3 + 2 * fabs(z))));
}

static void compare(const char *spec, struct look look, size_t *moved, size_t *levels)
{
    struct scene scene[2];
    for (int i = 0; i < 2; i++) {
        assert_int_equal(scene_open(spec, 1, &scene[i], NULL), STATUS_OK);
        picture_nearer(&scene[i], 0.4f);
    }
    bool rtrs = look.profile == PROFILE_RTRS;
    struct picture p = picture_of(scene[0], look, rtrs, 240, 180);
    struct picture q = picture_of(scene[1], look, rtrs, 240, 180);
    for (uint32_t i = 0; i < p.shading.material_count; i++) /* high powers err most */
        p.shading.material[i].spec = q.shading.material[i].spec = 500;
    way = 0;
    assert_true(picture_draw(&p, "cpu", 2, true, &p.frame));
    for (int turn = -1; turn <= 1; turn += 2) {
        way = turn;
        assert_true(picture_draw(&q, "cpu", 2, true, &q.frame));
        size_t bytes = 240 * 180 * look.bounces * sizeof *p.frame.segment;
        assert_memory_equal(p.frame.segment, q.frame.segment, bytes);
        for (size_t i = 0; i < 240 * 180; i++) {
            double off = 0;
            for (size_t k = 3 * i; k < 3 * i + 3; k++)
                off = fmax(off, 255 * fabs((double)p.frame.color[k] - (double)q.frame.color[k]));
            if (!(off <= (double)p.frame.bound[i]))
                fail_msg("%s: pixel %zu is %g levels off, not %g", spec, i, off,
                         (double)p.frame.bound[i]);
            *moved += off > 0.1 * (double)p.frame.bound[i] && off > 0;
            *levels += p.frame.pixel[i] != q.frame.pixel[i];
            assert_true(pixel_within(p.frame.color + 3 * i, p.frame.bound[i], q.frame.pixel[i]));
        }
    }
    picture_free(&p);
    picture_free(&q);
}

static void bound_covers_the_worst_pow(void **state)
{
    (void)state;
    size_t moved = 0, levels = 0;
    const struct look repaired = {.profile = PROFILE_REPAIRED, .bounces = 4, .camera_light = 2};
    const struct look rtrs = {.profile = PROFILE_RTRS, .bounces = 4};
    compare("rtrs", repaired, &moved, &levels);
    compare("rtrs", rtrs, &moved, &levels);
    compare("sphere", repaired, &moved, &levels);
    print_message("%zu colours moved by over a tenth of their bound, %zu pixels by a level\n",
                  moved, levels);
    assert_true(moved > 1000);
    assert_true(levels > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bound_covers_the_worst_pow)};
    return cmocka_run_group_tests_name("shade_bound", tests, NULL, NULL);
}
