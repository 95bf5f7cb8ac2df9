#include "fuzz/findings/finding_file.h"

#include "fuzz/findings/finding_file_scan.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

/* The least bytes of a line: numbers of one digit, blanks between them, the line's end. */
#define LEAST_LINE(numbers) (2 * (size_t)(numbers))

struct reader {
    struct scan scan;
    struct finding_file *file;
    struct reason *reason;
    uint32_t seen; /* bits of the lines that came */
};

typedef enum status line_fn(struct reader *reader);

static enum status unknown(struct reader *reader, const char *what, const char *word)
{
    return scan_fail(&reader->scan, reader->reason, "unknown %s '%.60s'", what, word);
}

static enum status read_expect(struct reader *reader)
{
    char word[FINDING_WORD_MOST];
    struct reason why;
    enum status status =
        finding_word(&reader->scan, "'clean' or a signature", word, reader->reason);
    if (status || strcmp(word, "clean") == 0)
        return status;
    if (fuzz_signature_parse(word, &reader->file->signature, &why))
        return scan_fail(&reader->scan, reader->reason, "%.180s", why.text);
    reader->file->has_signature = true;
    return STATUS_OK;
}

static enum status read_named_whole(struct reader *reader, const char *name, uint64_t most,
                                    uint64_t *out)
{
    enum status status = finding_keyword(&reader->scan, name, reader->reason);
    return status ? status : finding_whole(&reader->scan, name, most, out, reader->reason);
}

static enum status read_origin(struct reader *reader)
{
    struct fuzz_origin *origin = &reader->file->trial.origin;
    char word[FINDING_WORD_MOST];
    uint64_t version = 0;
    enum status status = read_named_whole(reader, "seed", UINT64_MAX, &origin->seed);
    if (!status)
        status = read_named_whole(reader, "index", UINT64_MAX, &origin->index);
    if (!status)
        status = read_named_whole(reader, "version", UINT32_MAX, &version);
    if (!status)
        status = finding_keyword(&reader->scan, "stream", reader->reason);
    if (!status)
        status = finding_word(&reader->scan, "gen or mut", word, reader->reason);
    if (status)
        return status;
    origin->version = (uint32_t)version;
    origin->mutated = strcmp(word, "mut") == 0;
    return origin->mutated || strcmp(word, "gen") == 0 ? STATUS_OK
                                                       : unknown(reader, "stream", word);
}

static enum status read_recipe(struct reader *reader)
{
    struct fuzz_origin *origin = &reader->file->trial.origin;
    return finding_text(&reader->scan, origin->recipe, sizeof origin->recipe, reader->reason);
}

static enum status read_with(struct reader *reader)
{
    char *text = reader->file->versions;
    size_t used = strlen(text), size = sizeof reader->file->versions;
    if (used > 0 && used + 2 < size)
        text[used++] = '\n';
    enum status status = finding_text(&reader->scan, text + used, size - used, reader->reason);
    if (!status && used > 0 && text[used] == '\0')
        text[used - 1] = '\0'; /* an empty line is none */
    return status;
}

static enum status read_builder(struct reader *reader)
{
    struct fuzz_trial *trial = &reader->file->trial;
    char word[FINDING_WORD_MOST];
    uint64_t leaf = 0;
    enum status status = finding_word(&reader->scan, "a builder", word, reader->reason);
    if (status)
        return status;
    trial->builder = builder_find(word);
    if (!trial->builder)
        return unknown(reader, "builder", word);
    status = read_named_whole(reader, "leaf", UINT32_MAX, &leaf);
    trial->build.leaf = (uint32_t)leaf;
    if (!status && leaf == 0)
        status = scan_fail(&reader->scan, reader->reason, "leaf is 1 or more");
    if (!status)
        status = finding_keyword(&reader->scan, "eps", reader->reason);
    if (!status)
        status = finding_float(&reader->scan, "eps", false, &trial->build.eps, reader->reason);
    if (!status && trial->build.eps < 0)
        status = scan_fail(&reader->scan, reader->reason, "eps is 0 or more");
    return status;
}

static enum status read_box(struct reader *reader)
{
    char word[FINDING_WORD_MOST];
    enum status status = finding_word(&reader->scan, "a box test", word, reader->reason);
    if (status)
        return status;
    reader->file->trial.box = box_test_find(word);
    return reader->file->trial.box ? STATUS_OK : unknown(reader, "box test", word);
}

static enum status read_tri(struct reader *reader)
{
    char word[FINDING_WORD_MOST];
    enum status status = finding_word(&reader->scan, "a triangle test", word, reader->reason);
    if (status)
        return status;
    reader->file->trial.tri = tri_test_find(word);
    return reader->file->trial.tri ? STATUS_OK : unknown(reader, "triangle test", word);
}

static enum status read_query(struct reader *reader)
{
    char word[FINDING_WORD_MOST];
    enum query query = QUERY_CLOSEST;
    enum status status = finding_word(&reader->scan, "closest or any", word, reader->reason);
    if (status)
        return status;
    if (!query_find(word, &query) || (query != QUERY_CLOSEST && query != QUERY_ANY))
        return unknown(reader, "query (closest or any)", word);
    reader->file->trial.query = query;
    return STATUS_OK;
}

static enum status read_store(struct reader *reader)
{
    char word[FINDING_WORD_MOST];
    enum status status = finding_word(&reader->scan, "a storage", word, reader->reason);
    if (status)
        return status;
    reader->file->trial.store = tri_store_find(word);
    return reader->file->trial.store ? STATUS_OK : unknown(reader, "storage", word);
}

static enum status read_optimize(struct reader *reader)
{
    uint64_t passes = 0;
    enum status status =
        finding_whole(&reader->scan, "passes", FUZZ_PASSES_MOST, &passes, reader->reason);
    reader->file->trial.build.passes = (uint32_t)passes;
    return status;
}

static enum status read_move(struct reader *reader)
{
    struct fuzz_trial *trial = &reader->file->trial;
    enum status status =
        finding_float(&reader->scan, "how far", false, &trial->move, reader->reason);
    if (!status && !(trial->move >= 0 && trial->move <= FUZZ_MOVE_MOST))
        status = scan_fail(&reader->scan, reader->reason, "how far is 0 to %g extents",
                           (double)FUZZ_MOVE_MOST);
    return status ? status : read_named_whole(reader, "seed", UINT64_MAX, &trial->move_seed);
}

static const struct {
    const char *name;
    line_fn *read;
    bool needed, many;
} settings[] = {
    {"expect", read_expect, true, false},  {"builder", read_builder, true, false},
    {"box", read_box, true, false},        {"tri", read_tri, true, false},
    {"query", read_query, true, false},    {"origin", read_origin, false, false},
    {"recipe", read_recipe, false, false}, {"with", read_with, false, true},
    {"store", read_store, false, false},   {"optimize", read_optimize, false, false},
    {"move", read_move, false, false},
};

/* All lines up to "vertices", of which the cursor is left in front. */
static enum status read_settings(struct reader *reader)
{
    for (;;) {
        char word[FINDING_WORD_MOST];
        finding_skip(&reader->scan);
        struct scan before = reader->scan;
        enum status status =
            finding_word(&reader->scan, "a setting or 'vertices'", word, reader->reason);
        if (status)
            return status;
        size_t i = 0;
        while (i < ARRAY_COUNT(settings) && strcmp(word, settings[i].name) != 0)
            i++;
        if (i == ARRAY_COUNT(settings)) {
            reader->scan = before;
            break;
        }
        if (reader->seen & 1u << i && !settings[i].many)
            return scan_fail(&before, reader->reason, "a second line '%s'", word);
        reader->seen |= 1u << i;
        status = settings[i].read(reader);
        if (!status)
            status = finding_line_end(&reader->scan, reader->reason);
        if (status)
            return status;
    }
    for (size_t i = 0; i < ARRAY_COUNT(settings); i++)
        if (settings[i].needed && !(reader->seen & 1u << i)) {
            char word[SCAN_SHOWN];
            return scan_fail(&reader->scan, reader->reason, "a line '%s' is needed before %s",
                             settings[i].name, scan_show(&reader->scan, word));
        }
    return STATUS_OK;
}

/* Reads "KEYWORD COUNT" and allocates COUNT elements of `size` bytes, each of which will be a line
 * of so many numbers. What the rest of the file cannot hold is refused before it is allocated. */
static enum status read_count(struct reader *reader, const char *keyword, uint32_t most,
                              int numbers, size_t size, uint32_t *count, void **array)
{
    struct scan *scan = &reader->scan;
    uint64_t value = 0;
    *count = 0;
    finding_skip(scan);
    enum status status = finding_keyword(scan, keyword, reader->reason);
    if (!status)
        status = finding_whole(scan, keyword, UINT64_MAX, &value, reader->reason);
    if (status)
        return status;
    if (value > (size_t)(scan->end - scan->at) / LEAST_LINE(numbers))
        return scan_fail(scan, reader->reason,
                         "%s: %llu of them do not fit into the rest of the file", keyword,
                         (unsigned long long)value);
    if (value > most)
        return fail(reader->reason, STATUS_LIMIT, "%s:%llu: a trial has at most %u %s", scan->name,
                    (unsigned long long)scan->line, most, keyword);
    *array = alloc_zeroed((size_t)value, size);
    if (!*array)
        return fail(reader->reason, STATUS_MEMORY, "%s: no memory for %llu %s", scan->name,
                    (unsigned long long)value, keyword);
    *count = (uint32_t)value;
    return finding_line_end(scan, reader->reason);
}

static enum status read_vertices(struct reader *reader)
{
    struct scene *scene = &reader->file->trial.scene;
    void *array = NULL;
    enum status status = read_count(reader, "vertices", 3 * FUZZ_TRIANGLES_MOST, 3,
                                    3 * sizeof *scene->vertex, &scene->vertex_count, &array);
    scene->vertex = array;
    for (size_t i = 0; i < scene->vertex_count && !status; i++) {
        static const char *const axis[] = {"x", "y", "z"};
        finding_skip(&reader->scan);
        for (size_t k = 0; k < 3 && !status; k++)
            status = finding_float(&reader->scan, axis[k], false, &scene->vertex[3 * i + k],
                                   reader->reason);
        if (!status)
            status = finding_line_end(&reader->scan, reader->reason);
    }
    return status;
}

static enum status read_triangles(struct reader *reader)
{
    struct scene *scene = &reader->file->trial.scene;
    void *array = NULL;
    enum status status = read_count(reader, "triangles", FUZZ_TRIANGLES_MOST, 3,
                                    3 * sizeof *scene->index, &scene->tri_count, &array);
    scene->index = array;
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count && !status; i++) {
        uint64_t index = 0;
        if (i % 3 == 0)
            finding_skip(&reader->scan);
        status = finding_whole(&reader->scan, "vertex index", UINT32_MAX, &index, reader->reason);
        if (!status && index >= scene->vertex_count)
            status = scan_fail(&reader->scan, reader->reason,
                               "vertex index %llu, but there are %u vertices",
                               (unsigned long long)index, scene->vertex_count);
        scene->index[i] = (uint32_t)index;
        if (!status && i % 3 == 2)
            status = finding_line_end(&reader->scan, reader->reason);
    }
    return status;
}

static enum status read_rays(struct reader *reader)
{
    static const char *const what[] = {"origin x",    "origin y",    "origin z", "direction x",
                                       "direction y", "direction z", "tmin",     "tmax"};
    struct fuzz_trial *trial = &reader->file->trial;
    void *array = NULL;
    enum status status = read_count(reader, "rays", FUZZ_RAYS_MOST, 8, sizeof *trial->ray,
                                    &trial->ray_count, &array);
    trial->ray = array;
    for (size_t i = 0; i < trial->ray_count && !status; i++) {
        struct ray *ray = &trial->ray[i];
        float *const to[] = {&ray->org[0], &ray->org[1], &ray->org[2], &ray->dir[0],
                             &ray->dir[1], &ray->dir[2], &ray->tmin,   &ray->tmax};
        finding_skip(&reader->scan);
        for (size_t k = 0; k < 8 && !status; k++)
            status = finding_float(&reader->scan, what[k], true, to[k], reader->reason);
        if (!status)
            status = finding_line_end(&reader->scan, reader->reason);
    }
    return status;
}

static enum status read_head(struct reader *reader)
{
    uint64_t version = 0;
    finding_skip(&reader->scan);
    enum status status = finding_keyword(&reader->scan, "raydiff", reader->reason);
    if (!status)
        status = finding_keyword(&reader->scan, "trial", reader->reason);
    if (!status)
        status =
            finding_whole(&reader->scan, "format version", UINT32_MAX, &version, reader->reason);
    if (!status && version != FINDING_FILE_VERSION)
        status =
            scan_fail(&reader->scan, reader->reason, "format version %llu; this program reads %d",
                      (unsigned long long)version, FINDING_FILE_VERSION);
    return status ? status : finding_line_end(&reader->scan, reader->reason);
}

static enum status read_end(struct reader *reader)
{
    finding_skip(&reader->scan);
    enum status status = finding_keyword(&reader->scan, "end", reader->reason);
    if (!status)
        status = finding_line_end(&reader->scan, reader->reason);
    if (status)
        return status;
    finding_skip(&reader->scan);
    if (reader->scan.at < reader->scan.end)
        return scan_fail(&reader->scan, reader->reason, "something follows 'end'");
    return STATUS_OK;
}

enum status finding_file_parse(const char *name, const char *bytes, size_t size,
                               struct finding_file *out, struct reason *reason)
{
    static line_fn *const parts[] = {read_head,      read_settings, read_vertices,
                                     read_triangles, read_rays,     read_end};
    struct reader reader = {scan_make(name, bytes, size), out, reason, 0};
    struct reason why;
    enum status status = STATUS_OK;
    *out = (struct finding_file){0};
    reader.scan.comment = '#';
    out->trial.store = tri_stores[0];
    for (size_t i = 0; i < ARRAY_COUNT(parts) && !status; i++)
        status = parts[i](&reader);
    if (!status) {
        status = fuzz_trial_check(&out->trial, &why);
        if (status)
            fail(reason, status, "%s: %.150s", name, why.text);
    }
    if (status)
        finding_file_free(out);
    return status;
}

enum status finding_file_read(const char *path, struct finding_file *out, struct reason *reason)
{
    char *bytes;
    size_t size;
    *out = (struct finding_file){0};
    enum status status = file_read_most(path, FINDING_FILE_MOST, &bytes, &size, reason);
    if (!status)
        status = finding_file_parse(file_label(path), bytes, size, out, reason);
    free(bytes);
    return status;
}

enum status finding_file_get(const struct folder *folder, const char *name,
                             struct finding_file *out, struct reason *reason)
{
    char *bytes, path[FOLDER_PATH_MOST];
    size_t size;
    *out = (struct finding_file){0};
    enum status status = folder_read(folder, name, FINDING_FILE_MOST, &bytes, &size, reason);
    folder_path(folder, name, path, sizeof path);
    if (!status)
        status = finding_file_parse(file_label(path), bytes, size, out, reason);
    free(bytes);
    return status;
}

void finding_file_free(struct finding_file *file)
{
    fuzz_trial_free(&file->trial);
    *file = (struct finding_file){0};
}
