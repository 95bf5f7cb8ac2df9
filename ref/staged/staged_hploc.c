/* H-PLOC (Benthin et al. 2024, H-PLOC: Hierarchical Parallel Locally-Ordered Clustering): clusters
 * are merged inside the ranges of Karras's hierarchy, from below. A range of more than
 * HPLOC_CLUSTERS places joins the clusters of its two halves, and merges those that choose each
 * other among HPLOC_RADIUS neighbours, round by round, until at most HPLOC_CLUSTERS are left; the
 * root, until one is. Published, the numbers of nodes depend on who comes first. Ours: a merged
 * cluster keeps the first one's place, and its node has the number of the place that is given up,
 * less 1; among equal areas the neighbour whose position in the list differs in lower bits is
 * chosen. Areas are exact integers of boxes in the scene's frame. */
#include "ref/staged/staged_inner.h"

#include "ref/abi_build.h"

#include <string.h>

#define CLUSTERS ((uint32_t)ABI_HPLOC_CLUSTERS)
#define RADIUS   ((uint32_t)ABI_HPLOC_RADIUS)

struct cluster {
    uint32_t link, place;
    int64_t lo[3], hi[3];
};

struct hploc {
    const struct staged_frame *frame;
    struct staged *staged;
};

static struct cluster cluster_make(const struct hploc *h, uint32_t link, uint32_t place)
{
    const uint32_t *box = staged_box(h->staged, link);
    struct cluster c = {.link = link, .place = place};
    for (int k = 0; k < 3; k++) {
        c.lo[k] = frame_coordinate(h->frame, float_from_bits(box[k]));
        c.hi[k] = frame_coordinate(h->frame, float_from_bits(box[3 + k]));
    }
    return c;
}

/* Half the area of the box of both. */
static int64_t common_area(const struct cluster *a, const struct cluster *b)
{
    int64_t side[3];
    for (int k = 0; k < 3; k++) {
        int64_t lo = a->lo[k] < b->lo[k] ? a->lo[k] : b->lo[k];
        int64_t hi = a->hi[k] > b->hi[k] ? a->hi[k] : b->hi[k];
        side[k] = hi - lo;
    }
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

static void choose(const struct cluster *list, uint32_t count, uint32_t *chosen)
{
    for (uint32_t i = 0; i < count; i++) {
        int64_t least = INT64_MAX;
        chosen[i] = i; /* itself is compared, too, before it is left out */
        uint32_t from = i > RADIUS ? i - RADIUS : 0;
        for (uint32_t j = from; j < count && j <= i + RADIUS; j++) {
            int64_t area = j == i ? INT64_MAX : common_area(&list[i], &list[j]);
            bool nearer = area < least || (area == least && (i ^ j) < (i ^ chosen[i]));
            if (j != i && nearer) {
                least = area;
                chosen[i] = j;
            }
        }
    }
}

static struct cluster join(struct hploc *h, const struct cluster *a, const struct cluster *b)
{
    struct staged *staged = h->staged;
    uint32_t number = b->place - 1;
    staged->child[number][0] = a->link;
    staged->child[number][1] = b->link;
    staged_box_join(staged_box(staged, a->link), staged_box(staged, b->link), staged->box[number]);
    return cluster_make(h, number, a->place);
}

/* One round. Returns the clusters left. */
static uint32_t merge(struct hploc *h, struct cluster *list, uint32_t count)
{
    uint32_t chosen[2 * ABI_HPLOC_CLUSTERS], left = 0;
    choose(list, count, chosen);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = chosen[i];
        if (chosen[j] != i)
            list[left++] = list[i];
        else if (i < j)
            list[left++] = join(h, &list[i], &list[j]);
    }
    return left;
}

/* Writes the clusters of a range to `list`; returns their number, at most CLUSTERS. */
static uint32_t clusters_of(struct hploc *h, uint32_t first, uint32_t last, bool root,
                            struct cluster *list)
{
    struct cluster both[2 * ABI_HPLOC_CLUSTERS];
    uint32_t count = 0;
    if (first == last) {
        list[0] = cluster_make(h, STAGED_LEAF | first, first);
        return 1;
    }
    uint32_t cut = stage_cut(h->staged, first, last);
    count = clusters_of(h, first, cut, false, both);
    count += clusters_of(h, cut + 1, last, false, both + count);
    while (count > (root ? 1 : CLUSTERS))
        count = merge(h, both, count);
    memcpy(list, both, count * sizeof *list);
    return count;
}

void stage_hploc(const struct staged_frame *frame, struct staged *staged)
{
    struct hploc h = {frame, staged};
    struct cluster list[2 * ABI_HPLOC_CLUSTERS];
    (void)clusters_of(&h, 0, staged->count - 1, true, list);
    staged->root = list[0].link;
}
