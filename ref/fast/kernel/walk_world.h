/* The traversal of worlds, compiled with each kernel. Included by ref/fast/kernel/walk.h. */

/* The best hit of a world. Of a ray that fast_careful_instance traced in an instance it is `hit`.
 * */
struct walk_world_best {
    struct walk_best in;
    struct hit hit;
    uint32_t tag, instance;
};

/* transform_ray (ref/world/object_ray.h), the same operations on vectors. */
INLINE void enter_ray(const struct fast_instance *instance, const struct ray *ray,
                      struct ray *inside)
{
    float4 column[3], o, d;
    if (instance->flags & ABI_INSTANCE_IDENTITY) {
        *inside = *ray;
        return;
    }
    memcpy(column, instance->column, sizeof column);
    o = all4(ray->org[0] - instance->column[0][3]) * column[0];
    o = o + all4(ray->org[1] - instance->column[1][3]) * column[1];
    o = o + all4(ray->org[2] - instance->column[2][3]) * column[2];
    d = all4(ray->dir[0]) * column[0] + all4(ray->dir[1]) * column[1];
    d = d + all4(ray->dir[2]) * column[2];
    o[3] = ray->tmin;
    d[3] = ray->tmax;
    memcpy((char *)inside + offsetof(struct ray, org), &o, sizeof o);
    memcpy((char *)inside + offsetof(struct ray, dir), &d, sizeof d);
}

/* Traverses one instance. Returns true if the ray hits something nearer there. */
INLINE bool enter(const struct fast_world *fast, const struct walk_ray *top, const struct ray *ray,
                  struct ray_mode mode, bool any, bool all_count, uint32_t index,
                  struct walk_world_best *best)
{
    const struct fast_instance *instance = &fast->instance[index];
    const struct instance_at at = {fast->world, &fast->record[index], index, mode};
    struct walk_ray r;
    struct ray inside;
    if ((instance->custom_mask >> 24 & mode.mask) == 0)
        return false;
    enter_ray(instance, ray, &inside);
    const struct fast_tree *tree = &fast->bottom[instance->mesh];
    if (!prepare(&r, tree, &inside)) {
        bool none = best->instance == ABI_NO_PRIM;
        struct hit hit = {.t = best->in.t, .prim = none ? ABI_NO_PRIM : ABI_PHANTOM};
        if (!fast_careful_instance(fast, index, &inside, mode, any, &hit, &best->tag))
            return false;
        best->hit = hit;
        best->in.block = NULL;
        best->in.t = hit.t;
        best->instance = index;
        return true;
    }
    narrow(&r, top->tlimit);
    const uint32_t *before = best->in.block;
    best->in.block = NULL;
    walk_tree(&r, tree, any, all_count ? NULL : &at, &inside, &best->in);
    if (!best->in.block) {
        best->in.block = before;
        return false;
    }
    best->instance = index;
    return true;
}

/* Facing by candidate_side, on the vertices as the block has them. */
INLINE void write_world_hit(const struct fast_world *fast, const struct ray *ray,
                            const struct walk_world_best *best, struct hit *hit, uint32_t *tag)
{
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    *tag = 0;
    if (best->instance == ABI_NO_PRIM)
        return;
    *hit = best->hit;
    *tag = best->tag;
    if (!best->in.block)
        return;
    const struct fast_instance *instance = &fast->instance[best->instance];
    struct ray inside;
    float v[3][3];
    enter_ray(instance, ray, &inside);
    write_hit(NULL, &best->in, hit);
    for (int c = 0; c < 3; c++)
        block_corner(best->in.block, best->in.part, best->in.lane, c, v[c]);
    bool front = (candidate_side(inside.dir, v) < 0.0f) !=
                 ((instance->flags & ABI_INSTANCE_FLIP_FACING) != 0);
    hit->prim += instance->first;
    *tag = (instance->custom_mask & ABI_TAG_CUSTOM) | (front ? ABI_TAG_FRONT : 0);
}

INLINE void walk_world(const struct fast_world *fast, const struct ray *ray, struct ray_mode mode,
                       bool any, bool all_count, struct hit *hit, uint32_t *tag)
{
    struct walk_ray top;
    struct walk_world_best best = {.in = {.block = NULL}, .instance = ABI_NO_PRIM};
    struct walk_stack stack;
    struct walk_place at = {0, 0};
    if (!prepare(&top, &fast->top, ray)) {
        fast_careful_world(fast, ray, mode, any, hit, tag);
        return;
    }
    do {
        while (!(at.now & FAST_LEAF))
            if (!descend(&top, &fast->top, any, &stack, &at))
                goto missed;
        if (enter(fast, &top, ray, mode, any, all_count, at.now & ~FAST_LEAF, &best)) {
            if (any)
                break;
            narrow(&top, best.in.t);
        }
    missed:;
    } while (pop(&top, any, &stack, &at));
    write_world_hit(fast, ray, &best, hit, tag);
}

/* Flags that leave every triangle what it is in a world that is plain. */
#define WALK_PLAIN (ABI_RAY_OPAQUE | ABI_RAY_FIRST | ABI_RAY_SKIP_CLOSEST)

KERNEL_TARGET static void trace_world(const struct fast_world *fast, const struct ray *ray,
                                      const struct ray_mode *mode, size_t count, bool any,
                                      struct hit *hit, uint32_t *tag)
{
    for (size_t i = 0; i < count; i++) {
        struct ray_mode own = mode ? mode[i] : ray_mode_all();
        bool plain = fast->plain && (own.flags & ~WALK_PLAIN) == 0;
        bool first = any || (own.flags & ABI_RAY_FIRST) != 0;
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        tag[i] = 0;
        if (fast->top.node_count == 0 || (own.flags & ABI_RAY_SKIP_TRIANGLES))
            continue;
        if (plain && !first)
            walk_world(fast, &ray[i], own, false, true, &hit[i], &tag[i]);
        else if (plain)
            walk_world(fast, &ray[i], own, true, true, &hit[i], &tag[i]);
        else if (!first)
            walk_world(fast, &ray[i], own, false, false, &hit[i], &tag[i]);
        else
            walk_world(fast, &ray[i], own, true, false, &hit[i], &tag[i]);
    }
}
