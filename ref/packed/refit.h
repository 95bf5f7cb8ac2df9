/* Refit: new bounds for a tree whose scene's vertices have moved, everything else of it kept. Trees
 * stay conservative; they get worse with every motion that takes neighbours apart. */
#ifndef REFIT_H
#define REFIT_H

#include "ref/layout.h"

/* Replaces the bounds of every node by the exact ones of the triangles below it, which have the
 * same indices as when the tree was built. The form of the tree has been checked. Errors, after
 * which the tree is as before: STATUS_INPUT another number of triangles than the scene's;
 * STATUS_LIMIT "rebuild: ..." a split tree, whose leaves have boxes of parts of triangles that
 * are not known any more; STATUS_MEMORY. */
enum status bvh_refit(struct bvh *bvh, const struct scene *scene, struct reason *reason) MUST_USE;

/* Replaces the bounds of a packed tree by the tightest that its layout has for the moved triangles,
 * and what its storage has of their vertices; nodes, references, items and a frame of the whole
 * scene stay. Frames of single nodes are made anew. A tree that packed_check found nothing in keeps
 * that, and what is refitted to the scene that it was packed from has the words that it had, if the
 * builder's boxes were exact. Safe on hostile words.
 * Errors, after which the packed tree is as before, to the bit: STATUS_LIMIT, always "rebuild:
 * ...": the layout has no refit (those as published, and plugins), a split tree, a bound beyond the
 * layout's numbers or beyond the frame of the scene as it was, a leaf that its storage has not
 * enough words for; STATUS_INPUT another number of triangles, a vertex that is not finite, what is
 * decoded is no tree of the scene; STATUS_MEMORY. */
enum status packed_refit(struct packed *packed, const struct scene *scene,
                         struct reason *reason) MUST_USE;

#endif
