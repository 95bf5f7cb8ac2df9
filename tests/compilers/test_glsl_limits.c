/* Laws of the borders of a shader's text (gpu/shaders/glsl_text.h): as many files, as deep, as long
 * names and as many bytes as there is room for are taken, and one more is refused with the file and
 * the line; a name from the root is no name in the folder of the shader. */
#include "gpu/shaders/glsl_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define DEEP 16

/* What a/main.glsl includes, and what was read last. */
static size_t files, deep, filled;
static const char *named;
static char last[GLSL_NAME_MOST + 8];

static char *main_text(void)
{
    char *text = calloc(1, filled + 64 * files + 4096);
    size_t at = 0;
    assert_non_null(text);
    at += (size_t)sprintf(text, "FIRST\n");
    for (size_t i = 0; i < files; i++)
        at += (size_t)sprintf(text + at, "#include \"f%zu.glsl\"\n", i);
    if (deep)
        at += (size_t)sprintf(text + at, "#include \"d%zu\"\n", deep);
    if (named)
        at += (size_t)sprintf(text + at, "#include \"%s\"\n", named);
    memset(text + at, '/', filled);
    return text;
}

/* a/dN includes a/d(N-1), down to d1; all others but the main one are short. */
static enum status read_made_up(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    (void)reason;
    if (strcmp(path, "a/main.glsl") == 0) {
        *bytes = main_text();
    } else {
        *bytes = calloc(1, 64);
        assert_non_null(*bytes);
        snprintf(last, sizeof last, "%s", path);
        if (strncmp(path, "a/d", 3) == 0 && atoi(path + 3) > 1)
            snprintf(*bytes, 64, "#include \"d%d\"\n", atoi(path + 3) - 1);
        else
            snprintf(*bytes, 64, "END\n");
    }
    *size = strlen(*bytes);
    return STATUS_OK;
}

/* The status. Of what is refused nothing is left. */
static enum status made(size_t *numbers, size_t *bytes, struct reason *reason)
{
    struct glsl_text text;
    enum status status = glsl_text_make("a/main.glsl", GLSL_TRACE, read_made_up, &text, reason);
    *numbers = text.files;
    *bytes = text.size;
    if (status)
        assert_true(text.text == NULL && text.files == 0 && text.size == 0);
    else
        assert_int_equal(strlen(text.text), text.size);
    glsl_text_free(&text);
    return status;
}

static void reset(void)
{
    files = deep = filled = 0;
    named = NULL;
}

static void as_many_files_as_have_numbers(void **state)
{
    (void)state;
    struct reason reason = {""};
    size_t own, now, bytes;
    reset();
    assert_int_equal(made(&own, &bytes, &reason), STATUS_OK);
    assert_true(own > 1 && own < GLSL_FILES_MOST);
    for (files = 1; own + files <= GLSL_FILES_MOST; files++) {
        assert_int_equal(made(&now, &bytes, &reason), STATUS_OK);
        assert_int_equal(now, own + files);
    }
    assert_int_equal(made(&now, &bytes, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "a/main.glsl: it includes more than 64 files");
}

static void as_deep_as_files_may_include_each_other(void **state)
{
    (void)state;
    struct reason reason = {""};
    size_t now, bytes;
    reset();
    for (deep = 1; deep <= DEEP; deep++)
        assert_int_equal(made(&now, &bytes, &reason), STATUS_OK);
    assert_int_equal(made(&now, &bytes, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "a/d2:1: files include each other 16 deep");
}

static void as_many_bytes_as_there_is_room_for(void **state)
{
    (void)state;
    struct reason reason = {""};
    size_t now, empty, bytes;
    reset();
    filled = 1;
    assert_int_equal(made(&now, &empty, &reason), STATUS_OK);
    filled += GLSL_TEXT_MOST - empty;
    assert_int_equal(made(&now, &bytes, &reason), STATUS_OK);
    assert_int_equal(bytes, GLSL_TEXT_MOST);
    filled++;
    assert_int_equal(made(&now, &bytes, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "a/main.glsl: with what it includes over 8388608 bytes");
}

/* With the folder it has at most GLSL_NAME_MOST - 1 bytes. */
static void as_long_names_as_there_is_room_for(void **state)
{
    (void)state;
    struct reason reason = {""};
    static char name[GLSL_NAME_MOST + 1];
    size_t now, bytes;
    reset();
    named = name;
    for (size_t length = 1; length < GLSL_NAME_MOST; length++) {
        memset(name, 'n', length);
        const bool root = length % 2;
        if (root)
            name[0] = '/';
        const size_t whole = length + (root ? 0 : 2);
        enum status status = made(&now, &bytes, &reason);
        assert_int_equal(status, whole < GLSL_NAME_MOST ? STATUS_OK : STATUS_INPUT);
        if (status)
            assert_string_equal(reason.text, "a/main.glsl:2: too long a name");
        else
            assert_string_equal(root ? last : last + 2, name);
        if (!status && !root)
            assert_memory_equal(last, "a/", 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_many_files_as_have_numbers),
        cmocka_unit_test(as_deep_as_files_may_include_each_other),
        cmocka_unit_test(as_many_bytes_as_there_is_room_for),
        cmocka_unit_test(as_long_names_as_there_is_room_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
