/* A tree read from a file, for a scene: the argument of --bvh. */
#ifndef TREE_FILE_H
#define TREE_FILE_H

#include "ref/layout.h"

/* BVH JSON (ref/tree/bvh_json.h), which can be packed in every layout, or a tree packed in one
 * layout (ref/packed/packed_file.h). Owns its arrays (see tree_file_free). */
struct tree_file {
    const char *name;       /* of the file; borrowed */
    struct bvh bvh;         /* from JSON; node_count 0 if packed */
    struct packed packed;   /* layout is NULL unless packed */
    struct bvh_stats stats; /* if packed, of the decoded tree: loose_count counts all boxes */
    struct reason doubt;    /* reason for which results may be wrong: boxes that are too small,
                               triangles in no leaf or in several; empty if none */
};

/* The builder that results name for a tree from a file: "file". It is in no table and cannot build:
 * its `build` returns STATUS_INTERNAL. */
extern const struct builder tree_file_builder;

/* Reads `size` bytes of either kind and checks that they are a tree of this scene: acyclic, all
 * references in range, each triangle in one leaf (for packed trees see packed_file_read), and most
 * triangles in the box of their leaf. Boxes that are too small for their triangles, like RTRS's,
 * are accepted, with a doubt.
 *   name   of the file, for reasons
 *   bytes  borrowed
 * Errors: STATUS_INPUT "NAME: place: rule", as bvh_json_read and packed_file_read, or the tree
 * belongs to another scene: more than half of the triangles have their centre outside the box of
 * their leaf (of the root, in RTRS's layouts, whose leaves name other triangles); STATUS_MEMORY. On
 * error *out is zero. */
enum status tree_file_read(const char *name, const char *bytes, size_t size,
                           const struct scene *scene, struct tree_file *out,
                           struct reason *reason) MUST_USE;

void tree_file_free(struct tree_file *file);

static inline bool tree_file_is_packed(const struct tree_file *file)
{
    return file->packed.layout != NULL;
}

/* Packs a JSON tree in `layout`, or copies a packed tree, which must already be in that layout.
 * Errors: STATUS_INPUT it is packed in another layout (named); those of packed_make. */
enum status tree_file_pack(const struct tree_file *file, const struct layout *layout,
                           const struct scene *scene, struct packed *out,
                           struct reason *reason) MUST_USE;

/* Copies a JSON tree; from a packed tree makes the decoded one (packed_unpack). Errors:
 * STATUS_INPUT "NAME: rule" it cannot be unpacked; STATUS_MEMORY. */
enum status tree_file_bvh(const struct tree_file *file, const struct scene *scene, struct bvh *out,
                          struct reason *reason) MUST_USE;

#endif
