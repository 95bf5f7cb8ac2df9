/* Storage `gathered`: ten words per item, in leaf order: the nine coordinates, then the triangle's
 * number. Nothing else is read, and nothing is shared. */
#include "ref/layout.h"
#include "ref/store/rows.h"
#include "ref/store.h"

#include <string.h>

static bool tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    const uint32_t *row = store_row(packed, first, slot);
    if (row)
        memcpy(v, row, 9 * sizeof v[0][0]);
    return row != NULL;
}

extern const struct tri_store tri_store_gathered;
const struct tri_store tri_store_gathered = {
    .name = "gathered",
    .summary = "nine floats and the number of each triangle, in leaf order",
    .id = ABI_STORE_GATHERED,
    .measure = store_rows_measure,
    .write = store_rows_write,
    .item = store_rows_item,
    .tri = tri,
};
