/* Hard cases of worlds. */
#ifndef HARD_WORLD_H
#define HARD_WORLD_H

#include "tests/hard/hard_check.h"

/* Plays a part that is a world: builds and packs both levels, traces, judges, compares with engine
 * cpu's bits and checks every property that a world has. Errors: STATUS_MEMORY; those of the
 * engine. */
enum status play_world(struct hard_play *play) MUST_USE;

#endif
