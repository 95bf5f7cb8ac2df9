#include "ref/dump/dump_check.h"

#include "ref/base/float_word.h"
#include "ref/dump/dump_walk.h"
#include "ref/tree/tree_quality.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

const char *const dump_rule_names[DUMP_RULES] = {"child",   "cycle", "shared",   "unreached",
                                                 "range",   "taken", "triangle", "doubled",
                                                 "missing", "nan",   "small",    "uncovered"};

/* The overlap of deeper trees, or of those of which each triangle meets so many nodes, is left
 * out. */
#define OVERLAP_DEPTH  1000u
#define OVERLAP_VISITS ((uint64_t)1 << 20) /* of 256 triangles */

void dump_note(struct dump_notes *notes, const struct dump_fault *fault)
{
    struct dump_report *report = notes->report;
    report->faults++;
    if (report->count[fault->rule]++ >= notes->most || notes->status)
        return;
    notes->status = array_reserve(&report->fault, &notes->capacity, report->fault_count + 1,
                                  sizeof *report->fault);
    if (!notes->status)
        report->fault[report->fault_count++] = *fault;
}

/* Sorts by rule and keeps the order within it. */
static enum status sort_faults(struct dump_report *report)
{
    struct dump_fault *sorted = alloc_zeroed(report->fault_count, sizeof *sorted);
    size_t count = 0;
    if (!sorted)
        return STATUS_MEMORY;
    for (int rule = 0; rule < DUMP_RULES; rule++)
        for (size_t i = 0; i < report->fault_count; i++)
            if ((int)report->fault[i].rule == rule)
                sorted[count++] = report->fault[i];
    free(report->fault);
    report->fault = sorted;
    return STATUS_OK;
}

static void count_node(const struct dump_walk *walk, uint32_t node, uint64_t *stack,
                       struct dump_report *out)
{
    const struct dump_node *of = &walk->dump->node[node];
    const uint32_t up = walk->parent[node];
    if (up != DUMP_NONE) /* its siblings wait while it is visited */
        stack[node] = stack[up] + walk->dump->node[up].count - 1;
    out->nodes++;
    out->inner += !of->leaf;
    out->leaves += of->leaf;
    out->empty_leaves += of->count == 0;
    if (walk->depth[node] > out->depth)
        out->depth = walk->depth[node];
    if (!of->leaf && of->count > out->width)
        out->width = of->count;
    if (of->leaf && of->count > out->largest_leaf)
        out->largest_leaf = of->count;
    if (stack[node] > out->stack)
        out->stack = stack[node];
}

static enum status count_nodes(const struct dump_walk *walk, struct dump_report *out)
{
    uint64_t *stack = alloc_zeroed(walk->dump->node_count, sizeof *stack);
    if (!stack)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < walk->count; i++)
        count_node(walk, walk->order[i], stack, out);
    out->items = walk->prim_count;
    free(stack);
    return STATUS_OK;
}

/* As tree_sah, in the order of the nodes' numbers. */
static double find_sah(const struct dump_walk *walk)
{
    const struct tree_dump *dump = walk->dump;
    const double root = box_half_area_or_none(&dump->node[0].box);
    double sum = 0;
    for (size_t i = 0; i < dump->node_count; i++) {
        const struct dump_node *node = &dump->node[i];
        const double cost = node->leaf ? QUALITY_TRIANGLE * node->count : QUALITY_NODE;
        if (walk->depth[i] != DUMP_NONE)
            sum += cost * box_half_area_or_none(&node->box);
    }
    const double sah = root > 0 ? sum / root : root == 0 ? 0 : (double)NAN;
    return isfinite(sah) ? sah : (double)NAN;
}

static enum status find_overlap(const struct dump_walk *walk, const struct scene *scene,
                                double *out)
{
    struct overlap_node *node = alloc_zeroed(walk->dump->node_count, sizeof *node);
    uint32_t *child = alloc_zeroed(walk->dump->child_count, sizeof *child), put = 0;
    enum status status = node && child ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < walk->count && !status; i++) {
        const uint32_t number = walk->order[i];
        const struct dump_node *of = &walk->dump->node[number];
        node[number] = (struct overlap_node){.box = of->box,
                                             .child_first = put,
                                             .item_first = walk->first[i],
                                             .item_end = walk->end[i]};
        for (uint32_t k = 0; k < of->count && !of->leaf; k++)
            if (walk->child[(size_t)of->first + k] != DUMP_NONE)
                child[put++] = walk->child[(size_t)of->first + k];
        node[number].child_count = (uint32_t)(put - node[number].child_first);
    }
    if (!status)
        status =
            overlap_measure(&(struct overlap_tree){.node = node,
                                                   .child = child,
                                                   .prim = walk->prim,
                                                   .node_count = (uint32_t)walk->dump->node_count,
                                                   .prim_count = walk->prim_count,
                                                   .tri_count = walk->tri_count},
                            scene, DUMP_OVERLAP_MOST, OVERLAP_VISITS, out);
    free(node);
    free(child);
    return status;
}

enum status dump_check(const struct tree_dump *dump, const struct scene *scene, size_t most,
                       bool overlap, struct dump_report *out, struct reason *reason)
{
    *out = (struct dump_report){.sah_tight = (double)NAN, .overlap = (double)NAN};
    if (scene && dump->tri_known && dump->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "a tree of %u triangles, the scene has %u",
                    dump->tri_count, scene->tri_count);
    struct dump_notes notes = {.report = out, .most = most};
    struct dump_walk walk;
    enum status status = dump_walk_make(dump, scene, &notes, &walk);
    if (!status)
        status = count_nodes(&walk, out);
    if (!status)
        status = dump_boxes(&walk, scene, &notes);
    if (!status && notes.status == STATUS_OK)
        status = sort_faults(out);
    for (size_t i = 0; i < out->fault_count && dump->instance; i++)
        out->fault[i].instance = true;
    if (!status) {
        out->sah = find_sah(&walk);
        if (scene && overlap && !dump->instance && out->depth <= OVERLAP_DEPTH)
            status = find_overlap(&walk, scene, &out->overlap);
    }
    dump_walk_free(&walk);
    status = status ? status : notes.status;
    if (status) {
        free(out->fault);
        *out = (struct dump_report){0};
        return fail(reason, status, "no memory to check a tree of %zu nodes", dump->node_count);
    }
    return STATUS_OK;
}

/* Floats in a row, with both zeros as one. */
static int64_t rank_of_float(float x)
{
    const int64_t size = float_bits(x) & 0x7FFFFFFF;
    return float_bits(x) >> 31 ? -size : size;
}

uint32_t dump_steps(float from, float to)
{
    return (uint32_t)llabs(rank_of_float(to) - rank_of_float(from));
}

float dump_step(float x, int32_t by)
{
    const int64_t most = 0x7F800000;
    int64_t rank = rank_of_float(x) + by;
    if (isnan(x) || by == 0)
        return x;
    rank = rank > most ? most : rank < -most ? -most : rank;
    return float_from_bits(rank < 0 ? (uint32_t)-rank | 0x80000000u : (uint32_t)rank);
}

static const char *side_name(unsigned side)
{
    static const char *const name[] = {"least x", "least y", "least z",
                                       "most x",  "most y",  "most z"};
    return name[side];
}

/* The difference of two floats is exact in double unless they are of very different size. */
static void small_text(const struct dump_fault *fault, char text[DUMP_FAULT_TEXT])
{
    char bound[FLOAT_WORD_MOST], needs[FLOAT_WORD_MOST];
    const uint32_t steps = dump_steps(fault->bound, fault->needs);
    const bool leaf = fault->triangle == DUMP_NONE;
    const char *what = leaf ? "leaf" : fault->instance ? "instance" : "triangle";
    (void)float_word_write(fault->bound, bound);
    (void)float_word_write(fault->needs, needs);
    snprintf(
        text, DUMP_FAULT_TEXT,
        "node %u: its box is too small: its %s is %s, and %s %u has %s: %" PRIu32 " step%s, %.9g",
        fault->node, side_name(fault->side), bound, what, leaf ? fault->child : fault->triangle,
        needs, steps, steps == 1 ? "" : "s", fabs((double)fault->needs - (double)fault->bound));
}

const char *dump_fault_text(const struct dump_fault *fault, char text[DUMP_FAULT_TEXT])
{
    static const char *const of_child[] = {[DUMP_CHILD] = "there is no such node",
                                           [DUMP_CYCLE] = "a node that leads to this one",
                                           [DUMP_SHARED] = "a child of a node already"};
    static const char *const of_triangle[] = {
        [DUMP_RANGE] = "its triangles leave the list at place",
        [DUMP_TAKEN] = "another leaf has place",
        [DUMP_TRIANGLE] = "there is no triangle",
        [DUMP_DOUBLED] = "a leaf has already triangle",
        [DUMP_UNCOVERED] = "no leaf's box below has a part of triangle"};
    switch (fault->rule) {
    case DUMP_CHILD:
    case DUMP_CYCLE:
    case DUMP_SHARED:
        snprintf(text, DUMP_FAULT_TEXT, "node %u: child %u: %s", fault->node, fault->child,
                 of_child[fault->rule]);
        break;
    case DUMP_UNREACHED:
        snprintf(text, DUMP_FAULT_TEXT, "node %u: the root does not lead to it", fault->node);
        break;
    case DUMP_MISSING:
        snprintf(text, DUMP_FAULT_TEXT, "triangle %u: it is in no leaf", fault->triangle);
        break;
    case DUMP_NAN:
        snprintf(text, DUMP_FAULT_TEXT, "node %u: the %s of its box is no number", fault->node,
                 side_name(fault->side));
        break;
    case DUMP_SMALL:
        small_text(fault, text);
        break;
    default:
        snprintf(text, DUMP_FAULT_TEXT, "node %u: %s %u", fault->node,
                 fault->instance && fault->rule == DUMP_DOUBLED ? "a leaf has already instance"
                                                                : of_triangle[fault->rule],
                 fault->triangle);
    }
    return text;
}
