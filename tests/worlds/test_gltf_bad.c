/* glTF files that are refused: one line each, with place and rule, and nothing made. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/worlds/gltf_fixture.h"

static void expect_refused(const char *old, const char *new, const char *rule)
{
    struct world world;
    expect_rule(read_gltf_changed(old, new, &world), rule);
    assert_int_equal(fixture_notes.points_and_lines, 0);
}

static void wrong_versions_and_extensions_are_named(void **state)
{
    (void)state;
    expect_refused("\"2.0\"", "\"1.0\"", "w.gltf: asset.version: is '1.0'; glTF 2.0 is read");
    expect_refused("\"2.0\"", "2.0", "w.gltf: asset.version: must be a text");
    expect_refused("{\"version\": \"2.0\"}", "{}", "asset.version: is missing");
    expect_refused("\"asset\"", "\"assets\"", "w.gltf: asset: is missing");
    expect_refused(
        "extensionsUsed", "extensionsRequired",
        "extensionsRequired[0]: the extension KHR_materials_unlit is required, which is");
    expect_refused("\"materials\"", "\"asset\"", "asset: is there twice");
    expect_refused("{\"asset\"", "[\"asset\"", "w.gltf: must be an object");
    expect_refused("}]}\n", "}]} x", "w.gltf:31:260: nothing may follow the last bracket");
}

static void wrong_nodes_are_named(void **state)
{
    (void)state;
    expect_refused("[1, 2], \"tr", "[1, 4], \"tr",
                   "nodes[0].children[1]: 4, but there are 4 nodes");
    expect_refused("[1, 2], \"tr", "[1, 1], \"tr",
                   "nodes[0].children[1]: node 1 has a parent already, node 0");
    expect_refused("{\"mesh\": 1, \"rot", "{\"mesh\": 1, \"children\": [1], \"rot",
                   "nodes[2].children[0]: node 1 has a parent already, node 0");
    expect_refused("{\"mesh\": 1, \"rot", "{\"mesh\": 1, \"children\": [0], \"rot",
                   "nodes[0]: is its own ancestor");
    expect_refused("{\"mesh\": 0, \"extras\": 7}", "{\"children\": [3]}",
                   "nodes[3]: is its own ancestor");
    expect_refused("[1, 2], \"tr", "[1.5, 2], \"tr",
                   "nodes[0].children[0]: must be a whole number");
    expect_refused("[1, 2], \"tr", "7, \"tr", "nodes[0].children: must be an array");
    expect_refused("\"mesh\": 1,", "\"mesh\": 2,", "nodes[2].mesh: 2, but there are 2 meshes");
    expect_refused("\"mesh\": 1,", "\"mesh\": 4294967295,",
                   "nodes[2].mesh: must be a whole number");
    expect_refused("[10, 20, 30]", "[10, 20]", "nodes[0].translation: must be 3 numbers, not 2");
    expect_refused("[10, 20, 30]", "[1, 2, 3, 4]", "translation[3]: is one more than 3 numbers");
    expect_refused("[10, 20, 30]", "[1, 2, null]",
                   "nodes[0].translation[2]: must be a number; null");
    expect_refused("7, 1]}", "7]}", "nodes[1].matrix: must be 16 numbers, not 15");
    expect_refused("7, 1]}", "7, 2]}", "nodes[1].matrix: its last row, elements 3, 7, 11 and 15");
    expect_refused("[2, 0, 1, 0,", "[2, 0, 1, 1,", "nodes[1].matrix: its last row, elements 3, 7");
    expect_refused("7, 1]}", "7, 1], \"scale\": [1, 1, 1]}",
                   "nodes[1]: has a matrix, and translat");
    expect_refused("0.705]", "0.5]", "nodes[2].rotation: is no quaternion of length 1, to within");
    expect_refused("0, 0, 0.705, 0.705", "0, 0, 0, 0", "nodes[2].rotation: is no quaternion");
    expect_refused("[2, 3, 4]", "[2, 0, 4]", "nodes[2]: its matrix in the scene is singular");
    expect_refused("\"scale\": [2, 1, 1]", "\"scale\": [0, 1, 1]",
                   "nodes[1]: its matrix in the scene is singular");
    expect_refused("[10, 20, 30]", "[1e39, 0, 0]",
                   "nodes[1]: row 0, column 3 of its matrix in the scene is beyond the range");
    expect_refused("[2, 1, 1]", "[1e200, 1, 1]", "row 0, column 0 of its matrix in the scene");
    expect_refused("70000", "16777216", "nodes[2].extras.raydiff.custom: must be a whole number");
    expect_refused("\"mask\": 3", "\"flags\": [\"flip\"]",
                   "nodes[2].extras.raydiff.flags[0]: 'flip'");
    expect_refused("\"mask\": 3", "\"flags\": [\"force_opaque\", \"force_no_opaque\"]",
                   "w.gltf: instance 1: it is forced to be opaque and not to be");
    expect_refused("{\"custom\"", "[1], \"x\": {\"custom\"", "extras.raydiff: must be an object");
}

static void wrong_scenes_are_named(void **state)
{
    (void)state;
    expect_refused("\"scene\": 1", "\"scene\": 2", "w.gltf: scene: 2, but there are 2 scenes");
    expect_refused("\"nodes\": [0], ", "\"nodes\": [4], ",
                   "scenes[1].nodes[0]: 4, but there are 4");
    expect_refused("\"nodes\": [0], ", "\"nodes\": [3, 3], ",
                   "scenes[1].nodes[1]: node 3 is there tw");
    expect_refused("\"nodes\": [0], ", "\"nodes\": [1], ",
                   "scenes[1].nodes[0]: node 1 is no root: its");
    expect_refused("\"nodes\": [0], ", "\"nodes\": 0, ", "scenes[1].nodes: must be an array");
}

static void wrong_meshes_are_named(void **state)
{
    (void)state;
    expect_refused("\"POSITION\": 4}", "\"POSITION\": 5}",
                   "meshes[1].primitives[0].attributes.POSITION: 5, but there are 5 accessors");
    expect_refused("\"POSITION\": 4}", "\"NORMAL\": 4}",
                   "meshes[1].primitives[0].attributes: has no POSITION");
    expect_refused("{\"attributes\": {\"POSITION\": 4}, ", "{",
                   "meshes[1].primitives[0].attributes: is missing");
    expect_refused("\"indices\": 3", "\"indices\": 5",
                   "meshes[0].primitives[2].indices: 5, but there are 5 accessors");
    expect_refused("\"mode\": 5", "\"mode\": 7",
                   "primitives[1].mode: must be a whole number from 0 to");
    expect_refused("\"material\": 2", "\"material\": 3",
                   "meshes[1].primitives[1].material: 3, but there are 3");
    expect_refused("\"primitives\": [{\"attributes\": {\"POSITION\": 4}",
                   "\"a\": [{\"b\": {\"c\": 4}", "meshes[1].primitives: is missing");
    expect_refused("\"BLEND\"", "\"Blend\"",
                   "materials[1].alphaMode: 'Blend' is none of OPAQUE, MASK");
    expect_refused("\"doubleSided\": true", "\"doubleSided\": 1",
                   "materials[1].doubleSided: must be");
    /* A list of 4 corners, a strip of 2. */
    expect_refused("\"mode\": 5", "\"mode\": 4",
                   "meshes[0].primitives[1]: has 4 corners, which are no triangles of 3 each");
    expect_refused(
        "5123, \"count\": 4", "5123, \"count\": 2",
        "meshes[0].primitives[1]: has 2 corners, which are no strip or fan of 3 or more");
}

static void wrong_accessors_are_named(void **state)
{
    (void)state;
    expect_refused("5126, \"count\": 3", "5123, \"count\": 3",
                   "accessors[4]: positions must be VEC3 of FLOAT (5126)");
    expect_refused("\"count\": 3, \"type\": \"VEC3\"", "\"count\": 3, \"type\": \"VEC2\"",
                   "accessors[4]: positions must be VEC3 of FLOAT");
    expect_refused("5121", "5120", "accessors[1]: indices must be SCALAR of UNSIGNED_BYTE");
    expect_refused("5121", "5126", "accessors[1]: indices must be SCALAR of UNSIGNED_BYTE");
    expect_refused("6, \"type\": \"SCALAR\"", "6, \"type\": \"VEC3\"",
                   "accessors[1]: indices must be");
    expect_refused("6, \"type\": \"SCALAR\"", "6, \"type\": 1",
                   "accessors[1].type: must be a text");
    expect_refused("\"count\": 3, \"type\"", "\"sparse\": {\"count\": 1}, \"count\": 3, \"type\"",
                   "accessors[4].sparse: sparse accessors are not read");
    expect_refused("{\"bufferView\": 3, ", "{", "accessors[4]: has no bufferView");
    expect_refused("{\"bufferView\": 3, ", "{\"bufferView\": 4, ",
                   "accessors[4].bufferView: 4, but");
    expect_refused("\"count\": 3,", "\"count\": 0,", "accessors[4].count: must be at least 1");
    expect_refused("\"count\": 3,", "\"count\": 4,",
                   "accessors[4]: ends at byte 48, but bufferViews[3] at 36");
    expect_refused("\"count\": 3,", "\"count\": 4294967294,",
                   "accessors[4]: ends at byte 51539607528");
    expect_refused("\"count\": 3,", "\"count\": 4294967295,",
                   "accessors[4].count: must be a whole");
    expect_refused("\"byteOffset\": 8", "\"byteOffset\": 9", "accessors[3]: ends at byte 25, but");
    expect_refused("\"byteOffset\": 8", "\"byteOffset\": -8",
                   "accessors[3].byteOffset: must be a w");
    expect_refused("\"byteOffset\": 8", "\"byteOffset\": 9007199254740992",
                   "accessors[3]: ends at byte 9007199254741008, but bufferViews[2] at 24");
    expect_refused("5126, \"count\": 4", "5126, \"count\": 3",
                   "accessors[1]: element 5 names vertex 3, but there are 3");
    expect_refused("\"count\": 6, ", "", "accessors[1].count: is missing");
}

static void wrong_views_and_buffers_are_named(void **state)
{
    (void)state;
    expect_refused("\"byteStride\": 16", "\"byteStride\": 8",
                   "bufferViews[0].byteStride: 8, but elements have 12 bytes");
    expect_refused("\"byteStride\": 16", "\"byteStride\": 14",
                   "bufferViews[0].byteStride: must be a m");
    expect_refused("\"byteStride\": 16", "\"byteStride\": 256",
                   "byteStride: must be a whole number");
    expect_refused("\"byteStride\": 16", "\"byteStride\": 20",
                   "accessors[0]: ends at byte 72, but bufferViews[0] at 64");
    expect_refused("\"byteLength\": 36}", "\"byteLength\": 37}",
                   "bufferViews[3]: ends at byte 133, but buffers[0] at 132");
    expect_refused("\"byteOffset\": 96", "\"byteOffset\": 9007199254740992",
                   "bufferViews[3]: ends at byte 9007199254741028, but buffers[0] at 132");
    expect_refused("{\"buffer\": 0, \"byteLength\": 64", "{\"buffer\": 1, \"byteLength\": 64",
                   "bufferViews[0].buffer: 1, but there are 1");
    expect_refused("{\"byteLength\": 132", "{\"byteLength\": 133",
                   "buffers[0].byteLength: is 133, but there are 132 bytes");
    expect_refused("{\"byteLength\": 132", "{\"byteLength\": 131",
                   "bufferViews[3]: ends at byte 132, but buffers[0] at 131");
    expect_refused("{\"byteLength\": 132, ", "{", "buffers[0].byteLength: is missing");
    expect_refused(";base64,", ",",
                   "buffers[0].uri: a data: URI must have ;base64, before its data");
    expect_refused(";base64,", ";base64", "buffers[0].uri: a data: URI must have ;base64, before");
    expect_refused(";base64,", ";base64,*", "buffers[0].uri: is no base64: letters by fours");
    expect_refused(";base64,", ";base64,AA==", "buffers[0].uri: is no base64: letters by fours");
    expect_refused("\"}]}\n", "=\"}]}\n", "buffers[0].uri: is no base64: letters by fours");
    expect_refused(GLTF_URI, "triangle.bin?", "w.gltf: buffers[0].uri: triangle.bin?");
    expect_refused("\"uri\"", "\"url\"", "buffers[0]: has no uri, and the file no chunk for it");
    expect_refused("\"uri\": ", "\"uri\": 7, \"x\": ", "buffers[0].uri: must be a text");
}

/* The fixture with bytes of its buffer changed, and read. */
static enum status read_poked(size_t at, const void *bytes, size_t size)
{
    size_t whole;
    char *glb = gltf_glb(&whole);
    struct world world;
    memcpy(glb + whole - GLTF_BYTES + at, bytes, size);
    enum status status = read_copy(read_gltf_bytes, glb, whole, "w.gltf", &world);
    world_free(&world);
    free(glb);
    return status;
}

static void positions_are_finite_and_indices_end_no_strip(void **state)
{
    (void)state;
    static const uint32_t nan = 0x7FC00001u, inf = 0xFF800000u, all = UINT32_MAX;
    assert_int_equal(read_poked(0, &inf, 0), STATUS_OK);
    assert_int_equal(read_poked(12, &nan, 4), STATUS_OK); /* between two vertices */
    expect_rule(read_poked(20, &nan, 4), "accessors[0]: element 1: y is not a finite number");
    expect_rule(read_poked(104, &inf, 4), "accessors[4]: element 0: z is not a finite number");
    expect_rule(read_poked(64, &all, 1), "accessors[1]: element 0 is 255, which would end a strip");
    expect_rule(read_poked(74, &all, 2), "accessors[2]: element 1 is 65535, which would end a");
    expect_rule(read_poked(88, &all, 4), "accessors[3]: element 2 is 4294967295, which would");
    expect_rule(read_poked(74, (const char *)&nan + 2, 2),
                "accessors[2]: element 1 names vertex 32704, but there are 4");
}

/* --- GLB -------------------------------------------------------------------------------------- */

/* Reads the fixture as GLB with a word changed, and more or fewer bytes. */
static enum status read_glb(size_t at, uint32_t word, long more)
{
    size_t size;
    char *glb = gltf_glb(&size);
    struct world world;
    glb = realloc(glb, size + 16);
    assert_non_null(glb);
    memset(glb + size, 0, 16);
    memcpy(glb + at, &word, 4);
    enum status status =
        read_copy(read_gltf_bytes, glb, (size_t)((long)size + more), "w.gltf", &world);
    world_free(&world);
    free(glb);
    return status;
}

static void wrong_chunks_are_named_by_their_byte(void **state)
{
    (void)state;
    size_t size;
    char *glb = gltf_glb(&size);
    uint32_t json, length = (uint32_t)size;
    memcpy(&json, glb + 12, 4);
    assert_int_equal(read_glb(4, 2, 0), STATUS_OK);
    expect_rule(read_glb(0, 0x46546C68, 0), "w.gltf: must be an object"); /* read as text */
    expect_rule(read_glb(4, 1, 0), "w.gltf: byte 4: version 1 of GLB; 2 is read");
    expect_rule(read_glb(8, length - 4, 0), "byte 8: the length is");
    expect_rule(read_glb(8, length, 1), "byte 8: the length is");
    expect_rule(read_glb(8, length, -1), "byte 8: the length is");
    expect_rule(read_glb(8, 16, 16 - (long)size), "byte 16: the header is cut short");
    expect_rule(read_glb(8, length + 4, 4), "a chunk is cut short");
    expect_rule(read_glb(12, json + 1, 0), "byte 12: the chunk has");
    expect_rule(read_glb(12, json + 400, 0), "byte 12: the chunk has");
    expect_rule(read_glb(12, UINT32_MAX - 3, 0), "byte 12: the chunk has 4294967292 bytes, but");
    expect_rule(read_glb(12, json - 4, 0), "w.gltf: byte"); /* the next chunk begins too early */
    expect_rule(read_glb(16, 0x004E4942, 0),
                "byte 12: the first chunk, and no other, must be JSON");
    expect_rule(read_glb(20 + json, 136, 0), "the chunk has 136 bytes, but 132 follow");
    expect_rule(read_glb(20 + json, 128, 0), "a chunk is cut short");
    expect_rule(read_glb(24 + json, 0x4E4F534A, 0), "the first chunk, and no other, must be JSON");
    expect_rule(read_glb(24 + json, 0x12345678, 0),
                "buffers[0]: has no uri, and the file no chunk");
    for (size_t cut = 4; cut < size; cut++)
        expect_rule(read_glb(4, 2, (long)cut - (long)size), "w.gltf: byte ");
    free(glb);
}

/* What a number at the end of a chunk could run into. */
static void a_text_does_not_run_into_the_next_chunk(void **state)
{
    (void)state;
    size_t size;
    struct world world;
    char *glb = glb_bytes("{\"asset\":12", "34567890", 8, &size);
    expect_rule(read_copy(read_gltf_bytes, glb, size, "w.gltf", &world), "w.gltf: asset: must be");
    free(glb);
    glb = glb_bytes("{\"scene\":  1", "34567890", 8, &size);
    glb[20 + 12] = '8'; /* the length of the next chunk begins with a digit */
    glb[20 + 13] = glb[20 + 14] = glb[20 + 15] = 0;
    expect_rule(read_copy(read_gltf_bytes, glb, 20 + 12 + 8 + 8, "w.gltf", &world), "w.gltf: byte");
    free(glb);
    glb = glb_bytes("{\"scene\":  1", "34567890", 8, &size);
    expect_rule(read_copy(read_gltf_bytes, glb, size, "w.gltf", &world), "the text is cut short");
    free(glb);
}

/* --- what costs more than it should ----------------------------------------------------------- */

/* A chain of so many nodes, the last with a mesh. */
static char *chain(unsigned nodes)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    (void)fprintf(stream, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[");
    for (unsigned i = 0; i + 1 < nodes; i++)
        (void)fprintf(stream, "{\"children\":[%u],\"translation\":[1,0,0]},", i + 1);
    (void)fprintf(stream, "{\"extras\":{\"raydiff\":{}}}]}");
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void nodes_lie_only_so_deep(void **state)
{
    (void)state;
    struct world world;
    char *text = chain(GLTF_DEEP + 1);
    assert_int_equal(read_gltf_text(text, &world), STATUS_OK);
    assert_true(world.instance[0].m[0][3] == (float)GLTF_DEEP);
    world_free(&world);
    free(text);
    text = chain(GLTF_DEEP + 2);
    expect_rule(read_gltf_text(text, &world), "nodes[257]: lies deeper than 256 nodes, or under a");
    free(text);
}

/* The same bytes for many meshes: each costs 60 bytes of text, and takes all of them. */
static void meshes_cost_bytes_of_their_own(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size;
    struct world world;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    (void)fprintf(stream, "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[");
    for (int i = 0; i < 100; i++)
        (void)fprintf(stream, "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":5}]},");
    (void)fprintf(stream,
                  "{\"primitives\":[]}],\"accessors\":[{\"bufferView\":0,\"componentType\":"
                  "5126,\"count\":1000,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"
                  "\"byteLength\":12000}],\"buffers\":[{\"byteLength\":12000,\"uri\":\"" GLTF_URI);
    for (int i = 0; i < 4000; i++)
        fputs("AAAA", stream);
    fputs("\"}]}", stream);
    assert_int_equal(fclose(stream), 0);
    expect_rule(read_gltf_text(text, &world), "]: meshes take more than 16 bytes for each of the ");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_versions_and_extensions_are_named),
        cmocka_unit_test(wrong_nodes_are_named),
        cmocka_unit_test(wrong_scenes_are_named),
        cmocka_unit_test(wrong_meshes_are_named),
        cmocka_unit_test(wrong_accessors_are_named),
        cmocka_unit_test(wrong_views_and_buffers_are_named),
        cmocka_unit_test(positions_are_finite_and_indices_end_no_strip),
        cmocka_unit_test(wrong_chunks_are_named_by_their_byte),
        cmocka_unit_test(a_text_does_not_run_into_the_next_chunk),
        cmocka_unit_test(nodes_lie_only_so_deep),
        cmocka_unit_test(meshes_cost_bytes_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
