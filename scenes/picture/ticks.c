#include "scenes/picture/ticks.h"

#include <math.h>
#include <stdio.h>

#define FAR 1e300

void ticks_range(double *lo, double *hi)
{
    if (!(*lo <= *hi)) {
        *lo = 0.0;
        *hi = 1.0;
        return;
    }
    *lo = fmin(fmax(*lo, -FAR), FAR);
    *hi = fmin(fmax(*hi, -FAR), FAR);
    /* Wide enough for ticks to be different doubles. */
    double middle = 0.5 * *lo + 0.5 * *hi, size = fmax(fabs(*lo), fabs(*hi));
    double least = fmax(1e-12 * size, 1e-300);
    if (*hi - *lo >= least)
        return;
    double half = size > 0.0 ? fmax(0.05 * size, least) : 1.0;
    *lo = middle - half;
    *hi = middle + half;
}

size_t ticks_linear(double lo, double hi, size_t wanted, double tick[TICKS_MOST], double *step)
{
    double rough = (hi - lo) / (double)wanted, power = pow(10.0, floor(log10(rough)));
    double factor = rough / power; /* 1 to 10 */
    *step = power * (factor < 1.5 ? 1.0 : factor < 3.5 ? 2.0 : factor < 7.5 ? 5.0 : 10.0);
    size_t count = 0;
    const double slack = 1e-9 * (hi - lo); /* includes ends that are multiples of the step */
    for (double k = ceil((lo - slack) / *step); count < TICKS_MOST; k += 1.0) {
        double value = k * *step;
        if (!(value <= hi + slack))
            break;
        tick[count++] = value == 0.0 ? 0.0 : value; /* no -0 */
    }
    return count;
}

size_t ticks_log(double lo, double hi, double tick[TICKS_MOST])
{
    double decades = log10(hi / lo);
    int first = (int)floor(log10(lo)), last = (int)ceil(log10(hi));
    int step = decades > 6.0 ? 2 : 1;
    while ((last - first) / step >= TICKS_MOST)
        step *= 2;
    size_t count = 0;
    for (int e = first; e <= last; e += step)
        for (int k = 0; k < 3; k++) {
            static const double factor[3] = {1, 2, 5};
            double value = factor[k] * pow(10.0, e);
            if (k > 0 && decades > 2.2)
                continue;
            if (value >= lo * 0.999 && value <= hi * 1.001 && count < TICKS_MOST)
                tick[count++] = value;
        }
    return count;
}

void tick_text(double value, double step, char *text, size_t text_bytes)
{
    if (value == 0.0 || !isfinite(value)) {
        snprintf(text, text_bytes, "%g", value == 0.0 ? 0.0 : value);
        return;
    }
    double size = fabs(value);
    int digits = 7, exponent = (int)floor(log10(size) + 1e-9);
    if (step > 0.0)
        digits = (int)fmin(fmax(ceil(log10(size / step) - 1e-9) + 1.0, 1.0), 15.0);
    if (exponent > 4 || exponent < -3)
        snprintf(text, text_bytes, "%.*ge%d", digits, value / pow(10.0, exponent), exponent);
    else
        snprintf(text, text_bytes, "%.*g", digits > exponent ? digits : exponent + 1, value);
}
