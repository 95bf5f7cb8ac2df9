/* The step of a grid is the least power of two for which the extents fit: to the last code. */
#include "ref/scene/quantise.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* A triangle between `from` and `to` along the axis, one unit of the step wide along the others. */
static struct scene span(int axis, float from, float to, float step)
{
    struct scene scene;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3; i++) {
        scene.index[i] = i;
        for (int k = 0; k < 3; k++)
            scene.vertex[3 * i + (uint32_t)k] = k == axis ? (i == 0 ? from : to)
                                                : i == 2  ? step
                                                          : 0;
    }
    return scene;
}

static void every_code_is_used_before_the_step_doubles(void **state)
{
    (void)state;
    for (uint32_t bits = QUANTISE_BITS_LEAST; bits <= QUANTISE_BITS_MOST; bits++)
        for (int power = -20; power <= 20; power += 5)
            for (int more = -1; more <= 2; more++) {
                const float step = ldexpf(1, power);
                const float units = (float)((1 << bits) - 1 + more), low = -3 * step;
                const int axis = (int)bits % 3;
                struct scene scene = span(axis, low, low + units * step, step), out;
                struct quantised q;
                struct reason reason = {""};
                if (scene_quantise(&scene, bits, &out, &q, &reason))
                    fail_msg("%s", reason.text);
                const float wanted = more <= 0 ? step : 2 * step;
                if (q.grid.step[axis] > wanted || q.grid.step[axis] < wanted)
                    fail_msg("%u bits, %g units: step %g, not %g", bits, (double)units,
                             (double)q.grid.step[axis], (double)wanted);
                assert_int_equal(q.grid.bits, bits);
                if (more <= 0)
                    for (int k = 0; k < 9; k++)
                        assert_int_equal(float_bits(out.vertex[k]), float_bits(scene.vertex[k]));
                scene_free(&out);
                scene_free(&scene);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_is_used_before_the_step_doubles)};
    return cmocka_run_group_tests_name("grid_step", tests, NULL, NULL);
}
