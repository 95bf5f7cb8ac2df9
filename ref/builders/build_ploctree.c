/* Builds bottom-up as a streaming unit would (Viitanen et al. 2018, PLOCTree: A fast, high-quality
 * hardware BVH builder): parallel locally-ordered clustering whose clusters pass, sweep after
 * sweep, through a window of 2 radius + 1 places. A cluster that comes in is compared with the
 * `radius` before it. One that has seen its last neighbour waits until those have seen theirs, and
 * leaves, merged with the one it chose if that chose it. Nothing but the window is held: all
 * clusters are read and those left are written once a sweep, which is counted. Ours: neighbours are
 * chosen as by builder ploc, and adjacent clusters are paired in a sweep of its own if hardly any
 * merged, so that the tree is that of builder ploc. No speed and no area of such a unit is
 * claimed. */
#include "ref/builders/clusters.h"

#include "ref/build/links.h"

#define PLACES 1024u /* a power of two, at least 2 BUILD_RADIUS_MOST + 1 */
_Static_assert(PLACES > 2 * BUILD_RADIUS_MOST, "the window holds every radius");

/* Place i of the stream is held at i % PLACES. */
struct stream {
    struct lane_box box[PLACES];
    uint32_t cluster[PLACES];
    struct choice best[PLACES];
};

static void come_in(struct stream *w, const struct clusters *c, uint32_t i)
{
    uint32_t at = i % PLACES, nearest = i > c->radius ? i - c->radius : 0;
    w->box[at] = c->box[i];
    w->cluster[at] = c->cluster[i];
    w->best[at] = CHOICE_NONE;
    for (uint32_t j = nearest; j < i; j++) {
        uint32_t other = j % PLACES;
        float area = common_area(&w->box[at], &w->box[other]);
        choose(&w->best[at], area, i ^ j);
        choose(&w->best[other], area, i ^ j);
    }
}

#define MERGED 0u /* `differs` of what has left with a cluster before it */

/* Writes what leaves the window at place i behind the `left` that have left before; returns how
 * many have left then. */
static uint32_t leave(struct stream *w, struct clusters *c, uint32_t i, uint32_t left)
{
    uint32_t at = i % PLACES, differs = w->best[at].differs, j = i ^ differs, other = j % PLACES;
    if (differs == MERGED)
        return left;
    struct lane_box box = w->box[at];
    uint32_t node = w->cluster[at];
    /* If it chose one before it that chose it, it is merged. */
    if (j > i && w->best[other].differs == differs) {
        lane_box_add(&box, &w->box[other]);
        node = clusters_join(c, node, w->cluster[other]);
        w->best[other].differs = MERGED;
    }
    c->box[left] = box;
    c->cluster[left] = node;
    return left + 1;
}

static void count_sweep(struct clusters *c, uint32_t left)
{
    c->traffic.sweeps++;
    c->traffic.boxes_read += c->count;
    c->traffic.boxes_written += left;
    c->count = left;
}

static void sweep(struct clusters *c)
{
    struct stream w;
    uint32_t left = 0, behind = 2 * c->radius;
    for (uint32_t i = 0; i < c->count + behind; i++) {
        if (i < c->count)
            come_in(&w, c, i);
        if (i >= behind)
            left = leave(&w, c, i - behind, left);
    }
    count_sweep(c, left);
}

/* A window of two places. */
static void pair(struct clusters *c)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < c->count; i += 2, left++) {
        struct lane_box box = c->box[i];
        uint32_t node = c->cluster[i];
        if (i + 1 < c->count) {
            lane_box_add(&box, &c->box[i + 1]);
            node = clusters_join(c, node, c->cluster[i + 1]);
        }
        c->box[left] = box;
        c->cluster[left] = node;
    }
    count_sweep(c, left);
}

static void round_of(struct clusters *c)
{
    uint32_t before = c->count;
    sweep(c);
    if (before > CLUSTERS_FEW && c->count > CLUSTERS_SLOW(before))
        pair(c);
}

static const struct cluster_rule rule = {.round = round_of};

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    return clusters_build(&rule, scene, options, out, NULL, reason);
}

static enum status traffic(const struct scene *scene, const struct build_options *options,
                           struct build_traffic *out, struct reason *reason)
{
    struct bvh bvh;
    *out = (struct build_traffic){0};
    enum status status = clusters_build(&rule, scene, options, &bvh, out, reason);
    tree_drop(&bvh);
    return status;
}

extern const struct builder build_ploctree;
const struct builder build_ploctree = {
    .name = "ploctree",
    .summary = "the tree of ploc, merged in sweeps over a stream, which are counted; one thread",
    .build = build,
    .traffic = traffic,
    .takes = "radius presplit",
    .tri_bytes = 185,
};
