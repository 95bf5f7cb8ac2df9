/* One kernel of ref/oracle/early.c, included once per vector width. Expects
 *   KERNEL    its name, with any attribute in KERNEL_TARGET
 *   LANES, V  doubles per vector and its type
 *   LOAD, SPLAT, SUB, MUL, MAX, MIN
 *   MISSED(most, least, bound, minus_bound)  bits of lanes with most > bound and least <
 *     minus_bound
 *   ABOVE(value, bound)  bits of lanes with value > bound
 * Neither KERNEL_TARGET may allow fma, nor may the operations be reordered: see early.h. */
KERNEL_TARGET
static uint64_t KERNEL(const struct early_soup *soup, const struct early_ray *ray, uint32_t first,
                       uint32_t count, double largest)
{
    const V ox = SPLAT(ray->o[ray->kx]), oy = SPLAT(ray->o[ray->ky]), oz = SPLAT(ray->o[ray->kz]);
    const V sx = SPLAT(ray->s[0]), sy = SPLAT(ray->s[1]);
    const double size = ray->bound * largest * largest;
    const V bound = SPLAT(size), minus_bound = SPLAT(-size), zero = SPLAT(0);
    const V beside = SPLAT(ray->beside * largest);
    const double *at[3][3];
    uint64_t missed = 0;
    for (int c = 0; c < 3; c++) {
        at[c][0] = soup->v[c][ray->kx] + first;
        at[c][1] = soup->v[c][ray->ky] + first;
        at[c][2] = soup->v[c][ray->kz] + first;
    }
    for (uint32_t i = 0; i < count; i += LANES) {
        V x[3], y[3];
        for (int c = 0; c < 3; c++) {
            V z = SUB(LOAD(at[c][2] + i), oz);
            x[c] = SUB(SUB(LOAD(at[c][0] + i), ox), MUL(sx, z));
            y[c] = SUB(SUB(LOAD(at[c][1] + i), oy), MUL(sy, z));
        }
        V w0 = SUB(MUL(x[1], y[2]), MUL(y[1], x[2]));
        V w1 = SUB(MUL(x[2], y[0]), MUL(y[2], x[0]));
        V w2 = SUB(MUL(x[0], y[1]), MUL(y[0], x[1]));
        V most = MAX(MAX(w0, w1), w2), least = MIN(MIN(w0, w1), w2);
        V low = MAX(MIN(MIN(x[0], x[1]), x[2]), MIN(MIN(y[0], y[1]), y[2]));
        V high = MIN(MAX(MAX(x[0], x[1]), x[2]), MAX(MAX(y[0], y[1]), y[2]));
        uint64_t lanes = (uint64_t)MISSED(most, least, bound, minus_bound) |
                         (uint64_t)ABOVE(MAX(low, SUB(zero, high)), beside);
        missed |= lanes << i;
    }
    return ~missed & (~(uint64_t)0 >> (EARLY_MOST - count));
}

#undef KERNEL
#undef KERNEL_TARGET
#undef LANES
#undef V
#undef LOAD
#undef SPLAT
#undef SUB
#undef MUL
#undef MAX
#undef MIN
#undef MISSED
#undef ABOVE
