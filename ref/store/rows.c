#include "ref/store/rows.h"
#include "ref/store.h"

#include <string.h>

void store_rows_write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                      uint32_t count, uint32_t *word)
{
    uint32_t (*row)(float v[3][3]) = packed->store->row;
    for (uint32_t i = 0; i < count; i++, word += STORE_ROW) {
        float v[3][3];
        scene_tri(scene, prim[i], v);
        word[STORE_ROW - 1] = prim[i] | (row ? row(v) << 30 : 0);
        memcpy(word, v, sizeof v);
    }
}

enum status store_rows_measure(const struct packed *packed, const struct scene *scene,
                               const uint32_t *prim, uint32_t count, uint64_t *words,
                               struct reason *reason)
{
    (void)prim;
    *words = (uint64_t)STORE_ROW * count;
    if (scene->tri_count > STORE_ROW_PRIM)
        return fail(reason, STATUS_LIMIT, "storage %s: at most %u triangles, the scene has %u",
                    packed->store->name, STORE_ROW_PRIM, scene->tri_count);
    return STATUS_OK;
}

uint32_t store_rows_item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    const uint32_t *row = store_row(packed, first, slot);
    return row ? row[STORE_ROW - 1] & STORE_ROW_PRIM : ABI_NO_PRIM;
}
