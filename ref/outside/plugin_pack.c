/* Packing by a plugin, and the check of its result. */
#include "ref/outside/plugin_layout.h"

#include "ref/packed/packed_walk.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(struct raydiff_node) == sizeof(struct bvh_node) &&
                   offsetof(struct raydiff_node, fst) == offsetof(struct bvh_node, fst) &&
                   offsetof(struct raydiff_node, snd) == offsetof(struct bvh_node, snd) &&
                   offsetof(struct raydiff_node, item_first) ==
                       offsetof(struct bvh_node, item_first) &&
                   offsetof(struct raydiff_node, item_count) ==
                       offsetof(struct bvh_node, item_count),
               "a plugin sees our nodes as they are");

/* What a plugin fills, and a copy of what it was given. */
struct pack_packing {
    struct raydiff_out out; /* first: a plugin passes its address to give() */
    struct raydiff_packed given;
    uint32_t node_words;
    bool asked, no_memory;
    char reason[200];
};

static bool give(struct raydiff_out *out, uint32_t records, uint32_t items)
{
    struct pack_packing *p = (struct pack_packing *)out;
    uint64_t words = (uint64_t)records * p->node_words;
    if (p->asked)
        return false;
    p->asked = true;
    p->no_memory = true;
    if (records == 0 || words > UINT32_MAX)
        return false;
    p->given.word = alloc_zeroed((size_t)words, sizeof *p->given.word);
    p->given.item = items ? alloc_zeroed(items, sizeof *p->given.item) : NULL;
    if (!p->given.word || (items && !p->given.item)) {
        free(p->given.word);
        free(p->given.item);
        p->given = (struct raydiff_packed){0};
        return false;
    }
    p->no_memory = false;
    p->given.records = records;
    p->given.items = items;
    out->packed = p->given;
    return true;
}

/* Checks that the plugin has not replaced the arrays and counts that it was given. */
static enum status check_given(const char *name, const struct pack_packing *p,
                               struct reason *reason)
{
    const struct raydiff_packed *has = &p->out.packed, *given = &p->given;
    if (!given->word)
        return fail(reason, STATUS_INPUT, "%s: pack() asked for no records", name);
    if (has->word != given->word || has->item != given->item || has->records != given->records ||
        has->items != given->items)
        return fail(reason, STATUS_INPUT,
                    "%s: pack() was given %u records and %u items, and returned %u and %u%s", name,
                    given->records, given->items, has->records, has->items,
                    has->word != given->word || has->item != given->item ? " in other arrays" : "");
    return STATUS_OK;
}

/* Calls the plugin. The caller frees *out, also on error. */
static enum status call(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out, struct reason *reason)
{
    const struct raydiff_plugin *plugin = layout->family;
    const struct raydiff_tree tree = {.node = (const struct raydiff_node *)(const void *)bvh->node,
                                      .prim = bvh->prim,
                                      .node_count = bvh->node_count,
                                      .prim_count = bvh->prim_count};
    const struct raydiff_scene theirs = {.vertex = scene->vertex,
                                         .index = scene->index,
                                         .vertex_count = scene->vertex_count,
                                         .tri_count = scene->tri_count};
    struct pack_packing p = {.node_words = plugin->node_bytes / 4};
    p.out.alloc = give;
    p.out.reason = p.reason;
    p.out.reason_bytes = sizeof p.reason;
    int answer = plugin->pack(&tree, &theirs, &p.out);
    p.reason[sizeof p.reason - 1] = '\0';
    enum status status;
    if (answer == RAYDIFF_LIMIT)
        status = fail(reason, STATUS_LIMIT, "%s: %s", layout->name, p.reason);
    else if (answer == RAYDIFF_MEMORY || p.no_memory)
        status = fail(reason, STATUS_MEMORY, "%s: no memory to pack %u nodes", layout->name,
                      bvh->node_count);
    else if (answer != RAYDIFF_OK)
        status = fail(reason, STATUS_INPUT, "%s: pack() returned %d", layout->name, answer);
    else
        status = check_given(layout->name, &p, reason);
    uint64_t refs = p.given.records * (uint64_t)(plugin->width > 2 ? 1 + plugin->width : 1);
    if (!status && refs > UINT32_MAX)
        status = fail(reason, STATUS_LIMIT, "%s: %u records have over 2^32 references",
                      layout->name, p.given.records);
    *out = (struct packed){.layout = layout,
                           .store = out->store,
                           .word = p.given.word,
                           .item = p.given.item,
                           .word_count = p.given.records * p.node_words,
                           .item_count = p.given.items,
                           .node_count = p.given.records,
                           .ref_count = (uint32_t)refs,
                           .root = p.out.packed.root,
                           .tri_count = scene->tri_count,
                           .split = bvh_is_split(bvh)};
    return status;
}

/* --- the check ------------------------------------------------------------------------------- */

/* Checks a reachable node, as the plugin's load() returns it. */
static enum status check_node(const struct packed *packed, uint32_t ref, enum packed_rule *rule,
                              struct reason *reason)
{
    const struct layout *layout = packed->layout;
    const struct raydiff_plugin *plugin = layout->family;
    const bool wide = plugin->width > 2;
    const struct raydiff_packed view = plugin_view(packed);
    struct raydiff_wide node;
    *rule = PACKED_RECORD;
    node.child_count = node.item_first = node.item_count = 0;
    plugin->load(&view, ref, &node);
    if (node.child_count > plugin->width)
        return fail(reason, STATUS_INPUT, "%s: %s: %u children, %u at most", layout->name,
                    packed_name(packed, ref).text, node.child_count, plugin->width);
    if (node.child_count == 1 && !wide)
        return fail(reason, STATUS_INPUT, "%s: %s: one child, not two", layout->name,
                    packed_name(packed, ref).text);
    if (node.child_count == 0 && node.item_count == 0)
        return fail(reason, STATUS_INPUT, "%s: %s: a leaf without items", layout->name,
                    packed_name(packed, ref).text);
    if (wide && (node.child_count == 0) != (ref >= packed->node_count))
        return fail(reason, STATUS_INPUT, "%s: %s: %s", layout->name, packed_name(packed, ref).text,
                    node.child_count ? "a child slot has children" : "a leaf, not a child slot");
    *rule = PACKED_REFERENCE;
    for (uint32_t i = 0; i < node.child_count; i++) {
        uint32_t child = node.child[i];
        if (child >= packed->ref_count)
            return fail(reason, STATUS_INPUT, "%s: %s: child %u is reference %u of %u",
                        layout->name, packed_name(packed, ref).text, i, child, packed->ref_count);
        if (wide && child >= packed->node_count &&
            (child - packed->node_count) / plugin->width != ref)
            return fail(reason, STATUS_INPUT, "%s: %s: child %u is %s", layout->name,
                        packed_name(packed, ref).text, i, packed_name(packed, child).text);
    }
    (void)layout->box(packed, ref); /* called here so that a crash happens in the child */
    return STATUS_OK;
}

static enum status check_nodes(struct packed *packed, enum packed_rule *rule, struct reason *reason)
{
    struct packed_walk walk;
    *rule = PACKED_REFERENCE;
    if (packed->root >= packed->node_count)
        return fail(reason, STATUS_INPUT, "%s: the root is record %u of %u", packed->layout->name,
                    packed->root, packed->node_count);
    enum status status = packed_walk_make(packed, &walk);
    if (status)
        return fail(reason, status, "%s: no memory to check %u records", packed->layout->name,
                    packed->node_count);
    packed->stack_need = walk.stack_most;
    for (uint32_t i = 0; i < walk.visit_count && !status; i++)
        status = check_node(packed, walk.visit[i].ref, rule, reason);
    packed_walk_free(&walk);
    return status;
}

/* Returns true if only boxes are at fault, and the tree's own boxes were, too. */
static bool is_excused(const struct bvh *bvh, const struct scene *scene,
                       const struct packed_faults *faults)
{
    struct reason unused;
    struct packed_faults others = *faults;
    others.loose_boxes = 0;
    others.first = PACKED_SOUND;
    static const struct packed_faults none;
    return memcmp(&others, &none, sizeof none) == 0 && bvh_check(bvh, scene, &unused);
}

enum status plugin_pack(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out, enum packed_rule *rule,
                        struct reason *reason)
{
    enum status status = call(layout, bvh, scene, out, reason);
    *rule = PACKED_RESULT;
    if (!status)
        status = check_nodes(out, rule, reason);
    if (!status) {
        struct packed_faults faults;
        status = packed_check(out, scene, &faults, reason);
        *rule = faults.first;
        if (status == STATUS_INPUT && is_excused(bvh, scene, &faults))
            status = STATUS_OK;
    }
    if (status)
        packed_free(out);
    if (status != STATUS_INPUT)
        *rule = PACKED_SOUND;
    return status;
}
