#include "fuzz/findings/finding_file.h"

#include "fuzz/findings/finding_file_scan.h"
#include "fuzz/findings/finding_file_world.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Reads a part of the file, or what follows the first word of a setting. */
typedef void part_fn(struct finding_scan *in, struct finding_file *file);

/* Fails if the table has no member of that name. */
static void check_known(struct finding_scan *in, bool known, const char *what, const char *word)
{
    if (!in->status && !known)
        in->status = scan_fail(&in->scan, in->reason, "unknown %s '%.60s'", what, word);
}

static void read_expect(struct finding_scan *in, struct finding_file *file)
{
    char word[FINDING_WORD_MOST];
    struct reason why;
    finding_word(in, "'clean' or a signature", word);
    if (in->status || strcmp(word, "clean") == 0)
        return;
    if (fuzz_signature_parse(word, &file->signature, &why))
        in->status = scan_fail(&in->scan, in->reason, "%.180s", why.text);
    else
        file->has_signature = true;
}

static uint64_t named_whole(struct finding_scan *in, const char *name, uint64_t most)
{
    finding_keyword(in, name);
    return finding_whole(in, name, most);
}

static void read_origin(struct finding_scan *in, struct finding_file *file)
{
    struct fuzz_origin *origin = &file->trial.origin;
    char word[FINDING_WORD_MOST];
    origin->seed = named_whole(in, "seed", UINT64_MAX);
    origin->index = named_whole(in, "index", UINT64_MAX);
    origin->version = (uint32_t)named_whole(in, "version", UINT32_MAX);
    finding_keyword(in, "stream");
    finding_word(in, "gen or mut", word);
    origin->mutated = strcmp(word, "mut") == 0;
    check_known(in, origin->mutated || strcmp(word, "gen") == 0, "stream", word);
}

static void read_recipe(struct finding_scan *in, struct finding_file *file)
{
    finding_text(in, file->trial.origin.recipe, sizeof file->trial.origin.recipe);
}

static void read_with(struct finding_scan *in, struct finding_file *file)
{
    char *text = file->versions;
    size_t used = strlen(text), size = sizeof file->versions;
    if (used > 0 && used + 2 < size)
        text[used++] = '\n';
    finding_text(in, text + used, size - used);
    if (!in->status && used > 0 && text[used] == '\0')
        text[used - 1] = '\0'; /* an empty line is left out */
}

static void read_builder(struct finding_scan *in, struct finding_file *file)
{
    struct fuzz_trial *trial = &file->trial;
    char word[FINDING_WORD_MOST];
    finding_word(in, "a builder", word);
    trial->builder = builder_find(word);
    check_known(in, trial->builder, "builder", word);
    trial->build.leaf = (uint32_t)named_whole(in, "leaf", UINT32_MAX);
    if (!in->status && trial->build.leaf == 0)
        in->status = scan_fail(&in->scan, in->reason, "leaf is 1 or more");
    finding_keyword(in, "eps");
    trial->build.eps = finding_float(in, "eps", false);
    if (!in->status && trial->build.eps < 0)
        in->status = scan_fail(&in->scan, in->reason, "eps is 0 or more");
}

static void read_box(struct finding_scan *in, struct finding_file *file)
{
    char word[FINDING_WORD_MOST];
    finding_word(in, "a box test", word);
    file->trial.box = box_test_find(word);
    check_known(in, file->trial.box, "box test", word);
}

static void read_tri(struct finding_scan *in, struct finding_file *file)
{
    char word[FINDING_WORD_MOST];
    finding_word(in, "a triangle test", word);
    file->trial.tri = tri_test_find(word);
    check_known(in, file->trial.tri, "triangle test", word);
}

static void read_query(struct finding_scan *in, struct finding_file *file)
{
    char word[FINDING_WORD_MOST];
    enum query query = QUERY_CLOSEST;
    finding_word(in, "closest or any", word);
    bool known = query_find(word, &query) && (query == QUERY_CLOSEST || query == QUERY_ANY);
    check_known(in, known, "query (closest or any)", word);
    file->trial.query = query;
}

static void read_store(struct finding_scan *in, struct finding_file *file)
{
    char word[FINDING_WORD_MOST];
    finding_word(in, "a storage", word);
    file->trial.store = tri_store_find(word);
    check_known(in, file->trial.store, "storage", word);
}

static void read_optimize(struct finding_scan *in, struct finding_file *file)
{
    if (!in->status && file->trial.build.passes > 0)
        in->status = scan_fail(&in->scan, in->reason, "a tree is optimized in one way");
    file->trial.build.passes = (uint32_t)finding_whole(in, "passes", FUZZ_PASSES_MOST);
}

static void read_rotate(struct finding_scan *in, struct finding_file *file)
{
    read_optimize(in, file);
    file->trial.build.rotates = true;
}

static void read_presplit(struct finding_scan *in, struct finding_file *file)
{
    float share = file->trial.build.presplit = finding_float(in, "how many parts", false);
    if (!in->status && !(share >= 0 && share <= FUZZ_PRESPLIT_MOST))
        in->status = scan_fail(&in->scan, in->reason, "how many parts is 0 to %g of the triangles",
                               (double)FUZZ_PRESPLIT_MOST);
}

static void read_move(struct finding_scan *in, struct finding_file *file)
{
    float move = file->trial.move = finding_float(in, "how far", false);
    if (!in->status && !(move >= 0 && move <= FUZZ_MOVE_MOST))
        in->status =
            scan_fail(&in->scan, in->reason, "how far is 0 to %g extents", (double)FUZZ_MOVE_MOST);
    file->trial.move_seed = named_whole(in, "seed", UINT64_MAX);
}

static void read_steps(struct finding_scan *in, struct finding_file *file)
{
    char text[STEPS_TEXT_MOST];
    struct reason why;
    finding_text(in, text, sizeof text);
    if (!in->status && steps_parse(text, file->trial.step, &file->trial.step_count, &why))
        in->status = scan_fail(&in->scan, in->reason, "%.180s", why.text);
}

static void read_filter(struct finding_scan *in, struct finding_file *file)
{
    if (!in->status && !file->trial.world.is)
        in->status = scan_fail(&in->scan, in->reason, "filters are of worlds: format version %d",
                               FINDING_FILE_WORLD);
    finding_read_filter(in, file);
}

static const struct {
    const char *name;
    part_fn *read;
    bool needed, many;
} settings[] = {
    {"expect", read_expect, true, false},  {"builder", read_builder, true, false},
    {"box", read_box, true, false},        {"tri", read_tri, true, false},
    {"query", read_query, true, false},    {"origin", read_origin, false, false},
    {"recipe", read_recipe, false, false}, {"with", read_with, false, true},
    {"store", read_store, false, false},   {"optimize", read_optimize, false, false},
    {"move", read_move, false, false},     {"filter", read_filter, false, false},
    {"rotate", read_rotate, false, false}, {"presplit", read_presplit, false, false},
    {"steps", read_steps, false, false},
};

/* All lines before "vertices", which is left to be read. */
static void read_settings(struct finding_scan *in, struct finding_file *file)
{
    uint32_t seen = 0; /* a bit for each setting */
    while (!in->status) {
        char word[FINDING_WORD_MOST];
        finding_skip(in);
        struct scan before = in->scan;
        finding_word(in, "a setting or 'vertices'", word);
        size_t i = 0;
        while (i < ARRAY_COUNT(settings) && strcmp(word, settings[i].name) != 0)
            i++;
        if (i == ARRAY_COUNT(settings)) {
            in->scan = before;
            break;
        }
        if (seen & 1u << i && !settings[i].many)
            in->status = scan_fail(&before, in->reason, "a second line '%s'", word);
        seen |= 1u << i;
        settings[i].read(in, file);
        finding_line_end(in);
    }
    for (size_t i = 0; i < ARRAY_COUNT(settings) && !in->status; i++)
        if (settings[i].needed && !(seen & 1u << i)) {
            char word[SCAN_SHOWN];
            in->status = scan_fail(&in->scan, in->reason, "a line '%s' is needed before %s",
                                   settings[i].name, scan_show(&in->scan, word));
        }
}

static void read_vertices(struct finding_scan *in, struct finding_file *file)
{
    static const char *const axis[] = {"x", "y", "z"};
    struct scene *scene = &file->trial.scene;
    scene->vertex = finding_count(in, "vertices", 3 * FUZZ_TRIANGLES_MOST, 3,
                                  3 * sizeof *scene->vertex, &scene->vertex_count);
    for (size_t i = 0; i < scene->vertex_count && !in->status; i++) {
        finding_skip(in);
        for (size_t k = 0; k < 3; k++)
            scene->vertex[3 * i + k] = finding_float(in, axis[k], false);
        finding_line_end(in);
    }
}

static void read_triangles(struct finding_scan *in, struct finding_file *file)
{
    struct scene *scene = &file->trial.scene;
    scene->index = finding_count(in, "triangles", FUZZ_TRIANGLES_MOST, 3, 3 * sizeof *scene->index,
                                 &scene->tri_count);
    for (size_t i = 0; i < scene->tri_count && !in->status; i++) {
        finding_skip(in);
        for (size_t k = 0; k < 3; k++) {
            uint32_t index = (uint32_t)finding_whole(in, "vertex index", UINT32_MAX);
            if (!in->status && index >= scene->vertex_count)
                in->status =
                    scan_fail(&in->scan, in->reason, "vertex index %u, but there are %u vertices",
                              index, scene->vertex_count);
            scene->index[3 * i + k] = index;
        }
        finding_line_end(in);
    }
}

static void read_rays(struct finding_scan *in, struct finding_file *file)
{
    static const char *const what[] = {"origin x",    "origin y",    "origin z", "direction x",
                                       "direction y", "direction z", "tmin",     "tmax"};
    struct fuzz_trial *trial = &file->trial;
    struct ray_mode *mode = NULL;
    trial->ray = finding_count(in, "rays", FUZZ_RAYS_MOST, trial->world.is ? 10 : 8,
                               sizeof *trial->ray, &trial->ray_count);
    if (trial->world.is && !in->status)
        trial->world.mode = mode = alloc_zeroed(trial->ray_count, sizeof *mode);
    if (trial->world.is && !in->status && !mode)
        in->status = fail(in->reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
    for (size_t i = 0; i < trial->ray_count && !in->status; i++) {
        struct ray *ray = &trial->ray[i];
        float *const to[] = {&ray->org[0], &ray->org[1], &ray->org[2], &ray->dir[0],
                             &ray->dir[1], &ray->dir[2], &ray->tmin,   &ray->tmax};
        finding_skip(in);
        for (size_t k = 0; k < 8; k++)
            *to[k] = finding_float(in, what[k], true);
        if (mode)
            mode[i] = finding_read_mode(in);
        finding_line_end(in);
    }
}

static void read_head(struct finding_scan *in, struct finding_file *file)
{
    finding_skip(in);
    finding_keyword(in, "raydiff");
    finding_keyword(in, "trial");
    uint64_t version = finding_whole(in, "format version", UINT32_MAX);
    file->trial.world.is = version == FINDING_FILE_WORLD;
    if (file->trial.world.is)
        file->trial.world.filter.share = 128;
    if (!in->status && version != FINDING_FILE_VERSION && version != FINDING_FILE_WORLD)
        in->status =
            scan_fail(&in->scan, in->reason, "format version %llu; this program reads %d and %d",
                      (unsigned long long)version, FINDING_FILE_VERSION, FINDING_FILE_WORLD);
    finding_line_end(in);
}

static void read_end(struct finding_scan *in, struct finding_file *file)
{
    (void)file;
    finding_skip(in);
    finding_keyword(in, "end");
    finding_line_end(in);
    finding_skip(in);
    if (!in->status && in->scan.at < in->scan.end)
        in->status = scan_fail(&in->scan, in->reason, "something follows 'end'");
}

enum status finding_file_parse(const char *name, const char *bytes, size_t size,
                               struct finding_file *out, struct reason *reason)
{
    static part_fn *const parts[] = {read_head,      read_settings,      read_vertices,
                                     read_triangles, finding_read_world, read_rays,
                                     read_end};
    struct finding_scan in = {scan_make(name, bytes, size), reason, STATUS_OK};
    struct reason why;
    *out = (struct finding_file){0};
    in.scan.comment = '#';
    out->trial.store = tri_stores[0];
    for (size_t i = 0; i < ARRAY_COUNT(parts); i++)
        parts[i](&in, out);
    if (!in.status) {
        in.status = fuzz_trial_check(&out->trial, &why);
        if (in.status)
            fail(reason, in.status, "%s: %.150s", name, why.text);
    }
    if (in.status)
        finding_file_free(out);
    return in.status;
}

enum status finding_file_read(const char *path, struct finding_file *out, struct reason *reason)
{
    char *bytes;
    size_t size;
    struct stat about;
    *out = (struct finding_file){0};
    if (stat(path, &about) == 0 && S_ISDIR(about.st_mode))
        return fail(
            reason, STATUS_INPUT,
            "%s: is a directory; of a folder of findings name one, as in %s/*/smallest.trial", path,
            path);
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
