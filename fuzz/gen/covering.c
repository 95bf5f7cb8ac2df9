#include "fuzz/gen/covering.h"

#include <stdlib.h>
#include <string.h>

/* Pairs that have not met. `met` has a byte for each two members: of tables a < b those of place
 * [a][b], where member i of a and j of b are at i * members[b] + j. */
struct pairs {
    const uint32_t *members;
    uint32_t tables;
    uint8_t *met;
    size_t place[COVERING_TABLES_MOST][COVERING_TABLES_MOST];
    uint32_t *left[COVERING_TABLES_MOST]; /* of each member: pairs with others that have not met */
    uint32_t *used[COVERING_TABLES_MOST]; /* rows that have it */
    uint64_t open;                        /* pairs that have not met */
};

static uint8_t *pair_of(const struct pairs *pairs, uint32_t a, uint32_t i, uint32_t b, uint32_t j)
{
    if (a < b)
        return &pairs->met[pairs->place[a][b] + (size_t)i * pairs->members[b] + j];
    return &pairs->met[pairs->place[b][a] + (size_t)j * pairs->members[a] + i];
}

static void pairs_free(struct pairs *pairs)
{
    free(pairs->met);
    for (uint32_t t = 0; t < pairs->tables; t++) {
        free(pairs->left[t]);
        free(pairs->used[t]);
    }
}

static enum status pairs_make(const uint32_t *members, uint32_t tables, struct pairs *out)
{
    *out = (struct pairs){.members = members, .tables = tables};
    uint64_t all = 0;
    for (uint32_t a = 0; a < tables; a++) {
        all += members[a];
        for (uint32_t b = a + 1; b < tables; b++) {
            out->place[a][b] = (size_t)out->open;
            out->open += (uint64_t)members[a] * members[b];
        }
    }
    bool fits = out->open <= SIZE_MAX;
    out->met = fits ? alloc_zeroed((size_t)out->open, 1) : NULL;
    bool enough = out->met != NULL;
    for (uint32_t t = 0; t < tables; t++) {
        out->left[t] = alloc_zeroed(members[t], sizeof *out->left[t]);
        out->used[t] = alloc_zeroed(members[t], sizeof *out->used[t]);
        enough = enough && out->left[t] && out->used[t];
        for (uint32_t i = 0; i < members[t] && enough; i++)
            out->left[t][i] = (uint32_t)(all - members[t]);
    }
    if (enough)
        return STATUS_OK;
    pairs_free(out);
    return STATUS_MEMORY;
}

/* The member that has most to meet; of equal ones the first. */
static void find_neediest(const struct pairs *pairs, uint32_t *table, uint32_t *member)
{
    uint32_t most = 0;
    *table = *member = 0;
    for (uint32_t t = 0; t < pairs->tables; t++)
        for (uint32_t i = 0; i < pairs->members[t]; i++)
            if (pairs->left[t][i] > most) {
                most = pairs->left[t][i];
                *table = t;
                *member = i;
            }
}

/* The member of table t that meets most of those in the row, then has most to meet, then is used
 * least. */
static uint32_t best_member(const struct pairs *pairs, uint32_t t, const uint32_t *row,
                            const bool *chosen)
{
    uint32_t best = 0, best_new = 0;
    for (uint32_t i = 0; i < pairs->members[t]; i++) {
        uint32_t new = 0;
        for (uint32_t o = 0; o < pairs->tables; o++)
            new += chosen[o] && !*pair_of(pairs, t, i, o, row[o]);
        bool better = new > best_new;
        if (new == best_new)
            better = pairs->left[t][i] > pairs->left[t][best] ||
                     (pairs->left[t][i] == pairs->left[t][best] &&
                      pairs->used[t][i] < pairs->used[t][best]);
        if (i == 0 || better) {
            best = i;
            best_new = new;
        }
    }
    return best;
}

static void meet(struct pairs *pairs, const uint32_t *row)
{
    for (uint32_t a = 0; a < pairs->tables; a++) {
        pairs->used[a][row[a]]++;
        for (uint32_t b = a + 1; b < pairs->tables; b++) {
            uint8_t *met = pair_of(pairs, a, row[a], b, row[b]);
            if (*met)
                continue;
            *met = 1;
            pairs->left[a][row[a]]--;
            pairs->left[b][row[b]]--;
            pairs->open--;
        }
    }
}

/* Every row begins with the member that has most to meet, so at least one pair is new in it. */
static void make_row(struct pairs *pairs, uint32_t *row)
{
    bool chosen[COVERING_TABLES_MOST] = {false};
    uint32_t first, member;
    find_neediest(pairs, &first, &member);
    row[first] = member;
    chosen[first] = true;
    for (uint32_t done = 1; done < pairs->tables; done++) {
        uint32_t largest = COVERING_TABLES_MOST;
        for (uint32_t t = 0; t < pairs->tables; t++)
            if (!chosen[t] &&
                (largest == COVERING_TABLES_MOST || pairs->members[t] > pairs->members[largest]))
                largest = t;
        row[largest] = best_member(pairs, largest, row, chosen);
        chosen[largest] = true;
    }
    meet(pairs, row);
}

static enum status add_row(struct covering *out, size_t *capacity, const uint32_t *row)
{
    void *array = out->member;
    size_t had = (size_t)out->rows * out->tables;
    enum status status = array_reserve(&array, capacity, had + out->tables, sizeof *out->member);
    out->member = array;
    for (uint32_t t = 0; t < out->tables && !status; t++)
        out->member[had + t] = (uint16_t)row[t];
    out->rows += !status;
    return status;
}

static enum status check(const uint32_t *members, uint32_t tables, struct reason *reason)
{
    if (tables < 2 || tables > COVERING_TABLES_MOST)
        return fail(reason, STATUS_INPUT, "covering: %u tables, must be 2 to %u", tables,
                    COVERING_TABLES_MOST);
    for (uint32_t t = 0; t < tables; t++)
        if (members[t] == 0 || members[t] > UINT16_MAX)
            return fail(reason, STATUS_INPUT, "covering: table %u has %u members, must be 1 to %u",
                        t, members[t], UINT16_MAX);
    return STATUS_OK;
}

enum status covering_make(const uint32_t *members, uint32_t tables, struct covering *out,
                          struct reason *reason)
{
    struct pairs pairs;
    size_t capacity = 0;
    *out = (struct covering){.tables = tables};
    enum status status = check(members, tables, reason);
    if (status) {
        *out = (struct covering){0};
        return status;
    }
    status = pairs_make(members, tables, &pairs);
    if (!status) {
        while (!status && pairs.open > 0) {
            uint32_t row[COVERING_TABLES_MOST];
            make_row(&pairs, row);
            status = add_row(out, &capacity, row);
        }
        pairs_free(&pairs);
    }
    if (status) {
        covering_free(out);
        return fail(reason, status, "covering: no memory for the pairs of %u tables", tables);
    }
    return STATUS_OK;
}

void covering_free(struct covering *covering)
{
    free(covering->member);
    *covering = (struct covering){0};
}
