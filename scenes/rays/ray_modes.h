/* What rays may meet of a world, drawn. */
#ifndef RAY_MODES_H
#define RAY_MODES_H

#include "ref/world/world.h"

enum ray_modes {
    RAY_MODES_ALL,   /* every instance and triangle */
    RAY_MODES_MIXED, /* of even rays ALL, of the others DRAWN */
    RAY_MODES_DRAWN, /* masks and flags at random, as ray_mode_check takes them */
    RAY_MODES_COUNT
};

/* "all", "mixed", "drawn"; NULL for another number. */
const char *ray_modes_name(enum ray_modes modes);

/* Draws the modes of `count` rays; number i depends on `seed` and i alone. */
void ray_modes_make(enum ray_modes modes, uint64_t seed, size_t count, struct ray_mode *out);

#endif
