/* raydiff doctor: reports what can run here, and why the rest cannot. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/doctor/cmd_doctor.h"

#include "gpu/vk/vk_driver.h"
#include "gpu/trace/vulkan_options.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"

#include <float.h>
#include <fenv.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* __VERSION__ of clang begins with its name, that of gcc does not have it. */
#ifdef __clang__
#define COMPILER __VERSION__
#else
#define COMPILER "gcc " __VERSION__
#endif

/* Prints each line indented. */
static void print_lines(char *text)
{
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        screen_line(8, "    %s\n", line);
}

static void ask_engine(const struct engine *engine, const struct engine_options *options,
                       struct doctor_engine *out)
{
    void *self = NULL;
    out->engine = engine;
    out->status = engine_open(engine, options, &self, &out->reason);
    engine_describe(engine, options, out->text, sizeof out->text);
    if (!out->status)
        engine->close(self);
}

/* `e` is one of the engines from `first` on; what is the same as of one before is not repeated. */
static void print_engine(const struct doctor_engine *first, const struct doctor_engine *e)
{
    const struct doctor_engine *same = first;
    char text[sizeof e->text];
    while (same < e && (same->status || e->status || strcmp(same->text, e->text) != 0))
        same++;
    memcpy(text, e->text, sizeof text);
    printf("%-14s %s\n", e->engine->name, e->status ? "SKIPPED" : "runs");
    if (same < e && strchr(e->text, '\n')) {
        printf("    as %s\n", same->engine->name);
        return;
    }
    if (e->status)
        screen_line(9, "    why: %s\n", e->reason.text);
    if (!e->status || !strstr(text, e->reason.text)) /* else the text repeats the reason */
        print_lines(text);
}

static void ask_driver(const char *name, const struct engine_options *options,
                       struct doctor_driver *out)
{
    struct engine_options asked = *options;
    struct driver driver;
    asked.driver = name;
    struct vk_options vk_options = vulkan_options(&asked);
    struct vk *vk;
    out->name = name;
    out->status = driver_find(name, &driver, &out->reason);
    if (!out->status)
        driver_version(&driver, out->version, sizeof out->version);
    if (!out->status)
        out->status = vk_open(&vk_options, &vk, &out->reason);
    if (out->status)
        return;
    out->status = card_make(vk, &out->card, &out->reason);
    (void)vk_close(vk, NULL);
}

/* Whether both names lead to the same driver, whose card says the same. */
static bool is_same(const struct doctor_driver *a, const struct doctor_driver *b)
{
    char text[2][4096];
    if (a->status || b->status || strcmp(a->version, b->version) != 0 ||
        strcmp(a->card.limits.device, b->card.limits.device) != 0 ||
        strcmp(a->card.limits.driver, b->card.limits.driver) != 0)
        return false;
    card_text(&a->card, text[0], sizeof text[0]);
    card_text(&b->card, text[1], sizeof text[1]);
    return strcmp(text[0], text[1]) == 0;
}

/* `d` is one of the drivers from `first` on; each card is printed once, whatever its names. */
static void print_driver(const struct doctor_driver *first, const struct doctor_driver *d)
{
    char text[4096];
    const struct doctor_driver *same = first;
    while (same < d && !is_same(same, d))
        same++;
    if (same < d) {
        printf("driver %-12s as %s\n", d->name, same->name);
        return;
    }
    if (d->status) {
        printf("driver %-12s SKIPPED\n", d->name);
        screen_line(9, "    why: %s\n", d->reason.text);
        return;
    }
    screen_line(20, "driver %-12s %s, %s\n", d->name, d->card.limits.device, d->card.limits.driver);
    if (d->version[0])
        screen_line(8, "    %s\n", d->version);
    card_text(&d->card, text, sizeof text);
    print_lines(text);
}

/* Checks that floats round to nearest, keep subnormals and have no excess precision, as the
 * reference needs. */
static int print_float_environment(void)
{
    volatile float least = FLT_MIN, half = 0.5f, one = 1.0f, tiny = 0x1p-24f;
    bool subnormals = least * half > 0.0f;
    bool nearest = fegetround() == FE_TONEAREST && one + tiny == one;
    screen_line(15, "float          %s: FLT_EVAL_METHOD %d, subnormals %s, rounding %s\n",
                subnormals && nearest && FLT_EVAL_METHOD == 0 ? "IEEE" : "NOT IEEE",
                FLT_EVAL_METHOD, subnormals ? "kept" : "flushed",
                nearest ? "to nearest" : "directed");
    return subnormals && nearest && FLT_EVAL_METHOD == 0 ? EXIT_AGREE : EXIT_INTERNAL;
}

struct arguments {
    struct engine_options engine;
    const char *json;
};

#define ROWS_OF struct arguments

static const struct option_row rows[] = {
    {"json", "FILE", "the same, written to a temporary name and renamed", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "doctor",
    .usage = "doctor [OPTIONS]",
    .about = "Prints for every engine whether it can run here, with versions, devices and limits, "
             "or why it is skipped; prints a card for every Vulkan driver (or the one of "
             "--driver): what its arithmetic, conversions and loops do, measured; and checks the "
             "float environment that the C reference relies on.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, engine)},
    .codes = "0 every engine of the processor runs and a Vulkan driver does (of --driver: that "
             "one), though others may be missing; 77 an engine of the processor, or every Vulkan "
             "driver, cannot run here; 4 the float environment is not IEEE",
    .example = "doctor --driver mesa25",
};

static int examine(const struct arguments *arguments, struct doctor *doctor)
{
    int code = print_float_environment();
    size_t drivers = 0, running = 0;
    for (size_t i = 0; engines[i] && i < DOCTOR_MOST; i++, doctor->engine_count++) {
        ask_engine(engines[i], &arguments->engine, &doctor->engine[i]);
        print_engine(doctor->engine, &doctor->engine[i]);
        running += doctor->engine[i].status == STATUS_OK;
        if (doctor->engine[i].status && !engines[i]->gpu)
            code = exit_worse(code, EXIT_SKIPPED);
    }
    const char *const asked[] = {arguments->engine.driver, NULL};
    const char *const *names = asked[0] ? asked : driver_names;
    for (size_t i = 0; names[i] && i < DOCTOR_MOST; i++, doctor->driver_count++) {
        ask_driver(names[i], &arguments->engine, &doctor->driver[i]);
        print_driver(doctor->driver, &doctor->driver[i]);
        drivers += doctor->driver[i].status == STATUS_OK;
    }
    screen_line(4, "conclusion: %zu of %zu engines run, %zu of %zu Vulkan drivers are here\n",
                running, doctor->engine_count, drivers, doctor->driver_count);
    return drivers > 0 ? code : exit_worse(code, EXIT_SKIPPED);
}

int cmd_doctor(int argc, char **argv)
{
    struct arguments arguments = {.engine = engine_options_default()};
    int first, code = options_read(&set, &arguments, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first < argc)
        return usage_error("doctor", "'%s' is not an option", argv[first]);
    printf("raydiff        %s, compiled by %s\n", RAYDIFF_VERSION, COMPILER);
    printf("processors     %ld\n", sysconf(_SC_NPROCESSORS_ONLN));
    struct doctor *doctor = alloc_zeroed(1, sizeof *doctor);
    struct reason reason = {""};
    if (!doctor) {
        fprintf(stderr, "raydiff doctor: no memory\n");
        return EXIT_INTERNAL;
    }
    code = examine(&arguments, doctor);
    enum status status =
        arguments.json ? doctor_write_json(arguments.json, doctor, &reason) : STATUS_OK;
    free(doctor);
    return status ? exit_with_reason("doctor", status, &reason) : code;
}
