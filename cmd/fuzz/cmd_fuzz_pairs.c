/* The members that pairs are formed from, and the report on pairs. */
#include "cmd/fuzz/cmd_fuzz.h"
#include "cmd/common/cmd_screen.h"

#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdio.h>

#define RAREST_SHOWN 5u
#define RAREST_TOLD  50u /* in JSON */

static void add(struct pair_tables *tables, enum pair_factor factor, const void *member)
{
    if (tables->count[factor] < MEET_MOST)
        tables->member[factor][tables->count[factor]++] = member;
}

/* The members that can be drawn or generated. Members as published count with --faithful, and such
 * layouts also if they are named. Only the names decide, so a resumed folder gives the same
 * members. */
static void fill(const struct fuzz_command *c, struct pair_tables *t)
{
    const struct fuzz_field *field = &c->campaign.rules.field;
    bool all = c->faithful, drawn = c->pairs > 0;
    for (size_t i = 0; i < field->count; i++)
        if (i == 0 || field->who[i].engine != field->who[i - 1].engine)
            add(t, MEET_ENGINE, field->who[i].engine);
    for (size_t i = 0; i < c->layout.count; i++) {
        const struct layout *layout = layouts_all[c->layout.index[i]];
        if (!drawn || all || !layout->faithful || !fuzz_has_every_layout(c))
            add(t, MEET_LAYOUT, layout);
    }
    for (size_t i = 0; i < c->builder.count; i++)
        add(t, MEET_BUILDER, builders_all[c->builder.index[i]]);
    for (size_t i = 0; builders_all[i] && c->builder.count == 0; i++)
        if ((all || !builders_all[i]->faithful) && !builders_all[i]->compare)
            add(t, MEET_BUILDER, builders_all[i]);
    for (size_t i = 0; tri_stores[i] && (drawn || i == 0); i++)
        add(t, MEET_STORE, tri_stores[i]);
    for (size_t i = 0; tri_tests[i]; i++)
        if (all || !tri_tests[i]->faithful)
            add(t, MEET_TRI, tri_tests[i]);
    for (size_t i = 0; box_tests[i]; i++)
        if (all || !box_tests[i]->faithful)
            add(t, MEET_BOX, box_tests[i]);
    t->count[MEET_OPTIMIZE] = drawn ? MEET_OPTIMIZATIONS : 1;
    t->count[MEET_MOTION] = drawn ? 2 : 1;
}

enum status fuzz_pairs_make(struct fuzz_command *c, struct reason *reason)
{
    struct pair_tables tables = {.count = {0}};
    fill(c, &tables);
    return pair_coverage_open(&tables, &c->pair_coverage, reason);
}

uint32_t fuzz_pairs_short(const struct fuzz_command *c)
{
    if (c->pairs == 0)
        return 0;
    struct pair_coverage_summary sum = pair_coverage_summarize(c->pair_coverage, c->pairs);
    return sum.below;
}

void fuzz_pairs_print(const struct fuzz_command *c, const struct campaign_view *view)
{
    struct pair_coverage_summary sum = pair_coverage_summarize(c->pair_coverage, c->pairs);
    char name[PAIR_NAME_MOST];
    uint64_t count;
    if (sum.possible == 0)
        screen_line(11, "pairs      none: no engine here runs two members that vary\n");
    else
        screen_line(11,
                    "pairs      %u of members can meet, %u met; trials of a pair: least %llu, "
                    "median %llu\n",
                    sum.possible, sum.met, (unsigned long long)sum.least,
                    (unsigned long long)sum.median);
    for (uint32_t i = 0;
         i < RAREST_SHOWN && pair_coverage_rarest(c->pair_coverage, i, name, &count); i++)
        screen_line(11, "           %s %llu\n", name, (unsigned long long)count);
    if (view->refitted + view->rebuilt > 0)
        screen_line(11, "moved      %s refitted, %llu rebuilt\n", COUNTED(view->refitted, "tree"),
                    (unsigned long long)view->rebuilt);
    if (c->pairs > 0 && sum.below > 0)
        screen_line(11, "short      %s met in fewer than %llu trials: run again to continue\n",
                    COUNTED(sum.below, "pair"), (unsigned long long)c->pairs);
}

struct json_t *fuzz_pairs_json(const struct fuzz_command *c, const struct campaign_view *view)
{
    struct pair_coverage_summary sum = pair_coverage_summarize(c->pair_coverage, c->pairs);
    char name[PAIR_NAME_MOST];
    uint64_t count;
    json_t *rarest = json_array();
    for (uint32_t i = 0; i < RAREST_TOLD && pair_coverage_rarest(c->pair_coverage, i, name, &count);
         i++)
        json_array_append_new(rarest, json_record("pair=%s trials=%zu", name, count));
    json_t *out =
        json_record("possible=%u impossible=%u met=%u least=%zu median=%zu wanted=%zu below=%u "
                    "refitted=%zu rebuilt=%zu rarest=%p",
                    sum.possible, sum.impossible, sum.met, sum.least, sum.median, c->pairs,
                    c->pairs ? sum.below : 0, view->refitted, view->rebuilt, rarest);
    return out;
}
