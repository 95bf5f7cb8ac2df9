/* Builds bottom-up (Meister and Bittner 2017, Parallel locally-ordered clustering). Along the order
 * of Morton codes every cluster searches `radius` places to both sides for the neighbour with the
 * smallest common box. Clusters that choose each other are merged, until one is left. Ours: among
 * equally near neighbours the one whose place differs in lower bits is chosen, so that many equal
 * triangles pair up. And if hardly any clusters chose each other (sizes that decrease along the
 * order), adjacent ones are paired, so that the number of rounds is logarithmic. */
#include "ref/builders/clusters.h"

#define CHUNK 1024u

/* Chooses for the clusters at begin .. end - 1. Each pair's area is computed once, except across
 * the chunk's ends. */
static void choose_chunk(const struct clusters *p, uint32_t begin, uint32_t end)
{
    struct choice best[CHUNK];
    uint32_t from = begin > p->radius ? begin - p->radius : 0;
    for (uint32_t i = 0; i < end - begin; i++)
        best[i] = CHOICE_NONE;
    for (uint32_t i = from; i < end; i++) {
        uint32_t last = p->count - i > p->radius ? i + p->radius : p->count - 1;
        for (uint32_t j = i < begin ? begin : i + 1; j <= last; j++) {
            float area = common_area(&p->box[i], &p->box[j]);
            if (i >= begin)
                choose(&best[i - begin], area, i ^ j);
            if (j < end)
                choose(&best[j - begin], area, i ^ j);
        }
    }
    for (uint32_t i = begin; i < end; i++)
        p->chosen[i] = i ^ best[i - begin].differs;
}

/* Merges clusters that chose each other, at the place of the first. Returns the number left. */
static uint32_t join_chosen(struct clusters *p)
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
            node = clusters_join(p, node, p->cluster[j]);
        }
        p->box[left] = box;
        p->cluster[left++] = node;
    }
    return left;
}

static void round_of(struct clusters *p)
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
    if (before <= CLUSTERS_FEW || p->count <= CLUSTERS_SLOW(before))
        return;
    for (uint32_t i = 0; i < p->count; i++)
        p->chosen[i] = i + 1 == p->count ? i - 1 : i ^ 1;
    p->count = join_chosen(p);
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    static const struct cluster_rule rule = {.round = round_of, .chooses = true};
    return clusters_build(&rule, scene, options, out, NULL, reason);
}

extern const struct builder build_ploc;
const struct builder build_ploc = {
    .name = "ploc",
    .summary = "clusters from below that join their best neighbour within --radius places",
    .build = build,
    .takes = "radius presplit",
    .tri_bytes = 190,
};
