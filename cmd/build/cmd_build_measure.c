#include "cmd/build/cmd_build.h"

#include "bench/chart/spread.h"

/* One round: builds on both sides and compares. */
static enum status play(struct device_tree *tree, enum staged_kind kind, const struct scene *scene,
                        struct device_times *times, uint64_t ns[STAGED_PARTS], uint32_t r,
                        struct build_row *row, struct build_wide *wide, size_t layout_count,
                        struct reason *reason)
{
    struct staged devices, mine = {0};
    enum status status = device_tree_build(tree, kind, scene, &devices, times, reason);
    if (status)
        return status;
    status = staged_build(kind, scene, &mine, ns, reason);
    if (!status) {
        struct staged_difference at = staged_compare(&devices, &mine);
        if (at.stage && row->differing++ == 0)
            row->differs = at;
        for (size_t l = 0; l < layout_count && !status; l++) {
            wide[l].unplayed = wide[l].unplayed || at.stage;
            if (!at.stage)
                status = build_wide_play(tree, &mine, scene, r, &wide[l], reason);
        }
    }
    staged_free(&devices);
    staged_free(&mine);
    return status;
}

struct build_part build_part_of(const double *device_ns, const double *c_ns, uint32_t rounds)
{
    double device[BUILD_ROUNDS_MOST], c[BUILD_ROUNDS_MOST], ratio[BUILD_ROUNDS_MOST];
    for (uint32_t r = 0; r < rounds; r++) {
        device[r] = device_ns[r];
        c[r] = c_ns[r];
        ratio[r] = c[r] > 0 ? device[r] / c[r] : 0;
    }
    struct spread spread = spread_of(ratio, rounds);
    return (struct build_part){spread_of(device, rounds).median / 1e6,
                               spread_of(c, rounds).median / 1e6, spread.median, spread.least,
                               spread.most};
}

enum status build_measure(struct device_tree *tree, const struct scene *scene, uint32_t rounds,
                          struct build_row *row, struct build_wide *wide, size_t layout_count,
                          struct reason *reason)
{
    static double device[STAGED_PARTS + 1][BUILD_ROUNDS_MOST],
        c[STAGED_PARTS + 1][BUILD_ROUNDS_MOST];
    enum staged_kind kind = STAGED_LBVH30;
    (void)device_builder_kind(row->builder, &kind);
    for (uint32_t r = 0; r < rounds; r++) {
        struct device_times times;
        uint64_t ns[STAGED_PARTS];
        enum status status =
            play(tree, kind, scene, &times, ns, r, row, wide, layout_count, reason);
        if (status)
            return status;
        device[STAGED_CODES][r] = (double)times.ns[DEVICE_CODES];
        device[STAGED_ORDER][r] = (double)times.ns[DEVICE_ORDER];
        device[STAGED_NODES][r] = (double)(times.ns[DEVICE_LINKS] + times.ns[DEVICE_BOXES]);
        device[STAGED_PARTS][r] = c[STAGED_PARTS][r] = 0;
        for (int p = 0; p < STAGED_PARTS; p++) {
            c[p][r] = (double)ns[p];
            c[STAGED_PARTS][r] += c[p][r];
            device[STAGED_PARTS][r] += device[p][r];
        }
        row->device_bytes = times.bytes;
    }
    for (int p = 0; p <= STAGED_PARTS; p++)
        row->part[p] = build_part_of(device[p], c[p], rounds);
    for (size_t l = 0; l < layout_count; l++)
        build_wide_sum(&wide[l], rounds);
    return STATUS_OK;
}
