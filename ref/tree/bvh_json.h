/* The tree file of RTRS's `precompute`. */
#ifndef BVH_JSON_H
#define BVH_JSON_H

#include "ref/tree/bvh.h"

#include <stdio.h>

/* Writes the tree as one line of compact JSON, byte for byte as RTRS's tool would:
 *   {"uniforms":[{"fst":1,"snd":2,"item_idx":0,"item_count":0,"bounds":{"min":[0.0,0.0,0.0],
 *   "max":[1.0,1.0,0.5]}},...],"indices":[0,...]}      (without the line break)
 * Floats are the shortest text that reads back as the same float (see decimal_write_float); values
 * that are not finite are null. Write errors set the stream's error flag only. */
void bvh_json_write(const struct bvh *bvh, FILE *stream);

/* Reads such a file, with keys in any order and any white space, and checks it as bvh_check_form:
 * pre-order, acyclic, in range, and every triangle of `scene` in one leaf, or, if there are more
 * items than triangles (a split tree), in at least one. Boxes may be too small for their triangles,
 * as RTRS's are (see bvh_check).
 *   name   of the file, for reasons
 *   bytes  `size` bytes of text; borrowed
 * Errors: STATUS_INPUT "NAME: place: rule"; STATUS_MEMORY. On error *out is zero. */
enum status bvh_json_read(const char *name, const char *bytes, size_t size,
                          const struct scene *scene, struct bvh *out,
                          struct reason *reason) MUST_USE;

#endif
