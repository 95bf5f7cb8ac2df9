/* Rays that start on a surface: how far an origin must be moved, and what moving it costs. */
#include "cmd/bench/cmd_bench_spawn.h"

#include "ref/base/command.h"
#include "scenes/rays/rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OWN_RAYS 50000
/* Below this many ray-triangle pairs per row, brute force finds the truth; above, the oracle's own
 * tree is faster. */
#define BRUTE_PAIRS 200000000u

static const struct spawn_place {
    double scale, far;
} places[] = {{1e-3, 0}, {1, 0}, {1e3, 0}, {1e6, 0}, {1, 1e3}, {1, 1e6}};

/* One block being measured. */
struct spawn_field {
    struct bench *bench;
    const struct scene *scene;
    struct oracle *oracle;
    struct topology topology;
    struct bvh bvh;
    struct race race;
    struct spawn_hit *hit;
    struct spawn_near *near;
    float (*origin)[3]; /* one array of hit_count per row */
    double *steps[SPAWN_POINTS];
    struct known_rays known; /* of the current row, as is `answer` */
    struct hit *answer;
    size_t hit_count;
};

static float (*origins_of(const struct spawn_field *field, size_t row))[3]
{
    return field->origin + row * field->hit_count;
}

static const double constants[SPAWN_RULES] = {
    [RULE_NONE] = 0, [RULE_CONST_5] = 1e-5, [RULE_CONST_4] = 1e-4, [RULE_CONST_3] = 1e-3};

/* Makes all origins of one hit. Returns the distance of the farthest. */
static double move_origins(const struct spawn_field *field, size_t i)
{
    const struct spawn_hit *hit = &field->hit[i];
    double reach = 0;
    for (int point = 0; point < SPAWN_POINTS; point++) {
        float p[3], error[3];
        spawn_point_make(hit, field->scene, (enum spawn_point)point, p, error);
        for (int rule = 0; rule < SPAWN_RULES; rule++) {
            float *out = origins_of(field, (size_t)(point * SPAWN_RULES + rule))[i];
            if (rule == RULE_BOUND) {
                spawn_bound(p, error, hit->normal, out);
            } else if (rule == RULE_INTEGER) {
                spawn_integer(p, hit->normal, out);
            } else if (rule == RULE_LEAST) {
                uint32_t steps = spawn_least(field->oracle, field->scene, hit, p, out);
                field->steps[point][i] = steps == SPAWN_NEVER ? NAN : (double)steps;
            } else {
                spawn_constant(p, hit->normal, (float)constants[rule], out);
            }
            reach = fmax(reach, spawn_offset(hit, out));
        }
    }
    return reach;
}

static void add_fate(struct spawn_count *count, const struct spawn_fate *fate)
{
    count->self += fate->self;
    count->beside += fate->beside;
    count->skipped += fate->skipped;
}

/* Makes the rays of one row and counts their exact outcomes. */
static enum status exact_row(struct spawn_field *field, size_t index, struct spawn_row *row,
                             struct reason *reason)
{
    float(*origin)[3] = origins_of(field, index);
    for (size_t i = 0; i < field->hit_count; i++)
        field->known.ray[i] = spawn_ray(&field->hit[i], origin[i]);
    enum status status = known_decide(field->oracle, field->scene, field->bench->engines.threads,
                                      BRUTE_PAIRS, &field->known, reason);
    for (size_t i = 0; i < field->hit_count && status == STATUS_OK; i++) {
        struct spawn_fate fate =
            spawn_fate_exact(field->oracle, field->scene, &field->topology, &field->hit[i],
                             &field->near[i], origin[i], &field->known.truth[i]);
        add_fate(&row->exact, &fate);
        row->near += fate.near;
    }
    return status;
}

static enum status engine_row(const struct spawn_field *field, size_t index, size_t judge,
                              struct spawn_row *row, struct reason *reason)
{
    const struct contestant *c = &field->race.contestant[judge];
    float(*origin)[3] = origins_of(field, index);
    struct trace_report report;
    enum status status = known_trace(&field->known, c, field->answer, &report, reason);
    for (size_t i = 0; i < field->hit_count && status == STATUS_OK; i++) {
        struct spawn_fate fate =
            spawn_fate_answer(field->scene, &field->topology, &field->hit[i], &field->near[i],
                              origin[i], field->answer[i].prim);
        add_fate(&row->engine[judge], &fate);
    }
    return status;
}

/* Computes the quantiles of one row's offsets and steps. Errors: STATUS_MEMORY. */
static enum status take_sizes(const struct spawn_field *field, size_t index, struct spawn_row *row,
                              struct reason *reason)
{
    float(*origin)[3] = origins_of(field, index);
    double *value = alloc_zeroed(field->hit_count, sizeof *value);
    if (!value)
        return fail(reason, STATUS_MEMORY, "no memory for %zu offsets", field->hit_count);
    for (size_t i = 0; i < field->hit_count; i++)
        value[i] = spawn_offset(&field->hit[i], origin[i]);
    row->offset = quantiles_of(value, field->hit_count);
    row->steps = (struct quantiles){0, NAN, NAN, NAN};
    if (row->rule == RULE_LEAST) {
        for (size_t i = 0; i < field->hit_count; i++)
            value[i] = field->steps[row->point][i];
        row->steps = quantiles_of(value, field->hit_count);
        row->never = field->hit_count - row->steps.count;
    }
    free(value);
    return STATUS_OK;
}

/* Makes the hits of `count` rays of a set. There are fewer hits than rays. */
static enum status make_hits(struct spawn_field *field, const struct ray_set *set, size_t count,
                             struct reason *reason)
{
    struct known_rays primary;
    enum status status = known_alloc(count, &primary, reason);
    field->hit = alloc_zeroed(count, sizeof *field->hit);
    if (status == STATUS_OK && !field->hit)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    if (status == STATUS_OK)
        status = ray_set_make(set, field->scene, field->bench->seed, count, primary.ray, reason);
    if (status == STATUS_OK)
        status = oracle_closest(field->oracle, ORACLE_AUTO, ORACLE_CLOSED, primary.ray, count,
                                field->bench->engines.threads, primary.truth, NULL, reason);
    for (size_t i = 0; i < count && status == STATUS_OK; i++) {
        struct rng rng = rng_make(field->bench->seed, 1000 + i);
        if (spawn_hit_make(field->oracle, field->scene, tri_tests[0], &primary.ray[i],
                           &primary.truth[i], &rng, &field->hit[field->hit_count]))
            field->hit_count++;
    }
    known_free(&primary);
    return status;
}

/* Makes the origins of all rules, and finds the nearest surface of each hit. */
static enum status make_origins(struct spawn_field *field, size_t *undecided, struct reason *reason)
{
    size_t count = field->hit_count, open = 0;
    field->near = alloc_zeroed(count, sizeof *field->near);
    field->origin = alloc_zeroed(count * SPAWN_POINTS * SPAWN_RULES, sizeof *field->origin);
    field->answer = alloc_zeroed(count, sizeof *field->answer);
    bool all =
        !known_alloc(count, &field->known, reason) && field->near && field->origin && field->answer;
    for (int point = 0; point < SPAWN_POINTS; point++) {
        field->steps[point] = alloc_zeroed(count, sizeof *field->steps[point]);
        all = all && field->steps[point];
    }
    if (!all)
        return fail(reason, STATUS_MEMORY, "no memory for %zu origins", count);
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : open)
    for (long long i = 0; i < (long long)count; i++) {
        double reach = move_origins(field, (size_t)i);
        field->near[i] = spawn_near_find(field->scene, &field->hit[i], reach);
        open += field->near[i].undecided;
    }
    *undecided = open;
    return STATUS_OK;
}

static enum status play_rows(struct spawn_field *field, struct spawn_block *block,
                             struct reason *reason)
{
    for (size_t i = 0; i < (size_t)SPAWN_POINTS * SPAWN_RULES; i++) {
        struct spawn_row *row = &block->row[i];
        row->point = (enum spawn_point)(i / SPAWN_RULES);
        row->rule = (enum spawn_rule)(i % SPAWN_RULES);
        progress_done(&field->bench->progress, i, (uint64_t)SPAWN_POINTS * SPAWN_RULES,
                      "this table");
        progress_step(&field->bench->progress, "%s, scale %g, offset %g: %s", block->scene,
                      block->scale, block->far, spawn_rule_name(row->rule));
        enum status status = exact_row(field, i, row, reason);
        if (status == STATUS_OK)
            status = take_sizes(field, i, row, reason);
        for (size_t judge = 0; judge < block->judge_count && status == STATUS_OK; judge++)
            status = engine_row(field, i, judge, row, reason);
        if (status)
            return status;
    }
    return STATUS_OK;
}

static void field_free(struct spawn_field *field)
{
    race_leave(&field->race);
    for (int point = 0; point < SPAWN_POINTS; point++)
        free(field->steps[point]);
    free(field->hit);
    free(field->near);
    free(field->origin);
    free(field->answer);
    known_free(&field->known);
    topology_free(&field->topology);
    bvh_free(&field->bvh);
    oracle_free(field->oracle);
}

/* Writes a judge's name: "embree_robust", "cpu mt", "cpu rf16 mt". */
static void name_judge(const struct contestant *c, char *text, size_t text_bytes)
{
    bool own = c->layout || c->engine->brute;
    bool base = !c->layout || c->layout == layouts[0];
    snprintf(text, text_bytes, "%s%s%s%s%s", c->engine->name, base ? "" : " ",
             base ? "" : c->layout->name, own ? " " : "", own ? c->tri->name : "");
}

static enum status play_block(struct bench *bench, const struct scene *scene,
                              const struct ray_set *set, struct spawn_block *block,
                              struct reason *reason)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    static struct spawn_field field;
    field = (struct spawn_field){.bench = bench,
                                 .scene = scene,
                                 .race = {.bench = bench,
                                          .label = block->scene,
                                          .scene = scene,
                                          .bvh = &field.bvh,
                                          .own_engines = "cpu embree_robust",
                                          .own_layouts = "f32"}};
    enum status status = oracle_make(scene, &field.oracle, reason);
    if (status == STATUS_OK)
        status = topology_make(scene, &field.topology, reason);
    if (status == STATUS_OK)
        status = builders[0]->build(scene, &build, &field.bvh, reason);
    if (status == STATUS_OK) {
        race_enter(&field.race);
        block->judge_count =
            field.race.count < SPAWN_JUDGES ? field.race.count : (size_t)SPAWN_JUDGES;
        for (size_t i = 0; i < block->judge_count; i++)
            name_judge(&field.race.contestant[i], block->judge[i], sizeof block->judge[i]);
        status = make_hits(&field, set, block->ray_count, reason);
    }
    if (status == STATUS_OK)
        status = make_origins(&field, &block->undecided, reason);
    block->hit_count = field.hit_count;
    if (status == STATUS_OK)
        status = play_rows(&field, block, reason);
    progress_end(&bench->progress);
    if (status == STATUS_OK)
        spawn_print(bench, block);
    if (status == STATUS_OK && block->hit_count == 0) {
        puts("vacuous: no ray hits anything");
        bench_worse(bench, EXIT_MISMATCH);
    }
    field_free(&field);
    return status;
}

/* Makes a copy of `from`: scaled, then moved by `far` times its new size along all axes, and
 * rounded to float32 as in a user's file of a scene at that place. */
static enum status place_scene(const struct scene *from, const struct spawn_place *place,
                               struct scene *out, struct reason *reason)
{
    struct box box = scene_bounds(from);
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, (double)box.hi[k] - (double)box.lo[k]);
    if (scene_make(from->vertex_count, from->tri_count, out))
        return fail(reason, STATUS_MEMORY, "no memory for a moved scene");
    for (size_t i = 0; i < 3 * (size_t)from->vertex_count; i++)
        out->vertex[i] = (float)(place->scale * ((double)from->vertex[i] + place->far * size));
    memcpy(out->index, from->index, 3 * (size_t)from->tri_count * sizeof *out->index);
    enum status status = scene_check(out, reason);
    if (status)
        scene_free(out);
    return status;
}

static enum status play_scene(struct bench *bench, const char *spec, const struct scene *scene,
                              struct reason *reason)
{
    static const char *const own[] = {"random", NULL};
    static struct spawn_block block;
    const void *sets[LIST_MOST];
    size_t count = bench_members(TABLE_RAY_SETS, &bench->rays, own, sets);
    enum status status = STATUS_OK;
    for (size_t p = 0; p < ARRAY_COUNT(places) && status == STATUS_OK; p++) {
        struct scene placed;
        status = place_scene(scene, &places[p], &placed, reason);
        for (size_t s = 0; s < count && status == STATUS_OK; s++) {
            const struct ray_set *set = sets[s];
            struct reason why = {""};
            block = (struct spawn_block){.scene = spec,
                                         .rays = set->name,
                                         .scale = places[p].scale,
                                         .far = places[p].far,
                                         .tri_count = scene->tri_count,
                                         .ray_count = bench_rays_count(bench, OWN_RAYS)};
            bench_failed(bench, spec, play_block(bench, &placed, set, &block, &why), &why);
            fflush(stdout);
        }
        scene_free(&placed);
    }
    return status;
}

static const char about[] =
    "rays leave the points that other rays hit. Points are computed in float32, as o+td "
    "(o + t d) and bary ((1 - u - v) v0 + u v1 + v v2), with t, u, v of the triangle "
    "test mt; then moved along the face's normal n, by one of these rules:\n"
    "  none      not at all\n"
    "  1e-5 ..   a constant distance, whatever the scale\n"
    "  bound     |n| . e with e the proven error of the point, then one float further: "
    "pbrt's OffsetRayOrigin (Pharr, Jakob, Humphreys: Physically Based Rendering, "
    "\"Managing Rounding Error\")\n"
    "  integer   256 n floats per coordinate, n / 65536 below 1/32 (Waechter, Binder: A "
    "Fast and Robust Method for Avoiding Self-Intersection, Ray Tracing Gems, chapter "
    "6)\n"
    "  least     the fewest steps along n, each one float of the largest coordinate, "
    "that free the exact ray from its own triangle; an engine's rounding may need more\n"
    "Counted per million hits, exactly (ref/oracle) and as engines answer (tmin is 0), "
    "by the first triangle that the moved ray hits:\n"
    "  self      it is the one that the ray left\n"
    "  beside    it touches that one, and the exact ray from the exact point misses it\n"
    "  skip      that exact ray meets a surface nearer than the origin was moved, and "
    "the moved ray first hits neither it nor a triangle that touches it: light leaks in\n"
    "<x: none of N, at most 3/N with 95 % confidence. The scene is scaled (scale), then "
    "moved away from the origin by so many of its sizes (far), and its vertices rounded "
    "to float32.\n"
    "";

const struct benchmark bench_spawn = {
    .name = "spawn",
    .shown = "rays that hit their own surface are counted, not judged",
    .refuted = "no ray hits anything",
    .summary = "rays that start on a surface: self-hits and skipped surfaces of offset rules",
    .takes =
        "scene count rounds csv json seed engine layout tri box rays" BENCH_MACHINE BENCH_OUTSIDE
            BENCH_SCREEN,
    .about = about,
    .scenes = "soup:n=400,size=0.7;cornell",
    .play = play_scene,
};
