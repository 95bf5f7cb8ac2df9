/* One line on a finding of a ray. */
#include "fuzz/play/player.h"

#include "ref/base/text.h"

#include <string.h>

/* Appends where placed triangle `prim` of a trial's world is. */
static void put_place(const struct trial_world *world, uint32_t prim, char *text, size_t size)
{
    uint32_t i = 0, first, count = 0, geometry = 0;
    if (prim == ABI_NO_PRIM) {
        text_append(text, size, " nothing");
        return;
    }
    for (; i < world->instance_count; i++, prim -= count) {
        trial_world_mesh(world, world->instance[i].mesh, &first, &count);
        if (prim < count)
            break;
    }
    if (i == world->instance_count) {
        text_append(text, size, " no triangle of the world");
        return;
    }
    for (uint32_t g = 0; g < world->geometry_count; g++) {
        if (world->geometry[g].mesh != world->instance[i].mesh)
            continue;
        if (prim < world->geometry[g].count)
            break;
        prim -= world->geometry[g].count;
        geometry++;
    }
    text_append(text, size, " instance %u geometry %u triangle %u", i, geometry, prim);
}

void fuzz_finding_line(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                       char *text, size_t size)
{
    const struct trial_world *world = &trial->world;
    judge_line(&trial->ray[finding->ray], &finding->judgement, &finding->answer, text, size);
    if (!world->is)
        return;
    const struct ray_mode mode = world->mode[finding->ray];
    text_append(text, size, "; mask 0x%02X flags 0x%X, got", mode.mask, mode.flags);
    put_place(world, finding->answer.prim, text, size);
    if (finding->answer.prim != ABI_NO_PRIM || finding->tag != 0)
        text_append(text, size, " custom %u %s", finding->tag & ABI_TAG_CUSTOM,
                    finding->tag & ABI_TAG_FRONT ? "front" : "back");
    text_append(text, size, ", expected");
    put_place(world, finding->judgement.expected, text, size);
}
