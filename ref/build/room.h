/* Memory of builders: large arrays that are written before they are read. A file of its own:
 * a test replaces it by one that fails at chosen calls. */
#ifndef ROOM_H
#define ROOM_H

#include <stddef.h>

/* Returns `count` elements of `size` bytes, not cleared, aligned to at least 64 bytes; NULL without
 * memory or if the product overflows. A count of 0 returns a valid pointer. free() takes it, too,
 * which is how what leaves a builder is freed. */
void *room_make(size_t count, size_t size);

/* Frees what room_make returned; NULL is fine. */
void room_free(void *room);

#endif
