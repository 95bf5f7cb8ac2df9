/* Trees of wide layouts that a device refits have the words of packed_refit, on every driver
 * here. */
#include "gpu/build/device_refit.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "scenes/move.h"
#include "tests/support/built.h"
#include "tests/build/device_fixture.h"

/* What is done to the vertices. */
enum refit_motion { STAYS, MOVES, MOVES_FAR, MIRRORED, SHRINKS, FLAT, A_POINT, MOTIONS };

static void move(struct scene *scene, enum refit_motion motion)
{
    const float amount[MOTIONS] = {[MOVES] = 0.01f, [MOVES_FAR] = 10};
    scene_move(scene, amount[motion], motion);
    for (size_t c = 0; c < 3 * (size_t)scene->vertex_count; c++) {
        float *x = &scene->vertex[c];
        if (motion == MIRRORED)
            *x = -*x;
        else if (motion == SHRINKS) /* a frame of the scene holds it still */
            *x = *x * 0.5f + scene->vertex[c % 3] * 0.5f;
        else if (motion == A_POINT || (motion == FLAT && c % 3 == 1))
            *x = scene->vertex[c % 3];
    }
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

static uint32_t check_layout(struct device_tree *tree, const struct layout *layout,
                             const struct bvh *bvh, const struct scene *scene, const char *what)
{
    uint32_t refitted = 0;
    for (int motion = 0; motion < MOTIONS; motion++) {
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

static uint32_t check_scene(struct device_tree *tree, struct scene *scene, const char *what)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    uint32_t refitted = 0;
    struct bvh bvh;
    struct reason reason;
    gpu_must(bvh_build(builder_find("lbvh63"), scene, &options, &bvh, &reason), &reason);
    for (size_t l = 0; layouts_all[l]; l++)
        if (layout_is_wide(layouts_all[l]) && device_refits(layouts_all[l]))
            refitted += check_layout(tree, layouts_all[l], &bvh, scene, what);
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
        refitted += check_scene(tree, &scene, what);
    }
    for (uint32_t n = 0; n < 12; n++) {
        struct scene scene = built_soup(n, n);
        refitted += check_scene(tree, &scene, "few");
    }
    print_message("%u refits\n", refitted);
    assert_true(refitted > 5000);
}

static void words_of_wide_layouts_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_driver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_of_wide_layouts_are_those_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
