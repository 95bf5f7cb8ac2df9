/* A closed box whose walls are instances of one open mesh: seams between instances that touch. */
#include "scenes/worlds/placer.h"

static enum status add_square(struct placer *placer, uint32_t n, struct reason *reason)
{
    struct scene scene;
    if (scene_make((n + 1) * (n + 1), 2 * n * n, &scene))
        return fail(reason, STATUS_MEMORY, "no memory for a wall");
    for (uint32_t i = 0; i < (n + 1) * (n + 1); i++) {
        scene.vertex[3 * i] = 2 * (float)(i % (n + 1)) - (float)n;
        scene.vertex[3 * i + 1] = 2 * (float)(i / (n + 1)) - (float)n;
        scene.vertex[3 * i + 2] = (float)n;
    }
    for (uint32_t i = 0; i < n * n; i++) {
        const uint32_t a = i % n + i / n * (n + 1), b = a + 1, c = a + n + 1, d = c + 1;
        const uint32_t index[6] = {a, b, d, a, d, c};
        for (uint32_t k = 0; k < 6; k++)
            scene.index[6 * i + k] = index[k];
    }
    return placer_mesh(placer, &scene, reason);
}

/* Rotations that take the wall z = n to the six sides. */
static enum status make_room(struct placer *placer, const double *value, struct reason *reason)
{
    static const struct linear sides[6] = {
        {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},
        {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0, -1}, {1, 0, 0}, {0, -1, 0}}},
        {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}, {{{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}}}};
    const double t[3] = {value[1], value[1], value[1]};
    enum status status = placer_start(placer, 1, 6, reason);
    if (!status)
        status = add_square(placer, (uint32_t)value[0], reason);
    for (int i = 0; i < 6 && !status; i++)
        placer_add(placer, 0, &sides[i], t);
    return status;
}

/* Coordinates are whole numbers below 2^24. */
const struct world_generator gen_room = {
    .name = "room",
    .summary = "six walls, each an instance of one square: closed only together",
    .param = {{"n", "each wall is n x n quads", 4, 1, 512, true},
              {"offset", "added to every coordinate", 0, -8000000, 8000000, true}},
    .make = make_room,
    .seedless = true,
    .undrawn = true,
};
