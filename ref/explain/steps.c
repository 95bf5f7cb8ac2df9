#include "ref/explain/steps.h"

#include "ref/base/base.h"

#include <math.h>

static int64_t float_index(float x)
{
    uint32_t bits = float_bits(x);
    int64_t magnitude = bits & 0x7FFFFFFFu;
    return bits >> 31 ? -magnitude : magnitude;
}

int64_t float_steps(float from, float to)
{
    return float_index(to) - float_index(from);
}

/* Position on the line of halves: 1024 steps per binade from 2^-14 up, evenly below. */
static double half_position(float x)
{
    double a = fabs((double)x);
    double position;
    if (a < 0x1p-14) {
        position = a * 0x1p24;
    } else if (isinf(a)) {
        position = half_position(65536.0f); /* what an infinite half stands for */
    } else {
        int exponent;
        double fraction = frexp(a, &exponent); /* [0.5, 1) */
        position = 1024.0 * (exponent + 13) + 2048.0 * (fraction - 0.5) + 1024.0;
    }
    return signbit(x) ? -position : position;
}

double half_steps(float from, float to)
{
    if (isnan(from) || isnan(to))
        return NAN;
    return half_position(to) - half_position(from);
}
