/* Blocks of trials: which comes next, what workers report of them, and what becomes of that. */
#include "fuzz/campaign/campaign_inner.h"

#include "fuzz/play/fuzz_turns.h"
#include "fuzz/play/trial_life.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- which comes next ------------------------------------------------------------------------ */

static struct campaign_block *make(struct campaign *c, enum work_stream stream, uint64_t first,
                                   uint64_t count)
{
    struct campaign_block *block = alloc_zeroed(1, sizeof *block);
    if (!block)
        return NULL;
    block->stream = stream;
    block->first = first;
    block->count = count < FUZZ_BATCH ? (uint32_t)count : FUZZ_BATCH;
    if (stream == WORK_GEN || stream == WORK_MUT) /* all play what is known to be worth it */
        block->waiting = fuzz_turns_waiting(&c->rules.field, first / FUZZ_BATCH);
    if (stream != WORK_MUT) {
        *c->last = block;
        c->last = &block->next;
        c->waiting++;
    }
    c->ordered++;
    return block;
}

/* As many mutants as have no more triangles than a block of the largest ordinary trials. */
static uint64_t mutants_of(const struct campaign *c, const struct fuzz_trial *base)
{
    uint64_t room = (uint64_t)FUZZ_BATCH * c->rules.gen.triangles_most;
    uint64_t count = room / (base->scene.tri_count + 1u);
    return count < 1 ? 1 : count < FUZZ_BATCH ? count : FUZZ_BATCH;
}

static struct campaign_block *make_mutants(struct campaign *c)
{
    const struct fuzz_trial *base = feedback_choose(c->feedback, &c->rng);
    struct campaign_block *block =
        base ? make(c, WORK_MUT, c->mut_next * FUZZ_BATCH, mutants_of(c, base)) : NULL;
    if (block) {
        block->base = base;
        c->mut_next++;
        c->mutated++;
        c->mut_triangles += block->count * (uint64_t)base->scene.tri_count;
    }
    return block;
}

/* Half of the blocks and no more than half of the work: rare states are often those of large
 * trials.
 */
static bool may_mutate(const struct campaign *c)
{
    return c->options->mutate && feedback_count(c->feedback) > 0 && 2 * c->mutated < c->ordered &&
           c->mut_triangles <= c->gen_triangles;
}

/* The first trial of our shard from trial `at` of stream gen on. */
static uint64_t own_trial(const struct campaign_options *o, uint64_t at)
{
    uint32_t shard = o->shard - 1;
    while (at / FUZZ_BATCH % o->shards != shard)
        at = (at / FUZZ_BATCH + 1) * FUZZ_BATCH;
    return at;
}

/* True if stream gen has a trial for us; then it is c->next. */
static bool has_next(struct campaign *c)
{
    const struct campaign_options *o = c->options;
    c->next = own_trial(o, c->next);
    return o->trials == 0 || c->next < o->trials;
}

/* From c->next to the end of its block, or of the campaign. */
static struct campaign_block *make_next(struct campaign *c)
{
    const struct campaign_options *o = c->options;
    uint64_t count = FUZZ_BATCH - c->next % FUZZ_BATCH;
    if (o->trials > 0 && o->trials - c->next < count)
        count = o->trials - c->next;
    struct campaign_block *block = make(c, WORK_GEN, c->next, count);
    if (block && o->rules.field.drawn)
        campaign_pairs_draw(c, block);
    c->next += block ? count : 0;
    c->gen_triangles += count * (o->rules.gen.triangles_least + o->rules.gen.triangles_most) / 2;
    return block;
}

bool campaign_blocks_left(const struct campaign *c)
{
    return own_trial(c->options, c->applied) < c->options->trials;
}

struct campaign_block *campaign_block_next(struct campaign *c, enum status *status)
{
    const struct campaign_options *o = c->options;
    struct campaign_block *block = NULL;
    bool wanted = true;
    *status = STATUS_OK;
    if (c->ending || c->waiting >= CAMPAIGN_WAITING + o->jobs)
        return NULL;
    if (!c->corpus_done && o->shard == 1 && c->corpus_next < o->rules.corpus_count) {
        block = make(c, WORK_CORPUS, c->corpus_next, o->rules.corpus_count - c->corpus_next);
        c->corpus_next += block ? block->count : 0;
    } else if (c->kept_next < c->rules.kept_count) {
        block = make(c, WORK_KEPT, c->kept_next, c->rules.kept_count - c->kept_next);
        c->kept_next += block ? block->count : 0;
    } else if (may_mutate(c)) {
        block = make_mutants(c);
    } else if (has_next(c)) {
        block = make_next(c);
    } else {
        wanted = false;
    }
    if (wanted && !block)
        *status = STATUS_MEMORY;
    return block;
}

void campaign_block_free(struct campaign_block *block)
{
    if (block)
        free(block->finding);
    free(block);
}

struct work_order campaign_block_order(const struct campaign_block *block)
{
    struct work_order order = {
        .stream = block->stream, .first = block->first, .count = block->count, .draw = block->draw};
    order.left_out = block->waiting;
    if (block->alone) {
        order.first += block->at;
        order.count = 1;
        order.left_out |= block->left_out;
        order.unexplained = block->unexplained;
    }
    return order;
}

/* --- what workers report ---------------------------------------------------------------------- */

static void add_times(struct campaign *c, const struct work_report *report)
{
    struct fuzz_time *sum = &c->view.time;
    for (size_t i = 0; i < FUZZ_CONTESTANTS_MOST; i++)
        sum->engine[i] += report->time.engine[i];
    sum->generate += report->time.generate;
    sum->build += report->time.build;
    sum->truth += report->time.truth;
    sum->judge += report->time.judge;
    c->view.explain_ns += report->explain_ns;
}

static enum status keep(struct campaign_block *block, const struct work_finding *finding)
{
    void *array = block->finding;
    if (array_reserve(&array, &block->finding_capacity, block->findings + 1,
                      sizeof *block->finding))
        return STATUS_MEMORY;
    block->finding = array;
    block->finding[block->findings++] = *finding;
    return STATUS_OK;
}

/* The next trial that is played alone. */
static void go_on_alone(struct campaign_block *block, uint32_t at)
{
    block->at = at;
    block->left_out = 0;
    block->unexplained = false;
}

/* Keeps a finding that only the parent saw. A `contestant` of FUZZ_CONTESTANTS_MOST is raydiff
 * itself. */
static enum status keep_death(struct campaign *c, struct campaign_block *block, uint32_t trial,
                              const struct death *death, enum cause cause)
{
    const struct fuzz_field *field = &c->options->rules.field;
    struct work_finding finding = {.trial = trial};
    struct fuzz_signature *signature = &finding.finding.signature;
    bool is_ours = death->contestant >= field->count;
    fuzz_signature_set_engine(signature,
                              is_ours ? "raydiff" : field->who[death->contestant].engine->name);
    signature->layout = is_ours          ? NULL
                        : block->draw.on ? block->draw.layout
                                         : field->who[death->contestant].layout;
    signature->kind = death->hung ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH;
    signature->cause = cause;
    finding.finding.contestant = death->contestant;
    finding.finding.ray = FINDINGS_NO_RAY;
    snprintf(finding.opinion, sizeof finding.opinion, "%s", death->text);
    return keep(block, &finding);
}

/* If no worker died of a single trial, the death is kept with the first trial that was at risk. */
static enum status end_alone(struct campaign *c, struct campaign_block *block)
{
    uint32_t first = block->death.trial < block->count ? (uint32_t)block->death.trial : 0;
    block->done = true;
    return block->died_alone ? STATUS_OK
                             : keep_death(c, block, first, &block->death, CAUSE_NOT_REPEATABLE);
}

enum status campaign_block_take(struct campaign *c, struct campaign_block *block,
                                const struct work_parts *parts)
{
    uint32_t from = block->alone ? block->at : 0;
    enum status status = STATUS_OK;
    add_times(c, parts->report);
    for (uint32_t i = 0; i < parts->report->trials && from + i < block->count; i++)
        block->trial[from + i] = parts->trial[i];
    for (uint32_t i = 0; i < parts->report->findings && !status; i++) {
        struct work_finding finding = parts->finding[i];
        finding.trial += from;
        status = keep(block, &finding);
    }
    block->done = !block->alone;
    if (block->alone)
        go_on_alone(block, block->at + 1);
    if (!status && block->alone && block->at == block->count)
        status = end_alone(c, block);
    return status;
}

enum status campaign_block_died(struct campaign *c, struct campaign_block *block,
                                const struct death *death)
{
    enum status status = STATUS_OK;
    if (!block->alone) { /* together: which trial it was is not known yet */
        block->alone = true;
        block->death = *death;
        block->findings = 0;
        go_on_alone(block, 0);
        return STATUS_OK;
    }
    block->died_alone = true;
    uint32_t bit = death->contestant < FUZZ_CONTESTANTS_MOST ? 1u << death->contestant : 0;
    if (death->phase == WORK_EXPLAINING && !block->unexplained) {
        block->unexplained = true;
    } else if (bit && !(block->left_out & bit)) {
        status = keep_death(c, block, block->at, death, CAUSE_UNEXPLAINED);
        block->left_out |= bit; /* the others still play it */
    } else {
        struct death ours = *death;
        ours.contestant = FUZZ_CONTESTANTS_MOST;
        status = keep_death(c, block, block->at, &ours, CAUSE_UNEXPLAINED);
        go_on_alone(block, block->at + 1);
        if (!status && block->at == block->count)
            status = end_alone(c, block);
    }
    return status;
}

/* --- what becomes of it ----------------------------------------------------------------------- */

static void count_trial(struct campaign *c, const struct campaign_block *block,
                        const struct work_trial *one)
{
    struct campaign_view *view = &c->view;
    uint32_t most = CAMPAIGN_TRIANGLES - 1;
    view->trials++;
    view->corpus += block->stream == WORK_CORPUS;
    view->mutants += block->stream == WORK_MUT;
    view->rays += one->rays;
    view->judged += one->judged;
    view->wrong += one->wrong;
    view->triangles += one->triangles;
    view->histogram[one->triangles < most ? one->triangles : most]++;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        view->count[v] += one->count[v];
    for (size_t i = 0; i < c->rules.field.count; i++) {
        view->refused[i] += (one->refusers & ~one->decliners) >> i & 1u;
        view->unasked[i] +=
            (block->draw.on && i != block->draw.contestant) || block->waiting >> i & 1u;
        view->turnout[i].played += one->players >> i & 1u;
        view->turnout[i].declined += one->decliners >> i & 1u;
        view->turnout[i].proved += one->provers >> i & 1u;
        for (size_t e = 0; e < MATCH_EDGES; e++) {
            view->turnout[i].edges[e].hits += one->edges[i][e].hits;
            view->turnout[i].edges[e].lost += one->edges[i][e].lost;
        }
        view->refitted += one->refitted >> i & 1u;
        view->rebuilt += one->rebuilt >> i & 1u;
    }
}

static enum status add_finding(struct campaign *c, const struct work_finding *one,
                               struct finding_file *file)
{
    struct findings_news news;
    uint32_t ray = one->finding.ray < file->trial.ray_count ? one->finding.ray : FINDINGS_NO_RAY;
    file->signature = one->finding.signature;
    enum status status = findings_add(c->findings, file, ray, one->opinion, &news, c->reason);
    if (!status)
        status = campaign_marks_update(c);
    for (size_t i = 0; i < c->marks && !status && !news.repeated; i++) {
        const struct findings_entry *entry = findings_entry(c->findings, i);
        if (!fuzz_signature_same(&entry->signature, &file->signature))
            continue;
        c->found = c->found || entry->lines == entry->count; /* else it is only counted */
        c->mark[i].shrunk = c->mark[i].shrunk && !news.smallest;
    }
    return status;
}

/* Of a trial with steps, what is kept ends after the step that shows the finding. */
static enum status add_ended(struct campaign *c, const struct work_finding *one,
                             struct finding_file *file)
{
    if (one->finding.step == file->trial.step_count)
        return add_finding(c, one, file);
    struct finding_file cut = *file;
    enum status status = trial_life_cut(&file->trial, one->finding.step, &cut.trial, c->reason);
    if (!status)
        status = add_finding(c, one, &cut);
    fuzz_trial_free(&cut.trial);
    return status;
}

/* Adds the trial's findings, and the trial to the feedback; it is made again only if one of them
 * needs it. */
static enum status apply_trial(struct campaign *c, const struct campaign_block *block, uint32_t i)
{
    const uint64_t *coverage = block->trial[i].coverage;
    bool wanted = c->options->mutate && feedback_wants(c->feedback, coverage), found = false;
    struct finding_file file = {.has_signature = true};
    struct feedback_news reached;
    enum status status = STATUS_OK;
    for (size_t k = 0; k < block->findings; k++)
        found = found || (block->finding[k].trial == i && block->stream != WORK_KEPT);
    const struct work_order order = {
        .stream = block->stream, .first = block->first, .draw = block->draw};
    if (wanted || found)
        status = work_trial_ordered(&c->rules, &order, i, block->base, &file.trial, c->reason);
    if (!status)
        status =
            feedback_add(c->feedback, wanted ? &file.trial : NULL, coverage, &reached, c->reason);
    snprintf(file.versions, sizeof file.versions, "%s", c->versions);
    for (size_t k = 0; k < block->findings && found && !status; k++)
        if (block->finding[k].trial == i)
            status = add_ended(c, &block->finding[k], &file);
    finding_file_free(&file);
    return status;
}

enum status campaign_block_apply(struct campaign *c, struct campaign_block *block)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < block->count && !status; i++) {
        coverage_merge(c->view.coverage, block->trial[i].coverage);
        count_trial(c, block, &block->trial[i]);
        status = apply_trial(c, block, i);
    }
    campaign_pairs_count(c, block);
    c->view.kept = feedback_count(c->feedback);
    if (block->stream == WORK_GEN) {
        c->applied = block->first + block->count;
        c->trials_done += block->count;
    }
    if (block->stream == WORK_CORPUS &&
        block->first + block->count == c->options->rules.corpus_count)
        c->corpus_done = true;
    c->dirty = true;
    campaign_block_free(block);
    return status;
}

enum status campaign_blocks_apply(struct campaign *c)
{
    enum status status = STATUS_OK;
    const struct campaign_options *o = c->options;
    while (c->first && c->first->done && !status) {
        struct campaign_block *block = c->first;
        c->first = block->next;
        c->last = c->first ? c->last : &c->first;
        c->waiting--;
        /* Trials behind the last finding of `until` are not part of the campaign. */
        if (o->until > 0 && campaign_counted(c) >= o->until) {
            campaign_block_free(block);
            continue;
        }
        status = campaign_block_apply(c, block);
    }
    return status;
}
