/* What is right of rays, as a list that can be compared with answers where there is no judge. */
#ifndef FUZZ_EXPORT_RIGHTS_H
#define FUZZ_EXPORT_RIGHTS_H

#include "fuzz/play/trial.h"
#include "ref/judge/judge.h"

/* A right answer: triangle prim, or ABI_NO_PRIM, with t, u and v in these closed intervals; those
 * of u and v are infinite if the formula is not known. */
struct export_right {
    uint32_t ray, prim;
    float t[2], u[2], v[2];
    bool front, back; /* in a world: the sides that may be reported */
};

/* Finds all right answers of a tracer of this model to rays in a scene, by the query of the trial,
 * of which nothing else is read but the scene. In the order of rays; a ray without one is out of
 * contract, so that any answer is right. The caller frees *out. Errors: those of oracle_make;
 * STATUS_MEMORY. *out is NULL on error. */
enum status export_rights_make(const struct fuzz_trial *trial, const struct model *model,
                               const struct ray *ray, uint32_t ray_count, struct export_right **out,
                               size_t *count, struct reason *reason) MUST_USE;

#endif
