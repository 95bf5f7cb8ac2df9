/* raydiff render --window: shows the picture in a window; RTRS's keys turn it. */
#include "bench/frames/pacing.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_process.h"
#include "cmd/render/cmd_render.h"
#include "scenes/render/turning.h"
#include "scenes/render/window.h"

#include <math.h>

/* Longest time between two checks of the window. */
#define LOOK_MS 250u

#define ROWS_OF struct render_settings

const struct option_row render_window_rows[] = {
    {"seconds", "S", "a window ends by itself after that time",
     OF_REAL(window.seconds, ABOVE_0, INFINITY), .shown = "never"},
    {"pictures", "N", "it ends after that many; one is drawn when something changed",
     OF_COUNT(window.pictures, 1, UINT32_MAX), .shown = "never"},
    {"log", "FILE", "a line per picture: camera angle, size, ms", OF_OUTPUT(window.log)},
    {"fps", "N", "pictures a second of a window", OF_REAL(window.fps, ABOVE_0, INFINITY),
     .value = "60"},
    {0},
};

/* State of the window and its picture. */
struct window_showing {
    const struct render_settings *settings;
    struct render_stage stage;
    struct renderer *renderer;
    struct window *window; /* NULL: no display */
    struct image image;
    struct pacing pacing;
    double angle;                    /* of the camera, radians */
    double turn_ms;                  /* time that keys were held, not applied yet */
    uint64_t start_ns, pictures, ns; /* ns: total over all pictures */
    struct file_out log;
};

/* Signals close the window, as its button does. SDL handles signals too, but only between
 * pictures. */
static volatile sig_atomic_t caught;

/* Draws the picture with the current view and size. */
static enum status draw(struct window_showing *s, struct reason *reason)
{
    struct view view = render_stage_view(&s->stage, s->angle);
    struct frame frame = {.pixel = s->image.pixel};
    uint64_t start = time_ns();
    enum status status = renderer_frame(s->renderer, &view, &frame, NULL, reason);
    uint64_t ns = time_ns() - start;
    s->ns += ns;
    s->pictures++;
    if (s->log.stream)
        fprintf(s->log.stream, "picture %llu angle %.17g size %ux%u ms %.3f\n",
                (unsigned long long)s->pictures, s->angle, s->image.width, s->image.height,
                1e-6 * (double)ns);
    if (status || !s->window)
        return status;
    char title[200];
    const struct packed *packed = s->stage.job.job.packed;
    snprintf(title, sizeof title, "raydiff: %.80s, %.40s%s%s, %.1f ms", s->settings->scene,
             s->settings->engine->name, packed ? " " : "", packed ? packed->layout->name : "",
             1e-6 * (double)ns);
    window_title(s->window, title);
    return window_show(s->window, &s->image, reason);
}

/* Changes the picture's size. */
static enum status resize(struct window_showing *s, uint32_t width, uint32_t height,
                          struct reason *reason)
{
    image_free(&s->image);
    s->stage.job.width = width;
    s->stage.job.height = height;
    enum status status = image_make(width, height, &s->image, reason);
    if (!status)
        status = renderer_prepare(s->renderer, &s->stage.job, reason);
    pacing_touch(&s->pacing);
    return status;
}

/* Turns the camera by the keys held since the last tick. A stall counts as one frame. */
static void turn(struct window_showing *s, double moved_ms)
{
    if (moved_ms <= 0 || s->turn_ms == 0)
        return;
    double most = fmax(moved_ms, TURNING_TAP_MS), by = fmax(-most, fmin(most, s->turn_ms));
    s->turn_ms = 0;
    if (!s->stage.camera.orbit)
        return;
    s->angle += TURNING_SPEED * by;
    pacing_touch(&s->pacing);
}

static bool is_over(const struct window_showing *s)
{
    double seconds = 1e-9 * (double)(time_ns() - s->start_ns);
    return (s->settings->window.pictures && s->pictures >= s->settings->window.pictures) ||
           (s->settings->window.seconds > 0 && seconds >= (double)s->settings->window.seconds);
}

/* How long to wait for an event, in milliseconds. */
static unsigned wait_ms(const struct window_showing *s, bool turning)
{
    if (!turning && s->turn_ms == 0 && !s->pacing.stale)
        return LOOK_MS;
    uint64_t ms = (pacing_idle_ns(&s->pacing, time_ns()) + 999999) / 1000000;
    return ms < LOOK_MS ? (unsigned)ms : LOOK_MS;
}

static enum status loop(struct window_showing *s, struct reason *reason)
{
    struct window_news news = {0};
    enum status status = STATUS_OK;
    while (!status && !is_over(s)) {
        window_wait(s->window, wait_ms(s, news.turning), &news);
        if (news.quit || caught)
            return STATUS_OK;
        s->turn_ms += news.turn_ms;
        turn(s, pacing_tick(&s->pacing, time_ns()));
        bool resized = news.width != s->image.width || news.height != s->image.height;
        if (s->settings->resizable && resized && news.width > 0 && news.height > 0)
            status = resize(s, news.width, news.height, reason);
        else if (news.redraw && !s->pacing.stale)
            status = window_show(s->window, &s->image, reason);
        if (!status && pacing_begin(&s->pacing)) {
            status = draw(s, reason);
            pacing_end(&s->pacing);
        }
    }
    return status;
}

/* Opens everything except the window. */
static enum status open_all(struct window_showing *s, struct reason *reason)
{
    struct render_settings turning = *s->settings;
    const struct render_settings *settings = &turning;
    turning.framing = FRAMING_TURN;
    enum status status = STATUS_OK;
    if (option_was_given("out"))
        status = output_try(settings->out, reason);
    if (!status && s->settings->window.log)
        status = file_out_open(s->settings->window.log, &s->log, reason);
    if (!status)
        status = render_stage_open("render", settings, &s->stage, reason);
    if (!status)
        status = renderer_open(settings->engine, &settings->engine_options, settings->waves,
                               &s->renderer, reason);
    if (!status)
        status = renderer_prepare(s->renderer, &s->stage.job, reason);
    if (!status)
        status = image_make(s->stage.job.width, s->stage.job.height, &s->image, reason);
    return status;
}

/* Opens the window. Without a display, --out still gets its picture. */
static enum status open_window(struct window_showing *s, struct reason *reason)
{
    struct reason why;
    process_signals_caught(&caught);
    enum status status = window_open("raydiff", s->image.width, s->image.height, &s->window, &why);
    if (status == STATUS_UNSUPPORTED && option_was_given("out")) {
        fprintf(stderr, "raydiff render: %s: %s is drawn without one\n", why.text,
                s->settings->out);
        return STATUS_OK;
    }
    if (status)
        return fail(reason, status, "%s%s", why.text,
                    status == STATUS_UNSUPPORTED ? "; --out FILE.png draws without one" : "");
    return STATUS_OK;
}

static enum status close_files(struct window_showing *s, struct reason *reason)
{
    enum status status = STATUS_OK;
    if (option_was_given("out") && s->pictures > 0)
        status = image_write(s->settings->out, &s->image, reason);
    if (!status && s->settings->window.log)
        status = file_out_commit(&s->log, reason);
    return status;
}

static int run(const struct render_settings *settings, const char *value)
{
    (void)value;
    struct window_showing s = {.settings = settings};
    struct reason reason = {""};
    enum status status = open_all(&s, &reason);
    if (!status)
        status = open_window(&s, &reason);
    s.start_ns = time_ns();
    s.pacing = pacing_make((double)settings->window.fps, s.start_ns);
    if (!status)
        status = s.window ? loop(&s, &reason) : draw(&s, &reason);
    process_signal_taken();
    if (!status)
        status = close_files(&s, &reason);
    if (!status)
        printf("%llu picture%s, %.1f ms each, camera turned by %.1f degrees\n",
               (unsigned long long)s.pictures, plural(s.pictures),
               s.pictures ? 1e-6 * (double)s.ns / (double)s.pictures : 0.0,
               s.angle * (180 / acos(-1.0)));
    window_close(s.window);
    file_out_discard(&s.log);
    image_free(&s.image);
    renderer_close(s.renderer);
    render_stage_close(&s.stage);
    return exit_with_reason("render", status, &reason);
}

extern const struct render_mode render_mode_window;
const struct render_mode render_mode_window = {
    .name = "window",
    .row = render_window_rows,
    .never = "frames angle paths json",
    .run = run,
};
