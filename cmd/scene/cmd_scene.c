/* raydiff scene: describes, converts and lists scenes. */
#define _GNU_SOURCE /* scandir */
#include "cmd/scene/cmd_scene.h"

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/nearest_name.h"
#include "ref/base/command.h"
#include "ref/base/decimal.h"
#include "ref/scene/quantise.h"
#include "scenes/facts.h"
#include "ref/base/json_record.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define FETCHED "scenes/fetched"

/* Writes "x y z" in the shortest decimals that identify the floats. */
static const char *show3(const float x[3], char text[3 * DECIMAL_TEXT])
{
    char part[3][DECIMAL_TEXT];
    for (int k = 0; k < 3; k++) {
        if (float_is_finite(x[k]))
            decimal_write_float(x[k], part[k]);
        else
            strcpy(part[k], "beyond-a-float");
    }
    snprintf(text, 3 * DECIMAL_TEXT, "%s %s %s", part[0], part[1], part[2]);
    return text;
}

static void print_info(const char *spec, const struct scene *scene, const struct facts *facts)
{
    char text[3 * DECIMAL_TEXT];
    struct camera camera = scene_camera(scene);
    printf("%s\n", spec);
    printf("  triangles           %u\n", scene->tri_count);
    printf("  vertices            %u\n", scene->vertex_count);
    if (scene->tri_count) {
        printf("  bounds, least       %s\n", show3(facts->bounds.lo, text));
        printf("  bounds, most        %s\n", show3(facts->bounds.hi, text));
    }
    printf("  longest side        %.9g\n", (double)facts->extent);
    printf("  largest coordinate  %.9g\n", (double)facts->largest);
    printf("  zero-area           %u\n", facts->zero_area);
    printf("  duplicates          %u\n", facts->duplicate);
    printf("  normals             %s\n", scene->normal ? "yes" : "no");
    printf("  lights, materials   %u, %u\n", scene->light_count, scene->material_count);
    printf("  camera from         %s%s\n", show3(camera.pos, text),
           scene->has_camera ? "" : " (none given: chosen)");
    printf("  camera at           %s, %s\n", show3(camera.at, text),
           camera.orbit ? "orbit" : "fixed");
}

/* Three floats; null for each that JSON cannot hold. */
static json_t *json3(const float x[3])
{
    json_t *array = json_array();
    for (int k = 0; k < 3; k++)
        json_array_append_new(array, float_is_finite(x[k]) ? json_real((double)x[k]) : json_null());
    return array;
}

static json_t *json_info(const char *spec, const struct scene *scene, const struct facts *facts)
{
    struct camera camera = scene_camera(scene);
    bool any = scene->tri_count > 0;
    json_t *place = json_record("from=%p at=%p orbit=%i chosen=%i", json3(camera.pos),
                                json3(camera.at), camera.orbit, !scene->has_camera);
    return json_record(
        "scene=%s triangles=%u vertices=%u least=%p most=%p longest_side=%g largest_coordinate=%g "
        "zero_area=%u duplicates=%u normals=%i lights=%u materials=%u camera=%p",
        spec, scene->tri_count, scene->vertex_count, any ? json3(facts->bounds.lo) : json_null(),
        any ? json3(facts->bounds.hi) : json_null(), (double)facts->extent, (double)facts->largest,
        facts->zero_area, facts->duplicate, scene->normal != NULL, scene->light_count,
        scene->material_count, place);
}

static enum status inform_scene(const char *spec, const struct scene *scene, json_t **json,
                                struct reason *reason)
{
    struct facts facts;
    enum status status = facts_make(scene, &facts);
    if (status)
        return fail(reason, status, "%s: no memory to compare %u triangles", spec,
                    scene->tri_count);
    if (json)
        *json = json_info(spec, scene, &facts);
    else
        print_info(spec, scene, &facts);
    return STATUS_OK;
}

/* Adds one scene or world to the report. `list` NULL: prints it instead. */
static enum status inform(const char *spec, uint64_t seed, json_t *list, struct reason *reason)
{
    struct world world;
    json_t *json = NULL;
    enum status status = world_open(spec, seed, &world, reason);
    if (status != STATUS_OK)
        return status;
    const struct scene *scene = world_only_scene(&world);
    if (scene)
        status = inform_scene(spec, scene, list ? &json : NULL, reason);
    else if (list)
        json = world_json(spec, &world);
    else
        world_print(spec, &world);
    if (!status && list && json_array_append_new(list, json) != 0)
        status = fail(reason, STATUS_MEMORY, "%s: no memory for the JSON", spec);
    world_free(&world);
    return status;
}

static int scene_info(const struct scene_options *options)
{
    if (options->argument_count == 0)
        return usage_error("scene", "info: no scene given");
    json_t *list = options->json ? json_array() : NULL;
    int code = EXIT_AGREE;
    for (int i = 0; i < options->argument_count; i++) {
        struct reason reason;
        enum status status = inform(options->argument[i], options->seed, list, &reason);
        code = exit_worse(code, exit_with_reason("scene", status, &reason));
    }
    if (!list)
        return code;
    json_t *whole = json_record("scenes=%p", list);
    if (json_dumpf(whole, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0)
        putchar('\n');
    json_decref(whole);
    return code;
}

static int is_shown(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

static void list_fetched(void)
{
    struct dirent **entry = NULL;
    int count = scandir(FETCHED, &entry, is_shown, alphasort);
    printf("\nfetched meshes (%s)\n", FETCHED);
    if (count <= 0)
        printf("  none here: `make scenes` fetches them\n");
    for (int i = 0; i < count; i++) {
        char path[sizeof FETCHED + 300];
        struct stat about;
        snprintf(path, sizeof path, "%s/%s", FETCHED, entry[i]->d_name);
        if (stat(path, &about) == 0)
            printf("  %-40s %9lld bytes\n", path, (long long)about.st_size);
        free(entry[i]);
    }
    free(entry);
}

/* A generator: its name, what it is, and its params. */
static void list_generator(const char *name, const char *summary, const struct param *param)
{
    putchar('\n');
    screen_line(13, "  %-10s %s\n", name, summary);
    for (size_t k = 0; k < GENERATOR_PARAMS && param[k].name; k++) {
        char range[64];
        snprintf(range, sizeof range, "%.9g to %.9g", param[k].least, param[k].most);
        screen_line(38, "    %-10s %-22s [%.9g] %s\n", param[k].name, range, param[k].value,
                    param[k].summary);
    }
}

/* What a generator of worlds makes of its defaults. */
static void list_made(const struct world_generator *generator)
{
    struct world world;
    struct reason reason;
    char shown[WORLD_SHOWN];
    if (world_open(generator->name, 1, &world, &reason) == STATUS_OK)
        printf("    (by default %s)\n", world_show(&world, shown));
    world_free(&world);
}

static int scene_list(const struct scene_options *options)
{
    if (options->argument_count != 0)
        return usage_error("scene", "list: takes no argument");
    screen_line(
        0, "generators, as NAME or NAME:PARAMETER=VALUE,PARAMETER=VALUE; each also takes seed=S");
    puts("(range of every parameter, and [default])");
    for (size_t i = 0; generators[i]; i++)
        list_generator(generators[i]->name, generators[i]->summary, generators[i]->param);
    printf("\ngenerators of worlds: meshes that are placed by instances\n");
    for (size_t i = 0; world_generators[i]; i++) {
        const struct world_generator *generator = world_generators[i];
        list_generator(generator->name, generator->summary, generator->param);
        list_made(generator);
    }
    list_fetched();
    return EXIT_AGREE;
}

static const struct {
    const char *name;
    int (*run)(const struct scene_options *options);
    const char *takes; /* the options that it takes */
} actions[] = {{"info", scene_info, "json seed"},
               {"convert", scene_convert, "bits seed"},
               {"list", scene_list, ""}};

#define ROWS_OF struct scene_options

static const struct option_row rows[] = {
    {"json", NULL, "info as one JSON object, {\"scenes\": [...]}", OF_FLAG(json)},
    {"bits", "N",
     "convert: moves the vertices of a scene to the nearest points of a grid of so many bits an "
     "axis, as --store quantised does, and tells how far",
     OF_COUNT(bits, QUANTISE_BITS_LEAST, QUANTISE_BITS_MOST)},
    SCENE_SEED_ROW(seed),
    {0},
};

static const struct option_set set = {
    .command = "scene",
    .usage = "scene info SCENE... [--json] [--seed S]\n"
             "scene convert SCENE FILE [--bits N] [--seed S]\n"
             "scene list",
    .about = "A SCENE is a mesh file (.json as RTRS writes it, .obj, .ply, .stl), a world file "
             "(.gltf, .glb, .json of raydiff; all also .gz) or a generator with parameters, such "
             "as soup:n=1000,seed=7. A world places meshes by instances.\n"
             "\n"
             "  info      triangles, vertices, bounds, zero-area and duplicate triangles, lights "
             "and more; of a world its meshes and instances\n"
             "  convert   reads SCENE and writes FILE, by its ending: .json, .obj, .ply "
             "(binary), .stl (binary), .gltf or .glb; coordinates and transforms keep every bit, "
             "triangles and instances their order. A scene as .json is RTRS's; a world, or a scene "
             "as .world.json, is raydiff's\n"
             "  list      the generators with their parameters, and the meshes that `make "
             "scenes` fetched",
    .group = {GROUP(rows)},
    .codes = "0, 2 bad input, 4 no memory",
    .example = "scene info sphere soup:n=1000\n"
               "scene convert terrain:k=6 terrain.ply\n"
               "scene convert crowd:n=100 crowd.glb\n"
               "scene convert sphere coarse.ply --bits 12",
};

static int run_action(size_t i, const struct scene_options *options)
{
    const struct option_use use = {.by = actions[i].name,
                                   .only = actions[i].takes,
                                   .scene = options->argument,
                                   .scene_count = (size_t)options->argument_count};
    int code = options_refused("scene", &use);
    return code < 0 ? actions[i].run(options) : code;
}

int cmd_scene(int argc, char **argv)
{
    struct scene_options options = {.argument_count = 0};
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("scene", "info, convert or list?");
    options.argument = argv + first + 1;
    options.argument_count = argc - first - 1;
    for (size_t i = 0; i < ARRAY_COUNT(actions); i++)
        if (strcmp(argv[first], actions[i].name) == 0)
            return run_action(i, &options);
    char hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(argv[first], strlen(argv[first]));
    for (size_t i = 0; i < ARRAY_COUNT(actions); i++)
        nearest_try(&nearest, actions[i].name);
    return usage_error("scene", "unknown action '%s'; those are info, convert, list%s", argv[first],
                       nearest_hint(&nearest, hint));
}
