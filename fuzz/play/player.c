/* Plays trials in batches: all are set up, each engine traces all, all are judged. */
#include "fuzz/play/player.h"

#include "fuzz/play/stage.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Rays of a batch, at most, unless one trial has more. */
#define BATCH_RAYS 65536u

static bool in_field(const struct fuzz_field *field, const struct engine *engine,
                     const struct layout *layout)
{
    for (size_t i = 0; i < field->count; i++)
        if (field->who[i].engine == engine && field->who[i].layout == layout)
            return true;
    return false;
}

/* Rejects two engines whose findings would have one name. */
static enum status check_names(struct fuzz_field *field, struct reason *reason)
{
    for (size_t i = 0; i < field->count; i++)
        for (size_t k = 0; k < i; k++) {
            const struct engine *one = field->who[k].engine, *other = field->who[i].engine;
            struct fuzz_signature a, b;
            fuzz_signature_set_engine(&a, one->name);
            fuzz_signature_set_engine(&b, other->name);
            if (one == other || strcmp(a.engine, b.engine) != 0)
                continue;
            *field = (struct fuzz_field){0};
            return fail(reason, STATUS_INPUT,
                        "%.80s and %.80s: both are called %s in findings; give one another name, "
                        "as by a link",
                        one->name, other->name, a.engine);
        }
    return STATUS_OK;
}

enum status fuzz_field_make(const struct engine *const *engine, size_t engine_count,
                            const struct layout *const *layout, size_t layout_count,
                            const struct engine_options *options, struct fuzz_field *out,
                            struct reason *reason)
{
    *out = (struct fuzz_field){.options = *options};
    for (size_t e = 0; e < engine_count; e++)
        for (size_t l = 0; l < (engine[e]->needs_packed ? layout_count : 1); l++) {
            const struct layout *on = engine[e]->needs_packed ? layout[l] : NULL;
            if (in_field(out, engine[e], on))
                continue;
            if (out->count == FUZZ_CONTESTANTS_MOST) {
                *out = (struct fuzz_field){0};
                return fail(reason, STATUS_LIMIT, "more than %u engines times layouts",
                            FUZZ_CONTESTANTS_MOST);
            }
            out->who[out->count++] = (struct fuzz_contestant){engine[e], on};
        }
    return check_names(out, reason);
}

enum status fuzz_field_draw(const struct engine *const *engine, size_t engine_count,
                            const struct engine_options *options, struct fuzz_field *out,
                            struct reason *reason)
{
    const struct layout *none = NULL;
    enum status status = fuzz_field_make(engine, engine_count, &none, 1, options, out, reason);
    out->drawn = status == STATUS_OK;
    return status;
}

static size_t layout_index(struct fuzz_player *player, const struct layout *layout)
{
    size_t i = 0;
    while (i < player->layout_count && player->layout[i] != layout)
        i++;
    if (i == player->layout_count)
        player->layout[player->layout_count++] = layout;
    return i;
}

/* Adds a seat, its engine opened if no earlier seat has it. */
static enum status add_seat(struct fuzz_player *player, const struct engine *engine,
                            const struct layout *layout, struct reason *reason)
{
    struct seat *seat = &player->seat[player->seat_count];
    *seat = (struct seat){.engine = engine, .layout = layout, .reference = SEATS_MOST};
    for (size_t i = 0; i < player->seat_count && !seat->self; i++)
        if (player->seat[i].engine == engine)
            seat->self = player->seat[i].self;
    if (!seat->self) {
        enum status status = engine_open(engine, &player->options, &seat->self, reason);
        if (status)
            return status;
    }
    if (layout)
        seat->layout_index = layout_index(player, layout);
    player->seat_count++;
    return STATUS_OK;
}

/* Gives each seat that promises cpu's bits a seat of engine cpu to be compared with. */
static enum status add_references(struct fuzz_player *player, struct reason *reason)
{
    const struct engine *cpu = engine_reference(true);
    for (size_t i = 0; i < player->contestants; i++) {
        struct seat *seat = &player->seat[i];
        if (!seat->layout || !engine_model(seat->engine, seat->self, tri_tests[0]).bits)
            continue;
        size_t k = 0;
        while (k < player->seat_count &&
               (player->seat[k].engine != cpu || player->seat[k].layout != seat->layout))
            k++;
        enum status status =
            k < player->seat_count ? STATUS_OK : add_seat(player, cpu, seat->layout, reason);
        if (status)
            return status;
        seat->reference = k;
    }
    return STATUS_OK;
}

enum status fuzz_player_open(const struct fuzz_field *field, struct fuzz_player **out,
                             struct reason *reason)
{
    struct fuzz_player *player = alloc_zeroed(1, sizeof *player);
    *out = NULL;
    if (!player)
        return fail(reason, STATUS_MEMORY, "no memory for a player");
    player->options = field->options;
    player->stage = alloc_zeroed(FUZZ_BATCH, sizeof *player->stage);
    player->task = alloc_zeroed(FUZZ_BATCH, sizeof *player->task);
    enum status status = STATUS_OK;
    if (!player->stage || !player->task)
        status = fail(reason, STATUS_MEMORY, "no memory for a player");
    for (size_t i = 0; i < field->count && !status; i++)
        status = add_seat(player, field->who[i].engine, field->who[i].layout, reason);
    player->contestants = player->seat_count;
    if (!status && field->drawn) /* cast if a contestant promises its bits */
        status = add_seat(player, engine_reference(true), NULL, reason);
    else if (!status)
        status = add_references(player, reason);
    if (status)
        fuzz_player_close(player);
    else
        *out = player;
    return status;
}

/* True if an earlier seat has the same engine. */
static bool is_shared(const struct fuzz_player *player, size_t seat)
{
    for (size_t i = 0; i < seat; i++)
        if (player->seat[i].engine == player->seat[seat].engine)
            return true;
    return false;
}

void fuzz_player_close(struct fuzz_player *player)
{
    if (!player)
        return;
    for (size_t i = 0; i < player->seat_count; i++)
        if (!is_shared(player, i) && player->seat[i].self)
            player->seat[i].engine->close(player->seat[i].self);
    for (size_t i = 0; i < FUZZ_BATCH && player->stage; i++)
        stage_close(&player->stage[i]);
    free(player->stage);
    free(player->task);
    free(player);
}

void fuzz_player_leave_out(struct fuzz_player *player, uint32_t contestants)
{
    player->left_out = contestants;
}

void fuzz_player_cast(struct fuzz_player *player, size_t contestant, const struct layout *layout)
{
    struct seat *seat = &player->seat[contestant], *cpu = &player->seat[player->contestants];
    for (size_t i = 0; i < player->seat_count; i++) {
        player->seat[i].layout = NULL;
        player->seat[i].reference = SEATS_MOST;
    }
    player->left_out = ~(1u << contestant);
    player->layout[0] = layout;
    player->layout_count = seat->engine->needs_packed;
    if (!seat->engine->needs_packed)
        return;
    seat->layout = cpu->layout = layout;
    seat->layout_index = cpu->layout_index = 0;
    if (seat->engine != cpu->engine && engine_model(seat->engine, seat->self, tri_tests[0]).bits)
        seat->reference = player->contestants;
}

static void mark_set(struct fuzz_mark *mark, size_t first, size_t count, size_t contestant)
{
    if (!mark)
        return;
    atomic_store(&mark->trial, first);
    atomic_store(&mark->count, count);
    atomic_store(&mark->contestant, (uint32_t)contestant);
}

/* How many of the trials make a batch: all are of scenes, or all of worlds; of one with steps
 * none. */
static size_t batch_size(const struct fuzz_trial *trial, size_t count)
{
    size_t rays = 0, size = 0;
    while (size < count && size < FUZZ_BATCH && trial[size].world.is == trial[0].world.is &&
           trial[size].step_count == 0 && (!size || rays + trial[size].ray_count <= BATCH_RAYS))
        rays += trial[size++].ray_count;
    return size;
}

/* A reference plays if a contestant that is compared with it does. */
static bool is_left_out(const struct fuzz_player *player, size_t seat)
{
    if (seat < player->contestants)
        return player->left_out >> seat & 1u;
    for (size_t i = 0; i < player->contestants; i++)
        if (player->seat[i].reference == seat && !is_left_out(player, i))
            return false;
    return true;
}

/* Has all seats trace the stages of a batch, which begins with trial `first` of the call. */
static enum status ask_all(struct fuzz_player *player, size_t first, size_t count,
                           struct fuzz_time *time, struct fuzz_mark *mark, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t s = 0; s < player->seat_count && !status; s++) {
        uint64_t start = time_ns();
        if (is_left_out(player, s))
            continue; /* make_room has set that nothing was answered */
        mark_set(mark, first, count, s < player->contestants ? s : FUZZ_CONTESTANTS_MOST);
        player->mark = mark;
        player->mark_first = first;
        status = seat_ask(player, s, count, reason);
        if (!status)
            mark_set(mark, first, count, FUZZ_CONTESTANTS_MOST);
        uint64_t spent = time_ns() - start;
        if (time && s < player->contestants)
            time->engine[s] += spent;
        else if (time)
            time->judge += spent; /* a reference is the harness's */
    }
    return status;
}

static enum status play_batch(struct fuzz_player *player, const struct fuzz_trial *trial,
                              size_t first, size_t count, struct fuzz_result *result,
                              struct fuzz_time *time, struct fuzz_mark *mark, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = stage_set(&player->stage[i], player, &trial[i], time, reason);
    if (!status)
        status = ask_all(player, first, count, time, mark, reason);
    uint64_t start = time_ns();
    for (size_t i = 0; i < count && !status; i++)
        status = stage_judge(&player->stage[i], player, &result[i], reason);
    for (size_t i = 0; i < count; i++)
        stage_clear(&player->stage[i]);
    if (time)
        time->judge += time_ns() - start;
    return status;
}

static void add_result(const struct fuzz_result *from, uint32_t step, struct fuzz_result *sum)
{
    struct fuzz_result result = *from;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        result.count[v] += sum->count[v];
    result.wrong += sum->wrong;
    result.judged += sum->judged;
    result.states = sum->states + 1;
    result.refused = sum->refused > result.refused ? sum->refused : result.refused;
    result.refusers |= sum->refusers;
    result.decliners |= sum->decliners;
    result.players |= sum->players;
    result.provers |= sum->provers;
    result.refitted |= sum->refitted;
    result.rebuilt |= sum->rebuilt;
    for (size_t i = 0; i < FUZZ_CONTESTANTS_MOST * MATCH_EDGES; i++) {
        struct edges_lost *edges = &result.edges[i / MATCH_EDGES][i % MATCH_EDGES];
        edges->hits += sum->edges[i / MATCH_EDGES][i % MATCH_EDGES].hits;
        edges->lost += sum->edges[i / MATCH_EDGES][i % MATCH_EDGES].lost;
    }
    for (size_t i = 0; i < COVERAGE_WORDS; i++)
        result.coverage[i] |= sum->coverage[i];
    for (size_t i = 0; i < result.finding_count; i++)
        result.finding[i].step = step;
    *sum = result;
}

/* Plays a trial with steps, trial `at` of the call. */
static enum status play_life(struct fuzz_player *player, const struct fuzz_trial *trial, size_t at,
                             struct fuzz_result *result, struct fuzz_time *time,
                             struct fuzz_mark *mark, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct fuzz_result *one = alloc_zeroed(1, sizeof *one);
    if (!one)
        return fail(reason, STATUS_MEMORY, "no memory for the result of a step");
    *result = (struct fuzz_result){0};
    for (uint32_t step = 0; step <= trial->step_count && !status && !result->finding_count;
         step++) {
        struct fuzz_trial cut;
        status = trial_life_cut(trial, step, &cut, reason);
        if (!status)
            status = play_batch(player, &cut, at, 1, one, time, mark, reason);
        if (!status)
            add_result(one, step, result);
        fuzz_trial_free(&cut);
    }
    result->rebuilt &= ~result->refitted;
    free(one);
    return status;
}

enum status fuzz_play(struct fuzz_player *player, const struct fuzz_trial *trial, size_t count,
                      struct fuzz_result *result, struct fuzz_time *time, struct fuzz_mark *mark,
                      struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t done = 0; done < count && !status;) {
        size_t part = batch_size(trial + done, count - done);
        status =
            part ? play_batch(player, trial + done, done, part, result + done, time, mark, reason)
                 : play_life(player, trial + done, done, result + done, time, mark, reason);
        done += part ? part : 1;
    }
    return status;
}
