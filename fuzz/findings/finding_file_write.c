#define _POSIX_C_SOURCE 200809L
#include "fuzz/findings/finding_file_world.h"

#include "ref/base/float_word.h"
#include "ref/base/decimal.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

/* Writes one line of text, printable ASCII only, blanks around it left out; nothing if that leaves
 * none. Returns what follows the line. */
static const char *put_text(const char *keyword, const char *text, FILE *to)
{
    size_t length = strcspn(text, "\n"), from = 0;
    const char *next = text + length + (text[length] == '\n');
    while (length > from && (unsigned char)text[length - 1] <= ' ')
        length--;
    while (from < length && (unsigned char)text[from] <= ' ')
        from++;
    if (from < length)
        fprintf(to, "%s ", keyword);
    for (size_t i = from; i < length; i++)
        fputc(text[i] >= 0x20 && text[i] <= 0x7E ? text[i] : '?', to);
    if (from < length)
        fputc('\n', to);
    return next;
}

void finding_put_decimal(float x, FILE *to)
{
    char text[DECIMAL_TEXT];
    if (float_is_finite(x)) {
        decimal_write_float(x, text);
        fputs(text, to);
    } else {
        fputs(x > 0 ? "inf" : x < 0 ? "-inf" : "nan", to);
    }
}

void finding_put_float(float x, FILE *to)
{
    char text[FLOAT_WORD_MOST];
    float_word_write(x, text);
    fprintf(to, "%-15s ", text);
}

/* Hexadecimal in columns, what a ray may meet unless NULL, decimals behind. */
static void put_numbers(const float *x, int count, const struct ray_mode *mode, FILE *to)
{
    for (int i = 0; i < count; i++)
        finding_put_float(x[i], to);
    if (mode)
        fprintf(to, "%u %u ", mode->mask, mode->flags);
    fputc('#', to);
    for (int i = 0; i < count; i++) {
        fputc(' ', to);
        finding_put_decimal(x[i], to);
    }
    fputc('\n', to);
}

static void put_head(const struct finding_file *file, FILE *to)
{
    const struct fuzz_trial *trial = &file->trial;
    const struct fuzz_origin *origin = &trial->origin;
    char text[FUZZ_SIGNATURE_MOST] = "clean", eps[FLOAT_WORD_MOST];
    if (file->has_signature)
        fuzz_signature_print(&file->signature, text);
    fprintf(to, "raydiff trial %d\n", trial->world.is ? FINDING_FILE_WORLD : FINDING_FILE_VERSION);
    fprintf(to, "expect %s\n", text);
    fprintf(to, "origin seed %llu index %llu version %u stream %s\n",
            (unsigned long long)origin->seed, (unsigned long long)origin->index, origin->version,
            origin->mutated ? "mut" : "gen");
    put_text("recipe", origin->recipe, to);
    for (const char *line = file->versions; *line;)
        line = put_text("with", line, to);
    float_word_write(trial->build.eps, eps);
    fprintf(to, "builder %s leaf %u eps %s # ", trial->builder->name, trial->build.leaf, eps);
    finding_put_decimal(trial->build.eps, to);
    fprintf(to, "\nbox %s\ntri %s\nquery %s\n", trial->box->name, trial->tri->name,
            query_name(trial->query));
    if (trial->store != tri_stores[0])
        fprintf(to, "store %s\n", trial->store->name);
    if (trial->build.passes > 0)
        fprintf(to, "%s %u\n", trial->build.rotates ? "rotate" : "optimize", trial->build.passes);
    if (trial->build.presplit > 0) {
        char share[FLOAT_WORD_MOST];
        float_word_write(trial->build.presplit, share);
        fprintf(to, "presplit %s # ", share);
        finding_put_decimal(trial->build.presplit, to);
        fputc('\n', to);
    }
    if (trial->move > 0) {
        char move[FLOAT_WORD_MOST];
        float_word_write(trial->move, move);
        fprintf(to, "move %s seed %llu # ", move, (unsigned long long)trial->move_seed);
        finding_put_decimal(trial->move, to);
        fputc('\n', to);
    }
    if (trial->step_count > 0) {
        char steps[STEPS_TEXT_MOST];
        steps_write(trial->step, trial->step_count, steps);
        fprintf(to, "steps %s\n", steps);
    }
    if (trial->world.is)
        finding_put_filter(&trial->world, to);
}

static void put_body(const struct fuzz_trial *trial, FILE *to)
{
    const struct scene *scene = &trial->scene;
    fprintf(to, "vertices %u\n", scene->vertex_count);
    for (size_t i = 0; i < scene->vertex_count; i++)
        put_numbers(scene->vertex + 3 * i, 3, NULL, to);
    fprintf(to, "triangles %u\n", scene->tri_count);
    for (size_t i = 0; i < scene->tri_count; i++)
        fprintf(to, "%u %u %u\n", scene->index[3 * i], scene->index[3 * i + 1],
                scene->index[3 * i + 2]);
    if (trial->world.is)
        finding_put_world(&trial->world, to);
    fprintf(to, "rays %u\n", trial->ray_count);
    for (size_t i = 0; i < trial->ray_count; i++) {
        const struct ray *ray = &trial->ray[i];
        const float number[8] = {ray->org[0], ray->org[1], ray->org[2], ray->dir[0],
                                 ray->dir[1], ray->dir[2], ray->tmin,   ray->tmax};
        put_numbers(number, 8, trial->world.is ? &trial->world.mode[i] : NULL, to);
    }
    fputs("end\n", to);
}

/* A file that the reader would reject is not written. */
static enum status check(const struct finding_file *file, struct reason *reason)
{
    char text[FUZZ_SIGNATURE_MOST];
    struct fuzz_signature again;
    enum status status = fuzz_trial_check(&file->trial, reason);
    if (status || !file->has_signature)
        return status;
    fuzz_signature_print(&file->signature, text);
    return fuzz_signature_parse(text, &again, reason);
}

static enum status put_all(const struct finding_file *file, struct file_out *out,
                           struct reason *reason)
{
    put_head(file, out->stream);
    put_body(&file->trial, out->stream);
    return file_out_commit(out, reason);
}

enum status finding_file_write(const struct finding_file *file, const char *path,
                               struct reason *reason)
{
    struct file_out out;
    enum status status = check(file, reason);
    if (!status)
        status = file_out_open(path, &out, reason);
    return status ? status : put_all(file, &out, reason);
}

enum status finding_file_put(const struct finding_file *file, const struct folder *folder,
                             const char *name, struct reason *reason)
{
    struct file_out out;
    enum status status = check(file, reason);
    if (!status)
        status = folder_put(folder, name, &out, reason);
    return status ? status : put_all(file, &out, reason);
}

enum status finding_file_print(const struct finding_file *file, char **bytes, size_t *size,
                               struct reason *reason)
{
    *bytes = NULL;
    *size = 0;
    enum status status = check(file, reason);
    if (status)
        return status;
    FILE *to = open_memstream(bytes, size);
    if (to) {
        put_head(file, to);
        put_body(&file->trial, to);
    }
    bool good = to && !ferror(to);
    if (to && fclose(to) != 0)
        good = false;
    if (good)
        return STATUS_OK;
    free(*bytes);
    *bytes = NULL;
    *size = 0;
    return fail(reason, STATUS_MEMORY, "no memory for the text of a trial");
}
