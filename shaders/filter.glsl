/* Which candidates that are not opaque count: filter_passes of ref/world/world.c, for the shaders
 * that trace worlds. */
#ifndef FILTER_GLSL
#define FILTER_GLSL

#include "job.glsl"

uint filter_stir(uint hash, uint number)
{
    hash ^= number;
    hash ^= hash >> 16;
    hash *= 0x85EBCA6Bu;
    hash ^= hash >> 13;
    hash *= 0xC2B2AE35u;
    return hash ^ hash >> 16;
}

/* The cell of a coordinate on a grid of four: how many of its inner lines are at or below it. */
uint filter_cell(float x)
{
    precise float scaled = x * float(ABI_FILTER_GRID);
    return pick(scaled >= 1.0, 1u, 0u) + pick(scaled >= 2.0, 1u, 0u) + pick(scaled >= 3.0, 1u, 0u);
}

/* `tri` counts from the first triangle of the geometry. */
bool filter_passes(uint index, uint geometry, uint tri, vec2 uv)
{
    uint hash = filter_stir(world.filter_seed, index);
    hash = filter_stir(hash, geometry);
    hash = filter_stir(hash, tri);
    uint cell = filter_cell(uv.x) * ABI_FILTER_GRID + filter_cell(uv.y);
    hash = pick(world.filter_kind == ABI_FILTER_CELLS, filter_stir(hash, cell), hash);
    bool passes = both((hash & 0xFFu) < world.filter_share, world.filter_kind != ABI_FILTER_NONE);
    return any(bvec2(passes, world.filter_kind == ABI_FILTER_ALL));
}

#endif
