#include "gpu/shaders/glsl_text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH_MOST 16

/* The state of glsl_text_make. */
struct making {
    struct glsl_text *out;
    const char *path; /* the layout's file */
    glsl_read_fn *read;
    struct reason *reason;
    unsigned depth;
};

static enum status append(struct making *m, const char *text, size_t size)
{
    struct glsl_text *out = m->out;
    if (out->size + size > GLSL_TEXT_MOST)
        return fail(m->reason, STATUS_INPUT, "%.120s: with what it includes over %zu bytes",
                    m->path, GLSL_TEXT_MOST);
    if (array_reserve(&out->text, &out->capacity, out->size + size + 1, 1))
        return fail(m->reason, STATUS_MEMORY, "no memory for the text of a shader");
    memcpy(out->text + out->size, text, size);
    out->size += size;
    out->text[out->size] = '\0';
    return STATUS_OK;
}

static enum status append_line(struct making *m, const char *format, ...) PRINTF_LIKE(2, 3);

static enum status append_line(struct making *m, const char *format, ...)
{
    char line[GLSL_NAME_MOST + 64];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    return append(m, line, length < (int)sizeof line ? (size_t)length : sizeof line - 1);
}

/* Finds or adds a file's number for #line. */
static enum status number_of(struct making *m, const char *name, size_t *out)
{
    struct glsl_text *text = m->out;
    for (*out = 0; *out < text->files; (*out)++)
        if (strcmp(text->file[*out], name) == 0)
            return STATUS_OK;
    if (text->files == GLSL_FILES_MOST)
        return fail(m->reason, STATUS_INPUT, "%.120s: it includes more than %d files", m->path,
                    GLSL_FILES_MOST);
    snprintf(text->file[text->files++], GLSL_NAME_MOST, "%s", name);
    return STATUS_OK;
}

/* Returns true and sets `name` if the line includes a file in quotes. */
static bool is_include(const char *line, size_t length, char name[GLSL_NAME_MOST])
{
    size_t at = strspn(line, " \t");
    if (at >= length || line[at] != '#')
        return false;
    at += 1 + strspn(line + at + 1, " \t");
    if (strncmp(line + at, "include", 7) != 0)
        return false;
    at += 7 + strspn(line + at + 7, " \t");
    if (at >= length || line[at] != '"')
        return false;
    size_t most = strcspn(line + at + 1, "\"\n");
    if (most >= GLSL_NAME_MOST || line[at + 1 + most] != '"')
        return false;
    memcpy(name, line + at + 1, most);
    name[most] = '\0';
    return true;
}

static enum status expand(struct making *m, const char *name, const char *text);

static const char *our_text(const char *name)
{
    for (const struct glsl_source *source = glsl_sources; source->name; source++)
        if (strcmp(source->name, name) == 0)
            return source->text;
    return NULL;
}

/* Includes a file that is not ours: it lies beside the layout's file. */
static enum status include_theirs(struct making *m, const char *name, const char *from, size_t line)
{
    char path[GLSL_NAME_MOST];
    const char *slash = strrchr(m->path, '/');
    int folder = slash ? (int)(slash - m->path) + 1 : 0;
    char *bytes = NULL;
    size_t size;
    struct reason why = {""};
    if (name[0] == '/')
        folder = 0;
    if (snprintf(path, sizeof path, "%.*s%s", folder, m->path, name) >= (int)sizeof path)
        return fail(m->reason, STATUS_INPUT, "%.120s:%zu: too long a name", from, line);
    enum status status = m->read(path, &bytes, &size, &why);
    if (status)
        return fail(m->reason, status, "%.100s:%zu: cannot include \"%.60s\": %.100s", from, line,
                    name, why.text);
    status = expand(m, path, bytes);
    free(bytes);
    return status;
}

static enum status include(struct making *m, const char *name, const char *from, size_t line)
{
    const char *ours = our_text(name);
    if (m->depth == DEPTH_MOST)
        return fail(m->reason, STATUS_INPUT, "%.120s:%zu: files include each other %d deep", from,
                    line, DEPTH_MOST);
    m->depth++;
    enum status status = ours ? expand(m, name, ours) : include_theirs(m, name, from, line);
    m->depth--;
    return status;
}

/* Appends the text of file `name` with its includes resolved. */
static enum status expand(struct making *m, const char *name, const char *text)
{
    size_t number, line = 1;
    enum status status = number_of(m, name, &number);
    if (!status)
        status = append_line(m, "#line 1 %zu\n", number);
    for (const char *at = text; *at && !status; line++) {
        char included[GLSL_NAME_MOST];
        size_t length = strcspn(at, "\n");
        if (is_include(at, length, included)) {
            status = include(m, included, name, line);
            if (!status)
                status = append_line(m, "#line %zu %zu\n", line + 1, number);
        } else {
            status = append(m, at, length);
            if (!status)
                status = append(m, "\n", 1);
        }
        at += length + (at[length] == '\n');
    }
    return status;
}

enum status glsl_text_make(const char *path, enum glsl_use use, glsl_read_fn *read,
                           struct glsl_text *out, struct reason *reason)
{
    static const char *const main_of[GLSL_USES] = {[GLSL_TRACE] = "trace.glsl",
                                                   [GLSL_RENDER] = "render_tree.glsl",
                                                   [GLSL_DECODE] = "decode.glsl"};
    *out = (struct glsl_text){.files = 0};
    struct making m = {out, path, read, reason, 0};
    char *bytes = NULL;
    size_t size;
    enum status status = read(path, &bytes, &size, reason);
    /* Begin as the shaders of the build do. Children are visited in the same order as in C. */
    if (!status)
        status = append_line(&m, "#version 450\n#define ORDER_NEAR\n%s",
                             use == GLSL_RENDER ? "#define RENDERING\n" : "");
    if (!status)
        status = expand(&m, path, bytes);
    free(bytes);
    if (!status)
        status = include(&m, main_of[use], path, 0);
    if (status)
        glsl_text_free(out);
    return status;
}

enum status glsl_text_blame(const struct glsl_text *text, const char *log, struct reason *reason)
{
    static const char mark[] = "ERROR: ";
    const char *error = strstr(log, mark);
    error = error ? error + strlen(mark) : log;
    char *end;
    unsigned long file = strtoul(error, &end, 10);
    if (end > error && *end == ':' && file < text->files) {
        const char *line = end + 1;
        unsigned long number = strtoul(line, &end, 10);
        if (end > line && *end == ':')
            return fail(reason, STATUS_INPUT, "%.120s:%lu:%.*s", text->file[file], number,
                        (int)strcspn(end + 1, "\n"), end + 1);
    }
    return fail(reason, STATUS_INPUT, "%.120s: %.*s", text->files ? text->file[0] : "shader",
                (int)strcspn(error, "\n"), error);
}

void glsl_text_free(struct glsl_text *text)
{
    free(text->text);
    *text = (struct glsl_text){.files = 0};
}
