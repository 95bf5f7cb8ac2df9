/* Laws of packed_make, packed_make_auto and packed_check. */
#include "tests/tree/packed_fixture.h"

#include "ref/packed/packed_walk.h"

#include <stdio.h>

static enum status fixture_check(struct packed_fixture *f)
{
    f->reason.text[0] = 0;
    return packed_check(&f->packed, &f->scene, &f->faults, &f->reason);
}

static void fixture_make(struct packed_fixture *f, const char *layout)
{
    *f = (struct packed_fixture){.scene = trees_grid(16)};
    f->bvh = trees_make(&f->scene, 2, TREES_BALANCED);
    if (packed_make(layout_find(layout), &f->bvh, &f->scene, &f->packed, &f->reason))
        fail_msg("%s", f->reason.text);
}

static void fixture_free(struct packed_fixture *f)
{
    packed_free(&f->packed);
    bvh_free(&f->bvh);
    scene_free(&f->scene);
}

static const struct packed_faults no_faults;

static void packed_check_finds_nothing_in_good_trees(void **state)
{
    (void)state;
    static const char *const good[] = {"f32", "rf16"};
    for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
        struct packed_fixture f;
        fixture_make(&f, good[i]);
        assert_int_equal(fixture_check(&f), STATUS_OK);
        assert_memory_equal(&f.faults, &no_faults, sizeof no_faults);
        assert_int_equal(f.packed.stack_need, 3);
        fixture_free(&f);
    }
}

/* Bounds that are no halves: rounded any other way than outward, some would be found loose. */
static void packed_check_finds_nothing_in_outward_rounded_bounds(void **state)
{
    (void)state;
    struct rng rng = rng_make(8, 0);
    for (int round = 0; round < 40; round++) {
        struct scene scene = trees_grid(200);
        float size = ldexpf(1, 15 - round); /* 2^15 down to where halves are subnormal */
        for (int i = 0; i < 9 * 200; i++)
            scene.vertex[i] = rng_range(&rng, -size, size);
        struct bvh bvh = trees_make(&scene, 3, TREES_BALANCED);
        struct packed packed;
        struct reason reason = {""};
        assert_int_equal(packed_make(layout_find("rf16"), &bvh, &scene, &packed, &reason), 0);
        if (packed_check(&packed, &scene, NULL, &reason))
            fail_msg("size %a: %s", (double)size, reason.text);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

static void packed_check_finds_a_bound_one_step_too_tight(void **state)
{
    (void)state;
    for (uint32_t node = 0; node < 15; node++)
        for (uint32_t k = 0; k < 6; k++) {
            struct packed_fixture f;
            fixture_make(&f, "f32");
            uint32_t *word = &f.packed.word[8 * node + (k < 3 ? k : k + 1)];
            float x = float_from_bits(*word);
            *word = float_bits(nextafterf(x, k < 3 ? 1e9f : -1e9f));
            assert_int_equal(fixture_check(&f), STATUS_INPUT);
            assert_int_equal(f.faults.loose_boxes, 1);
            assert_int_equal(f.faults.first, PACKED_BOUND);
            f.faults.loose_boxes = 0;
            f.faults.first = PACKED_SOUND;
            assert_memory_equal(&f.faults, &no_faults, sizeof no_faults);
            assert_non_null(strstr(f.reason.text, " bounds ["));
            fixture_free(&f);
        }
}

static void packed_check_takes_nan_bounds_for_loose(void **state)
{
    (void)state;
    struct packed_fixture f;
    fixture_make(&f, "rf16");
    f.packed.word[1] |= 0x7E00; /* y of the root */
    assert_int_equal(fixture_check(&f), STATUS_INPUT);
    assert_int_equal(f.faults.loose_boxes, 1);
    assert_int_equal(f.faults.first, PACKED_BOUND);
    fixture_free(&f);
}

/* One word changed, and the faults that must be counted. */
struct packed_spoilt {
    const char *layout;
    uint32_t word, value;
    struct packed_faults faults;
    const char *reason;
};

/* f32: node n's words begin at 8 n; 3 is first, 7 count. rf16: records 0, 1, 2 inner, leaves 3
 * (triangles 0, 1), 5 (2, 3), inner 7, leaves 8, 10, inner 12. */
static const struct packed_spoilt spoilt[] = {
    {"f32",
     3,
     15,
     {.first = PACKED_REFERENCE, .bad_refs = 1, .lost_prims = 8},
     "record 0: a child"},
    {"f32",
     3,
     UINT32_MAX,
     {.first = PACKED_REFERENCE, .bad_refs = 1, .lost_prims = 8},
     "record 0: a child"},
    {"f32",
     3,
     0,
     {.first = PACKED_REFERENCE, .cycles = 1, .lost_prims = 8},
     "record 0 is reached more than once"},
    {"f32", 3, 5, {.first = PACKED_REFERENCE, .cycles = 1, .lost_prims = 8}, "record 5"},
    {"f32",
     8 * 14 + 3,
     12,
     {.first = PACKED_TWICE, .lost_prims = 2, .double_prims = 2, .loose_boxes = 1},
     "second time"},
    {"f32", 8 * 14 + 7, 1, {.first = PACKED_LOST, .lost_prims = 1}, "triangle 15 is in no leaf"},
    {"f32",
     8 * 14 + 7,
     0,
     {.first = PACKED_REFERENCE, .bad_refs = 1, .cycles = 1, .lost_prims = 2},
     "record 14"},
    {"f32",
     8 * 14 + 7,
     UINT32_MAX,
     {.first = PACKED_ITEM, .bad_prims = 1, .lost_prims = 2},
     "a leaf of 4294967295"},
    {"rf16",
     3,
     0x0001FFFF,
     {.first = PACKED_REFERENCE, .bad_refs = 1, .lost_prims = 8},
     "record 0: a child"},
    {"rf16",
     3,
     0x00010000,
     {.first = PACKED_REFERENCE, .cycles = 1, .lost_prims = 8},
     "record 0 is reached more than once"},
    {"rf16",
     4 * 4,
     0x00000000,
     {.first = PACKED_TWICE, .double_prims = 1, .lost_prims = 1},
     "triangle 0 a second time"},
    {"rf16",
     4 * 4,
     0x00100001,
     {.first = PACKED_ITEM, .bad_prims = 1, .lost_prims = 1},
     "names triangle 16 of 16"},
    {"rf16",
     3 * 4 + 3,
     0x80000001,
     {.first = PACKED_LOST, .lost_prims = 1},
     "triangle 1 is in no leaf"},
    {"rf16",
     3 * 4 + 3,
     0x80000003,
     {.first = PACKED_TWICE, .double_prims = 1},
     "triangle 0 a second time"},
    {"rf16",
     3 * 4 + 3,
     0x80000000,
     {.first = PACKED_REFERENCE, .bad_refs = 2, .lost_prims = 2},
     "record 3: a child"},
};

static void packed_check_counts_each_kind_of_fault(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(spoilt); i++) {
        const struct packed_spoilt *s = &spoilt[i];
        struct packed_fixture f;
        fixture_make(&f, s->layout);
        f.packed.word[s->word] = s->value;
        enum status status = fixture_check(&f);
        struct packed_faults *got = &f.faults;
        if (status != STATUS_INPUT || memcmp(got, &s->faults, sizeof *got) != 0 ||
            !strstr(f.reason.text, s->reason))
            fail_msg("%s word %u: status %d, loose %u refs %u cycles %u lost %u double %u bad %u "
                     "deep %u, '%s'",
                     s->layout, s->word, status, got->loose_boxes, got->bad_refs, got->cycles,
                     got->lost_prims, got->double_prims, got->bad_prims, got->too_deep,
                     f.reason.text);
        fixture_free(&f);
    }
}

/* What a walk of its own finds: nodes reached again, children that are not there, and the first of
 * each. */
struct packed_ways {
    uint32_t repeats, bad, repeat_ref, bad_ref;
};

static void walk_ways(const struct packed *packed, struct packed_ways *out)
{
    static uint32_t queue[4096];
    static bool seen[4096];
    uint32_t count = 0, least = layout_is_wide(packed->layout) ? 1 : 2;
    assert_true(packed->ref_count <= ARRAY_COUNT(queue));
    memset(seen, 0, sizeof seen);
    *out = (struct packed_ways){0};
    queue[count++] = packed->root;
    seen[packed->root] = true;
    for (uint32_t i = 0; i < count; i++) {
        struct wide node;
        packed->layout->load(packed, queue[i], &node);
        bool leaf = node.child_count == 0 && node.item_count > 0;
        if (!leaf && node.child_count < least) {
            out->bad_ref = out->bad ? out->bad_ref : queue[i];
            out->bad += least - node.child_count;
        }
        for (uint32_t c = 0; c < node.child_count; c++) {
            uint32_t ref = node.child[c];
            if (seen[ref])
                out->repeat_ref = out->repeats++ ? out->repeat_ref : ref;
            else
                queue[count++] = ref;
            seen[ref] = true;
        }
    }
}

/* Any bit of any word of every layout, and another one half the words away. */
static void packed_check_describes_references_of_every_layout(void **state)
{
    (void)state;
    uint32_t repeated = 0, lost = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed_fixture f;
        fixture_make(&f, layouts_all[l]->name);
        for (uint32_t bit = 0; bit < 32 * f.packed.word_count; bit += 1 + (uint32_t)l % 3) {
            struct packed_ways ways;
            char expected[200];
            uint32_t other = (bit / 32 + f.packed.word_count / 2) % f.packed.word_count;
            uint32_t flip = 1u << bit % 32, second = bit % 2 ? flip : 0;
            f.packed.word[bit / 32] ^= flip;
            f.packed.word[other] ^= second;
            walk_ways(&f.packed, &ways);
            enum status status = fixture_check(&f);
            assert_int_equal(f.faults.bad_refs, ways.bad);
            assert_int_equal(f.faults.cycles, ways.repeats);
            if (ways.bad > 0 || ways.repeats > 0) {
                uint32_t ref = ways.bad > 0 ? ways.bad_ref : ways.repeat_ref;
                const char *name = f.packed.layout->name;
                struct packed_name at = packed_name(&f.packed, ref);
                if (ways.bad > 0)
                    snprintf(expected, sizeof expected,
                             "%s: %s: a child reference lies outside the %u records", name, at.text,
                             f.packed.node_count);
                else
                    snprintf(expected, sizeof expected, "%s: %s is reached more than once", name,
                             at.text);
                assert_int_equal(status, STATUS_INPUT);
                assert_int_equal(f.faults.first, PACKED_REFERENCE);
                assert_string_equal(f.reason.text, expected);
                repeated += ways.repeats > 0;
                lost += ways.bad > 0;
            }
            f.packed.word[bit / 32] ^= flip;
            f.packed.word[other] ^= second;
        }
        fixture_free(&f);
    }
    if (repeated < 500 || lost < 500)
        fail_msg("%u and %u are too few", repeated, lost);
}

static void packed_check_measures_the_stack(void **state)
{
    (void)state;
    struct packed_fixture f;
    fixture_make(&f, "rf16");
    f.packed.stack_need = 2;
    assert_int_equal(fixture_check(&f), STATUS_INPUT);
    assert_int_equal(f.faults.too_deep, 1);
    assert_int_equal(f.faults.first, PACKED_STACK);
    assert_string_equal(f.reason.text,
                        "rf16: a path needs 3 stack entries, the packed tree says 2");
    fixture_free(&f);
}

static void packed_check_finds_a_root_out_of_range(void **state)
{
    (void)state;
    struct packed_fixture f;
    fixture_make(&f, "f32");
    f.packed.root = 15;
    assert_int_equal(fixture_check(&f), STATUS_INPUT);
    assert_int_equal(f.faults.bad_refs, 1);
    assert_int_equal(f.faults.lost_prims, 16);
    fixture_free(&f);
}

/* Ends, without reading outside anything, on any words. */
static void packed_check_survives_garbage(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 0);
    for (size_t l = 0; layouts[l]; l++)
        for (int round = 0; round < 300; round++) {
            struct packed_fixture f;
            fixture_make(&f, layouts[l]->name);
            uint32_t mask = round % 2 ? UINT32_MAX : 0x801F001F;
            for (uint32_t i = 0; i < f.packed.word_count; i++)
                if (round % 3 || rng_below(&rng, 8) == 0)
                    f.packed.word[i] = (uint32_t)rng_u64(&rng) & mask;
            assert_int_equal(fixture_check(&f), STATUS_INPUT);
            fixture_free(&f);
        }
}

/* 16 triangles in leaves of two. rtrs_direct tests 0 - 1 .. 14: triangle 15 is lost, and every box
 * but the root's misses the shifted triangle. rtrs_rf and the paper lose one triangle as well. */
static void packed_check_sees_the_seeds_numbering(void **state)
{
    (void)state;
    static const char *const lost[][2] = {{"rtrs_direct", "triangle 15 is in no leaf"},
                                          {"rtrs_rf", "triangle 15 is in no leaf"},
                                          {"rtrs_rf_paper", "triangle 0 is in no leaf"}};
    for (size_t i = 0; i < ARRAY_COUNT(lost); i++) {
        struct packed_fixture f;
        fixture_make(&f, lost[i][0]);
        assert_int_equal(fixture_check(&f), STATUS_INPUT);
        assert_int_equal(f.faults.lost_prims, 1);
        assert_int_equal(f.faults.double_prims + f.faults.bad_prims + f.faults.cycles, 0);
        assert_non_null(strstr(f.reason.text, lost[i][1]));
        if (i < 2)
            assert_true(f.faults.loose_boxes > 8);
        else
            assert_int_equal(f.faults.loose_boxes, 0); /* all bounds here are halves */
        fixture_free(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packed_check_finds_nothing_in_good_trees),
        cmocka_unit_test(packed_check_finds_nothing_in_outward_rounded_bounds),
        cmocka_unit_test(packed_check_finds_a_bound_one_step_too_tight),
        cmocka_unit_test(packed_check_takes_nan_bounds_for_loose),
        cmocka_unit_test(packed_check_counts_each_kind_of_fault),
        cmocka_unit_test(packed_check_describes_references_of_every_layout),
        cmocka_unit_test(packed_check_measures_the_stack),
        cmocka_unit_test(packed_check_finds_a_root_out_of_range),
        cmocka_unit_test(packed_check_survives_garbage),
        cmocka_unit_test(packed_check_sees_the_seeds_numbering),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
