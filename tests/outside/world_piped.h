/* Worlds over a pipe: the world and rays that the suites use, and their engine. Includes
 * cmocka.h. */
#ifndef TESTS_WORLD_PIPED_H
#define TESTS_WORLD_PIPED_H

#include "tests/outside/world_peers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include "tests/outside/peer_engine.h"

#define RAYS 400

#include "tests/support/mixed_rays.h"

/* What a tracer without a defect answers to ray i. */
static inline void look_at(const struct world_look *look, enum query query, size_t i,
                           struct hit *hit, uint32_t *tag)
{
    const struct hit none = {.prim = ABI_NO_PRIM};
    world_look_trace(look, query, &ray[i], mode[i], &none, hit, tag);
}

#endif
