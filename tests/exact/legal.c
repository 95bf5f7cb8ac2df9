#include "tests/exact/legal_operations.h"

#include "ref/base/base.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define UNIT 0x1p-24

/* The choices of an operation of `kind` on a and b, the same each time. */
static uint32_t choice_of(const struct legal *l, uint32_t kind, float a, float b)
{
    uint32_t bits[2];
    memcpy(&bits[a > b], &a, sizeof a); /* a + b is b + a */
    memcpy(&bits[!(a > b)], &b, sizeof b);
    struct rng rng = rng_make(l->seed + kind, ((uint64_t)bits[0] << 32) | bits[1]);
    return (uint32_t)rng_u64(&rng) & 63u;
}

static uint32_t next_choice(struct legal *l, uint32_t kind, float a, float b)
{
    uint32_t choice = 0, at = l->count++ % LEGAL_MOST;
    switch (l->style) {
    case LEGAL_ALIKE:
        choice = choice_of(l, kind, a, b);
        break;
    case LEGAL_ALL_NEAREST:
        break;
    case LEGAL_ALL_LOW:
        choice = LEGAL_LOW;
        break;
    case LEGAL_ALL_HIGH:
        choice = LEGAL_HIGH | LEGAL_FUSE | LEGAL_FLUSH;
        break;
    case LEGAL_RANDOM:
        choice = (uint32_t)rng_u64(&l->rng) & 63u;
        break;
    case LEGAL_CHOSEN:
        choice = l->choice[at];
        break;
    }
    l->choice[at] = (uint8_t)choice;
    return choice;
}

static bool flushes(const struct legal *l)
{
    return l->rounding.tiny > 0x1p-149;
}

static float flushed(const struct legal *l, float x, bool wanted)
{
    return wanted && flushes(l) && fabsf(x) < FLT_MIN ? copysignf(0, x) : x;
}

/* The float32 next to head + tail, |tail| far below head's last place, on the side chosen. */
static float neighbour(double head, double tail, float nearest, uint32_t choice)
{
    float f = (float)head;
    bool below = (double)f < head || ((double)f == head && tail > 0);
    bool above = (double)f > head || ((double)f == head && tail < 0);
    if (choice & LEGAL_LOW)
        return above ? nextafterf(f, -INFINITY) : f;
    if (choice & LEGAL_HIGH)
        return below ? nextafterf(f, INFINITY) : f;
    return nearest;
}

static float rounded(const struct legal *l, double k, double head, double tail, float nearest,
                     uint32_t choice)
{
    float f = nearest;
    if (k >= 2.0 && isfinite(head)) {
        f = neighbour(head, tail, nearest, choice);
        /* Below the normal range one float32 step may be more than tiny only if nothing flushes. */
    }
    return flushed(l, f, (choice & LEGAL_FLUSH) != 0);
}

enum { OF_SUM, OF_PRODUCT, OF_QUOTIENT, OF_BOTH, OF_LOOK };

float legal_add(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_SUM, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    double x = (double)a, y = (double)b, sum = x + y, back = sum - x;
    double tail = (x - (sum - back)) + (y - back); /* Knuth: exactly what the sum lost */
    return rounded(l, l->rounding.add, sum, tail, a + b, choice);
}

float legal_sub(struct legal *l, float a, float b)
{
    return legal_add(l, a, -b);
}

float legal_mul(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_PRODUCT, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    return rounded(l, l->rounding.mul, (double)a * (double)b, 0, a * b, choice);
}

/* Any float32 within div u of the quotient: the farthest one on the side chosen. */
float legal_div(struct legal *l, float a, float b)
{
    uint32_t choice = next_choice(l, OF_QUOTIENT, a, b);
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    double q = (double)a / (double)b, k = l->rounding.div;
    float f = a / b;
    if (k > 1.0 && isfinite(q) && (choice & (LEGAL_LOW | LEGAL_HIGH))) {
        /* A little inside, so that the double's own rounding does not lead outside. */
        double reach = fabs(q) * k * UNIT * (1 - 1e-9) + (flushes(l) ? 0 : 0x1p-149);
        bool low = choice & LEGAL_LOW;
        double end = low ? q - reach : q + reach;
        f = neighbour(end, 0, (float)end, low ? LEGAL_HIGH : LEGAL_LOW);
    }
    return flushed(l, f, (choice & LEGAL_FLUSH) != 0);
}

/* In one rounding or two. */
float legal_multiply_add(struct legal *l, float a, float b, float c)
{
    uint32_t at = l->count;
    uint32_t choice = next_choice(l, OF_BOTH, a, b);
    if (!l->fuses || !(choice & LEGAL_FUSE)) {
        l->count = at + 1;
        return legal_add(l, legal_mul(l, a, b), c);
    }
    a = flushed(l, a, (choice & LEGAL_FLUSH_A) != 0);
    b = flushed(l, b, (choice & LEGAL_FLUSH_B) != 0);
    return flushed(l, fmaf(a, b, c), (choice & LEGAL_FLUSH) != 0);
}

float legal_seen(struct legal *l, float x)
{
    return flushed(l, x, (next_choice(l, OF_LOOK, x, 0) & LEGAL_FLUSH_A) != 0);
}

void legal_subtract(struct legal *l, const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = legal_sub(l, a[i], b[i]);
}

void legal_cross(struct legal *l, const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = legal_multiply_add(l, a[j], b[k], -legal_mul(l, a[k], b[j]));
    }
}

float legal_dot(struct legal *l, const float a[3], const float b[3])
{
    return legal_multiply_add(l, a[2], b[2],
                              legal_multiply_add(l, a[1], b[1], legal_mul(l, a[0], b[0])));
}

float legal_dot_back(struct legal *l, const float a[3], const float b[3])
{
    return legal_multiply_add(l, a[0], b[0],
                              legal_multiply_add(l, a[1], b[1], legal_mul(l, a[2], b[2])));
}
