/* A packed tree as a file, from or for another packer or tracer. Little-endian 32-bit words:
 *
 *   "RDPK", version 1, name of the layout in 16 bytes (padded with zeros), bytes of a record,
 *   records, items, record of the root, triangles of the scene, stack entries a traversal can need
 *   then the records, then the items (of layouts that have an item array)
 *
 * The words of a record are described in ref/layouts/ and shaders/layouts/, in layout_NAME. */
#ifndef PACKED_FILE_H
#define PACKED_FILE_H

#include "ref/layout.h"
#include "ref/packed/packed_check.h"

#include <stdio.h>

#define PACKED_FILE_VERSION 1u

/* Writes the tree, whose storage must be `indexed`. The caller checks the stream for errors. */
void packed_file_write(const struct packed *packed, FILE *stream);

/* True if the bytes begin like such a file. */
bool packed_file_is(const char *bytes, size_t size);

/* Reads a tree for `scene` and checks it with packed_check before any other use. The result is safe
 * to trace: every reference and triangle is in range, no record is reached twice, the stack
 * suffices. It may still be wrong: *faults (may be NULL) counts boxes that are too small and
 * triangles in no leaf or in several, and `reason` has the first of them, or is empty. The file
 * does not store whether the tree is split: it is if it names every triangle and some of them in
 * several leaves (unless the layout is faithful).
 *   name   of the file, for reasons
 *   bytes  `size` bytes; borrowed
 * Allocates at most 8 times `size` and 64 bytes per triangle of the scene, besides *out. Errors:
 * STATUS_INPUT "NAME: rule", also if packed_check finds the tree unsafe (references of the faithful
 * layouts wrap, so some of their own trees are unsafe); STATUS_MEMORY. On error *out is zero. */
enum status packed_file_read(const char *name, const char *bytes, size_t size,
                             const struct scene *scene, struct packed *out,
                             struct packed_faults *faults, struct reason *reason) MUST_USE;

#endif
