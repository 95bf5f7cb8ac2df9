/* Laws of motions of instances by value: how far, how much, how often, each on its own, and which
 * of them are left out. */
#include "tests/world_life/world_lives.h"

#include <float.h>
#include <math.h>

#define SPEC  "crowd:n=40"
#define FEW   "crowd:n=20"
#define SEEDS 72u

/* The world before and after a motion. */
static struct world_lived *moved(const char *spec, enum life_motion motion, uint64_t seed)
{
    char text[STEPS_TEXT_MOST];
    const struct step step = {LIFE_REFIT, motion, seed};
    steps_write(&step, 1, text);
    return world_lived_make(spec, text);
}

/* The longest side of the box around all that is active. */
static double extent_of(const struct world *world)
{
    struct box *box, all = box_empty();
    double most = 0;
    assert_int_equal(world_boxes_make(world, WORLD_BOXES_OF_CORNERS, &box, NULL), STATUS_OK);
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world_is_active(world, i))
            box_add_box(&all, &box[i]);
    for (int k = 0; k < 3; k++)
        most = fmax(most, (double)all.hi[k] - (double)all.lo[k]);
    free(box);
    return most;
}

/* What was drawn, as parts of the most that it may be. */
struct drawn_amounts {
    double least, most, sum;
    uint32_t count;
};

static void note(struct drawn_amounts *drawn, double part)
{
    assert_true(fabs(part) <= 1.001);
    drawn->least = fmin(drawn->least, part);
    drawn->most = fmax(drawn->most, part);
    drawn->sum += part;
    drawn->count++;
}

/* From one end to the other, about 0. */
static void expect_uniform(const struct drawn_amounts *drawn, double ends)
{
    assert_true(drawn->least < -ends && drawn->most > ends);
    assert_true(fabs(drawn->sum / drawn->count) < 4 / sqrt(3.0 * drawn->count));
}

/* Each instance along each axis on its own, by up to 2^-(seed mod 12) extents; M stays. */
static void drifts_are_up_to_a_part_of_the_extent(void **state)
{
    (void)state;
    struct drawn_amounts axis[3] = {{0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct world_lived *lived = moved(SPEC, MOTION_DRIFT, seed);
        const double most = ldexp(extent_of(&lived->world[0]), -(int)(seed % 12));
        struct drawn_amounts here = {0};
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            const struct instance *a = &lived->world[0].instance[i],
                                  *b = &lived->world[1].instance[i];
            for (int k = 0; k < 3; k++) {
                const double part = ((double)b->m[k][3] - (double)a->m[k][3]) / most;
                assert_memory_equal(a->m[k], b->m[k], 3 * sizeof(float));
                note(&axis[k], part);
                note(&here, part);
            }
        }
        expect_uniform(&here, 0.8);
        world_lived_free(lived);
    }
    for (int k = 0; k < 3; k++)
        expect_uniform(&axis[k], 0.99);
}

/* R of M' = R M. */
static void rotation_of(const struct instance *before, const struct instance *now, double r[3][3])
{
    double m[3][3], w[3][3], det = 0;
    for (int i = 0; i < 9; i++)
        m[i / 3][i % 3] = (double)before->m[i / 3][i % 3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            w[k][i] = m[(i + 1) % 3][(k + 1) % 3] * m[(i + 2) % 3][(k + 2) % 3] -
                      m[(i + 1) % 3][(k + 2) % 3] * m[(i + 2) % 3][(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        det += m[0][k] * w[k][0];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            r[i][k] = 0;
            for (int j = 0; j < 3; j++)
                r[i][k] += (double)now->m[i][j] * w[j][k] / det;
        }
}

/* By a rotation, the tangent of half whose angle times its axis is up to 2^-(seed mod 8) each. */
static void turns_are_rotations_by_up_to_a_part(void **state)
{
    (void)state;
    struct drawn_amounts axis[3] = {{0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct world_lived *lived = moved("placed-turned:count=40", MOTION_TURN, seed);
        struct drawn_amounts here = {0};
        for (uint32_t n = 0; n < lived->first.instance_count; n++) {
            double r[3][3];
            rotation_of(&lived->world[0].instance[n], &lived->world[1].instance[n], r);
            const double trace = 1 + r[0][0] + r[1][1] + r[2][2];
            for (int i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                const double part = ldexp((r[k][j] - r[j][k]) / trace, (int)(seed % 8));
                double own = 0, other = 0;
                for (int a = 0; a < 3; a++) {
                    own += r[i][a] * r[i][a];
                    other += r[i][a] * r[j][a];
                }
                assert_true(fabs(own - 1) < 1e-5 && fabs(other) < 1e-5);
                note(&axis[i], part);
                note(&here, part);
            }
        }
        expect_uniform(&here, 0.8);
        world_lived_free(lived);
    }
    for (int i = 0; i < 3; i++)
        expect_uniform(&axis[i], 0.99);
}

/* All along one axis, by the same. */
static void all_go_away_along_one_axis(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct world_lived *lived = moved(SPEC, MOTION_AWAY, seed);
        const double by = ldexp(extent_of(&lived->world[0]), 1 + (int)(seed % 24));
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            struct instance a = lived->world[0].instance[i], b = lived->world[1].instance[i];
            const float x = a.m[seed / 24][3], y = b.m[seed / 24][3];
            assert_true(fabs(((double)y - (double)x) / by - 1) < 1e-5);
            b.m[seed / 24][3] = x;
            assert_memory_equal(&a, &b, sizeof a);
        }
        world_lived_free(lived);
    }
}

/* Every power of two from 1/8 to 8, each about as often; half of all are hidden; all can be
 * exchanged, two at a time; each can be where all gather. */
static void every_choice_is_drawn(void **state)
{
    (void)state;
    uint32_t power[7] = {0}, hidden = 0, all = 0, exchanged[20] = {0}, origin[20] = {0};
    for (uint64_t seed = 0; seed < 4 * SEEDS; seed++) {
        struct world_lived *scale = moved(FEW, MOTION_SCALE, seed),
                           *hide = moved(FEW, MOTION_HIDE, seed),
                           *exchange = moved(FEW, MOTION_EXCHANGE, seed),
                           *gather = moved(FEW, MOTION_GATHER, seed);
        const uint32_t count = scale->first.instance_count, at = (uint32_t)(seed % count);
        uint32_t other = 0;
        assert_int_equal(count, 20);
        for (uint32_t i = 0; i < count; i++) {
            const struct instance *a = &scale->world[0].instance[i];
            const float by = scale->world[1].instance[i].m[0][0] / a->m[0][0];
            power[ilogbf(by) + 3]++;
            hidden += hide->world[1].instance[i].mask != a->mask;
            if (memcmp(a, &exchange->world[1].instance[i], sizeof *a) != 0) {
                exchanged[i]++;
                other++;
            }
            for (int k = 0; k < 3; k++)
                assert_true(gather->world[1].instance[i].m[k][3] ==
                            gather->world[0].instance[at].m[k][3]);
        }
        assert_true(other == 0 || other == 2);
        origin[at]++;
        all += count;
        world_lived_free(scale);
        world_lived_free(hide);
        world_lived_free(exchange);
        world_lived_free(gather);
    }
    for (int i = 0; i < 7; i++)
        assert_in_range(power[i], all / 7 * 9 / 10, all / 7 * 11 / 10);
    assert_in_range(hidden, all * 2 / 5, all * 3 / 5);
    for (int i = 0; i < 20; i++)
        assert_true(exchanged[i] > 0 && origin[i] > 0);
}

/* Steps are kept in findings as a motion and a seed: what they do is the same on every machine, and
 * stays so. FNV-1a of all transforms, masks and meshes. */
static uint64_t hash_of(enum life_motion motion)
{
    uint64_t hash = 0xCBF29CE484222325u;
    for (uint64_t seed = 0; seed < 30; seed++) {
        struct world_lived *lived = moved("mixed", motion, seed);
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            const struct instance *instance = &lived->world[1].instance[i];
            for (int j = 0; j < 14; j++) {
                const uint32_t word = j < 12    ? float_bits(instance->m[j / 4][j % 4])
                                      : j == 12 ? instance->mask
                                                : instance->mesh;
                hash = (hash ^ word) * 0x100000001B3u;
            }
        }
        world_lived_free(lived);
    }
    return hash;
}

static void a_seed_stands_for_the_same_motion_for_ever(void **state)
{
    (void)state;
    static const uint64_t was[MOTIONS - MOTIONS_OF_VERTICES] = {
        0x80DA0988A701CD24u, 0xC3BC6C15F6B95778u, 0xF29F57F7BEF9B6ADu,
        0x4103BD2F2679B6ADu, 0xD0148F4ED13B25D1u, 0x22BF5F2D683E31D5u,
        0xD17DC9B6E7919195u, 0x01503760D0066A46u, 0x2B2AB3CC1CD2E34Bu};
    for (enum life_motion m = MOTIONS_OF_VERTICES; m < MOTIONS; m++)
        if (hash_of(m) != was[m - MOTIONS_OF_VERTICES])
            fail_msg("%s: 0x%016llXu", motion_name(m), (unsigned long long)hash_of(m));
}

/* --- what is left out ------------------------------------------------------------------------- */

/* The largest coordinate that a corner of the mesh's box can have. */
static double reach_of(const struct world *world, uint32_t at)
{
    const struct instance *instance = &world->instance[at];
    const struct box box = scene_bounds(world->mesh[instance->mesh].scene);
    double most = 0;
    for (int corner = 0; corner < 8; corner++)
        for (int i = 0; i < 3; i++) {
            double sum = fabs((double)instance->m[i][3]); /* on whichever side it is */
            for (int k = 0; k < 3; k++)
                sum += fabs((double)instance->m[i][k] *
                            (double)(corner >> k & 1 ? box.hi : box.lo)[k]);
            most = fmax(most, sum);
        }
    return most;
}

/* One instance of a mesh whose box is lo to hi on each axis: M has `m` on the diagonal and `beside`
 * behind it, T is `t` along one axis. */
struct far_place {
    float lo, hi, m, beside, t;
    int axis;
    uint32_t mesh; /* of the world's */
};

static struct world far_world(const struct far_place *place)
{
    struct world world;
    assert_int_equal(world_open("mixed:count=1", 1, &world, NULL), STATUS_OK);
    struct scene *scene = world.mesh[place->mesh].scene;
    const struct box box = scene_bounds(scene);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        const float x = scene->vertex[i];
        scene->vertex[i] = x == box.lo[i % 3] ? place->lo : x == box.hi[i % 3] ? place->hi : 0;
    }
    world.instance[0].mesh = place->mesh;
    world.instance[0].mask = 0xFF;
    for (int i = 0; i < 3; i++) {
        world.instance[0].m[i][i] = place->m;
        world.instance[0].m[i][(i + 2) % 3] = 0;
        world.instance[0].m[i][(i + 1) % 3] = place->beside;
        world.instance[0].m[i][3] = i == place->axis ? place->t : 0;
    }
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    return world;
}

/* What a motion makes of it, where there is room for everything. */
static void expect_room(const struct far_place *place, const struct step *step, uint32_t *stayed,
                        uint32_t *went)
{
    struct world near =
                     far_world(&(struct far_place){place->lo, place->hi, 1, 0, 0, 0, place->mesh}),
                 far = far_world(place);
    struct instance wanted = far.instance[0];
    const struct instance was = wanted;
    assert_int_equal(world_motion_apply(step, &near, NULL), STATUS_OK);
    const float by = near.instance[0].m[0][0];
    for (int j = 0; j < 12; j++)
        if (step->motion == MOTION_REFLECT)
            wanted.m[j / 4][j % 4] *= (uint64_t)j / 4 == step->seed ? -1.0f : 1.0f;
        else if (j % 4 < 3)
            wanted.m[j / 4][j % 4] *= by;
    const double before = reach_of(&far, 0);
    far.instance[0] = wanted;
    const double after = reach_of(&far, 0);
    far.instance[0] = was;
    const bool goes = after < WORLD_REACH || after <= before;
    assert_int_equal(world_motion_apply(step, &far, NULL), STATUS_OK);
    assert_memory_equal(&far.instance[0], goes ? &wanted : &was, sizeof wanted);
    *(goes ? went : stayed) += 1;
    world_free(&near);
    world_free(&far);
}

/* A transform that takes a corner to WORLD_REACH or beyond is kept as it was, unless it is no
 * further than before. */
static void an_instance_stays_where_it_would_reach_too_far(void **state)
{
    (void)state;
    static const float side[][2] = {{-1, 1}, {-1, 0.5f}, {-0.25f, 1}, {0, 1}, {-1, 0}};
    uint32_t stayed = 0, went = 0;
    for (size_t s = 0; s < ARRAY_COUNT(side); s++)
        for (int e = 116; e < 124; e++)
            for (uint64_t seed = 0; seed < 6; seed++) {
                const float lo = side[s][0], hi = side[s][1], size = ldexpf(1, e);
                const int axis = (int)(seed % 3);
                const uint32_t mesh = seed / 3 % 2;
                const struct far_place place[] = {
                    {lo, hi, size, 0, 0, 0, mesh},
                    {lo, hi, size / 2, size / 2, 0, 0, mesh},
                    {lo, hi, size / 2, 0, -size / 2, axis, mesh},
                    {lo, hi, size / 2, -size, size, axis, mesh},
                };
                for (size_t p = 0; p < ARRAY_COUNT(place); p++) {
                    const struct step scale = {LIFE_REFIT, MOTION_SCALE, seed},
                                      mirror = {LIFE_REFIT, MOTION_REFLECT, seed % 3};
                    expect_room(&place[p], &scale, &stayed, &went);
                    expect_room(&place[p], &mirror, &stayed, &went);
                }
            }
    assert_true(stayed > 200 && went > 500);
}

/* Each mesh moves as a scene does, unless an instance of it would reach too far. */
static void a_mesh_stays_where_an_instance_would_reach_too_far(void **state)
{
    (void)state;
    uint32_t stayed = 0, went = 0;
    for (uint64_t seed = 0; seed < 48; seed++) {
        struct world world, out[LIFE_STEPS_MOST + 1];
        const struct step step = {LIFE_REFIT, seed % 2 ? MOTION_FAR : MOTION_JITTER, seed / 2};
        assert_int_equal(world_open("mixed", 1, &world, NULL), STATUS_OK);
        for (uint32_t i = 0; i < world.instance_count; i += 2) {
            const uint64_t scale = (11 * seed + 17 * world.instance[i].mesh) % 40;
            for (int j = 0; j < 12; j++)
                world.instance[i].m[j / 4][j % 4] *= ldexpf(1, 82 + (int)scale);
        }
        assert_int_equal(steps_worlds(&world, &step, 1, out, NULL), STATUS_OK);
        for (uint32_t mesh = 0; mesh < world.mesh_count && world.mesh[mesh].scene->tri_count;
             mesh++) {
            struct scene *scene = world.mesh[mesh].scene;
            double before = 0, after = 0;
            const size_t bytes = 12 * (size_t)scene->vertex_count;
            float *was = alloc_copy(scene->vertex, scene->vertex_count, 12);
            for (uint32_t i = 0; i < world.instance_count; i++)
                if (world.instance[i].mesh == mesh)
                    before = fmax(before, reach_of(&world, i));
            motion_apply(&step, scene);
            for (uint32_t i = 0; i < world.instance_count; i++)
                if (world.instance[i].mesh == mesh)
                    after = fmax(after, reach_of(&world, i));
            const bool goes = after < WORLD_REACH || after <= before;
            assert_memory_equal(out[1].mesh[mesh].scene->vertex, goes ? scene->vertex : was, bytes);
            *(goes ? &went : &stayed) += 1;
            free(was);
        }
        steps_worlds_free(out, 1);
        world_free(&world);
    }
    assert_true(stayed > 10 && went > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drifts_are_up_to_a_part_of_the_extent),
        cmocka_unit_test(turns_are_rotations_by_up_to_a_part),
        cmocka_unit_test(all_go_away_along_one_axis),
        cmocka_unit_test(every_choice_is_drawn),
        cmocka_unit_test(a_seed_stands_for_the_same_motion_for_ever),
        cmocka_unit_test(an_instance_stays_where_it_would_reach_too_far),
        cmocka_unit_test(a_mesh_stays_where_an_instance_would_reach_too_far),
    };
    return cmocka_run_group_tests_name("world_motion", tests, NULL, NULL);
}
