/* Variants of acceleration structures: in which way they are made, and in which form the triangles
 * are handed over. A variant is written as words after "rayquery:", in any order, each of them
 * optional (docs/variants.md):
 *   fast_trace or fast_build; low_memory, allow_update, allow_compaction   flags of the build
 *   update or update_into                      built over other vertices, then updated
 *   compact, clone, serialise or serialise_new what is traced is a copy
 *   indirect or host                           what starts the build, or carries it out
 *   split2 to split64                          the geometries of a scene
 *   scaled, turned or moved                    each geometry has a transform
 *   u16, u8 or unindexed                       its indices; else of 32 bits
 *   f32x2 f32x4 f16x2 f16x3 f16x4 s16x2 s16x4 u16x2 u16x4 s8x2 s8x4 u8x2 u8x4 u10x3 f64x3
 *                                              format of its vertices; else f32x3
 *   strideN                                    bytes from vertex to vertex
 *   offset                                     offsets of vertices, primitives, indices and
 *                                              transforms, with garbage before and between
 *   first_vertex                               the number that is added to indices
 *   nan, degenerate                            triangles that are never hit among the others */
#ifndef ACCEL_VARIANT_H
#define ACCEL_VARIANT_H

#include "gpu/vk/vk_accel.h"

#define ACCEL_PREFIX      "rayquery:"
#define ACCEL_NAME_MOST   256
#define ACCEL_SPLIT_MOST  64u
#define ACCEL_STRIDE_MOST 4096u

enum accel_transform {
    ACCEL_TRANSFORM_NONE,
    ACCEL_SCALED, /* by powers of two, others for each axis */
    ACCEL_TURNED, /* axes are exchanged and mirrored */
    ACCEL_MOVED,  /* by whole numbers */
    ACCEL_TRANSFORMS
};

enum accel_index { ACCEL_U32, ACCEL_U16, ACCEL_U8, ACCEL_UNINDEXED, ACCEL_INDICES };

enum accel_format {
    ACCEL_F32X3,
    ACCEL_F32X2,
    ACCEL_F32X4,
    ACCEL_F16X2,
    ACCEL_F16X3,
    ACCEL_F16X4,
    ACCEL_S16X2,
    ACCEL_S16X4,
    ACCEL_U16X2,
    ACCEL_U16X4,
    ACCEL_S8X2,
    ACCEL_S8X4,
    ACCEL_U8X2,
    ACCEL_U8X4,
    ACCEL_U10X3,
    ACCEL_F64X3,
    ACCEL_FORMATS
};

struct accel_variant {
    struct vk_accel_how how;
    enum accel_transform transform;
    enum accel_index index;
    enum accel_format format;
    uint32_t stride; /* 0: the size of a vertex */
    uint32_t split;  /* 0: one geometry */
    bool offset, first_vertex, nan, degenerate;
};

/* True for a name that begins with ACCEL_PREFIX and whose next word is no compiler's
 * (gpu/shaders/compiler.h). */
bool accel_is_named(const char *name);

/* Reads such a name. Errors: STATUS_INPUT a word that is none of the above, two of a kind, a stride
 * that the format does not allow, or a format without NaN together with nan. */
enum status accel_parse(const char *name, struct accel_variant *out,
                        struct reason *reason) MUST_USE;

/* Writes the name with its words in the order above, without those that change nothing; of the
 * plain variant "rayquery". */
void accel_write(const struct accel_variant *variant, char name[ACCEL_NAME_MOST]);

/* The variant whose answers it has to have bit for bit, as it traces a copy of the same structure:
 * the same without a copy. Returns false if it is no copy. */
bool accel_original(const struct accel_variant *variant, struct accel_variant *out);

/* Whether the triangles are handed over in another form than three floats and 32-bit indices. */
bool accel_has_form(const struct accel_variant *variant);

/* The names that "rayquery:all" and patterns stand for; NULL-terminated. */
extern const char *const accel_names[];

#endif
