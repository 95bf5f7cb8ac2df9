/* Builds bottom-up (Meister and Bittner 2017, Parallel locally-ordered clustering). Along the order
 * of Morton codes every cluster searches `radius` places to both sides for the neighbour with the
 * smallest common box. Clusters that choose each other are merged, until one is left. Ours: among
 * equally near neighbours the one whose place differs in lower bits is chosen, so that many equal
 * triangles pair up. And if hardly any clusters chose each other (sizes that decrease along the
 * order), adjacent ones are paired, so that the number of rounds is logarithmic. */
#include "ref/build/grow.h"
#include "ref/build/links.h"
#include "ref/build/morton.h"
#include "ref/build/room.h"

#include <math.h>
#include <string.h>

/* Nodes 0 .. count - 1 are the triangles. */
struct ploc {
    const struct ref *ref;
    uint32_t (*child)[2];
    uint32_t *leaves;
    uint32_t nodes;       /* nodes made so far */
    uint32_t *cluster;    /* nodes without a parent, in order */
    struct lane_box *box; /* their boxes, scaled so that areas neither overflow nor vanish */
    uint32_t *chosen;     /* place that each cluster would join */
    uint32_t count, radius, threads;
};

#define CHUNK 1024u
/* A round should leave at most this fraction of the clusters; usually it leaves two thirds. */
#define SLOW(count) ((count) - (count) / 16)

/* The best neighbour so far. */
struct choice {
    float area;
    uint32_t differs; /* bits in which the places differ: unique for each neighbour */
};

static void choose(struct choice *choice, float area, uint32_t differs)
{
    if (area < choice->area || (area == choice->area && differs < choice->differs))
        *choice = (struct choice){area, differs};
}

/* Chooses for the clusters at begin .. end - 1. Each pair's area is computed once, except across
 * the chunk's ends. */
static void choose_chunk(const struct ploc *p, uint32_t begin, uint32_t end)
{
    struct choice best[CHUNK];
    uint32_t from = begin > p->radius ? begin - p->radius : 0;
    for (uint32_t i = 0; i < end - begin; i++)
        best[i] = (struct choice){INFINITY, UINT32_MAX};
    for (uint32_t i = from; i < end; i++) {
        uint32_t last = p->count - i > p->radius ? i + p->radius : p->count - 1;
        for (uint32_t j = i < begin ? begin : i + 1; j <= last; j++) {
            struct lane_box both = p->box[i];
            lane_box_add(&both, &p->box[j]);
            float area = lanes_half_area(both.hi - both.lo);
            area = area < INFINITY ? area : INFINITY; /* NaN, if vertices are not finite */
            if (i >= begin)
                choose(&best[i - begin], area, i ^ j);
            if (j < end)
                choose(&best[j - begin], area, i ^ j);
        }
    }
    for (uint32_t i = begin; i < end; i++)
        p->chosen[i] = i ^ best[i - begin].differs;
}

static uint32_t join(struct ploc *p, uint32_t a, uint32_t b)
{
    uint32_t node = p->nodes++;
    p->child[node][0] = a;
    p->child[node][1] = b;
    p->leaves[node] = p->leaves[a] + p->leaves[b];
    return node;
}

/* Merges clusters that chose each other, at the place of the first. Returns the number left. */
static uint32_t join_chosen(struct ploc *p)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        uint32_t j = p->chosen[i];
        bool both = p->chosen[j] == i;
        if (both && j < i)
            continue;
        /* Neither place i nor any later place has been written yet. */
        struct lane_box box = p->box[i];
        uint32_t node = p->cluster[i];
        if (both) {
            lane_box_add(&box, &p->box[j]);
            node = join(p, node, p->cluster[j]);
        }
        p->box[left] = box;
        p->cluster[left++] = node;
    }
    return left;
}

static void round_of(struct ploc *p)
{
    uint32_t chunks = (p->count + CHUNK - 1) / CHUNK;
#pragma omp parallel for schedule(dynamic, 4)                                                      \
    num_threads(p->threads) if (p->threads > 1 && chunks > 8)
    for (uint32_t c = 0; c < chunks; c++) {
        uint32_t begin = c * CHUNK, rest = p->count - begin;
        choose_chunk(p, begin, begin + (rest < CHUNK ? rest : CHUNK));
    }
    uint32_t before = p->count;
    p->count = join_chosen(p);
    if (before <= CHUNK || p->count <= SLOW(before))
        return;
    for (uint32_t i = 0; i < p->count; i++)
        p->chosen[i] = i + 1 == p->count ? i - 1 : i ^ 1;
    p->count = join_chosen(p);
}

static void start(struct ploc *p, const uint64_t *key, uint32_t index_bits)
{
    struct lane_box all = lane_box_empty();
    for (uint32_t i = 0; i < p->count; i++)
        lane_box_add(&all, &p->ref[i].box);
    lanes unit = lanes_all(lanes_scale(&all));
    uint64_t mask = ((uint64_t)1 << index_bits) - 1;
    for (uint32_t i = 0; i < p->count; i++) {
        uint32_t prim = (uint32_t)(key[i] & mask);
        p->cluster[i] = prim;
        p->box[i].lo = p->ref[prim].box.lo * unit;
        p->box[i].hi = p->ref[prim].box.hi * unit;
        p->child[i][0] = p->child[i][1] = LINKS_NONE;
        p->leaves[i] = 1;
    }
    p->nodes = p->count;
}

static struct lane_box leaf(const void *user, uint32_t node, uint32_t *prim, uint32_t *items)
{
    *prim = node;
    *items = 1;
    return ((const struct ref *)user)[node].box;
}

static enum status cluster(struct ploc *p, const uint64_t *key, uint32_t index_bits,
                           struct bvh *out)
{
    uint32_t count = p->count;
    p->child = room_make(2 * (size_t)count, sizeof *p->child);
    p->leaves = room_make(2 * (size_t)count, sizeof *p->leaves);
    p->cluster = room_make(count, sizeof *p->cluster);
    p->box = room_make(count, sizeof *p->box);
    p->chosen = room_make(count, sizeof *p->chosen);
    enum status status = STATUS_MEMORY;
    if (p->child && p->leaves && p->cluster && p->box && p->chosen) {
        start(p, key, index_bits);
        while (p->count > 1)
            round_of(p);
        struct links links = {.child = p->child,
                              .leaves = p->leaves,
                              .root = p->cluster[0],
                              .leaf = leaf,
                              .user = p->ref,
                              .items = count,
                              .tris = count};
        status = links_write(&links, out);
    }
    room_free(p->child);
    room_free(p->leaves);
    room_free(p->cluster);
    room_free(p->box);
    room_free(p->chosen);
    return status;
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (status || scene->tri_count == 0)
        return status;
    uint32_t threads = build_threads(options, scene->tri_count), index_bits = 0;
    uint32_t radius = options->radius ? options->radius : BUILD_RADIUS_DEFAULT;
    struct lane_box centres;
    struct ref *ref = NULL;
    uint64_t *key = NULL;
    status = refs_make(scene, threads, &ref, &centres);
    if (!status)
        status = morton_order(ref, scene->tri_count, &centres, threads, &key, &index_bits);
    struct ploc p = {.ref = ref,
                     .count = scene->tri_count,
                     .radius = radius < BUILD_RADIUS_MOST ? radius : BUILD_RADIUS_MOST,
                     .threads = threads};
    if (!status)
        status = cluster(&p, key, index_bits, out);
    if (!status)
        status = tree_collapse(out, options->leaf);
    room_free(ref);
    room_free(key);
    if (!status)
        return STATUS_OK;
    tree_drop(out);
    return fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
}

extern const struct builder build_ploc;
const struct builder build_ploc = {
    .name = "ploc",
    .summary = "clusters from below that join their best neighbour within --radius places",
    .build = build,
    .takes = "radius",
    .tri_bytes = 190,
};
