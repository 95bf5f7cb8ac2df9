#include "bench/traffic/traffic_walk.h"

static void on_read(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    struct traffic_walker *w = reader;
    enum traffic_array at = (enum traffic_array)array;
    if (w->source == TRAFFIC_CACHED)
        traffic_access(w->memory, w->unit, TRAFFIC_L1, at, offset, bytes, false);
    else if (w->source == TRAFFIC_RESIDENT)
        traffic_on_chip(w->memory, at, bytes, false);
}

enum status traffic_walker_make(const struct job *job, uint64_t treelet, struct traffic_walker *out,
                                struct reason *reason)
{
    *out = (struct traffic_walker){.job = *job};
    enum status status = touch_make(job->packed, job->scene, false, NULL, &out->touch, reason);
    if (status)
        return status;
    if (job->packed->node_count == 0) {
        touch_free(&out->touch);
        return fail(reason, STATUS_INPUT, "no triangles");
    }
    out->root_box = job->packed->layout->box(job->packed, job->packed->root);
    status = treelets_make(&out->touch, treelet, &out->treelets, reason);
    if (status) {
        touch_free(&out->touch);
        return status;
    }
    out->touch.read = on_read;
    out->touch.reader = out;
    return STATUS_OK;
}

void traffic_walker_free(struct traffic_walker *walker)
{
    treelets_free(&walker->treelets);
    touch_free(&walker->touch);
}

static void set_ray(const struct traffic_walker *walker, struct traffic_lane *lane,
                    const struct ray *ray)
{
    struct walk *w = &lane->walk;
    walk_set_tree(w, &walker->touch.packed, walker->touch.scene);
    walk_set_ray(w, ray);
    slab_ray_place(&w->slab, &walker->root_box);
    w->decoded = NULL;
    w->parent = NULL;
    w->query = QUERY_CLOSEST;
    w->counts = (struct trace_counts){0};
    w->capacity = w->found = 0;
    lane->climbs = false;
}

enum traffic_end traffic_begin(struct traffic_walker *walker, struct traffic_lane *lane,
                               const struct ray *ray)
{
    float entry;
    set_ray(walker, lane, ray);
    lane->at = walker->job.packed->root;
    struct box root = walker->touch.packed.layout->box(&walker->touch.packed, lane->at);
    return box_test_run(walker->job.box->id, &lane->walk.slab, &root, lane->walk.tbest, &entry)
               ? TRAFFIC_MORE
               : TRAFFIC_DONE;
}

void traffic_enter(const struct traffic_walker *walker, struct traffic_lane *lane,
                   const struct ray *ray, uint32_t ref, const struct hit *best)
{
    set_ray(walker, lane, ray);
    lane->at = ref;
    if (best->prim != ABI_NO_PRIM) {
        lane->walk.best = *best;
        lane->walk.tbest = best->t;
    }
}

/* The stack grew or shrank from `before`. */
static inline void stack_moved(struct traffic_walker *walker, const struct traffic_lane *lane,
                               uint32_t before, uint32_t after)
{
    if (walker->trail == TRAFFIC_RESTART_TRAIL)
        return;
    bool write = after > before;
    uint32_t from = write ? before : after, to = write ? after : before;
    uint64_t base = (uint64_t)lane->slot * walker->job.packed->stack_need;
    if (walker->trail == TRAFFIC_STACK_ON_CHIP)
        traffic_on_chip(walker->memory, TRAFFIC_AT_STACKS, (to - from) * TRAFFIC_STACK_ENTRY,
                        write);
    else
        traffic_access(walker->memory, walker->unit, TRAFFIC_L1, TRAFFIC_AT_STACKS,
                       (base + from) * TRAFFIC_STACK_ENTRY, (to - from) * TRAFFIC_STACK_ENTRY,
                       write);
}

WALK_INLINE enum traffic_end pop(struct traffic_walker *walker, struct traffic_lane *lane,
                                 uint32_t box_id)
{
    struct walk *w = &lane->walk;
    uint32_t before = w->depth;
    bool more = walk_pop(w, box_id, &lane->at);
    stack_moved(walker, lane, before, w->depth);
    return more ? TRAFFIC_MORE : TRAFFIC_DONE;
}

/* As the loop of walk_tree, for one node. */
WALK_INLINE enum traffic_end visit(struct traffic_walker *walker, struct traffic_lane *lane,
                                   uint32_t box_id, uint32_t tri_id)
{
    struct walk *w = &lane->walk;
    struct wide node;
    uint32_t ref = lane->at, next = 0, before = w->depth;
    bool descend = false;
    walker->visits++;
    w->packed->layout->load(w->packed, ref, &node);
    if (node.child_count == 0)
        (void)walk_leaf(w, WALK_SCENE, tri_id, &node);
    else if (layout_is_wide(w->packed->layout) ? !walk_wide(w, box_id, ref, &node)
                                               : !walk_inner(w, box_id, &node, &next, &descend))
        return TRAFFIC_LIMIT;
    if (w->depth > before)
        stack_moved(walker, lane, before, w->depth);
    if (descend) {
        lane->at = next;
        return TRAFFIC_MORE;
    }
    enum traffic_end end = pop(walker, lane, box_id);
    lane->from = ref;
    lane->climbs = walker->trail == TRAFFIC_RESTART_TRAIL && end == TRAFFIC_MORE &&
                   walker->treelets.parent[lane->at] != ref;
    return end;
}

static void climb(struct traffic_walker *walker, struct traffic_lane *lane)
{
    const struct packed *packed = walker->job.packed;
    const struct scene_treelets *t = &walker->treelets;
    uint32_t way;
    walker->visits++;
    lane->from = t->parent[lane->from];
    on_read(walker, TOUCH_NODES,
            (uint64_t)touch_record(packed, lane->from, &way) * packed->layout->node_bytes,
            packed->layout->node_bytes);
    lane->climbs = lane->from != t->parent[lane->at];
}

enum traffic_end traffic_step(struct traffic_walker *walker, struct traffic_lane *lane)
{
    uint32_t box_id = walker->job.box->id, tri_id = walker->job.tri->id;
    if (lane->climbs) {
        climb(walker, lane);
        return TRAFFIC_MORE;
    }
    if (box_id == ABI_BOX_ROBUST && tri_id == ABI_TRI_MT)
        return visit(walker, lane, ABI_BOX_ROBUST, ABI_TRI_MT);
    return visit(walker, lane, box_id, tri_id);
}

enum traffic_end traffic_skip(struct traffic_walker *walker, struct traffic_lane *lane)
{
    return pop(walker, lane, walker->job.box->id);
}

void traffic_save(const struct traffic_lane *lane, struct traffic_waiting *out)
{
    const struct walk *w = &lane->walk;
    out->best = w->best;
    out->ray = lane->ray;
    out->at = lane->at;
    out->from = lane->from;
    out->climbs = lane->climbs;
    out->depth = w->depth;
    for (uint32_t i = 0; i < w->depth; i++)
        out->left[i] = (struct traffic_left){w->ref[i], w->entry[i]};
}

void traffic_restore(const struct traffic_walker *walker, const struct traffic_waiting *waiting,
                     const struct ray *ray, struct traffic_lane *lane)
{
    traffic_enter(walker, lane, ray, waiting->at, &waiting->best);
    lane->ray = waiting->ray;
    lane->from = waiting->from;
    lane->climbs = waiting->climbs;
    lane->walk.depth = waiting->depth;
    for (uint32_t i = 0; i < waiting->depth; i++) {
        lane->walk.ref[i] = waiting->left[i].ref;
        lane->walk.entry[i] = waiting->left[i].entry;
    }
}
