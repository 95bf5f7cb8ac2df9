/* Packets of rays that share a stack: a node is read once for all rays of the packet that meet it,
 * and so is a triangle. A unit ends a packet before it takes the next one. */
#include "bench/traffic/schedulers.h"

#include <stdlib.h>

#define ENTRY_BYTES 16u /* of the stack: a node, which rays, the least distance */

struct packet_entry {
    uint32_t ref;
    uint64_t rays; /* a bit each */
    float least;
    float entry[TRAFFIC_PACKET_MOST];
};

struct ray_packet {
    struct traffic_run *run;
    uint32_t wave, count, slot;
    uint32_t ray[TRAFFIC_PACKET_MOST];
    struct walk walk[TRAFFIC_PACKET_MOST];
    uint32_t depth;
    struct packet_entry stack[ABI_STACK_WIDE];
};

static void move_stack(struct ray_packet *p, bool write)
{
    struct traffic_walker *w = p->run->walker;
    uint64_t base = (uint64_t)p->slot * ABI_STACK_WIDE;
    traffic_access(&p->run->memory, w->unit, TRAFFIC_L1, TRAFFIC_AT_STACKS,
                   (base + p->depth) * ENTRY_BYTES, ENTRY_BYTES, write);
}

/* Which rays meet a child, and where. */
static void test_child(struct ray_packet *p, uint32_t ref, const struct wide *node, uint32_t c,
                       uint64_t rays, struct packet_entry *out)
{
    const struct traffic_walker *walker = p->run->walker;
    bool wide = layout_is_wide(walker->job.packed->layout);
    out->ref = node->child[c];
    out->rays = 0;
    out->least = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        struct walk *w = &p->walk[i];
        float entry;
        if (!(rays >> i & 1) ||
            !box_test_run(walker->job.box->id, &w->slab, &node->box[c], w->tbest, &entry) ||
            (wide && walk_misses(w, ref, node->child[c])))
            continue;
        out->least = out->rays == 0 || entry < out->least ? entry : out->least;
        out->entry[i] = entry;
        out->rays |= (uint64_t)1 << i;
    }
}

/* Pushes the children that are met, the nearest last. Returns false if the stack is full. */
static bool push_children(struct ray_packet *p, uint32_t ref, const struct wide *node,
                          uint64_t rays)
{
    uint32_t base = p->depth;
    for (uint32_t c = 0; c < node->child_count; c++) {
        struct packet_entry child;
        test_child(p, ref, node, c, rays, &child);
        if (child.rays == 0)
            continue;
        if (p->depth >= ABI_STACK_WIDE)
            return false;
        move_stack(p, true);
        uint32_t at = p->depth++;
        for (; at > base && p->stack[at - 1].least <= child.least; at--)
            p->stack[at] = p->stack[at - 1];
        p->stack[at] = child;
    }
    return true;
}

/* Rays of an entry that can still find something nearer there. */
static uint64_t still_wanted(const struct ray_packet *p, const struct packet_entry *entry)
{
    uint64_t rays = entry->rays;
    for (uint32_t i = 0; i < p->count; i++)
        if ((rays >> i & 1) && p->run->walker->job.box->id != ABI_BOX_RTRS &&
            !(entry->entry[i] <= p->walk[i].tbest))
            rays &= ~((uint64_t)1 << i);
    return rays;
}

/* Tests a leaf's triangles with each ray; the first one reads them. */
static void test_leaf(struct ray_packet *p, const struct wide *node, uint64_t rays)
{
    struct traffic_walker *walker = p->run->walker;
    for (uint32_t i = 0; i < p->count; i++)
        if (rays >> i & 1) {
            (void)walk_leaf(&p->walk[i], WALK_SCENE, walker->job.tri->id, node);
            walker->source = TRAFFIC_UNSEEN;
        }
    walker->source = TRAFFIC_CACHED;
}

/* Takes rays from `first` on and tests the root's box; returns those that meet it. */
static uint64_t begin(struct ray_packet *p, size_t first)
{
    struct traffic_walker *walker = p->run->walker;
    const struct traffic_wave *wave = &p->run->paths->wave[p->wave];
    uint64_t rays = 0;
    struct traffic_lane *lane = malloc(sizeof *lane);
    p->count = 0;
    p->depth = 0;
    while (lane && p->count < p->run->machine->packet && first + p->count < wave->count) {
        uint32_t i = p->count++;
        p->ray[i] = (uint32_t)(first + i);
        traffic_take_ray(p->run, walker->unit, p->wave, p->ray[i]);
        if (traffic_begin(walker, lane, &wave->ray[p->ray[i]]) == TRAFFIC_MORE)
            rays |= (uint64_t)1 << i;
        p->walk[i] = lane->walk;
        walker->source = TRAFFIC_UNSEEN; /* the root's box is read once */
    }
    walker->source = TRAFFIC_CACHED;
    free(lane);
    return rays;
}

static enum status play_packet(struct ray_packet *p, size_t first, struct reason *reason)
{
    struct traffic_walker *walker = p->run->walker;
    uint64_t rays = begin(p, first);
    if (p->count == 0)
        return fail(reason, STATUS_MEMORY, "no memory for a packet");
    uint32_t ref = walker->job.packed->root;
    for (bool more = rays != 0; more;) {
        const struct packed *packed = &walker->touch.packed;
        struct wide node;
        walker->visits++;
        packed->layout->load(packed, ref, &node);
        if (node.child_count == 0)
            test_leaf(p, &node, rays);
        else if (!push_children(p, ref, &node, rays))
            return fail(reason, STATUS_LIMIT, "the stack of a packet is full");
        for (more = false; p->depth > 0 && !more;) {
            const struct packet_entry *entry = &p->stack[--p->depth];
            move_stack(p, false);
            rays = still_wanted(p, entry);
            ref = entry->ref;
            more = rays != 0;
        }
    }
    for (uint32_t i = 0; i < p->count; i++)
        traffic_answer(p->run, walker->unit, p->wave, p->ray[i], &p->walk[i].best);
    return STATUS_OK;
}

static enum status play(struct traffic_run *run, struct reason *reason)
{
    struct ray_packet *p = alloc_zeroed(1, sizeof *p);
    enum status status = p ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a packet");
    for (uint32_t k = 0; k < run->depth && !status; k++) {
        size_t count = run->paths->wave[k].count, packets = 0;
        p->run = run;
        p->wave = k;
        for (size_t first = 0; first < count && !status; first += run->machine->packet) {
            run->walker->unit = p->slot = (uint32_t)(packets++ % run->machine->memory.units);
            status = play_packet(p, first, reason);
        }
    }
    free(p);
    return status;
}

const struct scheduler sched_packets = {.name = "packets",
                                        .summary =
                                            "neighbouring rays share a stack and what they read",
                                        .uses = "units packet private layout store",
                                        .reorders = true,
                                        .play = play};
