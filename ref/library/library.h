/* Shared by the files of the public library; see ref/library/raydiff.h. */
#ifndef LIBRARY_H
#define LIBRARY_H

#include "ref/library/raydiff.h"
#include "ref/oracle/oracle.h"

/* Owns all of it. */
struct raydiff_oracle {
    struct scene scene;
    struct oracle *oracle;
};

/* Ends a public function: writes the line of `reason`, empty if status is STATUS_OK, and returns
 * the error of that status. */
enum raydiff_error library_end(enum status status, const struct reason *reason,
                               struct raydiff_why *why) MUST_USE;

/* Errors: STATUS_INPUT a pointer is NULL, "WHAT: is NULL". */
enum status library_given(const void *pointer, const char *what, struct reason *reason) MUST_USE;

/* Copies triangles. Errors: those of raydiff_oracle_make, but for UNSUPPORTED; *out is then
 * zero. */
enum status library_scene(const struct raydiff_case *from, struct scene *out,
                          struct reason *reason) MUST_USE;

/* The place of `word` among the names that `name` gives, which end with NULL. Errors: STATUS_INPUT
 * it is none of them. */
enum status library_find(const char *what, const char *word, const char *(*name)(uint32_t),
                         uint32_t *out, struct reason *reason) MUST_USE;

/* Rays of the interface, which have the numbers of struct ray in its order. */
static inline const struct ray *library_rays(const float *ray)
{
    return (const struct ray *)(const void *)ray;
}

#endif
