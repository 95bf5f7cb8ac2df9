/* Laws of loading a tracer from outside (ref/guest/guest.h): whatever is wrong with the object or
 * its table is one line that names the file and the rule, and a crash is one, too. */
#define _GNU_SOURCE /* mkdtemp */
#include "tests/guest/guest_ways.h"

#include <sys/stat.h>
#include <unistd.h>

/* Loads it in a child and here: both end alike. */
static void must_say(const char *file, enum status status, const char *text)
{
    char path[GUEST_PATH_MOST];
    struct reason reason = {""}, here = {""};
    struct guest guest;
    object_path(file, path);
    assert_int_equal(guest_try(path, 5000, &reason), status);
    assert_int_equal(guest_load(path, &guest, &here), status);
    assert_string_equal(reason.text, here.text);
    if (status)
        assert_null(guest.handle);
    if (!strstr(reason.text, text) || (status && !strstr(reason.text, file)))
        fail_msg("%s: '%s' has no '%s'", file, reason.text, text);
    guest_close(&guest);
}

static void each_table_is_checked(void **state)
{
    static const struct {
        const char *what, *text;
    } known[] = {{"null", "raydiff_engine() returns NULL"},
                 {"version", "version 3 of "},
                 {"bytes", "compile it with its ref/raydiff_engine.h"},
                 {"name", "its name must be a letter"},
                 {"can", "can 0x5f has more than 0x3f"},
                 {"neither", "can 0x4 has neither CLOSEST nor WORLDS"},
                 {"no_trace", "it has no trace(), which can 0x1f needs"},
                 {"no_close", "it has no close()"},
                 {"no_rays_free", "it has no rays_free()"},
                 {"no_build_world", "it has no build_world()"},
                 {"no_move", "it has no move(), which can 0x3f needs"},
                 {"old_can", "can 0x3f has more than 0x1f"},
                 {"old_long", "version 1 of "},
                 {"new_short", "version 2 of "}};
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        behave(known[i].what);
        must_say("guest_bad.so", STATUS_INPUT, known[i].text);
    }
    behave("good");
    must_say("guest_bad.so", STATUS_OK, "");
    behave("old");
    must_say("guest_bad.so", STATUS_OK, "");
}

/* It ends before its `move`, so that what stands behind it is not read. */
static void a_table_of_version_1_is_taken_as_it_is(void **state)
{
    struct guest guest;
    struct reason reason = {""};
    char path[GUEST_PATH_MOST];
    (void)state;
    behave("old");
    assert_int_equal(guest_load(object_path("guest_bad.so", path), &guest, &reason), STATUS_OK);
    assert_int_equal(guest.table->version, 1);
    assert_null(guest.table->move);
    assert_non_null(guest.table->memory);
    assert_false(guest_can(&guest, RAYDIFF_ENGINE_MOVE));
    guest_close(&guest);
    behave("move");
    assert_int_equal(guest_load(path, &guest, &reason), STATUS_OK);
    assert_non_null(guest.table->move);
    assert_true(guest_can(&guest, RAYDIFF_ENGINE_MOVE));
    guest_close(&guest);
}

/* What a table does not claim it need not have. */
static void functions_are_needed_only_for_what_it_can(void **state)
{
    struct raydiff_engine table, least = {.can = 0};
    struct guest guest;
    struct reason reason = {""};
    char path[GUEST_PATH_MOST];
    (void)state;
    behave("good");
    assert_int_equal(guest_load(object_path("guest_bad.so", path), &guest, &reason), STATUS_OK);
    table = *guest.table;
    least = table;
    least.can = RAYDIFF_ENGINE_CLOSEST;
    least.trace_all = NULL, least.build_world = NULL, least.trace_world = NULL;
    least.rays_make = NULL, least.rays_trace = NULL, least.hits_read = NULL;
    least.rays_free = NULL, least.model = NULL, least.memory = NULL, least.summary = NULL;
    assert_int_equal(guest_check("x", &least, &reason), STATUS_OK);
    const uint32_t bits[] = {RAYDIFF_ENGINE_ALL, RAYDIFF_ENGINE_WORLDS, RAYDIFF_ENGINE_NATIVE};
    for (size_t i = 0; i < ARRAY_COUNT(bits); i++) {
        least.can = RAYDIFF_ENGINE_CLOSEST | bits[i];
        assert_int_equal(guest_check("x", &least, &reason), STATUS_INPUT);
    }
    least = table;
    least.can = RAYDIFF_ENGINE_WORLDS;
    least.build = NULL, least.trace = NULL, least.trace_all = NULL;
    assert_int_equal(guest_check("x", &least, &reason), STATUS_OK);
    guest_close(&guest);
}

static void what_is_no_guest_is_refused(void **state)
{
    char path[GUEST_PATH_MOST + 1], made[] = "/tmp/test_guest_XXXXXX";
    struct reason reason = {""};
    struct guest guest;
    (void)state;
    behave("good");
    must_say("guest_none.so", STATUS_INPUT, "it does not export raydiff_engine()");
    must_say("no_such_file.so", STATUS_INPUT, "cannot be loaded as a shared object");
    assert_non_null(mkdtemp(made));
    snprintf(path, sizeof path, "%s/text.so", made);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("no shared object, but a line of text\n", file);
    fclose(file);
    assert_int_equal(guest_try(path, 5000, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "cannot be loaded as a shared object: "));
    unlink(path);
    snprintf(path, sizeof path, "%s/fifo.so", made);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(guest_load(path, &guest, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "is no regular file"));
    unlink(path);
    rmdir(made);
    memset(path, 'x', GUEST_PATH_MOST);
    path[GUEST_PATH_MOST] = '\0';
    assert_int_equal(guest_load(path, &guest, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "a path of over 159 characters"));
}

static void a_constructor_may_crash_or_hang(void **state)
{
    char path[GUEST_PATH_MOST];
    struct reason reason = {""};
    (void)state;
    object_path("guest_bad.so", path);
    behave("load_crash");
    assert_int_equal(guest_try(path, 5000, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "guest_bad.so: crashed while being opened: "));
    behave("load_hang");
    assert_int_equal(guest_try(path, 300, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "hung while being opened: no end after 300 ms"));
    behave("good");
    assert_int_equal(guest_try(path, 5000, &reason), STATUS_OK);
}

static void names_of_engines(void **state)
{
    const struct engine *engine, *same;
    struct reason reason = {""};
    (void)state;
    const char *const bad[] = {"inside:", "inside:x", "inside:.so", "inside", "x.so"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
        assert_int_equal(guest_engine(bad[i], &engine, &reason), STATUS_INPUT);
    assert_int_equal(pipe_engine("inside:x.so", &engine, &reason), STATUS_INPUT);
    assert_int_equal(pipe_engine(".so", &engine, &reason), STATUS_INPUT);
    assert_int_equal(guest_engine("inside:x.so", &engine, &reason), STATUS_OK);
    assert_int_equal(guest_engine("inside:x.so", &same, &reason), STATUS_OK);
    assert_ptr_equal(engine, same);
    assert_null(engine->fault); /* its crash is its process's */
    assert_int_equal(pipe_engine("x.so", &same, &reason), STATUS_OK);
    assert_ptr_not_equal(engine, same);
    assert_non_null(same->fault);
    assert_true(pipe_is_peer("x.so") && pipe_is_peer("pipe:x") && pipe_is_peer("pipe:x.so"));
    assert_false(pipe_is_peer("inside:x.so") || pipe_is_peer("cpu") || pipe_is_peer(".so"));
    assert_int_equal(guest_engine("inside:2.so", &engine, &reason), STATUS_OK);
    assert_int_equal(guest_engine("inside:3.so", &engine, &reason), STATUS_OK);
    assert_int_equal(guest_engine("inside:4.so", &engine, &reason), STATUS_OK);
    assert_int_equal(guest_engine("inside:5.so", &engine, &reason), STATUS_LIMIT);
    assert_int_equal(pipe_engine("5.so", &engine, &reason), STATUS_OK); /* each kind has its own */
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_table_is_checked),
        cmocka_unit_test(a_table_of_version_1_is_taken_as_it_is),
        cmocka_unit_test(functions_are_needed_only_for_what_it_can),
        cmocka_unit_test(what_is_no_guest_is_refused),
        cmocka_unit_test(a_constructor_may_crash_or_hang),
        cmocka_unit_test(names_of_engines),
    };
    (void)argc;
    find_folder(argv[0]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
