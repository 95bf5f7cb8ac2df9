/* Signatures of findings: what they hold, their texts, and the folders that they name. */
#include "fuzz/play/signature.h"
#include "ref/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

static void signature_prints_and_parses_every_kind_and_cause(void **state)
{
    (void)state;
    char text[FUZZ_SIGNATURE_MOST];
    static const char *const names[] = {"cpu", "embree_robust", "pipe:my.tracer-2+x", "a"};
    size_t count = 0;
    for (size_t n = 0; n < ARRAY_COUNT(names); n++)
        for (enum fuzz_kind kind = FUZZ_KIND_WRONG + 1; kind < FUZZ_KIND_COUNT; kind++)
            for (enum cause cause = CAUSE_NONE; cause < CAUSE_COUNT; cause++) {
                struct fuzz_signature made = {.kind = kind, .cause = cause}, again;
                made.layout = count % 3 ? layouts[count % 3 - 1] : NULL;
                fuzz_signature_set_engine(&made, names[n]);
                assert_string_equal(made.engine, names[n]);
                fuzz_signature_print(&made, text);
                assert_null(strchr(text, '/'));
                assert_int_equal(fuzz_signature_parse(text, &again, &reason), STATUS_OK);
                assert_true(fuzz_signature_same(&made, &again));
                count++;
            }
    assert_true(count > 1000);
}

static void signatures_differ_in_every_field(void **state)
{
    (void)state;
    struct fuzz_signature one = {
        .layout = layouts[0], .kind = FUZZ_KIND_BITS, .cause = CAUSE_STACK};
    fuzz_signature_set_engine(&one, "cpu");
    struct fuzz_signature other[5] = {one, one, one, one, one};
    fuzz_signature_set_engine(&other[0], "cpu2");
    other[1].layout = layouts[1];
    other[2].layout = NULL;
    other[3].kind = FUZZ_KIND_CRASH;
    other[4].cause = CAUSE_SHADER;
    for (size_t i = 0; i < ARRAY_COUNT(other); i++)
        assert_false(fuzz_signature_same(&one, &other[i]) || fuzz_signature_same(&other[i], &one));
}

/* Names that a signature holds are told apart by their last byte; longer ones are not held. */
static void signatures_hold_whole_names(void **state)
{
    (void)state;
    char name[128], other[128];
    for (size_t length = 1; length < 120; length++) {
        struct fuzz_signature a, b;
        memset(name, 'a', length);
        name[length] = '\0';
        strcpy(other, name);
        other[length - 1] = 'b';
        fuzz_signature_set_engine(&a, name);
        fuzz_signature_set_engine(&b, other);
        assert_int_equal(fuzz_signature_holds(name), length <= 94);
        if (fuzz_signature_holds(name))
            assert_string_not_equal(a.engine, b.engine);
    }
    /* Folders of a command are not part of it. */
    memset(name, 'x', sizeof name - 1);
    memcpy(name, "pipe:/", 6);
    strcpy(name + 118, "/tracer");
    assert_true(fuzz_signature_holds(name));
}

/* A folder's name is one on every system, and gives the signature again; so does an older one. */
static void folders_have_names_that_every_store_takes(void **state)
{
    (void)state;
    static const char *const command[] = {"pipe:python3 /a/one.py", "pipe:python3 /a/two.py",
                                          "pipe:a:b \"c\" <d >e |f *g ?h \\i", "cpu"};
    char folder[FUZZ_SIGNATURE_MOST], text[FUZZ_SIGNATURE_MOST], first[FUZZ_SIGNATURE_MOST] = "";
    for (size_t i = 0; i < ARRAY_COUNT(command); i++) {
        struct fuzz_signature made = {.kind = FUZZ_KIND_BITS, .cause = CAUSE_STACK}, again;
        fuzz_signature_set_engine(&made, command[i]);
        fuzz_signature_folder(&made, folder);
        assert_null(strpbrk(folder, ":\"<>|*?\\/\r\n"));
        assert_string_not_equal(folder, first);
        strcpy(first, folder);
        assert_int_equal(fuzz_signature_of_folder(folder, &again, &reason), STATUS_OK);
        assert_true(fuzz_signature_same(&made, &again));
        fuzz_signature_print(&made, text);
        assert_int_equal(fuzz_signature_of_folder(text, &again, &reason), STATUS_OK);
        assert_true(fuzz_signature_same(&made, &again));
    }
}

/* A signature names a folder: nothing may lead out of it. */
static void signature_refuses_what_names_no_folder(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",
        "cpu",
        "cpu.rf16.missed",
        "..rf16.missed.stack",
        "../x.rf16.missed.stack",
        "a/b.rf16.missed.stack",
        ".hidden.rf16.missed.stack",
        "a b.rf16.missed.stack",
        "a\n.rf16.missed.stack",
        ".rf16.missed.stack",
        "cpu.rf17.missed.stack",
        "cpu..missed.stack",
        "cpu.rf16.lost.stack",
        "cpu.rf16.not.stack",
        "cpu.rf16.missed.luck",
        "cpu.rf16.missed.",
        "engine_of_a_name_that_is_far_too_long_for_a_signature_even_of_one_that_has_every_word_"
        "of_a_variant.rf16.missed.stack",
    };
    struct fuzz_signature signature;
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        reason.text[0] = '\0';
        if (fuzz_signature_parse(bad[i], &signature, &reason) != STATUS_INPUT)
            fail_msg("'%s' passes", bad[i]);
        assert_true(reason.text[0] != '\0');
        assert_true(signature.engine[0] == '\0');
    }
    char longest[1000];
    memset(longest, 'a', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    assert_int_equal(fuzz_signature_parse(longest, &signature, &reason), STATUS_INPUT);
    fuzz_signature_set_engine(&signature, "../a b/\x80");
    assert_string_equal(signature.engine, "_._a_b__");
    fuzz_signature_set_engine(&signature, "pipe: /opt/x y/my.tracer --fast a/b");
    assert_string_equal(signature.engine, "pipe:x_my.tracer_--fast_b");
    fuzz_signature_set_engine(&signature, "pipe:./build/my.tracer --fast a/b");
    assert_string_equal(signature.engine, "pipe:my.tracer_--fast_b");
    fuzz_signature_set_engine(&signature, "pipe:./build/my.tracer");
    assert_string_equal(signature.engine, "pipe:my.tracer");
    fuzz_signature_set_engine(&signature, longest);
    assert_int_equal(strlen(signature.engine), sizeof signature.engine - 1);
}

/* A folder's name of any length is that of a signature only if it is as short as one. */
static void long_names_are_of_no_signature(void **state)
{
    (void)state;
    for (size_t length = FUZZ_SIGNATURE_MOST - 3; length < 3 * FUZZ_SIGNATURE_MOST; length++) {
        char name[3 * FUZZ_SIGNATURE_MOST], why[80];
        struct fuzz_signature out;
        snprintf(why, sizeof why, "a signature has at most %d characters", FUZZ_SIGNATURE_MOST - 1);
        memset(name, 'a', length);
        strcpy(name + length - 11, ".-.crash.-x");
        assert_int_equal(strlen(name), length);
        assert_int_equal(fuzz_signature_of_folder(name, &out, &reason), STATUS_INPUT);
        assert_int_equal(strcmp(reason.text, why) == 0, length >= FUZZ_SIGNATURE_MOST);
        assert_int_equal(out.engine[0], 0);
    }
}

/* Of a word its folders are left out, but never all of it: one that ends in a slash keeps its last
 * name. */
static void a_word_keeps_its_last_name(void **state)
{
    (void)state;
    static const char *const word[][2] = {{"/opt/a/b", "b"}, {"/opt/a/b/", "b_"}, {"b/", "b_"},
                                          {"/", "_"},        {"x", "x"},          {"a//b", "b"}};
    for (size_t i = 0; i < ARRAY_COUNT(word); i++)
        for (size_t k = 0; k < ARRAY_COUNT(word); k++) {
            struct fuzz_signature signature;
            char name[60], wanted[60];
            snprintf(name, sizeof name, "pipe:%s  %s", word[i][0], word[k][0]);
            snprintf(wanted, sizeof wanted, "pipe:%s_%s", word[i][1], word[k][1]);
            fuzz_signature_set_engine(&signature, name);
            assert_string_equal(signature.engine, wanted);
        }
}

/* Every engine is found by its signature, those from outside by what is left of their names; the
 * first of several that have the same; and none by what is no engine's. */
static void each_engine_is_found_by_its_signature(void **state)
{
    (void)state;
    static struct engine outside[] = {
        {.name = "/opt/a b/tracer.so"}, {.name = "./tracer2.so"},
        {.name = "inside:../x/y.so"},   {.name = "pipe:python3 /a/one.py --fast"},
        {.name = "shader:/p/q.comp"},   {.name = "/elsewhere/tracer.so"}};
    static const char *const none[] = {"tracer.s", "tracer3.so", "python3", "cp", "cpu2"};
    const struct engine *added;
    size_t count = 0;
    for (size_t i = 0; i < ARRAY_COUNT(outside); i++)
        assert_int_equal(engine_add(&outside[i], &added, &reason), STATUS_OK);
    for (; engines[count]; count++) {
        struct fuzz_signature of, other;
        size_t first = 0;
        fuzz_signature_set_engine(&of, engines[count]->name);
        for (;; first++) {
            fuzz_signature_set_engine(&other, engines[first]->name);
            if (strcmp(of.engine, other.engine) == 0)
                break;
        }
        assert_ptr_equal(fuzz_signature_engine(&of), engines[first]);
        assert_true(first == count || strcmp(engines[count]->name, "/elsewhere/tracer.so") == 0);
    }
    assert_true(count > ARRAY_COUNT(outside) + 5);
    for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
        struct fuzz_signature of;
        fuzz_signature_set_engine(&of, none[i]);
        assert_null(fuzz_signature_engine(&of));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_word_keeps_its_last_name),
        cmocka_unit_test(each_engine_is_found_by_its_signature),
        cmocka_unit_test(signature_prints_and_parses_every_kind_and_cause),
        cmocka_unit_test(signatures_differ_in_every_field),
        cmocka_unit_test(signatures_hold_whole_names),
        cmocka_unit_test(folders_have_names_that_every_store_takes),
        cmocka_unit_test(signature_refuses_what_names_no_folder),
        cmocka_unit_test(long_names_are_of_no_signature),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
