#include "ref/staged/staged.h"

#include "ref/abi_build.h"
#include "ref/base/text.h"
#include "ref/build/grow.h"
#include "ref/build/links.h"
#include "ref/build/room.h"
#include "ref/staged/staged_inner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status staged_alloc(uint32_t count, struct staged *out)
{
    *out = (struct staged){.count = count};
    if (count == 0)
        return STATUS_OK;
    out->code = malloc(count * sizeof *out->code);
    out->order = malloc(count * sizeof *out->order);
    out->child = malloc(count * sizeof *out->child);
    out->box = malloc(2 * (size_t)count * sizeof *out->box);
    if (out->code && out->order && out->child && out->box)
        return STATUS_OK;
    staged_free(out);
    return STATUS_MEMORY;
}

void staged_free(struct staged *staged)
{
    free(staged->code);
    free(staged->order);
    free(staged->child);
    free(staged->box);
    *staged = (struct staged){0};
}

const char *const staged_part_names[STAGED_PARTS] = {"codes", "order", "nodes"};

/* Returns the time since *last, which becomes now. */
static uint64_t lap(uint64_t *last)
{
    uint64_t now = time_ns(), ns = now - *last;
    *last = now;
    return ns;
}

static enum status build_parts(enum staged_kind kind, const struct scene *scene, struct staged *out,
                               uint64_t ns[STAGED_PARTS])
{
    struct staged_frame frame;
    uint64_t last = time_ns();
    stage_codes(scene, kind == STAGED_LBVH30 ? 10 : 21, out, &frame);
    ns[STAGED_CODES] = lap(&last);
    enum status status = stage_order(out);
    ns[STAGED_ORDER] = lap(&last);
    if (!status && kind == STAGED_HPLOC)
        stage_hploc(&frame, out);
    else if (!status)
        stage_karras(out);
    ns[STAGED_NODES] = lap(&last);
    return status;
}

enum status staged_build(enum staged_kind kind, const struct scene *scene, struct staged *out,
                         uint64_t ns[STAGED_PARTS], struct reason *reason)
{
    uint64_t unused[STAGED_PARTS] = {0};
    uint64_t *times = ns ? ns : unused;
    *out = (struct staged){0};
    memset(times, 0, sizeof unused);
    if (scene->tri_count > STAGED_MOST)
        return fail(reason, STATUS_LIMIT, "a tree in stages holds at most 2^30 triangles, not %u",
                    scene->tri_count);
    enum status status = staged_alloc(scene->tri_count, out);
    if (!status && out->count > 0)
        status = build_parts(kind, scene, out, times);
    if (!status)
        return STATUS_OK;
    staged_free(out);
    return fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
}

/* --- comparing -------------------------------------------------------------------------------- */

uint32_t staged_differing(const void *mine, const void *other, size_t bytes, uint32_t count,
                          uint64_t *all)
{
    uint32_t first = count;
    *all = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (memcmp((const char *)mine + i * bytes, (const char *)other + i * bytes, bytes) == 0)
            continue;
        first = *all == 0 ? i : first;
        ++*all;
    }
    return first;
}

static void tell_box(const uint32_t box[6], char *text, size_t text_bytes)
{
    for (int k = 0; k < 6; k++)
        text_append(text, text_bytes, "%s%.6g", k ? " " : "", (double)float_from_bits(box[k]));
}

static void tell(const struct staged *mine, const struct staged *other, int stage,
                 struct staged_difference *at)
{
    const uint32_t i = at->element;
    char text[2][72] = {"", ""};
    for (int k = 0; k < 2; k++) {
        const struct staged *of = k ? other : mine;
        if (stage == 0)
            text_append(text[k], sizeof text[k], "0x%llx", (unsigned long long)of->code[i]);
        else if (stage == 1)
            text_append(text[k], sizeof text[k], "triangle %u", of->order[i]);
        else if (stage == 3)
            tell_box(of->box[i], text[k], sizeof text[k]);
        for (int c = 0; stage == 2 && c < 2; c++)
            text_append(text[k], sizeof text[k], "%s%s %u", c ? ", " : "",
                        of->child[i][c] & STAGED_LEAF ? "leaf" : "node",
                        of->child[i][c] & ~STAGED_LEAF);
    }
    snprintf(at->text, sizeof at->text, "%s, not %s", text[0], text[1]);
}

struct staged_difference staged_compare(const struct staged *mine, const struct staged *other)
{
    static const char *const names[] = {"codes", "order", "links", "boxes"};
    const uint32_t n = mine->count, inner = n > 0 ? n - 1 : 0;
    const struct {
        const void *mine, *other;
        size_t bytes;
        uint32_t count;
    } stages[] = {{mine->code, other->code, sizeof *mine->code, n},
                  {mine->order, other->order, sizeof *mine->order, n},
                  {mine->child, other->child, sizeof *mine->child, inner},
                  {mine->box, other->box, sizeof *mine->box, inner + n}};
    struct staged_difference at = {0};
    for (int s = 0; s < (int)ARRAY_COUNT(stages); s++) {
        at.element = staged_differing(stages[s].mine, stages[s].other, stages[s].bytes,
                                      stages[s].count, &at.count);
        bool root = s == 2 && at.count == 0 && mine->root != other->root;
        if (at.count == 0 && !root)
            continue;
        at.stage = names[s];
        if (!root)
            tell(mine, other, s, &at);
        else
            snprintf(at.text, sizeof at.text, "the root is 0x%x, not 0x%x", mine->root,
                     other->root);
        at.count += root;
        return at;
    }
    return (struct staged_difference){0};
}
