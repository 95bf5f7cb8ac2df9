/* Finds numbers in JSON and text, for tests of what commands tell. Needs _GNU_SOURCE. Includes
 * cmocka.h, whose macros must come last. */
#ifndef TESTS_TOLD_H
#define TESTS_TOLD_H

#include "ref/base/base.h"

#include <jansson.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The number at a path such as "axes.0.step.value". */
static inline double number_at(json_t *from, const char *path)
{
    char name[64];
    while (*path) {
        const size_t length = strcspn(path, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        from = json_is_array(from) ? json_array_get(from, strtoul(name, NULL, 10))
                                   : json_object_get(from, name);
        path += length + (path[length] == '.');
    }
    if (!json_is_number(from))
        fail_msg("no number");
    return json_number_value(from);
}

/* --- all numbers of a JSON -------------------------------------------------------------------- */

/* A number or a flag, which counts 0 or 1, at its path. */
struct told_number {
    const char *path;
    double is;
};

#define TOLD_MOST 400

struct told_table {
    const struct told_number *row;
    size_t count;
    bool found[TOLD_MOST];
};

static inline void told_leaf(struct told_table *table, const char *path, double is)
{
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->row[i].path, path) == 0) {
            if (fabs(is - table->row[i].is) > 1e-8 * fabs(is))
                fail_msg("%s is %.17g, not %.17g", path, is, table->row[i].is);
            table->found[i] = true;
            return;
        }
    fail_msg("%s, %.17g, is in no table", path, is);
}

static inline void told_walk(struct told_table *table, json_t *json, const char *path)
{
    const char *name, *dot = *path ? "." : "";
    char below[200];
    json_t *value;
    size_t i;
    json_object_foreach(json, name, value)
    {
        snprintf(below, sizeof below, "%s%s%s", path, dot, name);
        told_walk(table, value, below);
    }
    json_array_foreach(json, i, value)
    {
        snprintf(below, sizeof below, "%s%s%zu", path, dot, i);
        told_walk(table, value, below);
    }
    if (json_is_number(json) || json_is_boolean(json))
        told_leaf(table, path, json_is_true(json) ? 1 : json_number_value(json));
}

/* The JSON has these numbers and flags, all of them, and no others. Takes it. */
static inline void told_json(json_t *json, const struct told_number *row, size_t count)
{
    struct told_table table = {.row = row, .count = count};
    assert_true(json && count <= TOLD_MOST);
    told_walk(&table, json, "");
    for (size_t i = 0; i < count; i++)
        if (!table.found[i])
            fail_msg("there is no %s", row[i].path);
    json_decref(json);
}

/* Where a command writes a file; and what it wrote, as JSON or as text. */
static inline const char *told_file(void)
{
    static char path[64];
    snprintf(path, sizeof path, "/tmp/raydiff-told-%ld", (long)getpid());
    return path;
}

static inline json_t *told_file_json(void)
{
    json_t *json = json_load_file(told_file(), 0, NULL);
    unlink(told_file());
    return json;
}

/* --- all numbers of a text -------------------------------------------------------------------- */

static struct {
    FILE *before, *stream, **of;
    char *text;
    size_t size;
} telling;

/* Collects what goes to `stream`, which is stdout or stderr, until told_end. */
static inline void told_begin(FILE **stream)
{
    telling.of = stream;
    telling.before = *stream;
    telling.stream = open_memstream(&telling.text, &telling.size);
    assert_non_null(telling.stream);
    *stream = telling.stream;
}

/* Each run of blanks becomes one. */
static inline void told_squeeze(char *text)
{
    char *to = text;
    for (const char *from = text; *from; from++)
        if (*from != ' ' || (from[1] != ' ' && from[1] != '\n' && to > text && to[-1] != '\n'))
            *to++ = *from;
    *to = '\0';
}

static inline bool told_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The first place of a text that is not within a longer number. */
static inline char *told_find(char *text, const char *what)
{
    const size_t length = strlen(what);
    for (char *at = text; (at = strstr(at, what)) != NULL; at++) {
        const bool begun = at > text && told_is_digit(what[0]) &&
                           (told_is_digit(at[-1]) || at[-1] == '.' || at[-1] == '-');
        const bool open =
            told_is_digit(what[length - 1]) &&
            (told_is_digit(at[length]) || (at[length] == '.' && told_is_digit(at[length + 1])));
        if (!begun && !open)
            return at;
    }
    return NULL;
}

/* The lines have these texts, blanks aside, and without them no number. The first of a kind is
 * taken first. Takes `text`. */
static inline void told_text(char *text, const char *const *expected, size_t count)
{
    told_squeeze(text);
    for (size_t i = 0; i < count; i++) {
        char *at = told_find(text, expected[i]);
        if (!at)
            fail_msg("no '%s' in\n%s", expected[i], text);
        memset(at, '~', strlen(expected[i]));
    }
    for (const char *c = text; *c; c++)
        if (told_is_digit(*c) && (c == text || strchr(" \n(,:;=~", c[-1])))
            fail_msg("a number that is in no table: '%.40s' in\n%s", c, text);
    free(text);
}

static inline char *told_end(void)
{
    *telling.of = telling.before;
    fclose(telling.stream);
    return telling.text;
}

/* What a member tells is not exchanged with what another tells: with one flag alone set, only the
 * number at `path` is 1 of those of the table. Takes the JSON. */
static inline void told_flag(json_t *json, const char *path, const char *const *flags, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        json_t *at = json;
        char name[64];
        for (const char *word = flags[i]; *word;) {
            const size_t length = strcspn(word, ".");
            snprintf(name, sizeof name, "%.*s", (int)length, word);
            at = json_is_array(at) ? json_array_get(at, strtoul(name, NULL, 10))
                                   : json_object_get(at, name);
            word += length + (word[length] == '.');
        }
        if (!json_is_boolean(at) || json_is_true(at) != (strcmp(flags[i], path) == 0))
            fail_msg("flag %s, where %s alone is set", flags[i], path);
    }
    json_decref(json);
}

#endif
