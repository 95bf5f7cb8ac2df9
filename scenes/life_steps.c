#include "scenes/life_steps.h"

#include "ref/base/text.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEED_DIGITS 19u /* any number of so many is below 2^64 */

void step_write(const struct step *step, char text[STEP_TEXT_MOST])
{
    text[0] = '\0';
    text_append(text, STEP_TEXT_MOST, "%s", life_act_name(step->act));
    if (step->motion != MOTION_STILL || step->seed)
        text_append(text, STEP_TEXT_MOST, ":%s", motion_name(step->motion));
    if (step->seed)
        text_append(text, STEP_TEXT_MOST, ":%llu", (unsigned long long)step->seed);
}

void steps_write(const struct step *step, uint32_t count, char text[STEPS_TEXT_MOST])
{
    text[0] = '\0';
    for (uint32_t i = 0; i < count; i++) {
        char one[STEP_TEXT_MOST];
        step_write(&step[i], one);
        text_append(text, STEPS_TEXT_MOST, "%s%s", i ? "," : "", one);
    }
}

static bool is_word(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && memcmp(text, word, length) == 0;
}

/* Takes the next word of a step. False: it is none. */
static bool take(const char *word, size_t length, unsigned place, struct step *out)
{
    if (place == 0) {
        out->act = is_word(word, length, "rebuild") ? LIFE_REBUILD : LIFE_REFIT;
        return is_word(word, length, life_act_name(out->act));
    }
    if (place == 1) {
        for (enum life_motion m = 0; m < MOTIONS; m++)
            if (is_word(word, length, motion_name(m))) {
                out->motion = m;
                return true;
            }
        return false;
    }
    for (size_t i = 0; i < length; i++) {
        if (!isdigit((unsigned char)word[i]))
            return false;
        out->seed = 10 * out->seed + (uint64_t)(word[i] - '0');
    }
    return place == 2 && length > 0 && length <= SEED_DIGITS;
}

static enum status parse_one(const char *text, size_t length, struct step *out,
                             struct reason *reason)
{
    const char *word = text, *end = text + length;
    *out = (struct step){0};
    for (unsigned place = 0;; place++) {
        const char *colon = memchr(word, ':', (size_t)(end - word));
        size_t part = (size_t)((colon ? colon : end) - word);
        if (!take(word, part, place, out))
            return fail(reason, STATUS_INPUT, "'%.*s': '%.*s' is no %s",
                        (int)(length < 40 ? length : 40), text, (int)(part < 40 ? part : 40), word,
                        place == 0   ? "act: refit or rebuild"
                        : place == 1 ? "motion: still, jitter, one, mirror, swap, far, point, "
                                       "zero or subnormal; of a world also drift, turn, reflect, "
                                       "scale, exchange, gather, away, masks or hide"
                        : place == 2 ? "seed: a whole number below 10^19"
                                     : "part of a step: ACT:MOTION:SEED");
        if (!colon)
            return STATUS_OK;
        word = colon + 1;
    }
}

enum status steps_parse(const char *text, struct step out[LIFE_STEPS_MOST], uint32_t *count,
                        struct reason *reason)
{
    *count = 0;
    for (const char *at = text;;) {
        size_t length = strcspn(at, ",");
        if (*count == LIFE_STEPS_MOST)
            return fail(reason, STATUS_INPUT, "at most %u steps", LIFE_STEPS_MOST);
        enum status status = parse_one(at, length, &out[*count], reason);
        if (status)
            return status;
        ++*count;
        if (!at[length])
            return STATUS_OK;
        at += length + 1;
    }
}

enum status steps_of_scene(const struct step *step, uint32_t count, struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (motion_is_of_worlds(step[i].motion))
            return fail(reason, STATUS_INPUT, "'%s' moves instances, which only worlds have",
                        motion_name(step[i].motion));
    return STATUS_OK;
}

/* --- scenes ----------------------------------------------------------------------------------- */

static enum status copy_moved(const struct scene *from, const struct step *step, struct scene *out,
                              struct reason *reason)
{
    *out = *from;
    out->vertex = alloc_copy(from->vertex, 3 * (size_t)from->vertex_count, sizeof *out->vertex);
    if (from->vertex && !out->vertex)
        return fail(reason, STATUS_MEMORY, "no memory for the %u vertices of a step",
                    from->vertex_count);
    if (step)
        motion_apply(step, out);
    return STATUS_OK;
}

enum status steps_scenes(const struct scene *first, const struct step *step, uint32_t count,
                         struct scene out[LIFE_STEPS_MOST + 1], struct reason *reason)
{
    enum status status = copy_moved(first, NULL, &out[0], reason);
    uint32_t made = !status;
    for (; made <= count && !status; made += !status)
        status = copy_moved(&out[made - 1], &step[made - 1], &out[made], reason);
    for (uint32_t i = 0; i < made && status; i++)
        free(out[i].vertex);
    return status;
}

enum status steps_scenes_back(const struct scene *last, const struct step *step, uint32_t count,
                              struct scene out[LIFE_STEPS_MOST + 1], struct reason *reason)
{
    uint32_t at = count; /* scenes from here on are made */
    enum status status = copy_moved(last, NULL, &out[at], reason);
    if (status)
        return status;
    while (at > 0 && !status) {
        status = copy_moved(&out[at], &step[at - 1], &out[at - 1], reason);
        at -= !status;
    }
    for (uint32_t i = at; i <= count && status; i++)
        free(out[i].vertex);
    return status;
}

void steps_free(struct scene scene[LIFE_STEPS_MOST + 1], uint32_t count)
{
    for (uint32_t i = 0; i <= count; i++)
        free(scene[i].vertex);
}
