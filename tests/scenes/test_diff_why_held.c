/* Why two paths part: what has no cause, the published profile, and pictures that are not their
 * walks. */
#include "tests/scenes/diff_why_fixture.h"

/* Paths of two engines that agree on every hit, but not on what follows from them. */
static void what_has_no_cause_is_unexplained(void **state)
{
    (void)state;
    struct diff_walk a, b;
    struct path_why found;
    size_t cut = 0, lit = 0;
    walk(honest, &a);
    walk(honest, &b);
    for (size_t i = 0; i < a.count; i++) {
        if (a.length[i] < 2)
            continue;
        b.length[i]--; /* ended early */
        assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
        assert_int_equal(found.why, WHY_UNEXPLAINED);
        assert_int_equal(found.segment, b.length[i]);
        b.length[i]++;
        struct walk_light *light = &b.light[i * b.bounces * b.lights];
        light->asked = !light->asked;
        assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
        assert_int_equal(found.why, WHY_UNEXPLAINED);
        assert_int_equal(found.light, 0);
        light->asked = !light->asked;
        if (light->asked) { /* the same answer, taken for a shadow here and for none there */
            light->shadowed = !light->shadowed;
            assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
            assert_int_equal(found.why, WHY_UNEXPLAINED);
            assert_int_equal(found.light, 0);
            light->shadowed = !light->shadowed;
            lit++;
        }
        cut++;
    }
    assert_true(cut > 20 && lit > 20);
    walk_free(&a);
    walk_free(&b);
}

/* --- one difference made by hand, at each place of each path --------------------------------- */

enum difference {
    HIT_ULP,      /* t of the segment's own hit */
    LIGHT_RAY,    /* the end of a shadow ray */
    LIGHT_FAR,    /* how far its light is, so that its shadow is another */
    LIGHT_ULP,    /* t of a hit that is taken for a shadow on one side alone */
    LIGHT_SHADOW, /* the same hit, taken otherwise */
    LIGHT_ASKED,  /* a light that one side does not ask for */
    LIGHT_WRONG,  /* a shadow ray's answer is wrong */
    DIFFERENCES
};

/* Makes it; false if it does not apply there. */
static bool differ(enum difference kind, struct walk_step *step, struct walk_light *light)
{
    switch (kind) {
    case HIT_ULP:
        step->hit.t = nextafterf(step->hit.t, 0);
        return step->hit.prim != ABI_NO_PRIM;
    case LIGHT_RAY:
        light->ray.tmax = nextafterf(light->ray.tmax, INFINITY);
        return light->asked && light->hit.prim == ABI_NO_PRIM;
    case LIGHT_FAR:
        light->far = nextafterf(light->far, 0);
        light->shadowed = !light->shadowed;
        return light->asked;
    case LIGHT_ULP:
        light->hit.t = nextafterf(light->hit.t, 0);
        light->shadowed = !light->shadowed;
        return light->asked && light->hit.prim != ABI_NO_PRIM;
    case LIGHT_SHADOW:
        light->shadowed = !light->shadowed;
        return light->asked;
    case LIGHT_ASKED:
        light->asked = !light->asked;
        return true;
    default:
        light->hit = (struct hit){0.5f, 0.25f, 0.25f, 0};
        light->shadowed = true;
        return light->asked && light->hit.prim != ABI_NO_PRIM;
    }
}

/* What the paths part for, if nothing differed before. */
static const enum why expected[DIFFERENCES] = {
    [LIGHT_FAR] = WHY_DRIFT,         [LIGHT_ULP] = WHY_ALLOWED, [LIGHT_SHADOW] = WHY_UNEXPLAINED,
    [LIGHT_ASKED] = WHY_UNEXPLAINED, [LIGHT_WRONG] = WHY_WRONG,
};

static struct path_why found_of(const struct diff_walk *a, const struct diff_walk *b, size_t i)
{
    struct path_why found;
    assert_int_equal(why_paths(&s.judges, a, b, i, &found, &reason), STATUS_OK);
    return found;
}

static void must_part(const struct path_why *found, enum why why, uint32_t segment, uint32_t light)
{
    if (found->why != why || found->segment != segment || found->light != light)
        fail_msg("%s at segment %u, light %u, not %s at %u, %u", why_name(found->why),
                 found->segment, found->light, why_name(why), segment, light);
}

/* What comes last has no cause of its own: it is drift behind a difference, else unexplained. */
static void cut_must_be(const struct diff_walk *a, struct diff_walk *b, size_t i, uint32_t behind,
                        enum why why)
{
    if (a->length[i] <= behind + 1)
        return;
    b->length[i]--;
    struct path_why found = found_of(a, b, i), turned = found_of(b, a, i);
    must_part(&found, why, b->length[i], WHY_NO_LIGHT);
    must_part(&turned, why, b->length[i], WHY_NO_LIGHT);
    assert_false(found.answer[0].judged || found.answer[1].judged);
    b->length[i]++;
}

static size_t difference_is_found(enum difference kind, const struct diff_walk *a,
                                  struct diff_walk *b, size_t i, uint32_t k, uint32_t l)
{
    struct walk_step *step = walk_step_of(b, i, k), step_was = *step;
    struct walk_light *light = walk_light_of(b, i, k, l), light_was = *light;
    size_t made = differ(kind, step, light);
    if (made && (kind == HIT_ULP || kind == LIGHT_RAY)) {
        struct path_why found = found_of(a, b, i);
        must_part(&found, WHY_ROUNDING, a->length[i], WHY_NO_LIGHT);
        cut_must_be(a, b, i, k, WHY_DRIFT);
    } else if (made) {
        struct path_why found = found_of(a, b, i), turned = found_of(b, a, i);
        must_part(&found, expected[kind], k, l);
        must_part(&turned, expected[kind], k, l);
        if (kind == LIGHT_ULP)
            assert_true(found.verdict == VERDICT_BORDER && turned.verdict == VERDICT_BORDER);
        if (kind == LIGHT_WRONG)
            assert_true(found.side == 1 && turned.side == 0);
    }
    *step = step_was;
    *light = light_was;
    return made;
}

static void paths_part_where_they_differ(void **state)
{
    (void)state;
    struct diff_walk a, b;
    size_t made[DIFFERENCES][2] = {{0}};
    walk(honest, &a);
    walk(honest, &b);
    assert_int_equal(a.lights, 2);
    for (size_t i = 0; i < a.count; i++) {
        for (uint32_t k = 0; k < a.length[i]; k++)
            for (uint32_t l = 0; l < a.lights && walk_step_of(&a, i, k)->hit.prim != ABI_NO_PRIM;
                 l++)
                for (enum difference kind = 0; kind < DIFFERENCES; kind++)
                    made[kind][l] += difference_is_found(kind, &a, &b, i, k, l);
        cut_must_be(&a, &b, i, 0, WHY_UNEXPLAINED);
    }
    for (enum difference kind = 0; kind < DIFFERENCES; kind++)
        if (made[kind][0] < 20 || made[kind][1] < 20)
            fail_msg("difference %d: %zu and %zu", (int)kind, made[kind][0], made[kind][1]);
    walk_free(&a);
    walk_free(&b);
}

static void the_published_profile_asks_otherwise(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    forget();
    prepare(PROFILE_RTRS);
    count_whys(NONE, 0, why);
    assert_int_equal(why[WHY_SAME], WIDTH * HEIGHT);
    count_whys(OTHER_PRIM, 0, why);
    assert_true(why[WHY_WRONG] > 50);
    count_whys(ULP, 0, why);
    assert_int_equal(why[WHY_WRONG] + why[WHY_RENDERER] + why[WHY_UNEXPLAINED], 0);
    a_walk_is_the_picture(state);
    forget();
    prepare(PROFILE_REPAIRED);
}

/* Whole pictures: what a renderer of its own made of right answers. */
static void pictures_are_held_to_their_walks(void **state)
{
    (void)state;
    struct engine_options options = {.device = -1};
    struct side other;
    struct pair pair;
    size_t *pixel, count, at = 0;
    assert_int_equal(side_draw(&s.cpu, &s.view, &reason), STATUS_OK);
    assert_int_equal(side_open(engine_find("cpu"), &options, &s.job, true, &other, &reason),
                     STATUS_OK);
    assert_int_equal(side_draw(&other, &s.view, &reason), STATUS_OK);
    assert_int_equal(pair_compare(&s.cpu, &other, &pair, &pixel, &count, &reason), STATUS_OK);
    assert_true(pair.same_bits && pair_agrees(&pair));
    assert_int_equal(count, 0);
    free(pixel);
    while (other.frame.segment[at * 3].prim == ABI_NO_PRIM ||
           other.frame.segment[at * 3].asked == 0)
        at++;
    other.frame.segment[at * 3].shadowed ^= 1u;
    other.frame.pixel[at + 1] ^= 0x40u;
    assert_int_equal(pair_compare(&s.cpu, &other, &pair, &pixel, &count, &reason), STATUS_OK);
    assert_int_equal(count, 2);
    assert_int_equal(pair.diff.field[PATH_SHADOWED], 1);
    assert_int_equal(pair.diff.excess, 1);
    assert_int_equal(pair.diff.largest, 0x40);
    assert_false(pair_agrees(&pair));
    assert_int_equal(pair_explain(&s.cpu, &other, &s.view, s.oracle, pixel, count, &pair, &reason),
                     STATUS_OK);
    assert_int_equal(pair.why[WHY_RENDERER], 2);
    assert_int_equal(pair.example[WHY_RENDERER][0].pixel, at);
    assert_int_equal(pair.example[WHY_RENDERER][0].field, PATH_SHADOWED);
    assert_int_equal(pair.example[WHY_RENDERER][0].why.side, 1);
    assert_int_equal(pair.example[WHY_RENDERER][1].pixel, at + 1);
    other.model.bits = false; /* explained or not, it is a fault */
    pair.same_bits = false;
    assert_false(pair_agrees(&pair));
    free(pixel);
    side_close(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_has_no_cause_is_unexplained),
        cmocka_unit_test(paths_part_where_they_differ),
        cmocka_unit_test(the_published_profile_asks_otherwise),
        cmocka_unit_test(pictures_are_held_to_their_walks),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
