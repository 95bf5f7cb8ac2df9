/* Changes of the shrinker's passes over what a world consists of: each does to what the world means
 * (tests/worlds/world_meaning.h) what its name tells, and nothing else. */
#include "fuzz/shrink/shrink_inner.h"

#include "tests/worlds/world_meaning.h"

#define WORLDS 150

/* The world whose triangles have the numbers. */
static struct fuzz_trial drawn;

/* --- what changes mean ------------------------------------------------------------------------ */

/* Whether there is such a change; *want: what is meant after it. */
typedef bool wanted_fn(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant);

static bool is_in(uint32_t i, uint32_t first, uint32_t count)
{
    return i >= first && i - first < count;
}

/* Meshes and what instances show, one after the other: `at` counts from 0. */
static struct shown_mesh *shape_at(struct meaning *want, uint32_t at)
{
    return at < want->meshes                     ? &want->mesh[at]
           : at < want->meshes + want->instances ? &want->shown[at - want->meshes]
                                                 : NULL;
}

static void drop_mesh(struct meaning *want, uint32_t mesh)
{
    for (uint32_t m = mesh + 1; m < want->meshes; m++)
        want->mesh[m - 1] = want->mesh[m];
    want->meshes--;
}

/* Meshes that no instance shows are gone. */
static void tidy(struct meaning *want)
{
    for (uint32_t m = want->meshes; m-- > 0;) {
        bool used = false;
        for (uint32_t i = 0; i < want->instances; i++)
            used = used || (want->shown[i].count > 0 && want->shown[i].of == want->mesh[m].of);
        if (!used)
            drop_mesh(want, m);
    }
}

/* Keep or remove; the same and tidy; keep, tidy and with the custom index 1. */
static bool want_instances(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    bool keep = variant == 0 || variant == 2 || variant == 4;
    uint32_t left = 0;
    for (uint32_t i = 0; i < want->instances; i++)
        if (is_in(i, first, count) == keep) {
            want->shown[left] = want->shown[i];
            want->how[left++] = want->how[i];
        }
    want->instances = left;
    for (uint32_t i = 0; i < left && variant == 4; i++)
        want->how[i].custom = 1;
    if (variant >= 2)
        tidy(want);
    return true;
}

static void join_sorts(struct shown_geometry *to, const struct shown_geometry *from)
{
    for (uint32_t i = 0; i < from->count; i++)
        to->triangle[to->count++] = from->triangle[i];
}

static void drop_sort(struct shown_mesh *of, uint32_t sort)
{
    memmove(&of->sort[sort], &of->sort[sort + 1], sizeof *of->sort * (of->count - sort - 1));
    of->count--;
}

/* A geometry goes, is joined with the one before it in its mesh, joins its mesh with the one before
 * if it is its first, or is opaque. */
static bool want_geometry(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t mesh = 0, own = first;
    (void)count;
    while (own >= want->mesh[mesh].count)
        own -= want->mesh[mesh++].count;
    if (variant == 1 ? own == 0 : variant == 2 && (own > 0 || mesh == 0))
        return false;
    const struct shown_mesh before = want->mesh[mesh > 0 ? mesh - 1 : 0], it = want->mesh[mesh];
    struct shown_mesh both = before;
    for (uint32_t g = 0; g < it.count && both.count < GEOMETRIES; g++)
        both.sort[both.count++] = it.sort[g];
    struct shown_mesh *one;
    for (uint32_t i = 0; (one = shape_at(want, i)); i++) {
        if (one->count == 0 || (one->of != mesh && (variant != 2 || one->of + 1 != mesh)))
            continue;
        if (variant == 1)
            join_sorts(&one->sort[own - 1], &one->sort[own]);
        if (variant <= 1)
            drop_sort(one, own);
        else if (variant == 2)
            *one = both;
        else
            one->sort[own].opaque = true;
    }
    if (variant == 2 || want->mesh[mesh].count == 0)
        drop_mesh(want, mesh);
    return true;
}

static uint32_t low_bit(uint32_t bits)
{
    for (uint32_t bit = 1; bit; bit *= 2)
        if (bits & bit)
            return bit;
    return 0;
}

static uint32_t high_bit(uint32_t bits)
{
    for (uint32_t bit = 1u << 31; bit; bit /= 2)
        if (bits & bit)
            return bit;
    return 0;
}

static bool want_members(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    for (uint32_t i = first; i < first + count; i++) {
        struct instance *how = &want->how[i];
        const uint32_t mask[] = {0xFF, low_bit(how->mask), 1};
        const uint32_t custom[] = {0, 1, how->custom / 2, high_bit(how->custom)};
        if (variant < 3)
            how->mask = mask[variant];
        else if (variant == 3 || variant >= 12)
            how->flags &= variant == 3 ? 0 : ~(1u << (variant - 12));
        else if (variant < 8)
            how->custom = custom[variant - 4];
        else
            want->shown[i] = variant % 2 == 0 ? want->mesh[0] : (struct shown_mesh){0};
    }
    if (variant == 10 || variant == 11)
        tidy(want);
    return true;
}

static bool want_modes(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    for (uint32_t i = first; i < first + count; i++) {
        struct ray_mode *mode = &want->mode[i];
        if (variant < 2)
            mode->mask = variant == 0 ? 0xFF : low_bit(mode->mask);
        else
            mode->flags &= variant == 2 ? 0 : ~(1u << (variant - 3));
    }
    return true;
}

static bool want_filter(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    struct filter_rule *filter = &want->filter;
    struct shown_mesh *one;
    (void)first, (void)count;
    if (variant < 2)
        *filter = (struct filter_rule){variant == 0 ? FILTER_ALL : FILTER_NONE, 0, 128};
    else if (variant < 5)
        filter->seed = (const uint32_t[]){0, 1, filter->seed / 2}[variant - 2];
    else if (variant < 8)
        filter->share = (const uint32_t[]){128, 256, 0}[variant - 5];
    for (uint32_t i = 0; variant == 8 && (one = shape_at(want, i)); i++)
        for (uint32_t g = 0; g < one->count; g++)
            one->sort[g].opaque = true;
    return true;
}

/* Rays go with what they may meet. */
static bool want_rays(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < want->rays; i++)
        if (is_in(i, first, count) == (variant == 0)) {
            want->ray[left] = want->ray[i];
            want->mode[left++] = want->mode[i];
        }
    want->rays = left;
    return true;
}

static bool want_triangles(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    struct shown_mesh *one;
    for (uint32_t i = 0; (one = shape_at(want, i)); i++)
        for (uint32_t g = 0; g < one->count; g++) {
            struct shown_geometry was = one->sort[g], *is = &one->sort[g];
            is->count = 0;
            for (uint32_t t = 0; t < was.count; t++)
                if (is_in(was.triangle[t], first, count) == (variant == 0))
                    is->triangle[is->count++] = was.triangle[t];
        }
    return true;
}

/* Any two. */
static bool want_pairs(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t low = first / drawn.scene.tri_count, high = first % drawn.scene.tri_count;
    (void)variant;
    return low < high && want_triangles(want, low, count, 1) &&
           want_triangles(want, high, count, 1);
}

/* Triangles of a chunk are as the one before it (behind it), or as the first (last) of it. */
static bool want_repeated(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    uint32_t last = first + count - 1, from = variant == 0 ? first - (first > 0) : last;
    struct shown_mesh *one;
    if (variant == 1 && last + 1 < drawn.scene.tri_count)
        from = last + 1;
    for (uint32_t i = 0; (one = shape_at(want, i)); i++)
        for (uint32_t g = 0; g < one->count; g++)
            for (uint32_t t = 0; t < one->sort[g].count; t++)
                if (is_in(one->sort[g].triangle[t], first, count))
                    one->sort[g].triangle[t] = from;
    return true;
}

/* Numbers of vertices mean nothing. */
static bool want_the_same(struct meaning *want, uint32_t first, uint32_t count, uint32_t variant)
{
    (void)want, (void)first, (void)count, (void)variant;
    return true;
}

/* --- laws ------------------------------------------------------------------------------------- */

static const struct shrink_pass *pass_of(const char *name)
{
    for (size_t i = 0; shrink_passes[i]; i++)
        if (strcmp(shrink_passes[i]->name, name) == 0)
            return shrink_passes[i];
    fail_msg("no pass %s", name);
    return NULL;
}

/* A trial's parts that are of no world. */
static bool same_members(const struct fuzz_trial *a, const struct fuzz_trial *b)
{
    return a->builder == b->builder && a->build.leaf == b->build.leaf &&
           a->build.eps == b->build.eps && a->build.passes == b->build.passes && a->box == b->box &&
           a->tri == b->tri && a->query == b->query && a->store == b->store && a->move == b->move &&
           a->move_seed == b->move_seed;
}

static void try_change(const struct shrink_pass *pass, wanted_fn *wanted, uint32_t first,
                       uint32_t count, uint32_t variant)
{
    struct meaning want = meaning_of(&drawn.scene, &drawn);
    struct fuzz_trial changed;
    struct reason reason = {""};
    assert_int_equal(fuzz_trial_copy(&drawn, &changed, NULL), STATUS_OK);
    bool is = wanted(&want, first, count, variant);
    if (pass->change(&changed, first, count, variant) != is)
        fail_msg("%s, variant %u: it is %sa change", pass->name, variant, is ? "" : "not ");
    if (is && fuzz_trial_check(&changed, &reason))
        fail_msg("%s, variant %u: %s", pass->name, variant, reason.text);
    struct meaning got = meaning_of(&drawn.scene, is ? &changed : &drawn);
    const char *other = is ? differing(&got, &want) : NULL;
    if (other)
        fail_msg("%s, variant %u of %u from %u on: %s", pass->name, variant, count, first, other);
    assert_true(same_members(&changed, &drawn));
    fuzz_trial_free(&changed);
}

static void every_change_of_a_world_is_what_its_name_tells(void **state)
{
    (void)state;
    static const struct {
        const char *pass;
        wanted_fn *wanted;
        uint32_t variants;
    } known[] = {{"instances", want_instances, 5},
                 {"geometries", want_geometry, 4},
                 {"instance members", want_members, 16},
                 {"modes", want_modes, 12},
                 {"filter", want_filter, 9},
                 {"rays", want_rays, 2},
                 {"triangles", want_triangles, 2},
                 {"ends", want_triangles, 2},
                 {"pairs", want_pairs, 1},
                 {"repeat", want_repeated, 2},
                 {"tidy", want_the_same, 2}};
    for (uint64_t index = 0; index < WORLDS; index++) {
        drawn = draw(index);
        for (size_t k = 0; k < ARRAY_COUNT(known); k++) {
            const struct shrink_pass *pass = pass_of(known[k].pass);
            const uint32_t things = pass->things(&drawn);
            assert_int_equal(pass->variants, known[k].variants);
            for (uint32_t first = 0; first < things; first++)
                for (uint32_t count = 1; count <= things - first; count++)
                    for (uint32_t variant = 0; variant < pass->variants; variant++)
                        if (pass->way != SHRINK_SINGLY || count == 1)
                            try_change(pass, known[k].wanted, first, count, variant);
        }
        fuzz_trial_free(&drawn);
    }
}

/* Whether so many triangles of the scene are shown by some instance. */
static enum status shows_many(void *user, const struct fuzz_trial *candidate, size_t count,
                              size_t *first, struct reason *reason)
{
    (void)reason;
    for (*first = 0; *first < count; ++*first) {
        const struct trial_world *world = &candidate[*first].world;
        uint32_t shown = 0;
        for (uint32_t g = 0; g < world->geometry_count; g++)
            for (uint32_t i = 0; i < world->instance_count; i++)
                if (world->instance[i].mesh == world->geometry[g].mesh) {
                    shown += world->geometry[g].count;
                    break;
                }
        if (shown >= *(const uint32_t *)user)
            break;
    }
    return STATUS_OK;
}

/* Triangles that are needed are shown by one instance in the end, whichever meshes they were of:
 * those that no instance shows are gone. */
static void what_is_needed_ends_in_one_instance(void **state)
{
    (void)state;
    uint32_t joined = 0;
    for (uint64_t index = 0; index < WORLDS; index++) {
        const struct shrink_options options = {0};
        struct fuzz_trial trial = draw(index), out;
        struct shrink_stats stats;
        struct reason reason = {""};
        uint32_t needed = 2 + (uint32_t)(index % 3);
        if (fuzz_shrink_trial(&trial, shows_many, &needed, &options, &out, &stats, &reason))
            fail_msg("%s", reason.text);
        if (stats.end != SHRINK_NOT_SHOWN) {
            if (out.world.instance_count != 1 || out.scene.tri_count != needed ||
                out.world.geometry_count != 1)
                fail_msg("world %u: %u instances, %u geometries, %u of %u triangles",
                         (unsigned)index, out.world.instance_count, out.world.geometry_count,
                         out.scene.tri_count, needed);
            joined += trial_world_meshes(&trial.world) > 1;
        }
        fuzz_trial_free(&out);
        fuzz_trial_free(&trial);
    }
    assert_true(joined > 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_change_of_a_world_is_what_its_name_tells),
        cmocka_unit_test(what_is_needed_ends_in_one_instance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
