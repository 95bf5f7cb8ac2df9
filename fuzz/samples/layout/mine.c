/* Layout mine: 32-byte nodes. Words 0-2 the lower bounds, 3-5 the upper ones, as they are. Word 6
 * is the second child (the first follows its parent), or a leaf's first item; word 7 the items. */
#include "ref/plugin.h"

#include <string.h>

#define WORDS 8u

static int pack(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                struct raydiff_out *out)
{
    (void)scene; /* raydiff gathers the triangles: a layout writes nodes and which triangles */
    if (!out->alloc(out, tree->node_count, tree->prim_count))
        return RAYDIFF_MEMORY;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const struct raydiff_node *from = &tree->node[i];
        uint32_t *word = out->packed.word + (size_t)WORDS * i;
        memcpy(word, from->bounds.lo, 12);
        memcpy(word + 3, from->bounds.hi, 12);
        word[6] = from->item_count ? from->item_first : from->snd;
        word[7] = from->item_count;
    }
    memcpy(out->packed.item, tree->prim, sizeof *tree->prim * tree->prim_count);
    return RAYDIFF_OK;
}

static struct raydiff_box box(const struct raydiff_packed *packed, uint32_t ref)
{
    struct raydiff_box box;
    memcpy(&box, packed->word + (size_t)WORDS * ref, sizeof box);
    return box;
}

static void load(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out)
{
    const uint32_t *word = packed->word + (size_t)WORDS * ref;
    if (word[7] > 0) {
        out->item_first = word[6];
        out->item_count = word[7];
        return;
    }
    out->child_count = 2;
    out->child[0] = ref + 1;
    out->child[1] = word[6];
    for (int i = 0; i < 2; i++)
        if (out->child[i] < packed->records) /* else raydiff names the record and refuses it */
            out->box[i] = box(packed, out->child[i]);
}

const struct raydiff_plugin *raydiff_plugin(void)
{
    static const struct raydiff_plugin plugin = {
        .version = RAYDIFF_PLUGIN_VERSION,
        .bytes = sizeof plugin,
        .name = "mine",
        .summary = "32-byte nodes, bounds and indices as they are",
        .node_bytes = 4 * WORDS,
        .width = 2,
        .pack = pack,
        .load = load,
        .box = box,
    };
    return &plugin;
}
