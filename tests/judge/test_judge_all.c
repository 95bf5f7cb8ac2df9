/* Lists of all hits before the judge: right ones are right, wrong ones of every kind are caught for
 * every formula, and what is allowed has its class; and what lists say of a mesh. */
#include "ref/base/rng.h"
#include "ref/judge/judge_inner.h"
#include "tests/judge/judge_all_fixture.h"

static void exactly_the_hits_are_right(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        judge_fixture_ask(c, along_z(0.5f, -0.25f));
        must(c, LIST(c, 0, 2), VERDICT_RIGHT);
        judge_fixture_ask(c, along_z(5, 5));
        must(c, empty, VERDICT_RIGHT);
    }
    judge_fixture_close(c);
}

static void a_lost_hit_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must_wrong(c, empty, WRONG_MISSED, ABI_NO_PRIM, 0);
        must_wrong(c, LIST(c, 2), WRONG_MISSED, ABI_NO_PRIM, 0);
        struct judged_list last = must_wrong(c, LIST(c, 0), WRONG_MISSED, ABI_NO_PRIM, 2);
        assert_true(last.judged.judgement.t_lo <= 2.0 && last.judged.judgement.t_hi >= 2.0);
    }
    judge_fixture_close(c);
}

static void a_repeated_hit_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must_wrong(c, LIST(c, 0, 0, 2), WRONG_TWICE, 0, 0);
        must_wrong(c, LIST(c, 0, 2, 2), WRONG_TWICE, 2, 2);
    }
    judge_fixture_close(c);
}

/* At fault is the hit `at` of the list, to the bit. */
static struct judged_list must_be_at_fault(struct judge_fixture *c, struct judged_list list,
                                           enum wrong kind, size_t at)
{
    list = must(c, list, VERDICT_WRONG);
    if (list.judged.judgement.wrong != kind ||
        memcmp(&list.judged.at_fault, &list.hit[at], sizeof list.hit[at]) != 0)
        fail_msg("%s: %s of triangle %u at %a, not %s of hit %zu at %a", c->subject->name,
                 wrong_name(list.judged.judgement.wrong), list.judged.at_fault.prim,
                 (double)list.judged.at_fault.t, wrong_name(kind), at, (double)list.hit[at].t);
    return list;
}

/* Hits of one triangle that differ in their last bits: the second is at fault, and the first is
 * what it repeats, wherever they stand. Of several repeated triangles it is the least. */
static void the_second_of_two_hits_repeats_the_first(void **state)
{
    (void)state;
    static const uint32_t lists[][5] = {/* triangles; then what is repeated, and which it is */
                                        {0, 0, 2, 0, 1}, {0, 2, 0, 0, 2}, {2, 0, 0, 1, 2},
                                        {0, 2, 2, 1, 2}, {2, 0, 2, 0, 2}, {2, 2, 0, 0, 1},
                                        {0, 0, 0, 0, 1}, {2, 2, 2, 0, 1}};
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        for (size_t i = 0; i < ARRAY_COUNT(lists); i++) {
            struct judged_list list = list_of(c, 3, lists[i]);
            for (size_t k = 1; k < 3; k++)
                for (size_t n = 0; n < k; n++)
                    list.hit[k].t = nextafterf(list.hit[k].t, 3);
            list = must_be_at_fault(c, list, WRONG_TWICE, lists[i][4]);
            const struct judgement *j = &list.judged.judgement;
            const struct hit *first = &list.hit[lists[i][3]];
            assert_int_equal(j->expected, first->prim);
            assert_true(j->t_lo == (double)first->t && j->t_hi == (double)first->t);
        }
        struct judged_list both = LIST(c, 2, 0, 2, 0);
        both.hit[2].t = nextafterf(both.hit[2].t, 3);
        both.hit[3].t = nextafterf(both.hit[3].t, 3);
        must_be_at_fault(c, both, WRONG_TWICE, 3);
    }
    judge_fixture_close(c);
}

/* Of several hits that are wrong alone the first in the list is at fault. */
static void the_first_of_several_wrong_hits_is_at_fault(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        for (size_t first = 0; first < 2; first++) {
            struct judged_list list = LIST(c, 0, 2);
            for (size_t i = first; i < 2; i++)
                list.hit[i].t *= 1.001f;
            must_be_at_fault(c, list, WRONG_DISTANCE, first);
            for (size_t i = first; i < 2; i++)
                list.hit[i].v = NAN;
            must_be_at_fault(c, list, WRONG_NOT_FINITE, first);
            for (size_t i = first; i < 2; i++)
                list.hit[i].prim = c->scene.tri_count + (uint32_t)i;
            must_be_at_fault(c, list, WRONG_PHANTOM, first);
        }
        struct judged_list turned = must_be_at_fault(c, LIST(c, 2, 0), WRONG_ORDER, 0);
        const struct judgement *j = &turned.judged.judgement;
        double t = (double)turned.hit[1].t;
        assert_true(j->expected == 0 && j->t_lo == t && j->t_hi == t);
    }
    judge_fixture_close(c);
}

static void a_triangle_that_is_not_hit_is_wrong(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        judge_fixture_ask(c, along_z(0.5f, -0.25f));
        must_wrong(c, LIST(c, 0, 1, 2), WRONG_PHANTOM, 1, ABI_NO_PRIM);
        struct judged_list none = LIST(c, 0, 2);
        none.hit[none.count++] = (struct hit){3, 0.25f, 0.25f, 77}; /* no such triangle */
        must_wrong(c, none, WRONG_PHANTOM, 77, ABI_NO_PRIM);
        judge_fixture_ask(c, along_z(5, 5));
        must_wrong(c, LIST(c, 2), WRONG_PHANTOM, 2, ABI_NO_PRIM);
    }
    judge_fixture_close(c);
}

static void wrong_numbers_are_wrong(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        struct judged_list list = LIST(c, 0, 2);
        list.hit[1].t *= 1.001f;
        list = must_wrong(c, list, WRONG_DISTANCE, 2, 2);
        if (!is_unknown(&subjects[s]))
            assert_true(list.judged.judgement.over > 1.0);
        else
            assert_true(list.judged.judgement.displacement > JUDGE_DISPLACEMENT_MOST);
        list = LIST(c, 0, 2);
        list.hit[0].u += 0.001f;
        must_wrong(c, list, WRONG_BARYCENTRIC, 0, 0);
        for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
            for (int field = 0; field < 3; field++) {
                list = LIST(c, 0, 2);
                *(field == 0   ? &list.hit[1].t
                  : field == 1 ? &list.hit[1].u
                               : &list.hit[1].v) = bad[i];
                list = must_wrong(c, list, WRONG_NOT_FINITE, 2, 2);
                assert_true(list.judged.judgement.t_lo <= 2 && list.judged.judgement.t_hi >= 2);
            }
        }
        list = LIST(c, 0, 2);
        list.hit[1].t = nextafterf(list.hit[1].t, 3);
        list = must(c, list, VERDICT_RIGHT);
        const struct judgement *j = &list.judged.judgement;
        assert_true(is_unknown(&subjects[s]) ? j->displacement > 0 : j->over > 0 && j->over <= 1);
    }
    judge_fixture_close(c);
}

static void order_counts(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must_wrong(c, LIST(c, 2, 0), WRONG_ORDER, 2, 0);
    }
    judge_fixture_close(c);
}

/* Two layers an ulp apart whose t are the same in float32. */
static void an_order_within_the_errors_is_a_near_tie(void **state)
{
    (void)state;
    struct scene scene = layers();
    scene.tri_count = 4;
    for (int i = 4; i < 8; i++)
        scene.vertex[3 * i + 2] = nextafterf(1, 2);
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_ask(c, along_z(0.5f, -0.25f));
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        struct judged_list list = LIST(c, 2, 0);
        must(c, LIST(c, 0, 2), VERDICT_RIGHT);
        list.hit[0].t = list.hit[1].t = 1;
        must(c, list, VERDICT_NEAR_TIE);
    }
    judge_fixture_close(c);
}

static void ties_stand_in_any_order(void **state)
{
    (void)state;
    struct judge_fixture *c = judge_fixture_of(layers()); /* triangle 4 lies on triangle 0 */
    judge_fixture_ask(c, along_z(0.5f, -0.25f));
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must(c, LIST(c, 0, 4, 2), VERDICT_RIGHT);
        must(c, LIST(c, 4, 0, 2), VERDICT_RIGHT);
        must_wrong(c, LIST(c, 0, 2), WRONG_MISSED, ABI_NO_PRIM, 4);
    }
    judge_fixture_close(c);
}

/* Halves of quads whose diagonals lie beside the ray along z at 0.25, 0.25, each nearer than the
 * one before; layers are `gap` apart from z = 1 on. The ray meets triangle 2 i of layer i. */
static struct judge_fixture *beside_diagonals(uint32_t count, const float *off, float gap)
{
    struct scene scene;
    assert_int_equal(scene_make(4 * count, 2 * count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < count; i++) {
        const float corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
        for (uint32_t c = 0; c < 4; c++) {
            float *vertex = scene.vertex + 3 * (4 * i + c);
            vertex[0] = corner[c][0] - off[i];
            vertex[1] = corner[c][1];
            vertex[2] = 1 + (float)i * gap;
        }
        for (uint32_t k = 0; k < 6; k++)
            scene.index[6 * i + k] = 4 * i + index[k];
    }
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_seat(c, subject_of("unknown"), QUERY_ALL);
    return c;
}

/* The words of the ray in turn, each mixed with what came before. */
static uint32_t drawn_of(const struct ray *ray, uint32_t hits)
{
    uint32_t words[sizeof *ray / 4];
    uint64_t drawn = 0;
    memcpy(words, ray, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct rng rng = {drawn ^ words[i]};
        drawn = rng_u64(&rng);
    }
    return (uint32_t)(drawn % hits);
}

/* One exact hit stands for a list of an unknown formula, drawn by all bits of the ray. */
static void the_hit_that_stands_for_a_list_is_drawn_by_its_ray(void **state)
{
    (void)state;
    static const float off[3] = {0x1p-21f, 0x1p-22f, 0x1p-23f};
    struct judge_fixture *c = beside_diagonals(3, off, 1);
    size_t drawn[3] = {0};
    for (int i = 0; i < 300; i++) {
        struct ray ray = along_z(0.25f, 0.25f);
        *(i % 3 == 0 ? &ray.tmin : i % 3 == 1 ? &ray.tmax : &ray.org[2]) -= 0x1p-8f * (float)i;
        ray.tmin = fabsf(ray.tmin);
        if (ray.tmin >= 1)
            continue;
        judge_fixture_ask(c, ray);
        uint32_t one = drawn_of(&ray, 3);
        struct judged_list whole = must(c, LIST(c, 0, 2, 4), VERDICT_RIGHT);
        const double margin = judge_margin_of(c->judge, &ray, 2 * one);
        assert_true(margin > 0 && whole.judged.judgement.margin == margin);
        assert_false(whole.judged.judgement.edge_lost);
        for (uint32_t lost = 0; lost < 3; lost++) {
            struct judged_list list = whole;
            memmove(list.hit + lost, list.hit + lost + 1, (2 - lost) * sizeof *list.hit);
            list.count = 2;
            (void)judge(c, &list);
            assert_true(list.judged.judgement.margin == margin);
            assert_int_equal(list.judged.judgement.edge_lost, lost == one);
        }
        struct judged_list unread = whole; /* what is wrong whatever the ray stands for nothing */
        unread.hit[1].u = NAN;
        for (int k = 0; k < 2; k++, unread.hit[1].prim = 77) {
            must(c, unread, VERDICT_WRONG);
            (void)judge(c, &unread);
            assert_true(unread.judged.judgement.margin == 0);
        }
        drawn[one]++;
    }
    assert_true(drawn[0] > 30 && drawn[1] > 30 && drawn[2] > 30);
    judge_fixture_close(c);
}

/* A hit is lost for its edge only if no hit of the list is nearer to it, in what it needs, than the
 * edge is. */
static void a_hit_lost_beside_another_is_not_lost_for_its_edge(void **state)
{
    (void)state;
    static const float off[3] = {0x1p-20f, 0x1p-20f, 0x1p-20f}, gap[2] = {0x1p-23f, 1};
    size_t count[2] = {0};
    for (int far = 0; far < 2; far++) {
        struct judge_fixture *c = beside_diagonals(3, off, gap[far]);
        for (int i = 0; i < 90; i++) {
            struct ray ray = along_z(0.25f, 0.25f);
            ray.tmin = 0x1p-8f * (float)i;
            judge_fixture_ask(c, ray);
            if (drawn_of(&ray, 3) != 0)
                continue;
            struct judged_list none = empty, one = LIST(c, 2), two = LIST(c, 2, 4);
            struct judged_list *lists[] = {&none, &one, &two};
            for (size_t k = 0; k < ARRAY_COUNT(lists); k++) {
                (void)judge(c, lists[k]);
                assert_int_equal(lists[k]->judged.judgement.edge_lost, far || k == 0);
                count[lists[k]->judged.judgement.edge_lost]++;
            }
        }
        judge_fixture_close(c);
    }
    assert_true(count[0] > 20 && count[1] > 20);
}

/* What a list needs is the largest of what its hits need, and of what its losses do, by value. */
static void the_largest_need_of_a_list_counts(void **state)
{
    (void)state;
    for (int k = 1; k < 90; k++) {
        const float both[2] = {0x1p-24f * (float)k, 0x1p-24f * (float)(90 - k)};
        struct judge_fixture *c = beside_diagonals(2, both, 1);
        judge_fixture_ask(c, along_z(0.25f, 0.25f));
        struct judged_list none = empty, first = LIST(c, 2), bent[3];
        struct judge_loss loss[2];
        for (uint32_t i = 0; i < 2; i++) {
            struct oracle_crossing crossing = {.prim = 2 * i};
            oracle_pair(c->oracle, &c->ray, 2 * i, &crossing.pair);
            loss[i] = judge_loss_of(c->judge, &c->ray, &crossing, (double)INFINITY);
        }
        const struct judgement *said = &first.judged.judgement;
        assert_int_equal(judge(c, &first) == VERDICT_WRONG, loss[0].over > 1);
        assert_true(said->displacement == loss[0].need && said->share == loss[0].over);
        said = &none.judged.judgement;
        assert_int_equal(judge(c, &none) == VERDICT_WRONG, loss[0].over > 1 || loss[1].over > 1);
        if (said->verdict != VERDICT_WRONG)
            assert_true(said->displacement == fmax(loss[0].need, loss[1].need) &&
                        said->share == fmax(loss[0].over, loss[1].over));
        for (int n = 0; n < 3; n++) {
            bent[n] = LIST(c, 0, 2);
            if (n != 1)
                bent[n].hit[0].t += 0x1p-23f * (float)(k % 7);
            if (n != 0)
                bent[n].hit[1].t += 0x1p-22f * (float)(k % 5);
            must(c, bent[n], VERDICT_RIGHT);
            (void)judge(c, &bent[n]);
        }
        const struct judgement *a = &bent[0].judged.judgement, *b = &bent[1].judged.judgement;
        said = &bent[2].judged.judgement;
        assert_true(said->displacement == fmax(a->displacement, b->displacement));
        assert_true(said->share == fmax(a->share, b->share));
        assert_true(k % 7 == 0 || (a->displacement > 0 && a->share > 0));
        judge_fixture_close(c);
    }
}

/* The largest error of a list is that of one of its hits, judged alone, wherever that stands. */
static void the_largest_error_of_a_list_counts(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    int largest[2] = {0, 0};
    for (int k = 0; k < 25 * (int)SUBJECTS; k++) {
        judge_fixture_seat(c, &subjects[k / 25], QUERY_ALL);
        struct judged_list both = LIST(c, 0, 2), one[2] = {LIST(c, 0), LIST(c, 2)};
        both.hit[0].t = one[0].hit[0].t += 0x1p-23f * (float)(k % 5);
        both.hit[1].t = one[1].hit[0].t += 0x1p-22f * (float)(k % 25 / 5);
        (void)judge(c, &both), (void)judge(c, &one[0]), (void)judge(c, &one[1]);
        const double over[2] = {one[0].judged.judgement.over, one[1].judged.judgement.over};
        assert_true(both.judged.judgement.over == fmax(over[0], over[1]));
        largest[over[1] > over[0]] += over[0] != over[1];
    }
    assert_true(largest[0] > 10 && largest[1] > 10);
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exactly_the_hits_are_right),
        cmocka_unit_test(a_lost_hit_is_wrong),
        cmocka_unit_test(a_repeated_hit_is_wrong),
        cmocka_unit_test(the_second_of_two_hits_repeats_the_first),
        cmocka_unit_test(the_first_of_several_wrong_hits_is_at_fault),
        cmocka_unit_test(a_triangle_that_is_not_hit_is_wrong),
        cmocka_unit_test(wrong_numbers_are_wrong),
        cmocka_unit_test(order_counts),
        cmocka_unit_test(an_order_within_the_errors_is_a_near_tie),
        cmocka_unit_test(ties_stand_in_any_order),
        cmocka_unit_test(the_hit_that_stands_for_a_list_is_drawn_by_its_ray),
        cmocka_unit_test(a_hit_lost_beside_another_is_not_lost_for_its_edge),
        cmocka_unit_test(the_largest_need_of_a_list_counts),
        cmocka_unit_test(the_largest_error_of_a_list_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
