/* Laws of motions: along which axis, and how far. What no number is drawn for is held to the bit,
 * and what is drawn to both ends of its range. */
#include "tests/life/lives.h"
#include "tests/world_life/world_lives.h"

#include <math.h>

#define SEEDS 72u /* all sizes along all axes */

static struct lived moved(enum life_motion motion, uint64_t seed)
{
    char text[STEP_TEXT_MOST];
    step_write(&(struct step){LIFE_REFIT, motion, seed}, text);
    return lived_make("soup:n=40", text);
}

static struct world_lived *placed(const char *spec, enum life_motion motion, uint64_t seed)
{
    char text[STEP_TEXT_MOST];
    step_write(&(struct step){LIFE_REFIT, motion, seed}, text);
    return world_lived_make(spec, text);
}

static double longest_of(const struct box *box)
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, (double)box->hi[k] - (double)box->lo[k]);
    return most;
}

/* --- vertices --------------------------------------------------------------------------------- */

/* The coordinate of a vertex after a motion that draws nothing. */
static float after_plain(enum life_motion m, uint64_t seed, const struct scene *scene, size_t i)
{
    const struct box box = scene_bounds(scene);
    const float x = scene->vertex[i];
    if (m == MOTION_MIRROR)
        return i % 3 == seed % 3 ? -x : x;
    if (m == MOTION_POINT)
        return scene->vertex[3 * (seed % scene->vertex_count) + i % 3];
    const double by = ldexp(longest_of(&box), 1 + (int)(seed % 24));
    return i % 3 == seed / 24 % 3 ? (float)((double)x + by) : x;
}

static void vertices_move_as_their_motion_says_to_the_bit(void **state)
{
    (void)state;
    static const enum life_motion plain[] = {MOTION_MIRROR, MOTION_POINT, MOTION_FAR};
    for (size_t m = 0; m < ARRAY_COUNT(plain); m++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct lived lived = moved(plain[m], seed);
            for (size_t i = 0; i < 3 * (size_t)lived.first.vertex_count; i++)
                assert_true(float_bits(lived.scene[1].vertex[i]) ==
                            float_bits(after_plain(plain[m], seed, &lived.first, i)));
            lived_free(&lived);
        }
}

/* Seeds that are even flatten one axis, each in turn; others all three. */
static void tiny_coordinates_are_those_of_the_axis_of_the_seed(void **state)
{
    (void)state;
    for (enum life_motion m = MOTION_ZERO; m <= MOTION_SUBNORMAL; m++)
        for (uint64_t seed = 0; seed < 12; seed++) {
            struct lived lived = moved(m, seed);
            for (size_t i = 0; i < 3 * (size_t)lived.first.vertex_count; i++) {
                const float is = lived.scene[1].vertex[i], was = lived.first.vertex[i];
                const bool meant = seed % 2 == 1 || i % 3 == seed / 2 % 3;
                assert_true(meant ? fabsf(is) < 0x1p-126f : is == was);
                assert_true(!meant || !signbit(is) == !signbit(was));
            }
            lived_free(&lived);
        }
}

/* No vertex moves farther than the seed says, and one almost as far. */
static void vertices_are_jittered_by_the_size_of_the_seed(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 24; seed++) {
        struct lived lived = moved(MOTION_JITTER, seed);
        const struct box box = scene_bounds(&lived.first);
        double far = 0, most = ldexp(1, -(int)(seed % 12));
        for (size_t i = 0; i < 3 * (size_t)lived.first.vertex_count; i++) {
            const double side = (double)box.hi[i % 3] - (double)box.lo[i % 3];
            const double by = (double)lived.scene[1].vertex[i] - (double)lived.first.vertex[i];
            far = fmax(far, fabs(by) / fmax(side, longest_of(&box)));
        }
        assert_true(far <= most * 1.001 && far > most / 4);
        lived_free(&lived);
    }
}

/* --- instances -------------------------------------------------------------------------------- */

/* The extent of what is placed, from the boxes of its instances. */
static double extent_of(const struct world *world)
{
    struct box *box = NULL, all = box_empty();
    assert_int_equal(world_boxes_make(world, WORLD_BOXES_OF_CORNERS, &box, NULL), STATUS_OK);
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world_is_active(world, i))
            box_add_box(&all, &box[i]);
    free(box);
    return longest_of(&all);
}

/* All go the same way, along one axis, the one of the seed, by its size. */
static void instances_go_away_along_the_axis_of_the_seed(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct world_lived *lived = placed("crowd:n=9", MOTION_AWAY, seed);
        const double side = extent_of(&lived->first), size = ldexp(side, 1 + (int)(seed % 24));
        for (uint32_t i = 0; i < lived->first.instance_count; i++)
            for (uint32_t j = 0; j < 12; j++) {
                const double by = (double)lived->world[1].instance[i].m[j / 4][j % 4] -
                                  (double)lived->first.instance[i].m[j / 4][j % 4];
                const bool meant = j % 4 == 3 && j / 4 == seed / 24 % 3;
                assert_true(meant ? fabs(by - size) <= 1e-5 * size : by == 0);
            }
        world_lived_free(lived);
    }
}

static void instances_drift_by_the_size_of_the_seed(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 24; seed++) {
        struct world_lived *lived = placed("crowd:n=40", MOTION_DRIFT, seed);
        const double most = ldexp(extent_of(&lived->first), -(int)(seed % 12));
        double far[3] = {0, 0, 0};
        for (uint32_t i = 0; i < lived->first.instance_count; i++)
            for (int k = 0; k < 3; k++)
                far[k] = fmax(far[k], fabs((double)lived->world[1].instance[i].m[k][3] -
                                           (double)lived->first.instance[i].m[k][3]));
        for (int k = 0; k < 3; k++)
            assert_true(far[k] <= most * 1.001 && far[k] > most / 2);
        world_lived_free(lived);
    }
}

/* A quaternion (1, x, y, z) turns by twice the angle whose tangent is |(x, y, z)|. */
static void instances_turn_by_the_size_of_the_seed(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 16; seed++) {
        struct world_lived *lived = placed("crowd:n=40", MOTION_TURN, seed);
        const double most = ldexp(1, -(int)(seed % 8));
        double far = 0;
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            double trace = 0, size = 0; /* of R = M' M^-1: M is a rotation times a number */
            for (uint32_t j = 0; j < 9; j++) {
                const double was = (double)lived->first.instance[i].m[j / 3][j % 3];
                trace += was * (double)lived->world[1].instance[i].m[j / 3][j % 3];
                size += was * was;
            }
            trace *= 3 / size;
            far = fmax(far, tan(acos(fmax(-1, fmin(1, (trace - 1) / 2))) / 2));
        }
        assert_true(far <= sqrt(3) * most * 1.01 && far > most / 2);
        world_lived_free(lived);
    }
}

/* From an eighth to eight times, each of the seven powers. */
static void scales_are_each_of_seven_powers(void **state)
{
    (void)state;
    uint32_t seen = 0;
    for (uint64_t seed = 0; seed < 8; seed++) {
        struct world_lived *lived = placed("crowd:n=20", MOTION_SCALE, seed);
        for (uint32_t i = 0; i < lived->first.instance_count; i++) {
            const float by = lived->world[1].instance[i].m[0][0] / lived->first.instance[i].m[0][0];
            assert_true(by >= 0.125f && by <= 8);
            seen |= 1u << (3 + ilogbf(by));
        }
        world_lived_free(lived);
    }
    assert_int_equal(seen, 0x7F);
}

/* What reaches far already may move where it reaches no farther: in a mirror it does not. */
static void what_reaches_far_moves_where_it_reaches_no_farther(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 3; seed++) {
        struct world world, out[LIFE_STEPS_MOST + 1];
        const struct step step = {LIFE_REFIT, MOTION_REFLECT, seed};
        assert_int_equal(world_open("placed-turned", 1, &world, NULL), STATUS_OK);
        for (uint32_t i = 0; i < world.instance_count; i++)
            for (int j = 0; j < 12; j++)
                world.instance[i].m[j / 4][j % 4] *= 0x1p121f;
        assert_int_equal(steps_worlds(&world, &step, 1, out, NULL), STATUS_OK);
        for (uint32_t i = 0; i < world.instance_count; i++)
            for (uint32_t j = 0; j < 12; j++) {
                const float was = world.instance[i].m[j / 4][j % 4];
                assert_true(out[1].instance[i].m[j / 4][j % 4] == (j / 4 == seed ? -was : was));
            }
        steps_worlds_free(out, 1);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_move_as_their_motion_says_to_the_bit),
        cmocka_unit_test(tiny_coordinates_are_those_of_the_axis_of_the_seed),
        cmocka_unit_test(vertices_are_jittered_by_the_size_of_the_seed),
        cmocka_unit_test(instances_go_away_along_the_axis_of_the_seed),
        cmocka_unit_test(instances_drift_by_the_size_of_the_seed),
        cmocka_unit_test(instances_turn_by_the_size_of_the_seed),
        cmocka_unit_test(scales_are_each_of_seven_powers),
        cmocka_unit_test(what_reaches_far_moves_where_it_reaches_no_farther),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
