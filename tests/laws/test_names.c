/* Names that outputs have of the members of enumerations: each is its enumerator in lower case,
 * or another where the table has it, and no two of an enumeration are the same. */
#include "fuzz/play/signature.h"
#include "fuzz/shrink/shrink.h"
#include "ref/explain/explain.h"
#include "ref/explain/world_defect.h"
#include "ref/judge/leaks.h"
#include "ref/match/match.h"
#include "ref/oracle/oracle_world.h"
#include "ref/world/world_boxes.h"
#include "scenes/life_steps.h"
#include "scenes/rays/ray_modes.h"
#include "scenes/render/diff_frames.h"
#include "scenes/render/diff_why.h"

#include <ctype.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* The name, that of the enumerator, and the text if it is another. */
struct member_name {
    const char *family, *name, *enumerator, *other;
};
#define IS(function, prefix, member)                                                               \
    {                                                                                              \
#function, function(prefix##member), #member, NULL                                         \
    }
#define SAYS(function, prefix, member, text)                                                       \
    {                                                                                              \
#function, function(prefix##member), #member, text                                         \
    }

static void must_be_named(const struct member_name *member, size_t count, const char *family)
{
    for (size_t i = 0; i < count; i++) {
        char wanted[64];
        const char *plain = member[i].other ? member[i].other : member[i].enumerator;
        size_t length = strlen(plain);
        assert_true(length < sizeof wanted);
        for (size_t k = 0; k <= length; k++)
            wanted[k] = member[i].other ? plain[k] : (char)tolower((unsigned char)plain[k]);
        if (!member[i].name || strcmp(member[i].name, wanted) != 0)
            fail_msg("%s of %s: %s", member[i].family, member[i].enumerator, member[i].name);
        for (size_t k = 0; k < i; k++)
            if (strcmp(member[k].family, member[i].family) == 0)
                assert_string_not_equal(member[k].name, member[i].name);
    }
    print_message("%s: %zu names\n", family, count);
}

#define C(member) IS(cause_name, CAUSE_, member)
static void causes_are_named(void **state)
{
    (void)state;
    const struct member_name names[] = {
        C(NONE),
        C(INDEX_TRUNCATED),
        C(SLOT_NOT_READ),
        C(SENTINEL),
        C(INDEX_SHIFTED),
        C(WRONG_ITEM),
        C(STORED_TRIANGLE),
        C(HALF_OVERFLOW),
        C(HALF_SUBNORMAL_FLUSHED),
        C(ROUNDED_INWARD),
        C(STORED_BOX),
        C(CUT_BOX),
        C(ORIENTED_BOX),
        C(REFERENCE_TRUNCATED),
        C(CHILD_REFERENCE),
        C(PARALLEL_AXIS),
        C(STRICT_COMPARISON),
        C(BOX_PADDING_TOO_SMALL),
        C(BOX_TEST),
        C(ORIENTED_TEST),
        C(DETERMINANT_THRESHOLD),
        C(TRIANGLE_TEST),
        C(STACK),
        C(LOOP_CAP),
        C(CULLED_BY_BEST),
        C(STALE_BEST),
        C(LEAF_OVERFULL),
        C(ITEM_AS_NODE),
        C(BOUND_TOO_SMALL),
        C(TRIANGLE_LOST),
        C(TRIANGLE_TWICE),
        SAYS(cause_name, CAUSE_, ITEM_RANGE, "item_out_of_range"),
        SAYS(cause_name, CAUSE_, STACK_NEED, "stack_need_too_small"),
        C(RECORD_MALFORMED),
        C(PACK_RESULT),
        C(DEVICE_BUILD),
        C(DRIVER_ARITHMETIC),
        C(SHADER),
        C(NOT_REPEATABLE),
        C(STALE),
        C(SCALE),
        C(OUTSIDE),
        C(WORLD),
        C(UNEXPLAINED)};
    assert_int_equal(ARRAY_COUNT(names), CAUSE_COUNT);
    must_be_named(names, ARRAY_COUNT(names), "causes");
}

#define E(member) IS(explain_end_name, END_, member)
#define W(member) IS(world_cause_name, WORLD_CAUSE_, member)
static void ends_of_paths_and_causes_of_worlds_are_named(void **state)
{
    (void)state;
    const struct member_name names[] = {
        E(NOWHERE),
        E(BOX),
        SAYS(explain_end_name, END_, ORIENTED, "oriented_box"),
        E(SKIPPED),
        E(REFERENCE),
        E(SLOT),
        E(TRIANGLE),
        E(FARTHER),
        E(HIT),
        W(NONE),
        W(TRANSFORM),
        SAYS(world_cause_name, WORLD_CAUSE_, BOX, "world_box"),
        W(MASK),
        W(CULL),
        W(OPACITY),
        SAYS(world_cause_name, WORLD_CAUSE_, INDEX, "instance_index"),
        W(UNKNOWN)};
    must_be_named(names, ARRAY_COUNT(names), "ends and causes of worlds");
}

#define V(member) IS(verdict_name, VERDICT_, member)
#define X(member) IS(wrong_name, WRONG_, member)
static void verdicts_are_named(void **state)
{
    (void)state;
    const struct member_name names[] = {
        V(RIGHT),       V(TIE),        V(NEAR_TIE),       V(BOUNDARY),        V(BORDER),
        V(IN_PLANE),    V(SLAB),       V(NOISE),          V(OUT_OF_CONTRACT), V(WRONG),
        X(NOT),         X(MISSED),     X(PHANTOM),        X(TRIANGLE),        X(DISTANCE),
        X(BARYCENTRIC), X(NOT_FINITE), X(NOT_REPEATABLE), X(ANY_DISAGREES),   X(TWICE),
        X(ORDER),       X(MASKED),     X(CULLED),         X(OPACITY),         X(INSTANCE),
        X(FACING)};
    assert_int_equal(ARRAY_COUNT(names), VERDICT_COUNT + WRONG_COUNT);
    must_be_named(names, ARRAY_COUNT(names), "verdicts");
}

#define O(member) IS(oracle_class_name, ORACLE_, member)
#define A(member) IS(oracle_admission_name, ORACLE_, member)
#define L(member) IS(leak_aim_name, LEAK_, member)
#define R(member) IS(row_status_name, ROW_, member)
#define Q(member) IS(query_name, QUERY_, member)
#define M(member) IS(ray_modes_name, RAY_MODES_, member)
static void classes_and_rows_are_named(void **state)
{
    (void)state;
    const struct member_name names[] = {
        O(MISS),
        O(INSIDE),
        O(EDGE),
        O(VERTEX),
        O(IN_PLANE),
        O(ZERO_AREA),
        A(ADMITTED),
        A(MASKED),
        SAYS(oracle_admission_name, ORACLE_, CULLED_OPACITY, "culled by opacity"),
        SAYS(oracle_admission_name, ORACLE_, CULLED_FACING, "culled by facing"),
        A(FILTERED),
        L(VERTEX),
        L(MIDPOINT),
        L(EDGE),
        L(BESIDE),
        R(OK),
        R(REFUSED),
        R(SKIPPED),
        R(FAILED),
        R(VACUOUS),
        Q(CLOSEST),
        Q(ANY),
        Q(ALL),
        M(ALL),
        M(MIXED),
        M(DRAWN),
        SAYS(world_boxes_name, WORLD_BOXES_, AUTO, "auto"),
        SAYS(world_boxes_name, WORLD_BOXES_, OF_VERTICES, "vertices"),
        SAYS(world_boxes_name, WORLD_BOXES_, OF_CORNERS, "corners"),
        SAYS(life_act_name, LIFE_, REFIT, "refit"),
        SAYS(life_act_name, LIFE_, REBUILD, "rebuild")};
    must_be_named(names, ARRAY_COUNT(names), "classes and rows");
}

#define S(member) IS(motion_name, MOTION_, member)
#define F(member) IS(fuzz_kind_name, FUZZ_KIND_, member)
#define Y(member) IS(why_name, WHY_, member)
#define P(member) IS(path_field_name, PATH_, member)
static void motions_kinds_and_reasons_are_named(void **state)
{
    (void)state;
    const struct member_name names[] = {S(STILL),
                                        S(JITTER),
                                        S(ONE),
                                        S(MIRROR),
                                        S(SWAP),
                                        S(FAR),
                                        S(POINT),
                                        S(ZERO),
                                        S(SUBNORMAL),
                                        S(DRIFT),
                                        S(TURN),
                                        S(REFLECT),
                                        S(SCALE),
                                        S(EXCHANGE),
                                        S(GATHER),
                                        S(AWAY),
                                        S(MASKS),
                                        S(HIDE),
                                        F(BITS),
                                        F(UNFINISHED),
                                        F(REFUSED),
                                        F(TREE),
                                        F(CRASH),
                                        F(HANG),
                                        F(PROTOCOL),
                                        Y(SAME),
                                        Y(ROUNDING),
                                        Y(ALLOWED),
                                        Y(DRIFT),
                                        Y(PUBLISHED),
                                        Y(RENDERER),
                                        Y(WRONG),
                                        Y(UNEXPLAINED),
                                        P(SAME),
                                        P(PRIM),
                                        P(T),
                                        P(ASKED),
                                        P(SHADOWED),
                                        SAYS(shrink_end_name, SHRINK_, FIXPOINT, "fixpoint"),
                                        SAYS(shrink_end_name, SHRINK_, OUT_OF_ASKS, "asks"),
                                        SAYS(shrink_end_name, SHRINK_, OUT_OF_TIME, "time"),
                                        SAYS(shrink_end_name, SHRINK_, NOT_SHOWN, "not shown")};
    must_be_named(names, ARRAY_COUNT(names), "motions, kinds and reasons");
    for (enum wrong wrong = 1; wrong < WRONG_COUNT; wrong++) /* of a finding they are the judge's */
        assert_string_equal(fuzz_kind_name((enum fuzz_kind)(FUZZ_KIND_WRONG + (int)wrong)),
                            wrong_name(wrong));
}

/* What is no member has a name that none has, or none. */
static void others_have_no_name(void **state)
{
    (void)state;
    assert_string_equal(verdict_name(VERDICT_COUNT), "unknown");
    assert_string_equal(wrong_name(WRONG_COUNT), "unknown");
    assert_string_equal(oracle_class_name(ORACLE_CLASS_COUNT), "unknown");
    assert_string_equal(oracle_admission_name(ORACLE_ADMISSION_COUNT), "unknown");
    assert_string_equal(leak_aim_name(LEAK_AIMS), "unknown");
    assert_string_equal(row_status_name((enum row_status)(ROW_VACUOUS + 1)), "unknown");
    assert_string_equal(query_name(QUERY_COUNT), "unknown");
    assert_string_equal(why_name(WHY_COUNT), "unknown");
    assert_string_equal(path_field_name(PATH_FIELD_COUNT), "unknown");
    assert_null(ray_modes_name(RAY_MODES_COUNT));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(causes_are_named),
        cmocka_unit_test(ends_of_paths_and_causes_of_worlds_are_named),
        cmocka_unit_test(verdicts_are_named),
        cmocka_unit_test(classes_and_rows_are_named),
        cmocka_unit_test(motions_kinds_and_reasons_are_named),
        cmocka_unit_test(others_have_no_name),
    };
    return cmocka_run_group_tests_name("names", tests, NULL, NULL);
}
