/* The triangle tests as a compiler contracts them: every product that is added or subtracted goes
 * into an fma. For comparison with engines that were built with contraction. */
#ifndef EXPLAIN_FUSED_H
#define EXPLAIN_FUSED_H

#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"

/* As tri_test_run. */
bool fused_tri_run(uint32_t id, const struct tri_ray *r, float v[3][3], struct hit *out);

#endif
