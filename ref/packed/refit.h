/* Refit: computes new bounds for a tree after its scene's vertices have moved; everything else is
 * kept. Trees stay conservative; they get worse with every motion that separates neighbours. */
#ifndef REFIT_H
#define REFIT_H

#include "ref/layout.h"

/* Replaces the bounds of every node by the exact bounds of the triangles below it, which have the
 * same indices as when the tree was built. The form of the tree must have been checked. Errors,
 * after which the tree is unchanged: STATUS_INPUT the number of triangles differs from the scene's;
 * STATUS_LIMIT "rebuild: ..." a split tree, because the parts of triangles in its leaves are no
 * longer known; STATUS_MEMORY. */
enum status bvh_refit(struct bvh *bvh, const struct scene *scene, struct reason *reason) MUST_USE;

/* Replaces the bounds of a packed tree by the tightest that its layout can store for the moved
 * triangles, and the vertices in its storage. Nodes, references, items and a frame of the whole
 * scene are kept; frames of single nodes are recomputed. A tree without faults in packed_check
 * still has none. A refit to the scene from which the tree was packed gives the same words, if the
 * builder's boxes were exact. Safe on hostile words. Errors, after which the packed tree is
 * unchanged, to the bit: STATUS_LIMIT, always "rebuild: ...": the layout has no refit (faithful
 * ones, and plugins), a split tree, a bound outside the layout's numbers or the original frame of
 * the scene, a leaf with too few words in its storage; STATUS_INPUT another number of triangles, a
 * vertex that is not finite, or the decoded words are no tree of the scene; STATUS_MEMORY. */
enum status packed_refit(struct packed *packed, const struct scene *scene,
                         struct reason *reason) MUST_USE;

#endif
