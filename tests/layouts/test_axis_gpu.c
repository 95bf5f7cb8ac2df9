/* Axes of wide nodes, and records of boxes, that shaders make of integers
 * (shaders/build/build_axis.glsl and encode_*.glsl) have the words of C, on every driver here. */
#include "ref/layouts/wide_nodes.h"
#include "tests/layouts/drawn_bits.h"

#include <math.h>

#include "tests/support/gpu.h"

#define GROUP      64u
#define LARGEST    227u /* biased exponent of 2^100 */
#define POWERS     (LARGEST + 1)
#define PAIRS      (4 * POWERS * POWERS)
#define ROUNDS     4u
#define NEIGHBOURS (PAIRS / 2)

/* --- axes ------------------------------------------------------------------------------------- */

struct axis_case {
    uint32_t lo, hi, most, x;
};

struct axis_made {
    uint32_t origin, exponent, lo_down, hi_up, lo_up, hi_down, x_down, x_up;
};

static uint32_t bits_of(uint32_t exponent, uint32_t fraction, uint32_t sign)
{
    return sign << 31 | exponent << 23 | (exponent < LARGEST ? fraction & 0x7FFFFFu : 0);
}

/* A number from lo to hi: an end, any, or on a plane of the axis or beside it. */
static uint32_t draw_between(struct rng *rng, const struct axis_case *c)
{
    const int64_t lo = order_of_bits(c->lo), hi = order_of_bits(c->hi);
    int64_t x = lo + (int64_t)(rng_float(rng) * (float)(hi - lo));
    if (rng_below(rng, 2)) {
        struct node_axis axis =
            node_axis_make(float_from_bits(c->lo), float_from_bits(c->hi), c->most);
        float plane = node_axis_plane(&axis, rng_below(rng, c->most + 1));
        x = order_of_bits(float_bits(plane)) + (int64_t)rng_below(rng, 3) - 1;
    }
    return x < lo ? c->lo : x > hi ? c->hi : bits_of_order(x);
}

static struct axis_case ordered(struct rng *rng, uint32_t a, uint32_t b)
{
    static const uint32_t most[] = {63, 255, 63, 255, 2, 3, 254, 15};
    struct axis_case c = {.lo = a, .hi = b, .most = most[rng_below(rng, ARRAY_COUNT(most))]};
    if (order_of_bits(a) > order_of_bits(b)) {
        c.lo = b;
        c.hi = a;
    }
    c.x = draw_between(rng, &c);
    return c;
}

/* Every pair of exponents and signs. */
static void draw_pairs(struct rng *rng, struct axis_case *out)
{
    for (uint32_t i = 0; i < PAIRS; i++) {
        uint32_t a = bits_of(i / 4 / POWERS, draw_fraction(rng), i & 1);
        uint32_t b = bits_of(i / 4 % POWERS, draw_fraction(rng), i >> 1 & 1);
        out[i] = ordered(rng, a, b);
    }
}

/* Bounds that are equal, or some floats apart. */
static void draw_neighbours(struct rng *rng, struct axis_case *out)
{
    const int64_t largest = (int64_t)bits_of(LARGEST, 0, 0);
    for (uint32_t i = 0; i < NEIGHBOURS; i++) {
        uint32_t a = bits_of(i % POWERS, draw_fraction(rng), i / POWERS % 2);
        int64_t b = order_of_bits(a) + (int64_t)rng_below(rng, 1u << rng_below(rng, 11));
        out[i] = ordered(rng, a, bits_of_order(b < largest ? b : largest));
    }
}

static void check_axis(const struct axis_case *c, const struct axis_made *made)
{
    const float lo = float_from_bits(c->lo), hi = float_from_bits(c->hi);
    const float x = float_from_bits(c->x);
    struct node_axis axis = node_axis_make(lo, hi, c->most);
    const struct axis_made mine = {float_bits(axis.origin),   (uint32_t)axis.exponent,
                                   node_axis_down(&axis, lo), node_axis_up(&axis, hi),
                                   node_axis_up(&axis, lo),   node_axis_down(&axis, hi),
                                   node_axis_down(&axis, x),  node_axis_up(&axis, x)};
    if (memcmp(&mine, made, sizeof mine) != 0)
        fail_msg("%a to %a in %u, %a: %08x 2^%d %u %u %u %u %u %u, not %08x 2^%d %u %u %u %u %u %u",
                 (double)lo, (double)hi, c->most, (double)x, made->origin, (int)made->exponent,
                 made->lo_down, made->hi_up, made->lo_up, made->hi_down, made->x_down, made->x_up,
                 mine.origin, (int)mine.exponent, mine.lo_down, mine.hi_up, mine.lo_up,
                 mine.hi_down, mine.x_down, mine.x_up);
}

static void check_axes(struct vk *vk, const struct axis_case *c, uint32_t count)
{
    static const uint32_t group = GROUP;
    struct axis_made *made = malloc(count * sizeof *made);
    assert_non_null(made);
    memset(made, 0xA5, count * sizeof *made);
    struct axis_case *given = alloc_copy(c, count, sizeof *c);
    assert_non_null(given);
    gpu_run_on(vk, "probe_axis", &group, 1, &count, sizeof count, (count + GROUP - 1) / GROUP, 2,
               (const uint64_t[]){count * sizeof *c, count * sizeof *made},
               (void *const[]){given, made});
    for (uint32_t i = 0; i < count; i++)
        check_axis(&c[i], &made[i]);
    free(given);
    free(made);
}

static void play_axes(struct vk *vk, const char *driver, void *of)
{
    (void)of;
    struct rng rng = rng_make(1, 0);
    struct axis_case *c = malloc(PAIRS * sizeof *c);
    assert_non_null(c);
    for (uint32_t round = 0; round < ROUNDS; round++) {
        draw_pairs(&rng, c);
        check_axes(vk, c, PAIRS);
        draw_neighbours(&rng, c);
        check_axes(vk, c, NEIGHBOURS);
    }
    free(c);
    print_message("%s: %u axes\n", driver, ROUNDS * (PAIRS + NEIGHBOURS));
}

static void axes_are_those_of_c(void **state)
{
    (void)state;
    if (!gpu_on_cpu_drivers(play_axes, NULL))
        skip();
}

/* --- records ---------------------------------------------------------------------------------- */

#define RECORDS 20000u
#define SLOTS   8u
#define WORDS   36u /* 20 of cwbvh80, 16 of tiny8 */

struct boxes {
    uint32_t there;
    struct box box[SLOTS];
};

/* Boxes about one place, of one magnitude or several; some flat, some zeros of either sign. */
static void draw_boxes(struct rng *rng, struct boxes *out)
{
    const int magnitude = (int)rng_below(rng, 240) - 140;
    const float place = rng_below(rng, 2) ? 0 : ldexpf(rng_range(rng, -1, 1), magnitude);
    const uint32_t spread = 1 + rng_below(rng, rng_below(rng, 2) ? 2 : 60);
    out->there = 1 + rng_below(rng, 255);
    for (uint32_t s = 0; s < SLOTS; s++)
        for (int k = 0; k < 3; k++) {
            const int to = magnitude - (int)rng_below(rng, spread);
            float a = place + ldexpf(rng_range(rng, -0.5f, 0.5f), to), b = a;
            if (rng_below(rng, 8))
                b = place + ldexpf(rng_range(rng, -0.5f, 0.5f), to);
            if (rng_below(rng, 16) == 0)
                a = rng_below(rng, 2) ? 0.0f : -0.0f;
            out->box[s].lo[k] = a < b ? a : b;
            out->box[s].hi[k] = a < b ? b : a;
        }
}

static void put_boxes(const char *layout, const struct boxes *boxes, uint32_t *word)
{
    const struct wide_form *form = layout_find(layout)->family;
    const struct box *box[WIDE_MAX];
    for (uint32_t s = 0; s < SLOTS; s++)
        box[s] = boxes->there >> s & 1 ? &boxes->box[s] : NULL;
    form->put_boxes(box, word);
}

static void play_records(struct vk *vk, const char *driver, void *of)
{
    static const uint32_t group = GROUP, count = RECORDS;
    struct rng rng = rng_make(2, 0);
    struct boxes *boxes = malloc(RECORDS * sizeof *boxes);
    uint32_t *made = malloc(RECORDS * WORDS * sizeof *made), *mine;
    (void)of;
    assert_non_null(boxes);
    assert_non_null(made);
    for (uint32_t i = 0; i < RECORDS; i++)
        draw_boxes(&rng, &boxes[i]);
    for (uint32_t i = 0; i < RECORDS * WORDS; i++)
        made[i] = rng_below(&rng, UINT32_MAX);
    mine = alloc_copy(made, RECORDS * WORDS, sizeof *made);
    assert_non_null(mine);
    gpu_run_on(vk, "probe_encode", &group, 1, &count, sizeof count, (count + GROUP - 1) / GROUP, 2,
               (const uint64_t[]){RECORDS * sizeof *boxes, RECORDS * WORDS * sizeof *made},
               (void *const[]){boxes, made});
    for (uint32_t i = 0; i < RECORDS; i++) {
        put_boxes("cwbvh80", &boxes[i], &mine[WORDS * i]);
        put_boxes("tiny8", &boxes[i], &mine[WORDS * i + 20]);
        for (uint32_t w = WORDS * i; w < WORDS * (i + 1); w++)
            if (made[w] != mine[w])
                fail_msg("%s: record %u, slots %02x, word %u: %08x, not %08x", driver, i,
                         boxes[i].there, w % WORDS, made[w], mine[w]);
    }
    free(boxes);
    free(made);
    free(mine);
}

static void records_are_those_of_c(void **state)
{
    (void)state;
    if (!gpu_on_cpu_drivers(play_records, NULL))
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_are_those_of_c),
        cmocka_unit_test(records_are_those_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
