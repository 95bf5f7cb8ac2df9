#include "bench/traffic/schedulers.h"

#include "ref/base/memory.h"

#include <stdlib.h>
#include <string.h>

extern const struct scheduler sched_depth_first, sched_packets, sched_sorted, sched_treelets,
    sched_strata, sched_dual, sched_mach_rt, sched_raycore;

const struct scheduler *const schedulers[] = {&sched_depth_first, &sched_packets, &sched_sorted,
                                              &sched_treelets,    &sched_strata,  &sched_dual,
                                              &sched_mach_rt,     &sched_raycore, NULL};

const struct scheduler *scheduler_find(const char *name)
{
    for (size_t i = 0; schedulers[i]; i++)
        if (strcmp(schedulers[i]->name, name) == 0)
            return schedulers[i];
    return NULL;
}

static enum status check_range(const char *what, uint64_t value, uint64_t most,
                               struct reason *reason)
{
    if (value >= 1 && value <= most)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: %llu is not in 1 to %llu", what,
                (unsigned long long)value, (unsigned long long)most);
}

enum status traffic_machine_check(const struct traffic_machine *machine, struct reason *reason)
{
    enum status status = traffic_memory_check(&machine->memory, reason);
    if (!status)
        status = check_range("units", machine->memory.units, TRAFFIC_UNITS_MOST, reason);
    if (!status)
        status = check_range("lanes", machine->lanes, TRAFFIC_LANES_MOST, reason);
    if (!status)
        status = check_range("rays of a packet", machine->packet, TRAFFIC_PACKET_MOST, reason);
    if (!status)
        status = check_range("bytes of a treelet", machine->treelet, 1u << 30, reason);
    return status ? status : check_range("rays in queues", machine->queue, 1u << 28, reason);
}

uint64_t traffic_run_bytes(const struct traffic_machine *machine, uint32_t stack_need, size_t rays)
{
    uint64_t lanes = (uint64_t)machine->memory.units * machine->lanes;
    uint64_t queue = machine->queue < rays ? machine->queue : rays;
    uint64_t waiting = sizeof(struct traffic_waiting) + stack_need * sizeof(struct traffic_left);
    return lanes * sizeof(struct traffic_lane) + queue * waiting + (uint64_t)rays * 32;
}

/* --- answers ---------------------------------------------------------------------------------- */

/* Waves take turns in two halves of the rays and of the hits. */
static uint64_t place_of(const struct traffic_run *run, uint32_t wave, uint32_t ray)
{
    return (wave % 2) * (uint64_t)run->paths->wave[0].count + ray;
}

void traffic_take_ray(struct traffic_run *run, uint32_t unit, uint32_t wave, uint32_t ray)
{
    traffic_access(&run->memory, unit, TRAFFIC_L1, TRAFFIC_AT_RAYS,
                   place_of(run, wave, ray) * TRAFFIC_RAY_BYTES, TRAFFIC_RAY_BYTES, false);
}

void traffic_note_answer(struct traffic_run *run, uint32_t wave, uint32_t ray,
                         const struct hit *hit)
{
    run->twice += run->answered[wave][ray];
    run->answered[wave][ray] = true;
    run->hit[wave][ray] = *hit;
}

void traffic_answer(struct traffic_run *run, uint32_t unit, uint32_t wave, uint32_t ray,
                    const struct hit *hit)
{
    traffic_access(&run->memory, unit, TRAFFIC_L1, TRAFFIC_AT_HITS,
                   place_of(run, wave, ray) * TRAFFIC_HIT_BYTES, TRAFFIC_HIT_BYTES, true);
    traffic_note_answer(run, wave, ray, hit);
}

/* Compares the answer to a ray with what is expected. */
static void judge(const struct traffic_run *run, uint32_t wave, size_t i, const struct hit *wanted,
                  bool ordered, struct traffic_result *out)
{
    const struct hit *hit = &run->hit[wave][i];
    if (!run->answered[wave][i])
        out->wrong++;
    else if (memcmp(hit, wanted, sizeof *hit) != 0) {
        bool tie = hit->prim != ABI_NO_PRIM && wanted->prim != ABI_NO_PRIM &&
                   hit->prim != wanted->prim && float_bits(hit->t) == float_bits(wanted->t);
        out->ties += tie;
        out->wrong += !tie && !ordered;
        out->other += !tie && ordered;
    }
}

static void judge_all(const struct scheduler *scheduler, const struct traffic_run *run,
                      struct traffic_result *out)
{
    bool ordered = scheduler->reorders && run->walker->job.packed->layout->faithful;
    out->wrong = run->twice;
    for (uint32_t k = 0; k < run->depth; k++) {
        const struct traffic_wave *wave = &run->paths->wave[k];
        out->rays += wave->count;
        for (size_t i = 0; i < wave->count; i++) {
            struct hit wanted = wave->hit[i];
            struct kd_counts counts;
            if (scheduler->kd)
                wanted = kd_closest(run->kd, &wave->ray[i], &counts);
            judge(run, k, i, &wanted, ordered, out);
        }
    }
}

static enum status open_run(struct traffic_run *run, struct reason *reason)
{
    enum status status = traffic_memory_make(&run->machine->memory, &run->memory, reason);
    for (uint32_t k = 0; k < run->depth && !status; k++) {
        size_t count = run->paths->wave[k].count;
        run->hit[k] = alloc_zeroed(count, sizeof *run->hit[k]);
        run->answered[k] = alloc_zeroed(count, sizeof *run->answered[k]);
        if (!run->hit[k] || !run->answered[k])
            status = fail(reason, STATUS_MEMORY, "no memory for %zu answers", count);
    }
    return status;
}

static void close_run(struct traffic_run *run)
{
    for (uint32_t k = 0; k < run->depth; k++) {
        free(run->hit[k]);
        free(run->answered[k]);
        run->hit[k] = NULL;
        run->answered[k] = NULL;
    }
    traffic_memory_free(&run->memory);
}

enum status traffic_play(const struct scheduler *scheduler, struct traffic_run *run,
                         struct traffic_result *out, struct reason *reason)
{
    *out = (struct traffic_result){.rays = 0};
    enum status status = open_run(run, reason);
    run->loads = run->twice = run->reloads = 0;
    if (!status) {
        run->walker->memory = &run->memory;
        run->walker->unit = 0;
        run->walker->source = TRAFFIC_CACHED;
        run->walker->trail = TRAFFIC_STACK_CACHED;
        run->walker->visits = 0;
        status = scheduler->play(run, reason);
    }
    if (!status && run->memory.failed)
        status = fail(reason, STATUS_MEMORY, "no memory for the working set");
    if (!status) {
        traffic_flush(&run->memory);
        judge_all(scheduler, run, out);
        memcpy(out->count, run->memory.count, sizeof out->count);
        out->row_hits = run->memory.row_hits;
        out->row_misses = run->memory.row_misses;
        out->working_set = traffic_working_set(&run->memory);
        out->visits = run->walker->visits;
        out->loads = run->loads;
        out->reloads = run->reloads;
        out->conserved = traffic_conserved(&run->memory, !scheduler->streams);
    }
    close_run(run);
    return status;
}
