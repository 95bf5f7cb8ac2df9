/* vk_settle on drawn modules: every word is as it must be. What draws a module knows each constant,
 * and writes beside it what must come of it; so that each rule meets each of the others, also where
 * a module breaks those of SPIR-V. */
#include "gpu/vk/vk_settle.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define INST(op, length) ((uint32_t)(length) << 16 | (uint32_t)(op))

enum { CONSTANTS = 24, BLOCKS = 16, FIRST = 1, WORDS_MOST = 1000, VALUES_MOST = 6 };
enum { BOOL = FIRST + CONSTANTS, UINT, LONG, LABELS, IDS = LABELS + BLOCKS };

struct settle_drawing {
    struct rng rng;
    uint32_t word[WORDS_MOST], wanted[WORDS_MOST], count, bound;
    uint32_t value[VALUES_MOST], values; /* of specialization constants */
    struct drawn_constant {
        uint32_t type, spec; /* 1 + its SpecId; 0: has none */
        bool known;
        uint32_t value;
    } constant[IDS];
    bool phis[IDS];
};

static uint32_t below(struct settle_drawing *m, uint32_t most)
{
    return rng_below(&m->rng, most);
}

static void put(struct settle_drawing *m, uint32_t word)
{
    assert_true(m->count < WORDS_MOST);
    m->word[m->count] = m->wanted[m->count] = word;
    m->count++;
}

static void put_all(struct settle_drawing *m, const uint32_t *word, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        put(m, word[i]);
}
#define PUT(m, ...)                                                                                \
    put_all(m, (const uint32_t[]){__VA_ARGS__},                                                    \
            sizeof((const uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t))

/* An id of none: 0, the first that is out of range, others. */
static uint32_t no_id(struct settle_drawing *m)
{
    const uint32_t of[] = {0, m->bound, m->bound + 1, UINT32_MAX};
    return of[below(m, 4)];
}

/* --- constants -------------------------------------------------------------------------------- */

static void draw_decorations(struct settle_drawing *m)
{
    for (uint32_t id = FIRST; id < BOOL; id++) {
        if (below(m, 2)) {
            m->constant[id].spec = 1 + below(m, VALUES_MOST + 2);
            PUT(m, INST(71, 4), id, 1, m->constant[id].spec - 1);
        }
        const uint32_t number = below(m, VALUES_MOST);
        if (below(m, 4) == 0) /* others name nothing */
            PUT(m, INST(71, 4), id, 2 + below(m, 40), number);
        if (below(m, 4) == 0)
            PUT(m, INST(71, 3), id, 1);
        if (below(m, 8) == 0)
            PUT(m, INST(71, 4), no_id(m), 1, number);
    }
}

/* One of the constants before `id` of that type, or FIRST. */
static uint32_t one_of(struct settle_drawing *m, uint32_t id, uint32_t type)
{
    uint32_t found = FIRST, count = 0;
    for (uint32_t i = FIRST; i < id; i++)
        if (m->constant[i].type == type && below(m, ++count) == 0)
            found = i;
    return found;
}

/* An operation, most of them of two truth values or of two integers. */
static void draw_operation(struct settle_drawing *m, uint32_t id)
{
    static const uint32_t of[] = {164, 165, 166, 167, 168, 170, 171, 172, 194, 200, 169};
    const uint32_t op = of[below(m, 11)];
    const uint32_t type =
        op == 170 || op == 171 || op == 172 || op == 194 || op == 200 ? UINT : BOOL;
    const uint32_t a = one_of(m, id, type), b = one_of(m, id, type);
    const struct drawn_constant *x = &m->constant[a], *y = &m->constant[b];
    const bool one = op == 168 || op == 200;
    struct drawn_constant *c = &m->constant[id];
    c->type = op == 194 || op == 200 ? UINT : BOOL;
    c->known = x->known && (one || y->known);
    switch (op) {
    case 164:
    case 170:
        c->value = x->value == y->value;
        break;
    case 165:
    case 171:
        c->value = x->value != y->value;
        break;
    case 166:
        c->value = x->value || y->value;
        break;
    case 167:
        c->value = x->value && y->value;
        break;
    case 168:
        c->value = !x->value;
        break;
    default: /* left to the driver */
        c->known = false;
    }
    if (op == 169)
        PUT(m, INST(52, 7), c->type, id, op, a, b, b);
    else if (below(m, 12) == 0) { /* of a wrong length */
        c->known = false;
        if (one)
            PUT(m, INST(52, 6), c->type, id, op, a, b);
        else
            PUT(m, INST(52, 5), c->type, id, op, a);
    } else if (one)
        PUT(m, INST(52, 5), c->type, id, op, a);
    else
        PUT(m, INST(52, 6), c->type, id, op, a, b);
}

static void draw_constant(struct settle_drawing *m, uint32_t id)
{
    struct drawn_constant *c = &m->constant[id];
    const uint32_t kind = id < FIRST + 6 ? id - FIRST : below(m, 12), truth = below(m, 2);
    if (kind == 1 || kind == 4) {
        const uint32_t literal = below(m, 3);
        c->type = UINT;
        c->known = true;
        c->value = c->spec > 0 && c->spec <= m->values ? m->value[c->spec - 1] : literal;
        PUT(m, INST(c->spec ? 50 : 43, 4), UINT, id, literal);
    } else if (kind == 0 || kind == 3 || kind == 2) {
        c->type = BOOL;
        c->known = c->spec == 0; /* OpSpecConstantTrue is left to the driver */
        c->value = truth;
        PUT(m, INST((c->spec ? 49 : 42) - truth, 3), BOOL, id);
    } else if (kind == 5) {
        c->type = LONG;
        PUT(m, INST(c->spec ? 50 : 43, 5), LONG, id, 1, 0);
    } else {
        draw_operation(m, id);
    }
    if (below(m, 8) == 0)
        PUT(m, INST(41, 3), BOOL, no_id(m));
    if (below(m, 8) == 0)
        PUT(m, INST(43, 4), UINT, no_id(m), 1);
}

/* --- blocks ----------------------------------------------------------------------------------- */

static uint32_t draw_condition(struct settle_drawing *m)
{
    return below(m, 8) ? FIRST + below(m, CONSTANTS) : below(m, 2) ? LABELS : no_id(m);
}

/* A merge and a branch behind it, or what only looks so. */
static void draw_branch(struct settle_drawing *m)
{
    const uint32_t kind = below(m, 16), condition = draw_condition(m), at = m->count;
    const uint32_t to = below(m, 12) ? LABELS + below(m, BLOCKS) : no_id(m);
    uint32_t other = LABELS + below(m, BLOCKS - 1);
    other += other >= to;
    if (kind == 0)
        PUT(m, INST(246, 4), to, other, 0);
    else if (kind == 1)
        PUT(m, INST(247, 4), to, 0, 0);
    else if (kind == 2)
        PUT(m, INST(247, 2), to);
    else if (kind != 3)
        PUT(m, INST(247, 3), to, 0);
    if (kind == 4)
        PUT(m, INST(0, 1));
    if (kind == 5)
        PUT(m, INST(251, 4), condition, to, other);
    else if (kind == 6)
        PUT(m, INST(250, 3), condition, to);
    else if (kind < 12)
        PUT(m, INST(250, 4), condition, to, other);
    else
        PUT(m, INST(250, 6), condition, to, other, 1, 2);
    const struct drawn_constant none = {0},
                                *c = condition < LABELS ? &m->constant[condition] : &none;
    const uint32_t taken = c->value ? to : other, left = c->value ? other : to;
    if (kind < 7 || !c->known || (left < m->bound && m->phis[left]))
        return;
    for (uint32_t i = at; i < m->count - 2; i++)
        m->wanted[i] = INST(0, 1);
    m->wanted[m->count - 2] = INST(249, 2);
    m->wanted[m->count - 1] = taken;
}

static void draw_blocks(struct settle_drawing *m)
{
    for (uint32_t id = LABELS; id < IDS; id++)
        m->phis[id] = below(m, 3) == 0 && id < m->bound;
    for (uint32_t id = LABELS; id < IDS; id++) {
        PUT(m, INST(248, 2), id);
        if (m->phis[id])
            PUT(m, INST(245, 5), UINT, below(m, IDS), FIRST, LABELS);
        else if (below(m, 2))
            PUT(m, INST(0, 1));
        if (below(m, 8) == 0) /* no block of theirs */
            PUT(m, INST(248, 2), no_id(m), INST(245, 5), UINT, 0, FIRST, LABELS);
        draw_branch(m);
    }
    if (below(m, 4) == 0) /* nothing is behind it */
        PUT(m, INST(247, 3), LABELS, 0);
}

static struct settle_drawing *draw(uint64_t seed)
{
    struct settle_drawing *m = calloc(1, sizeof *m);
    assert_non_null(m);
    m->rng = rng_make(seed, 0);
    m->bound = IDS - below(m, 4); /* the last labels may be none */
    m->values = below(m, VALUES_MOST + 1);
    for (uint32_t i = 0; i < VALUES_MOST; i++)
        m->value[i] = below(m, 3);
    PUT(m, 0x07230203, 0x00010300, 0, m->bound, 0);
    draw_decorations(m);
    for (uint32_t id = FIRST; id < BOOL; id++)
        draw_constant(m, id);
    draw_blocks(m);
    return m;
}

static void every_word_is_as_it_must_be(void **state)
{
    (void)state;
    uint32_t settled = 0, left = 0;
    for (uint64_t seed = 0; seed < 8000; seed++) {
        struct settle_drawing *m = draw(seed);
        uint32_t *out = NULL, *exact = malloc(m->count * sizeof *exact);
        assert_non_null(exact);
        memcpy(exact, m->word, m->count * sizeof *exact); /* nothing behind it is read */
        assert_int_equal(vk_settle(exact, m->count, m->value, m->values, &out), STATUS_OK);
        assert_non_null(out);
        assert_memory_equal(exact, m->word, m->count * sizeof *exact);
        for (uint32_t i = 0; i < m->count; i++) {
            if (out[i] != m->wanted[i])
                fail_msg("module %u, word %u: %08x, not %08x", (unsigned)seed, i, out[i],
                         m->wanted[i]);
            settled += m->wanted[i] == INST(249, 2);
            left += m->wanted[i] == INST(250, 4);
        }
        free(out);
        free(exact);
        free(m);
    }
    assert_true(settled > 10000 && left > 10000);
}

/* A module of no instruction is one; so is one with the largest bound. */
static void the_smallest_and_the_widest_module(void **state)
{
    (void)state;
    static const uint32_t bound[] = {1, 0x3FFFFF};
    for (int i = 0; i < 2; i++) {
        const uint32_t word[] = {0x07230203, 0x00010300, 0, bound[i], 0};
        uint32_t *out;
        assert_int_equal(vk_settle(word, 5, NULL, 0, &out), STATUS_OK);
        assert_non_null(out);
        assert_memory_equal(out, word, sizeof word);
        free(out);
        assert_int_equal(vk_settle(word, 4, NULL, 0, &out), STATUS_OK);
        assert_null(out);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_word_is_as_it_must_be),
        cmocka_unit_test(the_smallest_and_the_widest_module),
    };
    return cmocka_run_group_tests_name("settle_drawn", tests, NULL, NULL);
}
