#define _POSIX_C_SOURCE 200809L
#include "cmd/bench/cmd_bench.h"

#include "bench/chart/csv.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/outside/shared_object.h"
#include "scenes/scenes.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

void bench_worse(struct bench *bench, int code)
{
    if (code <= 128 && bench->code <= 128)
        bench->code = exit_worse(bench->code, code);
    else if (bench->code == EXIT_AGREE)
        bench->code = code;
}

void bench_failed(struct bench *bench, const char *spec, enum status status,
                  const struct reason *reason)
{
    if (status == STATUS_OK)
        return;
    const char *why = reason->text[0] ? reason->text : status_text(status);
    size_t name = spec ? strcspn(spec, ":") : 0; /* a generator's name without parameters */
    bool named = !spec || (strncmp(why, spec, name) == 0 && why[name] == ':');
    fprintf(stderr, "raydiff bench: %s%s%s\n", named ? "" : spec, named ? "" : ": ", why);
    bench_worse(bench, exit_of_status(status));
}

size_t bench_members(enum table table, const struct list *named, const char *const *own,
                     const void *out[LIST_MOST])
{
    size_t count = 0;
    const char *name;
    for (; count < named->count; count++)
        out[count] = table_pointer(table, named->index[count]);
    for (size_t k = 0; named->count == 0 && own[k]; k++)
        for (size_t i = 0; (name = table_member(table, i, NULL)) != NULL; i++)
            if (strcmp(name, own[k]) == 0)
                out[count++] = table_pointer(table, i);
    return count;
}

static bool names(enum table table, const struct list *list, const void *member)
{
    for (size_t i = 0; i < list->count; i++)
        if (table_pointer(table, list->index[i]) == member)
            return true;
    return false;
}

void bench_left_out(struct bench *bench, const struct layout *layout, const struct tri_store *store,
                    enum status status)
{
    if (status == STATUS_LIMIT &&
        (names(TABLE_LAYOUTS, &bench->layout, layout) || names(TABLE_STORES, &bench->store, store)))
        bench_worse(bench, exit_of_status(status));
}

const char *bench_engine_name(const struct engine *engine, char text[BENCH_ENGINE_NAME])
{
    const char *path = file_of_engine(engine->name);
    const char *file = path ? strrchr(path, '/') : NULL;
    snprintf(text, BENCH_ENGINE_NAME, "%.*s%.20s", path ? (int)(path - engine->name) : 0,
             engine->name,
             file   ? file + 1
             : path ? path
                    : engine->name);
    return text;
}

/* Adds the scenes of a ';'-separated text and returns their number. Skips files that were not
 * fetched. Modifies the text. */
static size_t add_scenes(char *text, const char *out[BENCH_SCENES])
{
    size_t count = 0;
    for (char *at = strtok(text, ";"); at; at = strtok(NULL, ";")) {
        if (strchr(at, '/') && access(at, R_OK) != 0)
            printf("%s: left out, not fetched (make scenes)\n", at);
        else
            out[count++] = at;
    }
    return count;
}

static enum status play_one(struct bench *bench, const struct benchmark *benchmark,
                            const char *spec, struct reason *reason)
{
    struct scene scene;
    enum status status = scene_open(spec, bench->seed, &scene, reason);
    if (!status && benchmark->triangles && scene.tri_count == 0)
        status = fail(reason, STATUS_INPUT, "no triangles");
    if (!status)
        status = benchmark->play(bench, spec, &scene, reason);
    scene_free(&scene);
    return status;
}

int bench_each(struct bench *bench, const struct benchmark *benchmark)
{
    const char *own[BENCH_SCENES], *const *spec = bench->scene;
    size_t count = bench->scene_count;
    char scenes[200], made[200];
    snprintf(scenes, sizeof scenes, "%s", benchmark->scenes);
    snprintf(made, sizeof made, "%s", benchmark->made ? benchmark->made : "");
    if (benchmark->titled)
        printf("\n%s\n", benchmark->name);
    if (count == 0) {
        spec = own;
        count = add_scenes(scenes, own);
        count = count ? count : add_scenes(made, own);
    }
    for (size_t i = 0; i < count; i++) {
        struct reason reason = {""};
        enum status status = play_one(bench, benchmark, spec[i], &reason);
        progress_end(&bench->progress);
        bench_failed(bench, spec[i], status, &reason);
        fflush(stdout);
    }
    return bench->code;
}

int bench_on_core(struct bench *bench, const struct benchmark *benchmark)
{
    if (bench->engines.threads == 0)
        bench->engines.threads = 1;
    printf("\n%s: %u thread%s, %s\n", benchmark->name, bench->engines.threads,
           plural(bench->engines.threads),
           bench->engines.threads == 1 ? "the core's own time" : "time on the wall");
    return bench_each(bench, benchmark);
}

size_t bench_rays_count(const struct bench *bench, size_t own)
{
    return bench->ray_count ? (size_t)bench->ray_count : own;
}

const char *bench_tree_name(const struct bench *bench, char text[BENCH_TREE_NAME])
{
    if (bench->bvh)
        snprintf(text, BENCH_TREE_NAME, "tree %.100s", file_label(bench->bvh));
    else
        snprintf(text, BENCH_TREE_NAME, "builder %s, leaf %u", builders[0]->name,
                 BUILD_LEAF_DEFAULT);
    return text;
}

enum status bench_tree_open(const struct bench *bench, const struct scene *scene,
                            struct tree_file *out, struct reason *reason)
{
    *out = (struct tree_file){0};
    if (!bench->bvh)
        return STATUS_OK;
    enum status status = tree_open("bench", bench->bvh, scene, out, reason);
    if (status || !tree_file_is_packed(out))
        return status;
    tree_file_free(out);
    return fail(reason, STATUS_INPUT, "%s: is packed; layouts are compared on a tree as JSON",
                file_label(bench->bvh));
}

enum status bench_tree_make(const struct bench *bench, const struct scene *scene, struct bvh *out,
                            struct reason *reason)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    struct tree_file file;
    *out = (struct bvh){0};
    if (!bench->bvh)
        return bvh_build(builders[0], scene, &build, out, reason);
    enum status status = bench_tree_open(bench, scene, &file, reason);
    if (!status)
        status = tree_file_bvh(&file, scene, out, reason);
    tree_file_free(&file);
    return status;
}

static void csv_value(FILE *stream, const json_t *value)
{
    if (json_is_string(value))
        csv_text(stream, json_string_value(value));
    else if (json_is_integer(value))
        fprintf(stream, "%lld", (long long)json_integer_value(value));
    else if (json_is_real(value))
        fprintf(stream, "%.9g", json_real_value(value));
    else if (json_is_boolean(value))
        fputs(json_is_true(value) ? "true" : "false", stream);
}

void bench_row(struct bench *bench, const struct benchmark *benchmark, json_t *row)
{
    FILE *stream = bench->csv.stream;
    const char *name;
    bench->row_count += row != NULL;
    json_t *value;
    if (row && stream && bench->csv_head != benchmark->name) {
        fputs("benchmark", stream);
        json_object_foreach(row, name, value) fprintf(stream, ",%s", name);
        fputc('\n', stream);
        bench->csv_head = benchmark->name;
    }
    if (row && stream) {
        fputs(benchmark->name, stream);
        json_object_foreach(row, name, value)
        {
            fputc(',', stream);
            csv_value(stream, value);
        }
        fputc('\n', stream);
    }
    if (row && bench->rows) {
        json_add(row, "benchmark=%s", benchmark->name);
        json_array_append(bench->rows, row);
    }
    json_decref(row);
}
