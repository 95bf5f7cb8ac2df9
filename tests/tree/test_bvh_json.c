/* Laws of ref/tree/bvh_json.h. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/tree/bvh_json.h"
#include "ref/base/rng.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

/* The file's text; the caller frees it. */
static char *text_of(const struct bvh *bvh)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    bvh_json_write(bvh, stream);
    assert_int_equal(fclose(stream), 0);
    return text;
}

static enum status read_text(const char *text, const struct scene *scene, struct bvh *out,
                             struct reason *reason)
{
    reason->text[0] = 0;
    return bvh_json_read("t.json", text, strlen(text), scene, out, reason);
}

/* Three triangles, leaf 2: fst of the root holds {0, 1}, snd {2}. */
static const char golden[] =
    "{\"uniforms\":["
    "{\"fst\":1,\"snd\":2,\"item_idx\":0,\"item_count\":0,"
    "\"bounds\":{\"min\":[0.0,0.0,-1e-7],\"max\":[16777216.0,0.125,6.6320736e-9]}},"
    "{\"fst\":0,\"snd\":0,\"item_idx\":0,\"item_count\":2,"
    "\"bounds\":{\"min\":[0.0,-0.0,0.000001],\"max\":[0.375,0.1,3.4028235e38]}},"
    "{\"fst\":0,\"snd\":0,\"item_idx\":2,\"item_count\":1,"
    "\"bounds\":{\"min\":[0.5,1e-45,9999999000000.0],\"max\":[0.625,0.0001,1e13]}}"
    "],\"indices\":[0,1,2]}";

static struct bvh golden_tree(const struct scene *scene)
{
    struct bvh bvh = trees_make(scene, 2, TREES_BALANCED);
    bvh.node[0].bounds = (struct box){{0, 0, -1e-7f}, {16777216, 0.125f, 6.6320736e-9f}};
    bvh.node[1].bounds = (struct box){{0, -0.0f, 1e-6f}, {0.375f, 0.1f, 3.4028235e38f}};
    bvh.node[2].bounds = (struct box){{0.5f, 1e-45f, 9.999999e12f}, {0.625f, 1e-4f, 1e13f}};
    return bvh;
}

static void bvh_json_writes_what_the_seed_writes(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    struct bvh bvh = golden_tree(&scene);
    char *text = text_of(&bvh);
    assert_string_equal(text, golden);
    free(text);
    bvh.node[0].bounds.lo[0] = NAN;
    bvh.node[0].bounds.hi[2] = INFINITY;
    text = text_of(&bvh);
    assert_non_null(strstr(text, "\"min\":[null,0.0,-1e-7],\"max\":[16777216.0,0.125,null]"));
    free(text);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void bvh_json_writes_an_empty_tree(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh = {0};
    struct reason reason;
    char *text = text_of(&bvh);
    assert_string_equal(text, "{\"uniforms\":[],\"indices\":[]}");
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    assert_int_equal(read_text(text, &scene, &bvh, &reason), STATUS_OK);
    assert_int_equal(bvh.node_count, 0);
    bvh_free(&bvh);
    scene_free(&scene);
    free(text);
}

static void assert_same_tree(const struct bvh *a, const struct bvh *b)
{
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->prim_count, b->prim_count);
    assert_memory_equal(a->node, b->node, a->node_count * sizeof *a->node);
    assert_memory_equal(a->prim, b->prim, a->prim_count * sizeof *a->prim);
}

static void bvh_json_reads_back_the_same_bits(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 0);
    struct scene scene = trees_grid(20000);
    struct bvh bvh = trees_make(&scene, 3, TREES_BALANCED), back;
    for (uint32_t i = 0; i < bvh.node_count; i++)
        for (int k = 0; k < 3; k++) {
            float x = float_from_bits((uint32_t)rng_u64(&rng));
            bvh.node[i].bounds.lo[k] = float_is_finite(x) ? x : -0.0f;
        }
    char *text = text_of(&bvh);
    struct reason reason;
    if (read_text(text, &scene, &back, &reason))
        fail_msg("%s", reason.text);
    assert_same_tree(&bvh, &back);
    char *again = text_of(&back);
    assert_string_equal(text, again);
    free(text);
    free(again);
    bvh_free(&back);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void bvh_json_reads_any_order_and_white_space(void **state)
{
    (void)state;
    struct scene scene = trees_grid(1);
    struct bvh bvh;
    struct reason reason;
    static const char text[] =
        "\t{ \"indices\" : [ 0 ] ,\r\n \"made_by\": \"hand\", \"uniforms\": [ {\n"
        "\"bounds\": {\"max\": [1, 2, 3], \"min\": [-1, -2, -3e0]}, \"note\": null,\n"
        "\"item_count\": 1, \"item_idx\": 0, \"snd\": 0, \"fst\": 0 } ] }\n";
    if (read_text(text, &scene, &bvh, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(bvh.node_count, 1);
    assert_true(bvh.node[0].bounds.hi[2] == 3 && bvh.node[0].bounds.lo[2] == -3);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* `find` in the golden text, replaced by `put`, and what the reason must say. */
static const struct {
    const char *find, *put, *reason;
} spoilt[] = {
    {"]}", "]", "t.json: line 1, column "},
    {"{\"uniforms\":", "[{\"uniforms\":", "t.json: line 1, column"},
    {"\"uniforms\"", "\"uniform\"", "t.json: uniforms: must be an array"},
    {"\"indices\":[0,1,2]", "\"indices\":3", "t.json: indices: must be an array"},
    {"\"fst\":1", "\"fst\":-1", "t.json: uniforms[0].fst: must be a whole number"},
    {"\"fst\":1", "\"fst\":1.0", "t.json: uniforms[0].fst: must be a whole number"},
    {"\"fst\":1", "\"fst\":4294967297", "t.json: uniforms[0].fst: must be a whole number"},
    {"\"fst\":1", "\"first\":1", "t.json: uniforms[0].fst: must be a whole number"},
    {"\"fst\":1", "\"fst\":1,\"fst\":1", "t.json: line 1, column"},
    {"[0.0,0.0,-1e-7]", "[0.0,0.0]", "uniforms[0].min: must be an array of exactly 3"},
    {"[0.0,0.0,-1e-7]", "[0.0,0.0,null]", "uniforms[0].min: must hold numbers only"},
    {"16777216.0", "3.4028236e38", "uniforms[0].max: is beyond the range"},
    {"16777216.0", "1e999", "t.json: line 1, column"},
    {"\"bounds\":{\"min\":[0.0,-", "\"box\":{\"min\":[0.0,-", "uniforms[1].min: must be an array"},
    {"[0,1,2]", "[0,1,\"2\"]", "t.json: indices[2]: must be a whole number"},
    {"[0,1,2]", "[0,1,1]", "t.json: tree item 2: triangle 1 is there twice"},
    {"[0,1,2]", "[0,1,3]", "t.json: tree item 2: triangle 3, but the scene has 3"},
    {"[0,1,2]", "[0,1,2,3]", "t.json: the tree holds 4 triangles, the scene has 3"},
    {"\"snd\":2", "\"snd\":0", "t.json: tree node 0: second child is 0"},
    {"\"snd\":2", "\"snd\":3", "t.json: tree node 0: second child is 3"},
    {"\"uniforms\":[", "\"uniforms\":[7,", "t.json: uniforms[0]: must be an object"},
};

static void bvh_json_refuses_what_is_no_tree_of_the_scene(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    struct reason reason;
    for (size_t i = 0; i < ARRAY_COUNT(spoilt); i++) {
        char text[2000];
        const char *at = strstr(golden, spoilt[i].find);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - golden), golden, spoilt[i].put,
                 at + strlen(spoilt[i].find));
        struct bvh bvh = {.node_count = 1};
        enum status status = read_text(text, &scene, &bvh, &reason);
        if (status != STATUS_INPUT || !strstr(reason.text, spoilt[i].reason))
            fail_msg("case %zu: status %d, '%s' does not say '%s'", i, status, reason.text,
                     spoilt[i].reason);
        assert_null(bvh.node);
        assert_int_equal(bvh.node_count, 0);
    }
    scene_free(&scene);
}

static void bvh_json_refuses_every_beginning_of_a_file(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    struct reason reason;
    struct bvh bvh;
    for (size_t size = 0; size < strlen(golden); size++)
        assert_int_equal(bvh_json_read("t.json", golden, size, &scene, &bvh, &reason),
                         STATUS_INPUT);
    assert_int_equal(read_text("{\"uniforms\":[\x01\x7F", &scene, &bvh, &reason), STATUS_INPUT);
    for (const char *c = reason.text; *c; c++)
        assert_true((unsigned char)*c >= 0x20 && *c != 0x7F);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bvh_json_writes_what_the_seed_writes),
        cmocka_unit_test(bvh_json_writes_an_empty_tree),
        cmocka_unit_test(bvh_json_reads_back_the_same_bits),
        cmocka_unit_test(bvh_json_reads_any_order_and_white_space),
        cmocka_unit_test(bvh_json_refuses_what_is_no_tree_of_the_scene),
        cmocka_unit_test(bvh_json_refuses_every_beginning_of_a_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
