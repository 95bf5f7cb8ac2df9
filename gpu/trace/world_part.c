#include "gpu/trace/world_part.h"

#include "gpu/trace/dispatch.h"
#include "ref/world/world.h"

bool world_part_next(const struct world *world, struct world_push *push)
{
    const uint32_t count = world_tri_count(world);
    push->first = push->last;
    push->index = push->first < count ? world_instance_of(world, push->first) : 0;
    if (push->first >= count)
        return false;
    uint32_t left = world->instance_count - push->index;
    uint32_t most = world->first[push->index + (left < DISPATCH_PART ? left : DISPATCH_PART)];
    push->last = most - push->first < DISPATCH_PART ? most : push->first + DISPATCH_PART;
    return push->last < count;
}
