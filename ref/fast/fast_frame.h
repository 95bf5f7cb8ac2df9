/* The frame of a tree, codes in it, and memory; inside ref/fast. */
#ifndef FAST_FRAME_H
#define FAST_FRAME_H

#include "ref/fast/fast.h"

#define FRAME_MOST 65535
#define FRAME_LINE 128u /* what frame_pages aligns to at least: two lines */

/* Sets the frame: the scene's box in FRAME_MOST steps. A step has 8 significant bits, so that
 * step * code is exact in float. */
void frame_set(struct fast_tree *tree, const struct box *bounds);

/* The largest code of axis k whose bound is at or below b. In double step * code is exact. */
uint16_t frame_down(const struct fast_tree *tree, int k, float b);

/* The smallest code whose bound is at or above b. */
uint16_t frame_up(const struct fast_tree *tree, int k, float b);

/* Returns zeroed memory, aligned to FRAME_LINE at least. Large arrays use huge pages where the
 * system has them, as a ray reads a few cache lines of many pages. Freed by free(). Returns NULL if
 * there is no memory. */
void *frame_pages(uint64_t bytes);

#endif
