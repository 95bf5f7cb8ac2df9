/* Tracing of worlds, one ray per invocation, in the order of work of ref/trace/trace_world.h: one
 * loop for both levels, with one stack. */
#include "walk.glsl"
#include "world_instance.glsl"

/* The ray in the world, and what it may meet. */
vec4 world_org, world_dir;
uvec2 world_mode;

/* The best hit, and the number of hits that count. */
vec3 best = vec3(0.0);
uint best_prim = ABI_NO_PRIM, best_tag = 0u;
float tbest;
uint found = 0u, found_at = 0u;

/* Where the ray is: in the top, or in an instance. */
bool inside = false;
instance at;
slab_ray slab;
tri_ray tri;
uint visits = 0u;

/* What waits in the top meanwhile. */
slab_ray top_slab;
uint top_visits = 0u;
leaf top_leaf;
uint top_slot = 0u, top_items = 0u;

/* The item of a leaf of the top, which is stored by `indexed` whatever the storage of meshes. */
uint top_item(uint slot)
{
#ifdef STORE_GLSL
    uint place = top_leaf.first + slot;
    return place < job.item_count ? ITEM_WORD(place) : ABI_NO_PRIM;
#else
    return leaf_item(top_leaf, slot);
#endif
}

/* Keeps a hit that counts. Returns true if it ends the ray. */
bool keep(uint query, vec3 tuv, uint prim, uint tag)
{
    if (QUERY == ABI_QUERY_ALL) {
        if (found < world.capacity) {
            uint place = ABI_WORLD_HIT * (found_at + found);
            hit_quad[place] = uvec4(floatBitsToUint(tuv), at.first + prim);
            hit_quad[place + 1u] = uvec4(tag, 0u, 0u, 0u);
        }
        found++;
    } else {
        best = tuv;
        best_prim = at.first + prim;
        best_tag = tag;
        tbest = tuv.x;
    }
    return query == ABI_QUERY_ANY;
}

/* Tests the items of a leaf of a mesh in slot order. Returns true if the ray is finished. */
bool step_mesh_leaf(uint query, node n)
{
    leaf l = leaf_load(n);
    uint slot = 0u;
    bool answered = false;
    while (both(slot < l.count, !answered)) {
        uint prim = leaf_item(l, slot);
        if (prim < job.tri_count) {
            vec3 tuv;
            uint tag;
            bool hit = leaf_test(l, slot, prim, tri, tuv);
            bool nearer = any(bvec2(best_prim == ABI_NO_PRIM, tuv.x < tbest));
            if (both(hit, nearer)) {
                if (candidate_counts(at, world_mode.y, tri.d, prim, tuv, tag))
                    answered = keep(query, tuv, prim, tag);
            }
        }
        slot++;
    }
    if (both(slot < l.count, !answered))
        trouble |= ABI_FLAG_LOOP;
    return answered;
}

/* Returns the root of the tree in use if the ray meets its box, else NODE_DONE. */
node enter_tree()
{
    vec3 nearer, farther;
    float entry;
    node n = NODE_DONE;
    if (job.node_count > 0u) {
        node root = node_load(slab, job.root, nearer, farther);
        slab_ray_place(slab, nearer);
        if (slab_test(slab, nearer, farther, tbest, entry))
            n = root;
    }
    return n;
}

/* How much wider the boxes of the top are tested if it has parts: braid_width of
 * ref/two_level/braid.h. */
float top_width(vec3 o)
{
    vec3 a = slab_select(lessThan(o, vec3(0.0)), -o, o);
    float largest = 0.0;
    largest = pick(a.x > largest, a.x, largest);
    largest = pick(a.y > largest, a.y, largest);
    largest = pick(a.z > largest, a.z, largest);
    precise float sum = largest + world.reach;
    precise float width = world.share * sum;
    return width;
}

/* Enters the next instance, or part of one, of the leaf of the top that the ray meets, or goes back
 * in the top. */
node step_top()
{
    bool entered = false;
    node n = NODE_DONE;
    while (both(top_slot < top_items, !entered)) {
        uint index = top_item(top_slot);
        top_slot++;
        if (index < world.entry_count) {
            at = instance_load(index);
            entered = instance_is_met(at, world_mode);
        }
    }
    if (both(top_slot < top_items, !entered))
        trouble |= ABI_FLAG_LOOP;
    if (entered) {
        vec3 o, d;
        instance_ray(at, world_org.xyz, world_dir.xyz, o, d);
        tree_use(1u + at.mesh);
        inside = true;
        stack_base = stack_count;
        top_visits = visits;
        visits = 0u;
        slab = slab_ray_make(o, d, world_org.w);
        tri = tri_ray_make(o, d, world_org.w, world_dir.w);
        n = enter_tree();
    } else {
        n = walk_back(slab, tbest);
    }
    return n;
}

/* Returns to the leaf of the top. */
void leave_instance()
{
    tree_use(0u);
    inside = false;
    stack_base = 0u;
    visits = top_visits;
    slab = top_slab;
}

/* As walk() of one tree; a mesh that is done leads back to the top. */
void walk_world(uint query)
{
    node n = enter_tree();
    top_slab = slab;
    walk_begin();
    bool finished = node_is_done(n);
    while (both(!finished, trouble == 0u)) {
        while (both(!node_is_leaf(n), visits < job.node_count)) {
            visits++;
            n = step_inner(slab, n, tbest);
        }
        if (!node_is_leaf(n)) {
            trouble |= visits < job.node_count ? ABI_FLAG_LOOP : ABI_FLAG_VISITS;
        } else if (node_is_done(n)) {
            finished = !inside;
            if (inside) {
                leave_instance();
                n = step_top();
            }
        } else {
            if (visits >= job.node_count)
                trouble |= ABI_FLAG_VISITS;
            visits++;
            if (inside) {
                finished = step_mesh_leaf(query, n);
                n = walk_back(slab, tbest);
            } else {
                top_leaf = leaf_load(n);
                top_items = top_leaf.count;
                top_slot = 0u;
                n = step_top();
            }
        }
    }
    if (!finished)
        trouble |= trouble == 0u ? ABI_FLAG_LOOP : 0u;
}

void main()
{
    uint id = gl_GlobalInvocationID.x;
    if (id >= world.ray_count)
        return;
    world_org = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id]);
    world_dir = uintBitsToFloat(ray_quad[ABI_WORLD_RAY * id + 1u]);
    world_mode = ray_quad[ABI_WORLD_RAY * id + 2u].xy;
    found_at = id * world.capacity;
    tbest = world_dir.w;
    bool first = (world_mode.y & ABI_RAY_FIRST) != 0u;
    uint query = pick(both(first, QUERY == ABI_QUERY_CLOSEST), ABI_QUERY_ANY, QUERY);
    tree_use(0u);
    slab = slab_ray_make(world_org.xyz, world_dir.xyz, world_org.w);
    slab_ray_widen(slab, top_width(world_org.xyz));
    walk_world(query);
    if (QUERY == ABI_QUERY_ALL) {
        found_word[id] = found;
    } else {
        hit_quad[ABI_WORLD_HIT * id] = uvec4(floatBitsToUint(best), best_prim);
        hit_quad[ABI_WORLD_HIT * id + 1u] = uvec4(best_tag, 0u, 0u, 0u);
    }
    flag_word[id] = ABI_FLAG_DONE | trouble | (trouble != 0u ? ABI_FLAG_EXHAUSTED : 0u);
}
