#include "ref/explain/replay.h"

#include "ref/explain/fused.h"
#include "ref/explain/oriented.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* More than any tree of this program needs; the limit of a repaired stack. */
#define STACK_WITHOUT_END 4096u

struct state {
    const struct explain_replay *replay;
    const struct replay_change *change;
    struct slab_rule rule;
    struct slab_ray slab;
    struct oblique_ray oblique;
    struct tri_ray tri;
    const struct ray *ray;
    struct replay_notes *notes;
    const struct replay_watch *watch; /* of the notes, or NULL */
    struct hit best;
    float tbest;
    uint32_t depth, stack_most, visits_most;
    uint32_t ref[STACK_WITHOUT_END];
    float entry[STACK_WITHOUT_END];
};

static bool repairs(const struct state *s, enum repair repair)
{
    return (s->change->repairs >> repair & 1u) != 0;
}

static bool spoilt(const struct state *s, enum defect defect)
{
    return s->change->defect == defect;
}

/* Pads the planes as the repaired box tests do, whatever the constants of this program. */
static void pad(struct slab_rule *rule)
{
    if (rule->id == ABI_BOX_WATERTIGHT) {
        rule->near = 1.0f - 0x1p-18f;
        rule->behind = 0x1p-19f;
    } else {
        rule->far = 0x1.00002p0f;
    }
}

static void set_rule(struct state *s)
{
    uint32_t id = repairs(s, REPAIR_WATERTIGHT) ? ABI_BOX_WATERTIGHT : s->replay->box_id;
    const struct slab_rule plain = slab_rule_of(id);
    struct slab_rule *rule = &s->rule;
    *rule = plain;
    if (repairs(s, REPAIR_PARALLEL))
        rule->by_order = true;
    if (repairs(s, REPAIR_CLOSED) || repairs(s, REPAIR_WATERTIGHT))
        rule->closed = true;
    if (repairs(s, REPAIR_PADDING) || repairs(s, REPAIR_WATERTIGHT))
        pad(rule);
    if (spoilt(s, DEFECT_STRICT))
        rule->closed = false;
    if (spoilt(s, DEFECT_NOT_PADDED)) { /* FLT_EPSILON is 2 u */
        float pad = 0.5f * FLT_EPSILON * (float)s->change->parameter;
        rule->far = 1.0f + pad;
        rule->near = 1.0f - pad;
    }
    if (spoilt(s, DEFECT_NOT_BEHIND))
        rule->behind = 0.0f;
    if (spoilt(s, DEFECT_SLAB_FUSED))
        rule->form = SLAB_FORM_FUSED;
    if (spoilt(s, DEFECT_SLAB_SPLIT))
        rule->form = SLAB_FORM_SPLIT;
    rule->plain = rule->by_order == plain.by_order && rule->closed == plain.closed &&
                  rule->far == plain.far && rule->near == plain.near &&
                  rule->behind == plain.behind && rule->form == plain.form;
}

/* The note of a reference, or NULL if it is not on the path. */
static struct replay_note *note_of(const struct state *s, uint32_t ref)
{
    const uint32_t node = s->replay->tree->node[ref];
    if (!s->notes)
        return NULL;
    for (uint32_t i = 0; node != EXPLAIN_NONE && i < s->notes->count; i++)
        if (s->notes->step[i].node == node)
            return &s->notes->step[i];
    if (node != EXPLAIN_NONE || !explain_names(s->replay->tree, ref, s->notes->prim, NULL))
        return NULL;
    if (s->notes->part.below != ref)
        s->notes->part = (struct replay_note){.below = ref};
    return &s->notes->part;
}

static bool box_hit(struct state *s, uint32_t ref, const struct box *box, float *entry)
{
    float tbest = repairs(s, REPAIR_CULLING) ? s->ray->tmax : s->tbest;
    struct box stored = *box;
    for (int k = 0; k < 3 && spoilt(s, DEFECT_FLUSHED); k++) {
        stored.lo[k] = fabsf(stored.lo[k]) < 0x1p-14f ? 0.0f : stored.lo[k];
        stored.hi[k] = fabsf(stored.hi[k]) < 0x1p-14f ? 0.0f : stored.hi[k];
    }
    bool hit = repairs(s, REPAIR_BOX_TEST)
                   ? slab_conservative(&s->slab, &stored, tbest, entry)
                   : slab_by_rule(&s->rule, &s->slab, &stored, tbest, entry);
    if (s->watch)
        s->watch->box(s->watch->user, ref);
    struct replay_note *note = note_of(s, ref);
    if (note && !note->tested) {
        note->tested = true;
        note->below = ref;
        note->hit = hit;
        note->entry = *entry;
        note->tbest = tbest;
    }
    return hit;
}

/* An item of a leaf. */
struct item {
    const struct wide *leaf; /* NULL: every triangle is tested, none is an item */
    uint32_t slot, prim;
};

/* The storage that has the triangle, or NULL: it is the scene's, as is a repaired or planted one
 * that is not the triangle of the slot. */
static const struct tri_store *store_of(const struct state *s, const struct item *item)
{
    if (!item->leaf || item->leaf->item_first == EXPLAIN_NONE || repairs(s, REPAIR_ITEM_STORED))
        return NULL;
    const struct packed *packed = s->replay->tree->packed;
    bool stored = !tri_store_reads_scene(packed->store) &&
                  packed_item(packed, item->leaf, item->slot) == item->prim;
    return stored ? packed->store : NULL;
}

/* The triangle test of this run, range included. */
static bool tri_hit(const struct state *s, const struct item *item, struct hit *out)
{
    if (repairs(s, REPAIR_TRIANGLE) && s->replay->exact)
        return s->replay->exact(s->replay->exact_user, s->ray, item->prim, out);
    float v[3][3];
    uint32_t id = s->replay->tri_id;
    const struct tri_store *store = store_of(s, item);
    bool plain =
        !spoilt(s, DEFECT_EDGE_FUSED) && !(id == ABI_TRI_MT_RTRS && repairs(s, REPAIR_THRESHOLD));
    if (store && store->test && plain)
        return store->test(s->replay->tree->packed, item->leaf->item_first, item->slot, id, &s->tri,
                           out);
    if (!store || !store->tri)
        scene_tri(s->replay->scene, item->prim, v);
    else if (!store->tri(s->replay->tree->packed, item->leaf->item_first, item->slot, v))
        return false;
    if (spoilt(s, DEFECT_EDGE_FUSED))
        return fused_tri_run(id, &s->tri, v, out);
    if (id != ABI_TRI_MT_RTRS || !repairs(s, REPAIR_THRESHOLD))
        return tri_test_run(id, &s->tri, v, out);
    return tri_moeller_trumbore(&s->tri, v, 0.0f, out) && tri_in_range(id, &s->tri, out->t);
}

/* `limit`: an accepted triangle must be nearer, if `any` was hit before. */
static bool try_triangle(struct state *s, const struct item *item, bool any, float limit)
{
    struct hit hit;
    uint32_t prim = item->prim;
    if (s->watch)
        s->watch->tri(s->watch->user, prim);
    bool accepted = tri_hit(s, item, &hit);
    bool kept = accepted && (!any || hit.t < limit);
    hit.prim = prim;
    if (s->notes && prim == s->notes->prim && !s->notes->prim_accepted) {
        s->notes->prim_tested = true;
        s->notes->prim_accepted = accepted;
        s->notes->prim_kept = kept;
        if (accepted)
            s->notes->prim_hit = hit;
    }
    if (!kept)
        return false;
    s->best = hit;
    s->tbest = hit.t;
    return true;
}

/* Returns true if the query is answered. */
static bool leaf(struct state *s, const struct explain_node *node)
{
    bool any = s->best.prim != ABI_NO_PRIM;
    float limit = s->best.t;
    for (uint32_t slot = 0; slot < node->wide.item_count; slot++) {
        uint32_t prim = explain_item(s->replay->tree, node, slot);
        if (spoilt(s, DEFECT_SLOT) && slot == s->change->parameter)
            continue;
        if (spoilt(s, DEFECT_ZERO) && prim == 0)
            continue;
        if (spoilt(s, DEFECT_SHIFT))
            prim = prim > 0 && prim != ABI_NO_PRIM ? prim - 1 : ABI_NO_PRIM;
        if (!spoilt(s, DEFECT_LAST_WINS)) {
            any = s->best.prim != ABI_NO_PRIM;
            limit = s->best.t;
        }
        const struct item item = {&node->wide, slot, prim};
        if (prim < s->replay->scene->tri_count && try_triangle(s, &item, any, limit) &&
            s->replay->query == QUERY_ANY)
            return true;
    }
    return false;
}

/* Pushes a waiting child. False if the stack is full. */
static bool push(struct state *s, uint32_t ref, float entry)
{
    if (spoilt(s, DEFECT_FAR_DROPPED) && s->depth >= s->change->parameter)
        return true;
    if (s->depth >= s->stack_most ||
        (spoilt(s, DEFECT_STACK_FULL) && s->depth >= s->change->parameter))
        return false;
    s->ref[s->depth] = ref;
    s->entry[s->depth++] = entry;
    if (s->watch)
        s->watch->push(s->watch->user, s->depth);
    return true;
}

/* As trace.c: *next, or *any = false if no child is hit. False if the stack is full. */
static bool inner(struct state *s, const struct wide *node, uint32_t *next, bool *any)
{
    bool hit[2] = {false, false};
    float entry[2] = {0, 0};
    for (uint32_t i = 0; i < node->child_count && i < 2; i++)
        hit[i] = box_hit(s, node->child[i], &node->box[i], &entry[i]);
    *any = hit[0] || hit[1];
    if (!(hit[0] && hit[1])) {
        *next = node->child[hit[1] ? 1 : 0];
        return true;
    }
    enum visit order = s->replay->tree->packed->layout->order;
    int first = order == VISIT_SND ? 1 : 0;
    if (order == VISIT_NEAR)
        first = entry[1] < entry[0] ? 1 : 0;
    *next = node->child[first];
    return push(s, node->child[spoilt(s, DEFECT_NEAR_AGAIN) ? first : 1 - first], entry[1 - first]);
}

/* The oriented box of a child whose box is hit; as trace.c. */
static bool oriented_missed(struct state *s, uint32_t ref, uint32_t child)
{
    const struct explain_tree *tree = s->replay->tree;
    if (!tree->packed->layout->misses)
        return false;
    float tbest = repairs(s, REPAIR_CULLING) ? s->ray->tmax : s->tbest;
    bool missed = oriented_misses(tree, s->change->repairs, s->change->defect, ref, child,
                                  &s->oblique, tbest);
    if (s->watch)
        s->watch->box(s->watch->user, child);
    struct replay_note *note = note_of(s, child);
    if (note) {
        note->oriented = true;
        note->missed = missed;
        note->above = ref;
        note->below = child;
    }
    return missed;
}

/* As trace.c of a wide layout: pushes the children hit, the nearest last. */
static bool inner_wide(struct state *s, uint32_t ref, const struct wide *node)
{
    uint32_t base = s->depth;
    for (uint32_t i = 0; i < node->child_count; i++) {
        float entry;
        if (!box_hit(s, node->child[i], &node->box[i], &entry) ||
            oriented_missed(s, ref, node->child[i]))
            continue;
        uint32_t at = s->depth;
        if (!push(s, node->child[i], entry))
            return false;
        for (; at < s->depth && at > base && s->entry[at - 1] <= entry; at--) {
            s->entry[at] = s->entry[at - 1];
            s->ref[at] = s->ref[at - 1];
        }
        if (at < s->depth) { /* not dropped */
            s->entry[at] = entry;
            s->ref[at] = node->child[i];
        }
    }
    return true;
}

static bool pop(struct state *s, uint32_t *next)
{
    while (s->depth > 0) {
        s->depth--;
        *next = s->ref[s->depth];
        if (s->rule.id == ABI_BOX_RTRS || repairs(s, REPAIR_CULLING) ||
            s->entry[s->depth] <= s->tbest)
            return true;
        struct replay_note *note = note_of(s, *next);
        if (note)
            note->skipped = true;
    }
    return false;
}

static enum replay_end walk(struct state *s)
{
    const struct explain_tree *tree = s->replay->tree;
    const struct packed *packed = tree->packed;
    float entry;
    if (packed->node_count == 0 || !packed_ref_valid(packed, packed->root))
        return REPLAY_DONE;
    uint32_t ref = packed->root;
    struct box root = explain_box(tree, s->change->repairs, ref);
    slab_rule_place(&s->rule, &s->slab, &root);
    s->oblique = oriented_ray(s->ray, &root);
    if (!box_hit(s, ref, &root, &entry))
        return REPLAY_DONE;
    for (uint32_t visits = 0; visits < s->visits_most; visits++) {
        struct explain_node node;
        bool descend = false;
        uint32_t next = 0;
        if (spoilt(s, DEFECT_LOOP) && visits >= s->change->parameter)
            return REPLAY_DONE;
        explain_load(tree, s->change->repairs, ref, &node);
        struct replay_note *note = note_of(s, ref);
        if (note)
            note->visited = true;
        if (node.wide.child_count == 0) {
            if (leaf(s, &node))
                return REPLAY_DONE;
        } else if (layout_is_wide(packed->layout) ? !inner_wide(s, ref, &node.wide)
                                                  : !inner(s, &node.wide, &next, &descend)) {
            return REPLAY_STACK;
        }
        if (!descend && !pop(s, &next))
            return REPLAY_DONE;
        ref = next;
    }
    return REPLAY_VISITS;
}

/* Every triangle, as trace_brute. */
static void all(struct state *s)
{
    for (uint32_t prim = 0; prim < s->replay->scene->tri_count; prim++) {
        if (spoilt(s, DEFECT_LOOP) && prim >= s->change->parameter)
            return;
        if (spoilt(s, DEFECT_ZERO) && prim == 0)
            continue;
        const struct item item = {.prim = prim};
        if (try_triangle(s, &item, s->best.prim != ABI_NO_PRIM && !spoilt(s, DEFECT_LAST_WINS),
                         s->best.t) &&
            s->replay->query == QUERY_ANY)
            return;
    }
}

enum replay_end replay_run(const struct explain_replay *replay, const struct replay_change *change,
                           const struct ray *ray, struct hit *out, struct replay_notes *notes)
{
    struct state s;
    s.replay = replay;
    s.change = change;
    s.slab = slab_ray_make(ray);
    s.tri = tri_ray_make(ray);
    s.ray = ray;
    s.notes = notes;
    s.watch = notes ? notes->watch : NULL;
    s.best = hit_none();
    s.tbest = ray->tmax;
    s.depth = 0;
    enum replay_end end = REPLAY_DONE;
    set_rule(&s);
    if (replay->tree) {
        uint32_t need = replay->tree->packed->stack_need;
        uint32_t most = layout_stack_most(replay->tree->packed->layout);
        s.stack_most = need < most ? need : most;
        s.visits_most = replay->tree->packed->ref_count;
        if (repairs(&s, REPAIR_STACK))
            s.stack_most = STACK_WITHOUT_END;
        if (repairs(&s, REPAIR_VISITS))
            s.visits_most = s.visits_most > UINT32_MAX / 4 ? UINT32_MAX : 4 * s.visits_most;
        end = walk(&s);
    } else {
        all(&s);
    }
    *out = end == REPLAY_DONE ? s.best : hit_none();
    return end;
}
