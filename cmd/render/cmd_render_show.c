/* raydiff render --show: shows what determines a picture in false colours. */
#include "cmd/render/cmd_render_show.h"
#include "cmd/common/cmd_progress.h"

#include "ref/base/nearest_name.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/look/look_decoded.h"
#include "cmd/render/cmd_render_out.h"

#include <stdlib.h>
#include <string.h>

/* Number of pixels traced at a time, adapted so that this takes about PART_NS: a published box test
 * can take a thousand times as long as another. */
#define PART_FIRST ((size_t)1 << 11)
#define PART_LEAST ((size_t)1 << 6)
#define PART_MOST  ((size_t)1 << 20)
#define PART_NS    500000000u

static enum status take_range(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct show_range *range = &((struct render_settings *)options)->show.range;
    float lo, hi;
    char *text = given->text, *colon = strchr(text, ':');
    range->given = true;
    if (!colon)
        return fail(reason, STATUS_INPUT, "--show-range: '%s' is not LEAST:MOST", text);
    *colon = '\0';
    enum status status = parse_float("--show-range", text, &lo, reason);
    if (!status)
        status = parse_float("--show-range", colon + 1, &hi, reason);
    *colon = ':';
    if (status)
        return status;
    range->lo = (double)lo;
    range->hi = (double)hi;
    return STATUS_OK;
}

#define ROWS_OF struct render_settings

const struct option_row render_show_rows[] = {
    {"show-range", "A:B", "with --show: the ends of the colours, to compare pictures",
     OF_OWN(take_range)},
    {"csv", "FILE", "with --show: the value of every pixel; --json: statistics", OF_DATA(show.csv)},
    {0},
};

/* An engine opened on a stage, and what is needed to judge it. */
struct witness {
    void *self;
    struct numbers *numbers;
    struct oracle *oracle; /* of the scene; used for all layers */
    struct judge *judge;
    bool unknown;
};

static void witness_close(const struct showing *showing, struct witness *witness)
{
    numbers_free(witness->numbers);
    judge_free(witness->judge);
    oracle_free(witness->oracle);
    if (witness->self)
        showing->engine->close(witness->self);
}

/* Prepares the engine for the stage's current packed tree. */
static enum status witness_prepare(const struct showing *showing, const struct render_stage *stage,
                                   struct witness *witness, struct reason *reason)
{
    const struct job *job = &stage->job.job;
    enum status status = showing->engine->prepare(witness->self, job, reason);
    numbers_free(witness->numbers);
    judge_free(witness->judge);
    witness->numbers = NULL;
    witness->judge = NULL;
    if (!status && showing->show->from == SHOW_FROM_WALK)
        status = numbers_make(&stage->scene, &stage->bvh, &stage->packed, job->box, job->tri,
                              &witness->numbers, reason);
    if (status || showing->show->from != SHOW_FROM_JUDGE)
        return status;
    struct model model = engine_model(showing->engine, witness->self, job->tri);
    if (showing->engine->needs_packed && !job_keeps_watertight(job))
        model.watertight = false;
    witness->unknown = model.formula == TWIN_UNKNOWN;
    if (!witness->oracle)
        status = oracle_make(&stage->scene, &witness->oracle, reason);
    if (!status)
        status = judge_make(witness->oracle, &model, QUERY_CLOSEST, &witness->judge, reason);
    return status;
}

/* Computes sum and percentiles of one plane, and counts each verdict. */
static enum status measure(const struct showing *showing, bool names, struct show_layer *layer,
                           struct reason *reason)
{
    double *sorted = alloc_zeroed(showing->pixels, sizeof *sorted);
    if (!sorted)
        return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", showing->pixels);
    memcpy(sorted, layer->value, showing->pixels * sizeof *sorted);
    layer->sum = show_sum_of(layer->value, showing->pixels);
    layer->quantiles = quantiles_of(sorted, showing->pixels);
    free(sorted);
    for (size_t i = 0; i < showing->pixels && names && showing->show->id == SHOW_CLASS; i++)
        layer->verdict[(size_t)layer->value[i]]++;
    return STATUS_OK;
}

/* Checks that the pixels add up to the engine's own counters for the same rays. */
static enum status check_sum(const struct showing *showing, const struct show_layer *layer,
                             struct reason *reason)
{
    uint64_t counted = showing->show->id == SHOW_BOXES ? layer->counts.boxes : layer->counts.tris;
    if (showing->show->id != SHOW_BOXES && showing->show->id != SHOW_TRIANGLES)
        return STATUS_OK;
    if (layer->sum.sum == (double)counted)
        return STATUS_OK;
    return fail(reason, STATUS_INTERNAL, "%s: pixels add up to %.0f %s, engine %s counted %llu",
                layer->name, layer->sum.sum, showing->show->name, showing->engine->name,
                (unsigned long long)counted);
}

static size_t next_part(size_t part, uint64_t ns)
{
    if (ns < PART_NS / 2)
        return part < PART_MOST ? 2 * part : part;
    return ns > 2 * PART_NS && part > PART_LEAST ? part / 2 : part;
}

static enum status show_layer(const struct showing *showing, const struct render_stage *stage,
                              const struct witness *witness, struct show_layer *layer,
                              struct progress *progress, struct reason *reason)
{
    struct view view = render_stage_view(stage, 0);
    struct show_source source = {
        .show = showing->show,
        .job = &stage->job,
        .view = &view,
        .engine = showing->engine,
        .self = witness->self,
        .numbers = witness->numbers,
        .oracle = witness->judge ? witness->oracle : NULL,
        .judge = witness->judge,
        .unknown = witness->unknown,
    };
    enum status status = STATUS_OK;
    layer->name = stage->job.job.packed ? stage->packed.layout->name : showing->engine->name;
    layer->value = alloc_zeroed(showing->pixels, showing->show->planes * sizeof *layer->value);
    if (!layer->value)
        return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", showing->pixels);
    size_t part = PART_FIRST, count;
    for (size_t i = 0; i < showing->pixels && !status; i += count) {
        uint64_t start = time_ns();
        count = showing->pixels - i < part ? showing->pixels - i : part;
        progress_step(progress, "%s of %s: %.0f %%", showing->show->name, layer->name,
                      100.0 * (double)i / (double)showing->pixels);
        status = show_values(&source, i, count, layer->value + showing->show->planes * i,
                             &layer->counts, reason);
        part = next_part(part, time_ns() - start);
    }
    if (!status && showing->show->planes == 1)
        status = measure(showing, true, layer, reason);
    if (!status)
        status = check_sum(showing, layer, reason);
    return status;
}

/* Makes one layer per layout. */
static enum status show_layers(struct showing *showing, struct render_stage *stage,
                               struct reason *reason)
{
    const struct layout *versus = showing->settings->versus;
    struct progress progress = progress_make("render");
    struct witness witness = {0};
    enum status status =
        engine_open(showing->engine, &showing->settings->engine_options, &witness.self, reason);
    if (status)
        witness.self = NULL;
    for (size_t i = 0; i < showing->layer_count && !status; i++) {
        if (i > 0)
            status = render_stage_pack(stage, versus, reason);
        if (!status && stage->job.job.packed)
            showing->judged = showing->judged && !stage->packed.layout->faithful;
        if (!status)
            status = witness_prepare(showing, stage, &witness, reason);
        if (!status)
            status = show_layer(showing, stage, &witness, &showing->layer[i], &progress, reason);
    }
    progress_end(&progress);
    witness_close(showing, &witness);
    return status;
}

static enum status subtract(struct showing *showing, struct reason *reason)
{
    struct show_layer *out = &showing->difference;
    if (showing->layer_count < 2)
        return STATUS_OK;
    out->value = alloc_zeroed(showing->pixels, sizeof *out->value);
    if (!out->value)
        return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", showing->pixels);
    show_difference(showing->show, showing->layer[0].value, showing->layer[1].value,
                    showing->pixels, out->value, &showing->alone);
    return measure(showing, false, out, reason);
}

static enum status draw(struct showing *showing, const struct render_stage *stage,
                        struct image *image, struct reason *reason)
{
    bool two = showing->layer_count == 2;
    struct colour_place place;
    snprintf(showing->title, sizeof showing->title, "%.100s: %s, %s%s%s", showing->settings->scene,
             showing->show->name, two ? showing->layer[1].name : showing->layer[0].name,
             two ? " - " : "", two ? showing->layer[0].name : "");
    if (showing->engine->needs_packed)
        text_append(showing->title, sizeof showing->title, ", engine %s", showing->engine->name);
    return show_picture(showing->show, two,
                        two ? showing->difference.value : showing->layer[0].value, stage->job.width,
                        stage->job.height, &showing->range, showing->title, image, &place, reason);
}

/* Makes the picture and its statistics. */
static enum status show(struct showing *showing, struct render_stage *stage, struct reason *reason)
{
    const struct render_settings *settings = showing->settings;
    struct image image = {0};
    showing->pixels = (size_t)stage->job.width * stage->job.height;
    enum status status = show_layers(showing, stage, reason);
    if (!status)
        status = subtract(showing, reason);
    if (!status)
        status = draw(showing, stage, &image, reason);
    if (!status)
        status = image_write(settings->out, &image, reason);
    if (!status)
        showing_print(showing, &image);
    if (!status && showing->csv)
        status = showing_csv(showing, reason);
    if (!status && settings->json)
        status = showing_json(showing, settings->json, reason);
    image_free(&image);
    return status;
}

static enum status check(const struct showing *showing, const char *name, struct reason *reason)
{
    const struct render_settings *settings = showing->settings;
    const struct engine *engine = showing->engine;
    if (!showing->show) {
        char known[200] = "", hint[NEAREST_HINT];
        struct nearest_name nearest = nearest_make(name, strlen(name));
        for (const struct show *one = shows; one->name; one++) {
            text_append(known, sizeof known, "%s%s", one == shows ? "" : ", ", one->name);
            nearest_try(&nearest, one->name);
        }
        return fail(reason, STATUS_INPUT, "--show: unknown '%.40s'; known: %s%s", name, known,
                    nearest_hint(&nearest, hint));
    }
    if (settings->versus && !engine->needs_packed)
        return fail(reason, STATUS_INPUT,
                    "--layout: engine %s reads no layout, so there is no difference of two",
                    engine->name);
    if (engine->recorded)
        return fail(reason, STATUS_INPUT, "engine %s cannot trace new rays", engine->name);
    return show_range_check(showing->show, settings->versus != NULL, &showing->range, reason);
}

static enum status try_outputs(const struct showing *showing, struct reason *reason)
{
    char path[512];
    enum status status = frame_path(showing->settings->out, 1, 1, path, sizeof path, reason);
    return status ? status : output_try(showing->settings->out, reason);
}

static bool any_wrong(const struct showing *showing)
{
    size_t wrong = 0;
    for (size_t l = 0; l < showing->layer_count; l++) {
        const struct show_layer *layer = &showing->layer[l];
        wrong += layer->verdict[VERDICT_WRONG];
        wrong += showing->show->id == SHOW_ERROR && layer->sum.most > 1.0;
    }
    return showing->judged && wrong > 0;
}

/* Values taken from the walk always use the C engine, whatever was selected. */
static void choose_engine(struct showing *showing, struct render_settings *settings)
{
    if (showing->show && showing->show->from == SHOW_FROM_WALK) {
        if (settings->engine != engine_reference(true))
            fprintf(stderr, "raydiff render: --show %s is of the walk in C: engine cpu, not %s\n",
                    showing->show->name, settings->engine->name);
        settings->engine = engine_reference(true);
    }
    showing->engine = settings->engine;
}

static int run(const struct render_settings *given, const char *name)
{
    struct render_settings settings = *given;
    struct showing showing = {.show = show_find(name),
                              .settings = &settings,
                              .csv = settings.show.csv,
                              .range = settings.show.range,
                              .layer_count = settings.versus ? 2 : 1,
                              .judged = true};
    struct render_stage stage = {0};
    struct reason reason = {""};
    choose_engine(&showing, &settings);
    if (check(&showing, name, &reason))
        return usage_error("render", "%s", reason.text);
    if (showing.engine->needs_packed)
        showing.judged = (settings.bvh || !settings.builder->faithful) && !settings.box->faithful;
    enum status status = try_outputs(&showing, &reason);
    /* Light does not change the values; a little avoids the warning about missing light. */
    if (settings.look.profile == PROFILE_REPAIRED)
        settings.look.ambience = 1;
    else
        settings.look.camera_light = 1;
    if (!status)
        status = render_stage_open("render", &settings, &stage, &reason);
    if (!status && showing.show->from == SHOW_FROM_WALK && tree_file_is_packed(&stage.file))
        status = decoded_tree(&stage.packed, &stage.scene, &stage.bvh, &reason);
    if (!status)
        status = show(&showing, &stage, &reason);
    render_stage_close(&stage);
    for (size_t l = 0; l < SHOW_LAYERS_MOST; l++)
        free(showing.layer[l].value);
    free(showing.difference.value);
    if (!status && any_wrong(&showing))
        return EXIT_MISMATCH;
    return exit_with_reason("render", status, &reason);
}

extern const struct render_mode render_mode_show;
const struct render_mode render_mode_show = {
    .name = "show",
    .row = render_show_rows,
    .two_layouts = true,
    .never = "frames angle paths bounces ambience camera-light-strength waves plan general",
    .run = run,
};
