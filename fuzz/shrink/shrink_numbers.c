/* Passes that make numbers round and short: each number alone, chunks of them, and all that are
 * equal together, since equal ones often have to stay so. */
#include "fuzz/shrink/shrink_inner.h"

#include "fuzz/gen/gen_sketch.h"

#include <string.h>

/* Vertices and rays of a trial whose numbers are tried one by one, at most. */
#define FEW_MOST 256u

uint32_t shrink_number_count(const struct fuzz_trial *trial)
{
    return 3 * trial->scene.vertex_count + 8 * trial->ray_count + 12 * trial->world.instance_count;
}

float *shrink_number(struct fuzz_trial *trial, uint32_t i)
{
    uint32_t coordinates = 3 * trial->scene.vertex_count;
    if (i < coordinates)
        return &trial->scene.vertex[i];
    uint32_t of_rays = 8 * trial->ray_count;
    if (i >= coordinates + of_rays) {
        uint32_t at = i - coordinates - of_rays;
        return &trial->world.instance[at / 12].m[at % 12 / 4][at % 4];
    }
    struct ray *ray = &trial->ray[(i - coordinates) / 8];
    uint32_t k = (i - coordinates) % 8;
    return k < 3 ? &ray->org[k] : k < 6 ? &ray->dir[k - 3] : k == 6 ? &ray->tmin : &ray->tmax;
}

enum shrink_role shrink_role(const struct fuzz_trial *trial, uint32_t i, uint32_t *axis)
{
    uint32_t coordinates = 3 * trial->scene.vertex_count, k = i % 3;
    enum shrink_role role = SHRINK_VERTEX;
    if (i >= coordinates + 8 * trial->ray_count) {
        role = SHRINK_TRANSFORM;
        k = 0;
    } else if (i >= coordinates) {
        k = (i - coordinates) % 8;
        role = k < 3 ? SHRINK_ORG : k < 6 ? SHRINK_DIR : k == 6 ? SHRINK_TMIN : SHRINK_TMAX;
        k = k < 6 ? k % 3 : 0;
    }
    *axis = k;
    return role;
}

int shrink_exponent(float x)
{
    uint32_t bits = float_bits(x) & 0x7FFFFFFFu;
    if (bits == 0 || bits >= 0x7F800000u)
        return 0;
    if (bits >= 0x00800000u)
        return (int)(bits >> 23) - 127;
    int exponent = -149;
    while (bits >>= 1)
        exponent++;
    return exponent;
}

float shrink_scaled(float x, int by)
{
    for (; by > 127; by -= 127)
        x *= power_of_two(127);
    for (; by < -126; by += 126)
        x *= power_of_two(-126);
    return x * power_of_two(by);
}

/* x with at most `kept` significant bits, to nearest, ties away from zero. */
static float rounded(float x, uint32_t kept)
{
    uint32_t bits = float_bits(x), drop = 24 - kept;
    return float_from_bits((bits + (1u << (drop - 1))) & ~((1u << drop) - 1));
}

/* x without its last significant bit, towards zero or away from it. */
static float without_last_bit(float x, bool away)
{
    uint32_t bits = float_bits(x), last = bits & (0u - bits);
    if ((bits & 0x7FFFFFu) == 0)
        return x;
    return float_from_bits(away ? bits + last : bits - last);
}

static float with_exponent(float x, int exponent)
{
    return shrink_scaled(x, exponent - shrink_exponent(x));
}

static float nearest_integer(float x)
{
    if (!(x > -8388608.0f && x < 8388608.0f))
        return x;
    return (float)(int32_t)(x + (x < 0 ? -0.5f : 0.5f));
}

/* The simplest first. */
enum {
    TO_ZERO, /* tmax: infinity */
    TO_ONE,
    TO_MINUS_ONE,
    TO_POSITIVE,
    TO_POWER_BELOW,
    TO_POWER_ABOVE,
    TO_EXPONENT_ZERO,
    TO_EXPONENT_HALF,
    TO_EXPONENT_NEARER,
    TO_INTEGER,
    TO_BITS,
    BITS_COUNT = 12,
    TO_LESS_BIT = TO_BITS + BITS_COUNT,
    TO_LESS_BIT_AWAY,
    ROUND_COUNT
};

static float round_number(float x, uint32_t variant, bool tmax)
{
    static const uint8_t kept[BITS_COUNT] = {2, 3, 4, 5, 6, 8, 10, 11, 12, 14, 17, 20};
    int exponent = shrink_exponent(x);
    if (variant == TO_ZERO)
        return tmax ? float_from_bits(0x7F800000u) : 0.0f;
    if (variant == TO_ONE || variant == TO_MINUS_ONE)
        return variant == TO_ONE ? 1.0f : -1.0f;
    if (variant == TO_POSITIVE)
        return float_from_bits(float_bits(x) & 0x7FFFFFFFu);
    if (!float_is_finite(x) || x == 0)
        return x;
    if (variant >= TO_BITS && variant < TO_LESS_BIT)
        return rounded(x, kept[variant - TO_BITS]);
    switch (variant) {
    case TO_POWER_BELOW:
        return float_from_bits(float_bits(x) & 0xFF800000u);
    case TO_POWER_ABOVE:
        return float_from_bits((float_bits(x) + 0x7FFFFFu) & 0xFF800000u);
    case TO_EXPONENT_ZERO:
        return with_exponent(x, 0);
    case TO_EXPONENT_HALF:
        return with_exponent(x, exponent / 2);
    case TO_EXPONENT_NEARER:
        return with_exponent(x, exponent - (exponent > 0) + (exponent < 0));
    case TO_INTEGER:
        return nearest_integer(x);
    default:
        return without_last_bit(x, variant == TO_LESS_BIT_AWAY);
    }
}

#define CARRIED 3u

static void change_number(struct fuzz_trial *trial, uint32_t i, uint32_t variant)
{
    uint32_t axis;
    float *x = shrink_number(trial, i);
    *x = round_number(*x, variant, shrink_role(trial, i, &axis) == SHRINK_TMAX);
}

static bool change_row(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    for (uint32_t i = first; i < first + count; i++)
        change_number(trial, i, variant);
    return true;
}

uint32_t shrink_few_numbers(const struct fuzz_trial *trial)
{
    return trial->scene.vertex_count <= FEW_MOST && trial->ray_count <= FEW_MOST &&
                   trial->world.instance_count <= FEW_MOST / 4
               ? shrink_number_count(trial)
               : 0;
}

/* True if the numbers are both of transforms or both not, have one magnitude and, if `axis_too`,
 * are places on one axis. */
static bool alike(struct fuzz_trial *trial, uint32_t a, uint32_t b, bool axis_too)
{
    uint32_t axis_a, axis_b;
    enum shrink_role role_a = shrink_role(trial, a, &axis_a);
    enum shrink_role role_b = shrink_role(trial, b, &axis_b);
    if (axis_too && (axis_a != axis_b || role_a > SHRINK_ORG || role_b > SHRINK_ORG))
        return a == b;
    if ((role_a == SHRINK_TRANSFORM) != (role_b == SHRINK_TRANSFORM))
        return false; /* a 1 of a transform must stay, mostly */
    return (float_bits(*shrink_number(trial, a)) << 1) ==
           (float_bits(*shrink_number(trial, b)) << 1);
}

/* All numbers that are like number `first`, of which it is the first. */
static bool change_alike(struct fuzz_trial *trial, uint32_t first, uint32_t variant, bool axis_too)
{
    uint32_t n = shrink_number_count(trial), also = 0;
    for (uint32_t i = 0; i < first; i++)
        if (alike(trial, i, first, axis_too))
            return false;
    for (uint32_t i = first + 1; i < n; i++)
        if (alike(trial, i, first, axis_too)) {
            change_number(trial, i, variant);
            also++;
        }
    change_number(trial, first, variant);
    return also > 0;
}

static bool change_value(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    (void)count;
    return change_alike(trial, first, variant, false);
}

static bool change_plane(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    (void)count;
    return change_alike(trial, first, variant, true);
}

/* A coordinate, and rays moved along: by as much, by half, by a quarter. */
static bool change_carrying(struct fuzz_trial *trial, uint32_t first, uint32_t count,
                            uint32_t variant)
{
    static const float share[CARRIED] = {1.0f, 0.5f, 0.25f};
    float before = *shrink_number(trial, first);
    (void)count;
    change_number(trial, first, variant / CARRIED);
    float by = share[variant % CARRIED] * (*shrink_number(trial, first) - before);
    for (uint32_t i = 0; i < trial->ray_count; i++)
        trial->ray[i].org[first % 3] += by;
    return true;
}

static uint32_t carrying(const struct fuzz_trial *trial)
{
    return trial->scene.vertex_count <= FEW_MOST && trial->ray_count == 1
               ? 3 * trial->scene.vertex_count
               : 0;
}

/* Places on an axis by their rank: 0, 1, 2, ... in the same order; axis 3 is all. */
static bool change_ranks(struct fuzz_trial *trial, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t n = trial->scene.vertex_count;
    struct fuzz_trial old;
    struct reason reason;
    (void)first, (void)count;
    if (n > FEW_MOST || fuzz_trial_copy(trial, &old, &reason))
        return false;
    for (uint32_t i = 0; i < 3 * n; i++) {
        uint32_t rank = 0;
        float x = old.scene.vertex[i];
        for (uint32_t j = i % 3; j < 3 * n; j += 3) {
            bool new = old.scene.vertex[j] < x;
            for (uint32_t k = i % 3; k < j && new; k += 3)
                new = old.scene.vertex[k] != old.scene.vertex[j];
            rank += new;
        }
        if (variant == 3 || variant == i % 3)
            trial->scene.vertex[i] = (float)rank;
    }
    fuzz_trial_free(&old);
    return true;
}

const struct shrink_pass shrink_values = {"values", SHRINK_SINGLY, shrink_few_numbers, ROUND_COUNT,
                                          change_value};
const struct shrink_pass shrink_planes = {"planes", SHRINK_SINGLY, shrink_few_numbers, ROUND_COUNT,
                                          change_plane};
const struct shrink_pass shrink_numbers = {"numbers", SHRINK_CHUNKS, shrink_number_count,
                                           ROUND_COUNT, change_row};
const struct shrink_pass shrink_carrying = {"carrying", SHRINK_SINGLY, carrying,
                                            CARRIED *ROUND_COUNT, change_carrying};
const struct shrink_pass shrink_ranks = {"ranks", SHRINK_SINGLY, shrink_one, 4, change_ranks};
