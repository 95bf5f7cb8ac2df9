/* raydiff build --same: the same build again and again, with several numbers of threads. */
#include "cmd/build/cmd_build_same.h"

#include "cmd/common/cmd_grid.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/store.h"
#include "scenes/rays/rays.h"

#include <stdlib.h>
#include <string.h>

#define SAME_RAYS 10000u

const uint32_t same_threads[SAME_THREADS] = {1, 2, 8, 16};

/* --- trees ------------------------------------------------------------------------------------ */

/* The first element in which two arrays differ; `count`: none. */
static size_t first_other(const void *a, const void *b, size_t count, size_t size)
{
    size_t i = 0;
    while (i < count && memcmp((const char *)a + i * size, (const char *)b + i * size, size) == 0)
        i++;
    return i;
}

static void note(struct same_row *row, uint32_t threads, const char *what, size_t at, size_t most)
{
    if (at < most && row->differing++ == 0)
        snprintf(row->text, sizeof row->text, "with %u threads: %s %zu", threads, what, at);
}

static void compare_trees(const struct bvh *one, const struct bvh *other, uint32_t threads,
                          struct same_row *row)
{
    row->builds++;
    if (one->node_count != other->node_count || one->prim_count != other->prim_count) {
        note(row, threads, "number of nodes", other->node_count, SIZE_MAX);
        return;
    }
    size_t node = first_other(one->node, other->node, one->node_count, sizeof *one->node);
    size_t prim = first_other(one->prim, other->prim, one->prim_count, sizeof *one->prim);
    if (node < one->node_count)
        note(row, threads, "node", node, one->node_count);
    else
        note(row, threads, "item", prim, one->prim_count);
}

static void compare_packed(const struct packed *one, const struct packed *other, uint32_t threads,
                           struct same_row *row)
{
    row->builds++;
    if (one->word_count != other->word_count || one->item_count != other->item_count) {
        note(row, threads, "number of words", other->word_count, SIZE_MAX);
        return;
    }
    size_t items = one->item ? one->item_count : 0;
    size_t word = first_other(one->word, other->word, one->word_count, sizeof *one->word);
    size_t item = first_other(one->item, other->item, items, sizeof *one->item);
    if (word < one->word_count)
        note(row, threads, "word", word, one->word_count);
    else
        note(row, threads, "word of items", item, items);
}

/* What the builds of a builder are compared with: the first, with one thread. */
struct same_first {
    struct bvh bvh;
    struct packed packed[SAME_LAYOUTS_MOST];
};

static enum status pack_all(const struct same_job *job, const struct scene *scene,
                            const struct bvh *bvh, uint32_t threads, struct same_first *first,
                            struct same_row *row, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t l = 0; l < job->layout_count && !status; l++) {
        struct packed packed;
        row[1 + l].builder = row->builder;
        row[1 + l].layout = job->layout[l];
        status = packed_make(job->layout[l], bvh, scene, &packed, &row[1 + l].refused);
        if (status == STATUS_LIMIT) {
            status = STATUS_OK;
            continue;
        }
        if (status)
            return fail(reason, status, "%s", row[1 + l].refused.text);
        if (first->packed[l].layout) {
            compare_packed(&first->packed[l], &packed, threads, &row[1 + l]);
            packed_free(&packed);
        } else {
            first->packed[l] = packed;
        }
    }
    return status;
}

static enum status play_builder(const struct same_job *job, const struct scene *scene,
                                struct same_first *first, struct same_row *row,
                                struct reason *reason)
{
    struct build_options options = build_options_default();
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i <= job->rounds * SAME_THREADS && !status; i++) {
        struct bvh bvh;
        options.threads = i == 0 ? 1 : same_threads[(i - 1) % SAME_THREADS];
        status = bvh_build(row->builder, scene, &options, &bvh, &row->refused);
        if (status == STATUS_LIMIT)
            return STATUS_OK;
        if (status)
            return fail(reason, status, "%s", row->refused.text);
        if (i > 0)
            compare_trees(&first->bvh, &bvh, options.threads, row);
        status = pack_all(job, scene, &bvh, options.threads, first, row, reason);
        if (i == 0)
            first->bvh = bvh;
        else
            bvh_free(&bvh);
    }
    return status;
}

enum status same_play(const struct same_job *job, const struct scene *scene, struct same_row *row,
                      struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t b = 0; b < job->builder_count && !status; b++) {
        struct same_first first = {.bvh = {.node = NULL}};
        struct same_row *at = &row[b * (1 + job->layout_count)];
        at->builder = job->builder[b];
        status = play_builder(job, scene, &first, at, reason);
        bvh_free(&first.bvh);
        for (size_t l = 0; l < job->layout_count; l++)
            packed_free(&first.packed[l]);
    }
    return status;
}

/* --- trees of others -------------------------------------------------------------------------- */

/* Builds and traces with one engine; answers are compared with the first ones. */
static enum status play_engine(const struct same_job *job, struct match *match,
                               struct same_engine *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    struct hit *first = alloc_zeroed(match->ray_count, sizeof *first);
    if (!first)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", match->ray_count);
    for (uint32_t i = 0; i < job->rounds * SAME_THREADS && !status; i++) {
        struct pool pool = {.options = engine_options_default()};
        struct row row;
        pool.options.threads = same_threads[i % SAME_THREADS];
        match->pool = &pool;
        match_run(match, out->engine, &row);
        out->absent = row.status == ROW_SKIPPED;
        out->refused = row.reason;
        pool_free(&pool);
        if (row.status == ROW_SKIPPED)
            break;
        if (row.status != ROW_OK && row.status != ROW_VACUOUS)
            status = fail(reason, STATUS_DEVICE, "%s: %.200s", out->engine->name, row.reason.text);
        out->builds++;
        out->rays = row.rays;
        out->wrong += row.count[VERDICT_WRONG];
        if (i == 0)
            memcpy(first, match->answer, match->ray_count * sizeof *first);
        for (size_t r = 0; r < match->ray_count; r++)
            out->other += memcmp(&first[r], &match->answer[r], sizeof *first) != 0;
    }
    free(first);
    return status;
}

enum status same_engines(const struct same_job *job, const struct scene *scene,
                         struct same_engine out[SAME_ENGINES_MOST], size_t *count,
                         struct reason *reason)
{
    const struct match_options options = {.builder = builders_all[0],
                                          .build = build_options_default(),
                                          .box = box_tests[0],
                                          .tri = tri_tests[0],
                                          .repeats = 1};
    struct match match;
    struct ray *ray = NULL;
    *count = 0;
    enum status status =
        ray_set_new(ray_set_find("mixed"), scene, job->seed, SAME_RAYS, &ray, reason);
    if (!status)
        status = match_make(scene, ray, SAME_RAYS, &options, NULL, &match, reason);
    if (status) {
        free(ray);
        return status;
    }
    for (size_t i = 0; engines[i] && !status && *count < SAME_ENGINES_MOST; i++) {
        if (!engines[i]->library || engines[i]->needs_packed)
            continue;
        out[*count] = (struct same_engine){.engine = engines[i]};
        status = play_engine(job, &match, &out[(*count)++], reason);
    }
    match_free(&match);
    free(ray);
    return status;
}

/* --- reports ---------------------------------------------------------------------------------- */

void same_print(const struct same_row *row, size_t count, const struct screen *screen)
{
    static const struct column columns[] = {{"verdict", .left = true},
                                            {"builder", .left = true},
                                            {"layout", .left = true},
                                            {.title = "compared"},
                                            {.title = "differ"}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    for (size_t i = 0; i < count; i++)
        if (row[i].builder)
            grid_add(&grid, row[i].differing ? PAINT_BAD : PAINT_GOOD, "%s\t%s\t%s\t%u\t%u",
                     row[i].differing    ? "DIFFERS"
                     : row[i].builds > 0 ? "equal"
                                         : "refused",
                     row[i].builder->name, row[i].layout ? row[i].layout->name : "tree",
                     row[i].builds, row[i].differing);
    grid_print(&grid, screen);
    for (size_t i = 0; i < count; i++)
        if (row[i].differing)
            screen_text(screen, "%s, %s: the first difference %s\n", row[i].builder->name,
                        row[i].layout ? row[i].layout->name : "tree", row[i].text);
}

void same_print_engines(const struct same_engine *one, size_t count, const struct screen *screen)
{
    for (size_t i = 0; i < count; i++, one++)
        if (one->absent)
            screen_text(screen, "%s cannot run here: %s\n", one->engine->name, one->refused.text);
        else
            screen_text(screen,
                        "%s: its trees cannot be read; in %u builds of its own %zu of %zu answers "
                        "have other bits than in the first, which is only reported, and %zu are "
                        "WRONG\n",
                        one->engine->name, one->builds, one->other, one->builds * one->rays,
                        one->wrong);
}

json_t *same_json(const char *scene, const struct same_row *row, size_t count,
                  const struct same_engine *engine, size_t engine_count)
{
    json_t *trees = json_array(), *others = json_array();
    for (size_t i = 0; i < count; i++)
        if (row[i].builder)
            json_array_append_new(trees,
                                  json_record("builder=%s layout=%p compared=%u differ=%u first=%s",
                                              row[i].builder->name,
                                              json_text(row[i].layout ? row[i].layout->name : NULL),
                                              row[i].builds, row[i].differing, row[i].text));
    for (size_t i = 0; i < engine_count; i++)
        json_array_append_new(
            others,
            json_record("engine=%s builds=%u answers=%zu other_bits=%zu wrong=%zu",
                        engine[i].engine->name, engine[i].builds, engine[i].builds * engine[i].rays,
                        engine[i].other, engine[i].wrong));
    return json_record("scene=%s trees=%p engines=%p", scene, trees, others);
}
