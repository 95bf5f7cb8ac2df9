/* The campaign of truth: many judged rays, every WRONG decided again by rationals. With files,
 * findings of a fuzz campaign over worlds in place of scenes: the engine that each names plays it.
 *   truth [--worlds] [--rays N] [--seed S] [--out DIR] [--driver D] [FILE.trial...]
 * N rays of five sets on every scene, or every world; engines cpu and vulkan on layouts f32 and
 * rf16, with mt (box test robust) and woop (box test watertight), and embree_robust; of worlds fast
 * on f32, embree and rayquery, too, and every second ray has a mask and flags. The layouts as
 * published, which are known to be wrong, join with 1/500 of the rays: they show that WRONGs are
 * found, decided again and explained. The first of each signature and the smallest scene that still
 * shows it go to DIR. Exit: 0 nothing overturned and no WRONG of cpu, vulkan or fast on f32 or
 * rf16; 1 otherwise; 2 bad input; 3 an engine failed; 4 no memory; 77 the engine
 * of a finding cannot run here. */
#include "ref/files/file.h"
#include "tests/truth/truth.h"

#include <stdlib.h>
#include <string.h>

/* From so many answers on layouts as published must be found WRONG: some 4 in 100 are. */
#define BLIND_FROM 1000u

static const char *const group_names[GROUP_COUNT] = {"cpu, vulkan: mt", "cpu, vulkan: woop", "fast",
                                                     "others", "as published"};

static bool is_ours(const struct tally_contestant *who)
{
    return who->layout && !who->layout->faithful;
}

void truth_count(struct truth_campaign *c, const char *where, const struct tally_contestant *who,
                 enum truth_group group, enum status status, const struct play_result *result,
                 const struct reason *reason)
{
    if (status == STATUS_DEVICE && group == GROUP_PUBLISHED) {
        /* An index cut to 15 bits can make a circle; the engine says so instead of answering. */
        c->unfinished++;
        return;
    }
    if (status) {
        fprintf(stderr, "truth: %s, %s: %s\n", where, who->engine->name, reason->text);
        c->code = exit_worse(c->code, exit_of_status(status));
        return;
    }
    struct play_result *sum = &c->sum[group];
    c->refused += result->refused;
    sum->judged += result->judged;
    sum->hits += result->hits;
    for (enum verdict v = 0; v < VERDICT_COUNT; v++)
        sum->verdict[v] += result->verdict[v];
    if (result->worst_over > sum->worst_over)
        sum->worst_over = result->worst_over;
}

void truth_play(const struct truth_seat *seat, const struct tally_contestant *who,
                enum truth_group group, uint32_t share)
{
    struct truth_campaign *c = seat->campaign;
    struct play_result result;
    struct reason reason = {""};
    char where[160];
    const size_t all = *seat->count;
    *seat->count = all / share;
    if (*seat->count > 0) {
        snprintf(where, sizeof where, "%s, %s rays", seat->spec, seat->rays);
        progress_step(&c->progress, "%s, %s %s %s", where, who->engine->name,
                      who->layout ? who->layout->name : "", who->tri->name);
        enum status status = seat->play(seat->ground, who, &c->pool, &c->tally, &result, &reason);
        truth_count(c, where, who, group, status, &result, &reason);
    }
    *seat->count = all;
}

void truth_play_own(const struct truth_seat *seat)
{
    static const char *const pairs[][2] = {{"mt", "robust"}, {"woop", "watertight"}};
    static const char *const own[] = {"cpu", "vulkan"};
    for (size_t t = 0; t < ARRAY_COUNT(pairs); t++)
        for (size_t e = 0; e < ARRAY_COUNT(own); e++)
            for (size_t l = 0; layouts[l]; l++) {
                const bool published = layouts[l]->faithful;
                const struct tally_contestant who = {.engine = engine_find(own[e]),
                                                     .layout = layouts[l],
                                                     .box = box_test_find(pairs[t][1]),
                                                     .tri = tri_test_find(pairs[t][0])};
                truth_play(seat, &who, published ? GROUP_PUBLISHED : (enum truth_group)t,
                           published ? PUBLISHED_SHARE : 1);
            }
}

enum status truth_each_set(struct truth_campaign *c, void *ground,
                           enum status (*one)(struct truth_campaign *c, void *ground,
                                              const struct ray_set *set, size_t count,
                                              uint64_t seed, struct reason *reason),
                           struct reason *reason)
{
    static const char *const sets[] = {"random", "vertices", "edges", "corners", "axis"};
    enum status status = STATUS_OK;
    for (size_t s = 0; s < ARRAY_COUNT(sets) && !status; s++) {
        size_t left = (size_t)c->options.rays / ARRAY_COUNT(sets);
        for (uint64_t part = 0; left > 0 && !status; part++) {
            size_t rays = left < BATCH ? left : BATCH;
            status = one(c, ground, ray_set_find(sets[s]), rays, c->options.seed + 1000 * part + s,
                         reason);
            left -= rays;
        }
    }
    return status;
}

static void print_groups(const struct truth_campaign *c)
{
    printf("%-18s %11s %11s", "answers of", "judged", "hits");
    for (enum verdict v = VERDICT_TIE; v < VERDICT_COUNT; v++)
        printf(" %9.9s", v == VERDICT_OUT_OF_CONTRACT ? "no_contr." : verdict_name(v));
    printf(" %8s\n", "err/E");
    size_t judged = 0;
    for (int g = 0; g < GROUP_COUNT; g++) {
        const struct play_result *sum = &c->sum[g];
        if (sum->judged == 0)
            continue;
        printf("%-18s %11zu %11zu", group_names[g], sum->judged, sum->hits);
        for (enum verdict v = VERDICT_TIE; v < VERDICT_COUNT; v++)
            printf(" %9zu", sum->verdict[v]);
        printf(" %8.3g\n", sum->worst_over);
        judged += sum->judged;
    }
    printf("%-18s %11zu\n\n", "all", judged);
}

/* Prints the result; returns the exit code. */
static int print_result(const struct truth_campaign *c)
{
    size_t wrong = 0, opinion[GMP_OPINION_COUNT] = {0}, own = 0;
    print_groups(c);
    for (size_t i = 0; i < c->tally.count; i++) {
        const struct signature *s = &c->tally.signature[i];
        char name[160];
        signature_name(s, name, sizeof name);
        printf("%-68s %8zu wrong (confirmed %zu), smallest scene %u triangles\n", name, s->count,
               s->opinion[GMP_CONFIRMED], s->smallest.scene.tri_count);
        wrong += s->count;
        for (int k = 0; k < GMP_OPINION_COUNT; k++)
            opinion[k] += s->opinion[k];
        own += is_ours(&s->first.who) ? s->count : 0;
    }
    printf("%zu %s (%zu left out), %zu combinations refused by a layout or skipped, %zu of "
           "published layouts not finished (stack)\n",
           c->scenes, c->options.worlds ? "worlds" : "scenes", c->left_out, c->refused,
           c->unfinished);
    printf("WRONG: %zu in %zu signatures; of ours, without layouts as published: %zu of %zu\n",
           wrong, c->tally.count, own,
           c->sum[GROUP_MT].judged + c->sum[GROUP_WOOP].judged + c->sum[GROUP_FAST].judged);
    printf("decided again by rationals:");
    for (int k = 0; k < GMP_OPINION_COUNT; k++)
        printf(" %s %zu", gmp_opinion_name((enum gmp_opinion)k), opinion[k]);
    printf("; without a signature %zu\n", c->tally.beyond);
    for (size_t i = 0; i < c->tally.doubtful_count; i++)
        wrong_answer_print(&c->tally.doubtful[i], stdout);
    const struct play_result *published = &c->sum[GROUP_PUBLISHED];
    bool blind = published->judged >= BLIND_FROM && published->verdict[VERDICT_WRONG] == 0;
    if (blind)
        printf("of %zu answers of layouts as published none is WRONG: the judge sees nothing\n",
               published->judged);
    bool bad = opinion[GMP_OVERTURNED] > 0 || own > 0 || c->tally.beyond > 0 || blind;
    return exit_worse(c->code, bad ? EXIT_MISMATCH : EXIT_AGREE);
}

#define ROWS_OF struct truth_options

static const struct option_row rows[] = {
    {"rays", "N", "of each scene and contestant", OF_COUNT(rays, 100, 1u << 30), .value = "650000"},
    {"worlds", NULL, "worlds instead of scenes", OF_FLAG(worlds)},
    {"seed", "S", "of rays and scenes", OF_COUNT(seed, 0, UINT32_MAX), .value = "1"},
    {"out", "DIR", "where findings go", OF_FOLDER(out)},
    {0},
};

static const struct option_set set = {
    .command = "truth",
    .usage = "truth [OPTIONS] [FILE.trial...]     (make truth ARGS='...')",
    .about = "Judges rays and decides every WRONG again; with files, those of findings in worlds.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines)},
    .codes = "0 nothing overturned, 1 otherwise, 2 bad input, 3 an engine failed, 4 no memory, "
             "77 the engine of a finding cannot run here",
    .example = "truth --rays 10000 --out build/truth",
};

/* Plays one scene or world; a file that was not fetched is left out. */
static void play_spec(struct truth_campaign *c, const char *spec, truth_plays *plays)
{
    struct reason reason = {""};
    FILE *there = strchr(spec, '/') ? fopen(spec, "rb") : NULL;
    if (strchr(spec, '/') && !there) {
        printf("SKIP %s: not fetched (make scenes)\n", spec);
        c->left_out++;
        return;
    }
    if (there)
        fclose(there);
    enum status status = plays(c, spec, &reason);
    progress_end(&c->progress);
    c->scenes += status == STATUS_OK;
    if (status) {
        bool named = strncmp(reason.text, spec, strlen(spec)) == 0; /* as readers of files do */
        fprintf(stderr, "truth: %s%s%s\n", named ? "" : spec, named ? "" : ": ", reason.text);
        c->code = exit_worse(c->code, exit_of_status(status));
    }
}

int main(int argc, char **argv)
{
    static const char *const campaign_only[] = {"worlds", "rays", "seed"};
    static struct truth_campaign c;
    c.options = (struct truth_options){.engines = engine_options_default()};
    c.progress = progress_make("truth");
    int first, code = options_read(&set, &c.options, argc, argv, &first);
    if (code >= 0)
        return code;
    for (size_t i = 0; first < argc && i < ARRAY_COUNT(campaign_only); i++)
        if (option_was_given(campaign_only[i]))
            return usage_error("truth", "--%s: a finding brings its own", campaign_only[i]);
    c.pool.options = c.options.engines;
    const char *const *spec = c.options.worlds ? truth_worlds : truth_scenes;
    for (; *spec && first == argc; spec++)
        play_spec(&c, *spec, c.options.worlds ? truth_play_world : truth_play_scene);
    for (; first < argc; first++)
        play_spec(&c, argv[first], truth_play_trial);
    code = print_result(&c);
    struct reason reason = {""};
    if (c.options.out && tally_write(&c.tally, c.options.out, &reason)) {
        fprintf(stderr, "truth: %s\n", reason.text);
        code = exit_worse(code, EXIT_USAGE);
    }
    tally_free(&c.tally);
    pool_free(&c.pool);
    return code;
}
