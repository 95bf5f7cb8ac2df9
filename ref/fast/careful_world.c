#include "ref/fast/careful.h"
#include "ref/fast/fast_world.h"
#include "ref/world/object_ray.h"

/* The traversal of both levels by one ray. */
struct both_levels {
    struct careful top; /* first, so that it leads to the whole */
    struct careful in;
    const struct fast_world *fast;
    const struct ray *ray;
    struct ray_mode mode;
};

/* Goes on in one instance, with the hits that there are. */
static bool go_on(struct careful *in, const struct fast_world *fast, uint32_t index,
                  const struct ray *inside, struct ray_mode mode)
{
    const struct instance_at at = {fast->world, &fast->record[index], index, mode};
    struct hit before = in->best;
    uint32_t found = in->found;
    in->in = &at;
    careful_walk(in, &fast->bottom[fast->record[index].mesh], inside);
    in->in = NULL;
    return in->found != found || in->best.prim != before.prim;
}

static bool visit_instance(struct careful *top, uint32_t ref)
{
    struct both_levels *both = (struct both_levels *)top;
    uint32_t index = ref & ~FAST_LEAF;
    if (!world_meets(&both->fast->world->instance[index], both->mode))
        return false;
    struct ray inside = transform_ray(&both->fast->record[index], both->ray);
    (void)go_on(&both->in, both->fast, index, &inside, both->mode);
    top->tbest = both->in.tbest;
    return both->in.query == QUERY_ANY && both->in.best.prim != ABI_NO_PRIM;
}

static void trace(struct both_levels *both, const struct fast_world *fast, const struct ray *ray,
                  struct ray_mode mode, enum query query)
{
    both->fast = fast;
    both->ray = ray;
    both->mode = mode;
    careful_start(&both->in, ray, query);
    careful_start(&both->top, ray, query);
    both->top.leaf = visit_instance;
    careful_walk(&both->top, &fast->top, ray);
}

void fast_careful_world(const struct fast_world *fast, const struct ray *ray, struct ray_mode mode,
                        bool any, struct hit *hit, uint32_t *tag)
{
    struct both_levels both = {.top = {.list = NULL}};
    trace(&both, fast, ray, mode, any ? QUERY_ANY : QUERY_CLOSEST);
    *hit = both.in.best;
    *tag = both.in.tag;
}

bool fast_careful_instance(const struct fast_world *fast, uint32_t instance,
                           const struct ray *inside, struct ray_mode mode, bool any,
                           struct hit *hit, uint32_t *tag)
{
    struct careful in = {.list = NULL};
    careful_start(&in, inside, any ? QUERY_ANY : QUERY_CLOSEST);
    if (hit->prim != ABI_NO_PRIM) {
        in.best = *hit;
        in.tbest = hit->t;
    }
    if (!go_on(&in, fast, instance, inside, mode))
        return false;
    *hit = in.best;
    *tag = in.tag;
    return true;
}

uint32_t fast_world_all(const struct fast_world *fast, const struct ray *ray, struct ray_mode mode,
                        uint32_t capacity, struct hit *hit, uint32_t *tag)
{
    struct both_levels both = {.in = {.list = hit, .tags = tag, .capacity = capacity}};
    trace(&both, fast, ray, mode, QUERY_ALL);
    return both.in.found;
}
