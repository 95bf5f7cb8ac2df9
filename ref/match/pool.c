/* Engines opened once and kept. */
#include "ref/match/match.h"

#include "counts.h"

/* One file holds two engines. */
_Static_assert(POOL_MOST == ENGINE_FILES + 1 + ENGINES_ADDED_MOST, "a place for every engine");

void *pool_get(struct pool *pool, const struct engine *engine, enum status *status,
               struct reason *reason)
{
    size_t i = 0;
    while (i < pool->count && pool->entry[i].engine != engine)
        i++;
    if (i == POOL_MOST) {
        *status = fail(reason, STATUS_LIMIT, "more than %d engines", POOL_MOST);
        return NULL;
    }
    if (i == pool->count) {
        pool->count++;
        pool->entry[i].engine = engine;
        pool->entry[i].status =
            engine_open(engine, &pool->options, &pool->entry[i].self, &pool->entry[i].reason);
    }
    *status = pool->entry[i].status;
    if (*status && reason)
        *reason = pool->entry[i].reason;
    return pool->entry[i].self;
}

void pool_free(struct pool *pool)
{
    for (size_t i = 0; i < pool->count; i++)
        if (pool->entry[i].status == STATUS_OK)
            pool->entry[i].engine->close(pool->entry[i].self);
    pool->count = 0;
}
