#include "scenes/rays/ray_modes.h"

#include "ref/base/rng.h"

#define STREAM 0x6D6F646573u /* apart from those of the rays themselves */

const char *ray_modes_name(enum ray_modes modes)
{
    static const char *const name[RAY_MODES_COUNT] = {"all", "mixed", "drawn"};
    return modes < RAY_MODES_COUNT ? name[modes] : NULL;
}

/* Half of the masks have all bits, the others one, or any. */
static uint32_t draw_mask(struct rng *rng)
{
    uint32_t kind = rng_below(rng, 4), bits = rng_below(rng, 256), bit = rng_below(rng, 8);
    return kind < 2 ? 0xFF : kind == 2 ? 1u << bit : bits;
}

static struct ray_mode draw_mode(struct rng *rng)
{
    static const uint32_t opacity[] = {
        0, 0, 0, ABI_RAY_OPAQUE, ABI_RAY_NO_OPAQUE, ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE};
    static const uint32_t facing[] = {0, 0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT};
    struct ray_mode mode = {.mask = draw_mask(rng)};
    mode.flags = opacity[rng_below(rng, ARRAY_COUNT(opacity))];
    mode.flags |= facing[rng_below(rng, ARRAY_COUNT(facing))];
    if (rng_below(rng, 8) == 0)
        mode.flags |= ABI_RAY_FIRST;
    if (rng_below(rng, 16) == 0)
        mode.flags |= ABI_RAY_SKIP_CLOSEST;
    if (rng_below(rng, 32) == 0)
        mode.flags =
            (mode.flags & ~(ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT)) | ABI_RAY_SKIP_TRIANGLES;
    return mode;
}

void ray_modes_make(enum ray_modes modes, uint64_t seed, size_t count, struct ray_mode *out)
{
    for (size_t i = 0; i < count; i++) {
        struct rng rng = rng_make(seed, STREAM + i);
        bool drawn = modes == RAY_MODES_DRAWN || (modes == RAY_MODES_MIXED && i % 2 == 1);
        out[i] = drawn ? draw_mode(&rng) : ray_mode_all();
    }
}
