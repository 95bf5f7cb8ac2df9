#include "ref/layout.h"

#include "counts.h"
#include "ref/store.h"

#include <string.h>

extern const struct tri_store tri_store_indexed, tri_store_gathered, tri_store_edges,
    tri_store_baldwin_webber, tri_store_compact, tri_store_quantised, tri_store_truncated,
    tri_store_dgf1;

const struct tri_store *const tri_stores[] = {
    &tri_store_indexed,        &tri_store_gathered, &tri_store_edges,
    &tri_store_baldwin_webber, &tri_store_compact,  &tri_store_quantised,
    &tri_store_truncated,      &tri_store_dgf1,     NULL,
};
_Static_assert(ARRAY_COUNT(tri_stores) - 1 == STORE_FILES, "a ref/store/store_*.c has no entry");

const struct tri_store *tri_store_find(const char *name)
{
    for (size_t i = 0; tri_stores[i]; i++)
        if (strcmp(tri_stores[i]->name, name) == 0)
            return tri_stores[i];
    return NULL;
}

enum status tri_store_check(const struct tri_store *store, uint32_t id, const char *test,
                            struct reason *reason)
{
    if (tri_store_answers(store, id))
        return STATUS_OK;
    return fail(reason, STATUS_UNSUPPORTED, "storage %s holds no vertices: test %s needs them",
                store->name, test);
}

static enum status make_room(struct packed *out, uint64_t words, struct reason *reason)
{
    if (words > UINT32_MAX - out->item_count)
        return fail(reason, STATUS_LIMIT, "storage %s: at most %u words fit", out->store->name,
                    UINT32_MAX);
    if (array_reserve(&out->item, &out->item_room, out->item_count + words, sizeof *out->item))
        return fail(reason, STATUS_MEMORY, "storage %s: no memory for %llu bytes", out->store->name,
                    4 * (out->item_count + (unsigned long long)words));
    return STATUS_OK;
}

enum status store_put(const struct scene *scene, const uint32_t *prim, uint32_t count,
                      struct packed *out, uint32_t *first, struct reason *reason)
{
    const struct tri_store *store = out->store;
    uint64_t words;
    enum status status = STATUS_OK;
    if (out->item_count == 0 && store->head) {
        status = make_room(out, store->head_words, reason);
        if (!status)
            status = store->head(store, scene, out->item, reason);
        if (!status)
            out->item_count = store->head_words;
    }
    if (!status)
        status = store->measure(out, scene, prim, count, &words, reason);
    if (!status)
        status = make_room(out, words, reason);
    if (status)
        return status;
    *first = out->item_count;
    out->item_count += (uint32_t)words;
    store->write(out, scene, prim, count, out->item + *first);
    return STATUS_OK;
}
