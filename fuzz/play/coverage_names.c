#include "fuzz/play/coverage_bits.h"

#include <stdio.h>

static const char *const query_names[] = {"closest", "any"};
static const char *const depth_names[] = {"0",     "1",     "2",     "3",     "4",     "5",
                                          "6",     "7",     "8-9",   "10-11", "12-15", "16-19",
                                          "20-23", "24-31", "32-47", "48-"};
static const char *const leaf_names[] = {"1", "2", "3", "4", "5", "6", "7", "8", "9-15", "16-"};
static const char *const scale_names[] = {"0",      "-2^-126", "-2^-60", "-2^-24",
                                          "-2^-14", "-2^0",    "-2^10",  "-2^15",
                                          "-2^16",  "-2^24",   "-2^40",  "2^40-"};
static const char *const shape_names[] = {"empty", "single",  "flat",       "line",
                                          "point", "cut_box", "same_boxes", "mixed_scales"};
static const char *const count_names[] = {"items_32767",   "items_32768",   "items_65535",
                                          "items_65536",   "items_65537-",  "records_32767",
                                          "records_32768", "records_32769-"};
static const char *const stack_names[] = {"0",    "1",     "2",     "3-4",   "5-8",
                                          "9-15", "16-23", "24-31", "32-47", "48-"};
static const char *const half_names[] = {"infinite",  "65504",    "2^-14",
                                         "subnormal", "zero",     "minus_zero",
                                         "no_width",  "one_step", "power_of_two"};
static const char *const limit_names[] = {"leaf", "records", "indices", "bounds", "other"};
static const char *const truth_names[] = {"miss",     "inside",    "edge",      "vertex",
                                          "in_plane", "saw_plane", "refused",   "by_integers",
                                          "on_tmin",  "on_tmax",   "close_next"};
static const char *const tie_names[] = {"2", "3", "4", "5-8", "9-"};
static const char *const ray_names[] = {
    "out_of_contract", "one_axis", "parallel", "minus_zero", "subnormal", "zero", "nan", "infinite",
    "from_inside",     "on_face",  "endless",  "point",      "backward",  "fast", "slow"};
static const char *const error_names[] = {"0",    "-2^-8", "-2^-4", "-2^-2",
                                          "-0.5", "-0.75", "-1",    "1-"};
static const char *const displace_names[] = {"-1", "-4", "-16", "-64", "-256", "-1024", "1024-"};

static const char *const past_names[] = {"optimized", "split", "refitted", "rebuilt"};

/* As many names as bits. */
#define NAMED(GROUP, list)                                                                         \
    _Static_assert(ARRAY_COUNT(list) == COVERAGE_##GROUP##_LAST - COVERAGE_##GROUP + 1, #list)
NAMED(DEPTH, depth_names);
NAMED(LEAF, leaf_names);
NAMED(SCALE, scale_names);
NAMED(SHAPE, shape_names);
NAMED(COUNT, count_names);
NAMED(STACK, stack_names);
NAMED(HALF, half_names);
NAMED(TRUTH, truth_names);
NAMED(TIES, tie_names);
NAMED(RAY, ray_names);
NAMED(ERROR, error_names);
NAMED(DISPLACE, displace_names);
NAMED(PAST, past_names);

/* A group's bits are named by `list`; NULL: by tables of the library. */
static const struct {
    const char *prefix;
    const char *const *list;
    uint32_t first;
} groups[] = {
    {"verdict", NULL, COVERAGE_VERDICT},
    {"wrong", NULL, COVERAGE_WRONG},
    {"both", NULL, COVERAGE_BOTH},
    {"depth", depth_names, COVERAGE_DEPTH},
    {"leaf", leaf_names, COVERAGE_LEAF},
    {"members", NULL, COVERAGE_MEMBERS},
    {"scale", scale_names, COVERAGE_SCALE},
    {"shape", shape_names, COVERAGE_SHAPE},
    {"count", count_names, COVERAGE_COUNT},
    {"stack", stack_names, COVERAGE_STACK},
    {"half", half_names, COVERAGE_HALF},
    {"refused", NULL, COVERAGE_REFUSED},
    {"truth", truth_names, COVERAGE_TRUTH},
    {"ties", tie_names, COVERAGE_TIES},
    {"ray", ray_names, COVERAGE_RAY},
    {"error", error_names, COVERAGE_ERROR},
    {"displacement", displace_names, COVERAGE_DISPLACE},
    {"store", NULL, COVERAGE_STORE},
    {"tree", past_names, COVERAGE_PAST},
    {"layout", NULL, COVERAGE_PACKED},
};

uint32_t coverage_known(void)
{
    return COVERAGE_KNOWN;
}

/* Writes the name of pair `n` of unlike verdicts. */
static void name_both(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    for (uint32_t a = 0; a < VERDICT_COUNT; a++)
        for (uint32_t b = a + 1; b < VERDICT_COUNT; b++)
            if (n-- == 0)
                snprintf(name, COVERAGE_NAME_MOST, "both.%s.%s", verdict_name((enum verdict)a),
                         verdict_name((enum verdict)b));
}

/* The name of member `i` of a NULL-terminated table, "more" for those that share the last place. */
#define MEMBER(table, i, places) member((const void *const *)(table), (i), (places))
static int member(const void *const *table, uint32_t i, uint32_t places)
{
    uint32_t count = 0;
    while (table[count])
        count++;
    if (i >= count)
        return -1;
    return i == places - 1 && count > places ? -1 : (int)i;
}

static void name_members(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    int tri = MEMBER(tri_tests, n % COVERAGE_TRI_TESTS, COVERAGE_TRI_TESTS);
    n /= COVERAGE_TRI_TESTS;
    int box = MEMBER(box_tests, n % COVERAGE_BOX_TESTS, COVERAGE_BOX_TESTS);
    int builder = MEMBER(builders_all, n / COVERAGE_BOX_TESTS, COVERAGE_BUILDERS);
    snprintf(name, COVERAGE_NAME_MOST, "members.%s.%s.%s",
             builder < 0 ? "more" : builders_all[builder]->name,
             box < 0 ? "more" : box_tests[box]->name, tri < 0 ? "more" : tri_tests[tri]->name);
}

static void name_refused(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    int layout = MEMBER(layouts, n / COVERAGE_LIMITS, COVERAGE_LAYOUTS);
    snprintf(name, COVERAGE_NAME_MOST, "refused.%s.%s", layout < 0 ? "more" : layouts[layout]->name,
             limit_names[n % COVERAGE_LIMITS]);
}

static void name_store(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    int store = MEMBER(tri_stores, n, COVERAGE_STORES);
    snprintf(name, COVERAGE_NAME_MOST, "store.%s", store < 0 ? "more" : tri_stores[store]->name);
}

static void name_packed(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    int layout = MEMBER(layouts_all, n, COVERAGE_FORMS);
    snprintf(name, COVERAGE_NAME_MOST, "layout.%s",
             layout < 0 ? "more" : layouts_all[layout]->name);
}

bool coverage_name(uint32_t bit, char name[COVERAGE_NAME_MOST])
{
    name[0] = '\0';
    if (bit >= COVERAGE_KNOWN)
        return false;
    size_t group = ARRAY_COUNT(groups) - 1;
    while (bit < groups[group].first)
        group--;
    uint32_t n = bit - groups[group].first;
    if (groups[group].list)
        snprintf(name, COVERAGE_NAME_MOST, "%s.%s", groups[group].prefix, groups[group].list[n]);
    else if (groups[group].first == COVERAGE_VERDICT)
        snprintf(name, COVERAGE_NAME_MOST, "verdict.%s.%s", query_names[n / VERDICT_COUNT],
                 verdict_name((enum verdict)(n % VERDICT_COUNT)));
    else if (groups[group].first == COVERAGE_WRONG)
        snprintf(name, COVERAGE_NAME_MOST, "wrong.%s", wrong_name((enum wrong)n));
    else if (groups[group].first == COVERAGE_BOTH)
        name_both(n, name);
    else if (groups[group].first == COVERAGE_MEMBERS)
        name_members(n, name);
    else if (groups[group].first == COVERAGE_STORE)
        name_store(n, name);
    else if (groups[group].first == COVERAGE_PACKED)
        name_packed(n, name);
    else
        name_refused(n, name);
    return true;
}
