#include "scenes/spec.h"
#include "scenes/worlds/placer.h"

#include <string.h>

extern const struct world_generator gen_placed_identity, gen_placed_far, gen_placed_turned,
    gen_placed_scaled, gen_placed_tiny, gen_placed_stretched, gen_placed_mirrored,
    gen_placed_sheared, gen_placed_thin, gen_wall, gen_nest, gen_crowd, gen_twins, gen_room,
    gen_mixed;

const struct world_generator *const world_generators[] = {&gen_placed_identity,
                                                          &gen_placed_far,
                                                          &gen_placed_turned,
                                                          &gen_placed_scaled,
                                                          &gen_placed_tiny,
                                                          &gen_placed_stretched,
                                                          &gen_placed_mirrored,
                                                          &gen_placed_sheared,
                                                          &gen_placed_thin,
                                                          &gen_wall,
                                                          &gen_nest,
                                                          &gen_crowd,
                                                          &gen_twins,
                                                          &gen_room,
                                                          &gen_mixed,
                                                          NULL};

const struct world_generator *world_generator_find(const char *name)
{
    for (size_t i = 0; world_generators[i]; i++)
        if (strcmp(world_generators[i]->name, name) == 0)
            return world_generators[i];
    return NULL;
}

enum status world_generator_make(const struct world_generator *generator, const double *value,
                                 uint64_t seed, struct world *out, struct reason *reason)
{
    struct placer placer = {.world = out, .rng = rng_make(seed, 0)};
    const struct spec_maker maker = {generator->name, generator->param};
    *out = (struct world){0};
    enum status status = spec_check(&maker, value, reason);
    if (!status)
        status = generator->make(&placer, value, reason);
    if (!status)
        status = world_finish(out, reason);
    if (status)
        world_free(out);
    return status;
}
