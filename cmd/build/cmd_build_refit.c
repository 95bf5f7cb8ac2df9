/* Refits on a device beside packed_refit. */
#include "cmd/build/cmd_build.h"

#include "cmd/common/cmd_grid.h"
#include "gpu/build/device_refit.h"
#include "ref/base/json_record.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "scenes/move.h"

#include <stdlib.h>
#include <string.h>

/* The first word of a tree that differs; count: none. */
static uint32_t differing(const uint32_t *mine, const uint32_t *other, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && mine[i] == other[i])
        i++;
    return i;
}

/* One round. Both sides begin with the tree as it was before the motion. */
static enum status play(struct device_tree *tree, struct packed *packed, const struct scene *moved,
                        uint32_t *word, double *device_ns, double *c_ns, struct build_refit *refit,
                        struct reason *reason)
{
    uint64_t ns;
    enum status status = device_refit(tree, packed, moved, word, &ns, reason);
    if (status)
        return status;
    *device_ns = (double)ns;
    struct packed mine = *packed;
    mine.word = alloc_copy(packed->word, packed->word_count, sizeof *packed->word);
    if (!mine.word && packed->word_count > 0)
        return fail(reason, STATUS_MEMORY, "no memory for %u words", packed->word_count);
    uint64_t start = time_ns();
    status = packed_refit(&mine, moved, reason);
    *c_ns = (double)(time_ns() - start);
    uint32_t at = differing(word, mine.word, mine.word_count);
    if (!status && at < mine.word_count && refit->differing++ == 0)
        snprintf(refit->text, sizeof refit->text, "word %u: %08x, not %08x", at, word[at],
                 mine.word[at]);
    free(mine.word);
    return status;
}

static enum status play_all(struct device_tree *tree, struct packed *packed,
                            const struct scene *moved, uint32_t rounds, struct build_refit *refit,
                            struct reason *reason)
{
    double device[BUILD_ROUNDS_MOST], c[BUILD_ROUNDS_MOST];
    uint32_t *word = malloc(sizeof *word * ((size_t)packed->word_count + 1));
    enum status status =
        word ? STATUS_OK
             : fail(reason, STATUS_MEMORY, "no memory for %u words", packed->word_count);
    for (uint32_t r = 0; r < rounds && !status; r++)
        status = play(tree, packed, moved, word, &device[r], &c[r], refit, reason);
    free(word);
    if (!status)
        refit->part = build_part_of(device, c, rounds);
    return status;
}

static enum status measure(struct device_tree *tree, const struct bvh *bvh,
                           const struct scene *scene, const struct scene *moved, uint32_t rounds,
                           struct build_refit *refit, struct reason *reason)
{
    struct packed packed;
    enum status status = packed_make(refit->layout, bvh, scene, &packed, reason);
    if (status)
        return status;
    status = play_all(tree, &packed, moved, rounds, refit, reason);
    packed_free(&packed);
    return status;
}

/* Each layout; what one refuses is in its result. */
static enum status measure_all(struct device_tree *tree, const struct build_command *b,
                               const struct bvh *bvh, const struct scene *scene,
                               const struct scene *moved, const char *spec,
                               struct build_refit refit[BUILD_REFITS_MOST], size_t *count,
                               struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; layouts_all[i] && *count < BUILD_REFITS_MOST && !status; i++) {
        if (!device_refits(layouts_all[i]))
            continue;
        struct build_refit *next = &refit[(*count)++];
        *next = (struct build_refit){
            .scene = spec, .layout = layouts_all[i], .triangles = scene->tri_count};
        struct reason why;
        status = measure(tree, bvh, scene, moved, b->rounds, next, &why);
        if (status == STATUS_LIMIT) {
            next->refused = why;
            status = STATUS_OK;
        }
        if (status)
            *reason = why;
    }
    return status;
}

enum status build_refits(struct device_tree *tree, const struct build_command *b,
                         const struct scene *scene, const char *spec,
                         struct build_refit refit[BUILD_REFITS_MOST], size_t *count,
                         struct reason *reason)
{
    const struct build_options options = {.leaf = BUILD_LEAF_DEFAULT};
    struct bvh bvh;
    struct scene moved = *scene;
    *count = 0;
    moved.vertex = alloc_copy(scene->vertex, 3 * (size_t)scene->vertex_count, sizeof(float));
    if (!moved.vertex)
        return fail(reason, STATUS_MEMORY, "no memory for the vertices of a scene that moves");
    scene_move(&moved, b->move, b->seed);
    enum status status = bvh_build(builder_find("hploc"), scene, &options, &bvh, reason);
    if (!status)
        status = measure_all(tree, b, &bvh, scene, &moved, spec, refit, count, reason);
    bvh_free(&bvh);
    free(moved.vertex);
    return status;
}

void build_print_refits(const struct build_refit *refit, size_t count, const struct screen *screen)
{
    static const struct column columns[] = {
        {"verdict", .left = true},          {"refit", .left = true},
        {"device ms", .least = TIME_WIDTH}, {"C ms", .least = TIME_WIDTH},
        {"device/C", .least = TIME_WIDTH},  {"least-most", .rank = 1, .least = SPAN_WIDTH}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    for (size_t i = 0; i < count; i++) {
        const struct build_part *part = &refit[i].part;
        if (!refit[i].refused.text[0])
            grid_add(&grid, refit[i].differing ? PAINT_BAD : PAINT_GOOD,
                     "%s\t%s\t%.3f\t%.3f\t%.2f\t%.2f-%.2f",
                     refit[i].differing ? "DIFFERS" : "equal", refit[i].layout->name,
                     part->device_ms, part->c_ms, part->ratio, part->ratio_least, part->ratio_most);
    }
    if (grid.row_count > 0)
        grid_print(&grid, screen);
    for (size_t i = 0; i < count; i++) {
        if (refit[i].refused.text[0])
            screen_text(screen, "refit %s refused: %s\n", refit[i].layout->name,
                        refit[i].refused.text);
        if (refit[i].differing)
            screen_text(screen, "refit %s: %s\n", refit[i].layout->name, refit[i].text);
    }
}

json_t *build_refits_json(const struct build_refit *refit, size_t count)
{
    json_t *out = json_array();
    for (size_t i = 0; i < count; i++) {
        const struct build_refit *r = &refit[i];
        const bool refused = r->refused.text[0] != '\0';
        json_array_append_new(
            out, json_record("scene=%s layout=%s triangles=%u equal=%i differs=%p rounds=%u "
                             "refused=%p device_ms=%g c_ms=%g ratio=%g ratio_least=%g "
                             "ratio_most=%g",
                             r->scene, r->layout->name, r->triangles, r->differing == 0 && !refused,
                             json_text(r->differing ? r->text : NULL), r->differing,
                             json_text(refused ? r->refused.text : NULL), r->part.device_ms,
                             r->part.c_ms, r->part.ratio, r->part.ratio_least, r->part.ratio_most));
    }
    return out;
}
