/* Explanations of packed words that are spoilt on purpose: each kind of damage has its cause, in
 * every layout that can have it; healthy trees have none. Also steps between floats. */
#include "ref/explain/explain.h"
#include "ref/explain/steps.h"
#include "ref/base/half.h"
#include "scenes/rays/rays.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/explain/explained.h"
#include "tests/support/faults.h"

#include <math.h>

#define TRIANGLES 64u

/* A healthy tree whose words a test then spoils. */
struct words_spoilt {
    struct scene scene;
    struct subject subject;
    struct suspect suspect;
    struct ray ray[TRIANGLES];
};

static void spoilt_make(struct words_spoilt *s, const char *layout, const char *box)
{
    s->scene = trees_grid(TRIANGLES);
    s->subject = subject_make(&s->scene, "median", 4, SEED_EPS, layout);
    assert_int_equal(s->subject.status, STATUS_OK);
    s->suspect = suspect_make(&s->scene, &s->subject.bvh, &s->subject.packed, box, "mt");
    for (uint32_t prim = 0; prim < TRIANGLES; prim++)
        s->ray[prim] = ray_at_triangle(&s->scene, prim);
    assert_cause(&s->suspect, s->ray, TRIANGLES, CAUSE_NONE, 0);
}

static void spoilt_free(struct words_spoilt *s)
{
    suspect_free(&s->suspect);
    subject_free(&s->subject);
    scene_free(&s->scene);
}

/* The words of the record of tree node `node`. */
static uint32_t *words_of(struct words_spoilt *s, uint32_t node)
{
    struct packed *packed = &s->subject.packed;
    return packed->word + (size_t)s->suspect.tree.record[node] * packed->layout->node_bytes / 4;
}

/* After the words have changed: whole-tree facts are found again. */
static void spoilt_again(struct words_spoilt *s)
{
    suspect_free(&s->suspect);
    s->suspect = suspect_make(&s->scene, &s->subject.bvh, &s->subject.packed, "robust", "mt");
}

static void swapped_children_are_a_child_reference(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    uint32_t *root = words_of(&s, 0), right = s.subject.bvh.node[0].snd;
    /* Both children are the second: the first one's triangles are gone. */
    root[3] = (root[3] & 0xFFFFu) | root[3] << 16;
    spoilt_again(&s);
    assert_cause(&s.suspect, s.ray, TRIANGLES, CAUSE_CHILD_REFERENCE, TRIANGLES / 2 - 2);
    for (uint32_t prim = 0; prim < TRIANGLES; prim++) {
        struct explanation out = explained(&s.suspect, &s.ray[prim]);
        if (out.cause != CAUSE_NONE) {
            assert_int_equal(out.end, END_REFERENCE);
            assert_int_equal(out.last, 1);
            assert_int_equal(out.step[0].ref, REF_OTHER);
            assert_true(out.step[1].note.node != right);
        }
        explain_free(&out);
    }
    spoilt_free(&s);
}

static void a_leaf_read_as_an_inner_node_is_a_child_reference(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    uint32_t leaf = s.suspect.tree.leaf[20];
    words_of(&s, leaf)[3] &= 0x7FFFFFFFu;
    spoilt_again(&s);
    assert_int_equal(cause_of(&s.suspect, &s.ray[20]), CAUSE_CHILD_REFERENCE);
    spoilt_free(&s);
}

/* f32: 32-bit references and items, cut by hand as a layout with narrow fields would. */
static void cut_numbers_are_truncated(void **state)
{
    (void)state;
    struct scene scene = trees_grid(70000);
    struct subject s = subject_make(&scene, "median", 1, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    for (uint32_t i = 0; i < s.packed.item_count; i++)
        s.packed.item[i] &= 0xFFFFu;
    struct ray ray = ray_at_triangle(&scene, 69999);
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_INDEX_TRUNCATED);
    ray = ray_at_triangle(&scene, 60000);
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_NONE);
    suspect_free(&suspect);
    subject_pack(&s, "f32");
    for (uint32_t i = 0; i < s.packed.node_count; i++)
        if (s.packed.word[8 * (size_t)i + 7] == 0)
            s.packed.word[8 * (size_t)i + 3] &= 0x7FFFu;
    suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    uint32_t wrong = 0;
    for (uint32_t prim = 0; prim < scene.tri_count; prim += 501) {
        ray = ray_at_triangle(&scene, prim);
        enum cause cause = cause_of(&suspect, &ray);
        wrong += cause != CAUSE_NONE;
        assert_true(cause == CAUSE_NONE || cause == CAUSE_REFERENCE_TRUNCATED);
    }
    assert_true(wrong > 20);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

/* Replaces both halves of word `axis` of a leaf's record. */
static void set_halves(struct words_spoilt *s, uint32_t prim, int axis, uint16_t lo, uint16_t hi)
{
    words_of(s, s->suspect.tree.leaf[prim])[axis] = lo | (uint32_t)hi << 16;
    spoilt_again(s);
}

static void an_infinite_half_is_an_overflow(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    set_halves(&s, 7, 0, 0x7C00, 0x7C00);
    struct explanation out = explained(&s.suspect, &s.ray[7]);
    assert_int_equal(out.cause, CAUSE_HALF_OVERFLOW);
    assert_int_equal(out.step[out.last].lo[0].fault, BOUND_OVERFLOW);
    explain_free(&out);
    set_halves(&s, 7, 0, 0x7E00, 0x7E00); /* a NaN bounds nothing, so that nothing is lost */
    assert_int_equal(cause_of(&s.suspect, &s.ray[7]), CAUSE_NONE);
    spoilt_free(&s);
}

/* The ray at a triangle passes through a box one half step too small only if it is aimed there. */
static struct ray ray_at_upper_x(const struct words_spoilt *s, uint32_t prim)
{
    uint32_t leaf = s->suspect.tree.leaf[prim];
    float x = s->suspect.tree.exact[leaf].hi[0];
    for (uint32_t p = 0; p < TRIANGLES; p++) {
        float v[3][3];
        scene_tri(&s->scene, p, v);
        if (s->suspect.tree.leaf[p] == leaf && v[1][0] == x)
            return (struct ray){{v[1][0], v[1][1], -1}, 0, {0, 0, 1}, 10};
    }
    fail_msg("no vertex at %a", (double)x);
    return (struct ray){0};
}

static void bounds_inside_are_rounded_or_another_box(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    uint32_t leaf = s.suspect.tree.leaf[30];
    struct ray ray = ray_at_upper_x(&s, 30);
    const struct box *box = &s.subject.bvh.node[leaf].bounds;
    uint16_t lo = half_down(box->lo[0]).bits, hi = half_down(box->hi[0]).bits;
    assert_int_equal(cause_of(&s.suspect, &ray), CAUSE_NONE);
    set_halves(&s, 30, 0, lo, (uint16_t)(hi - 1));
    struct explanation out = explained(&s.suspect, &ray);
    assert_int_equal(out.cause, CAUSE_ROUNDED_INWARD);
    assert_true(out.step[out.last].hi[0].half_steps == -1.0);
    assert_true(out.step[out.last].hi[0].float_steps == -8192);
    explain_free(&out);
    set_halves(&s, 30, 0, lo, (uint16_t)(hi - 2));
    assert_int_equal(cause_of(&s.suspect, &ray), CAUSE_STORED_BOX);
    spoilt_free(&s);
}

static void a_box_cut_in_the_words_is_a_stored_box_and_in_the_tree_a_cut_one(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "f32", "robust");
    uint32_t leaf = s.suspect.tree.leaf[40];
    float lo = s.subject.bvh.node[leaf].bounds.lo[1], hi = s.subject.bvh.node[leaf].bounds.hi[1];
    words_of(&s, leaf)[5] = float_bits(lo + 0.01f * (hi - lo));
    spoilt_again(&s);
    assert_int_equal(cause_of(&s.suspect, &s.ray[40]), CAUSE_STORED_BOX);
    s.subject.bvh.node[leaf].bounds.hi[1] = lo + 0.01f * (hi - lo);
    assert_int_equal(cause_of(&s.suspect, &s.ray[40]), CAUSE_CUT_BOX);
    spoilt_free(&s);
}

static void a_flushed_subnormal_is_named(void **state)
{
    (void)state;
    const float v[3][3] = {{-6e-5f, -6e-5f, 0}, {-2e-5f, -6e-5f, 0}, {-6e-5f, -2e-5f, 0}};
    struct scene scene = trees_copies(2, v);
    struct subject s = subject_make(&scene, "median", 2, SEED_EPS, "rf16");
    assert_int_equal(s.packed.word[0], 0x8400u); /* outward: -2^-14 to 0 */
    s.packed.word[0] = 0; /* as if -6e-5 had been kept as a subnormal and read as 0 */
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    const struct ray ray = {{-5e-5f, -5e-5f, -1}, 0, {0, 0, 1}, 10};
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_HALF_SUBNORMAL_FLUSHED);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

static void a_cleared_slot_is_a_sentinel(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    uint32_t leaf = s.suspect.tree.leaf[50];
    uint32_t prim = s.subject.bvh.prim[s.subject.bvh.node[leaf].item_first];
    words_of(&s, leaf)[4] &= 0xFFFF0000u; /* slot 0 */
    spoilt_again(&s);
    struct explanation out = explained(&s.suspect, &s.ray[prim]);
    assert_int_equal(out.cause, CAUSE_SENTINEL);
    assert_int_equal(out.end, END_SLOT);
    assert_int_equal(out.slot, 0);
    assert_int_equal(out.slot_stored, 0);
    explain_free(&out);
    spoilt_free(&s);
}

static void a_wrong_item_is_named(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "f32", "robust");
    uint32_t lost = s.subject.packed.item[9];
    s.subject.packed.item[9] = (lost + 11) % TRIANGLES;
    spoilt_again(&s);
    assert_int_equal(cause_of(&s.suspect, &s.ray[lost]), CAUSE_WRONG_ITEM);
    spoilt_free(&s);
}

/* One count too small: the last slot of that leaf is never looked at. */
static void an_uncounted_slot_is_not_read(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "rf16", "robust");
    uint32_t leaf = s.suspect.tree.leaf[33];
    const struct bvh_node *node = &s.subject.bvh.node[leaf];
    uint32_t prim = s.subject.bvh.prim[node->item_first + node->item_count - 1];
    words_of(&s, leaf)[3]--;
    spoilt_again(&s);
    assert_int_equal(cause_of(&s.suspect, &s.ray[prim]), CAUSE_SLOT_NOT_READ);
    spoilt_free(&s);
}

static void a_short_stack_and_a_cycle_are_named(void **state)
{
    (void)state;
    static const float one[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(16, one);
    struct subject s = subject_make(&scene, "median", 1, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    const struct ray ray = {{0, 0, -1}, 0, {0, 0, 1}, 10};
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_NONE);
    s.packed.stack_need--;
    struct explanation out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_STACK);
    assert_int_equal(out.replayed_end, REPLAY_STACK);
    assert_false(out.opinion.allowed);
    explain_free(&out);
    s.packed.stack_need++;
    s.packed.word[8 * (size_t)s.bvh.node[0].fst + 3] = 0; /* a child that is its own ancestor */
    out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_CHILD_REFERENCE);
    assert_true(out.replayed_end != REPLAY_DONE);
    explain_free(&out);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

/* Two faults on one ray: no single repair helps, the pair does. */
static void two_faults_are_told_together(void **state)
{
    (void)state;
    struct words_spoilt s;
    spoilt_make(&s, "f32", "robust");
    uint32_t leaf = s.suspect.tree.leaf[40];
    const struct bvh_node *node = &s.subject.bvh.node[leaf];
    uint32_t prim = s.subject.bvh.prim[node->item_first];
    words_of(&s, leaf)[0] = float_bits(INFINITY);
    s.subject.packed.item[node->item_first] = (prim + 11) % TRIANGLES;
    spoilt_again(&s);
    struct explanation out = explained(&s.suspect, &s.ray[prim]);
    assert_int_equal(out.cause, CAUSE_WRONG_ITEM);
    assert_int_equal(out.needed, 1u << REPAIR_ITEM_OTHER | 1u << REPAIR_BOX_OVERFLOW);
    explain_free(&out);
    spoilt_free(&s);
}

/* The right cause is right because the wrong repairs do not help. */
static void a_healthy_answer_has_no_cause(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "grid:height=0", "sphere", "terrain:k=4"};
    static struct ray ray[500];
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++)
        for (int l = 0; l < 2; l++) {
            struct scene scene;
            assert_int_equal(scene_open(specs[i], 1, &scene, NULL), STATUS_OK);
            assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 1, 500, ray, NULL),
                             STATUS_OK);
            struct subject s = subject_repaired(&scene, l ? "rf16" : "f32");
            struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
            assert_cause(&suspect, ray, 500, CAUSE_NONE, 0);
            suspect_free(&suspect);
            subject_free(&s);
            scene_free(&scene);
        }
}

static void steps_are_counted_in_both_formats(void **state)
{
    (void)state;
    assert_int_equal(float_steps(1.0f, nextafterf(1.0f, 2.0f)), 1);
    assert_int_equal(float_steps(0.0f, -0.0f), 0);
    assert_int_equal(float_steps(-0x1p-149f, 0x1p-149f), 2);
    assert_int_equal(float_steps(INFINITY, 3.40282347e38f), -1);
    for (uint32_t bits = 0; bits + 1 < 0x7C00; bits++) {
        float a = half_to_float((struct half){(uint16_t)bits});
        float b = half_to_float((struct half){(uint16_t)(bits + 1)});
        assert_true(half_steps(a, b) == 1.0);
        assert_true(half_steps(-a, -b) == -1.0);
        assert_true(half_steps(a, 0.5f * (a + b)) == 0.5);
    }
    assert_true(half_steps(65504.0f, INFINITY) == 1.0);
    assert_true(half_steps(65504.0f, 65520.0f) == 0.5);
    assert_true(isnan(half_steps(NAN, 1.0f)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(swapped_children_are_a_child_reference),
        cmocka_unit_test(a_leaf_read_as_an_inner_node_is_a_child_reference),
        cmocka_unit_test(cut_numbers_are_truncated),
        cmocka_unit_test(an_infinite_half_is_an_overflow),
        cmocka_unit_test(bounds_inside_are_rounded_or_another_box),
        cmocka_unit_test(a_box_cut_in_the_words_is_a_stored_box_and_in_the_tree_a_cut_one),
        cmocka_unit_test(a_flushed_subnormal_is_named),
        cmocka_unit_test(a_cleared_slot_is_a_sentinel),
        cmocka_unit_test(a_wrong_item_is_named),
        cmocka_unit_test(an_uncounted_slot_is_not_read),
        cmocka_unit_test(a_short_stack_and_a_cycle_are_named),
        cmocka_unit_test(two_faults_are_told_together),
        cmocka_unit_test(a_healthy_answer_has_no_cause),
        cmocka_unit_test(steps_are_counted_in_both_formats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
