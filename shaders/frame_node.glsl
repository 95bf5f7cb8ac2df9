/* Shared by layouts cwbvh80 and tiny8. The first four words of their nodes are a frame: an origin,
 * and the exponents of the steps plus 127. The planes of the children's boxes are counted in these
 * steps. */
#ifndef FRAME_NODE_GLSL
#define FRAME_NODE_GLSL

#include "wide_leaf.glsl"

node node_of(uint ref)
{
    return node(ref, 0u);
}

/* Returns 2^(exponent - 127); exponent is a byte. */
float step_of(uint exponent)
{
    return uintBitsToFloat(exponent << 23);
}

vec3 frame_steps(uvec4 head)
{
    return vec3(step_of(head.w & 0xFFu), step_of((head.w >> 8) & 0xFFu),
                step_of((head.w >> 16) & 0xFFu));
}

/* Returns the planes lo and hi in the order in which the ray meets them. */
void frame_order(slab_ray r, uvec4 head, vec3 step_size, uvec3 lo, uvec3 hi, out vec3 nearer,
                 out vec3 farther)
{
    precise vec3 lower = uintBitsToFloat(head.xyz) + vec3(lo) * step_size;
    precise vec3 upper = uintBitsToFloat(head.xyz) + vec3(hi) * step_size;
    slab_order(r, lower, upper, nearer, farther);
}

#endif
