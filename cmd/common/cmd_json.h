/* JSON files as the commands write them: whole or not at all. For commands only. */
#ifndef CMD_JSON_H
#define CMD_JSON_H

#include "ref/abi.h"
#include "ref/base/base.h"
#include "ref/files/file.h"
#include "ref/match/match.h"

#include <jansson.h>

/* Writes `root`, which is taken over and may be NULL (no memory for it), to `path` (options_out),
 * reals with so many digits. Errors: STATUS_MEMORY; STATUS_INPUT cannot write. */
enum status json_write(const char *path, json_t *root, unsigned digits,
                       struct reason *reason) MUST_USE;

/* The same to an open file, which is committed or discarded. */
enum status json_write_out(struct file_out *out, json_t *root, unsigned digits,
                           struct reason *reason) MUST_USE;

/* {"value": a number or null, "bits": "0x..."}, one and several. NULL without memory, as all of these. */
json_t *json_float(float x);
json_t *json_floats(const float *x, size_t count);

/* Only the bits, "0x..."; and those of a ray: origin, tmin, direction, tmax. */
json_t *json_bits(float x);
json_t *json_ray_bits(const struct ray *ray);

/* How many answers each verdict has. */
json_t *json_verdicts(const size_t count[VERDICT_COUNT]);

/* A triangle, or null for ABI_NO_PRIM; and a hit with its t, u and v. */
json_t *json_prim(uint32_t prim);
json_t *json_hit(const struct hit *hit);

/* The members that were named and how often they answered, see README "JSON". */
struct turnout;
json_t *json_turnout(const struct turnout *turnout);

#endif
