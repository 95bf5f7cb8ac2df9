/* Layout obb8: 144-byte nodes of 8 children with boxes and oriented boxes. See
 * ref/layouts/layout_obb8.c for the words. */
#define WIDE 8u
#define WIDE_MISSES
#include "frame_node.glsl"

#define OBB_BESIDE       0.000003814697265625 /* 2^-18 */
#define OBB_BESIDE_LEAST 1.577721810442023610823457501e-30 /* 2^-99 */
#define OBB_SLACK        0.000003814697265625 /* 2^-18 */
#define OBB_PARALLEL     7.888609052210118054117285652e-31 /* 2^-100 */

/* An inner node: its nine quads, and the steps of its frames. */
struct wide {
    uvec4 head; /* origin, exponents */
    uvec4 base; /* first node, first item, kinds of the children, exponents along axes */
    uvec4 tilt; /* origin along axes, components of axes */
    uvec4 lo_xy, lo_z_hi_x, hi_yz;
    uvec4 lo_01, lo_2_hi_0, hi_12;
    vec3 step_size, tilt_step;
};

wide wide_load(node n)
{
    wide w;
    uint at = 9u * n.a;
    w.head = NODE_QUAD(at);
    w.base = NODE_QUAD(at + 1u);
    w.tilt = NODE_QUAD(at + 2u);
    w.lo_xy = NODE_QUAD(at + 3u);
    w.lo_z_hi_x = NODE_QUAD(at + 4u);
    w.hi_yz = NODE_QUAD(at + 5u);
    w.lo_01 = NODE_QUAD(at + 6u);
    w.lo_2_hi_0 = NODE_QUAD(at + 7u);
    w.hi_12 = NODE_QUAD(at + 8u);
    w.step_size = frame_steps(w.head);
    w.tilt_step = frame_steps(w.base);
    return w;
}

/* Returns the codes of a child in three quads: lower ones, then upper ones. */
void obb_codes(uvec4 a, uvec4 b, uvec4 c, uint slot, out uvec3 lo, out uvec3 hi)
{
    uint shift = (slot & 3u) << 3;
    bool low = slot < 4u;
    lo = uvec3(pick(low, a.x, a.y), pick(low, a.z, a.w), pick(low, b.x, b.y));
    hi = uvec3(pick(low, b.z, b.w), pick(low, c.x, c.y), pick(low, c.z, c.w));
    lo = (lo >> shift) & 0xFFu;
    hi = (hi >> shift) & 0xFFu;
}

/* Returns the lowest bits of all nibbles that are 15. */
uint full_nibbles(uint word)
{
    return word & (word >> 1) & (word >> 2) & (word >> 3) & 0x11111111u;
}

/* The sum of the nibbles of a word. */
uint sum_nibbles(uint word)
{
    uint bytes = (word & 0x0F0F0F0Fu) + ((word >> 4) & 0x0F0F0F0Fu);
    return (bytes * 0x01010101u) >> 24;
}

node wide_child(slab_ray r, wide w, uint slot, out vec3 nearer, out vec3 farther)
{
    uvec3 lo, hi;
    obb_codes(w.lo_xy, w.lo_z_hi_x, w.hi_yz, slot, lo, hi);
    frame_order(r, w.head, w.step_size, lo, hi, nearer, farther);
    uint kind = (w.base.z >> (slot << 2)) & 15u;
    uint before = w.base.z & ((1u << (slot << 2)) - 1u);
    uint nodes = full_nibbles(before);
    uint items = sum_nibbles(before & ~(nodes * 15u));
    bool inner = kind == 15u;
    return node(pick(inner, w.base.x + uint(bitCount(nodes)), NODE_LEAF | kind),
                pick(inner, 0u, w.base.y + items));
}

/* Returns four bits with a sign. */
float obb_component(uint four)
{
    return float(int((four & 15u) ^ 8u) - 8);
}

/* The product of an axis and a vector. */
float obb_along(vec3 axis, vec3 v)
{
    precise vec3 each = axis * v;
    precise float two = each.x + each.y;
    precise float all = two + each.z;
    return all;
}

/* Narrows a range of distances to those between two planes along an axis; false: there are none. */
bool obb_narrow(float lo, float hi, float beside, float org, float dir, inout float near,
                inout float far)
{
    precise float less = lo - beside;
    precise float more = hi + beside;
    bool crossing = any(bvec2(dir >= OBB_PARALLEL, dir <= -OBB_PARALLEL));
    precise float inv = 1.0 / dir;
    precise float a = (less - org) * inv;
    precise float b = (more - org) * inv;
    float first = pick(a < b, a, b);
    float last = pick(a < b, b, a);
    near = pick(both(crossing, first > near), first, near);
    far = pick(both(crossing, last < far), last, far);
    return any(bvec2(crossing, !any(bvec2(org < less, org > more))));
}

/* Without the sign, by its bit. */
vec3 obb_abs(vec3 x)
{
    return uintBitsToFloat(floatBitsToUint(x) & 0x7FFFFFFFu);
}

float obb_abs(float x)
{
    return uintBitsToFloat(floatBitsToUint(x) & 0x7FFFFFFFu);
}

/* Narrows by one axis. `reach`: how far points of the node and the origin lie from 0. */
bool obb_axis(slab_ray r, vec3 axis, vec3 reach, float origin, float step_size, uint lo, uint hi,
              inout float near, inout float far)
{
    vec3 size = obb_abs(axis);
    precise float sum = size.x + size.y;
    precise float sizes = sum + size.z;
    precise float beside = obb_along(size, reach) * OBB_BESIDE + sizes * r.by;
    precise float more = beside + OBB_BESIDE_LEAST;
    precise float lower = origin + float(lo) * step_size;
    precise float upper = origin + float(hi) * step_size;
    return obb_narrow(lower, upper, more, obb_along(axis, r.o), obb_along(axis, r.d), near, far);
}

bool wide_misses(slab_ray r, wide w, uint slot, float tbest)
{
    uvec3 lo, hi;
    obb_codes(w.lo_01, w.lo_2_hi_0, w.hi_12, slot, lo, hi);
    precise float least = r.tmin * SLAB_NEAR;
    precise float near = least - r.behind;
    float far = tbest;
    precise vec3 extent = 255.0 * w.step_size;
    precise vec3 reach = obb_abs(uintBitsToFloat(w.head.xyz)) + extent;
    precise vec3 all = reach + obb_abs(r.o);
    vec3 origin = uintBitsToFloat(w.tilt.xyz);
    uint c = w.tilt.w;
    vec3 axis0 = vec3(obb_component(c), obb_component(c >> 4), obb_component(c >> 8));
    vec3 axis1 = vec3(obb_component(c >> 12), obb_component(c >> 16), obb_component(c >> 20));
    vec3 axis2 = vec3(obb_component(c >> 24), obb_component(c >> 28),
                      obb_component(w.base.w >> 24));
    bool in0 = obb_axis(r, axis0, all, origin.x, w.tilt_step.x, lo.x, hi.x, near, far);
    bool in1 = obb_axis(r, axis1, all, origin.y, w.tilt_step.y, lo.y, hi.y, near, far);
    bool in2 = obb_axis(r, axis2, all, origin.z, w.tilt_step.z, lo.z, hi.z, near, far);
    precise float from = near - obb_abs(near) * OBB_SLACK;
    precise float to = far + obb_abs(far) * OBB_SLACK;
    bool apart = any(bvec2(!both(in0, in1, in2), from > to));
    return both((w.head.w & 0x1000000u) != 0u, apart);
}

#include "wide.glsl"
