/* The builders of a device, in the form of the tables. */
#ifndef DEVICE_BUILDERS_H
#define DEVICE_BUILDERS_H

#include "ref/engine.h"
#include "ref/staged/staged.h"

/* Adds gpu_lbvh30, gpu_lbvh63 and gpu_hploc to the table. Call it once. Errors: as builder_add. */
enum status device_builders_add(struct reason *reason) MUST_USE;

/* Sets *kind if the builder is one of these. */
bool device_builder_kind(const struct builder *builder, enum staged_kind *kind);

/* Sets the device for later builds: driver and device; both are copied. */
void device_builders_use(const struct engine_options *options);

/* Closes the device that builds opened; the next build opens it again. Returns the number of
 * validation messages. Not for use while a build runs. */
uint32_t device_builders_close(struct reason *reason);

#endif
