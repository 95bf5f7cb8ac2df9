/* A trial's tree, its packed forms and its truth. */
#include "fuzz/play/stage_world.h"

#include "ref/outside/plugin_guard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Beyond so many triangles the oracle's tree is faster than its brute force; both are exact. */
#define BRUTE_MOST 512u

#define ALIGNMENT 64u

static size_t padded(size_t bytes)
{
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Cuts the arrays of the stage out of its room. */
static enum status make_room(struct play_stage *stage, size_t seats, size_t rays)
{
    size_t truth = padded(rays * sizeof *stage->truth);
    size_t hits = padded(rays * sizeof(struct hit)), flags = padded(rays * sizeof(uint32_t));
    size_t need = truth + seats * (hits + 3 * flags) + ALIGNMENT;
    if (need > stage->room_bytes) {
        free(stage->room);
        stage->room = malloc(need);
        stage->room_bytes = stage->room ? need : 0;
        if (!stage->room)
            return STATUS_MEMORY;
    }
    uint8_t *at = stage->room;
    at += (ALIGNMENT - (uintptr_t)at % ALIGNMENT) % ALIGNMENT;
    stage->truth = (void *)at;
    at += truth;
    for (size_t i = 0; i < seats; i++) {
        stage->answers[i] = (struct answers){.hit = (void *)at,
                                             .flag = (void *)(at + hits),
                                             .work = (void *)(at + hits + flags),
                                             .tag = (void *)(at + hits + 2 * flags)};
        at += hits + 3 * flags;
    }
    return STATUS_OK;
}

static void say(struct play_stage *stage, size_t i, const struct reason *reason)
{
    snprintf(stage->said[i], FUZZ_SAID_MOST, "%.*s", FUZZ_SAID_MOST - 1, reason->text);
}

/* A layout's bytes are at fault only if the tree that they were made from was none. */
static bool is_broken(struct play_stage *stage, size_t i, enum status *status)
{
    const struct scene *scene = &stage->trial->scene;
    struct packed_faults faults;
    struct reason reason;
    *status = packed_check(&stage->packed[i], scene, &faults, &reason);
    stage->rule[i] = faults.first;
    if (*status != STATUS_INPUT)
        return false;
    say(stage, i, &reason);
    *status = bvh_check(stage_tree(stage, i), scene, &reason);
    bool sound = *status == STATUS_OK;
    if (*status == STATUS_INPUT)
        *status = STATUS_OK;
    return sound;
}

/* What a layout from outside did in place of packing, which checks what it packs. */
static enum fuzz_kind outside_fault(enum status status)
{
    if (status == STATUS_INPUT)
        return FUZZ_KIND_TREE;
    return plugin_hung() ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH;
}

/* Makes all trees of a trial with steps; the last one is what is traced. */
static enum status pack_life(struct play_stage *stage, const struct layout *layout, size_t i,
                             struct reason *reason)
{
    const uint32_t last = stage->life.count;
    stage->tree[i] = alloc_zeroed(LIFE_STEPS_MOST + 1, sizeof *stage->tree[i]);
    if (!stage->tree[i])
        return fail(reason, STATUS_MEMORY, "no memory for the trees of a life");
    enum status status =
        trial_life_trees(stage->trial, &stage->life, layout, stage->tree[i], reason);
    if (status) {
        free(stage->tree[i]);
        stage->tree[i] = NULL;
        return status;
    }
    stage->moved[i] = stage->tree[i][last].bvh;
    stage->packed[i] = stage->tree[i][last].packed;
    stage->motion[i] = fuzz_trial_motion(stage->tree[i][last].fate);
    return STATUS_OK;
}

/* Frees them, with what is shared. */
static void clear_life(struct play_stage *stage, size_t i)
{
    for (uint32_t k = 0; k <= stage->life.count && stage->tree[i]; k++)
        life_tree_free(&stage->tree[i][k]);
    if (stage->tree[i]) {
        stage->packed[i] = (struct packed){0};
        stage->moved[i] = (struct bvh){0};
    }
    free(stage->tree[i]);
    stage->tree[i] = NULL;
}

/* A tree that moves is made anew for each layout: one is refitted, the next may be rebuilt. */
static enum status pack(struct play_stage *stage, const struct layout *layout, size_t i,
                        struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    stage->motion[i] = TRIAL_STILL;
    if (trial->step_count > 0)
        return pack_life(stage, layout, i, reason);
    if (trial->move > 0)
        return fuzz_trial_tree(trial, layout, &stage->moved[i], &stage->packed[i],
                               &stage->motion[i], reason);
    return fuzz_trial_pack(trial, layout, &stage->bvh, &stage->packed[i], reason);
}

static enum status pack_all(struct play_stage *stage, const struct fuzz_player *player,
                            struct reason *reason)
{
    for (size_t i = 0; i < player->layout_count; i++) {
        const struct layout *layout = player->layout[i];
        stage->has_packed[i] = false;
        stage->fault[i] = FUZZ_KIND_COUNT;
        stage->rule[i] = PACKED_SOUND;
        stage->said[i][0] = '\0';
        if (!stage->has_tree)
            continue;
        enum status status = pack(stage, layout, i, reason);
        if (status == STATUS_LIMIT)
            continue;
        if ((layout->outside && (status == STATUS_INPUT || status == STATUS_DEVICE)) ||
            (status == STATUS_INPUT && (stage->trial->move > 0 || stage->trial->step_count > 0))) {
            stage->fault[i] = outside_fault(status);
            stage->rule[i] = layout->outside ? plugin_rule() : PACKED_SOUND;
            say(stage, i, reason);
            continue;
        }
        stage->has_packed[i] = status == STATUS_OK;
        if (status == STATUS_OK && is_broken(stage, i, &status))
            stage->fault[i] = FUZZ_KIND_TREE;
        if (status)
            return status == STATUS_MEMORY
                       ? fail(reason, status, "no memory to check a tree")
                       : fail(reason, STATUS_INTERNAL, "a builder's tree: %s", reason->text);
    }
    return STATUS_OK;
}

static enum status find_truth(struct play_stage *stage, struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    if (trial->world.is)
        return stage_world_truth(stage, reason);
    enum status status = oracle_make(&trial->scene, &stage->oracle, reason);
    if (status == STATUS_UNSUPPORTED)
        status = STATUS_INTERNAL; /* an engine left the float environment changed */
    if (status)
        return status;
    enum oracle_path path = trial->scene.tri_count <= BRUTE_MOST ? ORACLE_BRUTE : ORACLE_TREE;
    return oracle_closest(stage->oracle, path, ORACLE_CLOSED, trial->ray, trial->ray_count, 1,
                          stage->truth, NULL, reason);
}

/* Compares what a device builds with C's tree. A difference is in *built, and the trial is then
 * played with its twin in C. Errors: those of a device that cannot be opened; STATUS_MEMORY. */
static enum status compare_device(struct play_stage *stage, struct reason *built,
                                  struct reason *reason)
{
    const struct fuzz_trial *trial = stage->trial;
    if (!trial->builder->compare)
        return STATUS_OK;
    enum status status = trial->builder->compare(&trial->scene, built);
    if (status && status != STATUS_DEVICE)
        return fail(reason, status, "%s", built->text);
    if (status) {
        stage->in_c = *trial;
        stage->in_c.builder = builder_find(trial->builder->twin);
        stage->trial = &stage->in_c;
    }
    return STATUS_OK;
}

static enum status build_and_pack(struct play_stage *stage, const struct fuzz_player *player,
                                  struct reason *reason)
{
    if (stage->trial->world.is)
        return stage_world_set(stage, player, reason);
    struct reason built = {""};
    enum status status = compare_device(stage, &built, reason);
    if (!status)
        status = trial_life_make(stage->trial, &stage->life, reason);
    if (!status)
        status = fuzz_trial_build(stage->trial, &stage->bvh, reason);
    stage->has_tree = status == STATUS_OK;
    if (status && status != STATUS_LIMIT)
        return status == STATUS_MEMORY ? status : fail(reason, STATUS_INTERNAL, "%s", reason->text);
    status = pack_all(stage, player, reason);
    for (size_t i = 0; i < player->layout_count && built.text[0] && !status; i++) {
        stage->fault[i] = FUZZ_KIND_TREE;
        stage->rule[i] = PACKED_DEVICE;
        say(stage, i, &built);
    }
    return status;
}

enum status stage_set(struct play_stage *stage, const struct fuzz_player *player,
                      const struct fuzz_trial *trial, struct fuzz_time *time, struct reason *reason)
{
    uint64_t start = time_ns();
    stage->trial = trial;
    enum status status = make_room(stage, player->seat_count, trial->ray_count);
    if (status)
        return fail(reason, status, "no memory to play %u rays", trial->ray_count);
    status = build_and_pack(stage, player, reason);
    uint64_t built = time_ns();
    if (!status)
        status = find_truth(stage, reason);
    if (time) {
        time->build += built - start;
        time->truth += time_ns() - built;
    }
    return status;
}

void stage_clear(struct play_stage *stage)
{
    for (size_t i = 0; i < LAYOUTS_MOST; i++) {
        clear_life(stage, i);
        packed_free(&stage->packed[i]);
        bvh_free(&stage->moved[i]);
    }
    trial_life_free(&stage->life);
    bvh_free(&stage->bvh);
    oracle_free(stage->oracle);
    stage->oracle = NULL;
    stage_world_clear(stage);
    stage->trial = NULL;
}

void stage_close(struct play_stage *stage)
{
    stage_clear(stage);
    free(stage->room);
    *stage = (struct play_stage){0};
}

struct job stage_job(const struct play_stage *stage, const struct seat *seat)
{
    const struct fuzz_trial *trial = stage->trial;
    return (struct job){.scene = &trial->scene,
                        .packed = seat->layout ? &stage->packed[seat->layout_index] : NULL,
                        .box = trial->box,
                        .tri = trial->tri,
                        .query = trial->query};
}
