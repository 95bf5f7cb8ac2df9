/* Writes JSON files completely or not at all. For commands only. */
#ifndef CMD_JSON_H
#define CMD_JSON_H

#include "ref/abi.h"
#include "ref/base/base.h"
#include "ref/files/file.h"
#include "ref/match/match.h"

#include <jansson.h>

/* Writes `root` to `path` (opened by options_out), reals with `digits` digits. Takes ownership of
 * `root`, which may be NULL (no memory). Errors: STATUS_MEMORY; STATUS_INPUT cannot write. */
enum status json_write(const char *path, json_t *root, unsigned digits,
                       struct reason *reason) MUST_USE;

/* The same to an open file, which is then committed or discarded. */
enum status json_write_out(struct file_out *out, json_t *root, unsigned digits,
                           struct reason *reason) MUST_USE;

/* {"value": a number or null, "bits": "0x..."} for one float, or an array of these for several.
 * Like all the following functions, these return NULL without memory. */
json_t *json_float(float x);
json_t *json_floats(const float *x, size_t count);

/* Only the bits, "0x..."; for a ray an array of the bits of origin, tmin, direction and tmax. */
json_t *json_bits(float x);
json_t *json_ray_bits(const struct ray *ray);

/* The number of answers per verdict. */
json_t *json_verdicts(const size_t count[VERDICT_COUNT]);

/* A triangle's number, or null for ABI_NO_PRIM; and a hit with its t, u and v. */
json_t *json_prim(uint32_t prim);
json_t *json_hit(const struct hit *hit);

/* The named members and how often each answered, see docs/formats.md. */
struct turnout;
json_t *json_turnout(const struct turnout *turnout);

#endif
