#include "ref/trace/trace_world.h"

#include "ref/trace/trace_walk.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/object_ray.h"

/* A walk through both levels. The bottom's walk starts anew in every instance, but for its best hit
 * and its list. */
struct world_walk {
    struct walk top; /* first, so that it leads to the whole */
    struct walk bottom;
    const struct world_job *job;
    const struct ray *ray;
    struct instance_at at;
    enum status status; /* of the last walk through a bottom */
};

static enum status walk_top(struct walk *w, uint32_t box_id)
{
    if (box_id == ABI_BOX_ROBUST)
        return walk_tree(w, WALK_TOP, ABI_BOX_ROBUST, 0);
    return walk_tree(w, WALK_TOP, box_id, 0);
}

static enum status walk_bottom(struct walk *w, const struct world_job *job)
{
    if (job->box->id == ABI_BOX_ROBUST && job->tri->id == ABI_TRI_MT)
        return walk_tree(w, WALK_BOTTOM, ABI_BOX_ROBUST, ABI_TRI_MT);
    if (job->box->id == ABI_BOX_WATERTIGHT && job->tri->id == ABI_TRI_WOOP)
        return walk_tree(w, WALK_BOTTOM, ABI_BOX_WATERTIGHT, ABI_TRI_WOOP);
    return walk_tree(w, WALK_BOTTOM, job->box->id, job->tri->id);
}

/* Walks through one entry of the top: an instance, or a part of one. Returns true if the ray ends
 * there. */
static bool enter_instance(struct world_walk *both, uint32_t index)
{
    const struct packed_world *packed = both->job->packed;
    struct walk *top = &both->top, *bottom = &both->bottom;
    struct instance_at *at = &both->at;
    at->index = packed->instance[index];
    at->record = &packed->record[index];
    struct ray inside = transform_ray(at->record, both->ray);
    walk_set_tree(bottom, &packed->bottom[at->record->mesh], world_scene(at->world, at->index));
    walk_set_ray(bottom, &inside);
    bottom->best = top->best;
    bottom->tbest = top->tbest;
    both->status = walk_bottom(bottom, both->job);
    top->best = bottom->best;
    top->tbest = bottom->tbest;
    return both->status || (top->query == QUERY_ANY && top->best.prim != ABI_NO_PRIM);
}

/* Whether a number in the top is that of an entry which the ray may meet. Words of a packed world
 * that its check refuses do no harm. */
static bool is_met(const struct world_walk *both, uint32_t index)
{
    const struct packed_world *packed = both->job->packed;
    return index < packed->entry_count &&
           world_meets(&both->at.world->instance[packed->instance[index]], both->at.mode) &&
           packed->record[index].mesh < packed->tree_count;
}

/* Goes through the instances of a leaf of the top. */
static bool enter_leaf(struct walk *top, const struct wide *leaf)
{
    struct world_walk *both = (struct world_walk *)top;
    for (uint32_t i = 0; i < leaf->item_count; i++) {
        uint32_t index = walk_item(top, leaf, i);
        if (is_met(both, index) && enter_instance(both, index))
            return true;
    }
    return false;
}

static void start_level(struct walk *w, enum query query)
{
    w->parent = NULL;
    w->decoded = NULL;
    w->query = query;
    w->counts = (struct trace_counts){0};
    w->capacity = w->found = 0;
}

static void start(struct world_walk *both, const struct world_job *job, const struct ray *ray,
                  struct ray_mode mode, enum query query)
{
    struct walk *top = &both->top, *bottom = &both->bottom;
    both->job = job;
    both->ray = ray;
    both->at = (struct instance_at){.world = job->world, .mode = mode};
    both->status = STATUS_OK;
    walk_set_tree(top, &job->packed->top, NULL);
    walk_set_ray(top, ray);
    slab_ray_widen(&top->slab, braid_width(job->packed->share, job->packed->reach, ray->org));
    top->enter = enter_leaf;
    bottom->at = &both->at;
    bottom->tag = 0;
    start_level(top, query);
    start_level(bottom, query);
}

static enum status walk_world(struct world_walk *both, struct trace_counts *counts)
{
    enum status status = walk_top(&both->top, both->job->box->id);
    if (counts) {
        counts->boxes += both->top.counts.boxes + both->bottom.counts.boxes;
        counts->tris += both->bottom.counts.tris;
    }
    return status ? status : both->status;
}

enum status trace_world_ray(const struct world_job *job, const struct ray *ray,
                            struct ray_mode mode, struct hit *out, uint32_t *tag,
                            struct trace_counts *counts)
{
    struct world_walk both;
    start(&both, job, ray, mode, mode.flags & ABI_RAY_FIRST ? QUERY_ANY : job->query);
    enum status status = walk_world(&both, counts);
    *out = status ? hit_none() : both.top.best;
    *tag = status ? 0 : both.bottom.tag;
    return status;
}

enum status trace_world_ray_all(const struct world_job *job, const struct ray *ray,
                                struct ray_mode mode, uint32_t capacity, struct hit *out,
                                uint32_t *tag, uint32_t *count, struct trace_counts *counts)
{
    struct world_walk both;
    start(&both, job, ray, mode, QUERY_ALL);
    both.bottom.list = out;
    both.bottom.tags = tag;
    both.bottom.capacity = capacity;
    enum status status = walk_world(&both, counts);
    *count = status ? 0 : both.bottom.found;
    return status;
}

/* --- without trees ---------------------------------------------------------------------------- */

/* The next triangle that the ray hits and that counts, in the instance `at` is in, from *prim on;
 * *prim is then the one behind it. */
static bool next_hit(const struct instance_at *at, uint32_t tri_id, const struct tri_ray *ray,
                     const struct hit *best, uint32_t *prim, struct hit *out, uint32_t *tag)
{
    const struct scene *scene = world_scene(at->world, at->index);
    while (*prim < scene->tri_count) {
        float v[3][3];
        scene_tri(scene, *prim, v);
        bool hit = tri_test_run(tri_id, ray, v, out);
        out->prim = (*prim)++;
        if (hit && (!best || best->prim == ABI_NO_PRIM || out->t < best->t) &&
            candidate_counts(at, ray->d, out, tag))
            return true;
    }
    return false;
}

/* Enters the next instance that the ray may meet, from *index on; *index is then the one behind it.
 * Returns false if there is none. */
static bool next_instance(struct instance_at *at, const struct instance_record *record,
                          const struct ray *ray, uint32_t *index, struct tri_ray *inside)
{
    while (*index < at->world->instance_count) {
        at->index = (*index)++;
        at->record = &record[at->index];
        if (!world_meets(&at->world->instance[at->index], at->mode))
            continue;
        struct ray moved = transform_ray(at->record, ray);
        *inside = tri_ray_make(&moved);
        return true;
    }
    return false;
}

void trace_world_brute(const struct world *world, const struct instance_record *record,
                       const struct tri_test *tri, enum query query, const struct ray *ray,
                       struct ray_mode mode, struct hit *out, uint32_t *tag)
{
    struct instance_at at = {.world = world, .mode = mode};
    bool any = query == QUERY_ANY || (mode.flags & ABI_RAY_FIRST);
    struct tri_ray inside;
    struct hit hit;
    uint32_t index = 0, hit_tag;
    *out = hit_none();
    *tag = 0;
    while (next_instance(&at, record, ray, &index, &inside)) {
        uint32_t prim = 0;
        while (next_hit(&at, tri->id, &inside, out, &prim, &hit, &hit_tag)) {
            *out = hit;
            *tag = hit_tag;
            if (any)
                return;
        }
    }
}

uint32_t trace_world_brute_all(const struct world *world, const struct instance_record *record,
                               const struct tri_test *tri, const struct ray *ray,
                               struct ray_mode mode, uint32_t capacity, struct hit *out,
                               uint32_t *tag)
{
    struct instance_at at = {.world = world, .mode = mode};
    struct tri_ray inside;
    struct hit hit;
    uint32_t index = 0, hit_tag, found = 0;
    while (next_instance(&at, record, ray, &index, &inside)) {
        uint32_t prim = 0;
        while (next_hit(&at, tri->id, &inside, NULL, &prim, &hit, &hit_tag)) {
            if (found < capacity) {
                out[found] = hit;
                tag[found] = hit_tag;
            }
            found++;
        }
    }
    return found;
}
