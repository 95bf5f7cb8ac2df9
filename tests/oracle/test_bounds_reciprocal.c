/* How much slack the bound of Embree's reciprocal has on this processor: all mantissas (every
 * seventh unless RAYDIFF_SLOW), refined as Embree does. Prints the largest errors; fails if one is
 * beyond. */
#include "ref/base/base.h"
#include "ref/twin/model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define UNIT 0x1p-24

#if defined(__SSE__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#if defined(__SSE__)
static float estimate(float a)
{
    return _mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(a)));
}

static const double promised = 1.5 * 0x1p-12;
static const struct form {
    const char *name;
    double proven;
} forms[] = {{"r(2 - ra)", 4.75},
             {"the same fused", 4.25},
             {"r + r(1 - ar)", 4.25},
             {"the same fused", 3.25},
             {"r + r - rra", 5.25}};

/* One Newton step in each of the ways that Embree has used. */
static float refined(int form, float a)
{
    float r = estimate(a);
    switch (form) {
    case 0:
        return r * (2 - r * a);
    case 1:
        return r * fmaf(-r, a, 2);
    case 2:
        return r + r * (1 - a * r);
    case 3:
        return fmaf(r, fmaf(-a, r, 1), r);
    default:
        return r + r - r * r * a;
    }
}
#elif defined(__aarch64__)
static float estimate(float a)
{
    return vrecpes_f32(a);
}

static const double promised = 0x1p-7;
static const struct form {
    const char *name;
    double proven;
} forms[] = {{"2 times r(2 - ra)", 2.25}};

static float refined(int form, float a)
{
    (void)form;
    float r = estimate(a);
    r *= vrecpss_f32(r, a);
    return r * vrecpss_f32(r, a);
}
#endif

static void reciprocal_has_this_much_slack(void **state)
{
    (void)state;
#if defined(__SSE__) || defined(__aarch64__)
    double most_raw = 0;
    static const struct rounding embree = ROUNDING_EMBREE;
    uint32_t step = getenv("RAYDIFF_SLOW") ? 1 : 7;
    for (int form = 0; form < (int)ARRAY_COUNT(forms); form++) {
        double most = 0;
        for (uint32_t m = 0; m < 1u << 23; m += step) {
            float a = 1 + (float)m * 0x1p-23f;
            most = fmax(most, fabs(fma((double)refined(form, a), (double)a, -1)) / UNIT);
            most_raw = fmax(most_raw, fabs(fma((double)estimate(a), (double)a, -1)));
        }
        print_message("reciprocal %-16s chosen %g u, proof %g u, on this processor %.3f u\n",
                      forms[form].name, embree.div, forms[form].proven, most);
        assert_true(most <= forms[form].proven && forms[form].proven <= embree.div && most > 0.5);
    }
    print_message("its estimate: promised %.3f * 2^-12, here %.3f * 2^-12\n", promised * 0x1p12,
                  most_raw * 0x1p12);
    assert_true(most_raw <= promised);
#else
    print_message("SKIP reciprocal_has_this_much_slack: no estimate of this processor is known\n");
    skip();
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(reciprocal_has_this_much_slack)};
    return cmocka_run_group_tests_name("bounds_reciprocal", tests, NULL, NULL) ? 1 : 0;
}
