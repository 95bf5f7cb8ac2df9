/* The fuzzer's edits: each changes what it says, says what it changes, and keeps trials valid. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/mutate.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"

#define TRIALS 150u

static const struct gen_options short_ones = {
    .triangles_least = 16, .triangles_most = 64, .rays = 40};

/* What an edit did to one trial. */
enum effect {
    EFFECT_CHANGED,
    EFFECT_NOTHING,
    EFFECT_LIED,      /* says "changed" where nothing is, or the other way */
    EFFECT_INVALID,   /* left a trial that no reader would take */
    EFFECT_ELSEWHERE, /* changed another part than its own */
    EFFECTS
};

static uint64_t hash_without(const struct fuzz_trial *trial, enum edit_part part)
{
    struct fuzz_trial copy = *trial;
    static const struct scene no_scene;
    if (part == EDIT_SCENE)
        copy.scene = no_scene;
    if (part == EDIT_RAYS)
        copy.ray_count = 0;
    if (part == EDIT_TESTS) {
        copy.builder = builders[0];
        copy.box = box_tests[0];
        copy.tri = tri_tests[0];
        copy.query = QUERY_CLOSEST;
        copy.move = 0;
        copy.move_seed = 0;
        copy.build = (struct build_options){.leaf = 1, .eps = 0};
    }
    return fuzz_trial_hash(&copy);
}

static enum effect effect_of(const struct edit *edit, uint64_t seed)
{
    struct fuzz_trial trial = trial_of(53, seed, &short_ones);
    struct rng rng = rng_make(seed, 59);
    bool changed = false, rays_too = edit->part == EDIT_SCENE; /* which may go with the scene */
    uint64_t before = fuzz_trial_hash(&trial), others = hash_without(&trial, edit->part);
    assert_int_equal(edit->apply(&rng, &trial, &changed), STATUS_OK);
    enum effect effect = changed ? EFFECT_CHANGED : EFFECT_NOTHING;
    if (changed != (fuzz_trial_hash(&trial) != before))
        effect = EFFECT_LIED;
    else if (!rays_too && hash_without(&trial, edit->part) != others)
        effect = EFFECT_ELSEWHERE;
    else if (fuzz_trial_check(&trial, NULL))
        effect = EFFECT_INVALID;
    fuzz_trial_free(&trial);
    return effect;
}

static void every_edit_changes_something_and_says_so(void **state)
{
    (void)state;
    for (uint32_t e = 0; edits[e].name; e++) {
        uint32_t count[EFFECTS] = {0};
        for (uint32_t i = 0; i < TRIALS; i++)
            count[effect_of(&edits[e], i)]++;
        print_message("%-12s %3u changed, %3u nothing\n", edits[e].name, count[EFFECT_CHANGED],
                      count[EFFECT_NOTHING]);
        assert_int_equal(count[EFFECT_LIED] + count[EFFECT_INVALID] + count[EFFECT_ELSEWHERE], 0);
        /* The builder has no other that is not published. */
        if (strcmp(edits[e].name, "builder") != 0)
            assert_true(count[EFFECT_CHANGED] > TRIALS / 4);
        for (uint32_t other = 0; other < e; other++)
            assert_string_not_equal(edits[e].name, edits[other].name);
    }
}

/* Planted edits. */
static enum status lies(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng, (void)trial;
    *changed = true;
    return STATUS_OK;
}

static enum status overflows(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng;
    for (uint32_t i = 0; i < 3 * trial->scene.vertex_count; i++)
        trial->scene.vertex[i] = INFINITY;
    *changed = trial->scene.vertex_count > 0;
    return STATUS_OK;
}

static enum status strays(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    (void)rng;
    trial->build.leaf++;
    *changed = true;
    return STATUS_OK;
}

static void bad_edits_are_caught(void **state)
{
    (void)state;
    static const struct edit planted[] = {{"lies", EDIT_SCENE, lies},
                                          {"overflows", EDIT_SCENE, overflows},
                                          {"strays", EDIT_RAYS, strays}};
    static const enum effect expected[] = {EFFECT_LIED, EFFECT_INVALID, EFFECT_ELSEWHERE};
    for (uint32_t i = 0; i < ARRAY_COUNT(planted); i++)
        assert_int_equal(effect_of(&planted[i], 1), expected[i]);
}

/* A long life: edits upon edits keep a trial valid, small and in its members. */
static void mutants_of_mutants_stay_valid(void **state)
{
    (void)state;
    struct rng rng = rng_make(61, 0);
    for (uint32_t life = 0; life < 40; life++) {
        struct fuzz_trial trial = trial_of(67, life, &short_ones);
        uint32_t least = trial.scene.tri_count;
        for (uint32_t i = 0; i < 200; i++) {
            uint64_t before = fuzz_trial_hash(&trial);
            struct reason reason = {""};
            assert_int_equal(gen_mutate(&rng, &trial, &reason), STATUS_OK);
            assert_true(fuzz_trial_hash(&trial) != before);
            if (fuzz_trial_check(&trial, &reason))
                fail_msg("life %u, edit %u, %s: %s", life, i, trial.origin.recipe, reason.text);
            assert_true(trial.scene.tri_count <= 128 || trial.scene.tri_count <= least);
            assert_false(trial.builder->faithful || trial.box->faithful || trial.tri->faithful);
        }
        assert_true(trial.origin.mutated);
        assert_true(strlen(trial.origin.recipe) < sizeof trial.origin.recipe);
        assert_non_null(strstr(trial.origin.recipe, " + "));
        fuzz_trial_free(&trial);
    }
}

/* The same random numbers make the same mutant. */
static void a_mutant_depends_on_its_random_numbers_only(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 200; i++) {
        struct fuzz_trial a = trial_of(71, i, &short_ones), b = trial_of(71, i, &short_ones);
        struct rng left = rng_make(i, 73), right = rng_make(i, 73);
        assert_int_equal(gen_mutate(&left, &a, NULL), STATUS_OK);
        assert_int_equal(gen_mutate(&right, &b, NULL), STATUS_OK);
        assert_true(fuzz_trial_hash(&a) == fuzz_trial_hash(&b));
        assert_string_equal(a.origin.recipe, b.origin.recipe);
        fuzz_trial_free(&a);
        fuzz_trial_free(&b);
    }
}

/* --- rays ------------------------------------------------------------------------------------- */

/* What an edit does to one ray: a number by its place, 0 to 2 of the origin and 3 to 5 of the
 * direction, and by how much. */
struct ray_map {
    const char *name;
    int place;
    float by;
};

static const float ends_of_range[][2] = {{0, 1e30f}, {0, 1}, {1, 1e30f}, {0.5f, 2}, {1, 1}, {0, 0}};

static struct ray mapped_ray(const struct ray_map *map, struct ray ray)
{
    float *x = map->place < 3 ? &ray.org[map->place] : &ray.dir[map->place % 3];
    const float *dir = ray.dir;
    if (strcmp(map->name, "ray_step") == 0) {
        float next = nextafterf(*x, map->by * INFINITY);
        *x = next == 0 ? 0.0f : isfinite(next) ? next : *x; /* 0 and -0 are one place */
    } else if (strcmp(map->name, "ray_axis") == 0) {
        bool last = dir[(map->place + 1) % 3] == 0 && dir[(map->place + 2) % 3] == 0;
        *x = last ? *x : map->by;
    } else if (strcmp(map->name, "ray_range") == 0) {
        ray.tmin = ends_of_range[(int)map->by][0];
        ray.tmax = ends_of_range[(int)map->by][1];
    } else if (strcmp(map->name, "ray_back") == 0) {
        for (int k = 0; k < 3; k++) {
            ray.org[k] = isfinite(ray.org[k] + dir[k]) ? ray.org[k] + dir[k] : ray.org[k];
            ray.dir[k] = -ray.dir[k];
        }
    } else {
        for (int k = 0; k < 3; k++)
            ray.dir[k] = isfinite(dir[k] * map->by) ? dir[k] * map->by : dir[k];
    }
    return ray;
}

static bool same_ray(const struct ray *a, const struct ray *b)
{
    const float *x = (const float *)a, *y = (const float *)b;
    for (size_t i = 0; i < sizeof *a / sizeof *x; i++)
        if (float_bits(x[i]) != float_bits(y[i]) && !(isnan(x[i]) && isnan(y[i])))
            return false;
    return true;
}

/* The rays that are others: from *first to before *end. */
static void changed_run(const struct fuzz_trial *before, const struct fuzz_trial *after,
                        uint32_t *first, uint32_t *end)
{
    *first = *end = 0;
    for (uint32_t i = 0; i < before->ray_count; i++)
        if (!same_ray(&before->ray[i], &after->ray[i])) {
            *first = *end ? *first : i;
            *end = i + 1;
        }
}

static bool map_explains(const struct ray_map *map, const struct fuzz_trial *before,
                         const struct fuzz_trial *after, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i++) {
        struct ray wanted = mapped_ray(map, before->ray[i]);
        if (!same_ray(&after->ray[i], &wanted))
            return false;
    }
    return true;
}

/* The maps that an edit may take: places and factors. */
static size_t maps_of(const char *name, struct ray_map map[64])
{
    size_t count = 0;
    bool step = strcmp(name, "ray_step") == 0, axis = strcmp(name, "ray_axis") == 0;
    for (int place = axis ? 3 : 0; (step || axis) && place < 6; place++)
        for (int sign = 1; sign >= -1; sign -= 2)
            map[count++] = (struct ray_map){name, place, step ? (float)sign : 0.0f * (float)sign};
    for (int i = 0; strcmp(name, "ray_range") == 0 && i < (int)ARRAY_COUNT(ends_of_range); i++)
        map[count++] = (struct ray_map){name, 0, (float)i};
    for (int e = -20; strcmp(name, "ray_scale") == 0 && e <= 20; e++)
        if (e != 0)
            map[count++] = (struct ray_map){name, 0, ldexpf(1, e)};
    if (count == 0)
        map[count++] = (struct ray_map){name, 0, 0};
    return count;
}

/* One run of rays, one of them or up to a quarter and one, all by one of the maps, each of which is
 * taken. */
static void rays_change_in_one_run_by_one_map(void **state)
{
    (void)state;
    static const char *const names[] = {"ray_step", "ray_axis",  "ray_range",
                                        "ray_back", "ray_scale", "aim"};
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        struct ray_map map[64];
        size_t taken[64] = {0}, count = maps_of(names[n], map), singles = 0, runs = 0, firsts = 0;
        const struct edit *edit = edits;
        while (strcmp(edit->name, names[n]) != 0)
            edit++;
        for (uint64_t seed = 0; seed < 6 * TRIALS; seed++) {
            struct fuzz_trial before = trial_of(53, seed % 50, &short_ones);
            struct fuzz_trial after = trial_of(53, seed % 50, &short_ones);
            struct rng rng = rng_make(seed, 83);
            bool changed = false, found = strcmp(names[n], "aim") == 0;
            uint32_t first, end;
            assert_int_equal(edit->apply(&rng, &after, &changed), STATUS_OK);
            assert_int_equal(after.ray_count, before.ray_count);
            changed_run(&before, &after, &first, &end);
            assert_true(end - first <= 1 + before.ray_count / 4);
            for (size_t i = 0; i < count && changed && !found; i++) {
                found = map_explains(&map[i], &before, &after, first, end);
                taken[i] += found;
            }
            if (changed && !found)
                fail_msg("%s, trial %u: rays %u to %u are not of one map", names[n], (unsigned)seed,
                         (unsigned)first, (unsigned)end);
            singles += end - first == 1;
            runs += end - first > 1;
            firsts += changed && first < before.ray_count / 2;
            fuzz_trial_free(&before);
            fuzz_trial_free(&after);
        }
        print_message("%-9s %zu of one ray, %zu of more\n", names[n], singles, runs);
        assert_true(singles > TRIALS && runs > TRIALS && firsts > TRIALS);
        for (size_t i = 0; i < count && strcmp(names[n], "aim") != 0; i++)
            if (taken[i] == 0)
                fail_msg("%s: never place %d by %g", names[n], map[i].place, (double)map[i].by);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_edit_changes_something_and_says_so),
        cmocka_unit_test(bad_edits_are_caught),
        cmocka_unit_test(mutants_of_mutants_stay_valid),
        cmocka_unit_test(a_mutant_depends_on_its_random_numbers_only),
        cmocka_unit_test(rays_change_in_one_run_by_one_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
