/* Laws of motions, of steps and of the trees that go through them. */
#include "ref/packed/packed_check.h"

#include "tests/life/lives.h"

#include <float.h>
#include <math.h>

#define SPEC "soup:n=60"

static bool same_vertices(const struct scene *a, const struct scene *b)
{
    return memcmp(a->vertex, b->vertex, 12 * (size_t)a->vertex_count) == 0;
}

/* --- motions and texts ------------------------------------------------------------------------ */

static void motions_are_finite_the_same_each_time_and_themselves(void **state)
{
    (void)state;
    for (enum life_motion m = 0; m < MOTIONS_OF_VERTICES; m++)
        for (uint64_t seed = 0; seed < 40; seed++) {
            struct lived lived = lived_make(SPEC, "");
            struct step step = {LIFE_REFIT, m, seed};
            struct scene out[2][LIFE_STEPS_MOST + 1];
            uint32_t moved = 0;
            for (int i = 0; i < 2; i++)
                assert_int_equal(steps_scenes(&lived.first, &step, 1, out[i], NULL), STATUS_OK);
            assert_true(same_vertices(&out[0][0], &lived.first));
            assert_true(same_vertices(&out[0][1], &out[1][1]));
            for (uint32_t i = 0; i < lived.first.vertex_count; i++) {
                const float *p = out[0][1].vertex + 3 * (size_t)i;
                assert_true(float_is_finite(p[0]) && float_is_finite(p[1]) &&
                            float_is_finite(p[2]));
                moved += memcmp(p, lived.first.vertex + 3 * (size_t)i, 12) != 0;
            }
            assert_true(m == MOTION_STILL ? moved == 0 : m == MOTION_SWAP || moved > 0);
            assert_true(m != MOTION_ONE || moved == 1);
            assert_true(m != MOTION_SWAP || moved <= 6);
            steps_free(out[0], 1);
            steps_free(out[1], 1);
            lived_free(&lived);
        }
}

/* Whatever there is no room for stays where it was. */
static void motions_of_the_largest_floats_are_finite(void **state)
{
    (void)state;
    uint32_t moved = 0;
    for (enum life_motion m = 0; m < MOTIONS_OF_VERTICES; m++)
        for (uint64_t seed = 0; seed < 80; seed++) {
            struct lived lived = lived_make(SPEC, "");
            const struct step step = {LIFE_REFIT, m, seed};
            const struct box box = scene_bounds(&lived.first);
            struct scene out[LIFE_STEPS_MOST + 1];
            for (uint32_t i = 0; i < 3 * lived.first.vertex_count; i++) {
                const float most = fmaxf(fabsf(box.lo[i % 3]), fabsf(box.hi[i % 3]));
                lived.first.vertex[i] =
                    (float)((double)lived.first.vertex[i] * 0.999 * (double)FLT_MAX / (double)most);
                assert_true(float_is_finite(lived.first.vertex[i]));
            }
            assert_int_equal(steps_scenes(&lived.first, &step, 1, out, NULL), STATUS_OK);
            for (uint32_t i = 0; i < 3 * lived.first.vertex_count; i++)
                assert_true(float_is_finite(out[1].vertex[i]));
            moved += m == MOTION_ONE && !same_vertices(&out[0], &out[1]);
            steps_free(out, 1);
            lived_free(&lived);
        }
    assert_true(moved > 20);
}

/* Of the seeds of a motion that has a size and an axis, each pair is one seed's; those of a size
 * that is random else move the vertices otherwise. */
static void seeds_are_each_another_motion(void **state)
{
    (void)state;
    enum { FAR = 72, JITTER = 48 };
    struct lived far[FAR], jitter[JITTER];
    char text[60];
    for (uint32_t i = 0; i < FAR; i++) {
        uint32_t axes = 0;
        snprintf(text, sizeof text, "refit:far:%u", i);
        far[i] = lived_make(SPEC, text);
        for (uint32_t k = 0; k < 3; k++)
            axes += far[i].scene[1].vertex[k] != far[i].first.vertex[k];
        assert_int_equal(axes, 1);
        for (uint32_t k = 0; k < i; k++)
            assert_false(same_vertices(&far[i].scene[1], &far[k].scene[1]));
    }
    for (uint32_t i = 0; i < JITTER; i++) {
        snprintf(text, sizeof text, "refit:jitter:%u", i);
        jitter[i] = lived_make(SPEC, text);
        for (uint32_t k = 0; k < i; k++)
            assert_false(same_vertices(&jitter[i].scene[1], &jitter[k].scene[1]));
    }
    for (uint32_t i = 0; i < FAR; i++)
        lived_free(&far[i]);
    for (uint32_t i = 0; i < JITTER; i++)
        lived_free(&jitter[i]);
}

static void some_motions_are_their_own_inverse(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 30; seed++)
        for (int m = 0; m < 2; m++) {
            char text[STEPS_TEXT_MOST];
            const struct step step = {LIFE_REFIT, m ? MOTION_MIRROR : MOTION_SWAP, seed};
            const struct step both[] = {step, step};
            steps_write(both, 2, text);
            struct lived lived = lived_make(SPEC, text);
            struct scene back[LIFE_STEPS_MOST + 1];
            assert_true(same_vertices(&lived.scene[2], &lived.scene[0]));
            assert_int_equal(steps_scenes_back(&lived.scene[1], both, 1, back, NULL), STATUS_OK);
            assert_true(same_vertices(&back[0], &lived.scene[0]));
            assert_true(same_vertices(&back[1], &lived.scene[1]));
            steps_free(back, 1);
            lived_free(&lived);
        }
}

static void nasty_motions_are_as_nasty_as_they_say(void **state)
{
    (void)state;
    struct lived point = lived_make(SPEC, "refit:point:5"), zero = lived_make(SPEC, "refit:zero:1"),
                 tiny = lived_make(SPEC, "refit:subnormal:1"),
                 far = lived_make(SPEC, "refit:far:20");
    bool minus = false, plus = false;
    for (uint32_t i = 0; i < 3 * point.first.vertex_count; i++) {
        assert_true(point.scene[1].vertex[i] == point.scene[1].vertex[i % 3]);
        assert_true(zero.scene[1].vertex[i] == 0);
        minus = minus || float_bits(zero.scene[1].vertex[i]) != 0;
        plus = plus || float_bits(zero.scene[1].vertex[i]) == 0;
        assert_true(float_bits(tiny.scene[1].vertex[i]) << 1 < 0x01000000u);
    }
    assert_true(minus && plus);
    struct box box = scene_bounds(&far.scene[1]);
    assert_true(box.lo[0] > 1e6f || box.lo[1] > 1e6f || box.lo[2] > 1e6f);
    lived_free(&point);
    lived_free(&zero);
    lived_free(&tiny);
    lived_free(&far);
}

/* A soup's triangles share no vertices. */
static void the_triangles_of_a_swap_are_each_others(void **state)
{
    (void)state;
    uint32_t swapped = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        char text[STEP_TEXT_MOST];
        const struct step step = {LIFE_REFIT, MOTION_SWAP, seed};
        step_write(&step, text);
        struct lived lived = lived_make(SPEC, text);
        for (uint32_t i = 0; i < lived.first.tri_count; i++) {
            float now[3][3], then[3][3];
            uint32_t k = 0;
            scene_tri(&lived.scene[1], i, now);
            do
                scene_tri(&lived.scene[0], k, then);
            while (memcmp(now, then, sizeof now) != 0 && ++k < lived.first.tri_count);
            assert_true(k < lived.first.tri_count);
            swapped += k != i;
        }
        lived_free(&lived);
    }
    assert_true(swapped > 20);
}

static void texts_are_read_as_they_are_written(void **state)
{
    (void)state;
    static const char *const wrong[] = {"",
                                        "fit",
                                        "refit:",
                                        "refit:jump",
                                        "refit,",
                                        ",refit",
                                        "refit:jitter:-1",
                                        "refit:far:x",
                                        "move:3",
                                        "refit:far:1:1",
                                        "refit:far:",
                                        "rebuild: far",
                                        "refit:far:12345678901234567890"};
    static const char all[] = "refit,refit,refit,refit,refit,refit,refit,refit";
    for (enum life_act act = 0; act < LIFE_ACTS; act++)
        for (enum life_motion m = 0; m < MOTIONS; m++)
            for (uint64_t seed = 0; seed < 2; seed++) {
                const struct step in[] = {{act, m, seed * 5000000000000000000u}, {act, m, 7}};
                struct step out[LIFE_STEPS_MOST];
                char text[STEPS_TEXT_MOST], again[STEPS_TEXT_MOST];
                uint32_t count;
                steps_write(in, 2, text);
                assert_int_equal(steps_parse(text, out, &count, NULL), STATUS_OK);
                assert_int_equal(count, 2);
                steps_write(out, count, again);
                assert_string_equal(again, text);
                assert_true(out[0].act == act && out[0].motion == m && out[1].seed == 7);
            }
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        struct step out[LIFE_STEPS_MOST];
        struct reason reason = {""};
        uint32_t count;
        assert_int_equal(steps_parse(wrong[i], out, &count, &reason), STATUS_INPUT);
        assert_true(reason.text[0]);
    }
    struct step out[LIFE_STEPS_MOST];
    uint32_t count;
    char more[100];
    snprintf(more, sizeof more, "%s,refit", all);
    assert_int_equal(steps_parse(all, out, &count, NULL), STATUS_OK);
    assert_int_equal(count, LIFE_STEPS_MOST);
    assert_int_equal(steps_parse(more, out, &count, NULL), STATUS_INPUT);
}

/* --- trees ------------------------------------------------------------------------------------ */

static const struct build_options options = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};

typedef void pair_fn(const struct life_tree *one, const struct life_tree *other, const char *what);

/* The trees of two lives, in all layouts and the storages that have no grid, of two builders. */
static void in_every_layout(const char *one, const char *other, pair_fn *check)
{
    static const char *const names[] = {"median", "sah_sweep"};
    struct lived a = lived_make(SPEC, one), b = lived_make(SPEC, other);
    uint32_t pairs = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t s = 0; tri_stores[s]; s++)
            for (size_t n = 0; n < 2 && !tri_stores[s]->head; n++) {
                const struct life_recipe recipe = {builder_find(names[n]), &options, tri_stores[s],
                                                   layouts_all[l]};
                struct life_tree x, y;
                lived_tree(&a, &recipe, &x);
                lived_tree(&b, &recipe, &y);
                if (x.packed.layout && y.packed.layout) {
                    check(&x, &y, layouts_all[l]->name);
                    pairs++;
                }
                life_tree_free(&x);
                life_tree_free(&y);
            }
    assert_true(pairs > 100);
    lived_free(&a);
    lived_free(&b);
}

static void same_tree(const struct life_tree *one, const struct life_tree *other, const char *what)
{
    if (!lived_same_packed(&one->packed, &other->packed) || !lived_same_bvh(&one->bvh, &other->bvh))
        fail_msg("%s: other bytes", what);
}

static void refitted_twice_is_refitted_once(void **state)
{
    (void)state;
    in_every_layout("refit:jitter:9,refit:still", "refit:jitter:9", same_tree);
    in_every_layout("refit:one:4,refit:still,refit:still:3", "refit:one:4", same_tree);
}

static void there_and_back_is_the_first_refit(void **state)
{
    (void)state;
    in_every_layout("refit:swap:8,refit:swap:8", "refit", same_tree);
    in_every_layout("refit:swap:2,refit:swap:11,refit:swap:11,refit:swap:2", "refit", same_tree);
}

static void a_step_that_does_nothing_can_be_dropped(void **state)
{
    (void)state;
    in_every_layout("refit:jitter:8,refit,refit:swap:3", "refit:jitter:8,refit:swap:3", same_tree);
    in_every_layout("rebuild:jitter:3,rebuild", "rebuild:jitter:3", same_tree);
}

/* Whatever happened before it. */
static void a_rebuilt_tree_is_that_of_its_scene(void **state)
{
    (void)state;
    struct lived lived = lived_make(SPEC, "refit:jitter:3,refit:swap:5,rebuild:mirror:1");
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct life_recipe recipe = {builder_find("sah_sweep"), &options, tri_stores[0],
                                           layouts_all[l]};
        struct life_tree last, fresh;
        lived_tree(&lived, &recipe, &last);
        enum status status = life_begin(&recipe, &lived.scene[lived.count], &fresh, NULL);
        assert_int_equal(status == STATUS_OK, last.packed.layout != NULL);
        if (!status)
            same_tree(&last, &fresh, layouts_all[l]->name);
        assert_true(status || last.fate == LIFE_REBUILT);
        life_tree_free(&last);
        life_tree_free(&fresh);
    }
    lived_free(&lived);
}

/* The tree before a step stays as it was: what an engine holds of it may be read on. */
static void a_step_leaves_the_tree_before_it(void **state)
{
    (void)state;
    struct lived lived = lived_make(SPEC, "refit:jitter:5");
    uint32_t refitted = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct life_recipe recipe = {builder_find("median"), &options, tri_stores[0],
                                           layouts_all[l]};
        struct life_tree one, same, next;
        if (life_begin(&recipe, &lived.scene[0], &one, NULL) ||
            life_begin(&recipe, &lived.scene[0], &same, NULL))
            continue;
        assert_int_equal(life_step(&recipe, LIFE_REFIT, &lived.scene[1], &one, &next, NULL),
                         STATUS_OK);
        same_tree(&one, &same, layouts_all[l]->name);
        assert_true(next.fate == LIFE_REFITTED || next.fate == LIFE_FORCED);
        assert_true(layouts_all[l]->rebound || next.fate == LIFE_FORCED);
        refitted += next.fate == LIFE_REFITTED;
        life_tree_free(&one);
        life_tree_free(&same);
        life_tree_free(&next);
    }
    assert_true(refitted > 20);
    lived_free(&lived);
}

/* Each packed tree contains its triangles, to the last step, nasty ones included. */
static void every_tree_holds_its_scene(void **state)
{
    (void)state;
    uint32_t refitted = 0, forced = 0;
    for (uint64_t seed = 0; seed < 8; seed++)
        for (enum life_motion m = 0; m < MOTIONS_OF_VERTICES; m++) {
            struct lived lived = lived_make(SPEC, "refit,refit,rebuild,refit");
            for (uint32_t i = 0; i < lived.count; i++)
                lived.step[i] = (struct step){lived.step[i].act,
                                              (m + i * seed) % MOTIONS_OF_VERTICES, seed + i};
            steps_free(lived.scene, lived.count);
            assert_int_equal(steps_scenes(&lived.first, lived.step, lived.count, lived.scene, NULL),
                             STATUS_OK);
            for (size_t l = 0; layouts[l]; l++) {
                const struct life_recipe recipe = {builder_find("median"), &options, tri_stores[0],
                                                   layouts[l]};
                struct life_tree tree;
                struct reason reason = {""};
                lived_tree(&lived, &recipe, &tree);
                if (tree.packed.layout && !layouts[l]->faithful &&
                    (packed_check(&tree.packed, &lived.scene[4], NULL, &reason) ||
                     bvh_check(&tree.bvh, &lived.scene[4], &reason)))
                    fail_msg("%s: %s", layouts[l]->name, reason.text);
                refitted += tree.packed.layout && tree.fate == LIFE_REFITTED;
                forced += tree.packed.layout && tree.fate == LIFE_FORCED;
                life_tree_free(&tree);
            }
            lived_free(&lived);
        }
    assert_true(refitted > 100 && forced > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(motions_are_finite_the_same_each_time_and_themselves),
        cmocka_unit_test(motions_of_the_largest_floats_are_finite),
        cmocka_unit_test(seeds_are_each_another_motion),
        cmocka_unit_test(some_motions_are_their_own_inverse),
        cmocka_unit_test(nasty_motions_are_as_nasty_as_they_say),
        cmocka_unit_test(the_triangles_of_a_swap_are_each_others),
        cmocka_unit_test(texts_are_read_as_they_are_written),
        cmocka_unit_test(refitted_twice_is_refitted_once),
        cmocka_unit_test(there_and_back_is_the_first_refit),
        cmocka_unit_test(a_step_that_does_nothing_can_be_dropped),
        cmocka_unit_test(a_rebuilt_tree_is_that_of_its_scene),
        cmocka_unit_test(a_step_leaves_the_tree_before_it),
        cmocka_unit_test(every_tree_holds_its_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
