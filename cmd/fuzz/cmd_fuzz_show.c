/* Progress of a campaign: on a terminal, lines that are redrawn each second; otherwise one line
 * every ten seconds. */
#include "cmd/fuzz/cmd_fuzz.h"

#include "fuzz/play/coverage.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* Columns of a line, including its end; longer lines are hard to read. A narrower terminal has
 * fewer. */
#define ROW_MOST 80

#define SCREEN_NS 1000000000u
#define LINE_NS   10000000000u
#define STATS_NS  3000000000u

static double per_second(uint64_t count, uint64_t ns)
{
    return ns ? (double)count / ((double)ns * 1e-9) : 0;
}

/* Columns of a line, including its end. */
static size_t room_of(void)
{
    struct winsize size;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_col > ROW_MOST)
        return ROW_MOST;
    return size.ws_col;
}

/* Prints a line cut to the screen's width: a wrapped line would not be overwritten completely. */
PRINTF_LIKE(2, 3) static void row(struct fuzz_command *c, const char *format, ...)
{
    char text[ROW_MOST];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text[room_of() - 1] = '\0';
    fprintf(stderr, "\033[K%s\n", text);
    c->lines++;
}

static const char *phase_text(const struct campaign_view *view)
{
    static const char *const text[] = {[CAMPAIGN_STARTING] = "opening engines",
                                       [CAMPAIGN_PLAYING] = "playing",
                                       [CAMPAIGN_ENDING] = "ending",
                                       [CAMPAIGN_SHRINKING] = "shrinking"};
    return text[view->phase];
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
        snprintf(text, 40, "of %llu generated ones", (unsigned long long)(o->trials / o->shards));
}

/* A list of items, printed on as many rows as needed. */
struct show_items {
    struct fuzz_command *command;
    const char *label;
    char text[ROW_MOST];
};

static void end_row(struct show_items *items)
{
    row(items->command, "%-9s %s", items->label, items->text);
    items->label = "";
    items->text[0] = '\0';
}

static void add_share(struct show_items *items, const char *name, double share)
{
    char one[ROW_MOST];
    size_t used = strlen(items->text), room = room_of();
    snprintf(one, sizeof one, "%s%.30s %.3g %%", used ? ", " : "", name, 100 * share);
    if (used > 0 && used + strlen(one) + 12 > room) {
        end_row(items);
        used = 0;
        memmove(one, one + 2, strlen(one) - 1); /* without the comma */
    }
    snprintf(items->text + used, sizeof items->text - used, "%s", one);
}

/* Prints the share of time of each engine, summed over its layouts, and of the harness. */
static void show_shares(struct fuzz_command *c, const struct campaign_view *view)
{
    const struct fuzz_field *field = &view->options->rules.field;
    struct show_items items = {.command = c, .label = "time"};
    double all = 0, harness = campaign_harness_share(view, NULL);
    for (size_t i = 0; i < field->count; i++)
        all += (double)view->time.engine[i];
    for (size_t i = 0; i < field->count && all > 0; i++) {
        double mine = 0;
        size_t first = 0;
        while (field->who[first].engine != field->who[i].engine)
            first++;
        for (size_t k = i; k < field->count && first == i; k++)
            if (field->who[k].engine == field->who[i].engine)
                mine += (double)view->time.engine[k];
        if (first == i)
            add_share(&items, field->who[i].engine->name, mine / all * (1 - harness));
    }
    add_share(&items, "harness", harness);
    end_row(&items);
}

static void show_verdicts(struct fuzz_command *c, const struct campaign_view *view)
{
    struct show_items items = {.command = c, .label = "verdicts"};
    uint64_t all = 0;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        all += view->count[v];
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        if (view->count[v] > 0)
            add_share(&items, verdict_name((enum verdict)v), (double)view->count[v] / (double)all);
    end_row(&items);
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
        fprintf(stderr, "\033[%dA\033[J", c->lines);
    c->lines = 0;
    row(c, "raydiff fuzz: %s, seed %llu, %llu s  %s", phase_text(view), (unsigned long long)c->seed,
        (unsigned long long)(view->ns / 1000000000u), left);
    row(c, "trials    %llu (%.0f/s), judged rays %.3g (%.3g/s)", (unsigned long long)view->trials,
        per_second(view->trials, view->play_ns), (double)view->judged,
        per_second(view->judged, view->play_ns));
    row(c, "findings  %zu distinct, %zu new, %llu in all", findings_count(view->findings),
        campaign_news(view, NULL), (unsigned long long)total_of(view));
    row(c, "coverage  %u of %u, %zu trials kept, %llu mutants; corpus %s",
        coverage_count(view->coverage), coverage_known(), view->kept,
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
            coverage_count(view->coverage), coverage_known(), view->restarts, left);
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
