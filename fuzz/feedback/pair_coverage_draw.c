/* Which members are combined next. */
#include "fuzz/feedback/pair_coverage_inner.h"

#include "ref/base/rng.h"

#include <string.h>

/* A pair that is always refused is drawn once for that many times of another. */
#define PATIENCE 8u
/* An engine plays what it compiled in that many blocks before it compiles again. */
#define PROGRAM_BLOCKS 4u

/* Trials in which the pair has met, or is being played. */
static uint64_t had(const struct coverage_pair *pair)
{
    uint64_t due = pair->drawn - pair->missed, tried = pair->drawn / PATIENCE;
    return due > tried ? due : tried;
}

/* One of the rarest; false: there is no pair that can meet. */
static bool choose_pair(struct pair_coverage *m, struct rng *rng, enum pair_factor *a, uint32_t *i,
                        enum pair_factor *b, uint32_t *j)
{
    uint64_t least = UINT64_MAX;
    uint32_t alike = 0;
    for (enum pair_factor x = 0; x < MEET_FACTORS; x++)
        for (enum pair_factor y = x + 1; y < MEET_FACTORS; y++)
            for (uint32_t k = 0; k < m->tables.count[x] * m->tables.count[y]; k++) {
                const struct coverage_pair *pair = &m->pair[m->place[x][y] + k];
                uint64_t count = had(pair);
                if (!pair->possible || count > least)
                    continue;
                alike = count < least ? 1 : alike + 1;
                least = count;
                if (rng_below(rng, alike) > 0)
                    continue;
                *a = x;
                *b = y;
                *i = k / m->tables.count[y];
                *j = k % m->tables.count[y];
            }
    return least < UINT64_MAX;
}

/* A row being filled. */
struct draw_row {
    struct combination combination;
    const struct engine *engine; /* NULL: not chosen yet */
    bool free;                   /* storage and tests are not those that the row began with */
};

static bool is_of_program(enum pair_factor factor)
{
    return factor == MEET_STORE || factor == MEET_TRI || factor == MEET_BOX;
}

static bool is_met(const struct draw_row *row, enum pair_factor factor)
{
    return !row->engine || pair_coverage_meets(row->engine, factor);
}

static void set(const struct pair_coverage *m, struct draw_row *row, enum pair_factor factor,
                uint32_t i)
{
    row->combination.member[factor] = (uint16_t)i;
    if (factor == MEET_ENGINE)
        row->engine = m->tables.member[MEET_ENGINE][i];
}

/* How much member i would bring to those in the row: 1 for each that it never met, less the more
 * often it did; below 0: it cannot meet one of them. */
static double worth(const struct pair_coverage *m, const struct draw_row *row,
                    enum pair_factor factor, uint32_t i, double unit)
{
    double sum = 0;
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++) {
        if (row->combination.member[f] == MEET_NONE || !is_met(row, f))
            continue;
        const struct coverage_pair *pair =
            pair_coverage_of_pair(m, factor, i, f, row->combination.member[f]);
        if (!pair->possible)
            return -1;
        sum += unit / (unit + (double)had(pair));
    }
    return sum;
}

/* Engines that compile are drawn only where no other can meet the row. */
static bool is_dear(const struct pair_coverage *m, enum pair_factor factor, uint32_t i)
{
    return factor == MEET_ENGINE &&
           ((const struct engine *)m->tables.member[MEET_ENGINE][i])->compiles;
}

/* The member that brings most, one of those alike; false: none can meet the row. */
static bool choose_member(const struct pair_coverage *m, struct draw_row *row,
                          enum pair_factor factor, double unit, struct rng *rng, bool dear)
{
    double most = -1;
    uint32_t best = 0, alike = 0;
    for (uint32_t i = 0; i < m->tables.count[factor]; i++) {
        double worthy = is_dear(m, factor, i) && !dear ? -1 : worth(m, row, factor, i, unit);
        if (worthy < 0 || worthy < most)
            continue;
        alike = worthy > most ? 1 : alike + 1;
        most = worthy;
        if (rng_below(rng, alike) == 0)
            best = i;
    }
    if (alike > 0)
        set(m, row, factor, best);
    else if (!dear)
        return choose_member(m, row, factor, unit, rng, true);
    return alike > 0;
}

static struct program *program_of(const struct pair_coverage *m, const struct draw_row *row)
{
    uint16_t engine = row->combination.member[MEET_ENGINE],
             layout = row->combination.member[MEET_LAYOUT];
    bool known = engine != MEET_NONE && layout != MEET_NONE;
    return known && row->engine->compiles
               ? &m->program[(size_t)engine * m->tables.count[MEET_LAYOUT] + layout]
               : NULL;
}

/* Takes the storage and tests that the engine has compiled for this layout, if the row is free. */
static void take_program(const struct pair_coverage *m, struct draw_row *row)
{
    struct program *program = program_of(m, row);
    if (!program || !row->free || program->left == 0)
        return;
    row->free = false;
    struct draw_row taken = *row;
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++) /* those that the row has go */
        if (is_of_program(f))
            taken.combination.member[f] = MEET_NONE;
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++) {
        if (!is_of_program(f))
            continue;
        if (worth(m, &taken, f, program->member[f], 1) < 0)
            return;
        set(m, &taken, f, program->member[f]);
    }
    program->left--;
    *row = taken;
}

static void keep_program(const struct pair_coverage *m, const struct draw_row *row)
{
    struct program *program = program_of(m, row);
    if (!program || !row->free) /* not what was just taken */
        return;
    memcpy(program->member, row->combination.member, sizeof program->member);
    program->left = PROGRAM_BLOCKS - 1;
}

/* The largest factor that has no member yet and that the engine meets; MEET_FACTORS: none. */
static enum pair_factor next_factor(const struct pair_coverage *m, const struct draw_row *row)
{
    enum pair_factor largest = MEET_FACTORS;
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++)
        if (row->combination.member[f] == MEET_NONE && is_met(row, f) &&
            (largest == MEET_FACTORS || m->tables.count[f] > m->tables.count[largest]))
            largest = f;
    return largest;
}

/* Sets the factors that the engine does not meet to the first members that can be traced. */
static void fill(const struct pair_coverage *m, struct draw_row *row)
{
    for (enum pair_factor f = MEET_FACTORS; f-- > 0;) {
        if (row->combination.member[f] != MEET_NONE)
            continue;
        uint32_t i = 0;
        uint16_t store = row->combination.member[MEET_STORE];
        while (f == MEET_TRI && store != MEET_NONE && i + 1 < m->tables.count[f] &&
               !pair_coverage_of_pair(m, MEET_STORE, store, MEET_TRI, i)->possible)
            i++;
        row->combination.member[f] = (uint16_t)i;
    }
}

/* Of pairs of motion alone `rebuilt` more were missed. */
static void count_drawn(struct pair_coverage *m, const struct combination *drawn, uint64_t trials,
                        uint64_t missed, uint64_t rebuilt)
{
    const struct engine *engine = m->tables.member[MEET_ENGINE][drawn->member[MEET_ENGINE]];
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
        for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++)
            if (pair_coverage_meets(engine, a) && pair_coverage_meets(engine, b)) {
                struct coverage_pair *pair =
                    pair_coverage_of_pair(m, a, drawn->member[a], b, drawn->member[b]);
                pair->drawn += trials;
                pair->missed += missed + (b == MEET_MOTION ? rebuilt : 0);
            }
}

void pair_coverage_draw(struct pair_coverage *m, uint64_t seed, uint64_t turn, uint32_t trials,
                        struct combination *out)
{
    struct rng of_seed = rng_make(seed, 0x6D656574u), rng = rng_make(rng_u64(&of_seed), turn);
    for (;;) {
        enum pair_factor a = 0, b = 1, f;
        uint32_t i = 0, j = 0;
        struct draw_row row = {.free = true};
        for (enum pair_factor k = 0; k < MEET_FACTORS; k++)
            row.combination.member[k] = MEET_NONE;
        bool any = choose_pair(m, &rng, &a, &i, &b, &j), full = true;
        if (any) {
            set(m, &row, a, i);
            set(m, &row, b, j);
            row.free = !is_of_program(a) && !is_of_program(b);
        }
        while (full && (f = next_factor(m, &row)) < MEET_FACTORS) {
            full = choose_member(m, &row, f, (double)trials, &rng, false);
            take_program(m, &row);
        }
        if (any && !full) { /* no engine that takes part can trace these two */
            pair_coverage_of_pair(m, a, i, b, j)->possible = false;
            continue;
        }
        keep_program(m, &row);
        fill(m, &row);
        *out = row.combination;
        count_drawn(m, out, trials, 0, 0);
        return;
    }
}

void pair_coverage_missed(struct pair_coverage *m, const struct combination *drawn,
                          uint32_t refused, uint32_t rebuilt)
{
    count_drawn(m, drawn, 0, refused, rebuilt);
}
