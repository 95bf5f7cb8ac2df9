/* Summary and file of the tally. */
#include "fuzz/feedback/pair_coverage_inner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILE_MOST ((size_t)16 << 20)

static int by_count(const void *x, const void *y)
{
    uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
    return order_numbers(a, b);
}

struct pair_coverage_summary pair_coverage_summarize(const struct pair_coverage *m, uint64_t wanted)
{
    struct pair_coverage_summary out = {.possible = 0};
    uint64_t *count = alloc_zeroed(m->pairs, sizeof *count);
    for (size_t i = 0; i < m->pairs; i++) {
        const struct coverage_pair *pair = &m->pair[i];
        out.impossible += !pair->possible;
        if (!pair->possible)
            continue;
        out.met += pair->met > 0;
        out.below += pair->met < wanted;
        if (out.possible == 0 || pair->met < out.least)
            out.least = pair->met;
        if (count)
            count[out.possible] = pair->met;
        out.possible++;
    }
    if (count && out.possible > 0) {
        qsort(count, out.possible, sizeof *count, by_count);
        out.median = count[out.possible / 2];
    }
    free(count);
    return out;
}

static void name_pair(const struct pair_coverage *m, size_t at, char name[PAIR_NAME_MOST])
{
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
        for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++) {
            const uint32_t *count = m->tables.count;
            size_t first = m->place[a][b];
            if (at < first || at >= first + (size_t)count[a] * count[b])
                continue;
            uint32_t k = (uint32_t)(at - first);
            snprintf(name, PAIR_NAME_MOST, "%s.%.40s %s.%.40s", pair_factor_name(a),
                     pair_coverage_name(m, a, k / count[b]), pair_factor_name(b),
                     pair_coverage_name(m, b, k % count[b]));
        }
}

bool pair_coverage_rarest(const struct pair_coverage *m, uint32_t at, char name[PAIR_NAME_MOST],
                          uint64_t *count)
{
    const struct coverage_pair *last = NULL;
    for (uint32_t k = 0; k <= at; k++) { /* the next rarest, of equal ones the next in order */
        const struct coverage_pair *best = NULL;
        for (size_t i = 0; i < m->pairs; i++) {
            const struct coverage_pair *pair = &m->pair[i];
            bool later = !last || pair->met > last->met || (pair->met == last->met && pair > last);
            if (pair->possible && later && (!best || pair->met < best->met))
                best = pair;
        }
        if (!best)
            return false;
        last = best;
    }
    name_pair(m, (size_t)(last - m->pair), name);
    *count = last->met;
    return true;
}

enum status pair_coverage_write(const struct pair_coverage *m, const struct folder *folder,
                                const char *name, struct reason *reason)
{
    struct file_out out;
    enum status status = folder_put(folder, name, &out, reason);
    if (status)
        return status;
    for (size_t i = 0; i < m->pairs; i++) {
        char pair[PAIR_NAME_MOST];
        if (!m->pair[i].possible || m->pair[i].met == 0)
            continue;
        name_pair(m, i, pair);
        fprintf(out.stream, "%s %llu\n", pair, (unsigned long long)m->pair[i].met);
    }
    return file_out_commit(&out, reason);
}

/* The factor and member of "FACTOR.MEMBER"; false: it takes no part. */
static bool find(const struct pair_coverage *m, const char *word, enum pair_factor *factor,
                 uint32_t *member)
{
    const char *dot = strchr(word, '.');
    for (enum pair_factor f = 0; dot && f < MEET_FACTORS; f++) {
        const char *name = pair_factor_name(f);
        if (strlen(name) != (size_t)(dot - word) || strncmp(name, word, strlen(name)) != 0)
            continue;
        for (uint32_t i = 0; i < m->tables.count[f]; i++)
            if (strcmp(pair_coverage_name(m, f, i), dot + 1) == 0) {
                *factor = f;
                *member = i;
                return true;
            }
    }
    return false;
}

static enum status take_line(struct pair_coverage *m, const char *line, const char *path,
                             size_t number, struct reason *reason)
{
    char first[PAIR_NAME_MOST], second[PAIR_NAME_MOST], rest;
    enum pair_factor a, b;
    uint32_t i, j;
    unsigned long long count;
    if (sscanf(line, "%119s %119s %llu %c", first, second, &count, &rest) != 3)
        return fail(reason, STATUS_INPUT, "%s:%zu: no 'FACTOR.MEMBER FACTOR.MEMBER COUNT'",
                    file_label(path), number);
    if (!find(m, first, &a, &i) || !find(m, second, &b, &j) || a == b)
        return STATUS_OK;
    struct coverage_pair *pair = pair_coverage_of_pair(m, a, i, b, j);
    if (pair->possible)
        pair->met = pair->drawn = count;
    return STATUS_OK;
}

enum status pair_coverage_read(struct pair_coverage *m, const struct folder *folder,
                               const char *name, struct reason *reason)
{
    char *bytes = NULL, *next, path[FOLDER_PATH_MOST];
    size_t size, number = 0;
    bool there;
    enum status status = folder_has(folder, name, &there, reason);
    if (status || !there)
        return status;
    status = folder_read(folder, name, FILE_MOST, &bytes, &size, reason);
    folder_path(folder, name, path, sizeof path);
    for (char *line = bytes; !status && line && *line; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        status = take_line(m, line, path, ++number, reason);
        next = next ? next : line + strlen(line);
    }
    free(bytes);
    return status;
}
