#include "ref/oracle/world_walk.h"

#include "ref/oracle/internal.h"
#include "ref/oracle/placed_walk.h"

#include <math.h>

/* Which t of a triangle are taken: what is near 0 may be visited by two walks, one forth and one
 * back, and is of one of them. */
enum walk_half {
    HALF_BOTH,
    HALF_FORTH, /* t >= 0; of an interval its start */
    HALF_BACK,
};

/* One ray's. */
struct walking {
    const struct oracle *oracle;
    const struct ray *ray;
    struct ray_mode mode;
    struct world_visitor *visitor;
};

/* Decides a triangle of an instance. */
static enum status meet(const struct walking *walking, uint32_t instance, uint32_t tri,
                        enum walk_half half)
{
    const struct placing *placing = walking->oracle->placing;
    struct decided pair;
    uint32_t prim = placing->world->first[instance] + tri;
    const struct located at = placing_locate(placing, instance, prim);
    pair_decide(&at, walking->ray, prim, PAIR_HITS, &pair, &walking->visitor->stats);
    if (pair.pair.class == ORACLE_MISS || pair.pair.class == ORACLE_ZERO_AREA ||
        !oracle_in_range(&pair.pair, ORACLE_CLOSED))
        return STATUS_OK;
    if (half != HALF_BOTH && (half == HALF_BACK) != (pair.pair.t_lo < 0)) /* < 0 exactly if t is */
        return STATUS_OK;
    if (admission_of(walking->oracle, walking->ray, walking->mode, &pair) != ORACLE_ADMITTED)
        return STATUS_OK;
    return walking->visitor->take(walking->visitor, walking->ray, &pair);
}

/* Decides the triangles of a leaf that are not certainly missed. The first look's proof has room
 * for places of moderate size alone. */
static enum status meet_leaf(const struct walking *walking, uint32_t instance,
                             const struct early_ray *early, const struct tree_leaf *leaf,
                             enum walk_half half)
{
    const struct placing *placing = walking->oracle->placing;
    const struct oracle *mesh = placing->mesh[placing->world->instance[instance].mesh];
    uint64_t left = ~(uint64_t)0 >> (EARLY_MOST - leaf->count);
    double largest = leaf->largest + early->more;
    enum status status = STATUS_OK;
    if (largest >= EARLY_LEAST && largest <= EARLY_LARGEST)
        left = mesh->kernel->look(&mesh->soup, early, leaf->first, leaf->count, largest);
    walking->visitor->stats.pairs += leaf->count;
    for (; left && !status; left &= left - 1) {
        uint32_t tri = mesh->tree.order[leaf->first + (uint32_t)__builtin_ctzll(left)];
        status = meet(walking, instance, tri, half);
    }
    return status;
}

/* --- one instance ----------------------------------------------------------------------------- */

static enum status walk_identity(const struct walking *walking, uint32_t instance,
                                 const struct tree *tree)
{
    struct early_ray early = early_ray_make(walking->ray);
    struct tree_walk walk;
    struct tree_leaf leaf;
    enum status status = STATUS_OK;
    tree_walk_start(&walk, tree, walking->ray);
    while (!status && tree_walk_next(&walk, walking->visitor->reach, &leaf))
        status = meet_leaf(walking, instance, &early, &leaf, HALF_BOTH);
    return status;
}

/* At t >= 0, up to the visitor's reach. */
static enum status walk_forth(const struct walking *walking, uint32_t instance,
                              const struct tree *tree, const struct sight *sight,
                              const struct early_ray *early)
{
    struct placed_walk walk;
    struct tree_leaf leaf;
    enum status status = STATUS_OK;
    placed_walk_start(&walk, tree, sight, false, fmax((double)walking->ray->tmin, 0),
                      walking->visitor->reach);
    while (!status && placed_walk_next(&walk, walking->visitor->reach, &leaf))
        status = meet_leaf(walking, instance, early, &leaf, HALF_FORTH);
    return status;
}

/* At t < 0, of the opposite ray: from the visitor's reach on, as far as tmin. It meets the nearest
 * first, so a lower reach would save next to nothing before the next instance. */
static enum status walk_back(const struct walking *walking, uint32_t instance,
                             const struct tree *tree, const struct sight *sight,
                             const struct early_ray *early)
{
    struct placed_walk walk;
    struct tree_leaf leaf;
    enum status status = STATUS_OK;
    double most = -(double)walking->ray->tmin;
    placed_walk_start(&walk, tree, sight, true, fmax(-walking->visitor->reach, 0), most);
    while (!status && placed_walk_next(&walk, most, &leaf))
        status = meet_leaf(walking, instance, early, &leaf, HALF_BACK);
    return status;
}

static enum status walk_instance(const struct walking *walking, uint32_t instance)
{
    const struct placing *placing = walking->oracle->placing;
    const struct instance *at = &placing->world->instance[instance];
    const struct tree *tree = &placing->mesh[at->mesh]->tree;
    struct sight sight;
    enum status status = STATUS_OK;
    if (placing->inverse[instance].identity)
        return walk_identity(walking, instance, tree);
    sight_make(&placing->inverse[instance], at, walking->ray, &sight);
    struct early_ray early = early_ray_about(sight.o, sight.d, sight.o_err, sight.d_err);
    if (walking->ray->tmin < 0)
        status = walk_back(walking, instance, tree, &sight, &early);
    if (!status && walking->ray->tmax >= 0)
        status = walk_forth(walking, instance, tree, &sight, &early);
    return status;
}

/* --- the world -------------------------------------------------------------------------------- */

static enum status walk_brute(const struct walking *walking)
{
    const struct world *world = walking->oracle->placing->world;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < world->instance_count && !status; i++) {
        if (!world_meets(&world->instance[i], walking->mode))
            continue;
        uint32_t count = world->first[i + 1] - world->first[i];
        walking->visitor->stats.pairs += count;
        for (uint32_t tri = 0; tri < count && !status; tri++)
            status = meet(walking, i, tri, HALF_BOTH);
    }
    return status;
}

enum status world_walk(const struct oracle *oracle, const struct ray *ray, struct ray_mode mode,
                       bool brute, struct world_visitor *visitor)
{
    const struct walking walking = {oracle, ray, mode, visitor};
    const struct placing *placing = oracle->placing;
    struct tree_walk walk;
    struct tree_leaf leaf;
    enum status status = STATUS_OK;
    if (brute)
        return walk_brute(&walking);
    tree_walk_start(&walk, &placing->top, ray);
    while (!status && tree_walk_next(&walk, visitor->reach, &leaf)) {
        uint32_t instance = placing->top.order[leaf.first]; /* one a leaf */
        if (world_meets(&placing->world->instance[instance], mode))
            status = walk_instance(&walking, instance);
    }
    return status;
}
