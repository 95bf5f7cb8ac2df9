/* World JSON: what is read, to the bit, what is refused, and that what is written is read. */
#define _GNU_SOURCE /* open_memstream */
#include "ref/base/rng.h"
#include "tests/worlds/files_fixture.h"

static enum status read_json(const char *bytes, size_t size, struct world *out)
{
    return read_world("w.json", bytes, size, &fixture_files, out, &reason);
}

static enum status read_text(const char *text, struct world *out)
{
    return read_copy(read_json, text, strlen(text), "w.json", out);
}

static const char sample[] =
    "{\"raydiff_world\": 1,\n"
    " \"meshes\": [\n"
    "  {\"vertices\": [0, 0, 0, 1, -0.0, 1e-45, 3.4028235e38, 0.1, 16777217],\n"
    "   \"indices\": [0, 1, 2, 2, 1, 0, 1, 1, 1],\n"
    "   \"geometries\": [{\"count\": 1}, {\"count\": 0, \"opaque\": true},\n"
    "                  {\"count\": 2, \"opaque\": false}]},\n"
    "  {\"scene\": \"a.obj\"}],\n"
    " \"instances\": [\n"
    "  {\"mesh\": 0, \"transform\": [1, 2, 3, 4, 5, 6.5, 7, 8, 9, 10, -11, 12],\n"
    "   \"custom\": 16777215, \"mask\": 1, \"flags\": [\"flip_facing\", \"force_opaque\"]},\n"
    "  {\"mesh\": null}, {\"mesh\": 1}],\n"
    " \"filter\": {\"kind\": \"cells\", \"seed\": 4294967295, \"share\": 256}}\n";

static void every_member_of_a_world_is_read(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_text(sample, &world), STATUS_OK);
    static const float vertex[] = {0, 0, 0, 1, -0.0f, 0x1p-149f, 0x1.fffffep127f, 0.1f, 0x1p24f};
    static const uint32_t index[] = {0, 1, 2, 2, 1, 0, 1, 1, 1};
    static const float m[12] = {1, 2, 3, 4, 5, 6.5f, 7, 8, 9, 10, -11, 12};
    assert_int_equal(world.mesh_count, 2);
    assert_int_equal(world.instance_count, 3);
    assert_memory_equal(world.mesh[0].scene->vertex, vertex, sizeof vertex);
    assert_memory_equal(world.mesh[0].scene->index, index, sizeof index);
    const struct geometry *geometry = world.mesh[0].geometry;
    assert_int_equal(world.mesh[0].geometry_count, 3);
    assert_true(geometry[0].opaque && geometry[1].opaque && !geometry[2].opaque);
    assert_true(geometry[0].count == 1 && geometry[1].count == 0 && geometry[2].count == 2);
    assert_true(geometry[0].first == 0 && geometry[1].first == 1 && geometry[2].first == 1);
    assert_int_equal(world.mesh[1].scene->tri_count, 1);
    assert_int_equal(world.mesh[1].geometry_count, 1);
    assert_true(world.mesh[1].geometry[0].opaque);
    const struct instance *instance = world.instance;
    assert_memory_equal(instance[0].m, m, sizeof m);
    assert_int_equal(instance[0].custom, 0xFFFFFF);
    assert_int_equal(instance[0].mask, 1);
    assert_int_equal(instance[0].flags, ABI_INSTANCE_FLIP_FACING | ABI_INSTANCE_FORCE_OPAQUE);
    assert_int_equal(instance[1].mesh, WORLD_NO_MESH);
    assert_true(instance_is_identity(&instance[1]));
    assert_int_equal(instance[2].mask, 0xFF);
    assert_int_equal(instance[2].custom, 0);
    assert_int_equal(instance[2].flags, 0);
    assert_int_equal(world.filter.kind, FILTER_CELLS);
    assert_true(world.filter.seed == UINT32_MAX && world.filter.share == 256);
    assert_int_equal(world_tri_count(&world), 4);
    world_free(&world);
}

/* A text that rounds to a double halfway between two floats, and then to the wrong one. */
static void a_float_is_the_nearest_to_its_decimal(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t bits;
    } number[] = {{"1.00000005960464477539062500000001", 0x3F800001u},
                  {"1.00000017881393432617187499999999", 0x3F800001u},
                  {"1.00000005960464477539062499999999", 0x3F800000u},
                  {"-0", 0x80000000u},
                  {"0e7", 0x00000000u},
                  {"1.4e-45", 0x00000001u},
                  {"7.006492321624086e-46", 0x00000001u},
                  {"7.006492321624085e-46", 0x00000000u},
                  {"340282356779733661637539395458142568447.9", 0x7F7FFFFFu}};
    for (size_t i = 0; i < ARRAY_COUNT(number); i++) {
        char *text = changed(sample, "0.1", number[i].text);
        struct world world;
        assert_int_equal(read_text(text, &world), STATUS_OK);
        assert_int_equal(float_bits(world.mesh[0].scene->vertex[7]), number[i].bits);
        world_free(&world);
        free(text);
    }
}

static void members_come_in_any_order_and_may_be_empty(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_text("{\"instances\":[],\"meshes\":[],\"raydiff_world\":1}", &world),
                     STATUS_OK);
    assert_int_equal(world.mesh_count + world.instance_count + world_tri_count(&world), 0);
    world_free(&world);
    assert_int_equal(read_text("{\"instances\":[{\"mask\":0,\"mesh\":0}],\"meshes\":[{\"indices\":"
                               "[],\"vertices\":[]}],\"raydiff_world\":1.0}",
                               &world),
                     STATUS_OK);
    assert_int_equal(world.mesh[0].geometry_count, 1);
    assert_int_equal(world.mesh[0].geometry[0].count, 0);
    world_free(&world);
}

static void expect_refused(const char *old, const char *new, const char *rule)
{
    char *text = changed(sample, old, new);
    struct world world;
    expect_rule(read_text(text, &world), rule);
    free(text);
}

static void a_wrong_world_is_refused_with_place_and_rule(void **state)
{
    (void)state;
    expect_refused("_world\": 1", "_world\": 2", "w.json: raydiff_world: is 2; this version");
    expect_refused("_world\": 1", "_world\": \"1\"", "raydiff_world: must be a number");
    expect_refused("\"filter\"", "\"fliter\"", "w.json: 'fliter' is no member of it");
    expect_refused("\"custom\"", "\"costum\"", "instances[0]: 'costum' is no member of it");
    expect_refused("\"filter\"", "\"instances\"", "instances: is there twice");
    expect_refused("\"meshes\": [", "\"meshes\": [7, ", "meshes[0]: must be an object");
    expect_refused("[0, 0, 0, 1,", "{}, \"x\": [1,", "meshes[0].vertices: must be an array");
    expect_refused("[0, 0, 0, 1,", "[0, 0, 1,", "meshes[0].vertices: has 8 numbers, which is no");
    expect_refused("[0, 0, 0, 1,", "[0, 0, \"0\", 1,", "meshes[0].vertices[2]: must be a number");
    expect_refused("[0, 0, 0, 1,", "[0, null, 0, 1,",
                   "meshes[0].vertices[1]: must be a number; null (NaN, infinity) is none");
    expect_refused("3.4028235e38", "3.4028236e38",
                   "meshes[0].vertices[6]: is beyond the range of a 32-bit float");
    expect_refused("3.4028235e38", "-1e999", "meshes[0].vertices[6]: is beyond the range");
    expect_refused("[0, 1, 2, 2", "[0, 1, 3, 2", "meshes[0].indices[2]: names a vertex that does");
    expect_refused("[0, 1, 2, 2", "[0, 1, 2.5, 2", "meshes[0].indices[2]: must be a whole number");
    expect_refused("[0, 1, 2, 2", "[0, -1, 2, 2", "meshes[0].indices[1]: must be a whole number");
    expect_refused("[0, 1, 2, 2", "[0, 1, 2, 2, 2", "meshes[0].indices: has 10 numbers");
    expect_refused("\"count\": 2", "\"count\": 3", "meshes[0].geometries: have 4 triangles, but");
    expect_refused("\"count\": 2", "\"count\": 4294967295",
                   "meshes[0].geometries: have 4294967296");
    expect_refused("{\"count\": 1}", "{}", "meshes[0].geometries[0].count: is missing");
    expect_refused("\"opaque\": true", "\"opaque\": 1", "geometries[1].opaque: must be true or");
    expect_refused("\"a.obj\"}", "\"a.obj\", \"geometries\": []}",
                   "meshes[1].geometries: at least one geometry is needed");
    expect_refused("{\"scene\": \"a.obj\"}", "{}", "meshes[1]: needs a \"scene\", or \"vertices\"");
    expect_refused("\"a.obj\"}", "\"a.obj\", \"indices\": []}", "meshes[1]: has a \"scene\", and");
    expect_refused("a.obj", "nothing", "w.json: meshes[1].scene: nothing: No such file");
    expect_refused("\"a.obj\"", "null", "meshes[1].scene: must be a text");
    expect_refused("{\"mesh\": 1}", "{\"mesh\": 2}", "w.json: instance 2: mesh 2, but the world");
    expect_refused("{\"mesh\": 1}", "{}", "instances[2].mesh: is missing");
    expect_refused("{\"mesh\": 1}", "{\"mesh\": -1}", "instances[2].mesh: must be a whole number");
    expect_refused("-11, 12]", "-11]", "instances[0].transform: must be 12 numbers, row by row");
    expect_refused("-11, 12]", "-11, 12, 13]", "transform[12]: is one more than 12 numbers");
    expect_refused("-11, 12]", "-11, 1e39]", "instances[0].transform[11]: is beyond the range");
    expect_refused("5, 6.5, 7", "2, 4, 6", "instance 0: its transform is singular");
    expect_refused("16777215", "16777216", "custom: must be a whole number from 0 to 16777215");
    expect_refused("\"mask\": 1", "\"mask\": 256", "instances[0].mask: must be a whole number");
    expect_refused("flip_facing", "flip", "instances[0].flags[0]: 'flip' is none of cull_disable,");
    expect_refused("flip_facing", "force_opaque", "flags[1]: 'force_opaque' is there twice");
    expect_refused("flip_facing", "force_no_opaque", "instance 0: it is forced to be opaque and");
    expect_refused("cells", "cell", "filter.kind: 'cell' is none of all, none, triangles, cells");
    expect_refused("\"share\": 256", "\"share\": 257", "filter.share: must be a whole number from");
    expect_refused("4294967295", "4294967296", "filter.seed: must be a whole number from 0 to");
}

static void what_is_no_json_is_refused_with_its_line(void **state)
{
    (void)state;
    struct world world;
    expect_refused("{\"raydiff", "[\"raydiff", "w.json: must be an object");
    expect_refused("[0, 1, 2, 2", "[00, 1, 2, 2", "w.json:4:");
    expect_refused("[0, 1, 2, 2", "[1., 1, 2, 2", "w.json:4:");
    expect_refused("[0, 1, 2, 2", "[+1, 1, 2, 2", "meshes[0].indices[0]: must be a number");
    expect_refused("[0, 1, 2, 2", "[0x1, 1, 2, 2", "w.json:4:");
    expect_refused("[0, 1, 2, 2", "[0, 1 2, 2", "w.json:4:21: ',' or ']' must stand here");
    expect_refused("256}}", "256}} 1", "w.json:12:");
    expect_rule(read_text("{\"raydiff_world\": 1", &world), "the text is cut short");
    /* Every beginning of the text is refused, in one line. */
    for (size_t size = 0; size + 2 < strlen(sample); size++)
        assert_int_equal(read_copy(read_json, sample, size, "w.json", &world), STATUS_INPUT);
}

/* A mesh that a generator makes costs a few bytes of text. */
static enum status huge_scene(void *user, const char *spec, struct scene *out, struct reason *why)
{
    (void)user, (void)spec, (void)why;
    *out = (struct scene){.tri_count = WORLD_REFERRED_MOST / 2 + 1};
    return STATUS_OK;
}

static void meshes_from_elsewhere_have_a_limit(void **state)
{
    (void)state;
    struct world world;
    const struct world_files files = {huge_scene, fixture_bytes, NULL};
    static const char text[] =
        "{\"raydiff_world\":1,\"meshes\":[{\"scene\":\"a\"},{\"scene\":\"a\"}]}";
    enum status status = read_world("w.json", text, strlen(text), &files, &world, &reason);
    expect_rule(status, "meshes[1]: meshes from elsewhere have 67108866 triangles by here, over");
    assert_null(world.mesh);
}

static void a_world_is_told_by_its_key(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool world;
    } file[] = {
        {sample, true},
        {"{ \"a\": {\"b\": [1, \"]}\\\"\"]}, \"raydiff_world\" \n: 7", true},
        {"{\"a\": {\"raydiff_world\": 1}}", false},
        {"[\"raydiff_world\", 1]", false},
        {"{\"a\": \"raydiff_world\"}", false},
        {"{\"a\": \"\\\"raydiff_world\\\":\"}", false},
        {"{\"raydiff_world", false},
        {"{\"raydiff_world\"", false},
        {"", false},
        {"\"", false},
        {"{\"\\", false},
    };
    for (size_t i = 0; i < ARRAY_COUNT(file); i++)
        assert_int_equal(is_world(file[i].text, strlen(file[i].text)), file[i].world);
}

static void what_is_written_is_read_to_the_bit(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 0);
    for (int i = 0; i < 400; i++) {
        struct world world, back;
        size_t size;
        make_wild_world(&rng, &world);
        char *bytes = written_world(write_world, &world, &size);
        assert_true(is_world(bytes, size));
        enum status status = read_copy(read_json, bytes, size, "w.json", &back);
        if (status)
            print_error("%s\n", reason.text);
        assert_int_equal(status, STATUS_OK);
        assert_same_world(&world, &back);
        world_free(&back);
        world_free(&world);
        free(bytes);
    }
}

/* The identity is left out, one with a negative zero is not. */
static void the_identity_keeps_the_signs_of_its_zeros(void **state)
{
    (void)state;
    struct world world, back;
    assert_int_equal(read_text("{\"raydiff_world\":1,\"meshes\":[],\"instances\":[{\"mesh\":null},"
                               "{\"mesh\":null,\"transform\":[1,0,0,0,-0.0,1,0,0,0,0,1,-0]}]}",
                               &world),
                     STATUS_OK);
    size_t size;
    char *bytes = written_world(write_world, &world, &size);
    assert_int_equal(read_copy(read_json, bytes, size, "w.json", &back), STATUS_OK);
    assert_same_world(&world, &back);
    assert_int_equal(float_bits(back.instance[1].m[1][0]), 0x80000000u);
    assert_int_equal(float_bits(back.instance[1].m[2][3]), 0x80000000u);
    size_t told = 0;
    for (size_t i = 0; i + 9 < size; i++)
        told += memcmp(bytes + i, "transform", 9) == 0;
    assert_int_equal(told, 1);
    free(bytes);
    world_free(&back);
    world_free(&world);
}

/* Any words of flags in any order are those flags; one that is there twice is refused. */
static void flags_are_told_once(void **state)
{
    (void)state;
    static const char *const word[] = {"cull_disable", "flip_facing", "force_opaque",
                                       "force_no_opaque"};
    static const uint32_t bit[] = {ABI_INSTANCE_CULL_DISABLE, ABI_INSTANCE_FLIP_FACING,
                                   ABI_INSTANCE_FORCE_OPAQUE, ABI_INSTANCE_FORCE_NO_OPAQUE};
    for (uint32_t i = 0; i < 64; i++) {
        const uint32_t at[] = {i % 4, i / 4 % 4, i / 16};
        char list[100], rule[60] = "";
        struct world world;
        snprintf(list, sizeof list, "\"%s\", \"%s\", \"%s\"", word[at[0]], word[at[1]],
                 word[at[2]]);
        uint32_t twice = at[1] == at[0] ? at[1] : at[2] == at[0] || at[2] == at[1] ? at[2] : 4;
        uint32_t flags = bit[at[0]] | bit[at[1]] | bit[at[2]];
        uint32_t forces = ABI_INSTANCE_FORCE_OPAQUE | ABI_INSTANCE_FORCE_NO_OPAQUE;
        char *text = changed(sample, "\"flip_facing\", \"force_opaque\"", list);
        enum status status = read_text(text, &world);
        free(text);
        if (twice < 4)
            snprintf(rule, sizeof rule, "'%s' is there twice", word[twice]);
        if (twice < 4 || (flags & forces) == forces) {
            expect_rule(status, rule);
            continue;
        }
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(world.instance[0].flags, flags);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_member_of_a_world_is_read),
        cmocka_unit_test(a_float_is_the_nearest_to_its_decimal),
        cmocka_unit_test(members_come_in_any_order_and_may_be_empty),
        cmocka_unit_test(a_wrong_world_is_refused_with_place_and_rule),
        cmocka_unit_test(what_is_no_json_is_refused_with_its_line),
        cmocka_unit_test(meshes_from_elsewhere_have_a_limit),
        cmocka_unit_test(a_world_is_told_by_its_key),
        cmocka_unit_test(what_is_written_is_read_to_the_bit),
        cmocka_unit_test(the_identity_keeps_the_signs_of_its_zeros),
        cmocka_unit_test(flags_are_told_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
