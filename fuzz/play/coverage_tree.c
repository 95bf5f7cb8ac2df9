/* What a tree and its packed bytes have reached. */
#include "fuzz/play/coverage_bits.h"
#include "ref/base/half.h"

#include <math.h>
#include <string.h>

#define RECORD_LIMIT   32767u
#define TRIANGLE_LIMIT 65535u
#define NODES_LOOKED   4096u

static uint32_t step_of(uint32_t x, const uint32_t *step, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && x > step[i])
        i++;
    return i;
}

static uint32_t place_of(const void *const *table, const void *which, uint32_t places)
{
    uint32_t i = 0;
    while (table[i] && table[i] != which)
        i++;
    return i < places ? i : places - 1;
}

static void add_members(uint64_t map[COVERAGE_WORDS], const struct fuzz_trial *trial)
{
    uint32_t builder =
        place_of((const void *const *)builders_all, trial->builder, COVERAGE_BUILDERS);
    uint32_t box = place_of((const void *const *)box_tests, trial->box, COVERAGE_BOX_TESTS);
    uint32_t tri = place_of((const void *const *)tri_tests, trial->tri, COVERAGE_TRI_TESTS);
    coverage_set(map, COVERAGE_MEMBERS,
                 (builder * COVERAGE_BOX_TESTS + box) * COVERAGE_TRI_TESTS + tri);
    coverage_set(map, COVERAGE_STORE,
                 place_of((const void *const *)tri_stores, trial->store, COVERAGE_STORES));
    if (trial->build.passes > 0)
        coverage_set(map, COVERAGE_PAST, COVERAGE_PAST_OPTIMIZED);
}

void coverage_add_motion(uint64_t map[COVERAGE_WORDS], bool rebuilt)
{
    coverage_set(map, COVERAGE_PAST, rebuilt ? COVERAGE_PAST_REBUILT : COVERAGE_PAST_REFITTED);
}

/* A box without thickness in one, two or three axes. */
static void add_flatness(uint64_t map[COVERAGE_WORDS], const struct box *box)
{
    uint32_t flat = 0;
    for (int k = 0; k < 3; k++)
        flat += box->lo[k] == box->hi[k];
    if (flat > 0)
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_FLAT + flat - 1);
}

static float extent_of(const struct box *box)
{
    return fmaxf(box->hi[0] - box->lo[0], fmaxf(box->hi[1] - box->lo[1], box->hi[2] - box->lo[2]));
}

static void add_family(uint64_t map[COVERAGE_WORDS], const struct box *parent,
                       const struct box *fst, const struct box *snd)
{
    if (!box_contains_box(parent, fst) || !box_contains_box(parent, snd))
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_CUT);
    if (memcmp(fst, snd, sizeof *fst) == 0)
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_SAME);
    float whole = extent_of(parent);
    if (extent_of(fst) < whole * 0x1p-20f || extent_of(snd) < whole * 0x1p-20f)
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_MIXED);
}

static void add_scale(uint64_t map[COVERAGE_WORDS], const struct box *root)
{
    static const float step[] = {0,       0x1p-126f, 0x1p-60f, 0x1p-24f, 0x1p-14f, 1.0f,
                                 0x1p10f, 0x1p15f,   0x1p16f,  0x1p24f,  0x1p40f};
    float largest = 0;
    for (int k = 0; k < 3; k++)
        largest = fmaxf(largest, fmaxf(fabsf(root->lo[k]), fabsf(root->hi[k])));
    uint32_t i = 0;
    while (i < ARRAY_COUNT(step) && largest > step[i])
        i++;
    coverage_set(map, COVERAGE_SCALE, i);
}

/* At a limit of 16 bits, one below or one above. */
static void add_counts(uint64_t map[COVERAGE_WORDS], uint32_t items, uint64_t last_record)
{
    if (items == RECORD_LIMIT || items == RECORD_LIMIT + 1)
        coverage_set(map, COVERAGE_COUNT, items - RECORD_LIMIT);
    if (items == TRIANGLE_LIMIT || items == TRIANGLE_LIMIT + 1)
        coverage_set(map, COVERAGE_COUNT, 2 + items - TRIANGLE_LIMIT);
    if (items > TRIANGLE_LIMIT + 1)
        coverage_set(map, COVERAGE_COUNT, 4);
    if (last_record >= RECORD_LIMIT)
        coverage_set(map, COVERAGE_COUNT,
                     (last_record == RECORD_LIMIT       ? 5
                      : last_record == RECORD_LIMIT + 1 ? 6
                                                        : 7));
}

/* In layouts of 16-byte records a leaf takes two; the last child is the last node. */
static uint64_t last_record(const struct bvh *bvh)
{
    uint64_t leaves = 0;
    for (uint32_t i = 0; i + 1 < bvh->node_count; i++)
        leaves += bvh->node[i].item_count > 0;
    return bvh->node_count > 0 ? bvh->node_count - 1 + leaves : 0;
}

/* Depths of the nodes in pre-order: after a leaf comes the innermost second child still to come. */
struct descent {
    uint32_t snd[128], at[128]; /* those and their depths; a deeper tree counts as deepest */
    uint32_t pending, depth, deepest;
};

static void descend(struct descent *descent, uint32_t i, const struct bvh_node *node)
{
    if (descent->pending > 0 && descent->snd[descent->pending - 1] == i)
        descent->depth = descent->at[--descent->pending];
    if (descent->depth > descent->deepest)
        descent->deepest = descent->depth;
    if (node->item_count > 0)
        return;
    descent->depth++;
    if (descent->pending < ARRAY_COUNT(descent->snd)) {
        descent->snd[descent->pending] = node->snd;
        descent->at[descent->pending++] = descent->depth;
    }
}

void coverage_add_tree(uint64_t map[COVERAGE_WORDS], const struct fuzz_trial *trial,
                       const struct bvh *bvh)
{
    static const uint32_t depths[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 11, 15, 19, 23, 31, 47};
    static const uint32_t leaves[] = {1, 2, 3, 4, 5, 6, 7, 8, 15};
    struct descent descent = {.pending = 0};
    add_members(map, trial);
    if (bvh->node_count == 0) {
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_EMPTY);
        return;
    }
    add_scale(map, &bvh->node[0].bounds);
    add_counts(map, bvh->prim_count, last_record(bvh));
    if (bvh->node_count == 1)
        coverage_set(map, COVERAGE_SHAPE, COVERAGE_SHAPE_SINGLE);
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        uint32_t items = node->item_count;
        descend(&descent, i, node);
        if (i < NODES_LOOKED)
            add_flatness(map, &node->bounds);
        if (items > 0)
            coverage_set(map, COVERAGE_LEAF, step_of(items, leaves, ARRAY_COUNT(leaves)));
        else if (i < NODES_LOOKED)
            add_family(map, &node->bounds, &bvh->node[node->fst].bounds,
                       &bvh->node[node->snd].bounds);
    }
    coverage_set(map, COVERAGE_DEPTH, step_of(descent.deepest, depths, ARRAY_COUNT(depths)));
}

/* What a stored bound is; COVERAGE_HALVES: nothing of note. */
static enum coverage_half kind_of_half(uint32_t code)
{
    uint32_t size = code & 0x7FFFu;
    if (size >= 0x7C00u)
        return COVERAGE_HALF_INFINITE;
    if (size == 0x7BFFu)
        return COVERAGE_HALF_LARGEST;
    if (size == 0x0400u)
        return COVERAGE_HALF_LEAST;
    if (code == 0x8000u)
        return COVERAGE_HALF_MINUS_ZERO;
    if (size == 0)
        return COVERAGE_HALF_ZERO;
    if (size < 0x0400u)
        return COVERAGE_HALF_SUBNORMAL;
    return (size & 0x3FFu) == 0 ? COVERAGE_HALF_POWER : COVERAGE_HALVES;
}

static void add_half(uint64_t map[COVERAGE_WORDS], uint32_t code)
{
    enum coverage_half kind = kind_of_half(code);
    if (kind < COVERAGE_HALVES)
        coverage_set(map, COVERAGE_HALF, kind);
}

/* Record 0 of every node; the second records of leaves, which hold items, are passed over. */
static void add_halves(uint64_t map[COVERAGE_WORDS], const struct packed *packed)
{
    const uint32_t leaf = 0x80000000u;
    for (uint32_t r = 0; r < packed->node_count && r < NODES_LOOKED; r++) {
        const uint32_t *word = packed->word + 4 * (size_t)r;
        for (int k = 0; k < 3; k++) {
            uint32_t lo = word[k] & 0xFFFFu, hi = word[k] >> 16;
            add_half(map, lo);
            add_half(map, hi);
            if (lo == hi)
                coverage_set(map, COVERAGE_HALF, COVERAGE_HALF_FLAT);
            else if (lo + 1 == hi || hi + 1 == lo)
                coverage_set(map, COVERAGE_HALF, COVERAGE_HALF_STEP);
        }
        r += (word[3] & leaf) != 0;
    }
}

void coverage_add_packed(uint64_t map[COVERAGE_WORDS], const struct packed *packed)
{
    static const uint32_t stacks[] = {0, 1, 2, 4, 8, 15, 23, 31, 47};
    coverage_set(map, COVERAGE_STACK, step_of(packed->stack_need, stacks, ARRAY_COUNT(stacks)));
    coverage_set(map, COVERAGE_PACKED,
                 place_of((const void *const *)layouts_all, packed->layout, COVERAGE_FORMS));
    if (packed->split)
        coverage_set(map, COVERAGE_PAST, COVERAGE_PAST_SPLIT);
    if (packed->layout->node_bytes == sizeof(struct node_rf))
        add_halves(map, packed);
}

static enum coverage_limit limit_of(const struct fuzz_trial *trial, const struct bvh *bvh)
{
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if (bvh->node[i].item_count > 8)
            return COVERAGE_LIMIT_LEAF;
    if (last_record(bvh) > RECORD_LIMIT)
        return COVERAGE_LIMIT_RECORDS;
    if (trial->scene.tri_count > TRIANGLE_LIMIT + 1)
        return COVERAGE_LIMIT_INDICES;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        for (int k = 0; k < 3; k++)
            if (!(fabsf(bvh->node[i].bounds.lo[k]) <= HALF_MAX) ||
                !(fabsf(bvh->node[i].bounds.hi[k]) <= HALF_MAX))
                return COVERAGE_LIMIT_BOUNDS;
    return COVERAGE_LIMIT_OTHER;
}

void coverage_add_refusal(uint64_t map[COVERAGE_WORDS], const struct layout *layout,
                          const struct fuzz_trial *trial, const struct bvh *bvh)
{
    uint32_t row = place_of((const void *const *)layouts, layout, COVERAGE_LAYOUTS);
    coverage_set(map, COVERAGE_REFUSED, row * COVERAGE_LIMITS + (uint32_t)limit_of(trial, bvh));
}
