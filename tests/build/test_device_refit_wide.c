/* Trees of wide layouts that a device refits have the words of packed_refit, on every driver
 * here. */
#include "gpu/build/device_refit.h"
#include "ref/abi.h"
#include "ref/packed/packed_check.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "ref/trace/trace.h"
#include "scenes/move.h"
#include "tests/support/built.h"
#include "tests/build/device_fixture.h"

/* What is done to the vertices. */
enum refit_motion { STAYS, MOVES, MOVES_FAR, MIRRORED, SHRINKS, FLAT, A_POINT, GROWS, MOTIONS };

static void move(struct scene *scene, enum refit_motion motion)
{
    const float amount[MOTIONS] = {[MOVES] = 0.01f, [MOVES_FAR] = 10};
    scene_move(scene, amount[motion], motion);
    for (size_t c = 0; c < 3 * (size_t)scene->vertex_count; c++) {
        float *x = &scene->vertex[c];
        if (motion == MIRRORED)
            *x = -*x;
        else if (motion == GROWS)
            *x = fabsf(*x) < 0x1p126f ? 4 * *x : *x;
        else if (motion == SHRINKS) /* a frame of the scene holds it still */
            *x = *x * 0.5f + scene->vertex[c % 3] * 0.5f;
        else if (motion == A_POINT || (motion == FLAT && c % 3 == 1))
            *x = scene->vertex[c % 3];
    }
}

/* False if the layout cannot hold the tree. */
static bool packed_of(const struct scene *scene, const struct layout *layout, struct packed *out)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    gpu_must(bvh_build(builder_find("lbvh63"), scene, &options, &bvh, &reason), &reason);
    enum status status = packed_make(layout, &bvh, scene, out, &reason);
    bvh_free(&bvh);
    return status == STATUS_OK;
}

/* Refits to the scene on both sides; returns whether C does. A refusal leaves the words as they
 * were. */
static bool refit_both(struct device_tree *tree, struct packed *packed, const struct scene *scene,
                       const char *what)
{
    uint32_t *word = malloc(sizeof *word * ((size_t)packed->word_count + 1));
    uint64_t ns;
    struct reason reason = {""}, mine = {""};
    assert_non_null(word);
    memset(word, 0xA5, sizeof *word * packed->word_count);
    enum status status = device_refit(tree, packed, scene, word, &ns, &reason);
    enum status expected = packed_refit(packed, scene, &mine);
    if (status != expected)
        fail_msg("%s, %s: '%s', in C '%s'", what, packed->layout->name, reason.text, mine.text);
    for (uint32_t i = 0; i < packed->word_count; i++)
        if (word[i] != (status ? 0xA5A5A5A5u : packed->word[i]))
            fail_msg("%s, %s, %u triangles: word %u of %u, of record %u, is %08x, not %08x", what,
                     packed->layout->name, scene->tri_count, i, packed->word_count,
                     i / (packed->layout->node_bytes / 4), word[i], packed->word[i]);
    if (status)
        assert_non_null(strstr(reason.text, "rebuild: "));
    free(word);
    return status == STATUS_OK;
}

/* Every other motion: odd ones if `odd`. */
static uint32_t check_layout(struct device_tree *tree, const struct layout *layout,
                             const struct bvh *bvh, const struct scene *scene, bool odd,
                             const char *what)
{
    uint32_t refitted = 0;
    for (int motion = odd; motion < MOTIONS; motion += 2) {
        struct packed packed;
        struct reason reason;
        struct scene moved = *scene;
        if (packed_make(layout, bvh, scene, &packed, &reason))
            break;
        moved.vertex = alloc_copy(scene->vertex, 3 * (size_t)scene->vertex_count, sizeof(float));
        assert_non_null(moved.vertex);
        move(&moved, (enum refit_motion)motion);
        refitted += refit_both(tree, &packed, &moved, what);
        free(moved.vertex);
        packed_free(&packed);
    }
    return refitted;
}

static uint32_t check_scene(struct device_tree *tree, struct scene *scene, size_t turn,
                            const char *what)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    uint32_t refitted = 0;
    struct bvh bvh;
    struct reason reason;
    gpu_must(bvh_build(builder_find("lbvh63"), scene, &options, &bvh, &reason), &reason);
    for (size_t l = 0; layouts_all[l]; l++)
        if (layout_is_wide(layouts_all[l]) && device_refits(layouts_all[l]))
            refitted += check_layout(tree, layouts_all[l], &bvh, scene, (l + turn) % 2, what);
    bvh_free(&bvh);
    scene_free(scene);
    return refitted;
}

static void check_driver(struct device_tree *tree)
{
    uint32_t refitted = 0;
    for (size_t i = 0; i < BUILT_SCENES; i++) {
        const char *what;
        struct scene scene = built_scene(i, &what);
        refitted += check_scene(tree, &scene, i, what);
    }
    for (uint32_t n = 0; n < 16; n++) {
        struct scene scene = built_soup(n / 2, n);
        refitted += check_scene(tree, &scene, n, "few");
    }
    print_message("%u refits\n", refitted);
    assert_true(refitted > 5000);
}

static void words_of_wide_layouts_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_driver);
}

/* One vertex at a largest bound of some layout, or just beyond it, on either side. */
static void the_largest_bound_is_held(void **state)
{
    static const uint32_t largest[] = {0x477FE000u /* 65504 */, 0x71800000u /* 2^100 */,
                                       0x7E800000u /* 2^126 */, 0x7F7F0000u, 0x7F7FFFFEu};
    (void)state;
    struct device_tree *tree = device_open(false);
    for (size_t l = 0; layouts_all[l]; l++) {
        uint32_t held = 0;
        if (!layout_is_wide(layouts_all[l]) || !device_refits(layouts_all[l]))
            continue;
        for (uint32_t i = 0; i < 4 * ARRAY_COUNT(largest); i++) {
            struct packed packed;
            struct scene scene = built_soup(40, 5);
            assert_true(packed_of(&scene, layouts_all[l], &packed));
            scene.vertex[i % 7] = float_from_bits((largest[i / 4] + i % 2) | (i / 2 % 2) << 31);
            held += refit_both(tree, &packed, &scene, "largest");
            packed_free(&packed);
            scene_free(&scene);
        }
        const char *name = layouts_all[l]->name;
        if (strcmp(name, "half4") == 0)
            assert_int_equal(held, 2);
        else if (strcmp(name, "hpb64") == 0)
            assert_int_equal(held, 8 + 2);
        else if (strcmp(name, "cwbvh80") == 0 || strcmp(name, "gfx12") == 0 ||
                 strncmp(name, "tiny8", 5) == 0)
            assert_int_equal(held, 4 + 2);
        else if (strstr(name, "_node"))
            assert_int_equal(held, 8 + 2);
    }
    device_close(tree);
}

/* A finite number of a kind: any at all, near the ends of halves, halves and what lies between
 * them, or about 1 with far smaller ones. */
static float number_of(struct rng *rng, uint32_t kind)
{
    const uint32_t sign = rng_below(rng, 2) << 31, fraction = rng_below(rng, 0x800000u);
    const uint32_t exponents[] = {rng_below(rng, 226), 100 + rng_below(rng, 14),
                                  112 + rng_below(rng, 31), rng_below(rng, 2) ? 127 : 1};
    const uint32_t cut = rng_below(rng, 3) ? 0xFFFu << rng_below(rng, 12) : 0;
    const uint32_t magnitude = exponents[kind] << 23 | (fraction & ~cut);
    return rng_below(rng, 16) ? float_from_bits(sign | magnitude) : float_from_bits(sign);
}

static void check_numbers(struct device_tree *tree)
{
    /* Flat triangles: at the ends of a node, and so little inside that a quotient is half of the
     * least float, or between that and the least. */
    static const float flat[] = {0,           4096,      0x1p-138f, 0x1.002p-138f,
                                 0x1.8p-138f, 0x1p-137f, 0x1p-139f};
    struct rng rng = rng_make(5, 7);
    uint32_t refitted = 0;
    for (uint32_t n = 0; n < 100; n++)
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed;
            if (!layout_is_wide(layouts_all[l]) || !device_refits(layouts_all[l]) ||
                layouts_all[l]->constant[1] == ABI_FRAME_SCENE)
                continue;
            struct scene scene = built_soup(3 + n % 40, n);
            assert_true(packed_of(&scene, layouts_all[l], &packed));
            for (size_t c = 0; c < 3 * (size_t)scene.vertex_count; c++)
                scene.vertex[c] = n % 5 < 4 ? number_of(&rng, n % 5)
                                            : flat[(c / 9 + c + n / 5) % ARRAY_COUNT(flat)];
            refitted += refit_both(tree, &packed, &scene, "any numbers");
            packed_free(&packed);
            scene_free(&scene);
        }
    print_message("%u refits\n", refitted);
    assert_true(refitted > 1500);
}

static void words_of_any_numbers_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_numbers);
}

/* --- laws ------------------------------------------------------------------------------------- */

/* A tree with the words that the device made. */
static struct packed refitted(struct device_tree *tree, const struct packed *packed,
                              const struct scene *scene)
{
    struct packed out = *packed;
    uint64_t ns;
    struct reason reason = {""};
    out.word = calloc(packed->word_count, sizeof *out.word);
    assert_non_null(out.word);
    gpu_must(device_refit(tree, packed, scene, out.word, &ns, &reason), &reason);
    return out;
}

static void same_words(const struct packed *a, const struct packed *b, const char *law)
{
    assert_int_equal(a->word_count, b->word_count);
    for (uint32_t i = 0; i < a->word_count; i++)
        if (a->word[i] != b->word[i])
            fail_msg("%s: %s: word %u is %08x, not %08x", a->layout->name, law, i, a->word[i],
                     b->word[i]);
}

/* From outside the scene to the middle of triangles: what brute force finds. */
static void same_answers(const struct packed *packed, const struct scene *scene)
{
    const struct tri_test *tri = tri_test_find("woop");
    const struct job job = {.scene = scene,
                            .packed = packed,
                            .box = box_test_find("watertight"),
                            .tri = tri,
                            .query = QUERY_CLOSEST};
    for (uint32_t i = 0; i < scene->tri_count; i += 5) {
        struct ray ray = {.tmin = 0, .tmax = 4};
        struct hit one, all;
        float v[3][3];
        scene_tri(scene, i, v);
        for (uint32_t k = 0; k < 3; k++) {
            ray.org[k] = k == i % 3 ? -200 : 0;
            ray.dir[k] = v[0][k] / 3 + v[1][k] / 3 + v[2][k] / 3 - ray.org[k];
        }
        trace_brute(scene, tri, QUERY_CLOSEST, &ray, &all);
        assert_int_equal(trace_ray(&job, &ray, &one, NULL), STATUS_OK);
        if (one.prim != all.prim && one.t != all.t)
            fail_msg("%s: ray %u: triangle %u at %g, not %u at %g", packed->layout->name, i,
                     one.prim, (double)one.t, all.prim, (double)all.t);
    }
}

/* What `motion` makes of the words: a tree of the moved scene, with its answers. Where nothing has
 * moved the words stay. Where all is mirrored or four times as large, boxes and areas are so
 * exactly, and the refitted tree, packed anew, has the same nodes. */
static void check_laws(struct device_tree *tree, const struct layout *layout,
                       const struct scene *scene, const struct scene *moved, bool stays,
                       bool similar)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct packed packed, anew;
    struct reason reason = {""};
    gpu_must(bvh_build(builder_find("lbvh63"), scene, &options, &bvh, &reason), &reason);
    gpu_must(packed_make(layout, &bvh, scene, &packed, &reason), &reason);
    struct packed got = refitted(tree, &packed, moved);
    if (!layout->faithful && packed_check(&got, moved, NULL, &reason))
        fail_msg("%s", reason.text);
    if (!layout->faithful) /* else it may lose hits, as published */
        same_answers(&got, moved);
    if (stays)
        same_words(&got, &packed, "what stays");
    /* Of amd64 a node that is four times as large may have the other format. */
    if (similar && layout->constant[1] != ABI_FRAME_SCENE && strcmp(layout->name, "amd64") != 0) {
        gpu_must(bvh_refit(&bvh, moved, &reason), &reason);
        gpu_must(packed_make(layout, &bvh, moved, &anew, &reason), &reason);
        same_words(&got, &anew, "packed anew");
        packed_free(&anew);
    }
    free(got.word);
    packed_free(&packed);
    bvh_free(&bvh);
}

static void laws_of_scene(struct device_tree *tree, struct scene *scene)
{
    static const enum refit_motion motion[] = {STAYS, SHRINKS, MIRRORED, GROWS};
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        const bool framed = strstr(layout->name, "_scene") != NULL;
        if (!layout_is_wide(layout) || !device_refits(layout))
            continue;
        for (size_t m = 0; m < (framed ? 2 : ARRAY_COUNT(motion)); m++) {
            struct scene moved = *scene;
            moved.vertex =
                alloc_copy(scene->vertex, 3 * (size_t)scene->vertex_count, sizeof(float));
            assert_non_null(moved.vertex);
            move(&moved, motion[m]);
            check_laws(tree, layout, scene, &moved, motion[m] == STAYS, m > 1);
            free(moved.vertex);
        }
    }
    scene_free(scene);
}

static void trees_are_sound_and_as_if_packed_anew(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    for (uint32_t n = 1; n <= 400; n = 3 * n + 1) {
        struct scene scene = built_soup(n, 20 + n);
        laws_of_scene(tree, &scene);
    }
    device_close(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_of_wide_layouts_are_those_of_c),
        cmocka_unit_test(words_of_any_numbers_are_those_of_c),
        cmocka_unit_test(the_largest_bound_is_held),
        cmocka_unit_test(trees_are_sound_and_as_if_packed_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
