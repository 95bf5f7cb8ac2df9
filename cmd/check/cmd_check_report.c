/* Output of raydiff check: the findings and a summary. */
#include "cmd/check/cmd_check.h"

#include "cmd/common/cmd_finding.h"
#include "ref/base/command.h"
#include "ref/store.h"
#include "ref/base/text.h"

#include <string.h>

struct finding_of check_finding_of(const struct check_scene *scene)
{
    return (struct finding_of){.spec = scene->spec,
                               .seed = scene->seed,
                               .driver = scene->driver,
                               .set = {scene->rays, scene->ray_count}};
}

static void print_findings(const struct check_scene *scene, const struct row *row,
                           const struct screen *screen)
{
    const struct finding_of of = check_finding_of(scene);
    const size_t all[] = {row->judged ? row->count[VERDICT_WRONG] : 0, row->bit_differences};
    for (int bits = 0; bits < 2; bits++) {
        size_t shown = 0;
        for (size_t i = 0; i < row->finding_count; i++)
            if (row->finding[i].bits == (bits == 1)) {
                finding_print(screen, row, &row->finding[i], &of, shown == 0);
                shown++;
            }
        if (shown && all[bits] > shown)
            printf("  ... and %zu more of this row that %s%s%s\n", all[bits] - shown,
                   bits ? "differ from engine " : "are WRONG", bits ? row->against->name : "",
                   bits ? "'s" : "");
    }
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
static void print_stored(const struct check_scene *scene, const struct screen *screen)
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
        screen_text(
            screen,
            "  %s: %.2f bytes a triangle: %.2f nodes, %.2f storage, %.2f the scene's arrays\n",
            stored_name(row->layout, row->options.store, text),
            (double)(row->node_bytes + row->item_bytes + row->scene_bytes) / tris,
            (double)row->node_bytes / tris, (double)row->item_bytes / tris,
            (double)row->scene_bytes / tris);
    }
}

/* For rows on a decoded scene, prints how their answers fit the original. */
static void print_originals(const struct check_scene *scene, const struct screen *screen)
{
    char text[STORED_NAME_MOST];
    bool first = true;
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        const size_t judged = row->original.judged;
        if (row->status != ROW_OK || judged == 0)
            continue;
        if (first)
            screen_text(screen,
                        "  decoded from %u %s: vertices moved by %s at most, certified; %u "
                        "triangles without area\n",
                        scene->quantised.grid.bits, scene->lossy->told,
                        BOUND(scene->quantised.distance), scene->flat);
        first = false;
        screen_text(
            screen,
            "  %s on %s %s: WRONG decoded %zu, beyond what moved %zu; for the original, of a "
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
static void print_winners(const struct check_scene *scene, const struct screen *screen)
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
            screen_text(
                screen,
                "  %s on %s: %.2f of f32's node bytes (%.2f with f32's item array), %.2f times "
                "its speed%s\n",
                stored_name(row->layout, row->options.store, text), players[p],
                (double)row->node_bytes / (double)base->node_bytes,
                (double)(row->node_bytes + row->item_bytes) /
                    (double)(base->node_bytes + base->item_bytes),
                row->mrays[0] / base->mrays[0],
                check_speeds_differ(row, base) ? "" : ", within noise");
        }
    }
    const struct row *cpu = row_of(scene, "cpu", NULL);
    for (size_t i = 0; i < scene->row_count && cpu; i++) {
        const struct row *row = &scene->row[i];
        if (row->status == ROW_OK && !row->layout && row->mrays[0] > 0 && row->engine->library &&
            row->options.query == cpu->options.query)
            screen_text(screen, "  cpu on %s: %.2f times the speed of %s\n", cpu->layout->name,
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

/* Sums over the rows that ran. */
struct agreement {
    size_t exact_rows, exact_rays, exact_bad; /* rows that must have the bits of engine cpu */
    size_t same_rows, same_rays, same_bad;    /* or of the engine with the shaders as built */
    size_t judged, counted;                   /* answers judged; wrong ones of published members */
    size_t count[VERDICT_COUNT], wrong[WRONG_COUNT];
};

static struct agreement agreement_of(const struct check_scene *scene)
{
    struct agreement sum = {0};
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (row->status != ROW_OK)
            continue;
        if (row->bits && row->compiled.words > 0) {
            sum.same_rows++;
            sum.same_rays += row->rays;
            sum.same_bad += row->bit_differences;
        } else if (row->bits && !row->engine->reference) {
            sum.exact_rows++;
            sum.exact_rays += row->rays;
            sum.exact_bad += row->bit_differences;
        }
        if (!row->judged) {
            sum.counted += row->count[VERDICT_WRONG];
            continue;
        }
        sum.judged += row->rays;
        for (enum verdict v = 0; v < VERDICT_COUNT; v++)
            sum.count[v] += row->count[v];
        for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
            sum.wrong[w] += row->wrong[w];
    }
    return sum;
}

/* Prints both lists of counters; those of 0 only if the screen is wide. */
static void print_verdicts(const struct agreement *sum, const struct screen *screen)
{
    char text[1024];
    size_t at = 0;
    const char *between = " (";
    for (enum wrong w = WRONG_MISSED; w < WRONG_COUNT; w++)
        if (sum->wrong[w] || screen->wide) {
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s %zu", between, wrong_name(w),
                                   sum->wrong[w]);
            between = ", ";
        }
    screen_text(screen, "  against the exact truth: %zu of %zu answers WRONG%s%s\n",
                sum->count[VERDICT_WRONG], sum->judged, at ? text : "", at ? ")" : "");
    at = 0;
    between = " ";
    for (enum verdict v = VERDICT_RIGHT + 1; v < VERDICT_WRONG; v++)
        if (sum->count[v] || screen->wide) {
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s %zu", between,
                                   verdict_name(v), sum->count[v]);
            between = ", ";
        }
    screen_text(screen, "  right %zu; allowed:%s\n", sum->count[VERDICT_RIGHT],
                at ? text : " none");
}

static void print_agreement(const struct check_scene *scene, const struct screen *screen)
{
    const struct agreement sum = agreement_of(scene);
    if (is_idle(scene))
        puts("  nothing was played: no engine has anything to play on");
    else if (idle_store(scene))
        printf("  storage %s was played on no layout\n", idle_store(scene)->name);
    if (sum.exact_rows)
        screen_text(screen, "  bit for bit against cpu: %zu of %zu answers differ\n", sum.exact_bad,
                    sum.exact_rays);
    if (sum.same_rows)
        screen_text(screen,
                    "  bit for bit against the shaders as built: %zu of %zu answers differ\n",
                    sum.same_bad, sum.same_rays);
    check_print_modes(scene, screen);
    print_verdicts(&sum, screen);
    if (sum.counted)
        screen_text(screen, "  members as published are wrong in %s: counted, not judged\n",
                    COUNTED(sum.counted, "answer"));
}

/* Name of the member that refused, was skipped or failed. */
static const char *subject_name(const struct row *row)
{
    if (row->status == ROW_REFUSED && row->layout && !row->declined)
        return row->layout->name;
    return row->engine ? row->engine->name : "--layout auto";
}

static bool traces_scenes_only(const struct row *row)
{
    return row->of_world && row->engine && !row->engine->worlds;
}

static void print_reasons(const struct check_scene *scene, const struct screen *screen)
{
    if (scene->scenes_only[0])
        screen_text(screen, "  %s: trace%s scenes, not worlds\n", scene->scenes_only,
                    strchr(scene->scenes_only, ',') ? "" : "s");
    for (const char *line = scene->refused; *line;) {
        size_t length = strcspn(line, "\n");
        screen_text(screen, "  --layout auto could not take %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        bool repeated = false;
        for (size_t k = 0; k < i; k++)
            repeated |= strcmp(scene->row[k].reason.text, row->reason.text) == 0;
        if (row->status == ROW_OK || repeated || traces_scenes_only(row))
            continue;
        /* The reason of a vacuous row begins with that word. */
        const char *status = row->status == ROW_VACUOUS ? "" : row_status_name(row->status);
        screen_text(screen, "  %s%s%s: %s\n", subject_name(row), *status ? " " : "", status,
                    row->reason.text);
    }
}

static void print_tree(const struct row *row)
{
    if (row->options.tree)
        printf("tree: %s", row->options.tree->name);
    else
        printf("tree: %s, leaf %u", row->options.builder->name, row->options.build.leaf);
    if (row->options.braid)
        printf(", braid %u", row->options.braid);
    printf(": %s, %s, depth %u, largest leaf %u\n", COUNTED(row->stats.node_count, "node"),
           COUNTED(row->stats.leaf_count, "leaf"), row->stats.depth, row->stats.largest_leaf);
}

void check_print(const struct check_scene *scene, const struct screen *screen)
{
    const struct row *first = scene->row_count ? &scene->row[0] : NULL;
    char instances[32] = "", modes[32] = "", after[STEP_TEXT_MOST + 32] = "";
    if (scene->modes) {
        snprintf(instances, sizeof instances, "%s, ", COUNTED(scene->instance_count, "instance"));
        snprintf(modes, sizeof modes, ", masks and flags %s", scene->modes);
    }
    if (scene->step > 0)
        snprintf(after, sizeof after, " after step %u, %s", scene->step, scene->after);
    screen_record(screen, PAINT_PLAIN, "%s%s: %s%s, %s; %s, set %s%s, seed %llu\n", scene->spec,
                  after, instances, COUNTED(scene->tri_count, "triangle"),
                  COUNTED(scene->vertex_count, "vertex"), COUNTED(scene->ray_count, "ray"),
                  scene->rays, modes, (unsigned long long)scene->seed);
    for (size_t i = 0; i < scene->row_count; i++)
        if (scene->row[i].status == ROW_OK && scene->row[i].layout) {
            first = &scene->row[i];
            break;
        }
    if (first && first->layout) /* else no engine here walks one */
        print_tree(first);
    if (first && first->compared)
        printf("truth: exact, by the oracle's tree; %zu of %zu rays by brute force too\n",
               first->brute, first->compared);
    if (screen->wide)
        check_print_wide(scene);
    else
        check_print_table(scene, screen);
    compilers_print(scene->row, scene->row_count, scene->spec, scene->driver, screen);
    for (size_t i = 0; i < scene->row_count; i++)
        print_findings(scene, &scene->row[i], screen);
    puts("what it means");
    print_reasons(scene, screen);
    print_winners(scene, screen);
    print_stored(scene, screen);
    check_print_moved(scene, screen);
    check_print_life(scene, screen);
    print_originals(scene, screen);
    print_agreement(scene, screen);
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
