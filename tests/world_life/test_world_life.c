/* Laws of motions of instances, and of the trees of worlds that go through them. */
#include "tests/world_life/world_lives.h"

#include <float.h>
#include <math.h>

#define SPEC "mixed"

static bool same_instances(const struct world *a, const struct world *b)
{
    return a->instance_count == b->instance_count &&
           memcmp(a->instance, b->instance, a->instance_count * sizeof *a->instance) == 0 &&
           memcmp(a->first, b->first, (a->instance_count + 1) * sizeof *a->first) == 0;
}

static bool same_vertices(const struct world *a, const struct world *b)
{
    bool same = true;
    for (uint32_t i = 0; i < a->mesh_count && same; i++) {
        const struct scene *x = a->mesh[i].scene, *y = b->mesh[i].scene;
        same = x->vertex_count == y->vertex_count &&
               (x->vertex_count == 0 ||
                memcmp(x->vertex, y->vertex, 12 * (size_t)x->vertex_count) == 0);
    }
    return same;
}

static struct world_lived *after(const char *spec, enum life_motion motion, uint64_t seed,
                                 uint32_t times)
{
    char text[STEPS_TEXT_MOST];
    const struct step step = {LIFE_REFIT, motion, seed};
    const struct step steps[] = {step, step, step};
    steps_write(steps, times, text);
    return world_lived_make(spec, text);
}

/* --- motions ---------------------------------------------------------------------------------- */

/* Rules of worlds, and the numbers of triangles, are kept: steps_worlds checks them. */
static void motions_move_what_they_say_and_nothing_else(void **state)
{
    (void)state;
    uint32_t moved[MOTIONS] = {0};
    for (enum life_motion m = 0; m < MOTIONS; m++)
        for (uint64_t seed = 0; seed < 24; seed++) {
            struct world_lived *one = after(SPEC, m, seed, 1), *other = after(SPEC, m, seed, 1);
            const struct world *before = &one->world[0], *now = &one->world[1];
            assert_true(same_instances(now, &other->world[1]));
            assert_true(same_vertices(now, &other->world[1]));
            assert_true(same_instances(before, &one->first) && same_vertices(before, &one->first));
            assert_int_equal(world_tri_count(now), world_tri_count(before));
            moved[m] += !same_instances(now, before) || !same_vertices(now, before);
            assert_true(motion_is_of_worlds(m) ? same_vertices(now, before)
                                               : same_instances(now, before));
            for (uint32_t i = 0; i < now->instance_count && m != MOTION_EXCHANGE; i++) {
                const struct instance *a = &before->instance[i], *b = &now->instance[i];
                const bool masks = m == MOTION_MASKS || m == MOTION_HIDE;
                assert_true(a->mesh == b->mesh && a->custom == b->custom && a->flags == b->flags);
                assert_true(masks ? memcmp(a->m, b->m, sizeof a->m) == 0 : a->mask == b->mask);
            }
            world_lived_free(one);
            world_lived_free(other);
        }
    for (enum life_motion m = 0; m < MOTIONS; m++)
        assert_true(m == MOTION_STILL ? moved[m] == 0 : moved[m] > 16);
}

static void some_motions_of_instances_are_their_own_inverse(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        static const enum life_motion of[] = {MOTION_REFLECT, MOTION_EXCHANGE};
        for (size_t i = 0; i < ARRAY_COUNT(of); i++) {
            struct world_lived *lived = after(SPEC, of[i], seed, 2);
            assert_true(same_instances(&lived->world[2], &lived->world[0]));
            world_lived_free(lived);
        }
    }
}

/* The seven turns of masks; none is emptied. Hidden ones are 0, and shown again with all bits. */
static void masks_go_around_and_instances_hide(void **state)
{
    (void)state;
    uint32_t hidden = 0, shown = 0;
    for (uint64_t seed = 0; seed < 7; seed++) {
        struct world_lived *lived = after(SPEC, MOTION_MASKS, seed, 1);
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            const uint32_t a = lived->world[0].instance[i].mask,
                           b = lived->world[1].instance[i].mask;
            assert_int_equal(__builtin_popcount(a), __builtin_popcount(b));
            assert_int_equal(b, (a * 0x101u >> (7 - seed)) & 0xFF);
        }
        world_lived_free(lived);
        lived = after(SPEC, MOTION_HIDE, seed, 2);
        for (uint32_t s = 0; s < 2; s++) {
            bool active = false;
            for (uint32_t i = 0; i < lived->first.instance_count; i++) {
                const uint32_t a = lived->world[s].instance[i].mask,
                               b = lived->world[s + 1].instance[i].mask;
                assert_true(a == b || b == (a ? 0u : 0xFFu));
                hidden += a && !b;
                shown += !a && b;
                active |= world_is_active(&lived->world[s + 1], i);
            }
            assert_true(active);
        }
        world_lived_free(lived);
    }
    assert_true(hidden > 50 && shown > 50);
    for (uint64_t seed = 0; seed < 8; seed++) { /* of one instance alone */
        struct world_lived *lived = after("placed-turned:count=1", MOTION_HIDE, seed, 2);
        assert_true(same_instances(&lived->world[1], &lived->world[0]));
        assert_true(same_instances(&lived->world[2], &lived->world[0]));
        world_lived_free(lived);
    }
}

/* A rotation keeps lengths and the side of mirrors; a scale is a power of two, to the bit. */
static void turns_keep_lengths_and_scales_are_exact(void **state)
{
    (void)state;
    uint32_t turned = 0, scaled = 0;
    for (uint64_t seed = 0; seed < 16; seed++) {
        struct world_lived *turn = after("placed-turned:count=8", MOTION_TURN, seed, 1),
                           *scale = after("placed-turned:count=8", MOTION_SCALE, seed, 1);
        for (uint32_t i = 0; i < 8; i++) {
            const struct instance *a = &turn->world[0].instance[i],
                                  *b = &turn->world[1].instance[i],
                                  *c = &scale->world[1].instance[i];
            const float by = c->m[0][0] / a->m[0][0];
            for (int k = 0; k < 3; k++) {
                double x = 0, y = 0;
                for (int j = 0; j < 3; j++) {
                    x += (double)a->m[j][k] * (double)a->m[j][k];
                    y += (double)b->m[j][k] * (double)b->m[j][k];
                    assert_true(c->m[j][k] == by * a->m[j][k]);
                }
                assert_true(fabs(x - y) < 1e-6 * x && a->m[k][3] == b->m[k][3] &&
                            a->m[k][3] == c->m[k][3]);
            }
            assert_int_equal(instance_det_sign(a->m), instance_det_sign(b->m));
            assert_true(by >= 0.125f && by <= 8.0f && (float_bits(by) & 0x7FFFFFu) == 0);
            turned += memcmp(a->m, b->m, sizeof a->m) != 0;
            scaled += by != 1.0f;
        }
        world_lived_free(turn);
        world_lived_free(scale);
    }
    assert_true(turned == 128 && scaled > 64);
}

static void gathered_instances_are_at_one_place_and_far_ones_are_far(void **state)
{
    (void)state;
    struct world_lived *gather = after(SPEC, MOTION_GATHER, 3, 1),
                       *away = after(SPEC, MOTION_AWAY, 20, 1);
    for (uint32_t i = 0; i < gather->first.instance_count; i++) {
        double far = 0;
        for (int k = 0; k < 3; k++) {
            assert_true(gather->world[1].instance[i].m[k][3] ==
                        gather->world[0].instance[3].m[k][3]);
            far = fmax(far, fabs((double)away->world[1].instance[i].m[k][3]));
        }
        assert_true(far > 1e6);
    }
    world_lived_free(gather);
    world_lived_free(away);
}

/* All that is placed: M and T. One coordinate alone. */
static void reflections_negate_one_coordinate_of_all(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 3; seed++) {
        struct world_lived *lived = after(SPEC, MOTION_REFLECT, seed, 1);
        for (uint32_t i = 0; i < lived->first.instance_count; i++)
            for (uint32_t j = 0; j < 12; j++) {
                const float a = lived->world[0].instance[i].m[j / 4][j % 4],
                            b = lived->world[1].instance[i].m[j / 4][j % 4];
                assert_true(b == (j / 4 == seed ? -a : a));
            }
        world_lived_free(lived);
    }
}

/* Whatever there is no room for stays: boxes and inverses are still float32. */
static void what_cannot_be_placed_stays(void **state)
{
    (void)state;
    static const float size[] = {0x1p110f, 0x1p-100f};
    uint32_t kept = 0, moved = 0;
    for (size_t s = 0; s < ARRAY_COUNT(size); s++)
        for (enum life_motion m = 0; m < MOTIONS; m++)
            for (uint64_t seed = 0; seed < 24; seed++) {
                struct world world, out[LIFE_STEPS_MOST + 1];
                const struct step steps[] = {{LIFE_REFIT, m, seed}, {LIFE_REFIT, m, seed + 23}};
                struct box *box = NULL;
                struct instance_record *record = NULL;
                assert_int_equal(world_open("placed-turned", 1, &world, NULL), STATUS_OK);
                for (uint32_t i = 0; i < world.instance_count; i++)
                    for (int j = 0; j < 12; j++)
                        world.instance[i].m[j / 4][j % 4] *= size[s];
                assert_int_equal(steps_worlds(&world, steps, 2, out, NULL), STATUS_OK);
                assert_int_equal(world_boxes_make(&out[2], WORLD_BOXES_AUTO, &box, NULL),
                                 STATUS_OK);
                assert_int_equal(world_records_make(&out[2], &record, NULL), STATUS_OK);
                for (uint32_t i = 0; i < world.instance_count; i++)
                    for (int k = 0; k < 3 && world_is_active(&out[2], i); k++)
                        assert_true(fabs((double)box[i].lo[k]) < WORLD_REACH &&
                                    fabs((double)box[i].hi[k]) < WORLD_REACH);
                if (m == MOTION_AWAY)
                    *(same_instances(&out[0], &out[1]) ? &kept : &moved) += 1;
                free(box);
                free(record);
                steps_worlds_free(out, 2);
                world_free(&world);
            }
    assert_true(kept > 8 && moved > 8);
}

static void motions_of_instances_are_refused_of_scenes(void **state)
{
    (void)state;
    for (enum life_motion m = 0; m < MOTIONS; m++) {
        const struct step step[] = {{LIFE_REFIT, MOTION_JITTER, 1}, {LIFE_REFIT, m, 1}};
        struct reason reason = {""};
        assert_int_equal(steps_of_scene(step, 2, &reason),
                         motion_is_of_worlds(m) ? STATUS_INPUT : STATUS_OK);
        assert_true(!motion_is_of_worlds(m) || strstr(reason.text, motion_name(m)));
    }
}

/* --- trees ------------------------------------------------------------------------------------ */

static const struct build_options options = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};

static struct world_build build_by(const char *builder)
{
    return (struct world_build){.top = builder_find(builder),
                                .bottom = builder_find(builder),
                                .top_options = options,
                                .bottom_options = options};
}

/* In all layouts and the storages without a grid: a refit leaves what a fresh encoding of the same
 * topology has, at both levels, and no fault. */
static void refitted_worlds_are_those_packed_of_refitted_trees(void **state)
{
    (void)state;
    const struct world_build build = build_by("median");
    uint32_t fates[LIFE_FORCED + 1] = {0}, sound = 0;
    for (size_t w = 0; w < ARRAY_COUNT(world_lived_steps); w++) {
        struct world_lived *lived = world_lived_make(SPEC, world_lived_steps[w]);
        const struct world *last = &lived->world[lived->count];
        for (size_t l = 0; layouts[l]; l++)
            for (size_t s = 0; tri_stores[s] && (s == 0 || l == 0); s++) {
                const struct world_recipe recipe = {&build, layouts[l], layouts[l], tri_stores[s]};
                struct world_life life;
                struct packed_world fresh;
                struct reason reason = {""};
                if (tri_stores[s]->head)
                    continue;
                world_lived_trees(lived, &recipe, &life);
                if (!life.packed.top.layout)
                    continue;
                fates[life.fate]++;
                enum status status = packed_world_make(last, &life.trees, layouts[l], layouts[l],
                                                       tri_stores[s], &fresh, &reason);
                if (status)
                    fail_msg("%s: %s", layouts[l]->name, reason.text);
                if (!same_packed_worlds(&fresh, &life.packed))
                    fail_msg("%s, %s, %s: other bytes", world_lived_steps[w], layouts[l]->name,
                             tri_stores[s]->name);
                if (!layouts[l]->faithful) {
                    if (world_pack_check(last, &life.packed, NULL, &reason))
                        fail_msg("%s, %s: %s", world_lived_steps[w], layouts[l]->name, reason.text);
                    sound++;
                }
                packed_world_free(&fresh);
                world_life_free(&life);
            }
        world_lived_free(lived);
    }
    assert_true(fates[LIFE_REFITTED] > 40 && fates[LIFE_FORCED] > 5 && sound > 60);
}

/* The tree above is refitted, not built again: which entries are in which leaf stays. */
static void the_form_of_both_levels_stays(void **state)
{
    (void)state;
    const struct world_build build = build_by("sah_sweep");
    const struct layout *f32 = layout_find("f32");
    const struct world_recipe recipe = {&build, f32, f32, tri_stores[0]};
    struct world_lived *lived = world_lived_make(SPEC, "refit:drift,refit:jitter:2");
    struct world_life first, last;
    assert_int_equal(world_life_begin(&recipe, &lived->world[0], &first, NULL), STATUS_OK);
    world_lived_trees(lived, &recipe, &last);
    assert_int_equal(last.fate, LIFE_REFITTED);
    assert_memory_equal(first.packed.top.item, last.packed.top.item,
                        4 * (size_t)first.packed.top.item_count);
    assert_int_equal(first.trees.top.node_count, last.trees.top.node_count);
    for (uint32_t i = 0; i < first.trees.top.node_count; i++)
        assert_int_equal(first.trees.top.node[i].snd, last.trees.top.node[i].snd);
    assert_memory_not_equal(first.trees.top.node, last.trees.top.node,
                            first.trees.top.node_count * sizeof *first.trees.top.node);
    world_life_free(&first);
    world_life_free(&last);
    world_lived_free(lived);
}

static enum life_fate fate_after(const char *spec, const char *steps, float presplit,
                                 uint32_t braid)
{
    struct world_build build = build_by("median");
    const struct layout *f32 = layout_find("f32");
    const struct world_recipe recipe = {&build, f32, f32, tri_stores[0]};
    struct world_lived *lived = world_lived_make(spec, steps);
    struct world_life life;
    build.braid = braid;
    build.bottom_options.presplit = presplit;
    world_lived_trees(lived, &recipe, &life);
    const enum life_fate fate = life.fate;
    assert_int_equal(world_pack_check(&lived->world[lived->count], &life.packed, NULL, NULL),
                     STATUS_OK);
    world_life_free(&life);
    world_lived_free(lived);
    return fate;
}

/* What a top level leaves out, or opens, is decided when it is built; so is a split tree. */
static void other_active_instances_parts_and_splits_are_built_again(void **state)
{
    (void)state;
    assert_int_equal(fate_after("crowd:n=20", "refit:drift:3", 0, 0), LIFE_REFITTED);
    assert_int_equal(fate_after("crowd:n=20", "refit:masks:3", 0, 0), LIFE_REFITTED);
    assert_int_equal(fate_after("crowd:n=20", "rebuild:drift:3", 0, 0), LIFE_REBUILT);
    assert_int_equal(fate_after("crowd:n=20", "refit:hide:3", 0, 0), LIFE_FORCED);
    assert_int_equal(fate_after("crowd:n=20", "rebuild:hide:3,refit:hide:3", 0, 0), LIFE_FORCED);
    assert_int_equal(fate_after("crowd:n=20", "refit:hide:3,refit:turn", 0, 0), LIFE_REFITTED);
    assert_int_equal(fate_after("placed-turned:count=9", "refit:drift:9", 0, 1), LIFE_REFITTED);
    assert_int_equal(fate_after("placed-turned:count=9", "refit:drift:9", 0, 16), LIFE_FORCED);
    assert_int_equal(fate_after("mixed", "refit:drift:3", 1, 0), LIFE_FORCED);
}

static void other_numbers_are_refused(void **state)
{
    (void)state;
    struct world_build build = build_by("median");
    struct world_lived *a = world_lived_make("crowd:n=5", ""),
                       *b = world_lived_make("crowd:n=6", ""),
                       *c = world_lived_make("placed-turned:count=5", "");
    struct world_trees trees;
    struct reason reason = {""};
    assert_int_equal(world_trees_make(&a->first, &build, &trees, NULL), STATUS_OK);
    assert_int_equal(world_trees_refit(&trees, &b->first, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "the trees are of 5 instances and 1 meshes, the world has 6 "
                                     "and 1");
    assert_int_equal(world_trees_refit(&trees, &c->first, NULL), STATUS_INPUT);
    assert_int_equal(world_trees_refit(&trees, &a->first, NULL), STATUS_OK);
    world_trees_free(&trees);
    build.braid = 16; /* opened instances */
    assert_int_equal(world_trees_make(&c->first, &build, &trees, NULL), STATUS_OK);
    assert_true(trees.parts.count > 0);
    assert_int_equal(world_trees_refit(&trees, &c->first, NULL), STATUS_LIMIT);
    world_trees_free(&trees);
    world_lived_free(a);
    world_lived_free(b);
    world_lived_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(motions_move_what_they_say_and_nothing_else),
        cmocka_unit_test(some_motions_of_instances_are_their_own_inverse),
        cmocka_unit_test(masks_go_around_and_instances_hide),
        cmocka_unit_test(turns_keep_lengths_and_scales_are_exact),
        cmocka_unit_test(gathered_instances_are_at_one_place_and_far_ones_are_far),
        cmocka_unit_test(reflections_negate_one_coordinate_of_all),
        cmocka_unit_test(what_cannot_be_placed_stays),
        cmocka_unit_test(motions_of_instances_are_refused_of_scenes),
        cmocka_unit_test(refitted_worlds_are_those_packed_of_refitted_trees),
        cmocka_unit_test(the_form_of_both_levels_stays),
        cmocka_unit_test(other_active_instances_parts_and_splits_are_built_again),
        cmocka_unit_test(other_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
