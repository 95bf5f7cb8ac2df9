/* Shared by raydiff construct and its report. For commands only. */
#ifndef CMD_CONSTRUCT_H
#define CMD_CONSTRUCT_H

#include "scenes/construct.h"

#include <jansson.h>

/* Values of the options. */
struct construct_options {
    struct construct construct;
    size_t model_capacity, material_capacity, light_capacity;
    struct material *material; /* writable; those of `construct` are const */
    struct light *light;
    const char *out;
    bool json, has_kind;
};

/* Prints what was written, on standard error. */
void construct_print(const struct construct_options *options, const struct scene *scene,
                     const struct construct_notes *notes);

/* The same as JSON. Errors: STATUS_INPUT a name is not UTF-8. */
enum status construct_json(const struct construct_options *options, const struct scene *scene,
                           const struct construct_notes *notes, json_t **out,
                           struct reason *reason) MUST_USE;

#endif
