/* The files of a measured run, wherever it is stopped: every member by value, for any number of
 * contestants, notes, turns and frames dropped, and for every base of ratios. */
#define _GNU_SOURCE
#include "bench/frames/frames_files.h"
#include "ref/files/file.h"
#include "tests/support/root.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <jansson.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 7u

/* A run, and when it is stopped. */
struct stopped_run {
    size_t contestants, notes, base;
    uint32_t turns, warm_up;
    unsigned stop_call; /* 0: never */
    unsigned calls;
    volatile sig_atomic_t stop;
};

/* Every time of the run is another one, and all are sums of powers of two. */
static double time_of(size_t contestant, int64_t frame)
{
    return 1.0 + (double)(contestant * 16) + (double)((frame * 5) % 8) / 8;
}

/* The frame that is drawn: contestants take turns, each once in a frame. */
static int64_t frame_now(const struct stopped_run *p)
{
    return (int64_t)((p->calls - 1) / p->contestants) - (int64_t)p->warm_up;
}

static enum status draw(void *user, size_t contestant, double angle, struct frames_sample *out,
                        struct reason *reason)
{
    struct stopped_run *p = user;
    (void)reason;
    (void)angle;
    p->calls++;
    p->stop = p->stop || p->calls == p->stop_call;
    *out = (struct frames_sample){.ms = time_of(contestant, frame_now(p)),
                                  .device_clock = contestant % 2 == 0};
    return STATUS_OK;
}

static json_t *read_json(const char *base)
{
    char path[300];
    json_error_t why;
    snprintf(path, sizeof path, "%s.json", base);
    json_t *json = json_load_file(path, 0, &why);
    if (!json)
        fail_msg("%s: %s", path, why.text);
    return json;
}

static void number_is(const json_t *object, const char *name, double want)
{
    const json_t *value = json_object_get(object, name);
    if (!json_is_number(value) || fabs(json_number_value(value) - want) > 1e-8 * fabs(want))
        fail_msg("%s: %g, not %g", name, json_number_value(value), want);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Least, most, mean and median of the values, which it sorts. */
static void stats_are(const json_t *object, const char *const name[4], double *value, size_t count)
{
    double sum = 0;
    qsort(value, count, sizeof *value, by_size);
    for (size_t i = 0; i < count; i++)
        sum += value[i];
    if (name[0])
        number_is(object, name[0], count ? sum / (double)count : 0);
    number_is(object, name[1], count ? value[0] : 0);
    number_is(object, name[2], count ? value[count - 1] : 0);
    number_is(object, name[3], count ? 0.5 * (value[(count - 1) / 2] + value[count / 2]) : 0);
}

static void handler_is(const json_t *json, const struct stopped_run *p, size_t i, uint32_t done)
{
    static const char *const times[] = {"average_ms", "min_ms", "max_ms", "median_ms"};
    static const char *const ratios[] = {NULL, "min", "max", "median"};
    const json_t *samples = json_object_get(json, "samples_ms");
    const json_t *ratio = json_object_get(json, "ratio");
    double value[FRAMES], of_base[FRAMES];
    char name[20];
    snprintf(name, sizeof name, "handler %zu", i);
    assert_string_equal(json_string_value(json_object_get(json, "handler")), name);
    number_is(json, "bytes", 100.0 * (double)i);
    if (p->calls > p->contestants) /* each was drawn */
        assert_string_equal(json_string_value(json_object_get(json, "clock")),
                            i % 4 == 0   ? "GPU timestamps"
                            : i % 4 == 1 ? "host clock"
                            : i % 4 == 2 ? "GPU timestamps, rays alone"
                                         : "host clock, rays alone");
    assert_int_equal(json_array_size(samples), done);
    for (uint32_t k = 0; k < done; k++) {
        value[k] = time_of(i, k);
        of_base[k] = value[k] / time_of(p->base < p->contestants ? p->base : 0, k);
        assert_true(json_number_value(json_array_get(samples, k)) == value[k]);
    }
    stats_are(json, times, value, done);
    assert_int_equal(ratio != NULL, done > 0 && p->base < p->contestants);
    if (!ratio)
        return;
    snprintf(name, sizeof name, "handler %zu", p->base);
    assert_string_equal(json_string_value(json_object_get(ratio, "to")), name);
    stats_are(ratio, ratios, of_base, done);
}

static void json_is(const json_t *json, const struct stopped_run *p, uint32_t dropped,
                    uint32_t done)
{
    const json_t *handlers = json_object_get(json, "handlers");
    const json_t *notes = json_object_get(json, "notes");
    assert_string_equal(json_string_value(json_object_get(json, "title")), "a title");
    number_is(json, "frames_asked", FRAMES);
    number_is(json, "frames", done);
    number_is(json, "turns", p->turns);
    number_is(json, "warm_up_dropped", dropped);
    assert_int_equal(json_is_true(json_object_get(json, "stopped")), done < FRAMES);
    assert_int_equal(json_object_size(notes), p->notes);
    for (size_t i = 0; i < p->notes; i++) {
        char name[32], value[32];
        snprintf(name, sizeof name, "note %zu", i);
        snprintf(value, sizeof value, "value %zu", i);
        assert_string_equal(json_string_value(json_object_get(notes, name)), value);
    }
    assert_int_equal(json_array_size(handlers), p->contestants);
    for (size_t i = 0; i < p->contestants; i++)
        handler_is(json_array_get(handlers, i), p, i, done);
}

/* A line for each handler and frame, with the angle of the frame. */
static void csv_is(const char *base, const struct stopped_run *p, uint32_t done)
{
    char path[300], line[200], want[200], *text;
    size_t size, at = 0;
    struct reason reason;
    snprintf(path, sizeof path, "%s.csv", base);
    if (file_read(path, &text, &size, &reason))
        fail_msg("%s", reason.text);
    at = strcspn(text, "\n") + 1;
    for (size_t i = 0; i < p->contestants; i++)
        for (uint32_t k = 0; k < done; k++) {
            snprintf(line, sizeof line, "%.*s", (int)strcspn(text + at, "\n"), text + at);
            at += strcspn(text + at, "\n") + 1;
            int used = snprintf(want, sizeof want, "handler %zu,%zu,", i, 100 * i);
            assert_int_equal(strncmp(line, want, (size_t)used), 0);
            const char *behind = strstr(line, i % 2 ? "host clock" : "GPU timestamps");
            assert_non_null(behind);
            behind += strcspn(behind, "0123456789");
            snprintf(want, sizeof want, "%u,%.9g,%.9g,", k, 360.0 * p->turns * k / FRAMES,
                     time_of(i, k));
            if (strncmp(behind, want, strlen(want)) != 0)
                fail_msg("%s, not %s", line, want);
        }
    assert_int_equal(at, size);
    free(text);
}

/* A run is of whole frames: one that is stopped within a frame is as if before it. */
static void the_files_are_those_of_the_run(struct stopped_run *p, const char *base)
{
    static char note[FRAMES_NOTES][2][20];
    struct frames_settings settings = {FRAMES, p->turns, p->warm_up, &p->stop};
    struct frames_about about = {.title = "a title", .base = p->base};
    struct frames_run run;
    char name[20];
    assert_int_equal(frames_make(&settings, &run, NULL), STATUS_OK);
    for (size_t i = 0; i < p->notes; i++) {
        snprintf(note[i][0], sizeof note[i][0], "note %zu", i);
        snprintf(note[i][1], sizeof note[i][1], "value %zu", i);
        about.note[i].name = note[i][0];
        about.note[i].value = note[i][1];
    }
    for (size_t i = 0; i < p->contestants; i++) {
        snprintf(name, sizeof name, "handler %zu", i);
        assert_int_equal(frames_enter(&run, name, 100 * i, NULL), STATUS_OK);
        run.contestant[i].rays_alone = i % 4 >= 2;
    }
    assert_int_equal(frames_measure(&run, draw, NULL, p, NULL), STATUS_OK);
    unsigned most = (unsigned)p->contestants * (p->warm_up + FRAMES);
    unsigned whole = (p->stop_call ? p->stop_call : most) / (unsigned)p->contestants;
    uint32_t dropped = whole < p->warm_up ? whole : p->warm_up, done = whole - dropped;
    assert_int_equal(frames_write(&run, &about, base, NULL), STATUS_OK);
    frames_free(&run);
    json_t *json = read_json(base);
    json_is(json, p, dropped, done);
    json_decref(json);
    csv_is(base, p, done);
}

static void every_run_has_its_files(void **state)
{
    (void)state;
    char base[256];
    unsigned runs = 0;
    snprintf(base, sizeof base, "%s/run", root);
    for (size_t contestants = 1; contestants < 5; contestants++)
        for (uint32_t warm_up = 0; warm_up < 3; warm_up++)
            for (unsigned stop = 0; stop < contestants * (warm_up + FRAMES); stop += 1 + stop) {
                struct stopped_run p = {.contestants = contestants,
                                        .notes = runs % (FRAMES_NOTES + 1),
                                        .base = runs % 5 == 4 ? SIZE_MAX : runs % contestants,
                                        .turns = runs % 4,
                                        .warm_up = warm_up,
                                        .stop_call = stop};
                the_files_are_those_of_the_run(&p, base);
                runs++;
            }
    assert_true(runs > 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_run_has_its_files)};
    return cmocka_run_group_tests_name("frames_files", tests, make_root, remove_root);
}
