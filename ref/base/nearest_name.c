#include "ref/base/nearest_name.h"

#include <stdio.h>
#include <string.h>

#define WORD_MOST 40

struct nearest_name nearest_make(const char *word, size_t length)
{
    return (struct nearest_name){.word = word, .length = length, .distance = 1 + length / 4};
}

/* Number of characters inserted, deleted, replaced, or swapped with the next. */
static size_t distance_of(const char *a, size_t a_length, const char *b, size_t b_length)
{
    size_t row[3][WORD_MOST + 1];
    for (size_t k = 0; k <= b_length; k++)
        row[0][k] = k;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *now = row[i % 3], *before = row[(i + 2) % 3], *two = row[(i + 1) % 3];
        now[0] = i;
        for (size_t k = 1; k <= b_length; k++) {
            size_t best = before[k - 1] + (a[i - 1] != b[k - 1]);
            best = before[k] + 1 < best ? before[k] + 1 : best;
            best = now[k - 1] + 1 < best ? now[k - 1] + 1 : best;
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1] &&
                two[k - 2] + 1 < best)
                best = two[k - 2] + 1;
            now[k] = best;
        }
    }
    return row[a_length % 3][b_length];
}

void nearest_try(struct nearest_name *nearest, const char *name)
{
    const size_t length = strlen(name);
    if (length > WORD_MOST || nearest->length > WORD_MOST || nearest->length == 0)
        return;
    size_t distance = distance_of(nearest->word, nearest->length, name, length);
    if (distance < nearest->distance + (nearest->name == NULL)) {
        nearest->name = name;
        nearest->distance = distance;
    }
}

const char *nearest_hint(const struct nearest_name *nearest, char text[NEAREST_HINT])
{
    text[0] = '\0';
    if (nearest->name)
        snprintf(text, NEAREST_HINT, "; did you mean %.40s?", nearest->name);
    return text;
}
