/* Whole trials, played on engine cpu and judged. Text is a trial's file; other bytes are read as
 * choices: how many vertices, triangles and rays, members, and small numbers, so that any bytes are
 * a trial and changing one changes one thing. Wrong answers of members as published are findings,
 * as in every campaign, and are explained; what must not be is a contradiction of our own: of the
 * oracle's two ways, of the reference traversal with a packed tree that passed its check, or an
 * answer of repaired members that the judge calls wrong. */
#include "fuzz/findings/finding_file.h"
#include "tests/readers/reader_entry.h"
#include "fuzz/gen/mutate.h"
#include "fuzz/play/player.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- bytes to trials -------------------------------------------------------------------------- */

struct choices {
    const unsigned char *at, *end;
};

/* 0 when there is nothing more. */
static uint32_t choose(struct choices *from, uint32_t count)
{
    return from->at < from->end ? *from->at++ % count : 0;
}

/* A byte is a step of a lattice; those from 224 on have the bits of a float behind them. */
static float choose_float(struct choices *from, bool any)
{
    uint32_t byte = choose(from, 256), bits = 0;
    if (byte < 224)
        return (float)((int)byte - 112) / 8.0f;
    for (int i = 0; i < 4; i++)
        bits = bits << 8 | choose(from, 256);
    float value = float_from_bits(bits);
    return any || float_is_finite(value) ? value : 0.0f;
}

/* From the origin towards a vertex, or anywhere. */
static struct ray choose_ray(struct choices *from, const struct scene *scene)
{
    struct ray ray = {.tmax = INFINITY};
    uint32_t kind = choose(from, 4), vertex = choose(from, scene->vertex_count);
    for (int k = 0; k < 3; k++)
        ray.org[k] = choose_float(from, kind == 0);
    for (int k = 0; k < 3; k++)
        ray.dir[k] = kind < 2 ? choose_float(from, kind == 0)
                              : scene->vertex[3 * (size_t)vertex + (size_t)k] - ray.org[k];
    if (kind == 0 || kind == 3) {
        ray.tmin = choose_float(from, kind == 0);
        ray.tmax = choose_float(from, kind == 0);
    }
    return ray;
}

static uint32_t length_of(const void *table)
{
    const void *const *entry = table;
    uint32_t count = 0;
    while (entry[count])
        count++;
    return count;
}

static enum status choose_trial(const char *bytes, size_t size, struct fuzz_trial *out,
                                struct reason *reason)
{
    const unsigned char *start = (const unsigned char *)bytes;
    struct choices from = {start, start + size};
    uint32_t vertices = 3 + choose(&from, 30), triangles = choose(&from, 48);
    enum status status = fuzz_trial_make(vertices, triangles, 1 + choose(&from, 24), out, reason);
    if (status)
        return status;
    out->builder = builders[choose(&from, length_of(builders))];
    out->build.leaf = 1 + choose(&from, 10);
    out->box = box_tests[choose(&from, length_of(box_tests))];
    out->tri = tri_tests[choose(&from, length_of(tri_tests))];
    out->query = choose(&from, 2) ? QUERY_ANY : QUERY_CLOSEST;
    for (size_t i = 0; i < 3 * (size_t)vertices; i++)
        out->scene.vertex[i] = choose_float(&from, false);
    for (size_t i = 0; i < 3 * (size_t)triangles; i++)
        out->scene.index[i] = choose(&from, vertices);
    for (uint32_t i = 0; i < out->ray_count; i++)
        out->ray[i] = choose_ray(&from, &out->scene);
    return STATUS_OK;
}

static bool is_text(const char *bytes, size_t size)
{
    return size >= 7 && memcmp(bytes, "raydiff", 7) == 0;
}

static enum status make_trial(const char *bytes, size_t size, struct fuzz_trial *out,
                              struct reason *reason)
{
    struct finding_file file;
    if (!is_text(bytes, size))
        return choose_trial(bytes, size, out, reason);
    enum status status = finding_file_parse("fuzz", bytes, size, &file, reason);
    *out = file.trial;
    return status;
}

/* --- playing ---------------------------------------------------------------------------------- */

/* Nothing published takes part: nothing may be wrong. The layouts of the player are repaired ones
 * in the first half only. */
static bool is_repaired(const struct fuzz_trial *trial, const struct fuzz_finding *finding)
{
    return !trial->builder->faithful && !trial->box->faithful && !trial->tri->faithful &&
           !finding->signature.layout->faithful;
}

static struct fuzz_player *open_player(void)
{
    const struct engine *const cpu = engine_find("cpu");
    const struct engine_options options = {.threads = 1, .device = -1};
    struct fuzz_field field;
    struct fuzz_player *player = NULL;
    struct reason reason = {""};
    READER_MUST(fuzz_field_make(&cpu, 1, layouts, length_of(layouts), &options, &field, &reason) ==
                STATUS_OK);
    READER_MUST(fuzz_player_open(&field, &player, &reason) == STATUS_OK);
    return player;
}

static void must_be_known(struct fuzz_player *player, const struct fuzz_trial *trial,
                          struct fuzz_finding *finding)
{
    char text[FUZZ_SIGNATURE_MOST];
    struct fuzz_signature again;
    struct reason reason = {""};
    fuzz_signature_print(&finding->signature, text);
    if (is_repaired(trial, finding)) {
        fprintf(stderr, "reader play: ray %u: %s\n", finding->ray, text);
        reader_broken("repaired members are right", __FILE__, __LINE__);
    }
    READER_MUST(fuzz_explain(player, trial, finding, &reason) == STATUS_OK);
    fuzz_signature_print(&finding->signature, text);
    READER_MUST(fuzz_signature_parse(text, &again, &reason) == STATUS_OK);
    READER_MUST(fuzz_signature_same(&again, &finding->signature));
}

static bool play(const char *bytes, size_t size)
{
    static struct fuzz_player *player; /* kept: engines are not what is tested */
    struct fuzz_trial trial;
    struct fuzz_result result;
    struct reason reason = {""};
    enum status status = make_trial(bytes, size, &trial, &reason);
    if (!status)
        status = fuzz_trial_check(&trial, &reason);
    if (status) {
        READER_MUST(status == STATUS_INPUT || status == STATUS_LIMIT);
        reader_must_be_reason(&reason);
        fuzz_trial_free(&trial);
        return false;
    }
    player = player ? player : open_player();
    if (fuzz_play(player, &trial, 1, &result, NULL, NULL, &reason)) {
        fprintf(stderr, "reader play: %s\n", reason.text);
        reader_broken("a trial can be played", __FILE__, __LINE__);
    }
    READER_MUST(result.judged <= trial.ray_count);
    for (size_t i = 0; i < result.finding_count; i++)
        must_be_known(player, &trial, &result.finding[i]);
    fuzz_trial_free(&trial);
    return true;
}

const struct reader_entry reader_entry = {"play", READER_ANY, play};

/* --- changing trials -------------------------------------------------------------------------- */

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most) __attribute__((weak));
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

/* An edit of the trial that a text is. 0: it is none, or the result does not fit. */
static size_t edit_text(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    struct finding_file file;
    struct reason reason;
    struct rng rng = rng_make(seed, 1);
    char *copy = malloc(size + 1), *text = NULL;
    size_t length = 0;
    if (!copy)
        return 0;
    memcpy(copy, data, size);
    copy[size] = '\0';
    enum status status = finding_file_parse("fuzz", copy, size, &file, &reason);
    if (!status)
        status = mutate_once(&rng, &file.trial, EDIT_PARTS, &reason);
    if (!status)
        status = finding_file_print(&file, &text, &length, &reason);
    if (status || length > most)
        length = 0;
    else
        memcpy(data, text, length);
    finding_file_free(&file);
    free(text);
    free(copy);
    return length;
}

/* Half of the changes of a text are edits of its trial, the other half of its bytes. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    size_t length = 0;
    if (seed % 2 && is_text((const char *)data, size))
        length = edit_text(data, size, most, seed);
    if (length > 0)
        return length;
    return LLVMFuzzerMutate ? LLVMFuzzerMutate(data, size, most) : size;
}
