/* Laws of ref/packed/tree_file.h: a tree that is written comes back as it was, in every layout; one
 * of another scene is refused, however it is stored; one with too small boxes is taken, with a
 * doubt.
 */
#define _POSIX_C_SOURCE 200809L
#include "ref/tree/bvh_json.h"
#include "ref/packed/packed_file.h"
#include "ref/packed/tree_file.h"
#include "scenes/scenes.h"
#include "ref/store.h"
#include "tests/support/counted.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static struct reason reason;

static struct scene open_scene(const char *spec)
{
    struct scene scene;
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static struct bvh build(const struct scene *scene, const char *builder, uint32_t leaf)
{
    const struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    if (builder_find(builder)->build(scene, &options, &bvh, &reason))
        fail_msg("%s", reason.text);
    return bvh;
}

/* A tree's file: JSON, or packed unless `layout` is NULL. NULL if the layout refuses. */
static char *file_of(const struct scene *scene, const struct bvh *bvh, const struct layout *layout,
                     size_t *size)
{
    char *bytes = NULL;
    struct packed packed = {0};
    if (layout && packed_make(layout, bvh, scene, &packed, &reason))
        return NULL;
    FILE *stream = open_memstream(&bytes, size);
    assert_non_null(stream);
    if (layout)
        packed_file_write(&packed, stream);
    else
        bvh_json_write(bvh, stream);
    assert_int_equal(fclose(stream), 0);
    packed_free(&packed);
    return bytes;
}

static void assert_same_packed(const struct packed *a, const struct packed *b)
{
    assert_ptr_equal(a->layout, b->layout);
    assert_int_equal(a->word_count, b->word_count);
    assert_int_equal(a->item_count, b->item_count);
    assert_int_equal(a->root, b->root);
    assert_int_equal(a->tri_count, b->tri_count);
    assert_int_equal(a->stack_need, b->stack_need);
    assert_memory_equal(a->word, b->word, 4 * (size_t)a->word_count);
    if (a->item_count)
        assert_memory_equal(a->item, b->item, 4 * (size_t)a->item_count);
}

static void json_packs_as_the_builders_tree(void **state)
{
    (void)state;
    static const char *const names[] = {"median", "rtrs"};
    struct scene scene = open_scene("soup:n=300");
    for (size_t b = 0; b < ARRAY_COUNT(names); b++) {
        struct bvh bvh = build(&scene, names[b], 4), copy;
        struct tree_file file;
        size_t size;
        char *bytes = file_of(&scene, &bvh, NULL, &size);
        assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
        free(bytes);
        assert_false(tree_file_is_packed(&file));
        struct bvh_stats stats = bvh_counted(&bvh, &scene);
        assert_memory_equal(&file.stats, &stats, sizeof stats);
        size_t compared = 0;
        for (size_t l = 0; layouts[l]; l++) {
            struct packed own, theirs;
            struct reason why;
            enum status status = packed_make(layouts[l], &bvh, &scene, &own, &reason);
            assert_int_equal(tree_file_pack(&file, layouts[l], &scene, &theirs, &why), status);
            if (!status)
                assert_same_packed(&own, &theirs);
            else
                assert_string_equal(why.text, reason.text);
            compared += !status;
            packed_free(&own);
            packed_free(&theirs);
        }
        assert_true(compared >= 2);
        assert_int_equal(tree_file_bvh(&file, &scene, &copy, &reason), STATUS_OK);
        tree_file_free(&file); /* the copy is its own */
        assert_int_equal(copy.node_count, bvh.node_count);
        assert_memory_equal(copy.node, bvh.node, bvh.node_count * sizeof *bvh.node);
        assert_memory_equal(copy.prim, bvh.prim, bvh.prim_count * sizeof *bvh.prim);
        bvh_free(&copy);
        bvh_free(&bvh);
    }
    scene_free(&scene);
}

/* A packed file of a layout of ours decodes to the builder's tree, but for boxes rounded outward,
 * from which the same words are packed again. */
static void assert_decodes(const struct tree_file *file, const struct scene *scene,
                           const struct bvh *built)
{
    struct bvh bvh;
    struct packed again;
    struct reason why;
    if (tree_file_bvh(file, scene, &bvh, &why))
        fail_msg("%s", why.text);
    assert_int_equal(bvh.node_count, built->node_count);
    assert_memory_equal(bvh.prim, built->prim, 4 * (size_t)bvh.prim_count);
    for (uint32_t i = 0; i < bvh.node_count; i++) {
        const struct bvh_node *node = &bvh.node[i], *own = &built->node[i];
        assert_int_equal(node->fst, own->fst);
        assert_int_equal(node->snd, own->snd);
        assert_int_equal(node->item_first, own->item_first);
        assert_int_equal(node->item_count, own->item_count);
        for (int k = 0; k < 3; k++) {
            assert_true(node->bounds.lo[k] <= own->bounds.lo[k]);
            assert_true(node->bounds.hi[k] >= own->bounds.hi[k]);
        }
    }
    assert_int_equal(packed_make(file->packed.layout, &bvh, scene, &again, &why), STATUS_OK);
    assert_same_packed(&file->packed, &again);
    packed_free(&again);
    bvh_free(&bvh);
}

/* Every packed file that precompute can write of these scenes, RTRS's layouts included, which
 * name other triangles and lose some: that must not be taken for another scene. */
static void packed_fixes_the_layout(void **state)
{
    (void)state;
    static const char *const specs[] = {
        "soup:n=300", "terrain:k=4", "platonic", "needles:n=100",   "grid:n=9",         "stack",
        "soup:n=1",   "sphere:n=6",  "cornell",  "soup:offset=500", "needles:offset=99"};
    static const char *const names[] = {"median", "rtrs"};
    size_t taken[16] = {0};
    for (size_t i = 0; i < ARRAY_COUNT(specs) * ARRAY_COUNT(names); i++) {
        struct scene scene = open_scene(specs[i / 2]);
        struct bvh bvh = build(&scene, names[i % 2], 4);
        struct bvh_stats stats = bvh_counted(&bvh, &scene);
        for (size_t l = 0; layouts[l]; l++) {
            struct tree_file file;
            struct packed copy;
            size_t size;
            char *bytes = file_of(&scene, &bvh, layouts[l], &size);
            if (!bytes)
                continue;
            enum status status = tree_file_read("t", bytes, size, &scene, &file, &reason);
            if (status && strstr(reason.text, "another scene"))
                fail_msg("%s, %s, %s: %s", specs[i / 2], names[i % 2], layouts[l]->name,
                         reason.text);
            if (status && !layouts[l]->faithful)
                fail_msg("%s", reason.text);
            if (!status) {
                taken[l]++;
                assert_true(tree_file_is_packed(&file));
                if (!layouts[l]->faithful)
                    assert_decodes(&file, &scene, &bvh);
                assert_int_equal(tree_file_pack(&file, layouts[l], &scene, &copy, &reason),
                                 STATUS_OK);
                assert_same_packed(&file.packed, &copy);
                assert_ptr_not_equal(file.packed.word, copy.word);
                packed_free(&copy);
                const struct layout *other = layouts[l == 0];
                assert_int_equal(tree_file_pack(&file, other, &scene, &copy, &reason),
                                 STATUS_INPUT);
                assert_non_null(strstr(reason.text, layouts[l]->name));
                assert_non_null(strstr(reason.text, other->name));
                assert_null(copy.word);
                if (!layouts[l]->faithful) {
                    assert_int_equal(file.stats.node_count, stats.node_count);
                    assert_int_equal(file.stats.leaf_count, stats.leaf_count);
                    assert_int_equal(file.stats.depth, stats.depth);
                    assert_int_equal(file.stats.largest_leaf, stats.largest_leaf);
                }
            }
            tree_file_free(&file);
            free(bytes);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
    for (size_t l = 0; layouts[l]; l++)
        if (taken[l] < 10)
            fail_msg("%s: only %zu files were taken", layouts[l]->name, taken[l]);
}

/* `spec`'s tree for another scene of as many triangles. `apart`: in another place; only then can
 * it be told of RTRS's layouts, whose leaves name other triangles than their boxes hold. */
static void expect_foreign(const char *spec, const char *other_spec, bool apart)
{
    struct scene scene = open_scene(spec), other = open_scene(other_spec);
    struct bvh bvh = build(&scene, "median", 4);
    assert_int_equal(scene.tri_count, other.tri_count);
    for (size_t l = 0; l == 0 || layouts[l - 1]; l++) {
        struct tree_file file;
        size_t size;
        const struct layout *layout = l ? layouts[l - 1] : NULL;
        char *bytes =
            layout && layout->faithful && !apart ? NULL : file_of(&scene, &bvh, layout, &size);
        if (!bytes)
            continue;
        enum status status = tree_file_read("t", bytes, size, &other, &file, &reason);
        if (status != STATUS_INPUT)
            fail_msg("%s for %s, %s: taken", spec, other_spec, layout ? layout->name : "JSON");
        char counted[64];
        snprintf(counted, sizeof counted, " of %u triangles have", other.tri_count);
        assert_non_null(strstr(reason.text, "t: is the tree of another scene"));
        assert_non_null(strstr(reason.text, counted)); /* each once */
        assert_null(file.bvh.node);
        assert_null(file.packed.word);
        free(bytes);
    }
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&other);
}

static void a_tree_of_another_scene_is_refused(void **state)
{
    (void)state;
    expect_foreign("soup:n=300,seed=1", "soup:n=300,seed=2", false);
    expect_foreign("soup:n=300,offset=0", "soup:n=300,offset=4", true);
    expect_foreign("needles:n=100,seed=1", "needles:n=100,seed=2", false);
    /* Another number of triangles is told apart at once. */
    struct scene scene = open_scene("soup:n=300"), other = open_scene("soup:n=299");
    struct bvh bvh = build(&scene, "median", 4);
    struct tree_file file;
    size_t size;
    char *bytes = file_of(&scene, &bvh, NULL, &size);
    assert_int_equal(tree_file_read("t", bytes, size, &other, &file, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "t: the tree holds 300 triangles, the scene has 299"));
    free(bytes);
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&other);
}

/* RTRS's cut boxes, and one box pulled in by hand: taken, traced as they are, and said. */
static void too_small_boxes_are_doubted(void **state)
{
    (void)state;
    struct scene scene = open_scene("soup:n=300");
    struct bvh bvh = build(&scene, "median", 4);
    for (int small = 0; small < 2; small++) {
        if (small)
            bvh.node[0].bounds.hi[1] -= 0.25f;
        for (size_t l = 0; l < 3; l++) { /* JSON and two layouts */
            struct tree_file file;
            size_t size;
            char *bytes = file_of(&scene, &bvh, l ? layouts[l - 1] : NULL, &size);
            assert_non_null(bytes);
            assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
            bool said = file.doubt.text[0] != '\0';
            if (said != (small == 1))
                fail_msg("%d %zu: '%s'", small, l, file.doubt.text);
            if (small)
                assert_non_null(strstr(file.doubt.text, "too small"));
            tree_file_free(&file);
            free(bytes);
        }
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

static void the_seeds_tree_is_taken(void **state)
{
    (void)state;
    struct scene scene = open_scene("rtrs");
    struct tree_file file;
    struct bvh bvh = build(&scene, "rtrs", 2);
    size_t size;
    char *bytes = file_of(&scene, &bvh, NULL, &size);
    assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
    assert_non_null(strstr(file.doubt.text, "t: 2 of 51 boxes are too small"));
    tree_file_free(&file);
    free(bytes);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* What the readers refuse is refused here with their reason. */
static void damage_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *rule;
    } bad[] = {
        {"{", "t: line 1"},
        {"RDPK", "t: does not begin as a packed tree does"},
        {"{\"uniforms\":[],\"indices\":[]}", "t: the tree holds 0 triangles, the scene has 1"},
        {"{\"uniforms\":[{\"fst\":0,\"snd\":0,\"item_idx\":0,\"item_count\":0,\"bounds\":{\"min\":"
         "[0,0,0],\"max\":[1,1,1]}}],\"indices\":[0]}",
         "t: tree node 0: first child is 0"},
    };
    struct scene scene = open_scene("soup:n=1");
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct tree_file file;
        assert_int_equal(
            tree_file_read("t", bad[i].text, strlen(bad[i].text), &scene, &file, &reason),
            STATUS_INPUT);
        if (strncmp(reason.text, bad[i].rule, strlen(bad[i].rule)) != 0)
            fail_msg("'%s' does not begin with '%s'", reason.text, bad[i].rule);
    }
    /* No record at all is a packed tree that misses everything. */
    for (size_t l = 0; layouts[l]; l++) {
        const struct packed none = {.layout = layouts[l], .store = tri_stores[0], .tri_count = 1};
        struct tree_file file;
        size_t size;
        char *bytes = NULL;
        FILE *stream = open_memstream(&bytes, &size);
        assert_non_null(stream);
        packed_file_write(&none, stream);
        assert_int_equal(fclose(stream), 0);
        assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
        assert_non_null(strstr(file.doubt.text, "1 triangles in no leaf"));
        tree_file_free(&file);
        free(bytes);
    }
    struct bvh bvh;
    assert_int_equal(tree_file_builder.build(&scene, NULL, &bvh, &reason), STATUS_INTERNAL);
    scene_free(&scene);
}

/* A safe packed tree need not be one that a builder could have made. */
static void what_decodes_to_no_tree_is_refused(void **state)
{
    (void)state;
    struct scene scene = open_scene("soup:n=30");
    struct bvh bvh = build(&scene, "median", 4), back;
    const struct layout *f32 = layout_find("f32"), *rf = layout_find("rtrs_rf");
    struct tree_file file;
    size_t size;
    char *bytes = file_of(&scene, &bvh, rf, &size);
    assert_non_null(bytes);
    assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
    assert_int_equal(tree_file_bvh(&file, &scene, &back, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "t: cannot be decoded to a tree"));
    assert_null(back.node);
    tree_file_free(&file);
    free(bytes);
    /* One item twice, in place of another. */
    bytes = file_of(&scene, &bvh, f32, &size);
    assert_non_null(bytes);
    memcpy(bytes + size - 4, bytes + size - 8, 4);
    assert_int_equal(tree_file_read("t", bytes, size, &scene, &file, &reason), STATUS_OK);
    assert_non_null(strstr(file.doubt.text, "1 triangles in no leaf, 1 in several"));
    assert_int_equal(tree_file_bvh(&file, &scene, &back, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "is there twice"));
    tree_file_free(&file);
    free(bytes);
    /* The root's children in the other order: legal for a traversal, but not pre-order. */
    struct packed swapped;
    assert_int_equal(packed_make(f32, &bvh, &scene, &swapped, &reason), STATUS_OK);
    struct bvh_node *root = &bvh.node[0];
    assert_true(root->item_count == 0 && root->snd > 2);
    uint32_t words = f32->node_bytes / 4, found = 0;
    for (uint32_t w = 0; w < words; w++)
        if (swapped.word[w] == root->snd && !found++)
            swapped.word[w] = root->snd - 1;
    assert_int_equal(found, 1);
    struct tree_file whole = {.name = "t", .packed = swapped};
    assert_int_equal(tree_file_bvh(&whole, &scene, &back, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "not in pre-order"));
    packed_free(&swapped);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_packs_as_the_builders_tree),
        cmocka_unit_test(packed_fixes_the_layout),
        cmocka_unit_test(a_tree_of_another_scene_is_refused),
        cmocka_unit_test(too_small_boxes_are_doubted),
        cmocka_unit_test(the_seeds_tree_is_taken),
        cmocka_unit_test(damage_is_refused),
        cmocka_unit_test(what_decodes_to_no_tree_is_refused),
    };
    return cmocka_run_group_tests_name("tree_file", tests, NULL, NULL);
}
