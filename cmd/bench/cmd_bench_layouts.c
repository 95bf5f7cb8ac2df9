/* Compares layouts and engines on the same tree: speed, bytes, work and errors. */
#include "cmd/bench/cmd_bench_race.h"

#include "ref/base/command.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

/* Budget of ray-triangle tests by brute force for the error figures, per scene and ray set. */
#define BRUTE_BUDGET 100000000u
#define OWN_RAYS     262144

struct layouts_field {
    struct bench *bench;
    const char *spec, *rays;
    const struct scene *scene;
    const struct tree_file *tree; /* the user's, or NULL */
    size_t ray_count;
    struct match match;
    struct race race;
    struct row row[CONTESTANTS]; /* errors, from an untimed run */
    struct row_grid *grid;
    bool told; /* what is left out, of other rays */
};

static const struct column columns[] = {
    {"verdict", .left = true},
    {"layout", .left = true},
    {"engine", .left = true},
    {"rays", .left = true},
    {.title = "wrong"},
    {"allowed", .rank = 3},
    {"nodeB", .rank = 2},
    {"mem/tri", .rank = 4},
    {.title = "Mray/s", .least = TIME_WIDTH},
    {"ratio", .rank = 1, .least = 5},
    {"of", .left = true, .rank = 1},
    {"least-most", .rank = 5, .least = 2 * TIME_WIDTH + 1},
    {"+items", .rank = 6},
};

/* Named engines, and beside those under a compiler the ones with the shaders as built; without
 * names, all but the reference without a tree: its time depends on the triangles, not on a
 * layout. */
static bool takes_part(const struct layouts_field *field, const struct engine *engine)
{
    const struct list *named = &field->bench->engine;
    if (named->count == 0)
        return !(engine->reference && !engine->needs_packed);
    for (size_t i = 0; i < named->count; i++) {
        const struct engine *one = engines[named->index[i]];
        if (one == engine || (one->compiled && one->compiled->raw == engine))
            return true;
    }
    return false;
}

/* Named, or without --layout one of layouts[]; but RTRS's as published test every node, so that
 * speed cannot be compared. */
static bool takes_layout(const struct layouts_field *field, size_t l, bool core)
{
    const struct list *named = &field->bench->layout;
    return named->count ? list_has(named, l) : core && !layouts_all[l]->faithful;
}

/* Enters one, or says why it is left out. */
static enum status enter_one(struct layouts_field *field, const struct engine *engine,
                             const struct layout *layout)
{
    struct reason reason = {""};
    const struct contestant who = {.engine = engine,
                                   .layout = layout,
                                   .box = field->match.options.box,
                                   .tri = field->match.options.tri};
    enum status status = race_add(&field->race, &who, &field->bench->engines, &reason);
    if (status && !field->told)
        screen_text(&field->bench->screen_is, "%-14s %-12s left out: %s\n", engine->name,
                    layout ? layout->name : "-", reason.text);
    return status;
}

/* Enters an engine on every layout that it takes. Named and on none, it counts. */
static void enter_engine(struct layouts_field *field, const struct engine *engine)
{
    size_t before = field->race.count;
    enum status status = engine->needs_packed ? STATUS_OK : enter_one(field, engine, NULL);
    bool core = true; /* layouts_all begins with layouts */
    for (size_t l = 0; layouts_all[l] && engine->needs_packed; l++) {
        core = core && layouts[l];
        if (!takes_layout(field, l, core))
            continue;
        enum status one = enter_one(field, engine, layouts_all[l]);
        status = one ? one : status;
    }
    if (field->race.count == before && status && option_was_given("engine"))
        bench_worse(field->bench, exit_of_status(status));
}

static bool is_entered(const struct race *race, const struct layout *layout)
{
    for (size_t i = 0; i < race->count; i++)
        if (race->contestant[i].layout == layout)
            return true;
    return false;
}

/* Enters all that can run here and hold the scene. A named layout that none can take counts. */
static void enter_all(struct layouts_field *field)
{
    const struct list *named = &field->bench->layout;
    for (size_t e = 0; engines[e]; e++)
        if (takes_part(field, engines[e]))
            enter_engine(field, engines[e]);
    for (size_t i = 0; i < named->count; i++)
        if (!is_entered(&field->race, layouts_all[named->index[i]]))
            bench_worse(field->bench, EXIT_USAGE);
}

/* Counts every contestant's errors with the match's judge. */
static void judge_all(struct layouts_field *field)
{
    for (size_t i = 0; i < field->race.count; i++) {
        const struct contestant *c = &field->race.contestant[i];
        struct reason reason;
        if (c->layout && match_pack(&field->match, c->layout, &reason))
            continue;
        match_run(&field->match, c->engine, &field->row[i]);
        if (field->row[i].status == ROW_FAILED)
            bench_worse(field->bench, EXIT_ENGINE);
        if (row_failed(&field->row[i]))
            bench_worse(field->bench, EXIT_MISMATCH);
    }
}

/* Of what has neither a layout nor a tree of its own, 0 is what is not known. */
static json_t *bytes_json(const struct contestant *c, uint64_t bytes)
{
    return c->layout || c->engine->own_tree ? json_integer((json_int_t)bytes) : json_known(bytes);
}

/* What the engine holds, over the triangles; "-" is not known. */
static const char *memory_text(const struct contestant *c, double tris, char text[32])
{
    snprintf(text, 32, c->memory_bytes ? "%.1f" : "-", (double)c->memory_bytes / tris);
    return text;
}

static void write_row(struct layouts_field *field, size_t i, const struct spread *speed,
                      const struct spread *ratio, size_t allowed)
{
    const struct row *row = &field->row[i];
    const struct contestant *c = &field->race.contestant[i];
    const struct contestant *base = &field->race.contestant[c->base];
    json_t *out = json_record(
        "scene=%s triangles=%u rays=%s engine=%s layout=%s count=%zu rounds=%zu mrays_median=%g "
        "mrays_min=%g mrays_max=%g base_engine=%s base_layout=%s ratio_median=%g ratio_min=%g "
        "ratio_max=%g node_bytes=%p item_bytes=%p memory_bytes=%p differences=%zu allowed=%zu "
        "boxes_per_ray=%g tris_per_ray=%g",
        field->spec, field->scene->tri_count, field->rays, c->engine->name,
        c->layout ? c->layout->name : "-", field->ray_count, field->bench->rounds, speed->median,
        speed->least, speed->most, base->engine->name, base->layout ? base->layout->name : "-",
        ratio->median, ratio->least, ratio->most, bytes_json(c, row->node_bytes),
        bytes_json(c, row->item_bytes), json_known(c->memory_bytes), row->differences, allowed,
        (double)row->boxes / (double)field->ray_count,
        (double)row->tris / (double)field->ray_count);
    bench_row(field->bench, &bench_layouts, out);
}

/* The row of a table that fits the screen. */
static void add_contestant(struct layouts_field *field, size_t i, const struct spread *speed,
                           const struct spread *ratio, size_t allowed)
{
    const struct row *row = &field->row[i];
    struct contestant *c = &field->race.contestant[i];
    const bool wrong = row->differences > 0, vacuous = row->status == ROW_VACUOUS;
    double tris = field->scene->tri_count ? (double)field->scene->tri_count : 1.0;
    char nodes[32] = "-", all[32] = "-", memory[32];
    if (c->layout || c->engine->own_tree) {
        snprintf(nodes, sizeof nodes, "%.1f", (double)row->node_bytes / tris);
        snprintf(all, sizeof all, "%.1f", (double)(row->node_bytes + row->item_bytes) / tris);
    }
    grid_add(field->grid, wrong || vacuous ? PAINT_BAD : PAINT_GOOD,
             "%s\t%s\t%s\t%s\t%zu\t%zu\t%s\t%s\t%.3f\t%.2f\t%s\t%.3f-%.3f\t%s",
             wrong     ? "WRONG"
             : vacuous ? "vacuous"
                       : "agrees",
             c->layout ? c->layout->name : "-", c->engine->name, field->rays, row->differences,
             allowed, nodes, memory_text(c, tris, memory), speed->median, ratio->median,
             race_base_name(&field->race, c), speed->least, speed->most, all);
}

static void print_contestant(struct layouts_field *field, size_t i)
{
    size_t rounds = (size_t)field->bench->rounds;
    struct row *row = &field->row[i];
    struct contestant *c = &field->race.contestant[i];
    double tris = field->scene->tri_count ? (double)field->scene->tri_count : 1.0;
    struct spread speed = spread_of(c->mrays, rounds), ratio = spread_of(c->ratio, rounds);
    size_t allowed = row->rays - row->count[VERDICT_RIGHT] - row->count[VERDICT_WRONG];
    row->mrays[0] = speed.median; /* of the race, for the table of compilers */
    if (!field->bench->screen_is.wide) {
        add_contestant(field, i, &speed, &ratio, allowed);
        write_row(field, i, &speed, &ratio, allowed);
        return;
    }
    double node = (double)row->node_bytes / tris;
    char memory[32];
    double nodes = (double)(row->node_bytes + row->item_bytes) / tris;
    printf("%-8s %-13s %-5s %7.3f (%.3f-%.3f) %5.2f (%.2f-%.2f) of %-8s ", field->rays,
           c->engine->name, c->layout ? c->layout->name : "-", speed.median, speed.least,
           speed.most, ratio.median, ratio.least, ratio.most, race_base_name(&field->race, c));
    if (c->layout || c->engine->own_tree)
        printf("%6.1f %6.1f", node, nodes);
    else
        printf("%6s %6s", "-", "-");
    printf(" %8s %7zu %6zu\n", memory_text(c, tris, memory), row->differences, allowed);
    write_row(field, i, &speed, &ratio, allowed);
}

static enum status bench_rays(struct layouts_field *field, const struct ray_set *set,
                              struct reason *reason)
{
    struct match_options options = {
        .builder = field->tree ? &tree_file_builder : builders[0],
        .tree = field->tree,
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .box = box_tests[0],
        .tri = tri_tests[0],
        .query = QUERY_CLOSEST,
        .repeats = 1,
        .brute_budget = BRUTE_BUDGET,
    };
    struct pool pool = {.options = field->bench->engines};
    size_t count = bench_rays_count(field->bench, OWN_RAYS);
    struct ray *ray = alloc_zeroed(count, sizeof *ray);
    enum status status = ray ? STATUS_OK : STATUS_MEMORY;
    char label[120];
    snprintf(label, sizeof label, "%.80s, %s rays", field->spec, set->name);
    field->race = (struct race){
        .bench = field->bench, .label = label, .scene = field->scene, .bvh = &field->match.bvh};
    field->ray_count = count;
    field->rays = set->name;
    if (status == STATUS_OK)
        status = ray_set_make(set, field->scene, field->bench->seed, count, ray, reason);
    if (status == STATUS_OK)
        status = match_make(field->scene, ray, count, &options, &pool, &field->match, reason);
    if (status == STATUS_OK) {
        enter_all(field);
        judge_all(field);
        status = race_run(&field->race, QUERY_CLOSEST, ray, count, reason);
        progress_end(&field->bench->progress);
        for (size_t i = 0; i < field->race.count && status == STATUS_OK; i++)
            print_contestant(field, i);
        compilers_print(field->row, field->race.count, set->name, field->bench->engines.driver,
                        &field->bench->screen_is);
        race_leave(&field->race);
        match_free(&field->match);
    }
    pool_free(&pool);
    free(ray);
    return status;
}

static enum status play_scene(struct bench *bench, const char *spec, const struct scene *scene,
                              struct reason *reason)
{
    static const char *const sets[] = {"primary", "random", "bounce"};
    static struct layouts_field field;
    struct tree_file tree;
    char name[BENCH_TREE_NAME];
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    enum status status = bench_tree_open(bench, scene, &tree, reason);
    if (status)
        return status;
    putchar('\n');
    screen_text(&bench->screen_is, "%s: %s; %s, box %s, triangle %s; %s, %s interleaved\n", spec,
                COUNTED(scene->tri_count, "triangle"), bench_tree_name(bench, name),
                box_tests[0]->name, tri_tests[0]->name,
                COUNTED(bench_rays_count(bench, OWN_RAYS), "ray"), COUNTED(bench->rounds, "round"));
    if (bench->screen_is.wide)
        puts(
            "rays     engine        nodes Mray/s (least-most)   ratio (least-most)           nodeB "
            "+items  mem/tri   wrong  named");
    for (size_t s = 0; s < ARRAY_COUNT(sets); s++) {
        struct reason why = {""};
        field = (struct layouts_field){.bench = bench,
                                       .spec = spec,
                                       .scene = scene,
                                       .tree = bench->bvh ? &tree : NULL,
                                       .grid = &grid,
                                       .told = s > 0};
        bench_failed(bench, spec, bench_rays(&field, ray_set_find(sets[s]), &why), &why);
    }
    if (!bench->screen_is.wide)
        grid_print(&grid, &bench->screen_is);
    tree_file_free(&tree);
    return STATUS_OK;
}

const struct benchmark bench_layouts = {
    .name = "layouts",
    .shown = "no answer is WRONG",
    .refuted = "an answer is WRONG, or no ray hits anything",
    .summary = "engines and layouts: speed, bytes, memory, errors on the same tree",
    .takes = "scene count rounds csv json seed bvh engine layout" BENCH_MACHINE BENCH_SCREEN
        BENCH_COMPILERS,
    .scenes = "sphere:n=50;terrain:k=6;scenes/fetched/dragon-11k.ply.gz",
    .play = play_scene,
};
