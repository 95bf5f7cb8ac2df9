#include "bench/frames/turns.h"

static void swap(size_t *a, size_t *b)
{
    size_t kept = *a;
    *a = *b;
    *b = kept;
}

void turns_start(size_t *order, size_t count)
{
    for (size_t i = 0; i < count; i++)
        order[i] = i;
}

void turns_next(struct rng *rng, size_t *order, size_t count)
{
    if (count < 2)
        return;
    size_t last = order[count - 1];
    for (size_t i = count - 1; i > 0; i--)
        swap(&order[i], &order[rng_below(rng, (uint32_t)i + 1)]);
    if (order[0] == last)
        swap(&order[0], &order[1 + rng_below(rng, (uint32_t)count - 1)]);
}
