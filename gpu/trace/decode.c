#include "gpu/trace/decode.h"

#include "gpu/shaders/shaders.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/abi.h"
#include "ref/base/float_word.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GROUP    64u
#define BINDINGS (ABI_BIND_ASKED + 1)

/* A question, a record and one of its slots, and what the shader decodes there, as in
 * shaders/decode.glsl. */
struct decode_question {
    uint32_t ref, what;
};
struct answer {
    uint32_t lo[3], kind;
    uint32_t hi[3], count;
    uint32_t more[4]; /* leaf: the item; binary: the children; wide: MORE_* */
};
enum { MORE_CHILD_SUM = 1, MORE_RECORD_SUM = 2, MORE_CHILD_WORD = 3 };

struct decode_comparing {
    const struct packed *packed;
    struct decode_question *asked;
    struct answer *answer;
    size_t count, capacity;
    size_t *first; /* index of each reference's first question */
    bool *reached;
    struct decoded *out;
};

/* --- questions ------------------------------------------------------------------------------- */

static bool is_wide(const struct packed *packed)
{
    return layout_is_wide(packed->layout);
}

static enum status put(struct decode_comparing *c, uint32_t ref, uint32_t what)
{
    if (array_reserve(&c->asked, &c->capacity, c->count + 1, sizeof *c->asked))
        return STATUS_MEMORY;
    c->asked[c->count++] = (struct decode_question){ref, what};
    return STATUS_OK;
}

static uint32_t slot_of(const struct packed *packed, uint32_t child)
{
    return (child - packed->node_count) % packed->layout->width;
}

/* Adds every slot of the record, then the further items of its leaves. */
static enum status put_wide(struct decode_comparing *c, uint32_t ref, const struct wide *record)
{
    const uint32_t width = c->packed->layout->width;
    enum status status = STATUS_OK;
    for (uint32_t slot = 0; slot < width && !status; slot++)
        status = put(c, ref, slot);
    for (uint32_t i = 0; i < record->child_count; i++) {
        struct wide leaf;
        if (record->child[i] < c->packed->node_count)
            continue;
        c->packed->layout->load(c->packed, record->child[i], &leaf);
        for (uint32_t item = 1; item < leaf.item_count && !status; item++)
            status = put(c, ref, item * width + slot_of(c->packed, record->child[i]));
    }
    return status;
}

static enum status put_all(struct decode_comparing *c)
{
    const struct packed *packed = c->packed;
    uint32_t end = is_wide(packed) ? packed->node_count : packed->ref_count;
    enum status status = STATUS_OK;
    for (uint32_t ref = 0; ref < end && !status; ref++) {
        struct wide node;
        if (!c->reached[ref])
            continue;
        packed->layout->load(packed, ref, &node);
        c->first[ref] = c->count;
        c->out->records++;
        if (is_wide(packed)) {
            status = put_wide(c, ref, &node);
            continue;
        }
        status = put(c, ref, 0);
        for (uint32_t item = 1; item < node.item_count && !status; item++)
            status = put(c, ref, item);
    }
    c->out->slots = (uint32_t)c->count;
    return status;
}

/* --- the shader ------------------------------------------------------------------------------ */

static enum status fill(struct vk *vk, struct decode_comparing *c,
                        struct vk_buffer *buffer[BINDINGS], struct reason *reason)
{
    const struct packed *packed = c->packed;
    const uint64_t bytes[BINDINGS] = {[ABI_BIND_HITS] = c->count * sizeof *c->answer,
                                      [ABI_BIND_NODES] = 4 * (uint64_t)packed->word_count,
                                      [ABI_BIND_ITEMS] = 4 * (uint64_t)packed->item_count,
                                      [ABI_BIND_ASKED] = c->count * sizeof *c->asked};
    const void *from[BINDINGS] = {[ABI_BIND_NODES] = packed->word,
                                  [ABI_BIND_ITEMS] = packed->item,
                                  [ABI_BIND_ASKED] = c->asked};
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < BINDINGS && !status; i++) {
        status = from[i] ? vk_buffer_make_of(vk, from[i], bytes[i], &buffer[i], reason)
                         : vk_buffer_make(vk, bytes[i], &buffer[i], reason);
    }
    return status;
}

/* Runs the shader on all questions. */
static enum status ask(struct vk *vk, const struct shader *shader, struct decode_comparing *c,
                       struct reason *reason)
{
    const struct packed *packed = c->packed;
    const uint32_t constant[] = {
        [ABI_SPEC_WORKGROUP] = GROUP, [ABI_SPEC_BOX] = ABI_BOX_ROBUST,
        [ABI_SPEC_TRI] = ABI_TRI_MT,  [ABI_SPEC_QUERY] = ABI_QUERY_CLOSEST,
        [ABI_SPEC_STACK] = 16,        [ABI_SPEC_STORE] = packed->store->id};
    const struct push push = {.ray_count = (uint32_t)c->count,
                              .root = packed->root,
                              .node_count = packed->ref_count,
                              .item_count = packed->item_count,
                              .tri_count = packed->tri_count};
    const struct vk_shader make = {.name = shader->name,
                                   .word = shader->word,
                                   .word_count = shader->word_count,
                                   .binding_count = BINDINGS,
                                   .push_bytes = sizeof push,
                                   .constant = constant,
                                   .constant_count = ARRAY_COUNT(constant)};
    struct vk_pipeline *pipeline = NULL;
    struct vk_buffer *buffer[BINDINGS] = {NULL};
    struct vk_time time;
    enum status status = vk_pipeline_make(vk, &make, &pipeline, reason);
    if (!status)
        status = fill(vk, c, buffer, reason);
    if (!status)
        status = vk_dispatch(vk, pipeline, buffer, &push, (push.ray_count + GROUP - 1) / GROUP,
                             &time, reason);
    if (!status)
        status = vk_buffer_read(vk, buffer[ABI_BIND_HITS], 0, c->answer,
                                c->count * sizeof *c->answer, reason);
    vk_buffers_free(vk, buffer, BINDINGS);
    vk_pipeline_free(vk, pipeline);
    return status;
}

/* --- the comparison -------------------------------------------------------------------------- */

/* Describes the first difference and returns false. */
static bool differs(struct decode_comparing *c, uint32_t ref, const char *field, const char *mine,
                    const char *theirs)
{
    if (!c->out->first[0])
        snprintf(c->out->first, sizeof c->out->first, "%s: %s: C decodes %s, GLSL %s",
                 packed_name(c->packed, ref).text, field, mine, theirs);
    return false;
}

static bool same_number(struct decode_comparing *c, uint32_t ref, const char *field, uint32_t mine,
                        uint32_t theirs)
{
    char text[2][32];
    if (mine == theirs)
        return true;
    for (int i = 0; i < 2; i++) {
        uint32_t number = i ? theirs : mine;
        snprintf(text[i], sizeof text[i], number == ABI_NO_PRIM ? "none" : "%u", number);
    }
    return differs(c, ref, field, text[0], text[1]);
}

static bool same_box(struct decode_comparing *c, uint32_t ref, const struct box *box,
                     const struct answer *answer)
{
    for (int k = 0; k < 6; k++) {
        float mine = k < 3 ? box->lo[k] : box->hi[k - 3];
        float theirs = float_from_bits(k < 3 ? answer->lo[k] : answer->hi[k - 3]);
        char field[16], text[2][48];
        if (mine == theirs || (mine != mine && theirs != theirs))
            continue;
        snprintf(field, sizeof field, "%c %s", "xyz"[k % 3], k < 3 ? "lo" : "hi");
        snprintf(text[0], sizeof text[0], "%a (%.9g)", (double)mine, (double)mine);
        snprintf(text[1], sizeof text[1], "%a (%.9g)", (double)theirs, (double)theirs);
        return differs(c, ref, field, text[0], text[1]);
    }
    return true;
}

static const char *kind_name(uint32_t kind)
{
    static const char *const names[] = {"an empty slot", "an inner node", "a leaf"};
    return kind < ARRAY_COUNT(names) ? names[kind] : "nonsense";
}

static bool same_kind(struct decode_comparing *c, uint32_t ref, uint32_t mine, uint32_t theirs)
{
    return mine == theirs || differs(c, ref, "kind", kind_name(mine), kind_name(theirs));
}

/* Compares the items of a leaf. The first item is in `answer`, the next ones are from `more` on. */
static bool same_leaf(struct decode_comparing *c, uint32_t ref, const struct wide *leaf,
                      const struct answer *answer, const struct answer *more)
{
    if (!same_number(c, ref, "items", leaf->item_count, answer->count))
        return false;
    for (uint32_t slot = 0; slot < leaf->item_count; slot++) {
        char field[32];
        snprintf(field, sizeof field, "item slot %u", slot);
        if (!same_number(c, ref, field, packed_item(c->packed, leaf, slot),
                         slot ? more[slot - 1].more[0] : answer->more[0]))
            return false;
    }
    return true;
}

static bool same_binary(struct decode_comparing *c, uint32_t ref)
{
    const struct answer *answer = &c->answer[c->first[ref]];
    struct box box = c->packed->layout->box(c->packed, ref);
    struct wide node;
    c->packed->layout->load(c->packed, ref, &node);
    if (!same_kind(c, ref, node.child_count ? ABI_DECODED_INNER : ABI_DECODED_LEAF, answer->kind) ||
        !same_box(c, ref, &box, answer))
        return false;
    if (node.child_count == 0)
        return same_leaf(c, ref, &node, answer, answer + 1);
    return same_number(c, ref, "first child", node.child[0], answer->more[0]) &&
           same_number(c, ref, "second child", node.child[1], answer->more[1]);
}

/* Finds the slots of C's children. References to leaves contain their slot; inner nodes are matched
 * in order. */
static bool match_slots(struct decode_comparing *c, uint32_t ref, const struct wide *record,
                        uint32_t slot[WIDE_MAX])
{
    const struct packed *packed = c->packed;
    const struct answer *answer = &c->answer[c->first[ref]];
    uint32_t mine[3] = {0}, theirs[3] = {0}, next = 0;
    for (uint32_t i = 0; i < record->child_count; i++)
        mine[record->child[i] < packed->node_count ? ABI_DECODED_INNER : ABI_DECODED_LEAF]++;
    for (uint32_t s = 0; s < packed->layout->width; s++)
        if (answer[s].kind < ARRAY_COUNT(theirs))
            theirs[answer[s].kind]++;
    for (uint32_t i = 0; i < record->child_count; i++) {
        if (record->child[i] >= packed->node_count) {
            slot[i] = slot_of(packed, record->child[i]);
            if (!same_kind(c, record->child[i], ABI_DECODED_LEAF, answer[slot[i]].kind))
                return false;
            continue;
        }
        while (next < packed->layout->width && answer[next].kind != ABI_DECODED_INNER)
            next++;
        slot[i] = next++;
    }
    return same_number(c, ref, "children that are inner nodes", mine[ABI_DECODED_INNER],
                       theirs[ABI_DECODED_INNER]) &&
           same_number(c, ref, "children that are leaves", mine[ABI_DECODED_LEAF],
                       theirs[ABI_DECODED_LEAF]);
}

/* Returns true if GLSL's slot leads to the record of C's reference, judged by what GLSL decodes at
 * both. */
static bool same_child(struct decode_comparing *c, uint32_t ref, uint32_t slot, uint32_t child)
{
    const struct answer *answer = &c->answer[c->first[ref] + slot];
    const struct answer *there = &c->answer[c->first[child]];
    char field[48], mine[32], theirs[48];
    if (answer->more[MORE_CHILD_SUM] == there->more[MORE_RECORD_SUM])
        return true;
    snprintf(field, sizeof field, "child of slot %u", slot);
    snprintf(mine, sizeof mine, "record %u", child);
    snprintf(theirs, sizeof theirs, "another (%u)", answer->more[MORE_CHILD_WORD]);
    return differs(c, ref, field, mine, theirs);
}

static bool same_wide(struct decode_comparing *c, uint32_t ref)
{
    const struct packed *packed = c->packed;
    const struct answer *more = &c->answer[c->first[ref] + packed->layout->width];
    uint32_t slot[WIDE_MAX] = {0};
    struct wide record;
    packed->layout->load(packed, ref, &record);
    if (!match_slots(c, ref, &record, slot))
        return false;
    for (uint32_t i = 0; i < record.child_count; i++) {
        const struct answer *answer = &c->answer[c->first[ref] + slot[i]];
        const uint32_t child = record.child[i];
        struct wide leaf;
        if (!same_box(c, child, &record.box[i], answer))
            return false;
        if (child < packed->node_count) {
            if (!same_child(c, ref, slot[i], child))
                return false;
            continue;
        }
        packed->layout->load(packed, child, &leaf);
        if (!same_leaf(c, child, &leaf, answer, more))
            return false;
        more += leaf.item_count - 1;
    }
    return true;
}

static void compare(struct decode_comparing *c)
{
    const struct packed *packed = c->packed;
    uint32_t end = is_wide(packed) ? packed->node_count : packed->ref_count;
    for (uint32_t ref = 0; ref < end; ref++)
        if (c->reached[ref])
            c->out->differ += !(is_wide(packed) ? same_wide(c, ref) : same_binary(c, ref));
}

/* --- all ------------------------------------------------------------------------------------- */

static enum status prepare(struct decode_comparing *c, struct reason *reason)
{
    struct packed_walk walk;
    enum status status = packed_walk_make(c->packed, &walk);
    c->first = alloc_zeroed(c->packed->ref_count, sizeof *c->first);
    c->reached = alloc_zeroed(c->packed->ref_count, sizeof *c->reached);
    if (!c->first || !c->reached)
        status = STATUS_MEMORY;
    for (uint32_t i = 0; i < walk.visit_count && !status; i++)
        c->reached[walk.visit[i].ref] = true;
    packed_walk_free(&walk);
    if (!status)
        status = put_all(c);
    c->answer = alloc_zeroed(c->count, sizeof *c->answer);
    if (status || !c->answer)
        return fail(reason, STATUS_MEMORY, "no memory to compare %u records",
                    c->packed->node_count);
    if (c->count > UINT32_MAX / sizeof(struct answer))
        return fail(reason, STATUS_LIMIT, "%zu slots are too many to be compared", c->count);
    return STATUS_OK;
}

enum status decode_compare(const struct packed *packed, const struct engine_options *options,
                           struct decoded *out, struct reason *reason)
{
    const struct vk_options how = vulkan_options(options);
    struct decode_comparing c = {.packed = packed, .out = out};
    struct vk *vk = NULL;
    char name[64];
    *out = (struct decoded){.records = 0};
    if (packed->node_count == 0)
        return STATUS_OK;
    snprintf(name, sizeof name, "decode_%.48s", packed->layout->name);
    const struct shader *shader = shader_find(name);
    if (!shader) {
        shader_why_not(packed->layout->name, reason);
        return STATUS_UNSUPPORTED;
    }
    enum status status = prepare(&c, reason);
    if (!status)
        status = vk_open(&how, &vk, reason);
    if (!status)
        status = ask(vk, shader, &c, reason);
    if (!status)
        compare(&c);
    if (vk && vk_close(vk, status ? NULL : reason) && !status)
        status = STATUS_DEVICE;
    free(c.asked);
    free(c.answer);
    free(c.first);
    free(c.reached);
    return status;
}
