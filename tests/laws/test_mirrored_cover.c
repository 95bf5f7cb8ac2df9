/* Whether a triangle meets a part of space is the same for both mirrored at any of the three axes:
 * a bound of rounding errors knows no sign. Triangles are flat, or nearly so, where products
 * cancel. */
#include "ref/base/rng.h"
#include "ref/tree/cover_exact.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define CASES 40000

struct mirrored_case {
    float v[3][3];
    struct cover_part part;
};

static float any(struct rng *rng)
{
    return (float)((double)rng_below(rng, 1u << 24) / (1 << 23) - 1);
}

/* Three points of one line, as far as float32 has them, or exactly: then of a line through 0, with
 * powers of two between them, so that differences have more digits than a double. Of a third of
 * them, a coordinate lies one number beside it. The part ends where a corner of the triangle is, or
 * near by. */
static struct mirrored_case draw(struct rng *rng)
{
    struct mirrored_case out = {.part.open = rng_below(rng, 64)};
    const double share = (double)any(rng) * 2;
    const bool exact = rng_below(rng, 2);
    float step[3];
    for (int k = 0; k < 3; k++) {
        step[k] = any(rng);
        out.v[0][k] = any(rng);
        out.v[1][k] = out.v[0][k] + step[k];
        out.v[2][k] = (float)((double)out.v[0][k] + share * (double)step[k]);
    }
    for (int c = 1; c < 3 && exact; c++) {
        const float side = rng_below(rng, 2) ? 1 : -1;
        const float times = ldexpf(side, -(int)rng_below(rng, 60));
        for (int k = 0; k < 3; k++)
            out.v[c][k] = times * out.v[0][k];
    }
    if (rng_below(rng, 3) == 0) {
        float *corner = out.v[rng_below(rng, 3)];
        float *beside = &corner[rng_below(rng, 3)];
        *beside = nextafterf(*beside, (float)INFINITY);
    }
    for (int k = 0; k < 3; k++) {
        const float a = out.v[rng_below(rng, 3)][k];
        const float b = out.v[rng_below(rng, 3)][k];
        const float more = rng_below(rng, 2) ? 0.0f : 0x1p-12f;
        out.part.box.lo[k] = fminf(a, b) - more;
        out.part.box.hi[k] = fmaxf(a, b) + more;
        if (out.part.box.lo[k] == out.part.box.hi[k])
            out.part.box.hi[k] += 0.5f;
    }
    return out;
}

static void mirror(struct mirrored_case *of, int k)
{
    const float lo = of->part.box.lo[k];
    for (int c = 0; c < 3; c++)
        of->v[c][k] = -of->v[c][k];
    of->part.box.lo[k] = -of->part.box.hi[k];
    of->part.box.hi[k] = -lo;
    const unsigned low = of->part.open & COVER_OPEN_LO(k), high = of->part.open & COVER_OPEN_HI(k);
    of->part.open &= ~(COVER_OPEN_LO(k) | COVER_OPEN_HI(k));
    of->part.open |= (low ? COVER_OPEN_HI(k) : 0) | (high ? COVER_OPEN_LO(k) : 0);
}

static void what_is_mirrored_is_met_alike(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 1);
    unsigned long long in_integers = 0;
    uint32_t meets = 0;
    for (uint32_t n = 0; n < CASES; n++) {
        struct mirrored_case it = draw(&rng);
        const unsigned long long before = cover_integers();
        const bool want = cover_meets(it.v, &it.part);
        meets += want;
        in_integers += cover_integers() - before;
        for (unsigned axes = 1; axes < 8; axes++) {
            struct mirrored_case other = it;
            for (int k = 0; k < 3; k++)
                if (axes >> k & 1)
                    mirror(&other, k);
            if (cover_meets(other.v, &other.part) != want)
                fail_msg("case %u mirrored at axes %u: not %d", n, axes, want);
        }
    }
    assert_true(meets > CASES / 10 && meets < CASES - CASES / 10);
    assert_true(in_integers > CASES / 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_mirrored_is_met_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
