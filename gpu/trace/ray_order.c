#include "gpu/trace/ray_order.h"

#include <string.h>

/* A radix sort by bytes, lowest first. A byte that is the same in all values is skipped. */
void ray_order_by_work(const uint32_t *work, size_t count, uint32_t *order, uint32_t *spare)
{
    uint32_t *from = order, *to = spare;
    for (size_t i = 0; i < count; i++)
        order[i] = (uint32_t)i;
    for (int shift = 0; shift < 32 && count > 0; shift += 8) {
        size_t first[256] = {0}, sum = 0;
        for (size_t i = 0; i < count; i++)
            first[work[i] >> shift & 255]++;
        if (first[work[0] >> shift & 255] == count)
            continue;
        for (int digit = 0; digit < 256; digit++) {
            size_t of_digit = first[digit];
            first[digit] = sum;
            sum += of_digit;
        }
        for (size_t i = 0; i < count; i++)
            to[first[work[from[i]] >> shift & 255]++] = from[i];
        uint32_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != order && count > 0)
        memcpy(order, from, count * sizeof *order);
}
