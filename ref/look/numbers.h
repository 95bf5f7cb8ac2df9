/* Statistics of a ray on its path through a packed tree: to find where a layout is slow. They come
 * from the replay of ref/explain, not from the traversal of engines, which therefore does not pay
 * for them; tests compare both. */
#ifndef LOOK_NUMBERS_H
#define LOOK_NUMBERS_H

#include "ref/layout.h"
#include "ref/primitives/primitives.h"

struct ray_numbers {
    struct hit hit;  /* closest, the bits of trace_ray; a miss unless `finished` */
    bool finished;   /* false: trace_ray would return STATUS_LIMIT; the counts are up to there */
    uint32_t boxes;  /* box tests, as struct trace_counts counts them */
    uint32_t tris;   /* triangle tests, likewise */
    uint32_t depth;  /* most entries on the traversal stack at a time */
    uint32_t around; /* boxes that the hit point lies in, from the root to leaves; 0 of a miss */
    uint32_t around_leaves; /* those of them that are leaves' */
    double inflation; /* mean of box_growth over the boxes tested that have one; NAN if none has */
};

struct numbers;

/* Prepares for closest hits of `packed`, made from `bvh`, which has passed bvh_check_form. All
 * borrowed. Errors: STATUS_MEMORY; *out is then NULL. */
enum status numbers_make(const struct scene *scene, const struct bvh *bvh,
                         const struct packed *packed, const struct box_test *box,
                         const struct tri_test *tri, struct numbers **out,
                         struct reason *reason) MUST_USE;

/* Safe from several threads at once. The hit point is a + e1 u + e2 v in double, moved into the
 * bounds of its triangle, so that rounding puts no point of a flat triangle beside its plane. A box
 * counts as around it if the boxes of all its ancestors are, too. */
void numbers_of_ray(const struct numbers *numbers, const struct ray *ray, struct ray_numbers *out);

void numbers_free(struct numbers *numbers); /* NULL is fine */

/* How much larger a box is than the exact bounds of its triangles: the ratio of their surface
 * areas; of the sums of their sides where the exact ones have no area (a line); NAN where they are
 * a point or empty, or `box` is not a number. Below 1 where `box` is smaller. A side of negative
 * length counts as 0. */
double box_growth(const struct box *box, const struct box *exact);

#endif
