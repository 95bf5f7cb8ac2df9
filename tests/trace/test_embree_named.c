/* How modes of Embree are called, and what a device says of its ISA. */
#include <stdio.h>
#include <string.h>

#include "ref/engines/embree_isa.h"
#include "ref/engines/embree_named.h"
#include "tests/support/world_laws.h"
#include "tests/support/embree_mode_names.h"

/* --- names ------------------------------------------------------------------------------------ */

/* What is written is read as the same mode, no two modes have one name, and its length fits. */
static void names_are_of_one_mode(void **state)
{
    (void)state;
    enum { FLAGS = 12, MODES = EMBREE_ISAS * 4 * EMBREE_QUALITIES * FLAGS };
    static char name[MODES][EMBREE_NAME_MOST];
    size_t count = 0;
    for (int isa = 0; isa < EMBREE_ISAS; isa++)
        for (size_t w = 0; w < 4; w++)
            for (int quality = 0; quality < EMBREE_QUALITIES; quality++)
                for (int flags = 0; flags < FLAGS; flags++) {
                    const struct embree_mode mode = {(enum embree_isa)isa,
                                                     widths[w],
                                                     (enum embree_quality)quality,
                                                     flags & 1,
                                                     flags & 2,
                                                     flags >= 4,
                                                     flags >= 8};
                    embree_named_write(&mode, name[count]);
                    assert_true(strlen(name[count]) + 1 < EMBREE_NAME_MOST);
                    if (embree_is_named(name[count])) {
                        const struct embree_mode again = parsed(name[count]);
                        expect_equal(&again, &mode);
                    }
                    for (size_t i = 0; i < count; i++)
                        assert_string_not_equal(name[i], name[count]);
                    count++;
                }
    assert_string_equal(name[0], "embree");
    assert_string_equal(name[1], "embree_robust");
    assert_int_equal(count, MODES);
}

static void names_have_words_in_any_order(void **state)
{
    (void)state;
    static const char *const same[] = {
        "embree:sse42:8:high:robust:compact", "embree:compact:robust:high:8:sse42",
        "embree:8:sse4.2:robust:compact:high", "embree:robust:high:sse4.2:compact:8"};
    static const char *const none[] = {
        "embree:",          "embree:sse",        "embree:avx2:",         "embree::avx2",
        "embree:avx2:avx2", "embree:avx:avx2",   "embree:4:8",           "embree:1:1",
        "embree:low:high",  "embree:medium:low", "embree:robust:robust", "embree:compact:compact",
        "embree:2",         "embree:AVX2",       "embree:avx2 ",         "embree:all"};
    const struct embree_mode want = {EMBREE_ISA_SSE42, 8, EMBREE_HIGH, true, true, false, false};
    char name[EMBREE_NAME_MOST];
    for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
        const struct embree_mode mode = parsed(same[i]);
        expect_equal(&mode, &want);
        embree_named_write(&mode, name);
        assert_string_equal(name, same[0]);
    }
    for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
        struct embree_mode mode;
        struct reason reason = {""};
        const struct engine *engine;
        assert_int_equal(embree_named_parse(none[i], &mode, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "is no word for a mode of Embree"));
        assert_int_equal(embree_named(none[i], &engine, &reason), STATUS_INPUT);
        assert_null(engine);
        assert_null(embree_named_plain(none[i]));
    }
    assert_string_equal(embree_named_plain("embree:avx2:8"), "embree");
    assert_string_equal(embree_named_plain("embree:8:robust"), "embree_robust");
    assert_null(embree_named_plain("embree"));
    assert_null(embree_named_plain("embree_robust"));
}

#if HAVE_EMBREE

static size_t engine_count(void)
{
    size_t count = 0;
    while (engines[count])
        count++;
    return count;
}

/* However often and in whatever order its words stand, a mode is one engine. */
static void a_mode_is_one_engine(void **state)
{
    (void)state;
    static const char *const spelt[][3] = {
        {"embree:low:compact", "embree:compact:low", "embree:low:compact"},
        {"embree:4:robust", "embree:robust:4", "embree:4:robust"},
        {"embree:refit:high:8", "embree:8:high:refit", "embree:high:refit:8"},
        {"embree:robust", "embree:robust:1", "embree:1:robust"},
        {"embree:1", "embree:medium", "embree:1:medium"}};
    const struct engine *first[ARRAY_COUNT(spelt)];
    const size_t before = engine_count();
    size_t added = 0;
    for (size_t turn = 0; turn < 3; turn++)
        for (size_t k = 0; k < 3; k++)
            for (size_t i = 0; i < ARRAY_COUNT(spelt); i++) {
                struct reason reason = {""};
                const struct engine *engine;
                if (embree_named(spelt[i][k], &engine, &reason))
                    fail_msg("%s: %s", spelt[i][k], reason.text);
                if (turn + k == 0) {
                    first[i] = engine;
                    added += strchr(engine->name, ':') != NULL;
                }
                assert_ptr_equal(engine, first[i]);
                assert_ptr_equal(engine_find(engine->name), engine);
            }
    assert_int_equal(added, 3);
    assert_int_equal(engine_count(), before + added);
}

/* --- ISAs ------------------------------------------------------------------------------------- */

/* Both of "Targets" count, and only whole words of these lines. */
static void what_a_device_says_is_the_best_of_both(void **state)
{
    (void)state;
    static const struct {
        const char *told, *made;
        enum embree_isa runs;
    } said[] = {
        {"SSE SSE2 SSE3 AVX AVXI AVX2 AVX512", "SSE2 SSE4.2 AVX AVX2 AVX512", EMBREE_ISA_AVX512},
        {"SSE SSE2 SSE3 AVX AVXI AVX2 AVX512", "SSE2 SSE4.2 AVX AVX2", EMBREE_ISA_AVX2},
        {"SSE SSE2 SSE3 AVX AVXI", "SSE2 SSE4.2 AVX AVX2 AVX512", EMBREE_ISA_AVX},
        {"SSE SSE2 SSE4.1 SSE4.2", "SSE2 SSE4.2 AVX AVX2 AVX512", EMBREE_ISA_SSE42},
        {"SSE SSE2 SSE4.1 SSE4.2", "SSE2", EMBREE_ISA_SSE2},
        {"SSE SSE2 SSE3 AVXI AVX22", "SSE2 AVX AVX2", EMBREE_ISA_SSE2},
        {"NEON", "SSE2 AVX2", EMBREE_ISA_OWN},
    };
    for (size_t i = 0; i < ARRAY_COUNT(said); i++) {
        char text[600];
        snprintf(text, sizeof text,
                 "  CPU\n    Targets : SSE SSE2 AVX2 AVX512 \n  Config\n    ISA : AVX512 \n"
                 "    Targets : %s  (supported)\n              %s  (compile time enabled)\n",
                 said[i].told, said[i].made);
        assert_int_equal(embree_isa_said(text), said[i].runs);
    }
    assert_int_equal(embree_isa_said(""), EMBREE_ISA_OWN);
    assert_int_equal(embree_isa_said("Targets : AVX2  (supported)\n"), EMBREE_ISA_OWN);
}

#endif

static void without_embree_no_mode_can_run(void **state)
{
    (void)state;
    struct reason reason = {""};
    const struct engine *engine;
    if (HAVE_EMBREE)
        return;
    assert_int_equal(embree_named("embree:avx2", &engine, &reason), STATUS_UNSUPPORTED);
    assert_null(engine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_of_one_mode),
        cmocka_unit_test(names_have_words_in_any_order),
#if HAVE_EMBREE
        cmocka_unit_test(a_mode_is_one_engine),
        cmocka_unit_test(what_a_device_says_is_the_best_of_both),
#endif
        cmocka_unit_test(without_embree_no_mode_can_run),
    };
    return cmocka_run_group_tests_name("embree_named", tests, NULL, NULL);
}
