/* The catalogue of hard cases: what every entry must be, and the relations between rays that some
 * are made of, against answers that keep them and answers that do not. */
#include "tests/hard/members.h"
#include "tests/hard/parts.h"
#include "tests/hard/relations.h"
#include "ref/primitives/test_run.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static struct hard_made *made_new(const struct hard_case *one)
{
    struct reason reason = {""};
    struct hard_made *made = calloc(1, sizeof *made);
    assert_non_null(made);
    if (one && hard_make(one, made, &reason))
        fail_msg("%s", reason.text);
    return made;
}

static void made_drop(struct hard_made *made)
{
    hard_free(made);
    free(made);
}

static void cases_are_numbered_and_documented(void **state)
{
    bool listed[61] = {false};
    (void)state;
    for (size_t i = 0; hard_case_at(i); i++) {
        const struct hard_case *one = hard_case_at(i);
        if (i > 0)
            assert_true(one->number > hard_case_at(i - 1)->number);
        if (one->number <= 60)
            listed[one->number] = true;
        assert_true(strlen(one->recipe) > 8 && strlen(one->expected) > 3);
        assert_true(strlen(one->source) > 8);
        assert_null(strpbrk(one->name, " ._*?["));
    }
    for (int n = 1; n <= 60; n++)
        if (!listed[n])
            fail_msg("case %d is missing", n);
}

static void same_bytes(const struct hard_part *a, const struct hard_part *b)
{
    assert_int_equal(a->scene.tri_count, b->scene.tri_count);
    assert_int_equal(a->scene.vertex_count, b->scene.vertex_count);
    assert_int_equal(a->ray_count, b->ray_count);
    if (a->scene.tri_count) {
        assert_memory_equal(a->scene.vertex, b->scene.vertex, 12 * (size_t)a->scene.vertex_count);
        assert_memory_equal(a->scene.index, b->scene.index, 12 * (size_t)a->scene.tri_count);
    }
    if (a->ray_count) {
        assert_memory_equal(a->ray, b->ray, a->ray_count * sizeof *a->ray);
        assert_memory_equal(a->want, b->want, a->ray_count * sizeof *a->want);
    }
}

static void cases_are_made_the_same_twice(void **state)
{
    (void)state;
    for (size_t i = 0; hard_case_at(i); i++) {
        if (hard_case_at(i)->probe)
            continue; /* asks a driver */
        struct hard_made *a = made_new(hard_case_at(i)), *b = made_new(hard_case_at(i));
        size_t rays = 0;
        assert_true(a->part_count > 0);
        assert_int_equal(a->part_count, b->part_count);
        for (size_t p = 0; p < a->part_count; p++) {
            same_bytes(&a->part[p], &b->part[p]);
            rays += a->part[p].ray_count;
            for (size_t r = 0; r < a->part[p].ray_count; r++)
                assert_true(a->part[p].want[r].id_first + a->part[p].want[r].id_count <=
                            a->part[p].id_count);
        }
        assert_true(rays >= 8);
        made_drop(a);
        made_drop(b);
    }
}

/* The place of a layout in a table, from 1; 0: it is not there. */
static size_t place_of(const struct layout *layout, const struct layout *const *table)
{
    for (size_t l = 0; table[l]; l++)
        if (table[l] == layout)
            return l + 1;
    return 0;
}

struct hard_tally {
    size_t count, of_tree, all, by_turns;
    bool engine[POOL_MOST];
};

static void count_member(void *user, const struct hard_case *one, const struct hard_member *m)
{
    struct hard_tally *tally = user;
    (void)one;
    tally->count++;
    const bool by_turns = place_of(m->layout, layouts_all) && !place_of(m->layout, layouts);
    tally->by_turns += by_turns;
    tally->of_tree += m->layout != NULL && !by_turns;
    tally->all += m->query == QUERY_ALL;
    for (size_t e = 0; engines[e]; e++)
        tally->engine[e] |= m->engine == engines[e];
    assert_int_equal(m->layout != NULL, m->engine->needs_packed);
    assert_int_equal(m->layout != NULL, m->builder && m->box);
}

static size_t length(const void *const *table)
{
    size_t n = 0;
    while (table[n])
        n++;
    return n;
}

/* Every member of the tables takes part in every case. */
static void members_are_all_combinations(void **state)
{
    size_t trees = length((const void *const *)builders) * length((const void *const *)layouts) *
                   length((const void *const *)box_tests) * length((const void *const *)tri_tests);
    size_t with_trees = 0;
    (void)state;
    for (size_t e = 0; engines[e]; e++)
        with_trees += engines[e]->needs_packed;
    const struct hard_tables tables = hard_tables_all();
    for (size_t i = 0; hard_case_at(i); i++) {
        struct hard_tally tally = {0};
        if (hard_case_at(i)->probe || hard_case_at(i)->flags & HARD_WORLD)
            continue;
        size_t queries = hard_case_at(i)->flags & HARD_PARITY ? 3 : 2, made = 0;
        hard_each_member(hard_case_at(i), &tables, count_member, &tally);
        for (size_t d = 0; d < HARD_DEFECTS_MOST && hard_case_at(i)->defect[d].fault; d++)
            made +=
                (hard_case_at(i)->defect[d].layout || hard_case_at(i)->defect[d].engine) ? 2 : 0;
        assert_int_equal(tally.by_turns > 0, !(hard_case_at(i)->flags & HARD_NO_TREES));
        size_t of_tree = hard_case_at(i)->flags & HARD_NO_TREES ? 0 : queries * trees * with_trees;
        assert_int_equal(tally.of_tree, of_tree + made);
        assert_int_equal(tally.all > 0, queries == 3);
        for (size_t e = 0; engines[e]; e++)
            assert_true(tally.engine[e] ||
                        hard_case_at(i)->flags &
                            (engines[e]->needs_packed ? HARD_NO_TREES : HARD_TREES_ONLY));
    }
}

/* Of the defects of a layout, a builder and a triangle test an engine with records of its own shows
 * the second, and the third unless it has a test of its own. */
static void an_engine_with_its_own_shows_no_others(void **state)
{
    (void)state;
    static const char *const engine[] = {"cpu", "fast", "dual_split"};
    struct hard_member m = {.layout = layout_find("rtrs_rf_paper"),
                            .builder = builder_find("median"),
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt")};
    size_t layouts_show[3] = {0}, tests_show[3] = {0}, builders_show[3] = {0};
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++)
        for (size_t i = 0; hard_case_at(i); i++) {
            m.engine = engine_find(engine[e]);
            layouts_show[e] += hard_defect_of(hard_case_at(i), &m) != NULL;
            struct hard_member other = m;
            other.layout = layout_find("f32");
            other.builder = builder_find("rtrs");
            builders_show[e] += hard_defect_of(hard_case_at(i), &other) != NULL;
            other.builder = m.builder;
            other.tri = tri_test_find("mt_rtrs");
            tests_show[e] += hard_defect_of(hard_case_at(i), &other) != NULL;
        }
    assert_true(layouts_show[0] > 0 && layouts_show[1] == 0 && layouts_show[2] == 0);
    assert_true(tests_show[0] > 0 && tests_show[1] == 0 && tests_show[2] == tests_show[0]);
    for (size_t e = 0; e < ARRAY_COUNT(engine); e++)
        assert_int_equal(builders_show[e], builders_show[0]);
    assert_true(builders_show[0] > 0);
}

/* Every known truth is an entry, each with members that are there to show it. */
static void known_truths_are_kept(void **state)
{
    static const char *const faults[] = {
        "fault F1:",    "fault F2:",  "fault F3:",      "fault F4:",         "fault F5:",
        "fault F6:",    "fault F7:",  "fault F8:",      "fault F9:",         "fault F10:",
        "fault F11:",   "fault F12:", "fault F13:",     "fault F14:",        "fault F15:",
        "fault F16:",   "half",       "maximum border", "leaks at vertices", "65,535 rounds",
        "packHalf2x16", "1.00000024",
    };
    (void)state;
    for (size_t f = 0; f < ARRAY_COUNT(faults); f++) {
        size_t found = 0;
        for (size_t i = 0; hard_case_at(i); i++)
            for (size_t d = 0; d < HARD_DEFECTS_MOST && hard_case_at(i)->defect[d].fault; d++)
                found += strstr(hard_case_at(i)->defect[d].fault, faults[f]) != NULL;
        if (found == 0)
            fail_msg("no hard case shows %s", faults[f]);
    }
}

struct shown {
    size_t of[HARD_DEFECTS_MOST];
};

static void count_shown(void *user, const struct hard_case *one, const struct hard_member *m)
{
    struct shown *shown = user;
    const struct hard_defect *defect = hard_defect_of(one, m);
    if (defect)
        shown->of[defect - one->defect]++;
}

/* No defect is without a member that its pattern names. */
static void defects_name_members(void **state)
{
    (void)state;
    const struct hard_tables tables = hard_tables_all();
    for (size_t i = 0; hard_case_at(i); i++) {
        struct shown shown = {{0}};
        hard_each_member(hard_case_at(i), &tables, count_shown, &shown);
        for (size_t d = 0; d < HARD_DEFECTS_MOST && hard_case_at(i)->defect[d].fault; d++)
            if (shown.of[d] == 0)
                fail_msg("case %u: '%s' names no member", hard_case_at(i)->number,
                         hard_case_at(i)->defect[d].members);
    }
}

/* --- relations -------------------------------------------------------------------------------- */

/* One triangle and two rays at it, on a lattice. */
static struct hard_part *base(struct hard_made *made)
{
    struct hard_part *part = part_add(made, "base");
    part_triangle(part, 0, 0, 4, 8, 0, 4, 0, 8, 4);
    part_triangle(part, 0, 0, 6, 8, 0, 6, 0, 8, 8);
    part_ray(part, ray_of(1, 2, 0, 0, 0, 1));
    part_ray(part, ray_of(2, 1, 0, 0.5f, 0.25f, 2));
    assert_false(part->failed);
    return part;
}

static struct hit answer_of(const struct hard_part *part, const struct tri_test *tri, size_t i)
{
    struct hit hit = {.prim = ABI_NO_PRIM};
    struct tri_ray ray = tri_ray_make(&part->ray[i]);
    float best = part->ray[i].tmax;
    for (uint32_t p = 0; p < part->scene.tri_count; p++) {
        float v[3][3];
        struct hit one;
        scene_tri(&part->scene, p, v);
        if (tri_test_run(tri->id, &ray, v, &one) && one.t >= part->ray[i].tmin && one.t < best) {
            hit = one;
            hit.prim = p;
            best = one.t;
        }
    }
    return hit;
}

/* Answers that keep the relation pass; another triangle, a lost hit and, where bits are promised,
 * another t are found. */
static void relations_hold_and_find_breaches(void **state)
{
    const struct tri_test *tri = tri_test_find("mt");
    const struct hard_subject subject = {{.formula = TWIN_MT, .rounding = ROUNDING_IEEE}, false};
    (void)state;
    for (size_t r = 0; relations[r].name; r++)
        for (uint64_t seed = 0; seed < 20; seed++) {
            struct hard_made *made = made_new(NULL);
            struct hard_part *from = base(made), *to = part_add(made, "changed");
            if (!relations[r].make(from, seed, to))
                fail_msg("%s: small whole numbers are changed exactly", relations[r].name);
            assert_false(to->failed);
            assert_int_equal(to->ray_count, from->ray_count);
            for (size_t i = 0; i < to->ray_count; i++) {
                struct hit like[2] = {answer_of(from, tri, 0), answer_of(from, tri, 1)};
                struct hit good = answer_of(to, tri, i), bad = good;
                const struct hit *l = &like[to->want[i].like];
                assert_true(good.prim != ABI_NO_PRIM);
                assert_int_equal(hard_check(to, i, &subject, &good, l, false), PROPERTY_KEPT);
                bad.prim ^= 1u;
                assert_int_equal(hard_check(to, i, &subject, &bad, l, false), PROPERTY_LIKE);
                assert_int_equal(hard_check(to, i, &subject, &bad, l, true), PROPERTY_KEPT);
                bad = (struct hit){.prim = ABI_NO_PRIM};
                assert_int_equal(hard_check(to, i, &subject, &bad, l, false), PROPERTY_LIKE);
                bad = good;
                bad.t *= 1.0000002f;
                assert_int_equal(hard_check(to, i, &subject, &bad, l, false),
                                 to->like_bits & HARD_LIKE_MT ? PROPERTY_LIKE : PROPERTY_KEPT);
            }
            made_drop(made);
        }
}

/* A change that would round says no: nothing would follow from it. */
static void relations_refuse_what_is_not_exact(void **state)
{
    static const char *const names[] = {"translate", "shift_origin"};
    (void)state;
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        struct hard_made *made = made_new(NULL);
        struct hard_part *from = base(made), *to = part_add(made, "changed");
        from->scene.vertex[0] = 0x1.000002p-30f;
        from->ray[0].org[0] = 0x1.000002p-30f;
        from->ray[0].dir[0] = 1;
        assert_false(relation_find(names[n])->make(from, 3, to));
        made_drop(made);
    }
}

/* --- wants ------------------------------------------------------------------------------------ */

static void wants_are_checked(void **state)
{
    struct hard_made *made = made_new(NULL);
    struct hard_part *part = base(made);
    struct hard_subject closed = {{.formula = TWIN_MT}, false};
    struct hard_subject open = {{.formula = TWIN_MT_RTRS, .open = true}, false};
    struct hard_subject other = {{.formula = TWIN_UNKNOWN}, false};
    struct hard_subject any = {{.formula = TWIN_MT}, true};
    struct hit hit = {2, 0.25f, 0.25f, 1}, miss = {.prim = ABI_NO_PRIM};
    part_ray(part, ray_of(1, 1, 0, 0, 0, 1));
    size_t i = part->ray_count - 1;
    struct hard_want *w = &part->want[i];
    (void)state;
    want(part, HARD_ALL, WANT_HIT);
    assert_int_equal(hard_check(part, i, &closed, &miss, NULL, false), PROPERTY_HIT);
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_KEPT);
    *w = (struct hard_want){.what = WANT_MISS, .scope = HARD_OWN};
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_MISS);
    assert_int_equal(hard_check(part, i, &other, &hit, NULL, false), PROPERTY_KEPT);
    *w = (struct hard_want){.what = WANT_ENDS};
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_KEPT);
    assert_int_equal(hard_check(part, i, &closed, &miss, NULL, false), PROPERTY_ENDS);
    assert_int_equal(hard_check(part, i, &open, &hit, NULL, false), PROPERTY_ENDS);
    assert_int_equal(hard_check(part, i, &open, &miss, NULL, false), PROPERTY_KEPT);
    *w = (struct hard_want){0};
    want_id(part, HARD_ALL, 0);
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_ID);
    assert_int_equal(hard_check(part, i, &any, &hit, NULL, false), PROPERTY_KEPT);
    *w = (struct hard_want){0};
    want_t(part, HARD_TIGHT, 2.0000002f);
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_KEPT);
    closed.model.watertight = true;
    assert_int_equal(hard_check(part, i, &closed, &hit, NULL, false), PROPERTY_T);
    made_drop(made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cases_are_numbered_and_documented),
        cmocka_unit_test(cases_are_made_the_same_twice),
        cmocka_unit_test(members_are_all_combinations),
        cmocka_unit_test(an_engine_with_its_own_shows_no_others),
        cmocka_unit_test(known_truths_are_kept),
        cmocka_unit_test(defects_name_members),
        cmocka_unit_test(relations_hold_and_find_breaches),
        cmocka_unit_test(relations_refuse_what_is_not_exact),
        cmocka_unit_test(wants_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
