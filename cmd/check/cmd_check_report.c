/* Output of raydiff check: the table, the findings, and a summary. */
#include "cmd/check/cmd_check.h"

#include "cmd/common/cmd_finding.h"
#include "ref/base/command.h"
#include "ref/store.h"

#include <string.h>

static void print_bytes(const struct row *row)
{
    if (!row->layout)
        printf("%9s %9s", "-", "-");
    else
        printf("%9.1f %9.1f", (double)row->node_bytes / 1e3, (double)row->item_bytes / 1e3);
}

/* Prints the kinds of wrong answers, also of members as published. */
static void print_wrong(const struct row *row)
{
    if (row->count[VERDICT_WRONG] == 0)
        return;
    fputs(row->judged ? "" : " as published:", stdout);
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        if (row->wrong[w])
            printf(" %s %zu", wrong_name(w), row->wrong[w]);
}

/* Prints counters that exist only for lists of all hits. */
static void print_lists(const struct row *row)
{
    if (row->options.query != QUERY_ALL)
        return;
    printf(" %zu triangles listed, %zu double hits,", row->lists.triangles, row->lists.doubles);
    if (row->lists.closed)
        printf(" parity off in %zu of %zu", row->lists.parity_off, row->lists.parity);
    else
        printf(" no parity (the mesh is open)");
}

/* Prints hits lost beside edges, if there are more than rounding explains. */
static void print_edges(const struct row *row)
{
    char text[MATCH_EDGES_TEXT];
    match_edges_text(row->edges, text);
    if (row->edges_beyond)
        printf(" lost beside edges %s", text);
}

static void print_row(const struct row *row)
{
    const struct match_options *o = &row->options;
    char text[STORED_NAME_MOST];
    printf("%-13s %-13s %-7s %-7s %-7s ", stored_name(row->layout, row->options.store, text),
           row->engine ? row->engine->name : "-", row_box_name(row), row_tri_name(row),
           query_name(o->query));
    if (row->status == ROW_REFUSED || row->status == ROW_SKIPPED || row->status == ROW_FAILED) {
        printf("%s: %s\n", row_status_name(row->status), row->reason.text);
        return;
    }
    print_bytes(row);
    printf(" %7zu", row->hits);
    for (enum verdict v = VERDICT_TIE; v < VERDICT_WRONG; v++)
        printf(" %5zu", row->count[v]);
    if (row->displacement.count)
        printf(" %5s", "-");
    else
        printf(" %5.2f", row->worst_over);
    if (row->judged)
        printf(" %6zu", row->count[VERDICT_WRONG]);
    else
        printf(" %6s", "count");
    printf(" %6zu", row->bit_differences);
    printf(" %8.3f (%.3f-%.3f)", row->mrays[0], row->mrays[1], row->mrays[2]);
    print_wrong(row);
    if (row->displacement.count)
        printf(" displacement p50 %.2g p99 %.2g max %.3g uM, %zu lost in closed fans",
               row->displacement.p50, row->displacement.p99, row->displacement.most,
               row->displacement.fan_lost);
    print_edges(row);
    if (row->fans_lost)
        printf(" watertight: %zu lost in closed fans", row->fans_lost);
    print_lists(row);
    if (row->status == ROW_VACUOUS)
        printf(" %s", row->reason.text);
    putchar('\n');
}

static void print_findings(const struct check_scene *scene, const struct row *row)
{
    for (size_t i = 0; i < row->finding_count; i++)
        finding_print(row, &row->finding[i], scene->spec, scene->seed, scene->driver);
    if (row->differences > row->finding_count && row->finding_count)
        printf("  ... and %zu more of this row\n", row->differences - row->finding_count);
}

/* The first row of `engine` with a layout of that name (NULL: any layout), or NULL. */
static const struct row *row_of(const struct check_scene *scene, const char *engine,
                                const char *layout)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (row->status == ROW_OK && row->layout && strcmp(row->engine->name, engine) == 0 &&
            (!layout || strcmp(row->layout->name, layout) == 0))
            return row;
    }
    return NULL;
}

/* Prints how many bytes engine cpu reads of each layout and storage, if any storage is not the
 * default. */
static void print_stored(const struct check_scene *scene)
{
    char text[STORED_NAME_MOST];
    const struct row *last = NULL;
    double tris = scene->tri_count ? scene->tri_count : 1;
    bool several = false;
    for (size_t i = 0; i < scene->row_count; i++)
        several |= scene->row[i].layout && scene->row[i].options.store != tri_stores[0];
    for (size_t i = 0; i < scene->row_count && several; i++) {
        const struct row *row = &scene->row[i];
        if (row->status != ROW_OK || !row->layout ||
            (last && last->layout == row->layout && last->options.store == row->options.store &&
             last->options.builder == row->options.builder))
            continue;
        last = row;
        printf("  %s: %.2f bytes a triangle: %.2f nodes, %.2f storage, %.2f the scene's arrays\n",
               stored_name(row->layout, row->options.store, text),
               (double)(row->node_bytes + row->item_bytes + row->scene_bytes) / tris,
               (double)row->node_bytes / tris, (double)row->item_bytes / tris,
               (double)row->scene_bytes / tris);
    }
}

/* For rows on a decoded scene, prints how their answers fit the original. */
static void print_originals(const struct check_scene *scene)
{
    char text[STORED_NAME_MOST];
    bool first = true;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        const size_t judged = row->original.judged;
        if (row->status != ROW_OK || judged == 0)
            continue;
        if (first)
            printf("  decoded from %u bits an axis: vertices moved by %.4g at most, certified; %u "
                   "triangles without area\n",
                   scene->quantised.grid.bits, scene->quantised.distance, scene->quantised.flat);
        first = false;
        printf("  %s on %s %s: WRONG decoded %zu, beyond what moved %zu; for the original, of a "
               "million %.1f lost, %.1f phantom, %.1f other triangle; displacement needed %.4g "
               "(decoded: %.3g)\n",
               stored_name(row->layout, row->options.store, text), row->engine->name,
               query_name(row->options.query), row->count[VERDICT_WRONG], row->original.beyond,
               1e6 * (double)row->original.lost / (double)judged,
               1e6 * (double)row->original.phantom / (double)judged,
               1e6 * (double)row->original.other / (double)judged, row->original.most,
               row->original.most_decoded);
    }
}

/* Prints ratios within this run: size and speed of each layout relative to f32, per engine, and the
 * speed of cpu relative to Embree. */
static void print_winners(const struct check_scene *scene)
{
    static const char *const players[] = {"vulkan", "cpu"};
    char text[STORED_NAME_MOST];
    for (size_t p = 0; p < ARRAY_COUNT(players); p++) {
        const struct row *base = row_of(scene, players[p], "f32");
        if (!base)
            continue;
        for (size_t i = 0; i < scene->row_count; i++) {
            const struct row *row = &scene->row[i];
            if (row->status != ROW_OK || row == base || !row->layout ||
                row->engine != base->engine || row->options.tri != base->options.tri ||
                row->options.box != base->options.box || row->options.query != base->options.query)
                continue;
            printf("  %s on %s: %.2f of f32's node bytes (%.2f with f32's item array), %.2f times "
                   "its speed\n",
                   stored_name(row->layout, row->options.store, text), players[p],
                   (double)row->node_bytes / (double)base->node_bytes,
                   (double)(row->node_bytes + row->item_bytes) /
                       (double)(base->node_bytes + base->item_bytes),
                   row->mrays[0] / base->mrays[0]);
        }
    }
    const struct row *cpu = row_of(scene, "cpu", NULL);
    for (size_t i = 0; i < scene->row_count && cpu; i++) {
        const struct row *row = &scene->row[i];
        if (row->status == ROW_OK && !row->layout && row->mrays[0] > 0 && row->engine->library &&
            row->options.query == cpu->options.query)
            printf("  cpu on %s: %.2f times the speed of %s\n", cpu->layout->name,
                   cpu->mrays[0] / row->mrays[0], row->engine->name);
    }
}

/* True if all layouts refuse, or no engine can run on them. */
static bool is_idle(const struct check_scene *scene)
{
    bool idle = true;
    for (size_t i = 0; i < scene->row_count; i++)
        idle = idle && scene->row[i].status == ROW_REFUSED && !scene->row[i].declined;
    return idle;
}

/* Returns a storage on which no layout ran; or NULL. The default storage is not considered, so the
 * storage was named. */
static const struct tri_store *idle_store(const struct check_scene *scene)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        const struct tri_store *store = row->options.store;
        bool idle = row->layout && store && store != tri_stores[0];
        for (size_t k = 0; k < scene->row_count && idle; k++) {
            const struct row *other = &scene->row[k];
            idle = !other->layout || other->options.store != store || other->status == ROW_REFUSED;
        }
        if (idle)
            return store;
    }
    return NULL;
}

static void print_agreement(const struct check_scene *scene)
{
    size_t exact_rows = 0, exact_rays = 0, exact_bad = 0, judged = 0, counted = 0;
    size_t count[VERDICT_COUNT] = {0}, wrong[WRONG_COUNT] = {0};
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (row->status != ROW_OK)
            continue;
        if (row->bits && !row->engine->reference) {
            exact_rows++;
            exact_rays += row->rays;
            exact_bad += row->bit_differences;
        }
        if (!row->judged) {
            counted += row->count[VERDICT_WRONG];
            continue;
        }
        judged += row->rays;
        for (enum verdict v = 0; v < VERDICT_COUNT; v++)
            count[v] += row->count[v];
        for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
            wrong[w] += row->wrong[w];
    }
    if (is_idle(scene))
        puts("  nothing was played: no engine has anything to play on");
    else if (idle_store(scene))
        printf("  storage %s was played on no layout\n", idle_store(scene)->name);
    if (exact_rows)
        printf("  bit for bit against cpu: %zu of %zu answers differ\n", exact_bad, exact_rays);
    printf("  against the exact truth: %zu of %zu answers WRONG", count[VERDICT_WRONG], judged);
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        printf("%s%s %zu", w == WRONG_MISSED ? " (" : ", ", wrong_name(w), wrong[w]);
    printf(")\n  allowed:");
    for (enum verdict v = 0; v < VERDICT_WRONG; v++)
        printf(" %s %zu%s", verdict_name(v), count[v], v + 1 < VERDICT_WRONG ? "," : "\n");
    if (counted)
        printf("  members as published are wrong in %zu answers: counted, not judged\n", counted);
}

/* Name of the member that refused, was skipped or failed. */
static const char *subject_name(const struct row *row)
{
    if (row->status == ROW_REFUSED && row->layout && !row->declined)
        return row->layout->name;
    return row->engine ? row->engine->name : "--layout auto";
}

static void print_reasons(const struct check_scene *scene)
{
    for (const char *line = scene->refused; *line;) {
        size_t length = strcspn(line, "\n");
        printf("  --layout auto could not take %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        bool repeated = false;
        for (size_t k = 0; k < i; k++)
            repeated |= strcmp(scene->row[k].reason.text, row->reason.text) == 0;
        if (row->status != ROW_OK && !repeated)
            printf("  %s %s: %s\n", subject_name(row), row_status_name(row->status),
                   row->reason.text);
    }
}

static void print_tree(const struct row *row)
{
    if (row->options.tree)
        printf("tree: %s", row->options.tree->name);
    else
        printf("tree: %s, leaf %u", row->options.builder->name, row->options.build.leaf);
    printf(": %u nodes, %u leaves, depth %u, largest leaf %u\n", row->stats.node_count,
           row->stats.leaf_count, row->stats.depth, row->stats.largest_leaf);
}

void check_print(const struct check_scene *scene)
{
    const struct row *first = scene->row_count ? &scene->row[0] : NULL;
    printf("%s: %u triangles, %u vertices; %zu rays, set %s, seed %llu\n", scene->spec,
           scene->tri_count, scene->vertex_count, scene->ray_count, scene->rays,
           (unsigned long long)scene->seed);
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->row[i].status == ROW_OK && scene->row[i].layout) {
            first = &scene->row[i];
            break;
        }
    if (first)
        print_tree(first);
    if (first && first->compared)
        printf("truth: exact, by the oracle's tree; %zu of %zu rays by brute force too\n",
               first->brute, first->compared);
    printf("%-13s %-13s %-7s %-7s %-7s %9s %9s %7s %5s %5s %5s %5s %5s %5s %5s %5s %5s %6s %6s "
           "%8s\n",
           "layout", "engine", "box", "tri", "query", "nodes kB", "items kB", "hits", "tie", "near",
           "bound", "bordr", "plane", "slab", "noise", "out", "err/E", "WRONG", "bits",
           "Mray/s (least-most)");
    for (size_t i = 0; i < scene->row_count; i++)
        print_row(&scene->row[i]);
    for (size_t i = 0; i < scene->row_count; i++)
        print_findings(scene, &scene->row[i]);
    puts("what it means");
    print_reasons(scene);
    print_winners(scene);
    print_stored(scene);
    check_print_moved(scene);
    print_originals(scene);
    print_agreement(scene);
    putchar('\n');
}

int check_exit(const struct check_scene *scene, bool layout_named, bool engine_named)
{
    int code = is_idle(scene) || idle_store(scene) ? EXIT_USAGE : EXIT_AGREE;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (row->status == ROW_REFUSED && !row->declined && layout_named)
            code = exit_worse(code, EXIT_USAGE);
        if (row->status == ROW_SKIPPED && engine_named)
            code = exit_worse(code, EXIT_SKIPPED);
        if (row->status == ROW_FAILED)
            code = exit_worse(code, row->cause == STATUS_MEMORY || row->cause == STATUS_INTERNAL
                                        ? EXIT_INTERNAL
                                        : EXIT_ENGINE);
        if (row_failed(row))
            code = exit_worse(code, EXIT_MISMATCH);
    }
    return code;
}

int check_unused(float displacement, const struct check_scene *scene, size_t count)
{
    bool used = displacement == 0.0f, one = false;
    for (size_t s = 0; s < count; s++)
        for (size_t i = 0; i < scene[s].row_count; i++) {
            one = one || scene[s].row[i].status == ROW_OK;
            used = used || scene[s].row[i].unknown;
        }
    if (used || !one)
        return EXIT_AGREE;
    return usage_error("check", "--displacement: no engine here has an unknown formula");
}

enum status check_add_row(struct check_scene *result, const struct row *row)
{
    size_t capacity = result->row_count; /* grows one by one, since rows are few */
    void *rows = result->row;
    enum status status = array_reserve(&rows, &capacity, result->row_count + 1, sizeof *row);
    if (status)
        return status;
    result->row = rows;
    result->row[result->row_count++] = *row;
    return STATUS_OK;
}
