#include "ref/layout.h"

#include "ref/packed/packed_walk.h"

#include "counts.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The longest path of a tree, in edges: a binary traversal pushes at most one entry per level. */
static enum status tree_depth(const struct bvh *bvh, uint32_t *out)
{
    *out = 0;
    uint32_t *depth = alloc_zeroed(bvh->node_count, sizeof *depth);
    if (!depth)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        if (depth[i] > *out)
            *out = depth[i];
        if (node->item_count == 0)
            depth[node->fst] = depth[node->snd] = depth[i] + 1;
    }
    free(depth);
    return STATUS_OK;
}

/* A faithful layout can wrap references, so that the decoded tree is deeper than the original; a
 * wide one is less deep. If the decoded words are no tree, no stack is large enough. */
static enum status decoded_depth(const struct packed *packed, uint32_t *out)
{
    struct packed_walk walk;
    enum status status = packed_walk_make(packed, &walk);
    *out = walk.stack_most;
    if (packed->layout->faithful && (walk.repeats > 0 || walk.stack_most > ABI_STACK_MAX))
        *out = ABI_STACK_MAX;
    packed_walk_free(&walk);
    return status;
}

/* `bvh` may be NULL for a wide layout. */
static enum status find_stack_need(const struct bvh *bvh, struct packed *packed,
                                   struct reason *reason)
{
    const char *name = packed->layout->name;
    uint32_t depth = 0;
    uint32_t most = layout_stack_most(packed->layout);
    bool wide = layout_is_wide(packed->layout) || packed->layout->outside;
    enum status status = wide ? decoded_depth(packed, &depth) : tree_depth(bvh, &depth);
    if (!status && depth > most)
        return fail(reason, STATUS_LIMIT,
                    "%s: the traversal stack holds %u entries, this tree %s %u%s; use builder "
                    "median or a larger --leaf",
                    name, most, wide ? "needs" : "is", depth, wide ? "" : " deep");
    if (!status && packed->layout->faithful)
        status = decoded_depth(packed, &depth);
    if (status)
        return fail(reason, status, "%s: no memory to measure the tree's depth", name);
    packed->stack_need = depth;
    return STATUS_OK;
}

/* store_put grows the array by doubling; this frees the unused part. */
static void give_back_room(struct packed *packed)
{
    uint32_t *item = packed->item_room > packed->item_count && packed->item_count
                         ? realloc(packed->item, packed->item_count * sizeof *item)
                         : NULL;
    if (item)
        packed->item = item;
    packed->item_room = 0;
}

/* After a layout's pack() or pack_tree(): returns its status, or that of what is still to do. */
static enum status finish(const struct layout *layout, const struct tri_store *store,
                          const struct bvh *bvh, enum status status, struct packed *out,
                          struct reason *reason)
{
    if (!status) {
        give_back_room(out);
        out->layout = layout;
        out->store = store;
        status = find_stack_need(bvh, out, reason);
    }
    if (status)
        packed_free(out);
    return status;
}

enum status packed_make(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out, struct reason *reason)
{
    return packed_make_stored(layout, tri_stores[0], bvh, scene, out, reason);
}

enum status packed_make_stored(const struct layout *layout, const struct tri_store *store,
                               const struct bvh *bvh, const struct scene *scene, struct packed *out,
                               struct reason *reason)
{
    *out = (struct packed){.store = store};
    if (bvh->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "%s: the tree holds %u triangles, the scene has %u",
                    layout->name, bvh->tri_count, scene->tri_count);
    if (layout->item && store != tri_stores[0])
        return fail(reason, STATUS_LIMIT,
                    "%s: keeps its items its own way, storage %s is not for it", layout->name,
                    store->name);
    if (bvh->node_count > 0) {
        enum status status = layout->pack(layout, bvh, scene, out, reason);
        status = finish(layout, store, bvh, status, out, reason);
        if (status)
            return status;
    }
    out->layout = layout;
    out->tri_count = scene->tri_count;
    out->split = bvh_is_split(bvh);
    return STATUS_OK;
}

enum status packed_make_tree(const struct layout *layout, struct wide_tree *tree,
                             const uint32_t *item, uint32_t item_count, const struct scene *scene,
                             struct packed *out, struct reason *reason)
{
    *out = (struct packed){.store = tri_stores[0]};
    if (item_count > 0) {
        enum status status = layout->pack_tree(layout, tree, item, item_count, scene, out, reason);
        status = finish(layout, tri_stores[0], NULL, status, out, reason);
        if (status)
            return status;
    }
    out->layout = layout;
    out->tri_count = scene->tri_count;
    return STATUS_OK;
}

/* Appends `line` to the newline-separated `text` as far as it fits. */
static void append_line(char *text, size_t text_bytes, const char *line)
{
    size_t used = text_bytes > 0 ? strlen(text) : 0;
    if (used + 1 < text_bytes)
        snprintf(text + used, text_bytes - used, "%s%s", used > 0 ? "\n" : "", line);
}

enum status packed_make_auto(const struct bvh *bvh, const struct scene *scene, struct packed *out,
                             char *refused, size_t refused_bytes, struct reason *reason)
{
    struct reason why = {"no layout can be chosen"};
    *out = (struct packed){0};
    if (refused_bytes > 0)
        refused[0] = 0;
    for (size_t i = 0; layouts_auto[i]; i++) {
        enum status status = packed_make(layouts_auto[i], bvh, scene, out, &why);
        if (!status)
            return STATUS_OK;
        if (status != STATUS_LIMIT)
            return fail(reason, status, "%s", why.text);
        append_line(refused, refused_bytes, why.text);
    }
    return fail(reason, STATUS_LIMIT, "no layout can hold this scene: %s", why.text);
}

void packed_free(struct packed *packed)
{
    free(packed->word);
    free(packed->item);
    *packed = (struct packed){0};
}
