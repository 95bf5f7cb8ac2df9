/* Worlds for the engines that trace single rays in C (ref/engines/cpu_rays.h), which opens and
 * closes them. */
#ifndef CPU_WORLDS_H
#define CPU_WORLDS_H

#include "ref/engine.h"

/* On a packed world, by the reference traversal. prepare_world refuses what engine cpu's prepare
 * refuses. */
extern const struct world_tracer cpu_worlds_packed;

/* Every triangle of every instance. prepare_world returns also STATUS_LIMIT, if the inverse of a
 * transform is beyond float32. */
extern const struct world_tracer cpu_worlds_brute;

#endif
