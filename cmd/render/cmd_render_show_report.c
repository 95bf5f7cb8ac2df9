/* The statistics of raydiff render --show, as text, CSV and JSON. */
#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_options.h"
#include "cmd/render/cmd_render_show.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <math.h>

static void print_amounts(const struct show *show, const char *name, const struct show_layer *layer,
                          const struct showing *showing)
{
    uint32_t width = showing->settings->width;
    char text[6][40];
    const double value[6] = {layer->sum.sum,       layer->sum.least,     layer->sum.mean,
                             layer->quantiles.p50, layer->quantiles.p99, layer->sum.most};
    for (size_t i = 0; i < ARRAY_COUNT(value); i++)
        snprintf(text[i], sizeof text[i], show->whole && i != 2 ? "%.0f" : "%.6g", value[i]);
    if (layer->sum.pixels == 0)
        printf("%-20s no pixel has a value\n", name);
    else
        printf("%-20s %12s %10s %10s %10s %10s %10s  at %zu,%zu; %zu of %zu pixels\n", name,
               text[0], text[1], text[2], text[3], text[4], text[5], layer->sum.most_at % width,
               layer->sum.most_at / width, layer->sum.pixels, showing->pixels);
}

static void print_verdicts(const struct showing *showing)
{
    printf("%-16s", "verdict");
    for (size_t l = 0; l < showing->layer_count; l++)
        printf(" %12s", showing->layer[l].name);
    puts("");
    for (int v = 0; v < VERDICT_COUNT; v++) {
        printf("%-16s", verdict_name((enum verdict)v));
        for (size_t l = 0; l < showing->layer_count; l++)
            printf(" %12zu", showing->layer[l].verdict[v]);
        puts("");
    }
}

/* Number of places listed for a closer look. */
#define PLACES_MOST 5

static void print_places(const struct showing *showing, const double *value, double plain,
                         const char *name)
{
    const struct show *show = showing->show;
    uint32_t width = showing->settings->width;
    size_t found = 0;
    char text[40];
    for (size_t i = 0; i < showing->pixels && found < PLACES_MOST; i++) {
        if (isnan(value[i]) || value[i] == plain)
            continue;
        printf("%s%zu,%zu", found++ ? ", " : name, i % width, i / width);
        show_text(show, value[i], text, sizeof text);
        if (show->id == SHOW_CLASS && value != showing->difference.value)
            printf(" %s", text);
    }
    if (found)
        puts(found == PLACES_MOST ? ", ..." : "");
}

/* Counts the pixels above and below 0. */
static void count_sides(const struct showing *showing, size_t *more, size_t *less)
{
    *more = *less = 0;
    for (size_t i = 0; i < showing->pixels; i++) {
        *more += showing->difference.value[i] > 0.0;
        *less += showing->difference.value[i] < 0.0;
    }
}

static void print_difference(const struct showing *showing)
{
    const struct show *show = showing->show;
    const struct show_layer *difference = &showing->difference;
    const char *first = showing->layer[0].name, *second = showing->layer[1].name;
    size_t more, less;
    count_sides(showing, &more, &less);
    if (show->names) {
        printf("%s and %s: different in %zu of %zu pixels\n", second, first, more, showing->pixels);
        print_places(showing, difference->value, 0.0, "pixels ");
        return;
    }
    char name[64];
    snprintf(name, sizeof name, "%s - %s", second, first);
    print_amounts(show, show->planes == 3 ? "degrees between" : name, difference, showing);
    if (show->planes == 1)
        printf("%s: more in %s, less in %zu\n", second, COUNTED(more, "pixel"), less);
    if (showing->alone)
        printf("only one of them has a value in %s\n", COUNTED(showing->alone, "pixel"));
}

void showing_print(const struct showing *showing, const struct image *image)
{
    const struct show *show = showing->show;
    printf("%s: %s\n", showing->settings->scene, show->summary);
    if (show->id == SHOW_CLASS)
        print_verdicts(showing);
    else if (!show->names && (show->planes == 1 || showing->layer_count == 2))
        printf("%-20s %12s %10s %10s %10s %10s %10s\n", show->name, "sum", "least", "mean",
               "median", "99 %", "most");
    for (size_t l = 0; l < showing->layer_count && show->id == SHOW_CLASS; l++) {
        char name[64];
        snprintf(name, sizeof name, "%s: pixels ", showing->layer[l].name);
        print_places(showing, showing->layer[l].value, (double)VERDICT_RIGHT, name);
    }
    for (size_t l = 0; l < showing->layer_count && !show->names && show->planes == 1; l++)
        print_amounts(show, showing->layer[l].name, &showing->layer[l], showing);
    if (showing->layer_count == 2)
        print_difference(showing);
    for (size_t l = 0; l < showing->layer_count && show->from == SHOW_FROM_WALK; l++)
        printf("%s: engine %s counted %s, %s for these rays%s\n", showing->layer[l].name,
               showing->engine->name, COUNTED(showing->layer[l].counts.boxes, "box"),
               COUNTED(showing->layer[l].counts.tris, "triangle"),
               show->id == SHOW_BOXES || show->id == SHOW_TRIANGLES ? ": the sum of the pixels"
                                                                    : "");
    if (show->from == SHOW_FROM_JUDGE && !showing->judged)
        puts("a member as published takes part: what is wrong is counted, and no failure");
    printf("%s: %u x %u\n", showing->settings->out, image->width, image->height);
}

/* Prints "f32" or, for a normal, "f32_x,f32_y,f32_z". */
static void csv_names(FILE *stream, const struct show *show, const char *name)
{
    if (show->planes == 1)
        fprintf(stream, ",%s", name);
    else
        fprintf(stream, ",%s_x,%s_y,%s_z", name, name, name);
}

static void csv_values(FILE *stream, const struct show *show, const double *value)
{
    char text[48];
    for (uint32_t k = 0; k < show->planes; k++) {
        show_text(show, value[k], text, sizeof text);
        fprintf(stream, ",%s", isnan(value[k]) ? "" : text);
    }
}

enum status showing_csv(const struct showing *showing, struct reason *reason)
{
    struct file_out out = {.stream = NULL};
    const struct show *show = showing->show;
    const double *difference = showing->difference.value;
    enum status status = options_out(showing->csv, &out, reason);
    if (status)
        return status;
    fputs("x,y", out.stream);
    for (size_t l = 0; l < showing->layer_count; l++)
        csv_names(out.stream, show, showing->layer[l].name);
    fputs(difference ? ",difference\n" : "\n", out.stream);
    for (size_t i = 0; i < showing->pixels; i++) {
        fprintf(out.stream, "%zu,%zu", i % showing->settings->width, i / showing->settings->width);
        for (size_t l = 0; l < showing->layer_count; l++)
            csv_values(out.stream, show, showing->layer[l].value + show->planes * i);
        if (difference && isnan(difference[i]))
            fputs(",", out.stream);
        else if (difference)
            fprintf(out.stream, ",%.9g", difference[i]);
        fputs("\n", out.stream);
    }
    status = file_out_commit(&out, reason);
    file_out_discard(&out);
    return status;
}

static json_t *amounts_json(const struct show_layer *layer)
{
    return json_record("pixels=%zu sum=%g least=%g mean=%g median=%g p99=%g most=%g",
                       layer->sum.pixels, layer->sum.sum, layer->sum.least, layer->sum.mean,
                       layer->quantiles.p50, layer->quantiles.p99, layer->sum.most);
}

static json_t *layer_json(const struct showing *showing, const struct show_layer *layer)
{
    const struct show *show = showing->show;
    json_t *out =
        json_record("%s=%s", showing->engine->needs_packed ? "layout" : "engine", layer->name);
    if (show->from == SHOW_FROM_WALK)
        json_add(out, "counted=%p",
                 json_record("boxes=%zu triangles=%zu", layer->counts.boxes, layer->counts.tris));
    if (!show->names && show->planes == 1)
        json_add(out, "values=%p", amounts_json(layer));
    if (show->id != SHOW_CLASS)
        return out;
    json_add(out, "verdicts=%p", json_verdicts(layer->verdict));
    return out;
}

static json_t *difference_json(const struct showing *showing)
{
    size_t more, less;
    count_sides(showing, &more, &less);
    json_t *out = json_record("only_one=%zu", showing->alone);
    if (showing->show->names) {
        json_add(out, "different=%zu", more);
        return out;
    }
    json_add(out, "more=%zu less=%zu values=%p", more, less, amounts_json(&showing->difference));
    return out;
}

enum status showing_json(const struct showing *showing, const char *path, struct reason *reason)
{
    const struct render_settings *settings = showing->settings;
    json_t *layers = json_array();
    for (size_t l = 0; l < showing->layer_count; l++)
        json_array_append_new(layers, layer_json(showing, &showing->layer[l]));
    json_t *root =
        json_record("show=%s scene=%s engine=%s width=%u height=%u box=%s tri=%s builder=%s "
                    "picture=%s layers=%p",
                    showing->show->name, settings->scene, showing->engine->name, settings->width,
                    settings->height, settings->box->name, settings->tri->name,
                    settings->bvh ? "file" : settings->builder->name, settings->out, layers);
    if (root && showing->layer_count == 2)
        json_add(root, "difference=%p", difference_json(showing));
    return json_write(path, root, 9, reason);
}
