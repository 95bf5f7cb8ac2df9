/* Progress of a campaign: on a terminal a screen (cmd_fuzz_screen.c), else a line every ten
 * seconds. */
#include "cmd/fuzz/cmd_fuzz.h"

#include "fuzz/play/coverage.h"

#include <stdio.h>

#define LINE_NS  10000000000u
#define STATS_NS 3000000000u

static double per_second(uint64_t count, uint64_t ns)
{
    return ns ? (double)count / ((double)ns * 1e-9) : 0;
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
            coverage_count(view->coverage), coverage_reachable(view->options->rules.gen.worlds),
            view->restarts, left);
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
    if (c->terminal) {
        fuzz_screen_tick(c, view);
        return;
    }
    if (c->shown_ns == 0)
        c->shown_ns = now;
    if (now - c->shown_ns < LINE_NS)
        return;
    c->shown_ns = now;
    say(view);
}

void fuzz_show_end(struct fuzz_command *c)
{
    fuzz_screen_end(&c->screen);
}
