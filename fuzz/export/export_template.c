#include "fuzz/export/export_template.h"

#include <string.h>

#define DEPTH_MOST 8
#define NAME_MOST  64

/* A level of #if: one of ours, which is not written itself, or one of the program's own. */
struct template_level {
    bool ours, taken;
};

struct writing {
    const char *const *defined;
    export_data_fn *data;
    const void *user;
    FILE *to;
    struct template_level level[DEPTH_MOST];
    int depth;
};

static bool is_defined(const struct writing *w, const char *name, size_t length)
{
    for (const char *const *at = w->defined; *at; at++)
        if (strlen(*at) == length && memcmp(*at, name, length) == 0)
            return true;
    return false;
}

static bool is_written(const struct writing *w)
{
    for (int i = 0; i < w->depth; i++)
        if (w->level[i].ours && !w->level[i].taken)
            return false;
    return true;
}

/* What follows `prefix` if the line begins with it, or NULL. */
static const char *after(const char *line, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncmp(line, prefix, length) == 0 ? line + length : NULL;
}

/* True if the line is one of ours and not to be written. */
static bool resolve(struct writing *w, const char *line)
{
    const char *name = after(line, "#if EXPORT_");
    if (name || after(line, "#if")) {
        struct template_level *level = &w->level[w->depth < DEPTH_MOST - 1 ? w->depth++ : w->depth];
        level->ours = name != NULL;
        level->taken = name && is_defined(w, name, strcspn(name, " \n"));
        return level->ours;
    }
    struct template_level *top = w->depth ? &w->level[w->depth - 1] : NULL;
    if (after(line, "#else") && top && top->ours) {
        top->taken = !top->taken;
        return true;
    }
    if (after(line, "#endif") && top) {
        bool ours = top->ours;
        w->depth--;
        return ours;
    }
    return false;
}

static const char *text_of(const char *name, size_t length)
{
    for (const struct export_template *t = export_templates; t->name; t++)
        if (strlen(t->name) == length && memcmp(t->name, name, length) == 0)
            return t->text;
    return "";
}

static void write_text(struct writing *w, const char *text)
{
    while (*text) {
        size_t length = strcspn(text, "\n") + 1;
        const char *name = after(text, "#include \"");
        bool ours = resolve(w, text);
        if (!ours && is_written(w)) {
            if (name && after(name, "finding.h\""))
                w->data(w->user, w->to);
            else if (name)
                write_text(w, text_of(name, strcspn(name, "\"")));
            else
                fwrite(text, 1, length, w->to);
        }
        text += length;
    }
}

void export_template_write(const char *name, const char *const *defined, export_data_fn *data,
                           const void *user, FILE *to)
{
    struct writing w = {.defined = defined, .data = data, .user = user, .to = to};
    write_text(&w, text_of(name, strlen(name)));
}
