/* Build step for SPIR-V: checks a module against the rules of gpu/shaders/spirv_fix.h, decorates
 * its float arithmetic, and writes modules as C.
 *   spirv_tool fix IN.spv OUT.spv       checks and decorates
 *   spirv_tool embed OUT.c A.spv ...    writes the table of gpu/shaders/shaders.h
 * File names of tracing shaders begin with trace_, stackless_ or world_, of rendering shaders with
 * render_, of shaders that may use ray queries with query_. */
#include "gpu/shaders/spirv_fix.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct tool_module {
    const char *file;
    uint32_t *word;
    size_t count;
};

/* Prints one line and returns false. */
static bool complain(const struct tool_module *m, const char *what)
{
    fprintf(stderr, "%s: %s\n", m->file, what);
    return false;
}

static bool read_module(const char *file, struct tool_module *m)
{
    *m = (struct tool_module){.file = file};
    FILE *in = fopen(file, "rb");
    if (!in) {
        perror(file);
        return false;
    }
    size_t capacity = 0;
    for (size_t got = 1; got > 0; m->count += got) {
        if (m->count == capacity) {
            capacity = capacity ? 2 * capacity : 4096;
            uint32_t *grown = realloc(m->word, capacity * sizeof *grown);
            if (!grown) {
                perror(file);
                fclose(in);
                return false;
            }
            m->word = grown;
        }
        got = fread(m->word + m->count, sizeof *m->word, capacity - m->count, in);
    }
    bool failed = ferror(in) != 0;
    bool whole = ftell(in) % 4 == 0;
    fclose(in);
    if (failed)
        return complain(m, "read error");
    if (!whole)
        return complain(m, "its length must be whole words of four bytes");
    return true;
}

/* Closes the file and reports errors. An incomplete file is removed. */
static bool finish(FILE *out, const char *file)
{
    bool failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
    if (failed) {
        fprintf(stderr, "%s: write error\n", file);
        remove(file);
    }
    return !failed;
}

static bool is_tracing(const char *name)
{
    static const char *const begins[] = {"trace_", "stackless_", "world_"};
    for (size_t i = 0; i < ARRAY_COUNT(begins); i++)
        if (strncmp(name, begins[i], strlen(begins[i])) == 0)
            return true;
    return false;
}

static struct spirv_rules rules_of(const char *file)
{
    const char *slash = strrchr(file, '/'), *name = slash ? slash + 1 : file;
    return (struct spirv_rules){.tracing = is_tracing(name),
                                .render = strncmp(name, "render_", 7) == 0,
                                .query = strncmp(name, "query_", 6) == 0,
                                .free = strcmp(name, "probe_free.spv") == 0};
}

static bool write_words(const char *to, const uint32_t *word, size_t count)
{
    FILE *out = fopen(to, "wb");
    if (!out) {
        perror(to);
        return false;
    }
    fwrite(word, sizeof *word, count, out);
    return finish(out, to);
}

static bool fix(const char *from, const char *to)
{
    struct tool_module m;
    struct reason reason;
    const struct spirv_rules rules = rules_of(from);
    uint32_t *word = NULL;
    size_t count = 0;
    bool ok = read_module(from, &m);
    if (ok && spirv_fix(m.word, m.count, &rules, &word, &count, &reason))
        ok = complain(&m, reason.text);
    ok = ok && write_words(to, word, count);
    free(word);
    free(m.word);
    return ok;
}

/* Copies the file's stem to `name`; returns false unless it is a C identifier. */
static bool stem(const char *file, char name[64])
{
    const char *slash = strrchr(file, '/');
    const char *start = slash ? slash + 1 : file;
    size_t length = strcspn(start, ".");
    bool ok = length > 0 && length < 64 && isalpha((unsigned char)start[0]);
    for (size_t i = 0; i < length && ok; i++)
        ok = isalnum((unsigned char)start[i]) || start[i] == '_';
    if (!ok) {
        fprintf(stderr, "%s: the name of a shader must be a C identifier\n", file);
        return false;
    }
    memcpy(name, start, length);
    name[length] = '\0';
    return true;
}

static bool embed_words(FILE *out, const char *file)
{
    struct tool_module m;
    char name[64];
    bool ok = stem(file, name) && read_module(file, &m);
    if (!ok)
        return false;
    fprintf(out, "static const uint32_t %s[] = {", name);
    for (size_t i = 0; i < m.count; i++)
        fprintf(out, "%s0x%08x,", i % 8 ? " " : "\n    ", (unsigned)m.word[i]);
    fprintf(out, "\n};\n\n");
    free(m.word);
    return true;
}

static bool embed(const char *to, char **file, int count)
{
    FILE *out = fopen(to, "w");
    if (!out) {
        perror(to);
        return false;
    }
    bool ok = true;
    fprintf(out, "#include \"gpu/shaders/shaders.h\"\n\n");
    for (int i = 0; i < count && ok; i++)
        ok = embed_words(out, file[i]);
    fprintf(out, "const struct shader shaders[] = {\n");
    for (int i = 0; i < count && ok; i++) {
        char name[64];
        ok = stem(file[i], name);
        fprintf(out, "    {\"%s\", %s, (uint32_t)(sizeof %s / 4), %s},\n", name, name, name,
                is_tracing(name) ? "true" : "false");
    }
    fprintf(out, "    {0},\n};\n");
    if (!ok) {
        fclose(out);
        remove(to);
        return false;
    }
    return finish(out, to);
}

int main(int argc, char **argv)
{
    bool ok;
    if (argc == 4 && strcmp(argv[1], "fix") == 0) {
        ok = fix(argv[2], argv[3]);
    } else if (argc >= 3 && strcmp(argv[1], "embed") == 0) {
        ok = embed(argv[2], argv + 3, argc - 3);
    } else {
        fprintf(stderr, "usage: spirv_tool fix IN OUT | spirv_tool embed OUT.c MODULE...\n");
        return 2;
    }
    return ok ? 0 : 1;
}
