#include "ref/oracle/crossings.h"
#include "ref/oracle/environment.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/world_walk.h"

#include <assert.h>

/* The crossings of one ray, as a visitor. */
struct crossings_visitor {
    struct world_visitor visitor; /* first: the walk knows no more */
    double t_most;
    struct oracle_crossing **list;
    size_t *capacity, *count;
};

static enum status take(struct world_visitor *visitor, const struct ray *ray, struct decided *pair)
{
    struct crossings_visitor *all = (struct crossings_visitor *)visitor;
    (void)ray;
    return crossings_add(pair, all->t_most, all->list, all->capacity, all->count);
}

enum status oracle_crossings_world(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, double t_most,
                                   struct oracle_crossing **list, size_t *capacity, size_t *count,
                                   struct reason *reason)
{
    struct crossings_visitor all = {
        {.reach = crossings_reach(ray, t_most), .take = take}, t_most, list, capacity, count};
    *count = 0;
    assert(oracle->placing);
    if (!oracle_takes(ray) || ray_is_still(ray))
        return STATUS_OK;
    unsigned long saved = environment_enter();
    enum status status = world_walk(oracle, ray, mode, false, &all.visitor);
    if (status)
        *count = 0;
    else
        crossings_sort(oracle, ray, *list, *count);
    environment_leave(saved);
    return status ? fail(reason, status, "oracle: no memory for the crossings") : STATUS_OK;
}
