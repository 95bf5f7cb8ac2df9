#include "fuzz/play/number_set.h"

#include <stdlib.h>

/* The slot of the number, or the free one where it belongs. */
static uint64_t *slot_of(const struct number_set *set, uint64_t number)
{
    size_t i = (size_t)number & (set->capacity - 1);
    while (set->slot[i] && set->slot[i] != number)
        i = (i + 1) & (set->capacity - 1);
    return &set->slot[i];
}

bool number_set_has(const struct number_set *set, uint64_t number)
{
    return set->capacity > 0 && *slot_of(set, number);
}

static bool grow(struct number_set *set)
{
    struct number_set grown = {NULL, set->capacity ? 2 * set->capacity : 1024, set->count};
    grown.slot = alloc_zeroed(grown.capacity, sizeof *grown.slot);
    if (!grown.slot)
        return false;
    for (size_t i = 0; i < set->capacity; i++)
        if (set->slot[i])
            *slot_of(&grown, set->slot[i]) = set->slot[i];
    free(set->slot);
    *set = grown;
    return true;
}

bool number_set_add(struct number_set *set, uint64_t number)
{
    if (2 * (set->count + 1) > set->capacity && !grow(set))
        return false;
    uint64_t *slot = slot_of(set, number);
    set->count += *slot == 0;
    *slot = number;
    return true;
}
