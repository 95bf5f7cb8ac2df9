/* Engines that cheat in a world (tests/two_level/world_cheats.h, written apart from the defects
 * that are tried): the cause that is named is the cheat's, an honest engine has none, and what no
 * defect does is unknown. */
#include "ref/explain/world_why.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/world_boxes.h"
#include "scenes/rays/ray_modes.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"
#include "tests/two_level/world_cheats.h"

#define RAYS 1500

struct why_stand {
    struct world world;
    struct packed_world packed;
    struct oracle *oracle;
    struct ray ray[RAYS];
    struct ray_mode mode[RAYS];
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct judgement judgement[RAYS];
    struct world_why why;
};

static struct why_stand *s;

static int make(void **state)
{
    (void)state;
    s = calloc(1, sizeof *s);
    s->world = fixture_everything();
    s->packed = stand_world(&s->world, "f32");
    assert_int_equal(oracle_make_world(&s->world, &s->oracle, NULL), STATUS_OK);
    ray_modes_make(RAY_MODES_DRAWN, 3, RAYS, s->mode);
    for (uint32_t i = 0; i < RAYS; i++)
        s->ray[i] = stand_aim(&s->packed, 9, i);
    return 0;
}

static int drop(void **state)
{
    (void)state;
    oracle_free(s->oracle);
    packed_world_free(&s->packed);
    world_free(&s->world);
    free(s);
    return 0;
}

/* Judges the answers and explains them. */
static enum world_cause explained(enum query query, const struct world_faults *faults)
{
    const struct model model = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}};
    struct world_evidence a = {.world = &s->world,
                               .tri = tri_test_find("mt"),
                               .query = query,
                               .ray = s->ray,
                               .mode = s->mode,
                               .hit = s->hit,
                               .tag = s->tag,
                               .judgement = s->judgement,
                               .count = RAYS,
                               .faults = faults};
    struct reason reason = {""};
    struct judge *judge;
    assert_int_equal(judge_make(s->oracle, &model, query, &judge, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct oracle_answer truth;
        assert_int_equal(oracle_closest_world(s->oracle, ORACLE_AUTO, ORACLE_CLOSED, &s->ray[i],
                                              &s->mode[i], 1, 1, &truth, NULL, NULL),
                         STATUS_OK);
        assert_int_equal(judge_world_answer(judge, &s->ray[i], s->mode[i], &truth, &s->hit[i],
                                            s->tag[i], &s->judgement[i]),
                         STATUS_OK);
    }
    judge_free(judge);
    if (world_why(&a, &s->why, &reason))
        fail_msg("%s", reason.text);
    return s->why.cause;
}

static void cheat_with(enum world_cheat cheat, enum query query)
{
    cheat_answers(cheat, &s->world, query, s->ray, s->mode, RAYS, s->hit, s->tag);
}

static const struct {
    enum world_cheat cheat;
    enum world_cause closest, any;
} cheaters[] = {
    {CHEAT_NONE, WORLD_CAUSE_NONE, WORLD_CAUSE_NONE},
    {CHEAT_NO_FIRST, WORLD_CAUSE_NONE, WORLD_CAUSE_NONE},
    {CHEAT_NO_MASK, WORLD_CAUSE_MASK, WORLD_CAUSE_MASK},
    {CHEAT_MASK_EQUAL, WORLD_CAUSE_MASK, WORLD_CAUSE_MASK},
    {CHEAT_NO_SKIP, WORLD_CAUSE_CULL, WORLD_CAUSE_CULL},
    {CHEAT_NO_CULL, WORLD_CAUSE_CULL, WORLD_CAUSE_CULL},
    {CHEAT_NO_DISABLE, WORLD_CAUSE_CULL, WORLD_CAUSE_CULL},
    {CHEAT_NO_FLIP, WORLD_CAUSE_CULL, WORLD_CAUSE_CULL},
    {CHEAT_MIRROR, WORLD_CAUSE_CULL, WORLD_CAUSE_CULL},
    {CHEAT_OTHER_FACE, WORLD_CAUSE_CULL, WORLD_CAUSE_COUNT},
    {CHEAT_NO_OPACITY_CULL, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_NO_FORCE, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_NO_RAY_OPACITY, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_NO_FILTER, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_PASS_OVER, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_FIRST_PASSED, WORLD_CAUSE_OPACITY, WORLD_CAUSE_OPACITY},
    {CHEAT_INSTANCE_0, WORLD_CAUSE_INDEX, WORLD_CAUSE_INDEX},
    {CHEAT_INDEX, WORLD_CAUSE_INDEX, WORLD_CAUSE_COUNT},
    {CHEAT_CUT, WORLD_CAUSE_INDEX, WORLD_CAUSE_COUNT},
    {CHEAT_NOT_CARRIED, WORLD_CAUSE_TRANSFORM, WORLD_CAUSE_NONE},
    {CHEAT_LAST_TRANSFORM, WORLD_CAUSE_TRANSFORM, WORLD_CAUSE_TRANSFORM},
    {CHEAT_LENGTH, WORLD_CAUSE_TRANSFORM, WORLD_CAUSE_COUNT},
};

/* Any-hit answers are compared as hits and misses alone: what changes only their tags is not asked
 * for there. */
static void a_cheat_is_named_as_its_cause(void **state)
{
    (void)state;
    for (size_t c = 0; c < ARRAY_COUNT(cheaters); c++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            enum world_cause expected = query == QUERY_ANY ? cheaters[c].any : cheaters[c].closest;
            if (expected == WORLD_CAUSE_COUNT)
                continue;
            cheat_with(cheaters[c].cheat, query);
            enum world_cause cause = explained(query, NULL);
            if (cause != expected)
                fail_msg("cheat %d, %s: %s (%s), not %s: %zu WRONG", cheaters[c].cheat,
                         query_name(query), world_cause_name(cause),
                         world_defect_about(s->why.defect)->text, world_cause_name(expected),
                         s->why.wrong);
            assert_int_equal(s->why.first == RAYS, cause == WORLD_CAUSE_NONE);
            assert_true(cause == WORLD_CAUSE_NONE || s->why.wrong > 3);
        }
}

/* Each defect's own tracer is named as it, or as one that gives the same answers; all that are
 * WRONG have a kind. */
static void every_defect_is_found_by_its_own_answers(void **state)
{
    (void)state;
    struct world_look look;
    assert_int_equal(world_look_make(&s->world, tri_test_find("mt"), &look, NULL), STATUS_OK);
    for (enum world_defect d = 0; d < WORLD_DEFECT_COUNT; d++) {
        world_look_bend(&look, d);
        for (uint32_t i = 0; i < RAYS; i++) {
            const struct hit none = hit_none();
            world_look_trace(&look, QUERY_CLOSEST, &s->ray[i], s->mode[i], &none, &s->hit[i],
                             &s->tag[i]);
        }
        enum world_cause cause = explained(QUERY_CLOSEST, NULL);
        if (s->why.wrong == 0) {
            /* There are few instances, and none is inactive. */
            assert_true(d == WORLD_DEFECT_NONE || d == WORLD_DEFECT_NUMBER_10 ||
                        d == WORLD_DEFECT_INACTIVE_COUNT_NOT || d == WORLD_DEFECT_NOT_CARRIED);
            continue;
        }
        size_t kinds = 0;
        for (int w = 0; w < WRONG_COUNT; w++)
            kinds += s->why.kind[w];
        assert_int_equal(kinds, s->why.wrong);
        assert_int_equal(s->why.attempt[d].told_wrong, s->why.wrong_compared);
        assert_int_equal(s->why.attempt[d].told_other, s->why.other_compared);
        if (cause != world_defect_about(d)->cause)
            fail_msg("%s: %s", world_defect_about(d)->text,
                     world_defect_about(s->why.defect)->text);
    }
    world_look_free(&look);
}

/* Hits of every seventh instance are lost at random: no defect does that. Bits of t are: neither.
 * */
static void what_no_defect_does_is_unknown(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        cheat_with(CHEAT_NONE, QUERY_CLOSEST);
        for (uint32_t i = 0; i < RAYS; i++) {
            if (s->hit[i].prim == ABI_NO_PRIM || i % 3)
                continue;
            if (kind)
                s->hit[i].t *= 1.25f;
            else
                s->hit[i] = hit_none(), s->tag[i] = 0;
        }
        assert_int_equal(explained(QUERY_CLOSEST, NULL), WORLD_CAUSE_UNKNOWN);
        assert_true(s->why.wrong > 100);
        const struct world_faults sound = {.first = WORLD_SOUND}, box = {.first = WORLD_BOX};
        assert_int_equal(explained(QUERY_CLOSEST, &sound), WORLD_CAUSE_UNKNOWN);
        assert_int_equal(explained(QUERY_CLOSEST, &box), WORLD_CAUSE_BOX);
    }
}

/* Damages a member of every record: what the check of the bytes finds. */
static struct world_faults damaged(void (*damage)(struct instance_record *))
{
    struct world_faults faults;
    struct packed_world packed = stand_world(&s->world, "f32");
    for (uint32_t i = 0; i < s->world.instance_count; i++)
        damage(&packed.record[i]);
    assert_int_equal(world_pack_check(&s->world, &packed, &faults, NULL), STATUS_INPUT);
    assert_int_equal(faults.first, WORLD_RECORD);
    packed_world_free(&packed);
    return faults;
}

static void in_first(struct instance_record *r)
{
    r->first++;
}
static void in_mesh(struct instance_record *r)
{
    r->mesh++;
}
static void in_custom(struct instance_record *r)
{
    r->custom_mask ^= 0x800;
}
static void in_mask(struct instance_record *r)
{
    r->custom_mask ^= 0x40000000;
}
static void in_facing(struct instance_record *r)
{
    r->flags ^= ABI_INSTANCE_FLIP_FACING;
}
static void in_disable(struct instance_record *r)
{
    r->flags ^= ABI_INSTANCE_CULL_DISABLE;
}
static void in_opaque(struct instance_record *r)
{
    r->flags ^= ABI_INSTANCE_FORCE_OPAQUE;
}
static void in_no_opaque(struct instance_record *r)
{
    r->flags ^= ABI_INSTANCE_FORCE_NO_OPAQUE;
}
static void in_identity(struct instance_record *r)
{
    r->flags ^= ABI_INSTANCE_IDENTITY;
}
static void in_translation(struct instance_record *r)
{
    r->t[2] += 1;
}
static void in_inverse(struct instance_record *r)
{
    r->w[8] += 1;
}

/* Answers that no defect gives have the cause of the record that is wrong; answers that a defect
 * gives have the defect's, and it is named. */
static void a_wrong_record_is_named_by_its_member(void **state)
{
    (void)state;
    const struct {
        void (*damage)(struct instance_record *);
        enum world_cause cause;
    } parts[] = {{in_first, WORLD_CAUSE_INDEX},        {in_mesh, WORLD_CAUSE_INDEX},
                 {in_custom, WORLD_CAUSE_INDEX},       {in_mask, WORLD_CAUSE_MASK},
                 {in_facing, WORLD_CAUSE_CULL},        {in_disable, WORLD_CAUSE_CULL},
                 {in_opaque, WORLD_CAUSE_OPACITY},     {in_no_opaque, WORLD_CAUSE_OPACITY},
                 {in_identity, WORLD_CAUSE_TRANSFORM}, {in_translation, WORLD_CAUSE_TRANSFORM},
                 {in_inverse, WORLD_CAUSE_TRANSFORM}};
    for (size_t p = 0; p < ARRAY_COUNT(parts); p++) {
        const struct world_faults faults = damaged(parts[p].damage);
        cheat_with(CHEAT_NONE, QUERY_CLOSEST);
        for (uint32_t i = 0; i < RAYS; i += 3)
            s->hit[i].t *= 1.25f;
        assert_int_equal(explained(QUERY_CLOSEST, &faults), parts[p].cause);
        assert_int_equal(s->why.defect, WORLD_DEFECT_NONE);
        cheat_with(CHEAT_MASK_EQUAL, QUERY_CLOSEST);
        assert_int_equal(explained(QUERY_CLOSEST, &faults), WORLD_CAUSE_MASK);
        assert_int_equal(s->why.defect, WORLD_DEFECT_MASK_EQUAL);
    }
}

/* A ray that is turned away by a box a little too small loses what is there alone. */
static void boxes_that_are_too_small_are_named(void **state)
{
    (void)state;
    struct box *box;
    uint32_t lost = 0;
    assert_int_equal(world_boxes_make(&s->world, WORLD_BOXES_OF_VERTICES, &box, NULL), STATUS_OK);
    struct ray before[RAYS];
    memcpy(before, s->ray, sizeof before);
    /* At vertices at the rim of instances, from outside. */
    for (uint32_t i = 0; i < RAYS; i++) {
        uint32_t at = i % s->world.instance_count;
        const struct scene *mesh = world_scene(&s->world, at);
        const struct instance *instance = &s->world.instance[at];
        double best = -INFINITY, point[3] = {0};
        int axis = (int)(i / 24 % 3);
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            double p[3];
            for (int k = 0; k < 3; k++) {
                p[k] = (double)instance->m[k][3];
                for (uint32_t j = 0; j < 3; j++)
                    p[k] += (double)instance->m[k][j] * (double)mesh->vertex[3 * v + j];
            }
            if (p[axis] > best)
                best = p[axis], memcpy(point, p, sizeof point);
        }
        struct rng rng = rng_make(5, i);
        s->mode[i] = ray_mode_all();
        s->ray[i] = (struct ray){.tmax = 100};
        for (int k = 0; k < 3; k++) { /* within 2^-14 of the rim, along it */
            double size = (double)box[at].hi[k] - (double)box[at].lo[k];
            double to = (double)(float)point[k] -
                        (k == axis ? size * 0x1p-14 * (double)rng_float(&rng) : 0);
            s->ray[i].dir[k] = k == axis ? 0 : rng_range(&rng, -1, 1);
            s->ray[i].org[k] = (float)(to - 4 * (double)s->ray[i].dir[k]);
        }
    }
    cheat_with(CHEAT_NONE, QUERY_CLOSEST);
    for (uint32_t i = 0; i < RAYS; i++) {
        if (s->hit[i].prim == ABI_NO_PRIM ||
            world_instance_of(&s->world, s->hit[i].prim) != i % s->world.instance_count)
            continue;
        s->hit[i] = hit_none(), s->tag[i] = 0;
        lost++;
    }
    assert_true(lost > 50);
    enum world_cause cause = explained(QUERY_CLOSEST, NULL);
    print_message("%u of %u WRONG answers (%zu) lose what is at the rim\n", s->why.at_the_rim,
                  s->why.wrong_compared, s->why.wrong);
    assert_int_equal(cause, WORLD_CAUSE_BOX);
    assert_true(s->why.at_the_rim * 10 >= s->why.wrong_compared * 9 && s->why.wrong > 20);
    memcpy(s->ray, before, sizeof before);
    free(box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_cheat_is_named_as_its_cause, make, drop),
        cmocka_unit_test_setup_teardown(every_defect_is_found_by_its_own_answers, make, drop),
        cmocka_unit_test_setup_teardown(what_no_defect_does_is_unknown, make, drop),
        cmocka_unit_test_setup_teardown(a_wrong_record_is_named_by_its_member, make, drop),
        cmocka_unit_test_setup_teardown(boxes_that_are_too_small_are_named, make, drop),
    };
    return cmocka_run_group_tests_name("world_why", tests, NULL, NULL);
}
