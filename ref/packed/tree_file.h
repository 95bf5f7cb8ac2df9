/* A tree that comes from a file, for a scene: what --bvh names. */
#ifndef TREE_FILE_H
#define TREE_FILE_H

#include "ref/layout.h"

/* BVH JSON (ref/tree/bvh_json.h), from which every layout can be packed, or packed in one
 * (ref/packed/packed_file.h). Owns its arrays (see tree_file_free). */
struct tree_file {
    const char *name;     /* of the file; borrowed */
    struct bvh bvh;       /* of JSON; node_count 0 if packed */
    struct packed packed; /* layout is NULL unless packed */
    struct bvh_stats
        stats;           /* of a packed one as its layout decodes: loose_count counts all boxes */
    struct reason doubt; /* what makes answers wrong: boxes that are too small, triangles in no
                            leaf or in several; empty if there is nothing */
};

/* The builder that results name where a tree is a file's: "file". It is in no table and builds
 * nothing: its `build` returns STATUS_INTERNAL. */
extern const struct builder tree_file_builder;

/* Reads `size` bytes of either kind and checks that they are a tree of this scene: acyclic, all
 * references in range, each triangle in one leaf (of packed ones see packed_file_read), and most
 * triangles in the box of their leaf. Boxes that are too small for their triangles are taken, with
 * a doubt: RTRS's are.
 *   name   of the file, for reasons
 *   bytes  borrowed
 * Errors: STATUS_INPUT "NAME: place: rule", as bvh_json_read and packed_file_read, or the tree is
 * another scene's: more than half of the triangles have their centre outside the box of their leaf
 * (of the root, in RTRS's layouts, whose leaves name other triangles); STATUS_MEMORY. On error
 * *out is zero. */
enum status tree_file_read(const char *name, const char *bytes, size_t size,
                           const struct scene *scene, struct tree_file *out,
                           struct reason *reason) MUST_USE;

void tree_file_free(struct tree_file *file);

static inline bool tree_file_is_packed(const struct tree_file *file)
{
    return file->packed.layout != NULL;
}

/* Packs a JSON tree in `layout`, or copies a packed one, which must be in that layout already.
 * Errors: STATUS_INPUT it is packed in another layout (named); those of packed_make. */
enum status tree_file_pack(const struct tree_file *file, const struct layout *layout,
                           const struct scene *scene, struct packed *out,
                           struct reason *reason) MUST_USE;

/* Copies a JSON tree; of a packed one makes the tree that it decodes to (packed_unpack). Errors:
 * STATUS_INPUT "NAME: rule" it decodes to none; STATUS_MEMORY. */
enum status tree_file_bvh(const struct tree_file *file, const struct scene *scene, struct bvh *out,
                          struct reason *reason) MUST_USE;

#endif
