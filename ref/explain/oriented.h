/* Oriented boxes of a packed tree (layout->misses): what is below them, and their test with a
 * switch for each of its properties, as slabs.h has for boxes. */
#ifndef EXPLAIN_ORIENTED_H
#define EXPLAIN_ORIENTED_H

#include "ref/explain/tree.h"

/* For explain_tree_make: fills tree->oriented, if the layout has oriented boxes. Bounds are of the
 * triangles that leaves below name. Errors: STATUS_MEMORY. */
enum status explain_map_oriented(struct explain_tree *tree) MUST_USE;

/* The box along the axes of its parent that reference `child` of `ref` needs: `lo` the greatest
 * floats that are at most the products of axes and vertices below, `hi` the least that are at
 * least. False if none is stored, or if it is not known what is below. */
bool oriented_needs(const struct explain_tree *tree, uint32_t ref, uint32_t child, float lo[3],
                    float hi[3]);

/* True if the stored oriented box of `child` does not contain what is below it. A NaN is no
 * bound. */
bool oriented_is_loose(const struct explain_tree *tree, uint32_t ref, uint32_t child);

/* What differs from the layout's test. */
struct oriented_rule {
    bool turned;  /* component j of axis k is taken for component k of axis j */
    bool shifted; /* each axis has the bounds of the next */
};

/* True if the test with these properties turns the ray away from the box. With none of them and in
 * arithmetic without rounding it is the layout's. */
bool oriented_by_rule(const struct oriented_rule *rule, const struct oblique_box *box,
                      const struct oblique_ray *ray, float tmax);

/* False whenever the exact ray meets the stored box, a little widened, at a distance from
 * ray->least to tmax; in double. */
bool oriented_conservative(const struct oblique_box *box, const struct oblique_ray *ray,
                           float tmax);

/* The ray as a traversal of a tree with this box of its root passes it to layout->misses. */
struct oblique_ray oriented_ray(const struct ray *ray, const struct box *root);

/* layout->misses with the `repairs` (a mask) and the defect that concern it. The layout has it. */
bool oriented_misses(const struct explain_tree *tree, uint32_t repairs, enum defect defect,
                     uint32_t ref, uint32_t child, const struct oblique_ray *ray, float tmax);

/* The distances between the stored bounds of axis j, in double and without an allowance; a ray
 * along them has -infinity to infinity if it is between them, else infinity to -infinity. */
void oriented_axis_exact(const struct oblique_box *box, const struct oblique_ray *ray, uint32_t j,
                         double *enter, double *leave);

#endif
