/* What a driver builds for ray queries, as bytes that a file can hold. */
#ifndef RAYQUERY_SAVE_H
#define RAYQUERY_SAVE_H

#include "gpu/engines/rayquery_build.h"

#define RAYQUERY_DRIVER (2 * VK_NAME_BYTES + 4)

/* Serialised structures of a world, one behind the other as the driver wrote them: the top level,
 * then that of each mesh that its handles name, in the order in which they first do. */
struct rayquery_saved {
    char *byte; /* size of them, then a 0 */
    size_t size;
    char driver[RAYQUERY_DRIVER]; /* "DEVICE (DRIVER)" */
};

/* Builds the structures of a world on a device in the way of a variant, and serialises them. The
 * caller frees out->byte; on error it is NULL. Errors: as rayquery_open and rayquery_build;
 * STATUS_DEVICE the driver's bytes are no serialised top level. */
enum status rayquery_save(const struct engine_options *options, const struct accel_variant *variant,
                          const struct world *world, struct rayquery_saved *out,
                          struct reason *reason) MUST_USE;

#endif
