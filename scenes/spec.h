/* The text that names a generator, of scenes or of worlds: "NAME" or "NAME:KEY=VALUE,KEY=VALUE". */
#ifndef SPEC_H
#define SPEC_H

#include "scenes/scenes.h"

/* What a text may name, and its params: as of a struct generator. */
struct spec_maker {
    const char *name;
    const struct param *param; /* GENERATOR_PARAMS, or up to the first without a name */
};

/* True if `spec` is `name`, with or without params. */
bool spec_names(const char *spec, const char *name);

/* Sets `value`, GENERATOR_PARAMS numbers, to the defaults and what the text gives; *seed changes if
 * it gives one. Errors: STATUS_INPUT a param that is unknown, given twice, or out of its range. */
enum status spec_values(const struct spec_maker *maker, const char *spec, double *value,
                        uint64_t *seed, struct reason *reason) MUST_USE;

/* Checks one value per param. Errors: STATUS_LIMIT a value outside least..most or NaN; STATUS_INPUT
 * a fraction for a param of whole numbers. */
enum status spec_check(const struct spec_maker *maker, const double *value,
                       struct reason *reason) MUST_USE;

/* Number of params. */
size_t spec_params(const struct param *param);

#endif
