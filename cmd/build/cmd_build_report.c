#include "cmd/build/cmd_build.h"

#include "cmd/common/cmd_grid.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"

static const char *part_name(int part)
{
    return part < STAGED_PARTS ? staged_part_names[part] : "all";
}

static void print_row(const struct build_row *row, struct row_grid *grid)
{
    const bool bad = row->differs.stage != NULL;
    for (int p = 0; p <= STAGED_PARTS; p++) {
        const struct build_part *part = &row->part[p];
        grid_add(grid, bad ? PAINT_BAD : PAINT_GOOD, "%s\t%s\t%s\t%.3f\t%.3f\t%.2f\t%.2f-%.2f",
                 bad ? "DIFFERS" : "equal", row->builder->name, part_name(p), part->device_ms,
                 part->c_ms, part->ratio, part->ratio_least, part->ratio_most);
    }
}

void build_print(const struct build_row *row, size_t count, const struct screen *screen)
{
    static const struct column columns[] = {{"verdict", .left = true},
                                            {"builder", .left = true},
                                            {"stage", .left = true},
                                            {"device ms", .least = TIME_WIDTH},
                                            {"C ms", .least = TIME_WIDTH},
                                            {"device/C", .least = TIME_WIDTH},
                                            {"least-most", .rank = 1, .least = SPAN_WIDTH}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    for (size_t i = 0; i < count; i++)
        print_row(&row[i], &grid);
    grid_print(&grid, screen);
    for (size_t i = 0; i < count; i++)
        if (row[i].differs.stage)
            screen_text(screen, "%s: %s, the first of %llu: %s %u: %s\n", row[i].builder->name,
                        row[i].differs.stage, (unsigned long long)row[i].differs.count,
                        row[i].differs.stage, row[i].differs.element, row[i].differs.text);
    if (count > 0 && row->triangles > 0)
        screen_text(screen, "device memory: %.1f bytes a triangle\n",
                    (double)row->device_bytes / row->triangles);
}

static json_t *row_json(const struct build_row *row)
{
    json_t *parts = json_array();
    for (int p = 0; p <= STAGED_PARTS; p++) {
        const struct build_part *part = &row->part[p];
        json_array_append_new(parts, json_record("stage=%s device_ms=%g c_ms=%g ratio=%g "
                                                 "ratio_least=%g ratio_most=%g",
                                                 part_name(p), part->device_ms, part->c_ms,
                                                 part->ratio, part->ratio_least, part->ratio_most));
    }
    json_t *differs = json_null();
    if (row->differs.stage)
        differs = json_record("stage=%s element=%u elements=%zu text=%s rounds=%u",
                              row->differs.stage, row->differs.element, (size_t)row->differs.count,
                              row->differs.text, row->differing);
    return json_record("scene=%s builder=%s twin=%s triangles=%u device_bytes=%zu equal=%i "
                       "differs=%p stages=%p",
                       row->scene, row->builder->name, row->builder->twin, row->triangles,
                       (size_t)row->device_bytes, row->differs.stage == NULL, differs, parts);
}

enum status build_write_json(const char *path, const struct build_results *results,
                             const struct vk_limits *limits, uint32_t rounds, int code,
                             struct reason *reason)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < results->row_count; i++)
        json_array_append_new(rows, row_json(&results->row[i]));
    json_t *root =
        json_record("raydiff=%s exit=%d device=%s driver=%s rounds=%u rows=%p wide=%p refits=%p",
                    RAYDIFF_VERSION, code, limits->device, limits->driver, rounds, rows,
                    build_wide_json(results->wide, results->wide_count),
                    build_refits_json(results->refit, results->refit_count));
    return json_write(path, root, 17, reason);
}
