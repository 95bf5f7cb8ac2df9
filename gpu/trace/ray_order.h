/* The order in which rays are traced side by side. */
#ifndef RAY_ORDER_H
#define RAY_ORDER_H

#include <stddef.h>
#include <stdint.h>

/* Sorts the indices 0 .. count - 1 by work[index], ascending and stable. Invocations of a group
 * wait for the slowest of them, so rays with similar work should be neighbours.
 *   order, spare  room for `count` each */
void ray_order_by_work(const uint32_t *work, size_t count, uint32_t *order, uint32_t *spare);

#endif
