#define _POSIX_C_SOURCE 200809L /* strcasecmp, stat */
#include "ref/base/nearest_name.h"
#include "ref/base/decimal.h"
#include "ref/files/file.h"
#include "scenes/read/formats.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const struct format {
    const char *ending;
    enum status (*read)(const char *name, const char *bytes, size_t size, struct scene *out,
                        struct reason *reason);
    enum status (*write)(const struct scene *scene, FILE *stream, struct reason *reason);
} formats[] = {
    {".json", read_rtrs, write_rtrs},
    {".obj", read_obj, write_obj},
    {".ply", read_ply, write_ply},
};

/* Whether `path` without its last `cut` bytes ends in `ending` (case ignored) after at least one
 * character. */
static bool ends_in(const char *path, size_t cut, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending) + cut;
    return length > tail && strncasecmp(path + length - tail, ending, strlen(ending)) == 0;
}

/* The format of a file name, by its ending; `zipped`: ".gz" may follow it. NULL if none. */
static const struct format *find_format(const char *path, bool zipped)
{
    size_t cut = zipped && ends_in(path, 0, ".gz") ? 3 : 0;
    for (size_t i = 0; i < ARRAY_COUNT(formats); i++)
        if (ends_in(path, cut, formats[i].ending))
            return &formats[i];
    return NULL;
}

enum status scene_read(const char *path, struct scene *out, struct reason *reason)
{
    *out = (struct scene){0};
    const struct format *format = find_format(path, true);
    struct stat about;
    if (!format && stat(path, &about) == 0 && S_ISDIR(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: is a directory", file_label(path));
    if (!format)
        return fail(reason, STATUS_INPUT,
                    "%s: unknown ending; scenes are .json (RTRS), .obj or .ply, each also .gz",
                    file_label(path));
    char *bytes;
    size_t size;
    enum status status = file_read(path, &bytes, &size, reason);
    if (status)
        return status;
    status = format->read(file_label(path), bytes, size, out, reason);
    free(bytes);
    return status;
}

enum status scene_write(const char *path, const struct scene *scene, struct reason *reason)
{
    const struct format *format = find_format(path, false);
    if (!format)
        return fail(reason, STATUS_INPUT,
                    "%s: unknown ending; scenes are written as .json (RTRS), .obj or .ply",
                    file_label(path));
    enum status status = scene_check(scene, reason);
    if (status)
        return status;
    struct file_out out;
    status = file_out_open(path, &out, reason);
    if (!status)
        status = format->write(scene, out.stream, reason);
    if (!status)
        return file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

/* Appends `word` to a comma-separated list, truncated to `size`. */
static void append(char *text, size_t size, const char *word)
{
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", used ? ", " : "", word);
}

static enum status unknown_scene(const char *spec, struct reason *reason)
{
    char known[120] = "", hint[NEAREST_HINT];
    struct nearest_name nearest = nearest_make(spec, strcspn(spec, ":"));
    for (size_t i = 0; generators[i]; i++) {
        append(known, sizeof known, generators[i]->name);
        nearest_try(&nearest, generators[i]->name);
    }
    return fail(reason, STATUS_INPUT,
                "unknown scene '%.80s': no file, and no generator; those are %s%s", spec, known,
                nearest_hint(&nearest, hint));
}

static enum status unknown_param(const struct generator *generator, const char *key, size_t length,
                                 struct reason *reason)
{
    char known[120] = "";
    for (size_t i = 0; i < GENERATOR_PARAMS && generator->param[i].name; i++)
        append(known, sizeof known, generator->param[i].name);
    append(known, sizeof known, "seed");
    return fail(reason, STATUS_INPUT, "%s: '%.*s' is no parameter; known are %s (as %s:NAME=VALUE)",
                generator->name, length > 40 ? 40 : (int)length, key, known, generator->name);
}

/* Reads the number of a param, which ends at the next comma. */
static enum status read_param(const struct generator *generator, const struct param *param,
                              const char *text, double *value, struct reason *reason)
{
    size_t length = strcspn(text, ",");
    const char *end = decimal_read_double(text, value);
    if (end == text + length && *value >= param->least && *value <= param->most)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: %s=%.*s must be a number from %.9g to %.9g (%s)",
                generator->name, param->name, length > 40 ? 40 : (int)length, text, param->least,
                param->most, param->summary);
}

static enum status read_seed(const struct generator *generator, const char *text, uint64_t *seed,
                             struct reason *reason)
{
    size_t length = strcspn(text, ",");
    uint64_t value = 0;
    bool good = length > 0;
    for (size_t i = 0; i < length && good; i++) {
        uint64_t digit = (uint64_t)(text[i] - '0');
        good = text[i] >= '0' && text[i] <= '9' && value <= (UINT64_MAX - digit) / 10;
        value = 10 * value + digit;
    }
    *seed = value;
    if (good)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: seed=%.*s must be a whole number from 0 to 2^64 - 1",
                generator->name, length > 40 ? 40 : (int)length, text);
}

/* Reads "key=value,key=value" into the values of the generator's params and the seed. */
static enum status read_params(const struct generator *generator, const char *text, double *value,
                               uint64_t *seed, struct reason *reason)
{
    bool given[GENERATOR_PARAMS + 1] = {false}; /* the last is the seed */
    while (text) {
        size_t length = strcspn(text, "=,"), which = 0;
        for (; which < GENERATOR_PARAMS && generator->param[which].name; which++)
            if (strlen(generator->param[which].name) == length &&
                memcmp(text, generator->param[which].name, length) == 0)
                break;
        bool known = which < GENERATOR_PARAMS && generator->param[which].name;
        if (!known && length == 4 && memcmp(text, "seed", 4) == 0)
            which = GENERATOR_PARAMS;
        else if (!known)
            return unknown_param(generator, text, length, reason);
        const char *number = text[length] == '=' ? text + length + 1 : "";
        enum status status =
            which == GENERATOR_PARAMS
                ? read_seed(generator, number, seed, reason)
                : read_param(generator, &generator->param[which], number, &value[which], reason);
        if (status)
            return status;
        if (given[which])
            return fail(reason, STATUS_INPUT, "%s: %.*s is given twice", generator->name,
                        (int)length, text);
        given[which] = true;
        text = strchr(text, ',');
        text = text ? text + 1 : NULL;
    }
    return STATUS_OK;
}

/* Runs a generator with the text after its name: "" or ":key=value,...". */
static enum status generate(const struct generator *generator, const char *params, uint64_t seed,
                            struct scene *out, struct reason *reason)
{
    double value[GENERATOR_PARAMS];
    for (size_t i = 0; i < GENERATOR_PARAMS; i++)
        value[i] = generator->param[i].name ? generator->param[i].value : 0;
    enum status status = STATUS_OK;
    if (*params == ':')
        status = read_params(generator, params + 1, value, &seed, reason);
    if (!status)
        status = generator_make(generator, value, seed, out, reason);
    if (status)
        return status;
    struct reason rule;
    status = scene_check(out, &rule);
    if (status) {
        scene_free(out);
        return fail(reason, status, "%s: %s", generator->name, rule.text);
    }
    return STATUS_OK;
}

enum status scene_open(const char *spec, uint64_t seed, struct scene *out, struct reason *reason)
{
    *out = (struct scene){0};
    size_t length = strcspn(spec, ":");
    for (size_t i = 0; generators[i]; i++)
        if (strlen(generators[i]->name) == length && memcmp(spec, generators[i]->name, length) == 0)
            return generate(generators[i], spec + length, seed, out, reason);
    struct stat about;
    if (!find_format(spec, true) && stat(spec, &about) != 0)
        return unknown_scene(spec, reason);
    return scene_read(spec, out, reason);
}
