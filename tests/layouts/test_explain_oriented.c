/* Oriented boxes of layout obb8 explained: what they need to contain, which node's turned a ray
 * away, and tests of them that are wrong. */
#include "ref/explain/oriented.h"
#include "ref/base/rng.h"
#include "ref/packed/packed_check.h"
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/explain/explained.h"
#include "tests/layouts/obb8_words.h"

#define TRIANGLES 60u
#define RAYS      250u

/* Slivers of whole numbers: all places along axes are exact. A bvh of its own, packed. */
struct oriented_stage {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct suspect suspect;
};

static void stage_look(struct oriented_stage *s)
{
    s->suspect = suspect_make(&s->scene, &s->bvh, &s->packed, "watertight", "woop");
}

static void stage_make(struct rng *rng, struct oriented_stage *s)
{
    s->scene = slivers(rng, TRIANGLES, 0, 2000, 900);
    for (uint32_t i = 0; i < 9 * TRIANGLES; i++)
        s->scene.vertex[i] = rintf(s->scene.vertex[i]);
    s->bvh = trees_make(&s->scene, 1 + rng_below(rng, 3), TREES_BALANCED);
    trees_fit(&s->bvh, &s->scene);
    assert_int_equal(packed_make(layout_find("obb8"), &s->bvh, &s->scene, &s->packed, NULL),
                     STATUS_OK);
}

static void stage_free(struct oriented_stage *s)
{
    suspect_free(&s->suspect);
    packed_free(&s->packed);
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

/* A ray at a point of a triangle, a third of them at an edge nearly. */
static struct ray ray_of(struct rng *rng, const struct scene *scene, uint32_t prim)
{
    float v[3][3], a = rng_range(rng, 0, 1), b = rng_range(rng, 0, 1 - a);
    struct ray ray = {.tmax = 1e6f};
    scene_tri(scene, prim, v);
    a = rng_below(rng, 3) ? a : 0.001f;
    for (int k = 0; k < 3; k++) {
        float p = v[0][k] + a * (v[1][k] - v[0][k]) + b * (v[2][k] - v[0][k]);
        ray.org[k] = rng_range(rng, -6000, 6000);
        ray.dir[k] = p - ray.org[k];
    }
    return ray;
}

/* The references from the root to a leaf with the triangle; returns how many. */
static uint32_t find_way(const struct packed *packed, uint32_t ref, uint32_t prim, uint32_t depth,
                         uint32_t way[64])
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    way[depth] = ref;
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++)
        if (packed_item(packed, &node, i) == prim)
            return depth + 1;
    for (uint32_t c = 0; c < node.child_count; c++) {
        uint32_t count = find_way(packed, node.child[c], prim, depth + 1, way);
        if (count)
            return count;
    }
    return 0;
}

/* --- what they need --------------------------------------------------------------------------- */

/* All places of vertices below a reference, along the axes of a record: whole numbers. */
static void measure(const struct oriented_stage *s, const uint32_t *word, uint32_t ref,
                    int64_t lo[3], int64_t hi[3])
{
    struct wide node;
    s->packed.layout->load(&s->packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++)
        measure(s, word, node.child[c], lo, hi);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++) {
        float v[3][3];
        scene_tri(&s->scene, packed_item(&s->packed, &node, i), v);
        for (uint32_t n = 0; n < 9; n++) {
            int64_t place = 0;
            for (uint32_t k = 0; k < 3; k++)
                place += axis_of(word, n % 3, k) * (int64_t)v[n / 3][k];
            lo[n % 3] = place < lo[n % 3] ? place : lo[n % 3];
            hi[n % 3] = place > hi[n % 3] ? place : hi[n % 3];
        }
    }
}

static void needs_are_the_places_of_vertices(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 7);
    uint32_t seen = 0;
    for (uint32_t round = 0; round < 20; round++) {
        struct oriented_stage s;
        stage_make(&rng, &s);
        stage_look(&s);
        for (uint32_t r = 0; r < s.packed.node_count; r++) {
            const uint32_t *word = s.packed.word + WORDS * (size_t)r;
            struct wide node;
            s.packed.layout->load(&s.packed, r, &node);
            for (uint32_t c = 0; c < node.child_count; c++) {
                int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX};
                int64_t high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
                float lo[3], hi[3];
                bool stored = bits(word, 120, 8) != 0;
                assert_int_equal(oriented_needs(&s.suspect.tree, r, node.child[c], lo, hi), stored);
                assert_false(oriented_is_loose(&s.suspect.tree, r, node.child[c]));
                measure(&s, word, node.child[c], low, high);
                for (uint32_t j = 0; j < 3 && stored; j++)
                    assert_true((int64_t)lo[j] == low[j] && (int64_t)hi[j] == high[j]);
                seen += stored;
            }
        }
        stage_free(&s);
    }
    assert_true(seen > 200);
}

/* The sign of a vertex's place along an axis less a number, exactly. */
static int side_of(const uint32_t *word, uint32_t j, const float v[3], float number)
{
    const double x[] = {axis_of(word, j, 0) * (double)v[0], axis_of(word, j, 1) * (double)v[1],
                        axis_of(word, j, 2) * (double)v[2], -(double)number};
    return sign_of_sum(x, 4);
}

/* No vertex below is beyond the bounds; `met`: one is beyond the float next to them. */
static void check_below(const struct oriented_stage *s, const uint32_t *word, uint32_t ref,
                        const struct oblique_bounds *bounds, bool met[6])
{
    struct wide node;
    s->packed.layout->load(&s->packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++)
        check_below(s, word, node.child[c], bounds, met);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++) {
        float v[3][3];
        scene_tri(&s->scene, packed_item(&s->packed, &node, i), v);
        for (uint32_t n = 0; n < 9; n++) {
            const uint32_t j = n % 3;
            const float *at = v[n / 3], lo = bounds->lo[j], hi = bounds->hi[j];
            assert_true(side_of(word, j, at, lo) >= 0 && side_of(word, j, at, hi) <= 0);
            met[j] |= side_of(word, j, at, nextafterf(lo, INFINITY)) < 0;
            met[3 + j] |= side_of(word, j, at, nextafterf(hi, -INFINITY)) > 0;
        }
    }
}

/* Of vertices of any magnitude, where a sum in double is not exact. */
static void needs_are_rounded_outward_by_less_than_a_float(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 7);
    uint32_t seen = 0;
    for (uint32_t round = 0; round < 60; round++) {
        struct oriented_stage s;
        stage_make(&rng, &s);
        packed_free(&s.packed);
        for (uint32_t i = 0; i < 9 * TRIANGLES; i++) {
            int exponent = i % 9 < 3 ? (int)rng_below(&rng, 90) - 45 : -30;
            float x = ldexpf(rng_range(&rng, -1, 1), exponent);
            s.scene.vertex[i] = i % 9 < 3 ? x : s.scene.vertex[i - 3] + x;
        }
        trees_fit(&s.bvh, &s.scene);
        assert_int_equal(packed_make(layout_find("obb8"), &s.bvh, &s.scene, &s.packed, NULL),
                         STATUS_OK);
        stage_look(&s);
        for (uint32_t r = 0; r < s.packed.node_count; r++) {
            const uint32_t *word = s.packed.word + WORDS * (size_t)r;
            struct wide node;
            s.packed.layout->load(&s.packed, r, &node);
            for (uint32_t c = 0; c < node.child_count && bits(word, 120, 8); c++) {
                bool met[6] = {false};
                check_below(&s, word, node.child[c], &s.suspect.tree.oriented[node.child[c]], met);
                for (uint32_t i = 0; i < 6; i++)
                    assert_true(met[i]);
                seen++;
            }
        }
        stage_free(&s);
    }
    assert_true(seen > 100);
}

/* --- bytes that are wrong --------------------------------------------------------------------- */

/* Moves a stored bound of a child inward, by up to three quarters of what lies between the two;
 * *side is which. False if the record has no oriented boxes. */
static bool mutilate(struct rng *rng, struct oriented_stage *s, uint32_t *record, uint32_t *side,
                     uint32_t *child)
{
    struct wide node;
    *record = rng_below(rng, s->packed.node_count);
    *side = rng_below(rng, 6);
    uint32_t *word = s->packed.word + WORDS * (size_t)*record, j = *side / 2, up = *side % 2;
    if (!bits(word, 120, 8))
        return false;
    s->packed.layout->load(&s->packed, *record, &node);
    const uint32_t slot = rng_below(rng, node.child_count);
    *child = node.child[slot];
    const uint32_t at = 768 + 64 * (j + (up ? 3 : 0)) + 8 * slot;
    const uint32_t lo = bits(word, 768 + 64 * j + 8 * slot, 8);
    const uint32_t hi = bits(word, 768 + 64 * (j + 3) + 8 * slot, 8);
    if (hi - lo < 20)
        return false;
    const uint32_t by = 2 + rng_below(rng, 3 * (hi - lo) / 4), now = up ? hi - by : lo + by;
    word[at / 32] &= ~(0xFFu << at % 32);
    word[at / 32] |= now << at % 32;
    return true;
}

/* Whether the explanation names this child of this record, and this bound of it alone. */
static void assert_named(const struct oriented_stage *s, const struct explanation *out,
                         uint32_t record, uint32_t child, uint32_t side)
{
    const struct explain_step *step = &out->step[out->last];
    assert_int_equal(out->cause, CAUSE_ORIENTED_BOX);
    assert_int_equal(out->end, END_ORIENTED);
    assert_true(step->note.hit && step->note.missed && !step->note.visited);
    assert_int_equal(step->note.above, record);
    assert_true(step->note.below == child && step->record == child);
    assert_true(step->oriented.there && step->oriented.missed);
    const uint32_t *word = s->packed.word + WORDS * (size_t)record;
    int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX};
    int64_t high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
    measure(s, word, child, low, high);
    for (uint32_t i = 0; i < 6; i++) {
        const struct explain_bound *b =
            i % 2 ? &step->oriented.hi[i / 2] : &step->oriented.lo[i / 2];
        assert_true((int64_t)b->exact == (i % 2 ? high : low)[i / 2]);
        assert_int_equal(b->fault != BOUND_OK, i == side);
        assert_int_equal(b->float_steps < 0, i == side);
    }
}

static void the_first_node_that_refuses_is_named(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 7);
    uint32_t told = 0, inner = 0, record, side, child;
    for (uint32_t round = 0; round < 150; round++) {
        struct oriented_stage s;
        stage_make(&rng, &s);
        bool cut = mutilate(&rng, &s, &record, &side, &child);
        stage_look(&s);
        assert_int_equal(packed_check(&s.packed, &s.scene, NULL, NULL) != STATUS_OK,
                         cut && oriented_is_loose(&s.suspect.tree, record, child));
        for (uint32_t n = 0; cut && n < RAYS; n++) {
            struct ray ray = ray_of(&rng, &s.scene, n % TRIANGLES);
            struct hit hit;
            struct explain_case the = case_of(&s.suspect, &ray);
            const struct explain_answer answer = answer_of(&s.suspect, &ray);
            struct replay_change plain = {0};
            assert_int_equal(replay_run(&the.replay, &plain, &ray, &hit, NULL), REPLAY_DONE);
            assert_memory_equal(&hit, &answer.hit, sizeof hit);
            struct explanation out = explained(&s.suspect, &ray);
            if (out.cause != CAUSE_NONE) {
                uint32_t way[64], first = 0;
                const struct box root = s.packed.layout->box(&s.packed, s.packed.root);
                const struct oblique_ray oblique = oriented_ray(&ray, &root);
                uint32_t count = find_way(&s.packed, s.packed.root, out.prim, 0, way);
                const float tmax = out.step[out.last].note.tbest;
                while (
                    first + 1 < count &&
                    !s.packed.layout->misses(&s.packed, way[first], way[first + 1], &oblique, tmax))
                    first++;
                assert_true(first + 1 < count);
                assert_true(way[first] == record && way[first + 1] == child);
                assert_named(&s, &out, record, child, side);
                inner += child < s.packed.node_count;
                told++;
            }
            explain_free(&out);
        }
        stage_free(&s);
    }
    print_message("%u lost hits explained, %u below a node\n", told, inner);
    assert_true(told > 100 && inner > 20 && inner < told);
}

/* --- tests that are wrong --------------------------------------------------------------------- */

static struct oriented_rule wrong_rule;

static bool misses_wrongly(const struct packed *packed, uint32_t ref, uint32_t child,
                           const struct oblique_ray *ray, float tmax)
{
    struct oblique_box box;
    return packed->layout->oblique(packed, ref, child, ray, &box) &&
           oriented_by_rule(&wrong_rule, &box, ray, tmax);
}

struct wrong_engine {
    const struct suspect *right, *wrong;
    const struct ray *only; /* for which it is wrong, or NULL: all */
};

static bool ask_wrong(void *user, const struct ray *ray, size_t count, struct hit *out)
{
    const struct wrong_engine *e = user;
    for (size_t i = 0; i < count; i++) {
        bool is_wrong = !e->only || memcmp(e->only, &ray[i], sizeof *ray) == 0;
        out[i] = answer_of(is_wrong ? e->wrong : e->right, &ray[i]).hit;
    }
    return true;
}

static const struct {
    struct oriented_rule rule;
    enum defect defect;
} wrongs[] = {{{true, false}, DEFECT_ORIENTED_TURNED}, {{false, true}, DEFECT_ORIENTED_SHIFTED}};

/* The same wrong test in C, then in an engine whose bytes C traces rightly. */
static void a_wrong_test_is_named(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 7);
    struct layout bad = *layout_find("obb8");
    bad.misses = misses_wrongly;
    for (uint32_t w = 0; w < ARRAY_COUNT(wrongs); w++) {
        uint32_t told = 0, asked = 0, named = 0;
        wrong_rule = wrongs[w].rule;
        for (uint32_t round = 0; round < 2; round++) {
            struct oriented_stage s;
            stage_make(&rng, &s);
            stage_look(&s);
            struct packed copy = s.packed;
            copy.layout = &bad;
            struct suspect wrong = suspect_make(&s.scene, &s.bvh, &copy, "watertight", "woop");
            for (uint32_t n = 0; n < 60; n++) {
                struct ray ray = ray_of(&rng, &s.scene, n % TRIANGLES);
                struct explanation out = explained(&wrong, &ray);
                if (out.cause != CAUSE_NONE) {
                    assert_int_equal(out.cause, CAUSE_ORIENTED_TEST);
                    assert_int_equal(out.end, END_ORIENTED);
                    assert_true(out.step[out.last].oriented.lo[0].fault == BOUND_OK);
                    told++;
                }
                bool skips = out.cause == CAUSE_NONE || n % 4;
                explain_free(&out);
                if (skips)
                    continue;
                struct explain_case the = case_of(&s.suspect, &ray);
                const struct explain_answer answer = answer_of(&wrong, &ray);
                struct wrong_engine engine = {&s.suspect, &wrong, NULL};
                the.ask = ask_wrong;
                the.ask_user = &engine;
                assert_int_equal(explain_make(&the, &answer, &out, NULL), STATUS_OK);
                asked++;
                if (out.cause != CAUSE_SHADER) { /* too few rays tell of it */
                    assert_int_equal(out.cause, CAUSE_ORIENTED_TEST);
                    assert_int_equal(out.imitation[out.imitated].defect, wrongs[w].defect);
                    named++;
                }
                explain_free(&out);
                engine.only = &ray;
                assert_int_equal(explain_make(&the, &answer, &out, NULL), STATUS_OK);
                assert_int_equal(out.cause, CAUSE_SHADER); /* about one ray it lies */
                explain_free(&out);
            }
            suspect_free(&wrong);
            stage_free(&s);
        }
        print_message("%s: %u; of an engine %u of %u\n", defect_text(wrongs[w].defect), told, named,
                      asked);
        assert_true(told > 20 && asked > 4 && 2 * named > asked);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needs_are_the_places_of_vertices),
        cmocka_unit_test(needs_are_rounded_outward_by_less_than_a_float),
        cmocka_unit_test(the_first_node_that_refuses_is_named),
        cmocka_unit_test(a_wrong_test_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
