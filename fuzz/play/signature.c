#include "fuzz/play/signature.h"

#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"

#include <stdio.h>
#include <string.h>

const char *fuzz_kind_name(enum fuzz_kind kind)
{
    static const char *const name[] = {"bits",  "unfinished", "refused", "tree",
                                       "crash", "hang",       "protocol"};
    if (kind > FUZZ_KIND_WRONG && kind < FUZZ_KIND_BITS)
        return wrong_name((enum wrong)(kind - FUZZ_KIND_WRONG));
    return kind >= FUZZ_KIND_BITS && kind < FUZZ_KIND_COUNT ? name[kind - FUZZ_KIND_BITS] : "none";
}

bool fuzz_kind_find(const char *name, enum fuzz_kind *out)
{
    for (enum fuzz_kind kind = FUZZ_KIND_WRONG + 1; kind < FUZZ_KIND_COUNT; kind++)
        if (strcmp(fuzz_kind_name(kind), name) == 0) {
            *out = kind;
            return true;
        }
    return false;
}

static bool engine_byte(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           (c && strchr("_-+:.", c));
}

/* Appends one byte as a signature may hold it, if there is room. */
static void put_byte(struct fuzz_signature *signature, char byte)
{
    size_t used = strlen(signature->engine);
    if (used + 1 >= sizeof signature->engine)
        return;
    signature->engine[used] = engine_byte(byte) && (used > 0 || byte != '.') ? byte : '_';
    signature->engine[used + 1] = '\0';
}

/* Appends a word of a command: the interpreter alone would be the same for all its programs. */
static void put_word(struct fuzz_signature *signature, const char *from, const char *end)
{
    for (const char *at = from; at + 1 < end; at++)
        if (*at == '/')
            from = at + 1;
    for (; from < end; from++)
        put_byte(signature, *from);
}

void fuzz_signature_set_engine(struct fuzz_signature *signature, const char *name)
{
    static const char blanks[] = " \t\n";
    const char *object = file_of_engine(name);
    bool pipe = strncmp(name, PIPE_PREFIX, strlen(PIPE_PREFIX)) == 0, first = true;
    memset(signature->engine, 0, sizeof signature->engine);
    if (object) { /* without its folders, as the words of a command */
        memcpy(signature->engine, name, (size_t)(object - name)); /* "inside:", "shader:" */
        put_word(signature, object, object + strlen(object));
        return;
    }
    if (!pipe) {
        for (; *name; name++)
            put_byte(signature, *name);
        return;
    }
    strcpy(signature->engine, PIPE_PREFIX);
    for (const char *at = name + strlen(PIPE_PREFIX); *(at += strspn(at, blanks)); first = false) {
        const char *end = at + strcspn(at, blanks);
        if (!first)
            put_byte(signature, '_');
        put_word(signature, at, end);
        at = end;
    }
}

bool fuzz_signature_holds(const char *name)
{
    struct fuzz_signature signature;
    fuzz_signature_set_engine(&signature, name);
    return strlen(signature.engine) + 1 < sizeof signature.engine; /* or more was to come */
}

const struct engine *fuzz_signature_engine(const struct fuzz_signature *signature)
{
    for (size_t i = 0; engines[i]; i++) {
        struct fuzz_signature named;
        fuzz_signature_set_engine(&named, engines[i]->name);
        if (strcmp(named.engine, signature->engine) == 0)
            return engines[i];
    }
    return NULL;
}

static void change_bytes(char *text, char from, char to)
{
    for (; *text; text++)
        if (*text == from)
            *text = to;
}

void fuzz_signature_folder(const struct fuzz_signature *signature, char text[FUZZ_SIGNATURE_MOST])
{
    fuzz_signature_print(signature, text);
    change_bytes(text, ':', '=');
}

enum status fuzz_signature_of_folder(const char *name, struct fuzz_signature *out,
                                     struct reason *reason)
{
    char text[FUZZ_SIGNATURE_MOST];
    *out = (struct fuzz_signature){0};
    if (strlen(name) >= sizeof text)
        return fail(reason, STATUS_INPUT, "a signature has at most %d characters",
                    FUZZ_SIGNATURE_MOST - 1);
    strcpy(text, name);
    change_bytes(text, '=', ':');
    return fuzz_signature_parse(text, out, reason);
}

void fuzz_signature_print(const struct fuzz_signature *signature, char text[FUZZ_SIGNATURE_MOST])
{
    snprintf(text, FUZZ_SIGNATURE_MOST, "%s.%s.%s.%s", signature->engine,
             signature->layout ? signature->layout->name : "-", fuzz_kind_name(signature->kind),
             cause_name(signature->cause));
}

/* Cuts the last field off `text`; NULL if there is none. */
static char *last_field(char *text)
{
    char *dot = strrchr(text, '.');
    if (!dot)
        return NULL;
    *dot = '\0';
    return dot + 1;
}

enum status fuzz_signature_parse(const char *text, struct fuzz_signature *out,
                                 struct reason *reason)
{
    char copy[FUZZ_SIGNATURE_MOST];
    struct fuzz_signature read = {0};
    *out = read;
    if (strlen(text) >= sizeof copy)
        return fail(reason, STATUS_INPUT, "a signature has at most %d characters",
                    FUZZ_SIGNATURE_MOST - 1);
    strcpy(copy, text);
    const char *cause = last_field(copy), *kind = cause ? last_field(copy) : NULL;
    const char *layout = kind ? last_field(copy) : NULL;
    if (!layout)
        return fail(reason, STATUS_INPUT, "'%.80s' is no signature engine.layout.kind.cause", text);
    fuzz_signature_set_engine(&read, copy);
    if (copy[0] == '\0' || strcmp(read.engine, copy) != 0)
        return fail(reason, STATUS_INPUT, "signature: '%.60s' is no engine's name", copy);
    if (!cause_find(cause, &read.cause))
        return fail(reason, STATUS_INPUT, "signature: unknown cause '%.40s'", cause);
    if (!fuzz_kind_find(kind, &read.kind))
        return fail(reason, STATUS_INPUT, "signature: unknown kind '%.40s'", kind);
    read.layout = strcmp(layout, "-") == 0 ? NULL : layout_find(layout);
    if (!read.layout && strcmp(layout, "-") != 0)
        return fail(reason, STATUS_INPUT,
                    "signature: unknown layout '%.40s' (one from outside: --layout FILE.so first)",
                    layout);
    *out = read;
    return STATUS_OK;
}

bool fuzz_signature_same(const struct fuzz_signature *a, const struct fuzz_signature *b)
{
    return strcmp(a->engine, b->engine) == 0 && a->layout == b->layout && a->kind == b->kind &&
           a->cause == b->cause;
}
