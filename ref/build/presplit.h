/* Parts of triangles for builders that do not cut any: the triangles whose boxes have most room to
 * spare are cut before the build, and each part is a reference of its own (Ernst and Greiner 2007,
 * Early Split Clipping for Bounding Volume Hierarchies), by the priorities, the planes and the
 * budget of Karras and Aila 2013, section 4 (Fast parallel construction of high-quality bounding
 * volume hierarchies). */
#ifndef PRESPLIT_H
#define PRESPLIT_H

#include "ref/build/clip.h"
#include "ref/tree/bvh.h"

/* Makes the parts of all triangles, in the order of the triangles: of each one or more, which
 * together contain every point of it, and at most options->presplit times the triangles more than
 * there are triangles. Each part's box lies in its triangle's box. A triangle has
 *   priority = cbrt(2^-level * (area of its box - area of ideal boxes))
 * where `level` is that of the coarsest plane of the scene's grid that cuts its box, 0 for the
 * middle of the longest side of the scene's box, and ideal boxes are those of infinitely many
 * parts. It is cut scale * priority times, rounded down, by the largest scale that keeps the
 * budget: its box at the coarsest plane, then each part, which get cuts in the ratio of their
 * longest sides. Ours: the arithmetic is in double, of operations that are rounded alike
 * everywhere; so the parts are the same on any machine and by any number of threads. Free with
 * room_free. Errors: STATUS_LIMIT more than 2^31 parts; STATUS_MEMORY, without a reason. */
enum status presplit_make(const struct scene *scene, const struct build_options *options,
                          uint32_t threads, struct part **out, uint32_t *count,
                          struct reason *reason) MUST_USE;

/* The items that a build begins with, at most. */
double presplit_most(uint32_t tri_count, const struct build_options *options);

/* Finishes a tree whose items are parts of triangles 0 .. tri_count - 1, each named by its
 * triangle: a subtree of one triangle becomes a leaf, and a leaf lists a triangle once. No box
 * changes. Errors: STATUS_MEMORY; the tree is unchanged. */
enum status presplit_merge(struct bvh *bvh, uint32_t tri_count) MUST_USE;

#endif
