/* Layout mine4: nodes of up to four children, 128 bytes. Of each child 8 words, as a node of mine:
 * 0-2 the lower bounds, 3-5 the upper ones, as they are; word 6 is the child's record or, of a
 * leaf, its first item; word 7 the items. Leaves have no records. A slot whose words 6 and 7 are 0
 * is empty: no child is record 0, which is the root. */
#include "ref/plugin.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH      4u
#define SLOT_WORDS 8u
#define WORDS      (WIDTH * SLOT_WORDS)

/* The children of a record: those of the binary node `of`, and of its children that are no leaves
 * the children in their place. Of a tree of one leaf: that leaf. */
static uint32_t children(const struct raydiff_tree *tree, uint32_t of, uint32_t child[WIDTH])
{
    const struct raydiff_node *node = tree->node;
    uint32_t count = 0;
    if (node[of].item_count > 0) {
        child[count++] = of;
        return count;
    }
    const uint32_t pair[2] = {node[of].fst, node[of].snd};
    for (int i = 0; i < 2; i++) {
        if (node[pair[i]].item_count > 0) {
            child[count++] = pair[i];
        } else {
            child[count++] = node[pair[i]].fst;
            child[count++] = node[pair[i]].snd;
        }
    }
    return count;
}

static int pack(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                struct raydiff_out *out)
{
    (void)scene;
    /* The binary node that each record begins at: those of a record's children that are no leaves
     * come behind all that were there before it. */
    uint32_t child[WIDTH], records = 1, next = 1;
    uint32_t *begin = calloc(tree->node_count, sizeof *begin);
    if (!begin)
        return RAYDIFF_MEMORY;
    for (uint32_t i = 0; i < records; i++) {
        uint32_t count = children(tree, begin[i], child);
        for (uint32_t slot = 0; slot < count; slot++)
            if (tree->node[child[slot]].item_count == 0)
                begin[records++] = child[slot];
    }
    if (!out->alloc(out, records, tree->prim_count)) {
        free(begin);
        return RAYDIFF_MEMORY;
    }
    for (uint32_t i = 0; i < records; i++) {
        uint32_t count = children(tree, begin[i], child);
        for (uint32_t slot = 0; slot < count; slot++) {
            const struct raydiff_node *from = &tree->node[child[slot]];
            uint32_t *word = out->packed.word + (size_t)WORDS * i + (size_t)SLOT_WORDS * slot;
            memcpy(word, from->bounds.lo, 12);
            memcpy(word + 3, from->bounds.hi, 12);
            word[6] = from->item_count ? from->item_first : next++;
            word[7] = from->item_count;
        }
    }
    free(begin);
    memcpy(out->packed.item, tree->prim, sizeof *tree->prim * tree->prim_count);
    return RAYDIFF_OK;
}

static void load(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out)
{
    if (ref >= packed->records) { /* a leaf: child slot ref - records of all */
        const uint32_t *word = packed->word + (size_t)SLOT_WORDS * (ref - packed->records);
        out->item_first = word[6];
        out->item_count = word[7];
        return;
    }
    for (uint32_t slot = 0; slot < WIDTH; slot++) {
        const uint32_t *word = packed->word + (size_t)WORDS * ref + (size_t)SLOT_WORDS * slot;
        if (word[6] == 0 && word[7] == 0)
            continue;
        memcpy(&out->box[out->child_count], word, sizeof out->box[0]);
        out->child[out->child_count++] =
            word[7] > 0 ? packed->records + WIDTH * ref + slot : word[6];
    }
}

const struct raydiff_plugin *raydiff_plugin(void)
{
    static const struct raydiff_plugin plugin = {
        .version = RAYDIFF_PLUGIN_VERSION,
        .bytes = sizeof plugin,
        .name = "mine4",
        .summary = "128-byte nodes of 4 children, bounds and indices as they are",
        .node_bytes = 4 * WORDS,
        .width = WIDTH,
        .pack = pack,
        .load = load,
    };
    return &plugin;
}
