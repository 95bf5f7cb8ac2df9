/* The paper's performance table: its lines, the check of a frame of each, and the measurement. */
#include "cmd/bench/cmd_bench_paper.h"

#include "ref/base/command.h"

#include <math.h>
#include <string.h>

#define SLOW_MS     100.0
#define SLOW_FRAMES 9u
#define BOUNCES     4u
#define TILE        16u

/* The members of a line, by name. */
static const struct frames_recipe {
    const char *name, *engine, *layout, *builder;
    uint32_t leaf;
    const char *box, *tri;
    enum profile profile;
    enum frame_plan plan;
    enum paper_line_id other; /* line that its ratio is relative to */
} recipes[LINE_COUNT] = {
#define PUBLISHED(name, layout, leaf, box, plan, other)                                            \
    {                                                                                              \
        name, "vulkan", layout, "rtrs", leaf, box, "mt_rtrs", PROFILE_RTRS, plan, other            \
    }
#define REPAIRED(name, layout, leaf, plan, other)                                                  \
    {                                                                                              \
        name, "vulkan", layout, "median", leaf, "robust", "mt", PROFILE_REPAIRED, plan, other      \
    }
#define NO_TREE(name, engine, tri, profile, plan, other)                                           \
    {                                                                                              \
        name, engine, NULL, NULL, 0, "robust", tri, profile, plan, other                           \
    }
    [LINE_DIRECT] =
        PUBLISHED("direct, leaf 2", "rtrs_direct", PAPER_LEAF_DIRECT, "rtrs", FRAME_STEPS, LINE_RF),
    [LINE_RF] = PUBLISHED("RF, leaf 4", "rtrs_rf", PAPER_LEAF_RF, "rtrs", FRAME_STEPS, LINE_RF),
    [LINE_DIRECT_4] =
        PUBLISHED("direct, leaf 4", "rtrs_direct", PAPER_LEAF_RF, "rtrs", FRAME_STEPS, LINE_RF),
    [LINE_NAIVE] = NO_TREE("naive", "vulkan_brute", "mt_rtrs", PROFILE_RTRS, FRAME_STEPS, LINE_RF),
    [LINE_BLANK] = PUBLISHED("blank", "rtrs_rf", PAPER_LEAF_RF, "rtrs", FRAME_STEPS, LINE_RF),
    [LINE_EMBREE] =
        NO_TREE("embree, published look", "embree", "mt", PROFILE_RTRS, FRAME_AUTO, LINE_RF),
    [LINE_DIRECT_WHOLE] = PUBLISHED("direct, leaf 2, whole", "rtrs_direct", PAPER_LEAF_DIRECT,
                                    "rtrs", FRAME_WHOLE, LINE_RF_WHOLE),
    [LINE_RF_WHOLE] =
        PUBLISHED("RF, leaf 4, whole", "rtrs_rf", PAPER_LEAF_RF, "rtrs", FRAME_WHOLE, LINE_RF),
    [LINE_DIRECT_CULLS] = PUBLISHED("direct, leaf 2, culling", "rtrs_direct", PAPER_LEAF_DIRECT,
                                    "robust", FRAME_STEPS, LINE_RF_CULLS),
    [LINE_RF_CULLS] =
        PUBLISHED("RF, leaf 4, culling", "rtrs_rf", PAPER_LEAF_RF, "robust", FRAME_STEPS, LINE_RF),
    [LINE_F32_2] = REPAIRED("f32, leaf 2", "f32", 2, FRAME_STEPS, LINE_RF16_4),
    [LINE_RF16_4] = REPAIRED("rf16, leaf 4", "rf16", 4, FRAME_STEPS, LINE_RF16_4),
    [LINE_F32_4] = REPAIRED("f32, leaf 4", "f32", 4, FRAME_STEPS, LINE_RF16_4),
    [LINE_RF16_2] = REPAIRED("rf16, leaf 2", "rf16", 2, FRAME_STEPS, LINE_F32_2),
    [LINE_NAIVE_MT] = NO_TREE("naive, repaired", "vulkan_brute", "mt", PROFILE_REPAIRED,
                              FRAME_STEPS, LINE_RF16_4),
    [LINE_EMBREE_MT] =
        NO_TREE("embree, repaired look", "embree", "mt", PROFILE_REPAIRED, FRAME_AUTO, LINE_RF16_4),
    [LINE_F32_2_WHOLE] = REPAIRED("f32, leaf 2, whole", "f32", 2, FRAME_WHOLE, LINE_RF16_4_WHOLE),
    [LINE_RF16_4_WHOLE] = REPAIRED("rf16, leaf 4, whole", "rf16", 4, FRAME_WHOLE, LINE_RF16_4),
    [LINE_F32_4_WHOLE] = REPAIRED("f32, leaf 4, whole", "f32", 4, FRAME_WHOLE, LINE_RF16_4_WHOLE),
    [LINE_RF16_2_WHOLE] = REPAIRED("rf16, leaf 2, whole", "rf16", 2, FRAME_WHOLE, LINE_F32_2_WHOLE),
};

enum paper_line_id paper_line_other(enum paper_line_id id)
{
    return recipes[id].other;
}

const char *paper_line_name(enum paper_line_id id)
{
    return recipes[id].name;
}

bool paper_line_published(enum paper_line_id id)
{
    return recipes[id].profile == PROFILE_RTRS;
}

struct painter_plan paper_plan(const struct paper_table *table, enum paper_line_id id)
{
    const struct frames_recipe *recipe = &recipes[id];
    return (struct painter_plan){
        .handler = recipe->name,
        .engine = engine_find(recipe->engine),
        .layout = recipe->layout ? layout_find(recipe->layout) : NULL,
        .builder = recipe->builder ? builder_find(recipe->builder) : NULL,
        .build = {.leaf = recipe->leaf, .eps = PAPER_EPS},
        .box = box_test_find(recipe->box),
        .tri = tri_test_find(recipe->tri),
        .look = {.profile = recipe->profile, .bounces = BOUNCES, .ambience = 0.1f},
        .width = table->width,
        .height = table->height,
        .plan = recipe->plan,
        .tile = TILE,
        .blank = id == LINE_BLANK,
    };
}

/* Draws a frame with a temporary painter, not with the measured one. */
static enum status draw_once(const struct paper_table *table, const struct painter_plan *plan,
                             struct sheet *sheet, struct reason *reason)
{
    struct painter painter;
    struct frames_sample sample;
    enum status status =
        painter_open(plan, &table->scene->scene, &table->bench->engines, &painter, reason);
    if (!status)
        status = painter_sheet(&painter, 0, sheet, &sample, reason);
    painter_close(&painter);
    return status;
}

/* The engine whose frame the line must equal to the bit, with the same members: cpu, or brute force
 * for an engine without a tree. NULL for Embree, which has its own arithmetic. */
static const struct engine *peer_of(const struct painter_plan *plan)
{
    bool packed = plan->engine->needs_packed;
    return !packed && plan->engine->own_tri ? NULL : engine_reference(packed);
}

/* Compares a frame of the line with `truth` and its peer's frame, and sets table->slow. */
static enum status check_line(struct paper_table *table, enum paper_line_id id,
                              const struct sheet *truth, struct reason *reason)
{
    struct paper_line *line = &table->line[id];
    struct painter *painter = &table->session.painter[line->contestant];
    struct painter_plan plan = painter->plan;
    struct sheet drawn, expected;
    struct frames_sample first = {0}, second = {0};
    enum status status = sheet_make(&plan, &drawn, reason);
    if (status)
        return status;
    progress_step(&table->bench->progress, "%s: checking %s", table->scene->spec, plan.handler);
    status = painter_sheet(painter, 0, &drawn, &first, reason);
    if (!status) /* drawing the first may have compiled something */
        status = painter_draw(painter, 0, &second, reason);
    table->slow = table->slow || fmin(first.ms, second.ms) > SLOW_MS;
    line->wrong = plan.blank ? 0 : sheet_pixels_apart(&drawn, truth);
    plan.engine = peer_of(&plan);
    plan.waves = true;
    if (!status && plan.engine) {
        status = sheet_make(&plan, &expected, reason);
        if (!status)
            status = draw_once(table, &plan, &expected, reason);
        if (!status) {
            line->diff =
                frame_compare(&expected.frame, &drawn.frame, table->width, table->height, BOUNCES);
            line->checked = true;
        }
        sheet_free(&expected);
    }
    sheet_free(&drawn);
    return status;
}

/* The published shader visits every node, so a driver can cut whole paths short. That is a finding,
 * not a failure. */
static bool may_be_cut(enum paper_line_id id)
{
    return recipes[id].profile == PROFILE_RTRS && recipes[id].plan == FRAME_WHOLE;
}

/* Leaves out a line and closes its painter, which must be the last that was entered. */
static void leave_out(struct paper_table *table, enum paper_line_id id, enum status status,
                      const char *why)
{
    struct paper_line *line = &table->line[id];
    if (line->contestant < table->session.count)
        painter_close(&table->session.painter[--table->session.count]);
    line->contestant = SIZE_MAX;
    snprintf(line->why, sizeof line->why, "%s", why);
    if (status != STATUS_UNSUPPORTED && status != STATUS_LIMIT &&
        !(status == STATUS_DEVICE && may_be_cut(id)))
        bench_worse(table->bench, exit_of_status(status));
}

/* Draws the picture by brute force on the CPU, in the look of line `like`. */
static enum status draw_truth(const struct paper_table *table, enum paper_line_id like,
                              struct sheet *out, struct reason *reason)
{
    struct painter_plan plan = paper_plan(table, like);
    plan.engine = engine_reference(false);
    plan.layout = NULL;
    progress_step(&table->bench->progress, "%s: every triangle for every ray", table->scene->spec);
    enum status status = sheet_make(&plan, out, reason);
    return status ? status : draw_once(table, &plan, out, reason);
}

/* Enters a line and checks a frame of it. A line that cannot be drawn is left out with the
 * reason. */
static void enter_line(struct paper_table *table, enum paper_line_id id, const struct sheet *truth)
{
    struct paper_line *line = &table->line[id];
    struct painter_plan plan = paper_plan(table, id);
    struct reason reason = {""};
    line->contestant = table->session.count;
    progress_step(&table->bench->progress, "%s: preparing %s", table->scene->spec, plan.handler);
    enum status status = frames_session_enter(&table->session, &plan, &table->scene->scene,
                                              &table->bench->engines, &reason);
    if (!status) {
        line->tree = table->session.painter[line->contestant].tree;
        status = check_line(table, id, truth, &reason);
    }
    if (status)
        leave_out(table, id, status, reason.text);
}

static enum status enter_lines(struct paper_table *table, struct reason *reason)
{
    struct sheet truth[2] = {{.width = 0}};
    enum status status = draw_truth(table, LINE_NAIVE, &truth[0], reason);
    if (!status)
        status = draw_truth(table, LINE_NAIVE_MT, &truth[1], reason);
    for (enum paper_line_id id = 0; id < LINE_COUNT && !status; id++)
        if (frames_signal_code())
            leave_out(table, id, STATUS_UNSUPPORTED, "stopped by a signal");
        else
            enter_line(table, id, &truth[!paper_line_published(id)]);
    sheet_free(&truth[0]);
    sheet_free(&truth[1]);
    return status;
}

enum status paper_measure(struct paper_table *table, struct reason *reason)
{
    const struct bench *bench = table->bench;
    table->session.progress = &table->bench->progress;
    table->session.label = table->scene->spec;
    table->session.about.base = SIZE_MAX;
    enum status status = enter_lines(table, reason);
    if (status)
        return status;
    uint32_t frames = bench->picture.frames ? (uint32_t)bench->picture.frames
                      : table->slow         ? SLOW_FRAMES
                      : bench->quick        ? 20
                                            : FRAMES_DEFAULT;
    struct frames_settings settings = {.frames = frames,
                                       .turns = frames < 40 ? 1 : FRAMES_TURNS,
                                       .warm_up = table->slow ? 0 : FRAMES_WARM_UP};
    return frames_session_measure(&table->session, &settings, reason);
}
