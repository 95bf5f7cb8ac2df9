/* How a campaign stands: on a terminal some lines that are drawn again each second, else a line
 * each ten seconds. */
#include "fuzz/cmd_fuzz.h"

#include "fuzz/coverage.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SCREEN_NS 1000000000u
#define LINE_NS   10000000000u
#define STATS_NS  3000000000u

static double per_second(uint64_t count, uint64_t ns)
{
    return ns ? (double)count / ((double)ns * 1e-9) : 0;
}

/* A line of the screen, cut to what every terminal has. */
PRINTF_LIKE(2, 3) static void row(struct fuzz_command *c, const char *format, ...)
{
    char text[80];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(stderr, "\033[K%s\n", text);
    c->lines++;
}

static const char *phase_text(const struct campaign_view *view)
{
    switch (view->phase) {
    case CAMPAIGN_STARTING:
        return "opening engines";
    case CAMPAIGN_PLAYING:
        return "playing";
    case CAMPAIGN_ENDING:
        return "ending";
    case CAMPAIGN_SHRINKING:
        return "shrinking";
    }
    return "";
}

static void left_text(const struct campaign_view *view, char text[40])
{
    const struct campaign_options *o = view->options;
    uint64_t s = view->ns / 1000000000u;
    text[0] = '\0';
    if (view->phase != CAMPAIGN_PLAYING)
        return;
    if (o->seconds > 0)
        snprintf(text, 40, "%llu s left",
                 (unsigned long long)(s < o->seconds ? o->seconds - s : 0));
    else if (o->trials > 0)
        snprintf(text, 40, "of %llu", (unsigned long long)(o->trials / o->shards));
}

/* Contestants by their share of the engines' and the harness's time. */
static void show_shares(struct fuzz_command *c, const struct campaign_view *view)
{
    const struct fuzz_field *field = &view->options->rules.field;
    char text[80] = "";
    double all =
        (double)(view->time.generate + view->time.build + view->time.truth + view->time.judge);
    size_t used = 0;
    for (size_t i = 0; i < field->count; i++)
        all += (double)view->time.engine[i];
    for (size_t i = 0; i < field->count && used < sizeof text && all > 0; i++) {
        const struct layout *layout = field->who[i].layout;
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%.12s%s%s %.0f%%", i ? ", " : "",
                             field->who[i].engine->name, layout ? "." : "",
                             layout ? layout->name : "", 100 * (double)view->time.engine[i] / all);
    }
    row(c, "time      %s, harness %.0f%%", text, 100 * campaign_harness_share(view, NULL));
}

static void show_verdicts(struct fuzz_command *c, const struct campaign_view *view)
{
    char text[80] = "";
    size_t used = 0;
    for (size_t v = 0; v < VERDICT_COUNT && used < sizeof text; v++)
        if (view->count[v] > 0)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %.3g", used ? ", " : "",
                                     verdict_name((enum verdict)v), (double)view->count[v]);
    row(c, "verdicts  %s", text);
}

static uint64_t total_of(const struct campaign_view *view)
{
    uint64_t total = 0;
    for (size_t i = 0; i < findings_count(view->findings); i++)
        total += findings_entry(view->findings, i)->count;
    return total;
}

static void draw(struct fuzz_command *c, const struct campaign_view *view)
{
    char left[40];
    left_text(view, left);
    if (c->lines > 0)
        fprintf(stderr, "\033[%dA", c->lines);
    c->lines = 0;
    row(c, "raydiff fuzz: %s, seed %llu, %llu s  %s", phase_text(view), (unsigned long long)c->seed,
        (unsigned long long)(view->ns / 1000000000u), left);
    row(c, "trials    %llu (%.0f/s), judged rays %.3g (%.3g/s)", (unsigned long long)view->trials,
        per_second(view->trials, view->play_ns), (double)view->judged,
        per_second(view->judged, view->play_ns));
    row(c, "findings  %zu distinct, %zu new, %llu in all; %zu to be shrunk",
        findings_count(view->findings), campaign_news(view, NULL),
        (unsigned long long)total_of(view), view->to_shrink);
    row(c, "coverage  %u of %u, %zu trials kept, %llu mutants; corpus %s",
        (unsigned)coverage_count(view->coverage), (unsigned)coverage_known(), view->kept,
        (unsigned long long)view->mutants, view->options->rules.corpus_count ? "played" : "none");
    show_shares(c, view);
    show_verdicts(c, view);
    row(c, "workers   %u, %u restarts%s%s", view->workers, view->restarts,
        view->said[0] ? ": " : "", view->said);
    fflush(stderr);
}

static void say(const struct campaign_view *view)
{
    char left[40];
    left_text(view, left);
    fprintf(stderr,
            "raydiff fuzz: %llu s, %s: %llu trials (%.0f/s), %.3g judged rays (%.3g/s), "
            "findings %zu (%zu new), coverage %u of %u, restarts %u  %s\n",
            (unsigned long long)(view->ns / 1000000000u), phase_text(view),
            (unsigned long long)view->trials, per_second(view->trials, view->play_ns),
            (double)view->judged, per_second(view->judged, view->play_ns),
            findings_count(view->findings), campaign_news(view, NULL),
            (unsigned)coverage_count(view->coverage), (unsigned)coverage_known(), view->restarts,
            left);
    fflush(stderr);
}

void fuzz_show(void *user, const struct campaign_view *view)
{
    struct fuzz_command *c = user;
    uint64_t now = time_ns();
    if (now - c->stats_ns >= STATS_NS) {
        c->stats_ns = now;
        if (!c->failed_status)
            c->failed_status = fuzz_stats(c, view, &c->failed);
    }
    if (c->shown_ns == 0)
        c->shown_ns = c->terminal ? 1 : now;
    if (now - c->shown_ns < (c->terminal ? SCREEN_NS : LINE_NS))
        return;
    c->shown_ns = now;
    if (c->terminal)
        draw(c, view);
    else
        say(view);
}

void fuzz_show_end(struct fuzz_command *c)
{
    if (c->lines > 0)
        fprintf(stderr, "\033[%dA\033[J", c->lines);
    c->lines = 0;
    fflush(stderr);
}
