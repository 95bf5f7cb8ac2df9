#include "bench/frames/frames_files.h"

#include "bench/chart/csv.h"
#include "ref/files/file.h"
#include "ref/base/json_record.h"

#include <jansson.h>

#include <stdlib.h>

const char *frames_clock(const struct frames_contestant *contestant)
{
    if (contestant->rays_alone)
        return contestant->device_clock ? "GPU timestamps, rays alone" : "host clock, rays alone";
    return contestant->device_clock ? "GPU timestamps" : "host clock";
}

static void put_csv(FILE *stream, const struct frames_run *run)
{
    fputs("handler,bytes,clock,frame,angle_deg,ms,average_ms,min_ms,max_ms,median_ms\n", stream);
    for (size_t i = 0; i < run->count; i++) {
        const struct frames_contestant *c = &run->contestant[i];
        struct frames_stats stats = frames_stats_of(run, i);
        for (uint32_t frame = 0; frame < run->done; frame++) {
            csv_text(stream, c->handler);
            fprintf(stream, ",%llu,", (unsigned long long)c->bytes);
            csv_text(stream, frames_clock(c));
            fprintf(stream, ",%u,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", frame,
                    frames_angle(&run->settings, frame) * (180.0 / 3.14159265358979323846),
                    c->ms[frame], stats.average, stats.least, stats.most, stats.median);
        }
    }
}

static json_t *handler_json(const struct frames_run *run, size_t i, size_t base)
{
    const struct frames_contestant *c = &run->contestant[i];
    struct frames_stats stats = frames_stats_of(run, i);
    json_t *samples = json_array();
    for (uint32_t frame = 0; frame < run->done; frame++)
        json_array_append_new(samples, json_real(c->ms[frame]));
    json_t *out = json_record("handler=%s bytes=%zu clock=%s average_ms=%g min_ms=%g max_ms=%g "
                              "median_ms=%g samples_ms=%p",
                              c->handler, c->bytes, frames_clock(c), stats.average, stats.least,
                              stats.most, stats.median, samples);
    if (out && base < run->count && run->done > 0) {
        struct spread ratio = frames_ratio(run, i, base);
        json_add(out, "ratio=%p",
                 json_record("to=%s median=%g min=%g max=%g", run->contestant[base].handler,
                             ratio.median, ratio.least, ratio.most));
    }
    return out;
}

static json_t *run_json(const struct frames_run *run, const struct frames_about *about)
{
    json_t *notes = json_object(), *handlers = json_array();
    for (size_t i = 0; i < FRAMES_NOTES && about->note[i].name; i++)
        json_add(notes, "%s=%s", about->note[i].name, about->note[i].value);
    for (size_t i = 0; i < run->count; i++)
        json_array_append_new(handlers, handler_json(run, i, about->base));
    return json_record("raydiff=%s title=%s notes=%p frames_asked=%u frames=%u turns=%u "
                       "warm_up_dropped=%u stopped=%i handlers=%p",
                       RAYDIFF_VERSION, about->title, notes, run->settings.frames, run->done,
                       run->settings.turns, run->dropped, run->stopped, handlers);
}

static enum status write_csv(const struct frames_run *run, const char *path, struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    put_csv(out.stream, run);
    return file_out_commit(&out, reason);
}

static enum status write_json(const struct frames_run *run, const struct frames_about *about,
                              const char *path, struct reason *reason)
{
    struct file_out out;
    json_t *root = run_json(run, about);
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(root);
    if (!text)
        return fail(reason, STATUS_MEMORY, "%s: no memory for the JSON", file_label(path));
    enum status status = file_out_open(path, &out, reason);
    if (status == STATUS_OK) {
        fprintf(out.stream, "%s\n", text);
        status = file_out_commit(&out, reason);
    }
    free(text);
    return status;
}

struct chart_series frames_series(const struct frames_run *run, size_t contestant)
{
    const struct frames_contestant *c = &run->contestant[contestant];
    struct frames_stats stats = frames_stats_of(run, contestant);
    return (struct chart_series){.name = c->handler,
                                 .bytes = c->bytes,
                                 .average = stats.average,
                                 .least = stats.least,
                                 .most = stats.most,
                                 .value = c->ms,
                                 .count = run->done};
}

struct chart frames_chart(const struct frames_run *run, const char *title,
                          const struct chart_series *series, size_t count)
{
    return (struct chart){.title = title,
                          .x_label = "Frame",
                          .y_label = CHART_DURATION,
                          .unit = "ms",
                          .series = series,
                          .series_count = count,
                          .x_count = run->settings.frames};
}

static enum status write_chart(const struct frames_run *run, const struct frames_about *about,
                               const char *svg, const char *png, struct reason *reason)
{
    struct chart_series series[FRAMES_CONTESTANTS];
    for (size_t i = 0; i < run->count; i++)
        series[i] = frames_series(run, i);
    const struct chart chart = frames_chart(run, about->title, series, run->count);
    return chart_write(&chart, svg, png, reason);
}

enum status frames_file(const char *base, size_t file, char path[FRAMES_PATH_MOST],
                        struct reason *reason)
{
    static const char *const end[FRAMES_FILES] = {"csv", "json", "svg", "png"};
    if (snprintf(path, FRAMES_PATH_MOST, "%s.%s", base, end[file]) >= FRAMES_PATH_MOST)
        return fail(reason, STATUS_INPUT, "%s: too long a name", file_label(base));
    return STATUS_OK;
}

enum status frames_write(const struct frames_run *run, const struct frames_about *about,
                         const char *base, struct reason *reason)
{
    char path[FRAMES_FILES][FRAMES_PATH_MOST];
    enum status status = STATUS_OK;
    for (size_t i = 0; i < FRAMES_FILES && !status; i++)
        status = frames_file(base, i, path[i], reason);
    if (!status)
        status = write_csv(run, path[0], reason);
    if (!status)
        status = write_json(run, about, path[1], reason);
    return status ? status : write_chart(run, about, path[2], path[3], reason);
}
