/* Variants of acceleration structures as engines: "rayquery:fast_build:update:u16". The words are
 * in gpu/accel/accel_variant.h and docs/variants.md. The answers of a copy must have the bits of
 * the engine without the copy. */
#ifndef RAYQUERY_NAMED_H
#define RAYQUERY_NAMED_H

#include "gpu/accel/accel_variant.h"
#include "ref/engine.h"

/* Finds the engine of that name in the table of engines, or adds it. Errors: those of accel_parse;
 * STATUS_LIMIT more than ENGINES_RAYQUERY_MOST. */
enum status rayquery_named(const char *name, const struct engine **out,
                           struct reason *reason) MUST_USE;

/* Adds all of accel_names that have a name of that pattern (fnmatch), such as "rayquery:*u16*".
 * Errors: STATUS_INPUT there is none of that pattern; STATUS_LIMIT. */
enum status rayquery_named_all(const char *pattern, struct reason *reason) MUST_USE;

/* The variant of an engine that was added here, or NULL. */
const struct accel_variant *rayquery_variant_of(const struct engine *engine);

#endif
