/* RenderKit/embree#596: with another ISA the same ray has another answer. One of them divides, this
 * one multiplies with an estimate of the reciprocal of 12 bits, and no step of Newton's follows. */
#define SPOIL_TRACE trace_estimated
#include "tests/reported/reported_tracer.h"

static int trace_estimated(void *self, const ray_in *ray, size_t count, uint32_t query,
                           hit_out *hit, char *reason)
{
    trace(self, ray, count, query, hit, reason);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &hit[i].t, 4);
        bits &= ~0x7FFu;
        memcpy(&hit[i].t, &bits, 4);
    }
    return RAYDIFF_ENGINE_OK;
}
