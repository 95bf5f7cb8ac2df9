/* Each answer of a black box alone may be as bad as the worst published test at its worst. All of
 * them together may not: rounding errors are not all at their worst. A tracer that dropped each hit
 * that it may drop would lose whole pixels of every picture, and each loss would be excused.
 *
 * So hits beside edges are counted by their margin, the distance to the nearest edge in parts of
 * the bound of the classical test at that triangle (ref/judge/judge_allowed.c), with those that
 * were lost. Of plain, fused, reciprocal and fast-math Moeller and Trumbore, Woop and others, on
 * meshes, needles and cameras far away, the largest shares lost were 0.16, 0.036, 0.002 and 0
 * (tests/judge/honest.h, tests/judge/test_match_edges.c prints them); allowed are shares of 1/2,
 * 1/8, 1/32 and 1/64, and three standard deviations of so many independent losses and
 * MATCH_EDGES_FEW. A formula that its owner names is judged by that formula instead. */
#include "ref/match/match_edges.h"

#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    double most;  /* margin */
    double share; /* that may be lost */
} classes[MATCH_EDGES] = {
    {1.0 / 32, 1.0 / 2}, {1.0 / 16, 1.0 / 8}, {1.0 / 8, 1.0 / 32}, {INFINITY, 1.0 / 64}};

#define MARGIN_LEAST (1.0 / 64)
#define LOST         0x80u

uint8_t match_edges_note(const struct judgement *judgement)
{
    if (!(judgement->margin > MARGIN_LEAST))
        return 0;
    uint8_t class = 0;
    while (judgement->margin > classes[class].most)
        class ++;
    return (uint8_t)((class + 1u) | (judgement->edge_lost ? LOST : 0u));
}

double match_edges_limit(size_t class, size_t hits)
{
    double expected = classes[class].share * (double)hits;
    return expected + 3.0 * sqrt(expected) + MATCH_EDGES_FEW;
}

void match_edges_text(const struct edges_lost edges[MATCH_EDGES], char text[MATCH_EDGES_TEXT])
{
    text[0] = '\0';
    for (size_t class = 0; class < MATCH_EDGES; class ++)
        text_append(text, MATCH_EDGES_TEXT, "%zu of %zu (at most %.0f), ", edges[class].lost,
                    edges[class].hits, match_edges_limit(class, edges[class].hits));
    text_append(text, MATCH_EDGES_TEXT, "the nearest first: not rounding");
}

struct noted {
    const struct ray *ray;
    uint8_t note;
};

static int by_ray(const void *left, const void *right)
{
    const struct noted *a = left, *b = right;
    int order = memcmp(a->ray, b->ray, sizeof *a->ray);
    return order ? order : order_numbers(a->note, b->note);
}

enum status match_edges_add(const struct ray *ray, const uint8_t *note, size_t rays,
                            struct edges_lost edges[MATCH_EDGES])
{
    size_t count = 0;
    for (size_t i = 0; i < rays; i++)
        count += note[i] != 0;
    struct noted *list = alloc_zeroed(count + 1, sizeof *list);
    if (!list)
        return STATUS_MEMORY;
    count = 0;
    for (size_t i = 0; i < rays; i++)
        if (note[i])
            list[count++] = (struct noted){&ray[i], note[i]};
    qsort(list, count, sizeof *list, by_ray);
    for (size_t i = 0; i < count; i++) {
        size_t class = (list[i].note & ~LOST) - 1u;
        if (i > 0 && by_ray(&list[i - 1], &list[i]) == 0)
            continue;
        edges[class].hits++;
        edges[class].lost += (list[i].note & LOST) != 0;
    }
    free(list);
    return STATUS_OK;
}

size_t match_edges_beyond(const struct edges_lost edges[MATCH_EDGES])
{
    size_t beyond = 0;
    for (size_t class = 0; class < MATCH_EDGES; class ++) {
        double limit = match_edges_limit(class, edges[class].hits);
        if ((double)edges[class].lost > limit)
            beyond += edges[class].lost - (size_t)limit;
    }
    return beyond;
}

enum status match_edges_count(const struct ray *ray, const uint8_t *note, struct row *row)
{
    if (match_edges_add(ray, note, row->rays, row->edges))
        return fail(&row->reason, STATUS_MEMORY, "no memory to count hits beside edges");
    row->edges_beyond += match_edges_beyond(row->edges);
    return STATUS_OK;
}
