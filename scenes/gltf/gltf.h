/* A glTF file while it is read: what its JSON lists, before references are followed. Shared by the
 * parts of read_gltf (scenes/read/world_formats.h). */
#ifndef GLTF_H
#define GLTF_H

#include "scenes/read/json_pull.h"
#include "scenes/read/world_formats.h"

#define GLTF_NONE 0xFFFFFFFFu /* an index that is not given */

struct gltf_buffer {
    json_t *uri;     /* of a file beside it, or NULL */
    char *own;       /* bytes that are owned; NULL: not read yet, or of the chunk */
    uint64_t size;   /* of the bytes */
    uint64_t length; /* as the file tells: what views may reach */
};

struct gltf_view {
    uint32_t buffer;
    uint32_t stride; /* 0: elements are packed */
    uint64_t offset, length;
};

struct gltf_accessor {
    uint32_t view;      /* or GLTF_NONE */
    uint16_t component; /* 5126: float */
    bool vec3, scalar, sparse;
    uint64_t offset, count;
};

enum { GLTF_TRIANGLES = 4, GLTF_STRIP = 5, GLTF_FAN = 6 };

struct gltf_primitive {
    uint32_t position, indices, material; /* or GLTF_NONE */
    uint32_t mode;
};

/* The elements first .. first + count - 1 of a list. */
struct gltf_range {
    uint32_t first, count;
};

struct gltf_node {
    struct gltf_range children; /* of gltf.child */
    uint32_t parent, transform; /* or GLTF_NONE; of gltf.transform */
    struct instance *told;      /* of its extras: custom, mask and flags; or NULL */
    uint32_t mesh;              /* or GLTF_NONE */
    bool flags_told, in_scene;
};

/* M and T in double, row by row. */
struct gltf_transform {
    double m[3][4];
};

struct gltf_material {
    bool opaque, double_sided;
};

/* A list that grows; `items` is an array of what it lists. */
#define GLTF_LIST(type)                                                                            \
    struct {                                                                                       \
        type *item;                                                                                \
        size_t count, capacity;                                                                    \
    }

struct gltf {
    struct json_pull pull;
    const struct world_files *files;
    struct world_notes *notes;
    const char *chunk; /* of a GLB file, or NULL */
    size_t chunk_size;
    uint64_t given, made; /* bytes of the file and the buffers read; bytes of the meshes made */
    GLTF_LIST(struct gltf_buffer) buffer;
    GLTF_LIST(struct gltf_view) view;
    GLTF_LIST(struct gltf_accessor) accessor;
    GLTF_LIST(struct gltf_material) material;
    GLTF_LIST(struct gltf_primitive) primitive;
    GLTF_LIST(struct gltf_range) mesh; /* of primitives */
    GLTF_LIST(struct gltf_node) node;
    GLTF_LIST(uint32_t) child;
    GLTF_LIST(struct gltf_transform) transform;
    GLTF_LIST(struct gltf_range) scene; /* of roots */
    GLTF_LIST(uint32_t) root;
    uint32_t *base_of;      /* of the mesh that is made: the first vertex of each accessor, or
                          GLTF_NONE */
    uint32_t default_scene; /* or GLTF_NONE */
    struct filter_rule filter;
};

/* "NAME: " and the formatted place and rule; returns STATUS_INPUT. For when the JSON has been
 * read. */
enum status gltf_fail(const struct gltf *gltf, const char *format, ...) PRINTF_LIKE(2, 3);
enum status gltf_no_memory(const struct gltf *gltf);

/* Appends a zeroed element to a list of `gltf`, and sets `pointer` to it, or to NULL without
 * memory. */
#define GLTF_APPEND(list, pointer)                                                                 \
    ((pointer) = gltf_append(&(list).item, &(list).capacity, &(list).count, sizeof *(list).item))
void *gltf_append(void *item, size_t *capacity, size_t *count, size_t size);

/* Reads an index of some list, below GLTF_NONE. */
enum status gltf_take_id(struct json_pull *pull, uint32_t *out) MUST_USE;

/* Lists of the file; `self` is the struct gltf. */
json_take_fn gltf_take_nodes, gltf_take_scenes, gltf_take_buffers, gltf_take_views,
    gltf_take_accessors, gltf_take_materials, gltf_take_meshes;

/* Decodes base64 with its padding, `size` characters. Returns false where it is none; the bytes are
 * *out, at most size / 4 * 3. */
bool base64_decode(const char *text, size_t size, char *out, size_t *out_size);
/* Writes base64, with padding. */
void base64_encode(const unsigned char *bytes, size_t size, FILE *stream);

/* The elements of an accessor, each of `bytes` bytes: the first, and how far apart they are. Reads
 * the buffer where it has not been read. Errors: STATUS_INPUT an index, offset, count or length
 * that leads out of its array; STATUS_MEMORY. */
enum status gltf_elements(struct gltf *gltf, uint32_t accessor, size_t bytes,
                          const unsigned char **first, size_t *stride) MUST_USE;

/* Makes mesh `at` into *out, which the caller frees, also on error. *double_sided: all of its
 * primitives are. */
enum status gltf_make_mesh(struct gltf *gltf, uint32_t at, struct world_mesh *out,
                           bool *double_sided) MUST_USE;

/* Checks nodes and scenes, and makes the instances. double_sided: one for each mesh. */
enum status gltf_make_instances(struct gltf *gltf, const bool *double_sided,
                                struct world *out) MUST_USE;

#endif
