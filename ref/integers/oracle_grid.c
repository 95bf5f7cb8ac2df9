#include "ref/integers/oracle_grid.h"

struct odd odd_of(float x)
{
    uint32_t bits = float_bits(x), field = bits >> 23 & 0xFF, m = bits & 0x7FFFFF;
    if (field)
        m |= 0x800000;
    if (m == 0)
        return (struct odd){0, 0};
    int zeros = __builtin_ctz(m);
    int32_t size = (int32_t)(m >> zeros);
    return (struct odd){bits >> 31 ? -size : size, (int)(field ? field : 1) - 150 + zeros};
}

struct oracle_grid grid_of(const struct odd *x, int count)
{
    int low = 0, high = 0;
    bool any = false;
    for (int i = 0; i < count; i++) {
        if (x[i].m == 0)
            continue;
        uint32_t size = (uint32_t)(x[i].m < 0 ? -x[i].m : x[i].m);
        int top = x[i].exponent + 32 - __builtin_clz(size);
        low = !any || x[i].exponent < low ? x[i].exponent : low;
        high = !any || top > high ? top : high;
        any = true;
    }
    return (struct oracle_grid){low, high - low};
}

__int128 grid_int(struct oracle_grid grid, struct odd x)
{
    return x.m ? x.m * ((__int128)1 << (x.exponent - grid.exponent)) : 0;
}

void grid_wide(struct oracle_grid grid, struct odd x, struct oracle_wide *out)
{
    wide_set(x.m, out);
    if (x.m)
        wide_shift_left(out, (unsigned)(x.exponent - grid.exponent));
}
