/* Rendering (ref/frame.h), one pixel per invocation: all rays of its path, or one of them. There is
 * a single call that traces rays, whatever their query, because drivers inline every call: two
 * calls double the code, and one driver takes minutes to compile that. A driver can also end a loop
 * before its condition does (lavapipe 22 after 65,535 iterations of all loops of an invocation), so
 * every loop's condition is checked again after the loop. */
#include "render_state.glsl"

void record(uint slot, uint i, float t, uint prim, lit l)
{
    if (has(ABI_LOOK_SEGMENTS))
        segment_quad[slot * bounce_count() + i] =
            uvec4(floatBitsToUint(t), prim, l.asked, l.shadowed);
}

/* Ends a path: writes its pixel, flags and recordings. */
void finish(uint slot, path p)
{
    uint i = p.segment;
    if (has(ABI_LOOK_SEGMENTS)) {
        while (i < bounce_count()) {
            record(slot, i, 0.0, ABI_NO_SEGMENT, LIT_NONE);
            i++;
        }
        if (i < bounce_count())
            trouble |= ABI_FLAG_LOOP;
    }
    uint flags = ABI_FLAG_DONE | trouble | (trouble != 0u ? ABI_FLAG_EXHAUSTED : 0u);
    pixel_word[slot] = channel(p.total.x) | channel(p.total.y) << 8 | channel(p.total.z) << 16 |
                       (flags | job.serial << ABI_FLAG_BITS) << 24;
    if (has(ABI_LOOK_COLORS)) {
        color_word[3u * slot] = p.total.x;
        color_word[3u * slot + 1u] = p.total.y;
        color_word[3u * slot + 2u] = p.total.z;
    }
}

/* Processes the hit of the path's ray. */
void path_take(uint slot, inout path p, vec3 tuv, uint prim)
{
    if (p.to_light) {
        light_add(p.s, p.along, p.dir, p.far, p.light, tuv.x, prim, p.l);
        p.light++;
        return;
    }
    p.more = prim != ABI_NO_PRIM;
    p.t = tuv.x;
    p.l = LIT_NONE;
    p.light = 0u;
    if (p.more) {
        p.s = surface_of(p.org, p.dir, tuv, prim);
    } else {
        record(slot, p.segment, p.t, prim, p.l);
        p.segment++;
    }
}

/* Sets the next ray: to the next light that gets a shadow ray, else that of the next segment. */
void path_aim(uint slot, inout path p)
{
    p.to_light = false;
    while (both(p.light < light_count(), !p.to_light)) {
        p.to_light = shadow_of(p.s, p.light, p.org, p.dir, p.far);
        p.light += uint(!p.to_light);
    }
    if (p.to_light)
        return;
    if (p.light < light_count())
        trouble |= ABI_FLAG_LOOP;
    material m = material_of(p.s.prim);
    p.total = total_with(p.total, m, p.l, p.weight, p.segment);
    record(slot, p.segment, p.t, p.s.prim, p.l);
    p.segment++;
    p.more = path_next(p.s, m, p.along, p.weight, p.org);
    p.more = both(p.more, has(ABI_LOOK_REFLECT), p.segment < bounce_count());
    p.dir = p.along;
}

/* Traces the path's ray. Returns false if other dispatches must test more triangles. */
bool path_ray(uint at, path p, out vec3 tuv, out uint prim)
{
    bool any_hit = both(p.to_light, repaired());
    uint query = pick(any_hit, ABI_QUERY_ANY, ABI_QUERY_CLOSEST);
    tuv = vec3(0.0);
    prim = ABI_NO_PRIM;
    if (both(STEPS, job.part_first > 0u)) {
        tuv = state_vec(at + 8u);
        prim = state_quad[at + 8u].w;
    }
    answer(query, p.org, p.dir, job.tmin, pick(any_hit, p.far, job.tmax), tuv, prim);
    bool part = both(STEPS, job.part_last < job.tri_count);
    if (part)
        state_put(at + 8u, tuv, prim);
    return !part;
}

/* Renders the path of a pixel, from its beginning or, if `later`, from its stored state. */
void pixel(uint slot, uint x, uint y, bool later)
{
    uint at = state_at(slot);
    path p;
    if (later)
        p = path_load(at);
    else
        p = path_begin(eye(), pixel_direction(x, y));
    bool alive = p.more, again = alive, taken = false;
    while (again) {
        vec3 tuv;
        uint prim;
        taken = path_ray(at, p, tuv, prim);
        if (taken) {
            path_take(slot, p, tuv, prim);
            if (p.more)
                path_aim(slot, p);
        }
        p.more = both(p.more, trouble == 0u);
        again = both(p.more, !STEPS);
    }
    if (both(!STEPS, p.more)) {
        trouble |= ABI_FLAG_LOOP;
        p.more = false;
    }
    if (both(STEPS, p.more))
        path_store(at, p);
    if (both(STEPS, p.more, taken))
        queue_add(slot);
    if (both(!p.more, any(bvec2(alive, bounce_count() == 0u)))) {
        if (STEPS)
            state_quad[at].w = 0u;
        finish(slot, p);
    }
}

void main()
{
    uint per_row = (job.width + TILE - 1u) / TILE;
    uint tile = job.first_tile + gl_WorkGroupID.x;
    uint row = tile / per_row * TILE + gl_LocalInvocationIndex / TILE;
    uint x = tile % per_row * TILE + gl_LocalInvocationIndex % TILE;
    uint y = job.first_row + row, slot = row * job.width + x;
    bool mine = both(x < job.width, y < job.height), queued = both(STEPS, job.ray > 0u);
    if (queued) {
        uint i = gl_GlobalInvocationID.x;
        mine = i < state_quad[job.ray].w;
        slot = state_quad[queue_at(job.ray, pick(mine, i, 0u))].w;
    }
    if (mine)
        pixel(slot, x, y, any(bvec2(queued, both(STEPS, job.part_first > 0u))));
}
