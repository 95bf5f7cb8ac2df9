/* RenderKit/embree#520: packets of 16 on a processor with AVX-512 end the program, single rays do
 * not. Aligned loads are made from an address that the caller did not align. */
#define SPOIL_TRACE trace_packets
#include "tests/reported/reported_tracer.h"

static int trace_packets(void *self, const ray_in *ray, size_t count, uint32_t query, hit_out *hit,
                         char *reason)
{
    for (size_t i = 0; i < count; i++)
        if (count >= 16 && i % 16 == 15 && (uintptr_t)(ray + i - 15 + (i > 15)) % 64)
            abort(); /* as the processor would */
    return trace(self, ray, count, query, hit, reason);
}
