/* How Embree's library is looked for: in which places, once, and by any thread. */
#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#if HAVE_EMBREE

#undef EMBREE_FOLDER
#define EMBREE_FOLDER "/some/where"
#define dlopen        stand_in_open
#define dlsym         stand_in_find
#define dlerror()     "it is not there"
static void *stand_in_open(const char *path, int flags);
static void *stand_in_find(void *library, const char *name);
#include "ref/base/symbols.c"
#include "ref/engines/embree_library.c"
#undef dlopen
#undef dlsym
#undef dlerror

#include <cmocka.h>

static struct {
    bool in_folder, in_system; /* where the library is */
    const char *lacks;         /* a function */
    char path[4][64];          /* what was opened */
    atomic_int opened, found;
} stand_in;

static void *stand_in_open(const char *path, int flags)
{
    const int at = atomic_fetch_add(&stand_in.opened, 1);
    assert_in_range(at, 0, ARRAY_COUNT(stand_in.path) - 1);
    snprintf(stand_in.path[at], sizeof stand_in.path[at], "%s", path);
    assert_int_equal(flags, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    return (strchr(path, '/') ? stand_in.in_folder : stand_in.in_system) ? &stand_in : NULL;
}

static void *stand_in_find(void *library, const char *name)
{
    assert_ptr_equal(library, &stand_in);
    atomic_fetch_add(&stand_in.found, 1);
    return stand_in.lacks && strcmp(stand_in.lacks, name) == 0 ? NULL : &stand_in;
}

/* A process that has not looked yet. */
static void begin(bool in_folder, bool in_system, const char *lacks)
{
    memset(&stand_in, 0, sizeof stand_in);
    stand_in.in_folder = in_folder;
    stand_in.in_system = in_system;
    stand_in.lacks = lacks;
    once = (pthread_once_t)PTHREAD_ONCE_INIT;
    loaded = STATUS_OK;
    memset(&rtc, 0, sizeof rtc);
}

/* All functions are there, or none is. */
static bool has_functions(void)
{
    size_t there = 0;
    const size_t all = sizeof rtc / sizeof rtc.NewDevice;
#define COUNT(name) there += rtc.name != NULL;
    EMBREE_FUNCTIONS(COUNT)
#undef COUNT
    assert_true(there == 0 || there == all);
    return there > 0;
}

/* The folder of the build goes before the system's, which stands in for it. */
static void the_folder_of_the_build_comes_first(void **state)
{
    (void)state;
    for (int where = 0; where < 4; where++) {
        const bool in_folder = where & 1, in_system = where & 2;
        struct reason reason = {""};
        begin(in_folder, in_system, NULL);
        assert_int_equal(embree_load(&reason), where ? STATUS_OK : STATUS_UNSUPPORTED);
        assert_true(has_functions() == (where != 0));
        assert_int_equal(stand_in.opened, in_folder ? 1 : 2);
        assert_string_equal(stand_in.path[0], "/some/where/" EMBREE_LIBRARY);
        assert_string_equal(stand_in.path[1], in_folder ? "" : EMBREE_LIBRARY);
    }
}

/* Whatever came of it, it is looked for once, and each call returns the same with its reason. */
static void the_answer_stays(void **state)
{
    (void)state;
    static const char *const lacks[] = {NULL, "rtcAttachGeometry", "rtcUpdateGeometryBuffer"};
    for (size_t i = 0; i < ARRAY_COUNT(lacks); i++)
        for (int is_there = 0; is_there < 2; is_there++) {
            struct reason first = {""}, second = {""};
            begin(is_there, false, lacks[i]);
            const enum status status = embree_load(&first);
            const int opened = stand_in.opened;
            assert_int_equal(status, is_there && !lacks[i] ? STATUS_OK : STATUS_UNSUPPORTED);
            assert_true(has_functions() == (status == STATUS_OK));
            stand_in.in_folder = stand_in.in_system = true;
            stand_in.lacks = NULL;
            assert_int_equal(embree_load(&second), status);
            assert_int_equal(embree_load(NULL), status);
            assert_int_equal(stand_in.opened, opened);
            assert_string_equal(first.text, second.text);
            if (lacks[i] && is_there)
                assert_non_null(strstr(first.text, lacks[i]));
        }
}

#define THREADS 8

static pthread_barrier_t all_here;

static void *use(void *user)
{
    bool *fine = user;
    pthread_barrier_wait(&all_here);
    *fine = embree_load(NULL) == STATUS_OK && rtc.NewDevice && rtc.UpdateGeometryBuffer;
    return NULL;
}

/* Threads that come at once open it once, and none goes on before all functions are found. */
static void threads_open_it_once(void **state)
{
    (void)state;
    assert_int_equal(pthread_barrier_init(&all_here, NULL, THREADS), 0);
    for (int round = 0; round < 200; round++) {
        pthread_t thread[THREADS];
        bool fine[THREADS] = {false};
        begin(true, false, NULL);
        for (int i = 0; i < THREADS; i++)
            assert_int_equal(pthread_create(&thread[i], NULL, use, &fine[i]), 0);
        for (int i = 0; i < THREADS; i++) {
            pthread_join(thread[i], NULL);
            assert_true(fine[i]);
        }
        assert_int_equal(stand_in.opened, 1);
        assert_int_equal(stand_in.found, sizeof rtc / sizeof rtc.NewDevice);
    }
    pthread_barrier_destroy(&all_here);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_folder_of_the_build_comes_first),
        cmocka_unit_test(the_answer_stays),
        cmocka_unit_test(threads_open_it_once),
    };
    return cmocka_run_group_tests_name("embree_library", tests, NULL, NULL);
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
