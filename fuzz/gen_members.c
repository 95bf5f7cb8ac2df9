#include "fuzz/gen_members.h"

#include "fuzz/gen_sketch.h"

/* One of the members of a table that may take part, all alike. */
#define CHOOSER(function, type, table)                                                             \
    const struct type *function(struct rng *rng, bool faithful)                                    \
    {                                                                                              \
        uint32_t allowed = 0;                                                                      \
        for (size_t i = 0; (table)[i]; i++)                                                        \
            allowed += faithful || !(table)[i]->faithful;                                          \
        uint32_t skip = rng_below(rng, allowed);                                                   \
        for (size_t i = 0;; i++)                                                                   \
            if ((faithful || !(table)[i]->faithful) && skip-- == 0)                                \
                return (table)[i];                                                                 \
    }

CHOOSER(gen_builder, builder, builders)
CHOOSER(gen_box_test, box_test, box_tests)
CHOOSER(gen_tri_test, tri_test, tri_tests)

uint32_t gen_leaf(struct rng *rng, bool faithful)
{
    static const uint8_t often[] = {4, 4, 4, 4, 4, 1, 1, 2, 2, 3, 5, 6, 7, 8, 8, 8};
    uint32_t beyond = 9 + rng_below(rng, 8);
    uint32_t leaf = often[rng_below(rng, ARRAY_COUNT(often))];
    return rng_below(rng, 32) == 0 && faithful ? beyond : leaf;
}

float gen_eps(struct rng *rng)
{
    uint32_t how = rng_below(rng, 4);
    int exponent = (int)rng_below(rng, 31);
    return how < 2 ? BUILD_EPS_DEFAULT : how == 2 ? 0.0f : power_of_two(-exponent);
}
