/* Facts about a scene's triangles. */
#ifndef FACTS_H
#define FACTS_H

#include "ref/scene/scene.h"

struct facts {
    struct box bounds;
    float extent;       /* longest side of the bounds; 0 without triangles, may be infinite */
    float largest;      /* largest |coordinate| of any triangle corner */
    uint32_t zero_area; /* triangles whose corners lie on a line or coincide */
    uint32_t duplicate; /* triangles equal to an earlier one: the same three corner positions in
                         * any order; -0 equals 0 */
};

/* Zero area is decided by comparing products rounded to double, so a very thin triangle may count.
 * Coordinate differences are exact unless the coordinates of one triangle differ by a factor of
 * more than 2^28. Errors: STATUS_MEMORY. */
enum status facts_make(const struct scene *scene, struct facts *out) MUST_USE;

#endif
