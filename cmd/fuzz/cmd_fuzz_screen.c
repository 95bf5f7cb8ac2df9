/* What the screen of a campaign shows. */
#define _DEFAULT_SOURCE
#include "cmd/fuzz/cmd_fuzz_screen.h"

#include "cmd/fuzz/cmd_fuzz_report.h"
#include "fuzz/play/coverage.h"
#include "ref/base/command.h"

#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define DRAW_NS     1000000000u
#define ROW_MOST    160 /* columns of a line, its end included; longer ones are hard to read */
#define LISTED_MOST 12  /* findings of the list */
#define ABOVE_MOST  12  /* other rows */

enum tone { TONE_PLAIN, TONE_NEW, TONE_DIM, TONE_HEAD };

static bool has_colour(void)
{
    const char *none = getenv("NO_COLOR");
    return !(none && *none);
}

static struct winsize size_of(void)
{
    struct winsize size = {0};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0)
        size = (struct winsize){0};
    if (size.ws_col == 0 || size.ws_col > ROW_MOST)
        size.ws_col = size.ws_col ? ROW_MOST : 80;
    if (size.ws_row == 0)
        size.ws_row = 24;
    return size;
}

/* Prints a line cut to the screen's width: a wrapped line would not be overwritten completely. */
PRINTF_LIKE(3, 4)
static void row(struct fuzz_screen *screen, enum tone tone, const char *format, ...)
{
    static const char *const begin[] = {"", "\033[1;31m", "\033[2m", "\033[1m"};
    char text[ROW_MOST];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text[size_of().ws_col - 1] = '\0';
    bool painted = tone != TONE_PLAIN && has_colour();
    fprintf(stderr, "\033[K%s%s%s\n", painted ? begin[tone] : "", text, painted ? "\033[0m" : "");
    screen->lines++;
}

void fuzz_screen_trend(const struct fuzz_screen *screen, char text[SCREEN_SAMPLES + 1])
{
    static const char shade[] = " .:-=+*#";
    uint64_t count = screen->sampled < SCREEN_SAMPLES ? screen->sampled : SCREEN_SAMPLES, most = 1;
    for (uint64_t i = 0; i < count; i++)
        most = screen->sample[i] > most ? screen->sample[i] : most;
    for (uint64_t i = 0; i < count; i++) {
        uint64_t at = (screen->sampled - count + i) % SCREEN_SAMPLES;
        text[i] = shade[(screen->sample[at] * 7 + most - 1) / most];
    }
    text[count] = '\0';
}

void fuzz_screen_age(uint64_t ns, char text[16])
{
    const unsigned long long s = ns / 1000000000u;
    if (s < 120)
        snprintf(text, 16, "%llu s", s);
    else if (s < 7200)
        snprintf(text, 16, "%llu min", s / 60);
    else if (s < 172800)
        snprintf(text, 16, "%llu h", s / 3600);
    else
        snprintf(text, 16, "%llu d", s / 86400 > 99999 ? 99999 : s / 86400);
}

/* Notes when findings came, and how many trials a second were played. */
static void sample(struct fuzz_screen *screen, const struct campaign_view *view)
{
    size_t count = findings_count(view->findings);
    if (!screen->counted && view->phase != CAMPAIGN_STARTING && view->trials == 0)
        screen->seen = count; /* of earlier runs */
    screen->counted = screen->counted || view->trials > 0;
    for (; screen->seen < count; screen->seen++)
        if (screen->seen < SCREEN_SEEN)
            screen->seen_ns[screen->seen] = view->ns;
    if (view->ns - screen->sampled_ns >= DRAW_NS && view->phase == CAMPAIGN_PLAYING) {
        uint64_t spent = view->ns - screen->sampled_ns;
        screen->sample[screen->sampled++ % SCREEN_SAMPLES] =
            (uint64_t)((double)(view->trials - screen->before) * 1e9 / (double)spent);
        screen->sampled_ns = view->ns;
        screen->before = view->trials;
    }
}

static void age_of(const struct fuzz_screen *screen, const struct campaign_view *view, size_t i,
                   char text[16])
{
    if (i < SCREEN_SEEN && screen->seen_ns[i])
        fuzz_screen_age(view->ns - screen->seen_ns[i], text);
    else
        strcpy(text, "before");
}

static const char *state_text(const struct campaign_mark *mark)
{
    return mark->known ? "known" : campaign_is_flaky(mark) ? "flaky" : "NEW";
}

/* --- rows ------------------------------------------------------------------------------------- */

static double per_second(uint64_t count, uint64_t ns)
{
    return ns ? (double)count / ((double)ns * 1e-9) : 0;
}

static void draw_head(struct fuzz_command *c, const struct campaign_view *view)
{
    static const char *const phase[] = {[CAMPAIGN_STARTING] = "opening engines",
                                        [CAMPAIGN_PLAYING] = "playing",
                                        [CAMPAIGN_ENDING] = "ending",
                                        [CAMPAIGN_SHRINKING] = "shrinking"};
    const struct campaign_options *o = view->options;
    const uint64_t s = view->ns / 1000000000u;
    char left[48] = "", trend[SCREEN_SAMPLES + 1], age[16];
    if (view->phase == CAMPAIGN_PLAYING && o->seconds > 0) {
        fuzz_screen_age((s < o->seconds ? o->seconds - s : 0) * 1000000000u, age);
        snprintf(left, sizeof left, ", %s left", age);
    } else if (view->phase == CAMPAIGN_PLAYING && o->trials > 0) {
        snprintf(left, sizeof left, ", of %llu generated ones",
                 (unsigned long long)(o->trials / o->shards));
    }
    fuzz_screen_age(view->ns, age);
    row(&c->screen, TONE_HEAD, "raydiff fuzz: %s, seed %llu, %s%s",
        c->screen.paused ? "PAUSED" : phase[view->phase], (unsigned long long)c->seed, age, left);
    fuzz_screen_trend(&c->screen, trend);
    row(&c->screen, TONE_PLAIN, "trials    %llu (%.0f/s) |%s|", (unsigned long long)view->trials,
        per_second(view->trials, view->play_ns), trend);
    row(&c->screen, TONE_PLAIN, "rays      %.3g judged (%.3g/s), %llu at fault",
        (double)view->judged, per_second(view->judged, view->play_ns),
        (unsigned long long)view->wrong);
    row(&c->screen, TONE_PLAIN, "coverage  %u of %u, %zu trials kept, %llu mutants; corpus %s",
        coverage_count(view->coverage), coverage_reachable(view->options->rules.gen.worlds),
        view->kept, (unsigned long long)view->mutants,
        view->options->rules.corpus_count ? "played" : "none");
}

/* A list of shares on one row; those that do not fit are left out. */
struct shares {
    char text[ROW_MOST];
    size_t at;
};

static void add_share(struct shares *shares, const char *name, double share)
{
    char one[64];
    snprintf(one, sizeof one, "%s%.30s %.3g %%", shares->at ? ", " : "", name, 100 * share);
    if (shares->at + strlen(one) + 11 >= size_of().ws_col)
        return;
    strcpy(shares->text + shares->at, one);
    shares->at += strlen(one);
}

/* Prints the share of time of each engine, summed over its layouts, and of the harness. */
static void draw_times(struct fuzz_command *c, const struct campaign_view *view)
{
    const struct fuzz_field *field = &view->options->rules.field;
    struct shares shares = {"", 0};
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
            add_share(&shares, field->who[i].engine->name, mine / all * (1 - harness));
    }
    add_share(&shares, "harness", harness);
    row(&c->screen, TONE_PLAIN, "time      %s", shares.text);
}

/* Right and wrong first: what does not fit is left out. */
static void draw_verdicts(struct fuzz_command *c, const struct campaign_view *view)
{
    struct shares shares = {"", 0};
    uint64_t all = 0;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        all += view->count[v];
    double each = all > 0 ? 1 / (double)all : 0;
    add_share(&shares, verdict_name(VERDICT_RIGHT), (double)view->count[VERDICT_RIGHT] * each);
    add_share(&shares, verdict_name(VERDICT_WRONG), (double)view->count[VERDICT_WRONG] * each);
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        if (view->count[v] > 0 && v != VERDICT_RIGHT && v != VERDICT_WRONG)
            add_share(&shares, verdict_name((enum verdict)v), (double)view->count[v] * each);
    row(&c->screen, TONE_PLAIN, "verdicts  %s", shares.text);
}

/* The findings in the order of the list: new ones first, the last first. Returns their number. */
static size_t order(const struct campaign_view *view, size_t list[LISTED_MOST])
{
    size_t count = findings_count(view->findings), used = 0;
    for (int known = 0; known < 2; known++)
        for (size_t i = count; i-- > 0 && used < LISTED_MOST;)
            if ((strcmp(state_text(&view->mark[i]), "NEW") != 0) == known)
                list[used++] = i;
    return used;
}

static void draw_list(struct fuzz_command *c, const struct campaign_view *view)
{
    struct fuzz_screen *screen = &c->screen;
    size_t list[LISTED_MOST], count = findings_count(view->findings), shown = order(view, list);
    size_t room = size_of().ws_row > ABOVE_MOST ? (size_t)size_of().ws_row - ABOVE_MOST : 1;
    char age[16], last[64] = "", name[FUZZ_SIGNATURE_MOST];
    uint64_t latest = 0;
    for (size_t i = 0; i < count && i < SCREEN_SEEN; i++)
        latest = screen->seen_ns[i] > latest ? screen->seen_ns[i] : latest;
    if (latest) {
        fuzz_screen_age(view->ns - latest, age);
        snprintf(last, sizeof last, ", the last %s ago", age);
    }
    row(screen, TONE_PLAIN, "findings  %zu: %zu new%s", count, campaign_news(view, NULL), last);
    for (size_t i = 0; i < shown && i < room; i++) {
        const struct findings_entry *entry = findings_entry(view->findings, list[i]);
        const char *state = state_text(&view->mark[list[i]]);
        fuzz_signature_print(&entry->signature, name);
        age_of(screen, view, list[i], age);
        row(screen, strcmp(state, "NEW") == 0 ? TONE_NEW : TONE_DIM, "  %-5s %8s %6llu x  %s%s",
            state, age, (unsigned long long)entry->count, name,
            view->mark[list[i]].shrunk ? "" : ", not shrunk");
    }
    if (count > shown || shown > room)
        row(screen, TONE_DIM, "  ... and %zu more", count - (shown < room ? shown : room));
}

static void draw_finding(struct fuzz_command *c, const struct campaign_view *view, size_t i)
{
    static struct finding_words words;
    const struct findings_entry *entry = findings_entry(view->findings, i);
    fuzz_describe(c, view, i, &words);
    row(&c->screen, TONE_PLAIN, "finding   %zu of %zu", i + 1, findings_count(view->findings));
    row(&c->screen, strcmp(state_text(&view->mark[i]), "NEW") == 0 ? TONE_NEW : TONE_DIM,
        "  %s  %s", state_text(&view->mark[i]), words.signature);
    row(&c->screen, TONE_PLAIN, "  %s", cause_text(entry->signature.cause));
    if (words.answer.text[0])
        row(&c->screen, TONE_PLAIN, "  %s", words.answer.text);
    row(&c->screen, TONE_PLAIN, "  %llu times, smallest: %u triangle%s, %u ray%s",
        (unsigned long long)entry->count, entry->smallest.triangles,
        plural(entry->smallest.triangles), entry->smallest.rays, plural(entry->smallest.rays));
    row(&c->screen, TONE_PLAIN, "  %s", words.replay);
}

static void draw(struct fuzz_command *c, const struct campaign_view *view)
{
    struct fuzz_screen *screen = &c->screen;
    if (screen->lines > 0)
        fprintf(stderr, "\033[%dA\033[J", screen->lines);
    screen->lines = 0;
    draw_head(c, view);
    draw_times(c, view);
    draw_verdicts(c, view);
    row(screen, TONE_PLAIN, "workers   %u, %u restarts%s%s", view->workers, view->restarts,
        view->said[0] ? ": " : "", view->said);
    if (screen->selected > 0)
        draw_finding(c, view, screen->selected - 1);
    else
        draw_list(c, view);
    if (screen->keys)
        row(screen, TONE_DIM, "p %s   f %s   q end", screen->paused ? "go on" : "pause",
            screen->selected ? "the next finding" : "show a finding");
    fflush(stderr);
}

/* --- keys ------------------------------------------------------------------------------------- */

/* Does what the keys ask for; true if anything has changed. */
static bool take_keys(struct fuzz_screen *screen, const struct campaign_view *view)
{
    bool changed = false;
    for (int key; (key = fuzz_key_pressed(screen)) != 0; changed = true)
        switch (key) {
        case 'p':
            screen->paused = !screen->paused;
            break;
        case 'f':
            screen->selected = (screen->selected + 1) % (findings_count(view->findings) + 1);
            break;
        case 'q':
            screen->paused = false;
            raise(SIGINT);
            break;
        default:
            break;
        }
    return changed;
}

void fuzz_screen_tick(struct fuzz_command *c, const struct campaign_view *view)
{
    struct fuzz_screen *screen = &c->screen;
    uint64_t now = time_ns();
    sample(screen, view);
    bool changed = take_keys(screen, view);
    if (screen->drawn_ns == 0)
        screen->drawn_ns = 1;
    if (!changed && now - screen->drawn_ns < DRAW_NS)
        return;
    screen->drawn_ns = now;
    draw(c, view);
    while (screen->paused && !*view->options->stop) { /* workers end what they play, and wait */
        fuzz_key_wait();
        if (take_keys(screen, view))
            draw(c, view);
    }
}
