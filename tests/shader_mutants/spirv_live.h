/* Which instructions of a module a pipeline can reach: with the values of its specialization
 * constants, through parameters, branches that these decide alone. What a pipeline cannot reach it
 * does not show: no mutant of that needs to be played on it. */
#ifndef SPIRV_LIVE_H
#define SPIRV_LIVE_H

#include "gpu/bisect/spirv_say.h"

/* Sets live[i] of each instruction i; those outside of functions are live. constant[n] is the value
 * of specialization constant n. Errors: STATUS_MEMORY; STATUS_INPUT not a module with an entry. */
enum status spirv_live(const struct spirv_code *code, const uint32_t *constant, uint32_t count,
                       bool *live, struct reason *reason) MUST_USE;

#endif
