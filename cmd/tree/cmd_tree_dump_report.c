#include "cmd/tree/cmd_tree_dump.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/float_word.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* A measure, or a dash where there is none. */
static const char *measure(double value, char text[96])
{
    if (isnan(value))
        return "-";
    snprintf(text, 96, "%.6g", value);
    return text;
}

/* What would mend boxes that leave parts of triangles uncovered. */
static const char *gap_text(uint32_t gap, char text[96])
{
    if (gap == 0)
        return "";
    if (gap == DUMP_NONE)
        return "; they would do grown by no 65536 floats";
    snprintf(text, 96, "; they would do grown by %s on each side", COUNTED(gap, "float"));
    return text;
}

static void print_tree(const struct tree_told *told, const struct screen *screen)
{
    const struct dump_report *r = told->report;
    const struct tree_dump *dump = told->dump;
    char text[3][96];
    screen_text(screen, "%s: a tree of format %s, %s%s\n", told->file, dump->format,
                !told->has_scene ? "without a scene"
                : told->scene    ? "of "
                                 : "with its own triangles",
                told->scene ? told->scene : "");
    screen_text(screen,
                "  nodes    %zu, the root leads to %u: %u inner with up to %u children, %s (%u "
                "empty)\n",
                dump->node_count, r->nodes, r->inner, r->width, COUNTED(r->leaves, "leaf"),
                r->empty_leaves);
    screen_text(screen, "  leaves   %s, at most %u in one%s\n", COUNTED(r->items, "triangle"),
                r->largest_leaf, dump->splits ? "; they may be split" : "");
    screen_text(screen, "  depth    %u, so a stack of at most %" PRIu64 "\n", r->depth, r->stack);
    if (dump->bytes)
        screen_text(screen, "  bytes    %" PRIu64 " of nodes\n", dump->bytes);
    screen_text(screen, "  SAH      %s, with exact boxes %s; overlap %s\n",
                measure(r->sah, text[0]), measure(r->sah_tight, text[1]),
                measure(r->overlap, text[2]));
    if (dump->splits)
        screen_text(screen, "  boxes    hold parts of triangles: judged together%s\n",
                    gap_text(r->gap, text[0]));
    else
        screen_text(screen, "  boxes    of %u judged: %u too small, %u larger than need be\n",
                    r->judged, r->small_boxes, r->loose);
}

void tree_print(const struct tree_told *told, const struct screen *screen)
{
    const struct dump_report *r = told->report;
    char text[DUMP_FAULT_TEXT], sum[DUMP_FAULT_TEXT] = "";
    print_tree(told, screen);
    for (size_t i = 0; i < r->fault_count; i++)
        screen_record(screen, PAINT_BAD, "FAULT %s: %s\n", dump_rule_names[r->fault[i].rule],
                      dump_fault_text(&r->fault[i], text));
    for (int rule = 0; rule < DUMP_RULES; rule++)
        if (r->count[rule])
            text_append(sum, sizeof sum, "%s%s %" PRIu64, *sum ? ", " : "", dump_rule_names[rule],
                        r->count[rule]);
    if (r->faults)
        screen_record(screen, PAINT_BAD, "FAULTY: %s: %s\n", COUNTED(r->faults, "fault"), sum);
    else
        screen_record(screen, PAINT_GOOD, "SOUND%s\n",
                      told->has_scene ? "" : ", as far as a tree tells without its triangles");
}

static json_t *number_or_null(uint32_t number)
{
    return number == DUMP_NONE ? json_null() : json_integer(number);
}

static json_t *word_json(float x)
{
    char text[FLOAT_WORD_MOST];
    (void)float_word_write(x, text);
    return json_string(text);
}

static json_t *fault_json(const struct dump_fault *fault)
{
    static const char *const side[] = {"least x", "least y", "least z",
                                       "most x",  "most y",  "most z"};
    const bool small = fault->rule == DUMP_SMALL,
               place = fault->rule == DUMP_RANGE || fault->rule == DUMP_TAKEN;
    char text[DUMP_FAULT_TEXT];
    return json_record(
        "rule=%s node=%p child=%p triangle=%p place=%p side=%p bound=%p needs=%p steps=%p by=%p "
        "text=%s",
        dump_rule_names[fault->rule], number_or_null(fault->node), number_or_null(fault->child),
        number_or_null(place ? DUMP_NONE : fault->triangle),
        number_or_null(place ? fault->triangle : DUMP_NONE),
        json_text(small || fault->rule == DUMP_NAN ? side[fault->side] : NULL),
        small ? word_json(fault->bound) : json_null(),
        small ? word_json(fault->needs) : json_null(),
        small ? json_integer(dump_steps(fault->bound, fault->needs)) : json_null(),
        small && isfinite(fault->needs - fault->bound)
            ? json_real(fabs((double)fault->needs - (double)fault->bound))
            : json_null(),
        dump_fault_text(fault, text));
}

enum status tree_write_json(const char *path, const struct tree_told *told, int code,
                            struct reason *reason)
{
    const struct dump_report *r = told->report;
    const struct tree_dump *dump = told->dump;
    json_t *file = json_string(told->file), *scene = json_text(told->scene);
    if (!file || !scene) {
        json_decref(file);
        json_decref(scene);
        return fail(reason, STATUS_INPUT, "%s: a name that is not UTF-8 cannot be written to JSON",
                    told->file);
    }
    json_t *counts = json_object(), *faults = json_array();
    for (int rule = 0; rule < DUMP_RULES; rule++)
        json_object_set_new(counts, dump_rule_names[rule],
                            json_integer((json_int_t)r->count[rule]));
    for (size_t i = 0; i < r->fault_count; i++)
        json_array_append_new(faults, fault_json(&r->fault[i]));
    json_t *root = json_record(
        "raydiff=%s exit=%d file=%p format=%s scene=%p with_triangles=%i splits=%i nodes=%zu "
        "reached=%u "
        "inner=%u leaves=%u empty_leaves=%u width=%u triangles=%zu largest_leaf=%u depth=%u "
        "stack=%zu bytes=%p sah=%g sah_tight=%g overlap=%g boxes_judged=%u boxes_small=%u "
        "boxes_loose=%u gap=%p faults=%zu counts=%p named=%p",
        RAYDIFF_VERSION, code, file, dump->format, scene, told->has_scene, dump->splits,
        dump->node_count, r->nodes, r->inner, r->leaves, r->empty_leaves, r->width,
        (size_t)r->items, r->largest_leaf, r->depth, (size_t)r->stack, json_known(dump->bytes),
        r->sah, r->sah_tight, r->overlap, r->judged, r->small_boxes, r->loose,
        r->gap == 0 || r->gap == DUMP_NONE ? json_null() : json_integer(r->gap), (size_t)r->faults,
        counts, faults);
    return json_write(path, root, 17, reason);
}
