#include "bench/frames/paper.h"

#include "ref/layout.h"

const struct paper_figure paper_figures[PAPER_FIGURES] = {
    [PAPER_DEFAULT] = {"default", 40, 24, 680, 2448, 656, 6.168, 5.069},
    [PAPER_TEAPOT] = {"teapot", 6320, 3241, 101160, 381840, 110528, 258.567, 214.569},
};

uint64_t paper_geometry(uint32_t tri_count)
{
    return 16 * (uint64_t)tri_count + 40;
}

uint64_t paper_uploaded(uint32_t tri_count, uint32_t vertex_count)
{
    return 16 * ((uint64_t)tri_count + 1) + 32 * (uint64_t)vertex_count;
}

/* Bytes of the nodes in a layout, and of its item array; 0 if it cannot hold the tree. */
static enum status packed_bytes(const char *name, const struct bvh *bvh, const struct scene *scene,
                                uint64_t *nodes, uint64_t *items, struct reason *reason)
{
    struct packed packed;
    enum status status = packed_make(layout_find(name), bvh, scene, &packed, reason);
    *nodes = *items = 0;
    if (status == STATUS_LIMIT)
        return STATUS_OK;
    if (status)
        return status;
    *nodes = packed_node_bytes(&packed);
    *items = packed_item_bytes(&packed);
    packed_free(&packed);
    return STATUS_OK;
}

enum status paper_tree(const struct scene *scene, uint32_t leaf, struct paper_tree *out,
                       struct reason *reason)
{
    struct build_options options = {.leaf = leaf, .eps = PAPER_EPS};
    struct bvh bvh;
    uint64_t none;
    *out = (struct paper_tree){.leaf = leaf};
    enum status status = builder_find("rtrs")->build(scene, &options, &bvh, reason);
    if (status)
        return status;
    status = bvh_count(&bvh, scene, &out->stats, reason);
    if (!status)
        status = packed_bytes("rtrs_direct", &bvh, scene, &out->direct, &none, reason);
    if (!status)
        status = packed_bytes("f32", &bvh, scene, &out->plain, &out->items, reason);
    if (!status)
        status = packed_bytes("rtrs_rf", &bvh, scene, &out->rf, &none, reason);
    bvh_free(&bvh);
    return status;
}

bool paper_agrees(const struct paper_figure *figure, uint64_t geometry,
                  const struct paper_tree *direct, const struct paper_tree *rf)
{
    return geometry == figure->geometry && direct->direct == figure->direct && rf->rf == figure->rf;
}
