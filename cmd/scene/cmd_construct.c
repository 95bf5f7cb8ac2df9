/* raydiff construct: makes a scene of meshes, materials, lights and a camera, like RTRS's
 * construct. */
#include "cmd/scene/cmd_construct.h"

#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_progress.h"
#include "ref/base/command.h"
#include "scenes/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum status take_numbers(const struct option_value *words, size_t first, size_t count,
                                float *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    char flag[24];
    snprintf(flag, sizeof flag, "--%s", words->row->name);
    for (size_t i = 0; i < count && !status; i++)
        status = parse_float(flag, words->word[first + i], &out[i], reason);
    return status;
}

/* Appends a zeroed element and returns it, or NULL without memory. `array` may move. */
static void *append(void **array, size_t *capacity, uint32_t *count, size_t size)
{
    if (array_reserve(array, capacity, (size_t)*count + 1, size))
        return NULL;
    return memset((char *)*array + (*count)++ * size, 0, size);
}

static enum status no_memory(const struct option_value *words, struct reason *reason)
{
    return fail(reason, STATUS_MEMORY, "--%s: no memory", words->row->name);
}

static enum status take_material_index(const char *text, uint32_t *out, struct reason *reason)
{
    uint64_t index = 0;
    *out = CONSTRUCT_DEFAULT;
    if (strcmp(text, "default") == 0)
        return STATUS_OK;
    if (parse_count("--model", text, 0, INT32_MAX - 1, &index, NULL))
        return fail(reason, STATUS_INPUT,
                    "--model: '%s' is neither a material's index nor 'default'", text);
    *out = (uint32_t)index;
    return STATUS_OK;
}

static enum status take_model(void *options, const struct option_value *words,
                              struct reason *reason)
{
    struct construct_options *o = options;
    struct construct *c = &o->construct;
    if (words->count == 0 || words->count % 2 != 0)
        return fail(
            reason, STATUS_INPUT,
            "--model: takes pairs of a mesh and a material's index, but %zu word%s follow%s",
            words->count, plural(words->count), words->count == 1 ? "s" : "");
    for (size_t i = 0; i < words->count; i += 2) {
        void *models = c->model;
        struct construct_model *model =
            append(&models, &o->model_capacity, &c->model_count, sizeof *model);
        c->model = models;
        if (!model)
            return no_memory(words, reason);
        model->spec = words->word[i];
        model->transform = transform_identity();
        enum status status = take_material_index(words->word[i + 1], &model->material, reason);
        if (status)
            return status;
    }
    return STATUS_OK;
}

static enum status take_position(void *options, const struct option_value *words,
                                 struct reason *reason)
{
    struct construct_options *o = options;
    struct camera *camera = &o->construct.camera;
    enum status status = take_numbers(words, 0, 3, camera->pos, reason);
    return status ? status : take_numbers(words, 3, 3, camera->at, reason);
}

static enum status take_kind(void *options, const struct option_value *words, struct reason *reason)
{
    struct construct_options *o = options;
    bool orbit = strcmp(words->row->name, "camera-orbit") == 0;
    if (o->has_kind && o->construct.camera.orbit != orbit)
        return fail(reason, STATUS_INPUT, "--camera-fixed and --camera-orbit: one of them");
    o->has_kind = true;
    o->construct.camera.orbit = orbit;
    return STATUS_OK;
}

static enum status take_light(void *options, const struct option_value *words,
                              struct reason *reason)
{
    struct construct_options *o = options;
    void *lights = o->light;
    struct light *light =
        append(&lights, &o->light_capacity, &o->construct.light_count, sizeof *light);
    o->light = lights;
    if (!light)
        return no_memory(words, reason);
    enum status status = take_numbers(words, 0, 3, light->pos, reason);
    return status ? status : take_numbers(words, 3, 1, &light->strength, reason);
}

static enum status take_material(void *options, const struct option_value *words,
                                 struct reason *reason)
{
    struct construct_options *o = options;
    void *materials = o->material;
    struct material *material =
        append(&materials, &o->material_capacity, &o->construct.material_count, sizeof *material);
    o->material = materials;
    if (!material)
        return no_memory(words, reason);
    enum status status = take_numbers(words, 0, 3, material->color, reason);
    if (!status)
        status = take_numbers(words, 3, 3, material->albedo, reason);
    return status ? status : take_numbers(words, 6, 1, &material->spec, reason);
}

/* Reads an axis ("x", "y", "z" or three numbers), then degrees. */
static enum status make_rotation(const struct option_value *words, struct transform *out,
                                 struct reason *reason)
{
    float axis[3] = {0}, degrees;
    const char *name = words->word[0];
    if (words->count == 2 && (name[0] < 'x' || name[0] > 'z' || name[1]))
        return fail(reason, STATUS_INPUT, "'%s' is not x, y or z", name);
    if (words->count == 2)
        axis[name[0] - 'x'] = 1;
    enum status status = words->count == 2 ? STATUS_OK : take_numbers(words, 0, 3, axis, reason);
    if (!status)
        status = take_numbers(words, words->count - 1, 1, &degrees, reason);
    return status ? status : transform_rotate(axis, degrees, out, reason);
}

static enum status make_step(const struct option_value *words, struct transform *out,
                             struct reason *reason)
{
    float number[16];
    if (strcmp(words->row->name, "rotate") == 0)
        return make_rotation(words, out, reason);
    enum status status = take_numbers(words, 0, words->count, number, reason);
    if (status)
        return status;
    if (strcmp(words->row->name, "matrix") == 0)
        return transform_matrix(number, out, reason);
    if (strcmp(words->row->name, "translate") == 0) {
        *out = transform_translate(number);
        return STATUS_OK;
    }
    if (words->count == 1)
        number[1] = number[2] = number[0];
    return transform_scale(number, out, reason);
}

static enum status take_transform(void *options, const struct option_value *words,
                                  struct reason *reason)
{
    struct construct_options *o = options;
    struct construct *c = &o->construct;
    struct transform step;
    struct reason why;
    if (c->model_count == 0)
        return fail(reason, STATUS_INPUT, "--%s: must follow a --model", words->row->name);
    if (make_step(words, &step, &why))
        return strncmp(why.text, "--", 2) == 0
                   ? fail(reason, STATUS_INPUT, "%s", why.text)
                   : fail(reason, STATUS_INPUT, "--%s: %s", words->row->name, why.text);
    struct transform *transform = &c->model[c->model_count - 1].transform;
    *transform = transform_then(transform, &step);
    return STATUS_OK;
}

#define OF_WORDS(function, count, or_count, text)                                                  \
    OF_OWN(function), .least = count, .most = or_count, .words = text

#define ROWS_OF struct construct_options

static const struct option_row rows[] = {
    {"out", "FILE", "scene JSON as RTRS writes it; or .obj, .ply, .stl: the triangles only",
     OF_OUTPUT(out)},
    {"model", "MESH IDX",
     ".obj, .ply, .stl or .json, each also .gz, or a generator (soup:n=50); its triangles get "
     "material IDX, or the default one: 'default'; more models by more pairs or more --model",
     OF_OWN(take_model), .repeats = true},
    {"camera-pos", "X Y Z ATX ATY ATZ", "where the camera is, and what it looks at",
     OF_WORDS(take_position, 6, 0, "6 numbers: position and target")},
    {"camera-fixed", NULL, "the camera cannot turn around what it looks at", OF_ACT(take_kind)},
    {"camera-orbit", NULL, "it can", OF_ACT(take_kind)},
    {"light", "X Y Z STRENGTH", "as many as there are",
     OF_WORDS(take_light, 4, 0, "4 numbers: position and strength"), .repeats = true},
    {"material", "R G B DIFFUSE SPECULAR REFLECTIVE EXPONENT",
     "the first is 0, the next 1, ...; the default material is the red of RTRS, behind those "
     "given, if a model asks for it",
     OF_WORDS(take_material, 7, 0, "7 numbers: colour, albedo and exponent"), .repeats = true},
    {"fill-normals", NULL,
     "a vertex whose triangles give it no normal gets 0 1 0; else it is an error",
     OF_FLAG(construct.fill_normals)},
    SCENE_SEED_ROW(construct.seed),
    {"json", NULL, "what was made as JSON on the standard output", OF_FLAG(json)},
    {0},
};

static const struct option_row transform_rows[] = {
    {"translate", "X Y Z", "moves it", OF_WORDS(take_transform, 3, 0, "3 numbers"),
     .repeats = true},
    {"rotate", "AXIS DEGREES",
     "AXIS is x, y, z or any direction X Y Z; through the origin, counter-clockwise as seen from "
     "the axis' tip",
     OF_WORDS(take_transform, 2, 4, "an axis (x, y, z or 3 numbers) and degrees"), .repeats = true},
    {"scale", "S", "or X Y Z; a negative factor mirrors",
     OF_WORDS(take_transform, 1, 3, "1 or 3 numbers"), .repeats = true},
    {"matrix", "M11 M12 ... M44",
     "4 rows of 4, for points as columns: the fourth column moves, the last row is 0 0 0 1",
     OF_WORDS(take_transform, 16, 0, "16 numbers"), .repeats = true},
    {0},
};

static const struct option_set set = {
    .command = "construct",
    .usage = "construct --out FILE --model MESH IDX [TRANSFORMS] [--model ...] --camera-pos X Y Z "
             "ATX ATY ATZ --camera-fixed|--camera-orbit [OPTIONS]",
    .about = "Makes a scene of meshes. The options are those of RTRS; numbers may be negative or "
             "have an exponent (-10, 2.5e-3), options come in any order, but for transforms.",
    .group = {GROUP(rows),
              {.row = transform_rows,
               .title = "Transforms of the model named last, in their order:"}},
    .notes = "A mirrored model's triangles are turned around, so that outside stays outside. "
             "Normals are angle-weighted, of the vertices as transformed.",
    .codes = "0 written, 2 bad input (nothing is written), 4 no memory",
    .example = "construct --out two.json --camera-pos 0 1 -8 0 0 0 --camera-orbit --light -20 20 "
               "-20 1.5 --material 0.4 0.4 0.3 0.6 0.3 0.1 50 --model platonic:which=3 0 --model "
               "platonic:which=0 default --translate 2 0 0",
    .words = true,
};

static enum status check_complete(const struct construct_options *o, struct reason *reason)
{
    if (!o->out)
        return fail(reason, STATUS_INPUT, "--out is missing");
    if (o->construct.model_count == 0)
        return fail(reason, STATUS_INPUT, "--model is missing");
    if (!option_was_given("camera-pos"))
        return fail(reason, STATUS_INPUT, "--camera-pos is missing");
    if (!o->has_kind)
        return fail(reason, STATUS_INPUT, "--camera-fixed or --camera-orbit is missing");
    return STATUS_OK;
}

static void step(void *user, const char *spec)
{
    progress_step(user, "reading %s", spec);
}

static int construct(struct construct_options *o)
{
    struct progress progress = progress_make("construct");
    struct scene scene;
    struct construct_notes notes;
    struct reason reason = {""};
    o->construct.step = step;
    o->construct.user = &progress;
    enum status status = construct_scene(&o->construct, &scene, &notes, &reason);
    json_t *json = NULL;
    if (!status && o->json)
        status = construct_json(o, &scene, &notes, &json, &reason);
    if (!status)
        progress_step(&progress, "writing %s", o->out);
    if (!status)
        status = scene_write(o->out, &scene, &reason);
    progress_end(&progress);
    if (!status && json && json_dumpf(json, stdout, JSON_INDENT(1)) == 0)
        putchar('\n');
    if (!status && !json)
        construct_print(o, &scene, &notes);
    json_decref(json);
    scene_free(&scene);
    if (status)
        fprintf(stderr, "raydiff construct: %s%s\n", reason.text,
                notes.filled > 0 ? " (--fill-normals puts 0 1 0 there)" : "");
    return exit_of_status(status);
}

int cmd_construct(int argc, char **argv)
{
    struct construct_options options = {.json = false};
    struct reason reason = {""};
    const bool of_paper = argc > 1 && strcmp(argv[1], "--") == 0; /* as after "cargo run" */
    int first, code = options_read(&set, &options, argc - of_paper, argv + of_paper, &first);
    if (code < 0 && first < argc - of_paper)
        code = usage_error("construct", "unexpected argument '%s'", argv[of_paper + first]);
    if (code < 0 && check_complete(&options, &reason))
        code = usage_error("construct", "%s", reason.text);
    options.construct.material = options.material;
    options.construct.light = options.light;
    if (code < 0)
        code = construct(&options);
    free(options.construct.model);
    free(options.material);
    free(options.light);
    return code;
}
