/* Wide trees of a device beside C's, and their words. */
#include "cmd/build/cmd_build.h"

#include "cmd/common/cmd_grid.h"
#include "ref/base/json_record.h"

enum status build_wide_play(struct device_tree *tree, const struct staged *mine,
                            const struct scene *scene, uint32_t r, struct build_wide *wide,
                            struct reason *reason)
{
    struct wide_result result;
    enum status status = wide_compare(tree, wide->layout, mine, scene, &result, reason);
    if (status)
        return status;
    if (result.differs.stage && wide->differing++ == 0)
        wide->differs = result.differs;
    wide->nodes = result.nodes;
    wide->refused = result.refused;
    wide->device_bytes = result.device_bytes;
    for (int p = 0; p < WIDE_PARTS; p++) {
        wide->device_ns[p][r] = (double)result.device_ns[p];
        wide->c_ns[p][r] = (double)result.c_ns[p];
    }
    return STATUS_OK;
}

void build_wide_sum(struct build_wide *wide, uint32_t rounds)
{
    for (int p = 0; p < WIDE_PARTS; p++)
        wide->part[p] = build_part_of(wide->device_ns[p], wide->c_ns[p], rounds);
}

static bool is_told(const struct build_wide *wide)
{
    return !wide->unplayed && !wide->refused.text[0];
}

static void print_row(const struct build_wide *wide, struct row_grid *grid)
{
    const bool bad = wide->differs.stage != NULL;
    for (int p = 0; p < WIDE_PARTS; p++) {
        const struct build_part *part = &wide->part[p];
        grid_add(grid, bad ? PAINT_BAD : PAINT_GOOD, "%s\t%s\t%s\t%s\t%.3f\t%.3f\t%.2f\t%.2f-%.2f",
                 bad ? "DIFFERS" : "equal", wide->builder->name, wide->layout->name,
                 wide_part_names[p], part->device_ms, part->c_ms, part->ratio, part->ratio_least,
                 part->ratio_most);
    }
}

void build_print_wide(const struct build_wide *wide, size_t count, const struct screen *screen)
{
    static const struct column columns[] = {
        {"verdict", .left = true},          {"builder", .left = true},
        {"layout", .left = true},           {"stage", .left = true},
        {"device ms", .least = TIME_WIDTH}, {"C ms", .least = TIME_WIDTH},
        {"device/C", .least = TIME_WIDTH},  {"least-most", .rank = 1, .least = SPAN_WIDTH}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    for (size_t i = 0; i < count; i++)
        if (is_told(&wide[i]))
            print_row(&wide[i], &grid);
    if (grid.row_count > 0)
        grid_print(&grid, screen);
    for (size_t i = 0; i < count; i++) {
        const struct build_wide *w = &wide[i];
        if (w->refused.text[0])
            screen_text(screen, "%s refused: %s\n", w->builder->name, w->refused.text);
        if (w->differs.stage)
            screen_text(screen, "%s, %s: %s, the first of %llu: %s %u: %s\n", w->builder->name,
                        w->layout->name, w->differs.stage, (unsigned long long)w->differs.count,
                        w->differs.stage, w->differs.element, w->differs.text);
    }
}

static json_t *one_json(const struct build_wide *wide)
{
    json_t *parts = json_array(), *differs = json_null();
    for (int p = 0; p < WIDE_PARTS; p++) {
        const struct build_part *part = &wide->part[p];
        json_array_append_new(parts, json_record("stage=%s device_ms=%g c_ms=%g ratio=%g "
                                                 "ratio_least=%g ratio_most=%g",
                                                 wide_part_names[p], part->device_ms, part->c_ms,
                                                 part->ratio, part->ratio_least, part->ratio_most));
    }
    if (wide->differs.stage)
        differs = json_record("stage=%s element=%u elements=%zu text=%s rounds=%u",
                              wide->differs.stage, wide->differs.element,
                              (size_t)wide->differs.count, wide->differs.text, wide->differing);
    return json_record("scene=%s builder=%s layout=%s triangles=%u nodes=%u device_bytes=%zu "
                       "equal=%i differs=%p refused=%p stages=%p",
                       wide->scene, wide->builder->name, wide->layout->name, wide->triangles,
                       wide->nodes, (size_t)wide->device_bytes,
                       is_told(wide) && !wide->differs.stage, differs,
                       json_text(wide->refused.text[0] ? wide->refused.text : NULL), parts);
}

json_t *build_wide_json(const struct build_wide *wide, size_t count)
{
    json_t *out = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(out, one_json(&wide[i]));
    return out;
}
