#include "ref/packed/packed_unpack.h"
#include "ref/store.h"

#include <stdlib.h>

#define NO_PARENT UINT32_MAX

/* A record to be unpacked; its node becomes `snd` of `parent` if it is the second child. */
struct waiting {
    uint32_t ref, parent;
    struct box box;
};

/* A tree being made, and which record orders are still possible. */
struct unpacking {
    const struct packed *packed;
    struct bvh *tree;
    struct waiting *stack;
    uint32_t depth, prim_most;
    uint32_t next[2]; /* expected next record, if leaves have one or two records */
    bool fits[2];
};

static bool in_order(struct unpacking *u, uint32_t ref, bool leaf)
{
    for (uint32_t k = 0; k < 2; k++) {
        u->fits[k] &= ref == u->next[k];
        u->next[k] += leaf ? k + 1 : 1;
    }
    return u->fits[0] || u->fits[1];
}

/* Copies the items of a leaf; false if there are more than possible. */
static bool take_items(struct unpacking *u, const struct wide *wide, struct bvh_node *node)
{
    struct bvh *tree = u->tree;
    for (uint32_t s = 0; s < wide->item_count; s++) {
        uint32_t prim = packed_item(u->packed, wide, s);
        if (prim == ABI_NO_PRIM)
            continue;
        if (tree->prim_count == u->prim_most)
            return false;
        tree->prim[tree->prim_count++] = prim;
        node->item_count++;
    }
    return true;
}

static enum status take_record(struct unpacking *u, struct reason *reason)
{
    const char *name = u->packed->layout->name;
    struct waiting now = u->stack[--u->depth];
    uint32_t i = u->tree->node_count++;
    struct bvh_node *node = &u->tree->node[i];
    struct wide wide;
    u->packed->layout->load(u->packed, now.ref, &wide);
    *node = (struct bvh_node){.bounds = now.box, .item_first = u->tree->prim_count};
    if (now.parent != NO_PARENT && i != now.parent + 1)
        u->tree->node[now.parent].snd = i;
    if (!in_order(u, now.ref, wide.child_count == 0))
        return fail(reason, STATUS_INPUT, "%s: record %u: the records are not in pre-order", name,
                    now.ref);
    if (wide.child_count == 0)
        return take_items(u, &wide, node)
                   ? STATUS_OK
                   : fail(reason, STATUS_INPUT, "%s: record %u: triangles are in several leaves",
                          name, now.ref);
    if (wide.child_count != 2)
        return fail(reason, STATUS_INPUT, "%s: record %u has %u children, not 2", name, now.ref,
                    wide.child_count);
    node->fst = i + 1;
    u->stack[u->depth++] = (struct waiting){wide.child[1], i, wide.box[1]};
    u->stack[u->depth++] = (struct waiting){wide.child[0], i, wide.box[0]};
    return STATUS_OK;
}

enum status packed_unpack(const struct packed *packed, const struct scene *scene, struct bvh *out,
                          struct reason *reason)
{
    *out = (struct bvh){0};
    struct unpacking u = {.packed = packed,
                          .tree = out,
                          .prim_most = packed_prims_most(packed),
                          .fits = {true, true}};
    enum status status = STATUS_OK;
    /* Each record is reached at most once, and is on the stack at most once. */
    out->node = alloc_zeroed(packed->node_count, sizeof *out->node);
    out->prim = alloc_zeroed(u.prim_most, sizeof *out->prim);
    out->tri_count = packed->tri_count;
    u.stack = alloc_zeroed((size_t)packed->node_count + 1, sizeof *u.stack);
    if (!out->node || !out->prim || !u.stack)
        status = fail(reason, STATUS_MEMORY, "no memory to unpack %u records", packed->node_count);
    if (!status && packed->node_count > 0)
        u.stack[u.depth++] =
            (struct waiting){packed->root, NO_PARENT, packed->layout->box(packed, packed->root)};
    while (!status && u.depth > 0)
        status = take_record(&u, reason);
    free(u.stack);
    if (!status)
        status = bvh_check_form(out, scene, reason);
    if (status)
        bvh_free(out);
    return status;
}
