#include "ref/look/around.h"

#include "ref/packed/packed_walk.h"

#include <stdlib.h>

/* One node; its children stand one after the other. */
struct around_place {
    struct box box;
    uint32_t parent; /* the root's is 0 */
    uint32_t first, count;
};

struct around {
    struct around_place *place;
    uint32_t count;
};

enum status around_make(const struct packed *packed, struct around **out)
{
    struct packed_walk walk;
    *out = NULL;
    enum status status = packed_walk_make(packed, &walk);
    if (status)
        return status;
    struct around *around = alloc_zeroed(1, sizeof *around);
    struct around_place *place = alloc_zeroed(walk.visit_count, sizeof *place);
    if (!around || !place) {
        free(around);
        free(place);
        packed_walk_free(&walk);
        return STATUS_MEMORY;
    }
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        const struct packed_visit *visit = &walk.visit[i];
        place[i].box = visit->box;
        place[i].parent = visit->parent;
        if (i > 0 && place[visit->parent].count++ == 0)
            place[visit->parent].first = i;
    }
    *around = (struct around){place, walk.visit_count};
    packed_walk_free(&walk);
    *out = around;
    return STATUS_OK;
}

void around_free(struct around *around)
{
    if (around)
        free(around->place);
    free(around);
}

static bool contains(const struct box *box, const double p[3])
{
    for (int k = 0; k < 3; k++)
        if (!((double)box->lo[k] <= p[k] && p[k] <= (double)box->hi[k]))
            return false;
    return true;
}

/* Without a stack, since references that wrap can be chained to any depth. */
void around_count(const struct around *around, const double p[3], uint32_t *boxes, uint32_t *leaves)
{
    const struct around_place *place = around->place;
    *boxes = *leaves = 0;
    for (uint32_t i = 0; around->count > 0;) {
        if (contains(&place[i].box, p)) {
            ++*boxes;
            *leaves += place[i].count == 0;
            if (place[i].count > 0) {
                i = place[i].first;
                continue;
            }
        }
        while (i > 0 && i + 1 == place[place[i].parent].first + place[place[i].parent].count)
            i = place[i].parent;
        if (i == 0)
            return;
        i++;
    }
}
