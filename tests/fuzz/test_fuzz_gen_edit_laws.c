/* Edits of the whole scene: what they do to every coordinate is one map, which the rays go along
 * with as a whole or not at all. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/mutate.h"
#include "ref/base/half.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"

#define TRIALS 200u

static const struct gen_options short_ones = {
    .triangles_least = 16, .triangles_most = 64, .rays = 40};

enum map_kind { MAP_SCALE, MAP_MOVE, MAP_NEGATE, MAP_SWAP, MAP_FLATTEN, MAP_SNAP, MAP_HALVES };

/* `by`: the factor, the distance, the place or the step; of halves 0 or 1: between them. */
struct edit_map {
    enum map_kind kind;
    int axis;
    float by;
};

static float mapped(const struct edit_map *map, const float x[3], int axis, bool is_direction)
{
    switch (map->kind) {
    case MAP_SCALE:
        return x[axis] * map->by;
    case MAP_MOVE:
        return axis == map->axis && !is_direction ? x[axis] + map->by : x[axis];
    case MAP_NEGATE:
        return axis == map->axis ? -x[axis] : x[axis];
    case MAP_SWAP:
        return axis == map->axis             ? x[(axis + 1) % 3]
               : axis == (map->axis + 1) % 3 ? x[map->axis]
                                             : x[axis];
    case MAP_FLATTEN:
        return axis == map->axis ? map->by : x[axis];
    case MAP_SNAP:
        return (float)(int32_t)roundf(x[axis] / map->by) * map->by;
    case MAP_HALVES:
        return map->by > 0 ? 0.5f * half_to_float(half_down(x[axis])) +
                                 0.5f * half_to_float(half_up(x[axis]))
                           : half_to_float(half_nearest(x[axis]));
    }
    return NAN;
}

static bool same(float a, float b)
{
    return float_bits(a) == float_bits(b) || (isnan(a) && isnan(b));
}

static bool maps_scene(const struct edit_map *map, const struct scene *before,
                       const struct scene *after)
{
    for (uint32_t i = 0; i < before->vertex_count; i++)
        for (int k = 0; k < 3; k++) {
            const float *x = before->vertex + 3 * (size_t)i;
            float wanted = mapped(map, x, k, false);
            if (!same(after->vertex[3 * (size_t)i + (size_t)k], isfinite(wanted) ? wanted : x[k]))
                return false;
        }
    return true;
}

static bool maps_rays(const struct edit_map *map, const struct fuzz_trial *before,
                      const struct fuzz_trial *after)
{
    for (uint32_t i = 0; i < before->ray_count; i++)
        for (int k = 0; k < 3; k++) {
            const struct ray *from = &before->ray[i], *to = &after->ray[i];
            if (!same(to->org[k], mapped(map, from->org, k, false)) ||
                !same(to->dir[k], mapped(map, from->dir, k, true)))
                return false;
        }
    return true;
}

/* Nothing but coordinates is another. */
static void assert_only_coordinates(const struct fuzz_trial *before, const struct fuzz_trial *after)
{
    assert_int_equal(after->scene.vertex_count, before->scene.vertex_count);
    assert_int_equal(after->scene.tri_count, before->scene.tri_count);
    assert_memory_equal(after->scene.index, before->scene.index,
                        3 * sizeof(uint32_t) * (size_t)before->scene.tri_count);
    assert_int_equal(after->ray_count, before->ray_count);
    for (uint32_t i = 0; i < before->ray_count; i++)
        assert_true(same(after->ray[i].tmin, before->ray[i].tmin) &&
                    same(after->ray[i].tmax, before->ray[i].tmax));
    assert_ptr_equal(after->builder, before->builder);
    assert_ptr_equal(after->box, before->box);
    assert_ptr_equal(after->tri, before->tri);
    assert_int_equal(after->query, before->query);
}

/* What the edits were seen to do. */
struct edit_tally {
    size_t alone, with_rays, axis[3];
    float least, most; /* `by` */
};

/* True if this map is what happened. */
static bool explains(const struct edit_map *map, const struct fuzz_trial *before,
                     const struct fuzz_trial *after, struct edit_tally *tally)
{
    if (!maps_scene(map, &before->scene, &after->scene))
        return false;
    const struct edit_map still = {MAP_SCALE, 0, 1};
    bool alone = maps_rays(&still, before, after);
    bool along = map->kind <= MAP_SWAP && maps_rays(map, before, after);
    if (!alone && !along)
        return false;
    tally->alone += alone && !along;
    tally->with_rays += along && !alone;
    tally->axis[map->axis]++;
    tally->least = fminf(tally->least, map->by);
    tally->most = fmaxf(tally->most, map->by);
    return true;
}

static bool found_on_axis(struct edit_map map, const struct fuzz_trial *before,
                          const struct fuzz_trial *after, struct edit_tally *tally)
{
    if (map.kind == MAP_NEGATE || map.kind == MAP_SWAP)
        return explains(&map, before, after, tally);
    if (map.kind == MAP_HALVES) {
        map.by = 1;
        bool between = explains(&map, before, after, tally);
        map.by = 0;
        return between || explains(&map, before, after, tally);
    }
    for (uint32_t i = 0; i < before->scene.vertex_count && map.kind == MAP_FLATTEN; i++) {
        map.by = before->scene.vertex[3 * (size_t)i + (size_t)map.axis];
        if (explains(&map, before, after, tally))
            return true;
    }
    for (int e = -140; e <= 127 && map.kind != MAP_FLATTEN; e++)
        for (int sign = 1; sign >= (map.kind == MAP_MOVE ? -1 : 1); sign -= 2) {
            map.by = (float)sign * ldexpf(1, e);
            if (explains(&map, before, after, tally))
                return true;
        }
    return false;
}

static struct edit_tally play(const char *name, enum map_kind kind)
{
    const struct edit *edit = edits;
    struct edit_tally tally = {.least = INFINITY, .most = -INFINITY};
    bool axes = kind == MAP_MOVE || kind == MAP_NEGATE || kind == MAP_SWAP || kind == MAP_FLATTEN;
    while (strcmp(edit->name, name) != 0)
        edit++;
    for (uint64_t seed = 0; seed < TRIALS; seed++) {
        struct fuzz_trial before = trial_of(71, seed, &short_ones);
        struct fuzz_trial after = trial_of(71, seed, &short_ones);
        struct rng rng = rng_make(seed, 3);
        bool changed = false, found = false;
        assert_int_equal(edit->apply(&rng, &after, &changed), STATUS_OK);
        assert_only_coordinates(&before, &after);
        for (int axis = 0; axis < (axes ? 3 : 1) && changed && !found; axis++)
            found = found_on_axis((struct edit_map){kind, axis, 0}, &before, &after, &tally);
        if (changed && !found)
            fail_msg("%s, trial %u: its coordinates were not changed by one map", name,
                     (unsigned)seed);
        fuzz_trial_free(&before);
        fuzz_trial_free(&after);
    }
    printf("%-10s %3zu alone, %3zu with rays, %g to %g\n", name, tally.alone, tally.with_rays,
           (double)tally.least, (double)tally.most);
    for (int axis = 0; axis < (axes ? 3 : 1); axis++)
        assert_true(tally.axis[axis] > TRIALS / 12);
    return tally;
}

static void rays_go_with_the_scene_or_stay(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum map_kind kind;
    } cases[] = {
        {"scale", MAP_SCALE}, {"move", MAP_MOVE}, {"negate", MAP_NEGATE}, {"swap_axes", MAP_SWAP}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct edit_tally tally = play(cases[i].name, cases[i].kind);
        assert_true(tally.alone > TRIALS / 5 && tally.with_rays > TRIALS / 5);
        if (cases[i].kind == MAP_SCALE) /* both ends of what is drawn */
            assert_true(tally.least <= 0x1p-15f && tally.most >= 0x1p15f);
        if (cases[i].kind == MAP_MOVE)
            assert_true(tally.least < 0 && tally.most > 0);
    }
}

static void other_maps_leave_the_rays(void **state)
{
    (void)state;
    (void)play("flatten", MAP_FLATTEN);
    (void)play("snap", MAP_SNAP);
    struct edit_tally halves = play("halves", MAP_HALVES);
    assert_true(halves.least <= 0 && halves.most > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_go_with_the_scene_or_stay),
        cmocka_unit_test(other_maps_leave_the_rays),
    };
    return cmocka_run_group_tests_name("fuzz_gen_edit_laws", tests, NULL, NULL) ? 1 : 0;
}
