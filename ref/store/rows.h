/* Storages of ten words per item: nine floats, then the triangle's number. A storage can use the
 * upper two bits of the number. */
#ifndef ROWS_H
#define ROWS_H

#include "ref/layout.h"

#define STORE_ROW      10u
#define STORE_ROW_PRIM 0x3FFFFFFFu

/* Returns the row of an item, or NULL if it is outside the words. */
static inline const uint32_t *store_row(const struct packed *packed, uint32_t first, uint32_t slot)
{
    uint64_t at = first + (uint64_t)STORE_ROW * slot;
    return at + STORE_ROW <= packed->item_count ? packed->item + at : NULL;
}

/* tri_store.write, .measure and .item. tri_store.row makes the rows from the vertices. */
void store_rows_write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                      uint32_t count, uint32_t *word);
enum status store_rows_measure(const struct packed *packed, const struct scene *scene,
                               const uint32_t *prim, uint32_t count, uint64_t *words,
                               struct reason *reason);
uint32_t store_rows_item(const struct packed *packed, uint32_t first, uint32_t slot);

#endif
