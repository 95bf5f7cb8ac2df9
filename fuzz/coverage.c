#include "fuzz/coverage_bits.h"

/* Number of the first step that `x` does not exceed; `count` if it exceeds all. */
static uint32_t step_of(double x, const double *step, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && !(x <= step[i]))
        i++;
    return i;
}

uint32_t coverage_merge(uint64_t into[COVERAGE_WORDS], const uint64_t from[COVERAGE_WORDS])
{
    uint32_t fresh = 0;
    for (size_t w = 0; w < COVERAGE_WORDS; w++) {
        for (uint64_t bits = from[w] & ~into[w]; bits; bits &= bits - 1)
            fresh++;
        into[w] |= from[w];
    }
    return fresh;
}

uint32_t coverage_count(const uint64_t map[COVERAGE_WORDS])
{
    uint64_t none[COVERAGE_WORDS] = {0};
    return coverage_merge(none, map);
}

static bool finite_ray(const struct ray *ray, uint64_t map[COVERAGE_WORDS])
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        if (ray->org[k] != ray->org[k] || ray->dir[k] != ray->dir[k]) {
            coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_NAN);
            finite = false;
        } else if (!float_is_finite(ray->org[k]) || !float_is_finite(ray->dir[k])) {
            coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_INFINITE);
            finite = false;
        }
    }
    if (ray->tmin != ray->tmin || ray->tmax != ray->tmax)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_NAN);
    return finite;
}

static void add_direction(uint64_t map[COVERAGE_WORDS], const struct ray *ray)
{
    float largest = 0;
    int zeros = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t bits = float_bits(ray->dir[k]), size = bits & 0x7FFFFFFFu;
        zeros += size == 0;
        if (bits == 0x80000000u)
            coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_MINUS);
        if (size > 0 && size < 0x00800000u)
            coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_SUBNORMAL);
        if (float_from_bits(size) > largest)
            largest = float_from_bits(size);
    }
    if (zeros > 0)
        coverage_set(map, COVERAGE_RAY + (zeros == 3   ? COVERAGE_RAY_ZERO
                                          : zeros == 2 ? COVERAGE_RAY_ONE_AXIS
                                                       : COVERAGE_RAY_PARALLEL));
    if (largest > 0x1p20f)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_FAST);
    else if (largest > 0 && largest < 0x1p-20f)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_SLOW);
}

static void add_ray(uint64_t map[COVERAGE_WORDS], const struct ray *ray, const struct box *root)
{
    if (!ray_in_contract(ray))
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_OUT);
    if (ray->tmin == ray->tmax)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_POINT);
    if (ray->tmin > ray->tmax)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_BACKWARD);
    if (float_bits(ray->tmax) == 0x7F800000u)
        coverage_set(map, COVERAGE_RAY + COVERAGE_RAY_ENDLESS);
    if (!finite_ray(ray, map))
        return;
    add_direction(map, ray);
    bool inside = true, on_plane = false;
    for (int k = 0; k < 3; k++) {
        inside = inside && ray->org[k] >= root->lo[k] && ray->org[k] <= root->hi[k];
        on_plane = on_plane || ray->org[k] == root->lo[k] || ray->org[k] == root->hi[k];
    }
    if (inside)
        coverage_set(map, COVERAGE_RAY + (on_plane ? COVERAGE_RAY_ON_FACE : COVERAGE_RAY_INSIDE));
}

void coverage_add_truth(uint64_t map[COVERAGE_WORDS], const struct ray *ray, const struct box *root,
                        const struct oracle_answer *truth)
{
    static const double ties[] = {2, 3, 4, 8};
    add_ray(map, ray, root);
    if (truth->class <= ORACLE_IN_PLANE)
        coverage_set(map, COVERAGE_TRUTH + truth->class);
    if (truth->flags & ORACLE_SAW_IN_PLANE)
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_SAW_PLANE);
    if (truth->flags & ORACLE_REFUSED)
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_REFUSED);
    if (truth->flags & ORACLE_SAW_EXACT)
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_INTEGERS);
    if (truth->prim == ABI_NO_PRIM)
        return;
    if (truth->tie_count > 1)
        coverage_set(map, COVERAGE_TIES + step_of(truth->tie_count, ties, ARRAY_COUNT(ties)));
    if (truth->t_lo <= (double)ray->tmin)
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_ON_TMIN);
    if (truth->t_hi >= (double)ray->tmax)
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_ON_TMAX);
    if (truth->t_next <= truth->t_hi * (1 + 0x1p-20))
        coverage_set(map, COVERAGE_TRUTH + COVERAGE_TRUTH_CLOSE_NEXT);
}

void coverage_add_answer(uint64_t map[COVERAGE_WORDS], enum query query,
                         const struct judgement *judgement)
{
    static const double over[] = {0, 0x1p-8, 0x1p-4, 0x1p-2, 0.5, 0.75, 1};
    static const double displacement[] = {1, 4, 16, 64, 256, JUDGE_DISPLACEMENT_MOST};
    uint32_t row = query == QUERY_ANY ? VERDICT_COUNT : 0;
    coverage_set(map, COVERAGE_VERDICT + row + (uint32_t)judgement->verdict);
    if (judgement->verdict == VERDICT_WRONG)
        coverage_set(map, COVERAGE_WRONG + (uint32_t)judgement->wrong);
    coverage_set(map, COVERAGE_ERROR + step_of(judgement->over, over, ARRAY_COUNT(over)));
    if (judgement->displacement > 0)
        coverage_set(map, COVERAGE_DISPLACE + step_of(judgement->displacement, displacement,
                                                      ARRAY_COUNT(displacement)));
}

void coverage_add_verdicts(uint64_t map[COVERAGE_WORDS], uint32_t mask)
{
    if ((mask & (mask - 1)) == 0)
        return; /* all alike: by far the most rays */
    uint32_t pair = 0;
    for (uint32_t a = 0; a < VERDICT_COUNT; a++)
        for (uint32_t b = a + 1; b < VERDICT_COUNT; b++, pair++)
            if ((mask >> a & 1) && (mask >> b & 1))
                coverage_set(map, COVERAGE_BOTH + pair);
}
