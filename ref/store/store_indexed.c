/* Storage `indexed`: an array of triangle numbers in leaf order; vertices are read from the scene.
 * On the GPU these are gathered, nine floats per triangle in the scene's order. */
#include "ref/layout.h"
#include "ref/store.h"

#include <string.h>

static enum status measure(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason)
{
    (void)packed, (void)scene, (void)prim, (void)reason;
    *words = count;
    return STATUS_OK;
}

static void write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word)
{
    (void)packed;
    (void)scene;
    memcpy(word, prim, count * sizeof *prim);
}

static uint32_t item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    uint32_t at = first + slot;
    return at < packed->item_count ? packed->item[at] : ABI_NO_PRIM;
}

extern const struct tri_store tri_store_indexed;
const struct tri_store tri_store_indexed = {
    .name = "indexed",
    .summary = "triangle numbers in leaf order, vertices where the scene has them",
    .id = ABI_STORE_INDEXED,
    .measure = measure,
    .write = write,
    .item = item,
};
