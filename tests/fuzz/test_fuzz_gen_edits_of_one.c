/* Edits of the scene that are no map of all of it change one thing, in one of the ways that an edit
 * has; each of these comes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/mutate.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"

#define TRIALS 200u

static bool same(float a, float b)
{
    return float_bits(a) == float_bits(b);
}

/* Scenes before and after an edit, and where they differ: of indices or of coordinates the first
 * place, the one behind the last, and how many. */
struct scene_pair {
    const struct scene *a, *b;
    size_t first, end, count;
};

static void indices_changed(struct scene_pair *p)
{
    size_t shared =
        3 * (size_t)(p->a->tri_count < p->b->tri_count ? p->a->tri_count : p->b->tri_count);
    p->first = p->end = p->count = 0;
    for (size_t i = 0; i < shared; i++)
        if (p->a->index[i] != p->b->index[i]) {
            p->first = p->count++ ? p->first : i;
            p->end = i + 1;
        }
}

static void coordinates_changed(struct scene_pair *p)
{
    p->first = p->end = p->count = 0;
    for (size_t i = 0; i < 3 * (size_t)p->a->vertex_count; i++)
        if (float_bits(p->a->vertex[i]) != float_bits(p->b->vertex[i])) {
            p->first = p->count++ ? p->first : i;
            p->end = i + 1;
        }
}

static bool same_tri(const struct scene *a, size_t i, const struct scene *b, size_t k)
{
    return memcmp(a->index + 3 * i, b->index + 3 * k, 12) == 0;
}

static bool has_tri(const struct scene *a, const struct scene *b, size_t k)
{
    for (size_t i = 0; i < a->tri_count; i++)
        if (same_tri(a, i, b, k))
            return true;
    return false;
}

/* Ways of an edit, each of which is to be seen. */
typedef int law_fn(struct scene_pair *p);

/* At the end (1), else in place of one (0), which is the copy of another. */
static int law_duplicate(struct scene_pair *p)
{
    bool grown = p->b->tri_count == p->a->tri_count + 1;
    indices_changed(p);
    if (grown)
        return p->count == 0 && has_tri(p->a, p->b, p->a->tri_count) ? 1 : -1;
    return p->b->tri_count == p->a->tri_count && p->first / 3 == (p->end - 1) / 3 &&
                   has_tri(p->a, p->b, p->first / 3)
               ? 0
               : -1;
}

static int law_permute(struct scene_pair *p)
{
    if (p->b->tri_count != p->a->tri_count)
        return -1;
    for (size_t i = 0; i < p->a->tri_count; i++) {
        size_t before = 0, after = 0;
        for (size_t k = 0; k < p->a->tri_count; k++) {
            before += same_tri(p->a, i, p->a, k);
            after += same_tri(p->a, i, p->b, k);
        }
        if (before != after)
            return -1;
    }
    return 0;
}

/* Corners a and a + 1 of one triangle (a) or of all (3 + a). */
static int law_turn(struct scene_pair *p)
{
    indices_changed(p);
    bool one = p->first / 3 == (p->end - 1) / 3;
    for (int a = 0; a < 3 && p->b->tri_count == p->a->tri_count; a++) {
        bool all = true;
        size_t i = one ? p->first / 3 : 0, end = one ? i + 1 : p->a->tri_count;
        for (; i < end; i++)
            for (int c = 0; c < 3; c++) {
                int from = c == a ? (a + 1) % 3 : c == (a + 1) % 3 ? a : c;
                all = all && p->b->index[3 * i + (size_t)c] == p->a->index[3 * i + (size_t)from];
            }
        if (all)
            return a + (one ? 0 : 3);
    }
    return -1;
}

static int law_weld(struct scene_pair *p)
{
    indices_changed(p);
    for (size_t i = 0; p->count == 1 && i < 3 * (size_t)p->a->tri_count; i++)
        if (p->a->index[i] == p->b->index[p->first])
            return (int)(p->first % 3);
    return -1;
}

/* Stays where it was (0), or is a step down or up from it along an axis (1 to 6). */
static int law_unweld(struct scene_pair *p)
{
    size_t last = p->a->vertex_count;
    coordinates_changed(p);
    bool kept = p->count == 0 && p->b->vertex_count == last + 1;
    indices_changed(p);
    if (!kept || p->count != 1 || p->b->index[p->first] != last)
        return -1;
    const float *own = p->b->vertex + 3 * last,
                *from = p->a->vertex + 3 * (size_t)p->a->index[p->first];
    int way = 0;
    for (int k = 0; k < 3; k++) {
        if (same(own[k], from[k]))
            continue;
        if (way ||
            (own[k] != nextafterf(from[k], -INFINITY) && own[k] != nextafterf(from[k], INFINITY)))
            return -1;
        way = 1 + 2 * k + (own[k] > from[k]);
    }
    return way;
}

static int law_drop(struct scene_pair *p)
{
    size_t last = p->b->tri_count;
    indices_changed(p);
    if (p->a->tri_count != last + 1 || (p->count && p->first / 3 != (p->end - 1) / 3))
        return -1;
    return p->count == 0 || same_tri(p->a, last, p->b, p->first / 3) ? p->count > 0 : -1;
}

/* One coordinate by one to four floats down or up. */
static int law_next_float(struct scene_pair *p)
{
    coordinates_changed(p);
    for (int way = 0; way < 8 && p->count == 1; way++) {
        float x = p->a->vertex[p->first];
        for (int i = 0; i <= way / 2; i++)
            x = nextafterf(x, way % 2 ? INFINITY : -INFINITY);
        if (x == p->b->vertex[p->first])
            return way;
    }
    return -1;
}

static int law_onto_vertex(struct scene_pair *p)
{
    coordinates_changed(p);
    const float *v = p->b->vertex + 3 * (p->first / 3);
    for (size_t i = 0; p->first / 3 == (p->end - 1) / 3 && i < 3 * (size_t)p->a->tri_count; i++)
        if (memcmp(v, p->a->vertex + 3 * (size_t)p->a->index[i], 12) == 0)
            return 0;
    return -1;
}

/* The middle of an edge from a first to a second corner (0), or a place between (1). */
static int law_onto_edge(struct scene_pair *p)
{
    coordinates_changed(p);
    const float *v = p->b->vertex + 3 * (p->first / 3);
    bool between = false;
    for (size_t i = 0; p->first / 3 == (p->end - 1) / 3 && i < p->a->tri_count; i++) {
        const float *x = p->a->vertex + 3 * (size_t)p->a->index[3 * i],
                    *y = p->a->vertex + 3 * (size_t)p->a->index[3 * i + 1];
        bool middle = true, within = true;
        for (int k = 0; k < 3; k++) {
            float length = fabsf(y[k] - x[k]), slack = 1e-6f * (fabsf(x[k]) + fabsf(y[k]));
            middle = middle && same(v[k], x[k] + 0.5f * (y[k] - x[k]));
            within = within && fabsf(v[k] - x[k]) <= length + slack &&
                     fabsf(v[k] - y[k]) <= length + slack;
        }
        if (middle)
            return 0;
        between = between || within;
    }
    return between ? 1 : -1;
}

static int law_zero(struct scene_pair *p)
{
    static const float near[] = {0.0f, -0.0f, 0x1p-149f, -0x1p-126f, 0x1p-25f, -0x1p-15f};
    coordinates_changed(p);
    for (int i = 0; i < (int)ARRAY_COUNT(near) && p->count == 1; i++)
        if (same(p->b->vertex[p->first], near[i]))
            return i;
    return -1;
}

/* One coordinate is 2^way times the largest there was, or that below 0 (13 + way). */
static int law_far_vertex(struct scene_pair *p)
{
    float largest = 0;
    coordinates_changed(p);
    for (size_t i = 0; i < 3 * (size_t)p->a->vertex_count; i++)
        largest = fmaxf(largest, fabsf(p->a->vertex[i]));
    for (int way = 0; way < 26 && p->count == 1; way++)
        if (same(p->b->vertex[p->first], ldexpf(way < 13 ? largest : -largest, way % 13)) &&
            fabsf(p->b->vertex[p->first]) < 0x1p38f)
            return way;
    return -1;
}

static void one_thing_changes_in_each_of_its_ways(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        law_fn *law;
        int ways;
    } cases[] = {{"duplicate", law_duplicate, 2},
                 {"permute", law_permute, 1},
                 {"turn", law_turn, 6},
                 {"weld", law_weld, 3},
                 {"unweld", law_unweld, 7},
                 {"drop", law_drop, 2},
                 {"next_float", law_next_float, 8},
                 {"onto_vertex", law_onto_vertex, 1},
                 {"onto_edge", law_onto_edge, 2},
                 {"zero", law_zero, 6},
                 {"far_vertex", law_far_vertex, 26}};
    for (size_t n = 0; n < ARRAY_COUNT(cases); n++) {
        size_t seen[26] = {0};
        const struct edit *edit = edits;
        while (strcmp(edit->name, cases[n].name) != 0)
            edit++;
        for (uint64_t seed = 0; seed < 8 * TRIALS; seed++) {
            const bool large = n == 0 && seed % 4 == 0; /* which grow no more */
            struct gen_options options = {
                .triangles_least = large ? 128 : 16, .triangles_most = large ? 140 : 64, .rays = 4};
            struct fuzz_trial before = trial_of(71, seed % 97, &options);
            struct fuzz_trial after = trial_of(71, seed % 97, &options);
            struct rng rng = rng_make(seed, 3);
            bool changed = false;
            assert_int_equal(edit->apply(&rng, &after, &changed), STATUS_OK);
            int way = changed
                          ? cases[n].law(&(struct scene_pair){&before.scene, &after.scene, 0, 0, 0})
                          : 0;
            if (way < 0 || (changed && way == 1 && n == 0 && before.scene.tri_count >= 128))
                fail_msg("%s, trial %u: more than one thing changed", cases[n].name,
                         (unsigned)seed);
            seen[way] += changed;
            assert_int_equal(after.ray_count, before.ray_count);
            assert_memory_equal(after.ray, before.ray, before.ray_count * sizeof(struct ray));
            fuzz_trial_free(&before);
            fuzz_trial_free(&after);
        }
        for (int way = 0; way < cases[n].ways; way++)
            if (seen[way] == 0)
                fail_msg("%s: never in way %d", cases[n].name, way);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thing_changes_in_each_of_its_ways),
    };
    return cmocka_run_group_tests_name("fuzz_gen_edits_of_one", tests, NULL, NULL) ? 1 : 0;
}
