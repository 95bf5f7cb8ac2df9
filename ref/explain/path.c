#include "ref/explain/path.h"

#include "ref/explain/oriented.h"
#include "ref/explain/steps.h"
#include "ref/judge/ray_triangle.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdlib.h>

const char *explain_end_name(enum explain_end end)
{
    static const char *const names[] = {
        [END_NOWHERE] = "nowhere",     [END_BOX] = "box",   [END_SKIPPED] = "skipped",
        [END_REFERENCE] = "reference", [END_SLOT] = "slot", [END_TRIANGLE] = "triangle",
        [END_FARTHER] = "farther",     [END_HIT] = "hit",   [END_ORIENTED] = "oriented_box",
    };
    return names[end];
}

static void describe_bound(float decoded, float canonical, float exact, bool upper,
                           struct explain_bound *out)
{
    double outward = upper ? 1.0 : -1.0;
    *out = (struct explain_bound){
        .exact = exact,
        .canonical = canonical,
        .decoded = decoded,
        .fault = explain_bound_fault(decoded, canonical, exact, upper),
        .half_steps = outward * half_steps(exact, decoded),
        .float_steps = (upper ? 1 : -1) * float_steps(exact, decoded),
    };
}

/* A bound of an oriented box, of which the tree has none: within a step of the stored bounds is a
 * matter of rounding. */
static void describe_oriented(float decoded, float exact, float step, bool upper,
                              struct explain_bound *out)
{
    double inward = upper ? (double)exact - (double)decoded : (double)decoded - (double)exact;
    describe_bound(decoded, exact, exact, upper, out);
    out->fault = inward > (double)step ? BOUND_STORED : inward > 0 ? BOUND_ROUNDED : BOUND_OK;
}

static void describe_tilt(const struct explain_case *the, struct explain_step *step)
{
    const struct explain_tree *tree = the->replay.tree;
    const struct packed *packed = tree->packed;
    const struct replay_note *note = &step->note;
    struct explain_oriented *out = &step->oriented;
    float lo[3], hi[3];
    if (!note->oriented || !oriented_needs(tree, note->above, note->below, lo, hi))
        return;
    const struct box root = packed->layout->box(packed, packed->root);
    const struct oblique_ray ray = oriented_ray(&the->ray, &root);
    out->missed = note->missed;
    out->there = packed->layout->oblique(packed, note->above, note->below, &ray, &out->box);
    for (uint32_t j = 0; j < 3; j++) {
        const struct oblique_box *box = &out->box;
        describe_oriented(box->lo[j], lo[j], box->step[j], false, &out->lo[j]);
        describe_oriented(box->hi[j], hi[j], box->step[j], true, &out->hi[j]);
        oriented_axis_exact(box, &ray, j, &out->exact_enter[j], &out->exact_leave[j]);
    }
}

/* Describes the box as it is decoded, of the tree, and of its triangles. */
static void describe_boxes(const struct explain_case *the, const struct box *decoded,
                           const struct box *canonical, const struct box *exact,
                           struct explain_step *step)
{
    const struct packed *packed = the->replay.tree->packed;
    struct slab_rule rule = slab_rule_of(the->replay.box_id);
    struct slab_ray slab = slab_ray_make(&the->ray);
    for (int k = 0; k < 3; k++) {
        describe_bound(decoded->lo[k], canonical->lo[k], exact->lo[k], false, &step->lo[k]);
        describe_bound(decoded->hi[k], canonical->hi[k], exact->hi[k], true, &step->hi[k]);
        slab_axis_of(&rule, &slab, decoded, k, &step->slab[k]);
    }
    describe_tilt(the, step);
    uint64_t words = packed->layout->node_bytes / 4;
    uint64_t first = words * step->record;
    for (uint64_t i = 0; i < words && i < ARRAY_COUNT(step->word); i++)
        if (first + i < packed->word_count)
            step->word[step->word_count++] = packed->word[first + i];
}

static void describe_step(const struct explain_case *the, struct explain_step *step)
{
    const struct explain_tree *tree = the->replay.tree;
    uint32_t node = step->note.node;
    step->record = tree->record[node];
    step->leaf = tree->bvh->node[node].item_count > 0;
    step->ref = explain_ref_fault(tree, node);
    if (step->record == EXPLAIN_NONE)
        return;
    struct box decoded =
        tree->box ? tree->box[node] : tree->packed->layout->box(tree->packed, step->record);
    describe_boxes(the, &decoded, &tree->bvh->node[node].bounds, &tree->exact[node], step);
}

/* The last step, if what is packed there is no node of the tree. */
static void describe_part(const struct explain_case *the, uint32_t leaf, struct explanation *out)
{
    const struct explain_tree *tree = the->replay.tree;
    if (!out->notes.part.tested)
        return;
    struct explain_step *step = &out->step[out->step_count++];
    step->note = out->notes.part;
    step->note.node = leaf;
    step->record = step->note.below;
    struct wide wide;
    tree->packed->layout->load(tree->packed, step->record, &wide);
    step->leaf = wide.child_count == 0;
    struct box decoded = tree->packed->layout->box(tree->packed, step->record);
    struct box exact;
    (void)explain_names(tree, step->record, out->prim, &exact);
    describe_boxes(the, &decoded, &exact, &exact, step);
}

/* A node that a collapse left out is no step. */
static bool is_step(const struct explain_tree *tree, uint32_t node)
{
    return !layout_is_wide(tree->packed->layout) || tree->record[node] != EXPLAIN_NONE;
}

/* Where the ray meets the triangle's plane, about; false if it runs along it. */
static bool meeting_point(const struct explain_case *the, uint32_t prim, double point[3])
{
    float v[3][3];
    scene_tri(the->replay.tree->scene, prim, v);
    double t = judge_plane_t(&the->ray, v);
    for (int k = 0; k < 3; k++)
        point[k] = (double)the->ray.org[k] + (double)the->ray.dir[k] * t;
    return isfinite(t);
}

/* How far a point is outside a box. */
static double distance_outside(const double point[3], const struct box *box)
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fmax((double)box->lo[k] - point[k], point[k] - (double)box->hi[k]));
    return most;
}

/* The triangle's leaf; in a split tree the one where the ray meets it. */
static uint32_t leaf_of(const struct explain_case *the, uint32_t prim)
{
    const struct explain_tree *tree = the->replay.tree;
    const struct bvh *bvh = tree->bvh;
    uint32_t leaf = tree->leaf[prim];
    double point[3], least = INFINITY;
    if (!bvh_is_split(bvh) || !meeting_point(the, prim, point))
        return leaf;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        for (uint32_t k = 0; k < bvh->node[i].item_count; k++) {
            double distance = distance_outside(point, &bvh->node[i].bounds);
            if (bvh->prim[bvh->node[i].item_first + k] != prim || !(distance < least))
                continue;
            least = distance;
            leaf = i;
        }
    return leaf;
}

/* The nodes from the root to the triangle's leaf, as notes for the replay. */
static enum status find_path(const struct explain_tree *tree, uint32_t leaf,
                             struct explanation *out)
{
    uint32_t depth = 0;
    for (uint32_t node = leaf; node != EXPLAIN_NONE; node = tree->parent[node])
        depth += is_step(tree, node);
    out->step = alloc_zeroed((size_t)depth + 1, sizeof *out->step); /* and a part of a leaf */
    if (!out->step)
        return STATUS_MEMORY;
    out->step_count = depth;
    for (uint32_t node = leaf; node != EXPLAIN_NONE; node = tree->parent[node])
        if (is_step(tree, node))
            out->step[--depth].note.node = node;
    return STATUS_OK;
}

/* Which slot of its leaf holds the triangle, and what is read there. */
static void find_slot(const struct explain_tree *tree, uint32_t index, struct explanation *out)
{
    const struct bvh_node *leaf = &tree->bvh->node[index];
    while (tree->bvh->prim[leaf->item_first + out->slot] != out->prim)
        out->slot++;
    (void)explain_item_fault(tree, index, out->slot, &out->slot_stored);
}

static enum explain_end triangle_end(const struct explanation *out, bool entered)
{
    if (!out->notes.prim_tested)
        return entered ? END_SLOT : END_NOWHERE;
    if (!out->notes.prim_accepted)
        return END_TRIANGLE;
    return out->notes.prim_kept ? END_HIT : END_FARTHER;
}

/* Where the plain replay left the path. A triangle can be tested although its leaf was not entered:
 * then another leaf names it. */
static void find_end(struct explanation *out)
{
    for (uint32_t i = 0; i < out->step_count; i++) {
        const struct replay_note *note = &out->step[i].note;
        out->last = i;
        if (note->missed) {
            out->end = END_ORIENTED;
            return;
        }
        if (note->visited)
            continue;
        out->end = END_REFERENCE;
        if (note->tested)
            out->end = note->hit ? END_SKIPPED : END_BOX;
        return;
    }
    out->end = triangle_end(out, true);
}

enum status explain_path(const struct explain_case *the, struct explanation *out)
{
    const struct explain_tree *tree = the->replay.tree;
    struct replay_change plain = {0};
    struct hit hit;
    out->notes = (struct replay_notes){.prim = out->prim};
    if (out->prim == ABI_NO_PRIM)
        return STATUS_OK;
    uint32_t leaf = tree ? tree->leaf[out->prim] : EXPLAIN_NONE;
    if (leaf != EXPLAIN_NONE) {
        leaf = leaf_of(the, out->prim);
        if (find_path(tree, leaf, out))
            return STATUS_MEMORY;
        find_slot(tree, leaf, out);
    }
    struct replay_note *note = alloc_zeroed(out->step_count, sizeof *note);
    if (!note)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < out->step_count; i++)
        note[i].node = out->step[i].note.node;
    out->notes.step = note;
    out->notes.count = out->step_count;
    (void)replay_run(&the->replay, &plain, &the->ray, &hit, &out->notes);
    for (uint32_t i = 0; i < out->step_count; i++) {
        out->step[i].note = note[i];
        describe_step(the, &out->step[i]);
    }
    free(note);
    out->notes.step = NULL;
    if (leaf != EXPLAIN_NONE)
        describe_part(the, leaf, out);
    if (out->step_count > 0)
        find_end(out);
    else
        out->end = triangle_end(out, false);
    return STATUS_OK;
}
