#include "ref/explain/repair.h"

#include <string.h>

static const struct {
    const char *name, *text;
} causes[CAUSE_COUNT] = {
    [CAUSE_NONE] = {"none", "the answer is allowed"},
    [CAUSE_INDEX_TRUNCATED] = {"index_truncated",
                               "a triangle's index has more bits than its field"},
    [CAUSE_SLOT_NOT_READ] = {"slot_not_read", "an item slot that leaves use is not read"},
    [CAUSE_SENTINEL] = {"sentinel", "triangle 0 or a stored 0 is taken for an empty slot"},
    [CAUSE_INDEX_SHIFTED] = {"index_shifted", "items are numbered one off"},
    [CAUSE_WRONG_ITEM] = {"wrong_item", "a leaf tests other triangles than the tree gave it"},
    [CAUSE_STORED_TRIANGLE] = {"stored_triangle",
                               "the triangle storage holds another triangle than the scene's"},
    [CAUSE_HALF_OVERFLOW] = {"half_overflow", "a stored bound is infinite or not a number"},
    [CAUSE_HALF_SUBNORMAL_FLUSHED] = {"half_subnormal_flushed",
                                      "a bound below 2^-14 in magnitude reads as 0"},
    [CAUSE_ROUNDED_INWARD] = {"rounded_inward",
                              "a stored bound lies inside the tree's, within a float16 step"},
    [CAUSE_STORED_BOX] = {"stored_box",
                          "a stored bound lies inside the tree's by more than rounding can do"},
    [CAUSE_CUT_BOX] = {"cut_box", "the builder's box does not contain its own triangles"},
    [CAUSE_ORIENTED_BOX] = {"oriented_box", "an oriented box does not contain what is below it"},
    [CAUSE_REFERENCE_TRUNCATED] = {"reference_truncated",
                                   "a record's index has more bits than its field"},
    [CAUSE_CHILD_REFERENCE] = {"child_reference",
                               "a child reference leads elsewhere, or a node is misread"},
    [CAUSE_PARALLEL_AXIS] = {"parallel_axis", "the box test divides by a direction component of 0"},
    [CAUSE_STRICT_COMPARISON] = {"strict_comparison", "the box test has < where <= is needed"},
    [CAUSE_BOX_PADDING_TOO_SMALL] = {"box_padding_too_small",
                                     "the box test does not allow for all roundings"},
    [CAUSE_BOX_TEST] = {"box_test", "the box test turns away a ray that meets the box"},
    [CAUSE_ORIENTED_TEST] = {"oriented_test",
                             "the test of oriented boxes turns away a ray that meets one"},
    [CAUSE_DETERMINANT_THRESHOLD] = {"determinant_threshold",
                                     "the determinant is under an absolute threshold"},
    [CAUSE_TRIANGLE_TEST] = {"triangle_test", "the triangle test is wrong beyond its own bound"},
    [CAUSE_STACK] = {"stack", "the traversal stack was full"},
    [CAUSE_LOOP_CAP] = {"loop_cap", "a loop ended before its own condition did"},
    [CAUSE_CULLED_BY_BEST] = {"culled_by_best", "a box was skipped for a hit that is none"},
    [CAUSE_STALE_BEST] = {"stale_best", "a farther triangle replaced a nearer one"},
    [CAUSE_LEAF_OVERFULL] = {"leaf_overfull",
                             "a leaf has more triangles than its record has slots"},
    [CAUSE_ITEM_AS_NODE] = {"item_as_node", "items of a leaf are taken for references to nodes"},
    [CAUSE_BOUND_TOO_SMALL] = {"bound_too_small", "a stored box does not contain what is below it"},
    [CAUSE_TRIANGLE_LOST] = {"triangle_lost", "a triangle is in no leaf"},
    [CAUSE_TRIANGLE_TWICE] = {"triangle_twice", "a triangle is in the leaves a second time"},
    [CAUSE_ITEM_RANGE] = {"item_out_of_range",
                          "a leaf has an index that is no triangle of the scene"},
    [CAUSE_STACK_NEED] = {"stack_need_too_small",
                          "a path needs more stack entries than the packed tree says"},
    [CAUSE_RECORD_MALFORMED] = {"record_malformed", "a record does not decode to a node"},
    [CAUSE_PACK_RESULT] = {"pack_result",
                           "pack() returned other arrays or counts than it was given"},
    [CAUSE_DEVICE_BUILD] = {"device_build", "a device built another tree than C"},
    [CAUSE_DRIVER_ARITHMETIC] = {"driver_arithmetic",
                                 "an operator of the engine does not round as C does"},
    [CAUSE_SHADER] = {"shader", "C is right on the same bytes and the engine's operators are "
                                "exact: its own code differs"},
    [CAUSE_NOT_REPEATABLE] = {"not_repeatable", "the engine returned two answers for the same ray"},
    [CAUSE_STALE] = {"stale", "right if the engine is prepared anew: its update kept something of "
                              "before"},
    [CAUSE_SCALE] = {"scale", "right at another scale: a constant that does not scale, or "
                              "underflow"},
    [CAUSE_OUTSIDE] = {"outside", "unexplained: the engine's tree cannot be read"},
    [CAUSE_WORLD] = {"world", "unexplained: the engine's trees of a world cannot be read"},
    [CAUSE_UNEXPLAINED] = {"unexplained", "no known cause predicts the answer"},
};

const char *cause_name(enum cause cause)
{
    return causes[cause].name;
}

bool cause_find(const char *name, enum cause *out)
{
    for (*out = CAUSE_NONE; *out < CAUSE_COUNT; (*out)++)
        if (strcmp(name, causes[*out].name) == 0)
            return true;
    return false;
}

const char *cause_text(enum cause cause)
{
    return causes[cause].text;
}

static const struct {
    enum cause cause;
    const char *text;
} repairs[REPAIR_COUNT] = {
    [REPAIR_ITEM_TRUNCATED] = {CAUSE_INDEX_TRUNCATED, "items that were cut to fewer bits restored"},
    [REPAIR_ITEM_SLOT] = {CAUSE_SLOT_NOT_READ, "every item slot read"},
    [REPAIR_ITEM_SENTINEL] = {CAUSE_SENTINEL, "slots that read as empty restored"},
    [REPAIR_ITEM_SHIFTED] = {CAUSE_INDEX_SHIFTED, "items one off restored"},
    [REPAIR_ITEM_OTHER] = {CAUSE_WRONG_ITEM, "all other wrong items restored"},
    [REPAIR_ITEM_STORED] = {CAUSE_STORED_TRIANGLE, "stored triangles replaced by the scene's"},
    [REPAIR_REF_TRUNCATED] = {CAUSE_REFERENCE_TRUNCATED, "references that were cut restored"},
    [REPAIR_BOX_OVERFLOW] = {CAUSE_HALF_OVERFLOW, "bounds that are not finite restored"},
    [REPAIR_BOX_FLUSHED] = {CAUSE_HALF_SUBNORMAL_FLUSHED, "bounds flushed to 0 restored"},
    [REPAIR_BOX_ROUNDED] = {CAUSE_ROUNDED_INWARD, "bounds rounded inward restored"},
    [REPAIR_BOX_STORED] = {CAUSE_STORED_BOX, "all other bounds inside the tree's restored"},
    [REPAIR_BOX_CUT] = {CAUSE_CUT_BOX, "boxes grown to contain their triangles"},
    [REPAIR_ORIENTED_BOX] = {CAUSE_ORIENTED_BOX, "oriented boxes that are too small left out"},
    [REPAIR_REF] = {CAUSE_CHILD_REFERENCE, "all other child references restored"},
    [REPAIR_PARALLEL] = {CAUSE_PARALLEL_AXIS, "box test: axes of direction 0 by comparison"},
    [REPAIR_CLOSED] = {CAUSE_STRICT_COMPARISON, "box test: <= for <"},
    [REPAIR_PADDING] = {CAUSE_BOX_PADDING_TOO_SMALL, "box test: planes padded"},
    [REPAIR_BOX_TEST] = {CAUSE_BOX_TEST, "box test: conservative, in double"},
    [REPAIR_ORIENTED_TEST] = {CAUSE_ORIENTED_TEST, "oriented boxes: conservative test, in double"},
    [REPAIR_WATERTIGHT] = {CAUSE_BOX_PADDING_TOO_SMALL, "box test: watertight"},
    [REPAIR_THRESHOLD] = {CAUSE_DETERMINANT_THRESHOLD, "triangle test: no threshold"},
    [REPAIR_STACK] = {CAUSE_STACK, "stack without end"},
    [REPAIR_VISITS] = {CAUSE_LOOP_CAP, "four times the visits"},
    [REPAIR_CULLING] = {CAUSE_CULLED_BY_BEST, "boxes are not culled by the best hit"},
    [REPAIR_TRIANGLE] = {CAUSE_TRIANGLE_TEST, "triangle test: exact"},
};

enum cause repair_cause(enum repair repair)
{
    return repairs[repair].cause;
}

const char *repair_text(enum repair repair)
{
    return repairs[repair].text;
}

static const struct {
    enum cause cause;
    const char *text;
} defects[DEFECT_COUNT] = {
    [DEFECT_NONE] = {CAUSE_NONE, "nothing planted"},
    [DEFECT_SLOT] = {CAUSE_SLOT_NOT_READ, "an item slot is not read"},
    [DEFECT_ZERO] = {CAUSE_SENTINEL, "triangle 0 is an empty slot"},
    [DEFECT_SHIFT] = {CAUSE_INDEX_SHIFTED, "items are numbered one off"},
    [DEFECT_NEAR_AGAIN] = {CAUSE_CHILD_REFERENCE, "the near child is pushed for the far one"},
    [DEFECT_FAR_DROPPED] = {CAUSE_STACK, "entries that overflow the stack are lost"},
    [DEFECT_STACK_FULL] = {CAUSE_STACK, "the stack is shorter, and an overflow ends the traversal"},
    [DEFECT_FLUSHED] = {CAUSE_HALF_SUBNORMAL_FLUSHED, "small bounds read as 0"},
    [DEFECT_STRICT] = {CAUSE_STRICT_COMPARISON, "box test: < for <="},
    [DEFECT_NOT_PADDED] = {CAUSE_BOX_PADDING_TOO_SMALL,
                           "box test: planes padded by so many 2^-24 only"},
    [DEFECT_NOT_BEHIND] = {CAUSE_BOX_PADDING_TOO_SMALL,
                           "box test: nothing reaches behind the origin"},
    [DEFECT_SLAB_FUSED] = {CAUSE_DRIVER_ARITHMETIC, "box test: b / d - o / d by fma"},
    [DEFECT_SLAB_SPLIT] = {CAUSE_DRIVER_ARITHMETIC, "box test: b / d - o / d"},
    [DEFECT_ORIENTED_TURNED] = {CAUSE_ORIENTED_TEST,
                                "oriented boxes: rows and columns of the axes exchanged"},
    [DEFECT_ORIENTED_SHIFTED] = {CAUSE_ORIENTED_TEST,
                                 "oriented boxes: each axis has the bounds of the next"},
    [DEFECT_EDGE_FUSED] = {CAUSE_DRIVER_ARITHMETIC, "triangle test: contracted to fma"},
    [DEFECT_LAST_WINS] = {CAUSE_STALE_BEST, "the last triangle of a leaf wins"},
    [DEFECT_LOOP] = {CAUSE_LOOP_CAP, "the traversal ends early"},
};

enum cause defect_cause(enum defect defect)
{
    return defects[defect].cause;
}

const char *defect_text(enum defect defect)
{
    return defects[defect].text;
}

bool defect_is_numbered(enum defect defect)
{
    return defect == DEFECT_SLOT || defect == DEFECT_FAR_DROPPED || defect == DEFECT_STACK_FULL ||
           defect == DEFECT_NOT_PADDED || defect == DEFECT_LOOP;
}
