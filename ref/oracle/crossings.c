#include "ref/oracle/environment.h"
#include "ref/base/invariant.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/tree_walk.h"
#include "ref/oracle/world_walk.h"

#include <math.h>

/* A crossing whose integers are not known. */
static void restart(const struct oracle *oracle, const struct oracle_crossing *crossing,
                    struct decided *out)
{
    out->prim = crossing->prim;
    out->at = pair_locate(oracle, crossing->prim);
    out->pair = crossing->pair;
    out->have_exact = false;
}

/* The order of two crossings: by the exact t of a hit or t_lo of an interval, then by index. */
static int compare(const struct oracle *oracle, const struct ray *ray,
                   const struct oracle_crossing *a, const struct oracle_crossing *b)
{
    bool a_hit = oracle_is_hit(&a->pair), b_hit = oracle_is_hit(&b->pair);
    double a_hi = a_hit ? a->pair.t_hi : a->pair.t_lo, b_hi = b_hit ? b->pair.t_hi : b->pair.t_lo;
    if (a->pair.t_lo > b_hi)
        return 1;
    if (a_hi < b->pair.t_lo)
        return -1;
    struct decided one, two;
    int sign = 0;
    restart(oracle, a, &one);
    restart(oracle, b, &two);
    if (a_hit && b_hit)
        sign = pair_order(ray, &one, &two);
    else if (a_hit)
        sign = fraction_compare_double(pair_t(ray, &one), b->pair.t_lo);
    else if (b_hit)
        sign = -fraction_compare_double(pair_t(ray, &two), a->pair.t_lo);
    return sign ? sign : order_numbers(a->prim, b->prim);
}

/* By insertion: lists are short, and nearly in order where a tree found them. */
static void sort(const struct oracle *oracle, const struct ray *ray, struct oracle_crossing *list,
                 size_t count)
{
    for (size_t i = 1; i < count; i++) {
        struct oracle_crossing moved = list[i];
        size_t at = i;
        while (at > 0 && compare(oracle, ray, &list[at - 1], &moved) > 0) {
            list[at] = list[at - 1];
            at--;
        }
        list[at] = moved;
    }
}

static enum status add(const struct decided *pair, double t_most, struct oracle_crossing **list,
                       size_t *capacity, size_t *count)
{
    if (!(pair->pair.t_lo <= t_most))
        return STATUS_OK;
    enum status status = array_reserve((void **)list, capacity, *count + 1, sizeof **list);
    if (!status)
        (*list)[(*count)++] = (struct oracle_crossing){pair->prim, pair->pair};
    return status;
}

/* Enclosures of hits in range are at most 2^-40 wide, so t_lo <= t_most bounds t by this; or it is
 * up to FRACTION_LEAST, where the walks take it for 0: of a float32 scene no t is as small, and
 * PLACED_PAD is more. */
static double reach_to(const struct ray *ray, double t_most)
{
    return fmin(t_most + fabs(t_most) * 0x1p-38, (double)ray->tmax);
}

/* Appends triangle `prim` if it is met in range. */
static enum status take(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                        double t_most, struct oracle_crossing **list, size_t *capacity,
                        size_t *count)
{
    struct decided pair;
    const struct located at = {oracle, NULL, prim};
    pair_decide(&at, ray, prim, PAIR_HITS, &pair, NULL);
    if (pair.pair.class == ORACLE_MISS || pair.pair.class == ORACLE_ZERO_AREA ||
        !oracle_in_range(&pair.pair, ORACLE_CLOSED))
        return STATUS_OK;
    return add(&pair, t_most, list, capacity, count);
}

static enum status collect(const struct oracle *oracle, const struct ray *ray, double t_most,
                           struct oracle_crossing **list, size_t *capacity, size_t *count)
{
    struct early_ray early = early_ray_make(ray);
    struct tree_walk walk;
    struct tree_leaf leaf;
    double reach = reach_to(ray, t_most);
    tree_walk_start(&walk, &oracle->tree, ray);
    while (tree_walk_next(&walk, reach, &leaf)) {
        uint64_t left =
            oracle->kernel->look(&oracle->soup, &early, leaf.first, leaf.count, leaf.largest);
        for (; left; left &= left - 1) {
            uint32_t prim = oracle->tree.order[leaf.first + (uint32_t)__builtin_ctzll(left)];
            enum status status = take(oracle, ray, prim, t_most, list, capacity, count);
            if (status)
                return status;
        }
    }
    return STATUS_OK;
}

enum status oracle_crossings(const struct oracle *oracle, const struct ray *ray, double t_most,
                             struct oracle_crossing **list, size_t *capacity, size_t *count,
                             struct reason *reason)
{
    *count = 0;
    invariant(!oracle->placing);
    if (!oracle_takes(ray) || ray_is_still(ray))
        return STATUS_OK;
    unsigned long saved = environment_enter();
    enum status status = collect(oracle, ray, t_most, list, capacity, count);
    if (status)
        *count = 0;
    else
        sort(oracle, ray, *list, *count);
    environment_leave(saved);
    return status ? fail(reason, status, "oracle: no memory for the crossings") : STATUS_OK;
}

/* --- worlds ----------------------------------------------------------------------------------- */

/* The crossings of one ray, as a visitor. */
struct crossings_visitor {
    struct world_visitor visitor; /* first: the walk knows no more */
    double t_most;
    struct oracle_crossing **list;
    size_t *capacity, *count;
};

static enum status take_placed(struct world_visitor *visitor, const struct ray *ray,
                               struct decided *pair)
{
    struct crossings_visitor *all = (struct crossings_visitor *)visitor;
    (void)ray;
    return add(pair, all->t_most, all->list, all->capacity, all->count);
}

enum status oracle_crossings_world(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, double t_most,
                                   struct oracle_crossing **list, size_t *capacity, size_t *count,
                                   struct reason *reason)
{
    struct crossings_visitor all = {
        {.reach = reach_to(ray, t_most), .take = take_placed}, t_most, list, capacity, count};
    *count = 0;
    invariant(oracle->placing);
    if (!oracle_takes(ray) || ray_is_still(ray))
        return STATUS_OK;
    unsigned long saved = environment_enter();
    enum status status = world_walk(oracle, ray, mode, false, &all.visitor);
    if (status)
        *count = 0;
    else
        sort(oracle, ray, *list, *count);
    environment_leave(saved);
    return status ? fail(reason, status, "oracle: no memory for the crossings") : STATUS_OK;
}
