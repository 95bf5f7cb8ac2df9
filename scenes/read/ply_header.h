/* The header of a PLY file: which elements follow, with which properties. */
#ifndef PLY_HEADER_H
#define PLY_HEADER_H

#include "ref/files/scan.h"

enum ply_encoding { PLY_ASCII, PLY_LITTLE, PLY_BIG };

enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64,
};

/* Bytes of a value in a binary file: 1, 2, 4 or 8. */
size_t ply_type_size(enum ply_type type);

static inline bool ply_type_is_whole(enum ply_type type)
{
    return type < PLY_FLOAT32;
}

/* What the reader does with a property. */
enum ply_role { PLY_SKIP, PLY_X, PLY_Y, PLY_Z, PLY_CORNERS };

/* Not terminated: into the file's bytes. */
struct ply_name {
    const char *at;
    size_t length;
};

struct ply_property {
    enum ply_type type;
    enum ply_type count_type; /* of a list */
    bool list;
    enum ply_role role;
    struct ply_name name;
};

struct ply_element {
    uint64_t count;
    uint32_t first, property_count; /* in ply_header.property */
    struct ply_name name;
};

struct ply_header {
    enum ply_encoding encoding;
    struct ply_element *element;
    struct ply_property *property;
    size_t element_count, property_count;
    size_t element_capacity, property_capacity;
    uint64_t vertex_count;
};

void ply_header_free(struct ply_header *header);

/* Reads the header at the start of `scan` and leaves the cursor on the first byte of the data.
 * The header has one element "vertex" with scalars x, y and z and one element "face" with one list
 * "vertex_indices" or "vertex_index" of whole numbers; no name stands twice.
 * Errors: STATUS_INPUT "NAME:LINE: rule"; STATUS_MEMORY. Free it in either case. */
enum status ply_header_read(struct scan *scan, struct ply_header *out,
                            struct reason *reason) MUST_USE;

bool ply_is_named(struct ply_name name, const char *word);

#endif
