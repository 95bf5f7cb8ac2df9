/* Triangle tests as tracers ship them, for a judge that does not know which: written from their
 * public descriptions, each compiled as its users would. */
#ifndef TESTS_HONEST_H
#define TESTS_HONEST_H

#include "ref/abi.h"

#include <stdbool.h>
#include <stddef.h>

struct honest {
    const char *name;
    /* True if the ray hits the triangle in its range; *out then has t, u and v. */
    bool (*hits)(const struct ray *ray, const float v[3][3], struct hit *out);
};

#define HONEST_PLAIN 4
#define HONEST_FAST  2

extern const struct honest honest_plain[HONEST_PLAIN];
extern const struct honest honest_fast[HONEST_FAST]; /* with -ffast-math, and fused where it can */

/* False: this processor has no fused operations, which honest_fast was compiled with. */
bool honest_fast_runs(void);

#endif
