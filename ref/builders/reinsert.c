#include "ref/builders/reinsert.h"

#include "ref/build/grow.h"
#include "ref/build/keys.h"
#include "ref/build/links.h"
#include "ref/build/room.h"
#include "ref/builders/spots.h"

/* Places are searched for every TURNS-th node at a time, so that later turns of a pass see earlier
 * moves. */
#define TURNS 4u

struct reinsert {
    struct spots spots;
    float *gain;      /* per node: the gain at its better place */
    uint32_t *target; /* that place; LINKS_NONE: none */
    uint32_t threads;
};

/* Searches places for the nodes of a turn. Sets *found to the nodes that have one, by falling gain;
 * the node is in the low half of each entry. Errors: STATUS_MEMORY. */
static enum status seek_all(const struct reinsert *r, uint32_t turn, uint64_t **found,
                            uint32_t *count)
{
    uint32_t nodes = r->spots.count, some = 0;
#pragma omp parallel for schedule(dynamic, 256) num_threads(r->threads) if (r->threads > 1)
    for (uint32_t i = turn; i < nodes; i += TURNS)
        r->target[i] = spots_seek(&r->spots, i, &r->gain[i]);
    for (uint32_t i = turn; i < nodes; i += TURNS)
        some += r->target[i] != LINKS_NONE;
    *count = some;
    *found = room_make(some, sizeof **found);
    if (!*found)
        return STATUS_MEMORY;
    some = 0;
    for (uint32_t i = turn; i < nodes; i += TURNS)
        if (r->target[i] != LINKS_NONE) /* gains are positive: their bits order them */
            (*found)[some++] = (uint64_t)~float_bits(r->gain[i]) << 32 | i;
    return keys_sort(found, some, 32, 1);
}

/* Sets *fall to the decrease of the cost. */
static enum status pass(struct reinsert *r, double *fall)
{
    enum status status = STATUS_OK;
    *fall = 0;
    for (uint32_t turn = 0; turn < TURNS && !status; turn++) {
        uint32_t count;
        uint64_t *found = NULL;
        status = seek_all(r, turn, &found, &count);
        for (uint32_t i = 0; i < count && !status; i++) {
            uint32_t node = (uint32_t)found[i];
            *fall += spots_move(&r->spots, node, r->target[node]);
        }
        room_free(found);
    }
    return status;
}

enum status tree_reinsert(struct bvh *bvh, uint32_t passes, uint32_t threads)
{
    if (bvh->node_count < 7)
        return STATUS_OK; /* trees of up to 3 leaves are not changed */
    const struct build_options options = {.threads = threads};
    struct reinsert r = {.threads = build_threads(&options, bvh->node_count)};
    r.gain = room_make(bvh->node_count, sizeof *r.gain);
    r.target = room_make(bvh->node_count, sizeof *r.target);
    enum status status = spots_make(bvh, &r.spots);
    if (!status && !(r.gain && r.target))
        status = STATUS_MEMORY;
    double fall = 1;
    for (uint32_t i = 0; i < passes && !status && fall > 0; i++)
        status = pass(&r, &fall);
    struct bvh moved = {0};
    if (!status)
        status = spots_write(&r.spots, bvh, &moved);
    if (!status) {
        tree_drop(bvh);
        *bvh = moved;
    }
    spots_free(&r.spots);
    room_free(r.gain);
    room_free(r.target);
    return status;
}
