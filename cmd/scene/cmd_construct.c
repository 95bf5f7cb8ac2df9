/* raydiff construct: meshes, materials, lights and a camera to a scene, as RTRS's construct. */
#include "cmd/scene/cmd_construct.h"

#include "cmd/common/cmd_tables.h"
#include "ref/base/command.h"
#include "scenes/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: raydiff construct --out FILE --model MESH IDX [TRANSFORMS] [--model ...]\n"
    "           --camera-pos X Y Z ATX ATY ATZ --camera-fixed|--camera-orbit [OPTIONS]\n"
    "Makes a scene of meshes. The options are RTRS's; numbers may be negative or have an\n"
    "exponent (-10, 2.5e-3), options come in any order, but for transforms.\n\n"
    "  --out FILE          scene JSON as RTRS writes it; or .obj, .ply: the triangles only\n"
    "  --model MESH IDX    .obj, .ply or .json, each also .gz, or a generator (soup:n=50); its\n"
    "                      triangles get material IDX, or the default one: 'default'; more\n"
    "                      models by more pairs or more --model\n"
    "  --camera-pos        where the camera is, and what it looks at\n"
    "  --camera-fixed, --camera-orbit    whether it can turn around what it looks at\n"
    "  --light X Y Z STRENGTH            as many as there are\n"
    "  --material R G B DIFFUSE SPECULAR REFLECTIVE EXPONENT    the first is 0, the next 1, ...\n"
    "The default material is RTRS's red. It comes behind those given, if a model asks for it;\n"
    "without --material it is 0.\n\n"
    "Transforms of the model named last, one after the other as they stand:\n"
    "  --translate X Y Z\n"
    "  --rotate AXIS DEGREES, --rotate X Y Z DEGREES    AXIS x, y or z, or any direction; through\n"
    "                      the origin, counter-clockwise as seen from the axis' tip\n"
    "  --scale S, --scale X Y Z          a negative factor mirrors\n"
    "  --matrix M11 M12 ... M44          4 rows of 4, for points as columns: the fourth column\n"
    "                      moves, the last row is 0 0 0 1\n"
    "A mirrored model's triangles are turned around, so that outside stays outside. Normals are\n"
    "angle-weighted, of the vertices as transformed.\n\n"
    "  --fill-normals      a vertex whose triangles give it no normal gets 0 1 0; else an error\n"
    "  --seed S            of generators whose text gives none                  [1]\n"
    "  --json              what was made as JSON on the standard output\n\n"
    "exit codes: 0 written, 2 bad input (nothing is written), 4 no memory\n"
    "example: raydiff construct --out two.json --camera-pos 0 1 -8 0 0 0 --camera-orbit \\\n"
    "             --light -20 20 -20 1.5 --material 0.4 0.4 0.3 0.6 0.3 0.1 50 \\\n"
    "             --model platonic:which=3 0 --model platonic:which=0 default --translate 2 0 0\n";

/* What an option takes: words of the command line, all that follow it up to the next option. */
struct words {
    const char *flag;
    char *const *word;
    size_t count;
};

static enum status take_numbers(const struct words *words, size_t first, size_t count, float *out,
                                struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = parse_float(words->flag, words->word[first + i], &out[i], reason);
    return status;
}

/* Room for one more; `array` may move. Returns the new element, zeroed, or NULL. */
static void *append(void **array, size_t *capacity, uint32_t *count, size_t size)
{
    if (array_reserve(array, capacity, (size_t)*count + 1, size))
        return NULL;
    return memset((char *)*array + (*count)++ * size, 0, size);
}

static enum status no_memory(const struct words *words, struct reason *reason)
{
    return fail(reason, STATUS_MEMORY, "%s: no memory", words->flag);
}

static enum status take_out(struct construct_options *o, const struct words *words,
                            struct reason *reason)
{
    if (o->out)
        return fail(reason, STATUS_INPUT, "--out: is given twice");
    if (strcmp(words->word[0], "-") == 0)
        return fail(reason, STATUS_INPUT, "--out: needs a file, not '-'");
    o->out = words->word[0];
    return STATUS_OK;
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

static enum status take_model(struct construct_options *o, const struct words *words,
                              struct reason *reason)
{
    struct construct *c = &o->construct;
    if (words->count == 0 || words->count % 2 != 0)
        return fail(
            reason, STATUS_INPUT,
            "--model: takes pairs of a mesh and a material's index, but %zu word%s follow%s",
            words->count, words->count == 1 ? "" : "s", words->count == 1 ? "s" : "");
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

static enum status take_position(struct construct_options *o, const struct words *words,
                                 struct reason *reason)
{
    struct camera *camera = &o->construct.camera;
    if (o->has_position)
        return fail(reason, STATUS_INPUT, "--camera-pos: is given twice");
    o->has_position = true;
    enum status status = take_numbers(words, 0, 3, camera->pos, reason);
    return status ? status : take_numbers(words, 3, 3, camera->at, reason);
}

static enum status take_kind(struct construct_options *o, const struct words *words,
                             struct reason *reason)
{
    bool orbit = strcmp(words->flag, "--camera-orbit") == 0;
    if (o->has_kind && o->construct.camera.orbit != orbit)
        return fail(reason, STATUS_INPUT, "--camera-fixed and --camera-orbit: one of them");
    o->has_kind = true;
    o->construct.camera.orbit = orbit;
    return STATUS_OK;
}

static enum status take_light(struct construct_options *o, const struct words *words,
                              struct reason *reason)
{
    void *lights = o->light;
    struct light *light =
        append(&lights, &o->light_capacity, &o->construct.light_count, sizeof *light);
    o->light = lights;
    if (!light)
        return no_memory(words, reason);
    enum status status = take_numbers(words, 0, 3, light->pos, reason);
    return status ? status : take_numbers(words, 3, 1, &light->strength, reason);
}

static enum status take_material(struct construct_options *o, const struct words *words,
                                 struct reason *reason)
{
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

/* "x", "y", "z" or three numbers, then degrees. */
static enum status make_rotation(const struct words *words, struct transform *out,
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

static enum status make_step(const struct words *words, struct transform *out,
                             struct reason *reason)
{
    float number[16];
    if (strcmp(words->flag, "--rotate") == 0)
        return make_rotation(words, out, reason);
    enum status status = take_numbers(words, 0, words->count, number, reason);
    if (status)
        return status;
    if (strcmp(words->flag, "--matrix") == 0)
        return transform_matrix(number, out, reason);
    if (strcmp(words->flag, "--translate") == 0) {
        *out = transform_translate(number);
        return STATUS_OK;
    }
    if (words->count == 1)
        number[1] = number[2] = number[0];
    return transform_scale(number, out, reason);
}

static enum status take_transform(struct construct_options *o, const struct words *words,
                                  struct reason *reason)
{
    struct construct *c = &o->construct;
    struct transform step;
    struct reason why;
    if (c->model_count == 0)
        return fail(reason, STATUS_INPUT, "%s: no --model stands before it", words->flag);
    if (make_step(words, &step, &why))
        return fail(reason, STATUS_INPUT, "%s%s%s",
                    strncmp(why.text, "--", 2) == 0 ? "" : words->flag,
                    strncmp(why.text, "--", 2) == 0 ? "" : ": ", why.text);
    struct transform *transform = &c->model[c->model_count - 1].transform;
    *transform = transform_then(transform, &step);
    return STATUS_OK;
}

static enum status take_other(struct construct_options *o, const struct words *words,
                              struct reason *reason)
{
    if (strcmp(words->flag, "--seed") == 0)
        return parse_count("--seed", words->word[0], 0, UINT64_MAX, &o->construct.seed, reason);
    o->json |= strcmp(words->flag, "--json") == 0;
    o->construct.fill_normals |= strcmp(words->flag, "--fill-normals") == 0;
    return STATUS_OK;
}

#define ANY_COUNT 99 /* take() says what it can be */

static const struct flag {
    const char *name;
    size_t count, or_count; /* of words; or_count 0: no other */
    const char *what;
    enum status (*take)(struct construct_options *o, const struct words *words,
                        struct reason *reason);
} flags[] = {
    {"--out", 1, 0, "a file", take_out},
    {"--model", ANY_COUNT, 0, "", take_model},
    {"--camera-pos", 6, 0, "6 numbers: position and target", take_position},
    {"--camera-fixed", 0, 0, "nothing", take_kind},
    {"--camera-orbit", 0, 0, "nothing", take_kind},
    {"--light", 4, 0, "4 numbers: position and strength", take_light},
    {"--material", 7, 0, "7 numbers: colour, albedo and exponent", take_material},
    {"--translate", 3, 0, "3 numbers", take_transform},
    {"--rotate", 2, 4, "an axis (x, y, z or 3 numbers) and degrees", take_transform},
    {"--scale", 1, 3, "1 or 3 numbers", take_transform},
    {"--matrix", 16, 0, "16 numbers", take_transform},
    {"--fill-normals", 0, 0, "nothing", take_other},
    {"--seed", 1, 0, "a number", take_other},
    {"--json", 0, 0, "nothing", take_other},
};

/* Options begin with two dashes; a negative number begins with one. */
static bool is_option(const char *word)
{
    return strncmp(word, "--", 2) == 0;
}

static enum status take_flag(struct construct_options *o, const struct words *words,
                             struct reason *reason)
{
    for (size_t i = 0; i < ARRAY_COUNT(flags); i++) {
        const struct flag *flag = &flags[i];
        if (strcmp(words->flag, flag->name) != 0)
            continue;
        bool fits = flag->count == ANY_COUNT || words->count == flag->count ||
                    (flag->or_count > 0 && words->count == flag->or_count);
        if (!fits)
            return fail(reason, STATUS_INPUT, "%s: takes %s, but %zu word%s follow%s", flag->name,
                        flag->what, words->count, words->count == 1 ? "" : "s",
                        words->count == 1 ? "s" : "");
        return flag->take(o, words, reason);
    }
    return fail(reason, STATUS_INPUT, "unknown option '%s'", words->flag);
}

/* getopt takes -10 for options, and options of several words are beyond it. */
static enum status take_all(struct construct_options *o, int argc, char **argv,
                            struct reason *reason)
{
    enum status status = STATUS_OK;
    int i = argc > 1 && strcmp(argv[1], "--") == 0 ? 2 : 1; /* the paper has it after cargo's own */
    if (i < argc && !is_option(argv[i]))
        return fail(reason, STATUS_INPUT, "unexpected argument '%s'", argv[i]);
    while (i < argc && !status) {
        struct words words = {.flag = argv[i], .word = argv + i + 1};
        char *value = strchr(argv[i], '=');
        if (value) { /* --out=FILE: the one word that follows it */
            *value++ = '\0';
            words.word = &value;
        }
        for (i++; i < argc && !is_option(argv[i]); i++)
            words.count++;
        if (value && words.count > 0)
            return fail(reason, STATUS_INPUT, "unexpected argument '%s'", argv[i - 1]);
        words.count += value != NULL;
        status = take_flag(o, &words, reason);
    }
    o->construct.material = o->material;
    o->construct.light = o->light;
    return status;
}

static enum status check_complete(const struct construct_options *o, struct reason *reason)
{
    if (!o->out)
        return fail(reason, STATUS_INPUT, "--out is missing");
    if (o->construct.model_count == 0)
        return fail(reason, STATUS_INPUT, "--model is missing");
    if (!o->has_position)
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
    if (!status && (fflush(stdout) != 0 || ferror(stdout)))
        status = fail(&reason, STATUS_INPUT, "cannot write to standard output");
    json_decref(json);
    scene_free(&scene);
    if (status)
        fprintf(stderr, "raydiff construct: %s%s\n", reason.text,
                notes.filled > 0 ? " (--fill-normals puts 0 1 0 there)" : "");
    return exit_of_status(status);
}

int cmd_construct(int argc, char **argv)
{
    struct construct_options options = {.construct = {.seed = 1}};
    struct reason reason = {""};
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            fputs(help, stdout);
            return EXIT_AGREE;
        }
    enum status status = take_all(&options, argc, argv, &reason);
    if (!status)
        status = check_complete(&options, &reason);
    int code = status ? usage_error("construct", "%s", reason.text) : construct(&options);
    free(options.construct.model);
    free(options.material);
    free(options.light);
    return code;
}
