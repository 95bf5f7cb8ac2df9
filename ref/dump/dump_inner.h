/* Shared by the readers of dumps. */
#ifndef DUMP_INNER_H
#define DUMP_INNER_H

#include "ref/dump/tree_dump.h"

/* A dump while it grows. */
struct dump_making {
    struct tree_dump dump;
    size_t node_capacity, child_capacity, item_capacity;
};

/* Appends a node without children or items. Errors: STATUS_MEMORY; STATUS_LIMIT 2^32 - 1 nodes. */
enum status dump_add_node(struct dump_making *making, bool leaf, const struct box *box) MUST_USE;

/* Appends to the last node: a triangle of a leaf, or a child. Errors: as dump_add_node. */
enum status dump_add_link(struct dump_making *making, uint32_t number) MUST_USE;

/* The readers, as tree_dump_read; *out is freed by the caller also on error. */
enum status dump_read_text(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason) MUST_USE;
enum status dump_read_tinybvh(const char *name, const char *bytes, size_t size,
                              struct tree_dump *out, struct reason *reason) MUST_USE;
enum status dump_read_bvh2(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason) MUST_USE;

enum status dump_read_lavapipe(const char *name, const char *bytes, size_t size,
                               struct tree_dump *out, struct reason *reason) MUST_USE;

enum status dump_read_radv(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason) MUST_USE;

/* True if the bytes begin as an acceleration structure that some Vulkan driver serialised. */
bool dump_is_serialised(const char *bytes, size_t size);

/* The same, of RADV. */
bool dump_is_radv(const char *bytes, size_t size);

/* True if the bytes have the size that their first words demand, with nodes of float or double. */
bool dump_is_bvh2(const char *bytes, size_t size);

/* True if the first word names one of tinybvh's layouts. */
bool dump_is_tinybvh(const char *bytes, size_t size);

#define DUMP_MAGIC "raydiff tree "

#endif
