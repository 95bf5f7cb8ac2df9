#include "fuzz/campaign/campaign_inner.h"

#include "ref/match/turnout.h"

#include <stdlib.h>
#include <string.h>

#define TICK_NS 100000000u
/* Between checkpoints while nothing is written to the log: of many findings only the number is. */
#define SAVE_NS 1000000000u
/* The longest that new signatures are shrunk after the last trial. */
#define GRACE_NS 30000000000u
/* The longest that workers may finish their trials after a signal; the next run plays the rest. */
#define STOP_NS 500000000u

#define KEPT_FOLDER "corpus"

uint32_t campaign_triangles_median(const struct campaign_view *view)
{
    uint64_t seen = 0;
    for (uint32_t i = 0; i < CAMPAIGN_TRIANGLES; i++) {
        seen += view->histogram[i];
        if (2 * seen >= view->trials)
            return i;
    }
    return 0;
}

double campaign_harness_share(const struct campaign_view *view, double *to_engines)
{
    const struct fuzz_time *time = &view->time;
    double harness = (double)(time->generate + time->build + time->truth + time->judge), asked = 0;
    for (size_t i = 0; i < FUZZ_CONTESTANTS_MOST; i++)
        asked += (double)time->engine[i];
    if (to_engines)
        *to_engines = asked > 0 ? harness / asked : 0;
    return harness + asked > 0 ? harness / (harness + asked) : 0;
}

bool campaign_is_flaky(const struct campaign_mark *mark)
{
    return mark->played_again > 0 && mark->shown == 0;
}

size_t campaign_news(const struct campaign_view *view, size_t *flaky)
{
    size_t news = 0, rare = 0;
    for (size_t i = 0; i < findings_count(view->findings); i++) {
        bool is_flaky = campaign_is_flaky(&view->mark[i]);
        rare += is_flaky;
        news += !is_flaky && !view->mark[i].known;
    }
    if (flaky)
        *flaky = rare;
    return news;
}

const char *campaign_vacuous(const struct campaign_view *view, size_t i)
{
    const struct campaign_turnout *turnout = &view->turnout[i];
    if (view->turnout_unknown || view->trials + view->before == 0)
        return NULL;
    if (turnout->played == 0)
        return "it answered none of the trials";
    if (turnout->proved == 0)
        return "it gave no right hit in any trial";
    if (TURNOUT_ONE_IN * turnout->played < turnout->played + turnout->declined)
        return "it refused nearly all trials";
    return NULL;
}

const char *campaign_loses(const struct campaign_view *view, size_t i)
{
    return match_edges_beyond(view->turnout[i].edges) > 0
               ? "it loses more hits beside edges than rounding does"
               : NULL;
}

static int stop_of(const struct campaign *c)
{
    return c->options->stop ? *c->options->stop : 0;
}

/* True if workers have blocks, or some are not applied. */
static bool has_blocks(const struct campaign *c)
{
    for (size_t i = 0; i < c->slots; i++)
        if (c->slot[i].block)
            return true;
    return c->first != NULL;
}

bool campaign_is_played(const struct campaign *c)
{
    const struct campaign_options *o = c->options;
    return c->ending && !stop_of(c) && !has_blocks(c) &&
           (!campaign_blocks_left(c) || (o->until > 0 && campaign_counted(c) >= o->until));
}

static void update_view(struct campaign *c)
{
    struct campaign_view *view = &c->view;
    view->mark = c->mark;
    view->ns = time_ns() - c->start_ns;
    view->play_ns = c->play_end_ns ? c->play_end_ns - c->start_ns : view->ns;
    view->workers = (uint32_t)(c->slots - campaign_crew_count(c, SLOT_STARTING));
    view->to_shrink = view->shrunk = 0;
    for (size_t i = 0; i < c->marks; i++) {
        view->shrunk += c->mark[i].shrunk;
        view->to_shrink += !c->mark[i].shrunk;
    }
    view->unplayed = campaign_blocks_left(c);
    view->unshrunk = c->options->shrink == CAMPAIGN_SHRINK_AT_END && campaign_shrinks_left(c);
    view->phase = !c->versions[0]  ? CAMPAIGN_STARTING
                  : !c->ending     ? CAMPAIGN_PLAYING
                  : c->play_end_ns ? CAMPAIGN_SHRINKING
                                   : CAMPAIGN_ENDING;
}

static void tick(struct campaign *c, bool now)
{
    if (!c->options->tick || (!now && time_ns() - c->ticked_ns < TICK_NS))
        return;
    c->ticked_ns = time_ns();
    update_view(c);
    c->options->tick(c->options->user, &c->view);
}

/* True if no block may be ordered any more. */
static bool is_over(const struct campaign *c)
{
    const struct campaign_options *o = c->options;
    return stop_of(c) || (o->until > 0 && campaign_counted(c) >= o->until) ||
           (o->seconds > 0 && time_ns() - c->start_ns >= o->seconds * 1000000000u);
}

/* True if there is nothing more to do. */
static bool is_done(struct campaign *c)
{
    if (!c->ending || has_blocks(c))
        return false;
    if (!c->play_end_ns)
        c->play_end_ns = time_ns();
    bool late = c->options->shrink == CAMPAIGN_SHRINK_SOON && time_ns() - c->play_end_ns > GRACE_NS;
    c->no_more_jobs = c->no_more_jobs || stop_of(c) || late;
    if (campaign_crew_count(c, SLOT_SHRINK) || campaign_crew_count(c, SLOT_AGAIN))
        return stop_of(c) != 0;
    return c->no_more_jobs || !campaign_jobs_left(c);
}

/* Writes the trials kept for mutation, so that a kill loses no more of them than of the rest. */
static enum status save_kept(struct campaign *c)
{
    enum status status = STATUS_OK;
    if (!c->kept_folder.path)
        status = folder_open_in(findings_folder(c->findings), KEPT_FOLDER, true, &c->kept_folder,
                                c->reason);
    return status ? status : feedback_save(c->feedback, &c->kept_folder, c->reason);
}

static enum status save(struct campaign *c, bool now)
{
    uint64_t since = time_ns() - c->saved_ns;
    if (!c->dirty || (!now && !c->found && since < SAVE_NS))
        return STATUS_OK;
    enum status status = campaign_state_write(c);
    return status || !c->options->mutate ? status : save_kept(c);
}

/* All trials were ordered: no worker has one, and there is no next. */
static bool is_empty(struct campaign *c)
{
    return campaign_crew_count(c, SLOT_IDLE) == c->slots && !has_blocks(c);
}

/* True if a signal was received and the workers had STOP_NS to finish. */
static bool is_cut_short(struct campaign *c)
{
    if (!stop_of(c))
        return false;
    if (!c->stopped_ns)
        c->stopped_ns = time_ns();
    return stop_of(c) > 1 || time_ns() - c->stopped_ns > STOP_NS;
}

static enum status go_on(struct campaign *c)
{
    enum status status = STATUS_OK;
    while (!status && !is_done(c) && !is_cut_short(c)) {
        status = campaign_crew_order(c);
        if (!status && is_empty(c))
            c->ending = true;
        if (!status)
            status = campaign_crew_hear(c);
        c->ending = c->ending || is_over(c);
        if (!status) /* before files are written, so that no worker waits for the disk */
            status = campaign_crew_order(c);
        if (!status)
            status = campaign_blocks_apply(c);
        if (!status)
            status = campaign_marks_update(c);
        c->ending = c->ending || is_over(c);
        if (!status)
            status = save(c, false);
        c->view.said = c->said;
        tick(c, false);
    }
    return status;
}

static void close_all(struct campaign *c)
{
    struct campaign_block *next;
    campaign_crew_end(c, 2000);
    for (struct campaign_block *block = c->first; block; block = next) {
        next = block->next;
        campaign_block_free(block);
    }
    feedback_close(c->feedback);
    feedback_list_free(&c->kept);
    folder_close(&c->kept_folder);
    free(c->mark);
    free(c);
}

/* Reads the trials that earlier runs kept. */
static enum status load_kept(struct campaign *c)
{
    const struct folder *parent = findings_folder(c->findings);
    bool there;
    enum status status = folder_has_folder(parent, KEPT_FOLDER, &there, c->reason);
    if (status || !there)
        return status;
    status = folder_open_in(parent, KEPT_FOLDER, false, &c->kept_folder, c->reason);
    if (!status)
        status = folder_clean(&c->kept_folder, c->reason);
    return status ? status : feedback_load(&c->kept_folder, FEEDBACK_BYTES, &c->kept, c->reason);
}

/* Opens what a run needs before it makes processes. */
static enum status open_all(struct campaign *c)
{
    enum status status = feedback_open(FEEDBACK_BYTES, &c->feedback, c->reason);
    if (!status && c->options->mutate)
        status = load_kept(c);
    c->rules = c->options->rules;
    c->rules.kept = c->kept.trial;
    c->rules.kept_count = c->kept.count;
    c->last = &c->first;
    c->offered = SIZE_MAX;
    c->rng = rng_make(c->options->rules.seed, 0x63686F6Fu);
    c->start_ns = time_ns();
    c->view.options = c->options;
    c->view.findings = c->findings;
    c->view.versions = c->versions;
    c->view.said = c->said;
    if (!status)
        status = campaign_marks_update(c);
    if (!status)
        campaign_state_read(c);
    if (!status && !campaign_state_is_unplayed(findings_state(c->findings)))
        status = campaign_pairs_read(c);
    /* Before any other file, so that a folder with files always has the state of its campaign. */
    if (!status && campaign_state_is_unplayed(findings_state(c->findings)))
        status = campaign_state_write(c);
    return status;
}

enum status campaign_run(const struct campaign_options *options, struct findings *findings,
                         void (*end)(void *user, const struct campaign_view *view),
                         struct reason *reason)
{
    struct campaign *c = alloc_zeroed(1, sizeof *c);
    if (!c)
        return fail(reason, STATUS_MEMORY, "no memory for a campaign");
    c->options = options;
    c->reason = reason;
    c->findings = findings;
    enum status status = open_all(c);
    if (!status)
        status = campaign_crew_start(c);
    if (!status)
        status = go_on(c);
    if (!status)
        status = save(c, true);
    if (!status && options->mutate)
        status = save_kept(c);
    if (!c->play_end_ns)
        c->play_end_ns = time_ns();
    if (!status) {
        update_view(c);
        if (end)
            end(options->user, &c->view);
    }
    close_all(c);
    return status;
}
