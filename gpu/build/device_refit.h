/* Refits packed trees on a Vulkan device. */
#ifndef DEVICE_REFIT_H
#define DEVICE_REFIT_H

#include "gpu/build/device_tree.h"
#include "ref/layout.h"

/* True if the device can refit trees of this layout: f32, rf16, cwbvh80, half4, hpb64, the
 * families of tiny8, amd64, gfx12 and grid. */
bool device_refits(const struct layout *layout);

/* Computes the words of a packed tree for vertices that have moved, as packed_refit does in C, into
 * `word`, room for packed->word_count; the tree itself is not changed. The scene is checked, and
 * the tree's form is that of the scene. Writes the time to *ns. Errors: STATUS_LIMIT "rebuild: ..."
 * bounds that the layout cannot hold, or a split tree; STATUS_UNSUPPORTED another layout, or
 * vertices in the storage; STATUS_INPUT the words are no tree; STATUS_DEVICE; STATUS_MEMORY. */
enum status device_refit(struct device_tree *tree, const struct packed *packed,
                         const struct scene *scene, uint32_t *word, uint64_t *ns,
                         struct reason *reason) MUST_USE;

#endif
