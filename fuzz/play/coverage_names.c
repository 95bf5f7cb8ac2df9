#include "fuzz/play/coverage_bits.h"

#include <stdio.h>
#include <string.h>

static const struct coverage_group {
    const char *prefix, *words;
    uint32_t first, bits;
} groups[] = {
#define GROUP(id, count, name, names) {name, names, COVERAGE_##id, count},
    COVERAGE_GROUPS(GROUP)
#undef GROUP
};

uint32_t coverage_known(void)
{
    return COVERAGE_KNOWN;
}

uint32_t coverage_reachable(bool world)
{
    return world ? COVERAGE_KNOWN : COVERAGE_WORLD; /* what worlds have besides comes last */
}

/* Writes "GROUP.WORD", word `n` of the group's. False: it has not one word for each bit. */
static bool name_word(const struct coverage_group *group, uint32_t n, char name[COVERAGE_NAME_MOST])
{
    const char *word = group->words;
    uint32_t count = 1;
    for (const char *at = word; *at; at++)
        if (*at == ' ' && count++ == n)
            word = at + 1;
    snprintf(name, COVERAGE_NAME_MOST, "%s.%.*s", group->prefix, (int)strcspn(word, " "), word);
    return count == group->bits;
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

/* The name of member `i` of a NULL-terminated table of structs that begin with their names; "more"
 * for those that share the last place. */
#define MEMBER(table, i, places) member((const void *const *)(table), (i), (places))
static const char *member(const void *const *table, uint32_t i, uint32_t places)
{
    uint32_t count = 0;
    while (table[count])
        count++;
    bool shared = i == places - 1 && count > places;
    return i < count && !shared ? *(const char *const *)table[i] : "more";
}

static void name_members(uint32_t n, char name[COVERAGE_NAME_MOST])
{
    uint32_t tri = n % COVERAGE_TRI_TESTS, rest = n / COVERAGE_TRI_TESTS;
    snprintf(name, COVERAGE_NAME_MOST, "members.%s.%s.%s",
             MEMBER(builders_all, rest / COVERAGE_BOX_TESTS, COVERAGE_BUILDERS),
             MEMBER(box_tests, rest % COVERAGE_BOX_TESTS, COVERAGE_BOX_TESTS),
             MEMBER(tri_tests, tri, COVERAGE_TRI_TESTS));
}

bool coverage_name(uint32_t bit, char name[COVERAGE_NAME_MOST])
{
    name[0] = '\0';
    if (bit >= COVERAGE_KNOWN)
        return false;
    const struct coverage_group *group = groups;
    while (bit >= group->first + group->bits)
        group++;
    uint32_t n = bit - group->first;
    if (group->words)
        return name_word(group, n, name);
    static const char *const limits[] = {"leaf", "records", "indices", "bounds", "other"};
    switch (group->first) {
    case COVERAGE_VERDICT:
        snprintf(name, COVERAGE_NAME_MOST, "verdict.%s.%s", n < VERDICT_COUNT ? "closest" : "any",
                 verdict_name((enum verdict)(n % VERDICT_COUNT)));
        break;
    case COVERAGE_WRONG:
        snprintf(name, COVERAGE_NAME_MOST, "wrong.%s", wrong_name((enum wrong)n));
        break;
    case COVERAGE_BOTH:
        name_both(n, name);
        break;
    case COVERAGE_MEMBERS:
        name_members(n, name);
        break;
    case COVERAGE_STORE:
        snprintf(name, COVERAGE_NAME_MOST, "store.%s", MEMBER(tri_stores, n, COVERAGE_STORES));
        break;
    case COVERAGE_PACKED:
        snprintf(name, COVERAGE_NAME_MOST, "layout.%s", MEMBER(layouts_all, n, COVERAGE_FORMS));
        break;
    default:
        snprintf(name, COVERAGE_NAME_MOST, "refused.%s.%s",
                 MEMBER(layouts, n / COVERAGE_LIMITS, COVERAGE_LAYOUTS),
                 limits[n % COVERAGE_LIMITS]);
    }
    return true;
}
