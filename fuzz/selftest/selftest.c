/* The table of planted bugs. */
#include "fuzz/selftest/selftest.h"

#include "ref/files/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TABLE_MOST ((size_t)1 << 20)

/* Copies the next word of the line into a field; false if there is none or it does not fit. */
static bool take_word(const char **at, char *field, size_t size)
{
    *at += strspn(*at, " \t");
    size_t length = strcspn(*at, " \t\n");
    if (length == 0 || length >= size)
        return false;
    memcpy(field, *at, length);
    field[length] = '\0';
    *at += length;
    return true;
}

static bool take_line(const char *line, struct selftest_bug *bug)
{
    return take_word(&line, bug->bug, sizeof bug->bug) &&
           take_word(&line, bug->unit, sizeof bug->unit) &&
           take_word(&line, bug->engines, sizeof bug->engines) &&
           take_word(&line, bug->layouts, sizeof bug->layouts) &&
           take_word(&line, bug->kind, sizeof bug->kind) && line[strspn(line, " \t")] <= '\n';
}

static bool is_known(const struct selftest_bug *bug, size_t count, const struct selftest_bug *one)
{
    char name[SELFTEST_NAME_MOST], other[SELFTEST_NAME_MOST];
    selftest_name(one, name);
    for (size_t i = 0; i < count; i++) {
        selftest_name(&bug[i], other);
        if (strcmp(name, other) == 0)
            return true;
    }
    return false;
}

enum status selftest_parse(const char *name, const char *text, struct selftest_bug **out,
                           size_t *count, struct reason *reason)
{
    void *array = NULL;
    size_t capacity = 0, number = 0;
    enum status status = STATUS_OK;
    *out = NULL;
    *count = 0;
    for (const char *line = text; *line && !status; line += line[0] == '\n') {
        struct selftest_bug bug = {.bug = ""};
        size_t length = strcspn(line, "\n");
        number++;
        if (length > strspn(line, " \t") && line[0] != '#') {
            if (!take_line(line, &bug))
                status =
                    fail(reason, STATUS_INPUT, "%s:%zu: a line is BUG UNIT ENGINES LAYOUTS KIND",
                         file_label(name), number);
            else if (is_known(array, *count, &bug))
                status = fail(reason, STATUS_INPUT, "%s:%zu: %s is planted there twice",
                              file_label(name), number, bug.bug);
            else
                status = array_reserve(&array, &capacity, *count + 1, sizeof bug);
            if (status == STATUS_MEMORY)
                (void)fail(reason, status, "%s: no memory", file_label(name));
            if (!status)
                ((struct selftest_bug *)array)[(*count)++] = bug;
        }
        line += length;
    }
    if (!status && *count == 0)
        status = fail(reason, STATUS_INPUT, "%s: it lists no bug", file_label(name));
    if (status) {
        free(array);
        array = NULL;
        *count = 0;
    }
    *out = array;
    return status;
}

enum status selftest_read(const char *path, struct selftest_bug **out, size_t *count,
                          struct reason *reason)
{
    char *bytes = NULL;
    size_t size = 0;
    *out = NULL;
    *count = 0;
    enum status status = file_read_most(path, TABLE_MOST, &bytes, &size, reason);
    if (!status)
        status = selftest_parse(path, bytes, out, count, reason);
    free(bytes);
    return status;
}

void selftest_name(const struct selftest_bug *bug, char name[SELFTEST_NAME_MOST])
{
    const char *slash = strrchr(bug->unit, '/');
    const char *file = slash ? slash + 1 : bug->unit;
    (void)snprintf(name, SELFTEST_NAME_MOST, "%s.%.*s", bug->bug, (int)strcspn(file, "."), file);
}

bool selftest_chosen(const struct selftest_bug *bug, const char *choice)
{
    char name[SELFTEST_NAME_MOST];
    selftest_name(bug, name);
    return strcmp(choice, bug->bug) == 0 || strcmp(choice, name) == 0 ||
           strcmp(choice, bug->kind) == 0 || strcmp(choice, bug->engines) == 0;
}
