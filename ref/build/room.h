/* Memory of builders: large arrays that are written before they are read. In a separate file so
 * that a test can replace it by one that fails at chosen calls. */
#ifndef ROOM_H
#define ROOM_H

#include <stddef.h>

/* Returns `count` elements of `size` bytes, uninitialized, aligned to at least 64 bytes; NULL if
 * out of memory or if the product overflows. A count of 0 returns a valid pointer. free() works,
 * too, and frees arrays that a builder returns. */
void *room_make(size_t count, size_t size);

/* Frees the result of room_make; NULL is allowed. */
void room_free(void *room);

#endif
