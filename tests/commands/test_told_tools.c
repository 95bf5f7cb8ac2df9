/* Numbers that raydiff bisect, build, scene and construct tell: no two are the same, and each is
 * looked for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/bisect/cmd_bisect.h"
#include "cmd/build/cmd_build.h"
#include "cmd/build/cmd_build_same.h"
#include "cmd/scene/cmd_construct.h"
#include "cmd/scene/cmd_scene.h"

#include "tests/commands/told.h"

static const struct screen screen = {.width = 4000, .wide = true};

/* --- bisect ----------------------------------------------------------------------------------- */

static const char *passes[] = {"a", "b", "c"};
static bool in[] = {true, false, true};

static struct bisect_result bisect_made(const struct bisect_options *options,
                                        const struct bisect_subject *subject)
{
    return (struct bisect_result){
        .options = options,
        .subject = subject,
        .shader = "s",
        .shown =
            {.is = true, .symptom = SYMPTOM_BITS, .count = 11, .of = 12, .first = 13, .open = 14},
        .bisect = {.pass = passes,
                   .in = in,
                   .pass_count = 3,
                   .found_count = 2,
                   .pass_tries = 21,
                   .edits = 22,
                   .edit_count = 23,
                   .edit_tries = 24,
                   .least = true},
        .crashed = 31,
        .hung = 32,
    };
}

static const struct told_number bisect_numbers[] = {
    {"exit", 1},
    {"rays", 33},
    {"symptom.count", 11},
    {"symptom.of", 12},
    {"symptom.first_ray", 13},
    {"symptom.open", 14},
    {"passes.tried", 21},
    {"change.decorations", 0},
    {"change.edits", 22},
    {"change.found", 23},
    {"change.least", 1},
    {"change.tried", 24},
    {"crashed", 31},
    {"hung", 32},
};

static void what_was_bisected(void **state)
{
    (void)state;
    static struct bisect_subject subject;
    static const struct bisect_options options;
    struct bisect_options of = options;
    struct reason reason;
    subject = (struct bisect_subject){
        .text = "t", .ray_count = 33, .bad_name = "bad", .good_name = "good"};
    of.engine = engine_find("cpu");
    struct bisect_result result = bisect_made(&of, &subject);
    const char *const lines[] = {
        "bad against good: t, 33 rays, engine cpu",
        "symptom bits: 11 of 12 answers have other bits, to ray 13 first",
        "passes a + c: 2 of 3, no shorter list shows it (21 tried)",
        "23 of 22 edits, none can be left out (24 tried)",
        "modules 31 of those tried crashed the engine, 32 hung",
    };
    told_begin(&stdout);
    bisect_print(&result, &screen);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    assert_int_equal(bisect_write_json(told_file(), &result, 1, &reason), STATUS_OK);
    told_json(told_file_json(), bisect_numbers, ARRAY_COUNT(bisect_numbers));
    result.shown.symptom = SYMPTOM_PRECISE;
    char text[200];
    shown_text(&result.shown, text, sizeof text);
    assert_non_null(strstr(text, ": 11 of 12 float operations"));
    assert_non_null(strstr(text, ", 14 of open rounding"));
}

/* --- build ------------------------------------------------------------------------------------ */

static void what_device_and_c_build(void **state)
{
    (void)state;
    static struct build_row row;
    struct told_number numbers[7 + 5 * (STAGED_PARTS + 1)] = {
        {"exit", 1},
        {"rounds", 41},
        {"rows.0.triangles", 42},
        {"rows.0.device_bytes", 43},
        {"rows.0.equal", 0},
        {"rows.0.differs.element", 44},
        {"rows.0.differs.elements", 45},
    };
    static char path[ARRAY_COUNT(numbers) + 1][60];
    static const char *const name[] = {"device_ms", "c_ms", "ratio", "ratio_least", "ratio_most"};
    struct reason reason;
    size_t count = 7;
    const struct builder builder = {.name = "b", .twin = "c"};
    row = (struct build_row){.scene = "s",
                             .builder = &builder,
                             .triangles = 42,
                             .differs = {.stage = "codes", .element = 44, .count = 45},
                             .differing = 46,
                             .device_bytes = 43};
    for (size_t p = 0; p <= STAGED_PARTS; p++) {
        const double at = 100.0 * (double)(p + 1);
        row.part[p] = (struct build_part){at, at + 1, at + 2, at + 3, at + 4};
        for (size_t k = 0; k < 5; k++, count++) {
            snprintf(path[count], sizeof path[0], "rows.0.stages.%zu.%s", p, name[k]);
            numbers[count] = (struct told_number){path[count], at + (double)k};
        }
    }
    struct told_number all[ARRAY_COUNT(numbers) + 1];
    memcpy(all, numbers, sizeof numbers);
    all[count++] = (struct told_number){"rows.0.differs.rounds", 46};
    const struct build_results results = {.row = &row, .row_count = 1};
    const struct vk_limits limits = {.device = "d", .driver = "e"};
    assert_int_equal(build_write_json(told_file(), &results, &limits, 41, 1, &reason), STATUS_OK);
    told_json(told_file_json(), all, count);
}

static const struct told_number same_numbers[] = {
    {"trees.0.compared", 51},     {"trees.0.differ", 52},   {"trees.1.compared", 53},
    {"trees.1.differ", 54},       {"engines.0.builds", 55}, {"engines.0.answers", 55 * 56},
    {"engines.0.other_bits", 57}, {"engines.0.wrong", 58},
};

static void what_was_built_again(void **state)
{
    (void)state;
    const struct same_row row[] = {
        {.builder = builders_all[0], .builds = 51, .differing = 52, .text = "node x"},
        {.builder = builders_all[0],
         .layout = layout_find("f32"),
         .builds = 53,
         .differing = 54,
         .text = "word y"}};
    const struct same_engine engine = {
        .engine = engine_find("cpu"), .builds = 55, .rays = 56, .other = 57, .wrong = 58};
    const char *const lines[] = {"verdict builder layout compared differ",
                                 "tree 51 52",
                                 "f32 53 54",
                                 "median, tree: the first difference node x",
                                 "median, f32: the first difference word y",
                                 "in 55 builds of its own 57 of 3080 answers have other bits",
                                 "and 58 are WRONG"};
    told_begin(&stdout);
    same_print(row, 2, &screen);
    same_print_engines(&engine, 1, &screen);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    told_json(same_json("s", row, 2, &engine, 1), same_numbers, ARRAY_COUNT(same_numbers));
}

/* --- scenes ----------------------------------------------------------------------------------- */

static const struct told_number world_numbers[] = {
    {"meshes", 2},
    {"geometries", 6},
    {"not_opaque", 4},
    {"vertices", 101 + 60},
    {"triangles", 103 + 200},
    {"instances", 9},
    {"inactive", 3},
    {"mirrored", 1},
    {"identity", 8},
    {"placed_triangles", 1000},
    {"share", 77},
};

/* Two meshes of one and five geometries, all but two not opaque; nine instances, one mirrored, the
 * others at the identity, two without a mesh and one without a mask. */
static void what_a_world_is(void **state)
{
    (void)state;
    struct scene scene[2] = {{.vertex_count = 101, .tri_count = 103},
                             {.vertex_count = 60, .tri_count = 200}};
    struct geometry geometry[6] = {{.opaque = true}, {.opaque = true}};
    struct world_mesh mesh[2] = {{&scene[0], geometry, 1}, {&scene[1], geometry + 1, 5}};
    struct instance instance[9];
    uint32_t first[10] = {[9] = 1000};
    for (size_t i = 0; i < 9; i++)
        instance[i] =
            (struct instance){.m = {{i == 4 ? -1 : 1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                              .mesh = i < 2 ? WORLD_NO_MESH : 0,
                              .mask = i == 2 ? 0 : 255};
    const struct world world = {.mesh = mesh,
                                .instance = instance,
                                .first = first,
                                .mesh_count = 2,
                                .instance_count = 9,
                                .filter = {.kind = FILTER_CELLS, .share = 77}};
    const char *const lines[] = {"meshes 2\n",
                                 "geometries 6, not opaque 4\n",
                                 "vertices 161\n",
                                 "triangles 303\n",
                                 "instances 9, inactive 3, mirrored 1, at the identity 8\n",
                                 "placed triangles 1000\n",
                                 "filter cells, 77 of 256\n"};
    told_begin(&stdout);
    world_print("w", &world);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    told_json(world_json("w", &world), world_numbers, ARRAY_COUNT(world_numbers));
}

static const struct told_number construct_numbers[] = {
    {"models.0.material", 61},   {"models.0.triangles", 62}, {"models.0.vertices", 63},
    {"models.0.transformed", 1}, {"models.0.mirrored", 0},   {"models.1.material", 71},
    {"models.1.triangles", 65},  {"models.1.vertices", 66},  {"models.1.transformed", 0},
    {"models.1.mirrored", 1},    {"triangles", 67},          {"vertices", 68},
    {"materials", 69},           {"default_material", 71},   {"lights", 70},
    {"unused_vertices", 72},     {"filled_normals", 73},
};

static void what_was_constructed(void **state)
{
    (void)state;
    struct construct_model model[2] = {
        {.spec = "a", .material = 61, .tri_count = 62, .vertex_count = 63, .transform.any = true},
        {.spec = "b",
         .material = CONSTRUCT_DEFAULT,
         .tri_count = 65,
         .vertex_count = 66,
         .transform.mirrors = true}};
    const struct construct_options options = {.construct = {.model = model, .model_count = 2},
                                              .out = "o.json"};
    const struct scene scene = {
        .tri_count = 67, .vertex_count = 68, .material_count = 69, .light_count = 70};
    const struct construct_notes notes = {.red = 71, .unused = 72, .filled = 73};
    const char *const lines[] = {
        "o.json: 2 models, 67 triangles, 68 vertices, 69 materials, 70 lights, camera",
        "material 71 is the default red", "vertices of no triangle, kept, with normal 0 1 0: 72\n",
        "vertices without a normal of their triangles', filled with 0 1 0: 73\n"};
    json_t *json = NULL;
    struct reason reason;
    told_begin(&stderr);
    construct_print(&options, &scene, &notes);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    assert_int_equal(construct_json(&options, &scene, &notes, &json, &reason), STATUS_OK);
    told_json(json, construct_numbers, ARRAY_COUNT(construct_numbers));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_bisected),    cmocka_unit_test(what_device_and_c_build),
        cmocka_unit_test(what_was_built_again), cmocka_unit_test(what_a_world_is),
        cmocka_unit_test(what_was_constructed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
