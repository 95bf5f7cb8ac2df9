#include "ref/outside/recorded.h"

#include "ref/outside/pipe.h"
#include "ref/base/ray_text.h"
#include "ref/twin/model.h"
#include "ref/world/world.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The state of an engine. There is one for a file and one for a single answer. */
struct tape {
    struct recorded answers;
    struct model model;
    char name[RECORDED_NAME_MOST];
    struct ray first; /* single answer: the ray that it belongs to */
    struct hit only;
    bool asked;
    bool of_world; /* what was prepared */
};
static struct tape of_file, of_ray;

static bool set_model(struct tape *tape, struct reason *reason)
{
    const struct recorded *a = &tape->answers;
    return pipe_model(a->formula, a->rounding, a->flags, &tape->model, reason) == STATUS_OK;
}

static enum status open_file(const struct engine *engine, const struct engine_options *options,
                             void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &of_file;
    return STATUS_OK;
}

static enum status open_ray(const struct engine *engine, const struct engine_options *options,
                            void **self, struct reason *reason)
{
    (void)engine, (void)options, (void)reason;
    *self = &of_ray;
    return STATUS_OK;
}

static enum status check_hits(const struct tape *tape, uint32_t triangles, struct reason *reason)
{
    for (size_t i = 0; i < tape->answers.count; i++)
        if (tape->answers.hit[i].prim != ABI_NO_PRIM && tape->answers.hit[i].prim >= triangles)
            return fail(reason, STATUS_LIMIT, "answer %zu names triangle %u of %u", i,
                        tape->answers.hit[i].prim, triangles);
    return STATUS_OK;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct tape *tape = self;
    tape->of_world = false;
    return check_hits(tape, job->scene->tri_count, reason);
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct tape *tape = self;
    tape->of_world = true;
    return check_hits(tape, world_tri_count(job->world), reason);
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct tape *tape = self;
    *report = (struct trace_report){0};
    if (tape == &of_ray && ray_count > 0 && !tape->asked) {
        tape->first = ray[0];
        tape->asked = true;
    }
    if (ray_count > tape->answers.count ||
        memcmp(ray, tape->answers.ray, ray_count * sizeof *ray) != 0)
        return fail(reason, STATUS_UNSUPPORTED, "no answer is recorded for this ray");
    memcpy(hit, tape->answers.hit, ray_count * sizeof *hit);
    return STATUS_OK;
}

static bool traces_worlds(const void *self)
{
    return ((const struct tape *)self)->answers.tag != NULL;
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    const struct recorded *answers = &((const struct tape *)self)->answers;
    enum status status = trace(self, ray, ray_count, hit, report, reason);
    if (status)
        return status;
    if (memcmp(mode, answers->mode, ray_count * sizeof *mode) != 0)
        return fail(reason, STATUS_UNSUPPORTED, "no answer is recorded for this mask and flags");
    memcpy(tag, answers->tag, ray_count * sizeof *tag);
    return STATUS_OK;
}

static const struct world_tracer worlds = {
    .prepare_world = prepare_world, .trace_world = trace_world, .traces = traces_worlds};

/* As of a pipe: in worlds transforms are its own. */
static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine;
    const struct tape *tape = self;
    struct model model = tape->model;
    (void)tri;
    if (tape->of_world)
        model.formula = TWIN_UNKNOWN;
    return model;
}

static void close_tape(void *self)
{
    (void)self;
}

static void describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes)
{
    (void)engine, (void)options;
    snprintf(text, text_bytes, "recorded answers");
}

static const struct engine file_engine = {
    .name = of_file.name,
    .summary = "answers of a file",
    .own_tri = true,
    .recorded = true,
    .open = open_file,
    .prepare = prepare,
    .trace = trace,
    .worlds = &worlds,
    .model = model,
    .close = close_tape,
    .describe = describe,
};

static const struct engine ray_engine = {
    .name = of_ray.name,
    .summary = "one answer",
    .own_tri = true,
    .open = open_ray,
    .prepare = prepare,
    .trace = trace,
    .model = model,
    .close = close_tape,
    .describe = describe,
};

enum status recorded_engine(const struct recorded *answers, const struct engine **out,
                            struct reason *reason)
{
    *out = NULL;
    of_file.answers = *answers;
    if (!set_model(&of_file, reason))
        return STATUS_INPUT;
    snprintf(of_file.name, sizeof of_file.name, RECORDED_PREFIX "%s:%s:%" PRIu32,
             pipe_formula_name(answers->formula), pipe_rounding_name(answers->rounding),
             answers->flags);
    *out = &file_engine;
    return STATUS_OK;
}

void recorded_name(const char *engine, const struct hit *hit, char text[RECORDED_NAME_MOST])
{
    char number[3][32];
    const float value[3] = {hit->t, hit->u, hit->v};
    for (int k = 0; k < 3; k++)
        float_text_write(value[k], number[k]);
    if (hit->prim == ABI_NO_PRIM)
        snprintf(text, RECORDED_NAME_MOST, "%.60s:miss", engine);
    else
        snprintf(text, RECORDED_NAME_MOST, "%.50s:%.30s:%.30s:%.30s:%" PRIu32, engine, number[0],
                 number[1], number[2], hit->prim);
}

/* Returns the next field, which ends at a colon or the end of the text, and moves *rest behind it.
 * NULL past the last. */
static char *cut_field(char **rest)
{
    char *field = *rest;
    if (!field)
        return NULL;
    char *end = strchr(field, ':');
    if (end)
        *end = '\0';
    *rest = end ? end + 1 : NULL;
    return field;
}

static uint32_t find_word(const char *word, const char *(*name)(uint32_t))
{
    uint32_t i = 0;
    while (name(i) && strcmp(name(i), word) != 0)
        i++;
    return i;
}

static bool take_whole(const char *text, uint32_t *out)
{
    char *end;
    unsigned long long n = text && *text >= '0' && *text <= '9' ? strtoull(text, &end, 10) : 0;
    if (!text || *text < '0' || *text > '9' || *end || n >= ABI_NO_PRIM)
        return false;
    *out = (uint32_t)n;
    return true;
}

static bool take_float(const char *text, float *out)
{
    const char *end = text ? float_text_read(text, out) : NULL;
    return end && *end == '\0';
}

/* Reads the fields of a name into `of_ray`. */
static bool take_name(const char *name, struct reason *reason)
{
    char text[RECORDED_NAME_MOST], *rest = text;
    struct recorded *a = &of_ray.answers;
    struct hit *hit = &of_ray.only;
    *a = (struct recorded){.ray = &of_ray.first, .hit = hit, .count = 1};
    if (strlen(name) >= sizeof text)
        return false;
    strcpy(text, name + strlen(RECORDED_PREFIX));
    char *formula = cut_field(&rest), *rounding = cut_field(&rest);
    if (!rounding || !take_whole(cut_field(&rest), &a->flags))
        return false;
    a->formula = find_word(formula, pipe_formula_name);
    a->rounding = find_word(rounding, pipe_rounding_name);
    if (rest && strcmp(rest, "miss") == 0)
        *hit = (struct hit){.prim = ABI_NO_PRIM};
    else if (!take_float(cut_field(&rest), &hit->t) || !take_float(cut_field(&rest), &hit->u) ||
             !take_float(cut_field(&rest), &hit->v) || !take_whole(cut_field(&rest), &hit->prim) ||
             rest)
        return false;
    return set_model(&of_ray, reason);
}

enum status recorded_find(const char *name, const struct engine **out, struct reason *reason)
{
    *out = engine_find(name);
    if (*out)
        return STATUS_OK;
    if (of_ray.name[0])
        return fail(reason, STATUS_LIMIT, "one answer at a time");
    if (strncmp(name, RECORDED_PREFIX, strlen(RECORDED_PREFIX)) != 0 || !take_name(name, NULL))
        return fail(reason, STATUS_INPUT,
                    "'%.100s' is not answer:FORMULA:ROUNDING:FLAGS:T:U:V:TRIANGLE, or :miss", name);
    enum status status = engine_add(&ray_engine, out, reason);
    if (status)
        return status;
    strcpy(of_ray.name, name);
    return STATUS_OK;
}
