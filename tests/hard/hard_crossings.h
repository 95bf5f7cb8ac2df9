/* All crossings of closed meshes, see HARD_PARITY. */
#ifndef HARD_CROSSINGS_H
#define HARD_CROSSINGS_H

#include "tests/hard/hard_check.h"

/* Lists all hits of every ray and compares them with the oracle's where these are clear: an even
 * number, each listed once, nothing else. Errors: STATUS_UNSUPPORTED the engine cannot list;
 * STATUS_MEMORY; the engine's. */
enum status play_crossings(struct hard_play *play) MUST_USE;

#endif
