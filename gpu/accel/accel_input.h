/* The triangles of a mesh in the form of a variant: buffers as the driver is given them, and the
 * numbers that it is told. The triangles stay the same, exactly; what would be rounded is an
 * error. */
#ifndef ACCEL_INPUT_H
#define ACCEL_INPUT_H

#include "gpu/accel/accel_variant.h"
#include "ref/scene/scene.h"

/* Triangles first .. first + count - 1 of a scene, which are one geometry. */
struct accel_part {
    uint32_t first, count;
};

/* The buffers of a mesh. */
struct accel_input {
    uint8_t *vertices, *before, *indices, *transforms; /* `before`: vertices that an update finds */
    size_t vertex_bytes, index_bytes, transform_bytes; /* of `before` as of `vertices` */
    struct vk_accel_form *form;                        /* of each part */
    uint32_t *count; /* triangles of each part: its own in order, then what is never hit */
    uint32_t part_count;
};

/* Divides a scene into the geometries of a variant: as many as it says, some of them empty if there
 * are fewer triangles, and more where indices do not reach all vertices of one. The caller frees
 * *out. Errors: STATUS_MEMORY. */
enum status accel_split(const struct scene *scene, const struct accel_variant *variant,
                        struct accel_part **out, uint32_t *count, struct reason *reason) MUST_USE;

/* Makes the input of a mesh. Call accel_input_free also on error. Errors: STATUS_LIMIT a vertex
 * that the format or the transform does not give exactly (the first, with its number), or a part
 * with more vertices than indices reach; STATUS_MEMORY.
 *   earlier  where the scene's vertices were before, three floats each, for `before`; they may be
 *            rounded. NULL: each is where the next one is now */
enum status accel_input_make(const struct scene *scene, const float *earlier,
                             const struct accel_part *part, uint32_t part_count,
                             const struct accel_variant *variant, struct accel_input *out,
                             struct reason *reason) MUST_USE;
void accel_input_free(struct accel_input *input);

/* The transform of part `number`; false: the variant has none. */
bool accel_transform_of(const struct accel_variant *variant, uint32_t number, float m[3][4]);

#endif
