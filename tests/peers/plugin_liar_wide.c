/* The layout of fuzz/samples/layout/mine4.c with a lie, number LIE; see
 * tests/peers/plugin_liar.c. */
#include "ref/plugin.h"

const struct raydiff_plugin *honest_plugin(void);
#define raydiff_plugin(none) honest_plugin(none)
#include "fuzz/samples/layout/mine4.c"
#undef raydiff_plugin

#include <math.h>

enum lie {
    LIE_HONEST,
    LIE_HOLE,     /* no lie: the children are in the last slots, in reverse order */
    LIE_ULP,      /* the root's last child is one float short */
    LIE_LEAF_ULP, /* and the last leaf */
    LIE_CHILD,    /* a child is out of range */
    LIE_SLOT,     /* a child is a slot of another record */
    LIE_RECORD,   /* load() says that a record is a leaf */
    LIE_INNER,    /* load() says that a leaf has children */
    LIE_EMPTY,    /* a record has no child */
    LIE_CHILDREN, /* load() says five children */
    LIES
};

#ifndef LIE
#error "-DLIE=LIE_..."
#endif

static uint32_t *slot_words(const struct raydiff_packed *packed, uint32_t record, uint32_t slot)
{
    return packed->word + (size_t)WORDS * record + (size_t)SLOT_WORDS * slot;
}

static void one_float_short(uint32_t *slot)
{
    float bound;
    memcpy(&bound, slot + 3, sizeof bound);
    bound = nextafterf(bound, -INFINITY);
    memcpy(slot + 3, &bound, sizeof bound);
}

static void reverse(uint32_t *record)
{
    for (uint32_t slot = 0; slot < WIDTH / 2; slot++) {
        uint32_t *a = record + (size_t)SLOT_WORDS * slot;
        uint32_t *b = record + (size_t)SLOT_WORDS * (WIDTH - 1 - slot), was[SLOT_WORDS];
        memcpy(was, a, sizeof was);
        memcpy(a, b, sizeof was);
        memcpy(b, was, sizeof was);
    }
}

static int lie_pack(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                    struct raydiff_out *out)
{
    int code = pack(tree, scene, out);
    const struct raydiff_packed *packed = &out->packed;
    if (code != RAYDIFF_OK)
        return code;
    for (uint32_t i = 0; LIE == LIE_HOLE && i < packed->records; i++)
        reverse(slot_words(packed, i, 0));
    uint32_t *root = slot_words(packed, 0, 0), *last = slot_words(packed, packed->records - 1, 0);
    if (LIE == LIE_ULP)
        one_float_short(root + (size_t)SLOT_WORDS * (WIDTH - 1));
    if (LIE == LIE_LEAF_ULP)
        one_float_short(last + SLOT_WORDS);
    if (LIE == LIE_CHILD)
        root[6] = 5 * packed->records;
    if (LIE == LIE_SLOT)
        root[6] = packed->records + WIDTH + 1;
    if (LIE == LIE_EMPTY)
        memset(last, 0, sizeof *last * WORDS);
    return code;
}

static void lie_load(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out)
{
    load(packed, ref, out);
    if (LIE == LIE_RECORD && ref + 1 == packed->records) {
        out->child_count = 0;
        out->item_count = 1;
    }
    if (LIE == LIE_INNER && ref == 5 * packed->records - WIDTH) {
        out->child_count = 1;
        out->child[0] = ref + 1;
    }
    if (LIE == LIE_CHILDREN && ref == 0)
        out->child_count = WIDTH + 1;
}

const struct raydiff_plugin *raydiff_plugin(void)
{
    static struct raydiff_plugin plugin;
    plugin = *honest_plugin();
    plugin.name = "liar4";
    plugin.pack = lie_pack;
    plugin.load = lie_load;
    return &plugin;
}
