#include "ref/packed/tree_file.h"

#include "ref/tree/bvh_json.h"
#include "ref/packed/packed_file.h"
#include "ref/packed/packed_unpack.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status build_nothing(const struct scene *scene, const struct build_options *options,
                                 struct bvh *out, struct reason *reason)
{
    (void)scene, (void)options;
    *out = (struct bvh){0};
    return fail(reason, STATUS_INTERNAL, "builder file: its tree is read, not built");
}

const struct builder tree_file_builder = {
    .name = "file", .summary = "a tree that was read from a file", .build = build_nothing};

/* How far rounding may move a centre out of the box of its leaf, relative to the largest
 * coordinate: for RTRS's float32 arithmetic, and for bounds in float16 rounded to nearest, which
 * also lose up to 2^-25 below their range. */
#define SLACK_FLOAT 0x1p-20
#define SLACK_HALF  0x1p-10
#define SLACK_LEAST 0x1p-24

/* Checks that the leaves' boxes are where their triangles are. */
struct fit {
    const struct scene *scene;
    double slack;
    bool split;             /* some part of the triangle must be inside; else its centre */
    const char *part;       /* owner of the boxes compared, for the reason */
    uint64_t items, astray; /* number checked; number outside */
};

static bool is_inside(const struct fit *fit, uint32_t prim, const struct box *box)
{
    float v[3][3];
    scene_tri(fit->scene, prim, v);
    for (int k = 0; k < 3; k++) {
        double centre = ((double)v[0][k] + (double)v[1][k] + (double)v[2][k]) / 3;
        double least = centre, most = centre, lo = (double)box->lo[k], hi = (double)box->hi[k];
        for (int c = 0; c < 3 && fit->split; c++) {
            least = fmin(least, (double)v[c][k]);
            most = fmax(most, (double)v[c][k]);
        }
        double slack = fit->slack * fmax(fabs(lo), fabs(hi)) + SLACK_LEAST;
        /* An infinite bound is a coordinate outside the layout's range, on either side. */
        if ((isfinite(lo) && most < lo - slack) || (isfinite(hi) && least > hi + slack))
            return false;
    }
    return true;
}

static void fit_item(struct fit *fit, uint32_t prim, const struct box *box)
{
    fit->items++;
    fit->astray += !is_inside(fit, prim, box);
}

static enum status check_fit(const char *name, const struct fit *fit, struct reason *reason)
{
    if (2 * fit->astray <= fit->items)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT,
                "%s: is the tree of another scene: %llu of %llu triangles have their centre "
                "outside the box of %s",
                name, (unsigned long long)fit->astray, (unsigned long long)fit->items, fit->part);
}

static enum status read_json(const char *bytes, size_t size, const struct scene *scene,
                             struct tree_file *file, struct reason *reason)
{
    enum status status = bvh_json_read(file->name, bytes, size, scene, &file->bvh, reason);
    if (status)
        return status;
    bool split = bvh_is_split(&file->bvh);
    struct fit fit = {.scene = scene, .slack = SLACK_FLOAT, .split = split, .part = "their leaf"};
    status = bvh_count(&file->bvh, scene, &file->stats, reason);
    if (status)
        return status;
    uint64_t small = file->stats.loose_count;
    for (uint32_t i = 0; i < file->bvh.node_count; i++) {
        const struct bvh_node *node = &file->bvh.node[i];
        bool loose = false;
        for (uint32_t k = 0; k < node->item_count; k++) {
            uint32_t prim = file->bvh.prim[node->item_first + k];
            struct box exact = scene_tri_bounds(scene, prim);
            loose |= !split && !box_contains_box(&node->bounds, &exact);
            fit_item(&fit, prim, &node->bounds);
        }
        small += loose;
    }
    status = check_fit(file->name, &fit, reason);
    struct reason first;
    if (!status && bvh_check(&file->bvh, scene, &first))
        (void)fail(&file->doubt, STATUS_OK, "%s: %llu of %u %s; the first: %s", file->name,
                   (unsigned long long)small, split ? scene->tri_count : file->bvh.node_count,
                   split ? "triangles have parts in no leaf's box"
                         : "boxes are too small for their triangles",
                   first.text);
    return status;
}

/* Counts the decoded nodes, and checks the positions of the leaves' triangles. */
static enum status measure_packed(struct tree_file *file, struct fit *fit, struct reason *reason)
{
    const struct packed *packed = &file->packed;
    struct packed_walk walk;
    enum status status = packed_walk_make(packed, &walk);
    uint32_t *depth = alloc_zeroed(walk.visit_count, sizeof *depth);
    if (status || !depth) {
        packed_walk_free(&walk);
        free(depth);
        return fail(reason, STATUS_MEMORY, "%s: no memory for %u records", file->name,
                    packed->node_count);
    }
    file->stats.node_count = walk.visit_count;
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        uint32_t items = 0;
        depth[i] = i > 0 ? depth[walk.visit[i].parent] + 1 : 0;
        file->stats.depth = depth[i] > file->stats.depth ? depth[i] : file->stats.depth;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        if (node.child_count > 0)
            continue;
        for (uint32_t s = 0; s < node.item_count; s++) {
            uint32_t prim = packed_item(packed, &node, s);
            if (prim == ABI_NO_PRIM)
                continue;
            items++;
            fit_item(fit, prim, &walk.visit[i].box);
        }
        file->stats.leaf_count++;
        if (items > file->stats.largest_leaf)
            file->stats.largest_leaf = items;
    }
    packed_walk_free(&walk);
    free(depth);
    return STATUS_OK;
}

/* In RTRS's layouts leaves name triangles of other leaves (F2, F3), so only the root's box is
 * checked. */
static void fit_root(struct fit *fit, const struct packed *packed)
{
    struct box box = packed->layout->box(packed, packed->root);
    fit->items = fit->astray = 0;
    fit->part = "the root";
    for (uint32_t prim = 0; prim < fit->scene->tri_count; prim++)
        fit_item(fit, prim, &box);
}

static enum status read_packed(const char *bytes, size_t size, const struct scene *scene,
                               struct tree_file *file, struct reason *reason)
{
    struct packed_faults faults;
    struct reason first = {""};
    enum status status =
        packed_file_read(file->name, bytes, size, scene, &file->packed, &faults, &first);
    if (status)
        return fail(reason, status, "%s", first.text);
    struct fit fit = {
        .scene = scene, .slack = SLACK_HALF, .split = file->packed.split, .part = "their leaf"};
    status = measure_packed(file, &fit, reason);
    if (file->packed.layout->faithful && file->packed.node_count > 0)
        fit_root(&fit, &file->packed);
    file->stats.loose_count = faults.loose_boxes;
    if (!status)
        status = check_fit(file->name, &fit, reason);
    if (!status && first.text[0])
        (void)fail(&file->doubt, STATUS_OK,
                   "%s: %u boxes are too small, %u triangles in no leaf, %u in several; the "
                   "first: %s",
                   file->name, faults.loose_boxes, faults.lost_prims, faults.double_prims,
                   first.text + strlen(file->name) + 2);
    return status;
}

enum status tree_file_read(const char *name, const char *bytes, size_t size,
                           const struct scene *scene, struct tree_file *out, struct reason *reason)
{
    *out = (struct tree_file){.name = name};
    enum status status = packed_file_is(bytes, size) ? read_packed(bytes, size, scene, out, reason)
                                                     : read_json(bytes, size, scene, out, reason);
    if (status)
        tree_file_free(out);
    return status;
}

void tree_file_free(struct tree_file *file)
{
    bvh_free(&file->bvh);
    packed_free(&file->packed);
    *file = (struct tree_file){0};
}

enum status tree_file_pack(const struct tree_file *file, const struct layout *layout,
                           const struct scene *scene, struct packed *out, struct reason *reason)
{
    const struct packed *from = &file->packed;
    if (!tree_file_is_packed(file))
        return packed_make(layout, &file->bvh, scene, out, reason);
    *out = (struct packed){0};
    if (from->layout != layout)
        return fail(reason, STATUS_INPUT, "%s: is packed as %s; only JSON can be packed as %s",
                    file->name, from->layout->name, layout->name);
    *out = *from;
    out->word = alloc_copy(from->word, from->word_count, sizeof *from->word);
    out->item = alloc_copy(from->item, from->item_count, sizeof *from->item);
    if ((!from->word || out->word) && (!from->item || out->item))
        return STATUS_OK;
    packed_free(out);
    return fail(reason, STATUS_MEMORY, "%s: no memory for %u records", file->name,
                from->node_count);
}

enum status tree_file_bvh(const struct tree_file *file, const struct scene *scene, struct bvh *out,
                          struct reason *reason)
{
    struct reason why = {""};
    if (tree_file_is_packed(file)) {
        enum status status = packed_unpack(&file->packed, scene, out, &why);
        return status ? fail(reason, status, "%s: cannot be decoded to a tree for JSON: %s",
                             file->name, why.text)
                      : STATUS_OK;
    }
    *out = file->bvh;
    out->node = alloc_copy(file->bvh.node, out->node_count, sizeof *out->node);
    out->prim = alloc_copy(file->bvh.prim, out->prim_count, sizeof *out->prim);
    if (out->node && out->prim)
        return STATUS_OK;
    bvh_free(out);
    return fail(reason, STATUS_MEMORY, "%s: no memory to copy %u nodes", file->name,
                file->bvh.node_count);
}
