/* Draws members that play together, and counts the pairs that met. */
#include "fuzz/campaign/campaign_inner.h"

#include "ref/base/rng.h"

#include <string.h>

#define PAIRS_FILE "pairs.txt"

/* One query for a block; for an engine that compiles, always the same with these members. */
static enum query choose_query(const struct campaign *c, const struct campaign_block *block)
{
    static const enum pair_factor of[] = {MEET_ENGINE, MEET_LAYOUT, MEET_STORE, MEET_TRI, MEET_BOX};
    const struct engine *engine = c->rules.field.who[block->draw.contestant].engine;
    struct rng rng = rng_make(c->rules.seed, 0x71756572u);
    if (engine->compiles)
        for (size_t i = 0; i < ARRAY_COUNT(of); i++)
            rng = rng_make(rng_u64(&rng), block->combination.member[of[i]]);
    else
        rng = rng_make(rng_u64(&rng), block->first / FUZZ_BATCH);
    return rng_below(&rng, 4) == 0 ? QUERY_ANY : QUERY_CLOSEST;
}

static struct work_draw draw_of(const struct campaign *c, const struct combination *combination)
{
    const struct pair_tables *t = pair_coverage_tables(c->options->pair_coverage);
    const void *member[MEET_FACTORS];
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++)
        member[f] = t->member[f][combination->member[f]];
    const struct engine *engine = member[MEET_ENGINE];
    struct work_draw draw = {.on = true,
                             .layout = engine->needs_packed ? member[MEET_LAYOUT] : NULL,
                             .builder = member[MEET_BUILDER],
                             .store = member[MEET_STORE],
                             .tri = member[MEET_TRI],
                             .box = member[MEET_BOX],
                             .optimized = combination->member[MEET_OPTIMIZE],
                             .moved = combination->member[MEET_MOTION] > 0};
    while (draw.contestant + 1 < c->rules.field.count &&
           c->rules.field.who[draw.contestant].engine != engine)
        draw.contestant++;
    return draw;
}

void campaign_pairs_draw(struct campaign *c, struct campaign_block *block)
{
    struct pair_coverage *pair_coverage = c->options->pair_coverage;
    uint64_t number = block->first / FUZZ_BATCH;
    struct missed *missed = &c->missed[number % CAMPAIGN_BEHIND];
    if (missed->block > 0)
        pair_coverage_missed(pair_coverage, &missed->combination, missed->refused, missed->rebuilt);
    *missed = (struct missed){0};
    pair_coverage_draw(pair_coverage, c->rules.seed, number, block->count, &block->combination);
    block->draw = draw_of(c, &block->combination);
    block->draw.query = choose_query(c, block);
}

/* Counts the pairs of a trial that a contestant, whose bit this is, has answered. */
static void count_met(struct campaign *c, const struct engine *engine, const struct layout *layout,
                      const struct work_trial *one, uint32_t bit)
{
    struct combination met =
        pair_coverage_of(c->options->pair_coverage, engine, layout, one->builder, one->store,
                         one->tri, one->box, one->optimized, one->refitted & bit);
    if (one->rebuilt & bit)
        met.member[MEET_MOTION] = MEET_NONE;
    pair_coverage_add(c->options->pair_coverage, &met);
}

static void count_trial(struct campaign *c, const struct work_trial *one)
{
    const struct fuzz_field *field = &c->rules.field;
    for (size_t i = 0; i < field->count; i++)
        if (one->players >> i & 1u)
            count_met(c, field->who[i].engine, field->who[i].layout, one, 1u << i);
}

/* Counts as drawn: members that the engine does not meet are in no pair. */
static void count_drawn(struct campaign *c, const struct campaign_block *block)
{
    uint32_t bit = 1u << block->draw.contestant;
    struct missed missed = {block->first / FUZZ_BATCH + 1, block->combination, 0, 0};
    const struct engine *engine = c->rules.field.who[block->draw.contestant].engine;
    for (uint32_t i = 0; i < block->count; i++) {
        const struct work_trial *one = &block->trial[i];
        bool played = one->players & bit;
        missed.refused += !played;
        missed.rebuilt += played && one->rebuilt & bit;
        if (played)
            count_met(c, engine, block->draw.layout, one, bit);
    }
    c->missed[(missed.block - 1) % CAMPAIGN_BEHIND] = missed;
}

void campaign_pairs_count(struct campaign *c, const struct campaign_block *block)
{
    if (block->draw.on)
        count_drawn(c, block);
    else if (c->options->pair_coverage && block->stream != WORK_KEPT)
        for (uint32_t i = 0; i < block->count; i++)
            count_trial(c, &block->trial[i]);
}

enum status campaign_pairs_read(struct campaign *c)
{
    if (!c->options->rules.field.drawn)
        return STATUS_OK;
    return pair_coverage_read(c->options->pair_coverage, findings_folder(c->findings), PAIRS_FILE,
                              c->reason);
}

enum status campaign_pairs_write(const struct campaign *c)
{
    if (!c->options->rules.field.drawn)
        return STATUS_OK;
    return pair_coverage_write(c->options->pair_coverage, findings_folder(c->findings), PAIRS_FILE,
                               c->reason);
}
