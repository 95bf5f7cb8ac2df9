#include "scenes/scenes.h"

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
