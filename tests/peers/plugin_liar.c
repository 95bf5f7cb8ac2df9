/* The layout of fuzz/samples/layout/mine.c with a lie, number LIE: a shared object of each for
 * tests/scripts/plugin.sh, and a variable for tests/outside/test_plugin.c. Needs no more than
 * ref/plugin.h. */
#include "ref/plugin.h"

const struct raydiff_plugin *honest_plugin(void);
#define raydiff_plugin(none) honest_plugin(none)
#include "fuzz/samples/layout/mine.c"
#undef raydiff_plugin

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum lie {
    LIE_HONEST,
    LIE_ULP,      /* the last leaf's upper bound is one float short */
    LIE_CHILD,    /* a child is out of range */
    LIE_LOST,     /* a triangle is in no leaf */
    LIE_TWICE,    /* and another twice */
    LIE_SIZE,     /* pack() says four times as many records as it was given */
    LIE_CYCLE,    /* a child is the root */
    LIE_NAN,      /* a bound is NaN */
    LIE_CHILDREN, /* load() says nine children */
    LIE_TRIANGLE, /* an item beyond the scene */
    LIE_LEAF,     /* a leaf without items */
    LIE_ROOT,     /* the root is out of range */
    LIE_ONE,      /* load() says one child */
    LIE_NOTHING,  /* pack() asks for nothing */
    LIE_CODE,     /* pack() returns what is no result */
    LIE_LIMIT,    /* no lie: a limit */
    LIE_VERSION,  /* of another version */
    LIE_NAME,     /* a name that is taken */
    LIE_WIDTH,    /* three children */
    LIE_AGAIN,    /* pack() asks for arrays a second time, and gets none */
    LIE_CRASH,    /* pack() writes where nothing is */
    LIE_HANG,     /* pack() does not end */
    LIE_ABORT,    /* load() aborts */
    LIE_EXIT,     /* pack() ends the process */
    LIE_MEMORY,   /* pack() takes what it can get */
    LIE_START,    /* dies when it is opened */
    LIE_FEWER,    /* pack() says one record less than it was given */
    LIE_ITEMS,    /* one item more */
    LIE_WORDS,    /* that its records are elsewhere */
    LIE_PLACES,   /* that its items are elsewhere */
    LIES
};

#ifndef LIE
#error "-DLIE=LIE_..."
#endif

static volatile int *volatile nowhere;

static uint32_t *record(const struct raydiff_packed *packed, uint32_t i)
{
    return packed->word + (size_t)WORDS * i;
}

static void lie_of_bytes(struct raydiff_packed *packed)
{
    uint32_t last = packed->records - 1, *leaf = record(packed, last);
    float bound;
    memcpy(&bound, leaf + 3, sizeof bound);
    if (LIE == LIE_ULP)
        bound = nextafterf(bound, -INFINITY);
    if (LIE == LIE_NAN)
        bound = NAN;
    memcpy(leaf + 3, &bound, sizeof bound);
    if (LIE == LIE_CHILD)
        record(packed, 0)[6] = packed->records + 5;
    if (LIE == LIE_CYCLE)
        record(packed, 0)[6] = 0;
    if (LIE == LIE_LOST)
        leaf[7]--;
    if (LIE == LIE_TWICE)
        packed->item[0] = packed->item[packed->items - 1];
    if (LIE == LIE_TRIANGLE)
        packed->item[0] = 1u << 30;
    if (LIE == LIE_ROOT)
        packed->root = packed->records;
    packed->records -= LIE == LIE_FEWER;
    packed->items += LIE == LIE_ITEMS;
    packed->word += LIE == LIE_WORDS;
    packed->item += LIE == LIE_PLACES;
    if (LIE == LIE_SIZE)
        packed->records *= 4;
}

static int lie_pack(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                    struct raydiff_out *out)
{
    if (LIE == LIE_NOTHING)
        return RAYDIFF_OK;
    if (LIE == LIE_CODE)
        return 99;
    if (LIE == LIE_CRASH)
        *nowhere = 1;
    if (LIE == LIE_EXIT)
        exit(0);
    while (LIE == LIE_HANG)
        nowhere = NULL;
    for (size_t taken = 0; LIE == LIE_MEMORY && taken < (size_t)1 << 40; taken += 1u << 24)
        memset(malloc(1u << 24), 1, 1u << 24); /* and crashes where there is none */
    if (LIE == LIE_LIMIT) {
        snprintf(out->reason, out->reason_bytes, "at most 3 nodes, this tree has %u",
                 tree->node_count);
        return RAYDIFF_LIMIT;
    }
    int code = pack(tree, scene, out);
    if (code == RAYDIFF_OK && LIE == LIE_AGAIN)
        (void)out->alloc(out, 3, 2);
    if (code == RAYDIFF_OK)
        lie_of_bytes(&out->packed);
    return code;
}

static void lie_load(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out)
{
    load(packed, ref, out);
    if (LIE == LIE_ABORT && ref > 0)
        abort();
    if (LIE == LIE_CHILDREN && ref == 1)
        out->child_count = 9;
    if (LIE == LIE_ONE && ref == 0)
        out->child_count = 1;
    if (LIE == LIE_LEAF && ref + 1 == packed->records)
        out->item_count = 0;
}

const struct raydiff_plugin *raydiff_plugin(void)
{
    static struct raydiff_plugin plugin;
    if (LIE == LIE_START)
        abort();
    plugin = *honest_plugin();
    plugin.name = LIE == LIE_NAME ? "f32" : "liar";
    plugin.version += LIE == LIE_VERSION;
    plugin.width += LIE == LIE_WIDTH;
    plugin.pack = lie_pack;
    plugin.load = lie_load;
    return &plugin;
}
