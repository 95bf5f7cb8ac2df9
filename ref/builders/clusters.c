#include "ref/builders/clusters.h"

#include "ref/build/grow.h"
#include "ref/build/links.h"
#include "ref/build/morton.h"
#include "ref/build/presplit.h"
#include "ref/build/room.h"

uint32_t clusters_join(struct clusters *c, uint32_t a, uint32_t b)
{
    uint32_t node = c->nodes++;
    c->child[node][0] = a;
    c->child[node][1] = b;
    c->leaves[node] = c->leaves[a] + c->leaves[b];
    return node;
}

static void start(struct clusters *c, const uint64_t *key, uint32_t index_bits)
{
    struct lane_box all = lane_box_empty();
    for (uint32_t i = 0; i < c->count; i++)
        lane_box_add(&all, &c->ref[i].box);
    lanes unit = lanes_all(lanes_scale(&all));
    uint64_t mask = ((uint64_t)1 << index_bits) - 1;
    for (uint32_t i = 0; i < c->count; i++) {
        uint32_t prim = (uint32_t)(key[i] & mask);
        c->cluster[i] = prim;
        c->box[i].lo = c->ref[prim].box.lo * unit;
        c->box[i].hi = c->ref[prim].box.hi * unit;
        c->child[i][0] = c->child[i][1] = LINKS_NONE;
        c->leaves[i] = 1;
    }
    c->nodes = c->count;
}

static struct lane_box leaf(const void *user, uint32_t node, uint32_t *prim, uint32_t *items)
{
    const struct ref *ref = (const struct ref *)user + node;
    *prim = ref_prim(ref);
    *items = 1;
    return ref->box;
}

static enum status cluster(const struct cluster_rule *rule, struct clusters *c, const uint64_t *key,
                           uint32_t index_bits, struct bvh *out)
{
    uint32_t count = c->count;
    c->child = room_make(2 * (size_t)count, sizeof *c->child);
    c->leaves = room_make(2 * (size_t)count, sizeof *c->leaves);
    c->cluster = room_make(count, sizeof *c->cluster);
    c->box = room_make(count, sizeof *c->box);
    c->chosen = room_make(rule->chooses ? count : 0, sizeof *c->chosen);
    enum status status = STATUS_MEMORY;
    if (c->child && c->leaves && c->cluster && c->box && c->chosen) {
        start(c, key, index_bits);
        while (c->count > 1)
            rule->round(c);
        struct links links = {.child = c->child,
                              .leaves = c->leaves,
                              .root = c->cluster[0],
                              .leaf = leaf,
                              .user = c->ref,
                              .items = count,
                              .tris = count};
        status = links_write(&links, out);
    }
    room_free(c->child);
    room_free(c->leaves);
    room_free(c->cluster);
    room_free(c->box);
    room_free(c->chosen);
    return status;
}

enum status clusters_build(const struct cluster_rule *rule, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct build_traffic *traffic, struct reason *reason)
{
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (status || scene->tri_count == 0)
        return status;
    uint32_t threads = build_threads(options, scene->tri_count), index_bits = 0;
    uint32_t radius = options->radius ? options->radius : BUILD_RADIUS_DEFAULT;
    struct refs refs;
    uint64_t *key = NULL;
    status = refs_make(scene, options, threads, &refs, reason);
    if (status == STATUS_LIMIT)
        return status;
    if (!status)
        status = morton_order(refs.ref, refs.count, &refs.centres, threads, &key, &index_bits);
    struct clusters c = {.ref = refs.ref,
                         .count = refs.count,
                         .radius = radius < BUILD_RADIUS_MOST ? radius : BUILD_RADIUS_MOST,
                         .threads = threads};
    if (!status)
        status = cluster(rule, &c, key, index_bits, out);
    if (!status && options->presplit > 0)
        status = presplit_merge(out, scene->tri_count);
    if (!status)
        status = tree_collapse(out, options->leaf);
    if (traffic)
        *traffic = c.traffic;
    room_free(refs.ref);
    room_free(key);
    if (!status)
        return STATUS_OK;
    tree_drop(out);
    return fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
}
