#include "fuzz/play/coverage_bits.h"

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

/* Sets the bits of `mask` from `first` on; a ray costs some nanoseconds, so that its bits are
 * gathered without branches and set at once. */
static void set_mask(uint64_t map[COVERAGE_WORDS], uint32_t first, uint32_t mask)
{
    uint32_t word = first / 64, shift = first % 64;
    map[word] |= (uint64_t)mask << shift;
    if (shift > 32 && word + 1 < COVERAGE_WORDS)
        map[word + 1] |= (uint64_t)mask >> (64 - shift);
}

#define BIT(condition, bit) ((uint32_t)(condition) << (bit))

static uint32_t size_bits(float x)
{
    return float_bits(x) & 0x7FFFFFFFu;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* What a finite direction is; the sizes order as their bits. */
static uint32_t mask_of_direction(const float dir[3])
{
    const uint32_t normal = 0x00800000u;
    uint32_t x = size_bits(dir[0]), y = size_bits(dir[1]), z = size_bits(dir[2]);
    uint32_t zeros = (uint32_t)(x == 0) + (y == 0) + (z == 0), most = larger(x, larger(y, z));
    uint32_t mask = BIT(zeros == 1, COVERAGE_RAY_PARALLEL) |
                    BIT(zeros == 2, COVERAGE_RAY_ONE_AXIS) | BIT(zeros == 3, COVERAGE_RAY_ZERO);
    for (int k = 0; k < 3; k++) {
        uint32_t bits = float_bits(dir[k]);
        mask |= BIT(bits == 0x80000000u, COVERAGE_RAY_MINUS);
        mask |= BIT((bits & 0x7FFFFFFFu) - 1 < normal - 1, COVERAGE_RAY_SUBNORMAL);
    }
    mask |= BIT(most > float_bits(0x1p20f), COVERAGE_RAY_FAST);
    mask |= BIT(most - 1 < float_bits(0x1p-20f) - 1, COVERAGE_RAY_SLOW);
    return mask;
}

static uint32_t mask_of_origin(const float org[3], const struct box *root)
{
    bool inside = true, on_plane = false;
    for (int k = 0; k < 3; k++) {
        inside &= (org[k] >= root->lo[k]) & (org[k] <= root->hi[k]);
        on_plane |= (org[k] == root->lo[k]) | (org[k] == root->hi[k]);
    }
    return BIT(inside & !on_plane, COVERAGE_RAY_INSIDE) |
           BIT(inside & on_plane, COVERAGE_RAY_ON_FACE);
}

/* Out of contract; nearly all rays are let through by the exponents of their numbers. */
static bool is_out(const struct ray *ray, uint32_t most_org, uint32_t most_dir)
{
    const uint32_t one = 0x3F800000u, binade = 1u << 23;
    bool in = most_org < one + 40 * binade && most_dir < one + 40 * binade &&
              most_dir >= one - 40 * binade && ray->tmin >= 0 && ray->tmin <= ray->tmax &&
              float_is_finite(ray->tmin);
    for (int k = 0; k < 3; k++) {
        uint32_t size = size_bits(ray->dir[k]);
        in = in && (size == 0 || size > most_dir - 59 * binade);
    }
    return !in && !ray_in_contract(ray);
}

static uint32_t mask_of_ray(const struct ray *ray, const struct box *root)
{
    const uint32_t infinite = 0x7F800000u;
    uint32_t most_org = 0, most_dir = 0;
    bool any_infinite = false;
    for (int k = 0; k < 3; k++) {
        uint32_t o = size_bits(ray->org[k]), d = size_bits(ray->dir[k]);
        any_infinite = any_infinite || o == infinite || d == infinite;
        most_org = larger(most_org, o);
        most_dir = larger(most_dir, d);
    }
    uint32_t most = larger(most_org, most_dir);
    uint32_t range = larger(size_bits(ray->tmin), size_bits(ray->tmax));
    uint32_t mask = BIT(is_out(ray, most_org, most_dir), COVERAGE_RAY_OUT) |
                    BIT(ray->tmin == ray->tmax, COVERAGE_RAY_POINT) |
                    BIT(ray->tmin > ray->tmax, COVERAGE_RAY_BACKWARD) |
                    BIT(float_bits(ray->tmax) == infinite, COVERAGE_RAY_ENDLESS) |
                    BIT(any_infinite, COVERAGE_RAY_INFINITE) |
                    BIT(larger(most, range) > infinite, COVERAGE_RAY_NAN);
    if (most < infinite)
        mask |= mask_of_direction(ray->dir) | mask_of_origin(ray->org, root);
    return mask;
}

static uint32_t mask_of_truth(const struct oracle_answer *truth)
{
    return BIT(truth->class <= ORACLE_IN_PLANE, truth->class & 15u) |
           BIT((truth->flags & ORACLE_SAW_IN_PLANE) != 0, COVERAGE_TRUTH_SAW_PLANE) |
           BIT((truth->flags & ORACLE_REFUSED) != 0, COVERAGE_TRUTH_REFUSED) |
           BIT((truth->flags & ORACLE_SAW_EXACT) != 0, COVERAGE_TRUTH_INTEGERS);
}

void coverage_add_truth(uint64_t map[COVERAGE_WORDS], const struct ray *ray, const struct box *root,
                        const struct oracle_answer *truth)
{
    static const double ties[] = {2, 3, 4, 8};
    set_mask(map, COVERAGE_RAY, mask_of_ray(ray, root));
    set_mask(map, COVERAGE_TRUTH, mask_of_truth(truth));
    if (truth->prim == ABI_NO_PRIM)
        return;
    if (truth->tie_count > 1)
        coverage_set(map, COVERAGE_TIES, step_of(truth->tie_count, ties, ARRAY_COUNT(ties)));
    if (truth->t_lo <= (double)ray->tmin)
        coverage_set(map, COVERAGE_TRUTH, COVERAGE_TRUTH_ON_TMIN);
    if (truth->t_hi >= (double)ray->tmax)
        coverage_set(map, COVERAGE_TRUTH, COVERAGE_TRUTH_ON_TMAX);
    if (truth->t_next <= truth->t_hi * (1 + 0x1p-20))
        coverage_set(map, COVERAGE_TRUTH, COVERAGE_TRUTH_CLOSE_NEXT);
}

void coverage_add_answer(uint64_t map[COVERAGE_WORDS], enum query query,
                         const struct judgement *judgement)
{
    static const double over[] = {0, 0x1p-8, 0x1p-4, 0x1p-2, 0.5, 0.75, 1};
    static const double displacement[] = {1, 4, 16, 64, 256, 1024};
    uint32_t row = query == QUERY_ANY ? VERDICT_COUNT : 0;
    coverage_set(map, COVERAGE_VERDICT, row + judgement->verdict);
    if (judgement->verdict == VERDICT_WRONG)
        coverage_set(map, COVERAGE_WRONG, judgement->wrong);
    coverage_set(map, COVERAGE_ERROR, step_of(judgement->over, over, ARRAY_COUNT(over)));
    if (judgement->displacement > 0)
        coverage_set(map, COVERAGE_DISPLACE,
                     step_of(judgement->displacement, displacement, ARRAY_COUNT(displacement)));
}

void coverage_add_verdicts(uint64_t map[COVERAGE_WORDS], uint32_t mask)
{
    if ((mask & (mask - 1)) == 0)
        return; /* all alike: by far the most rays */
    uint32_t pair = 0;
    for (uint32_t a = 0; a < VERDICT_COUNT; a++)
        for (uint32_t b = a + 1; b < VERDICT_COUNT; b++, pair++)
            if ((mask >> a & 1) && (mask >> b & 1))
                coverage_set(map, COVERAGE_BOTH, pair);
}
