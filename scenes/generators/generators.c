#include "scenes/generators/pen.h"
#include "scenes/spec.h"

#include "counts.h"

#include <string.h>

extern const struct generator gen_soup, gen_sphere, gen_flake, gen_terrain, gen_grid, gen_cornell,
    gen_platonic, gen_needles, gen_stack, gen_rtrs;

const struct generator *const generators[] = {&gen_soup,  &gen_sphere,  &gen_flake,    &gen_terrain,
                                              &gen_grid,  &gen_cornell, &gen_platonic, &gen_needles,
                                              &gen_stack, &gen_rtrs,    NULL};

_Static_assert(ARRAY_COUNT(generators) - 1 == GENERATOR_FILES,
               "every scenes/generators/gen_*.c is in the table, and nothing else");

const struct generator *generator_find(const char *name)
{
    for (size_t i = 0; generators[i]; i++)
        if (strcmp(generators[i]->name, name) == 0)
            return generators[i];
    return NULL;
}

enum status generator_make(const struct generator *generator, const double *value, uint64_t seed,
                           struct scene *out, struct reason *reason)
{
    struct pen pen = {.generator = generator, .scene = out, .rng = rng_make(seed, 0)};
    *out = (struct scene){0};
    const struct spec_maker maker = {generator->name, generator->param};
    enum status status = spec_check(&maker, value, reason);
    if (!status)
        status = generator->make(&pen, value, reason);
    if (status)
        scene_free(out);
    return status;
}
