#include "cmd/tree/cmd_tree_dump.h"

#include "cmd/common/cmd_json.h"
#include "ref/base/float_word.h"
#include "ref/base/json_record.h"
#include "ref/base/ray_text.h"
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

static const char *const sides[] = {"least x", "least y", "least z", "most x", "most y", "most z"};

const char *tree_lacks_text(const struct tree_told *told, char text[TREE_LACKS_TEXT])
{
    const struct dump_lacks *lacks = &told->lacks;
    char bound[FLOAT_WORD_MOST];
    snprintf(text, TREE_LACKS_TEXT, "of %u judged: %u too small", lacks->judged, lacks->small);
    if (lacks->sides == 0)
        return text;
    (void)float_word_write(lacks->most.bound, bound);
    text_append(text, TREE_LACKS_TEXT,
                ", on %u sides, by at most %s and %.3g u: instance %u, whose %s is %s and lacks "
                "%.6g",
                lacks->sides, COUNTED(lacks->most_steps, "float"), lacks->most.u,
                told->dump->instance[lacks->most.item].number, sides[lacks->most.side], bound,
                lacks->most.lacks);
    return text;
}

/* "FILE: a tree of format F, with its own triangles". */
static void print_name(const struct tree_told *told, const struct screen *screen)
{
    const struct tree_dump *dump = told->dump;
    char tree[64] = "";
    if (told->tree)
        snprintf(tree, sizeof tree, ", tree %zu below", told->tree);
    if (dump->instance)
        screen_text(screen, "%s: a top level of format %s, %s, %s\n", told->file, dump->format,
                    COUNTED(dump->tri_count, "instance"),
                    !dump->below_count ? "without the trees below"
                    : told->has_scene  ? "with the trees below"
                                       : "of which some reach beyond floats");
    else
        screen_text(screen, "%s%s: a tree of format %s, %s%s\n", told->file, tree, dump->format,
                    !told->has_scene                 ? "without a scene"
                    : told->scene && !told->compared ? "of "
                                                     : "with its own triangles",
                    told->scene && !told->compared ? told->scene : "");
    if (told->driver)
        screen_text(screen, "  driver   %s\n", told->driver);
}

static void print_tree(const struct tree_told *told, const struct screen *screen)
{
    const struct dump_report *r = &told->report;
    const struct tree_dump *dump = told->dump;
    char text[3][96], lacks[TREE_LACKS_TEXT];
    screen_text(screen,
                "  nodes    %zu, the root leads to %u: %u inner with up to %u children, %s (%u "
                "empty)\n",
                dump->node_count, r->nodes, r->inner, r->width, COUNTED(r->leaves, "leaf"),
                r->empty_leaves);
    screen_text(screen, "  leaves   %s, at most %u in one%s\n",
                dump->instance ? COUNTED(r->items, "instance") : COUNTED(r->items, "triangle"),
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
    if (told->measured)
        screen_text(screen, "  placed   %s\n", tree_lacks_text(told, lacks));
}

static void print_aimed(const struct tree_told *told, const struct screen *screen)
{
    const struct tree_aimed *a = &told->aimed;
    char ray[RAY_TEXT_MOST];
    if (!a->done)
        return;
    screen_text(screen,
                "  aimed    %u rays; %u hit an instance outside of its box first; of these %u are "
                "lost, and %u of those found in larger boxes\n",
                a->tries, a->aimed, a->lost, a->found);
    if (a->found == 0)
        return;
    (void)ray_text_write(&a->ray, ray);
    screen_record(screen, PAINT_BAD, "LOST: instance %u, %s: ray %s\n", a->instance, sides[a->side],
                  ray);
}

static void print_faults(const struct tree_told *told, const struct screen *screen)
{
    const struct dump_report *r = &told->report;
    char text[DUMP_FAULT_TEXT], sum[DUMP_FAULT_TEXT] = "";
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

static void print_differences(const struct tree_told *told, const struct screen *screen)
{
    const struct dump_differences *d = &told->differences;
    char first[96] = "";
    if (d->instances + d->triangles == 0) {
        screen_record(screen, PAINT_GOOD, "SAME: instances and triangles are those of %s\n",
                      told->scene);
        return;
    }
    if (d->triangle.geometry != DUMP_NO_NUMBER)
        snprintf(first, sizeof first, ", triangle %u of its geometry %u", d->triangle.triangle,
                 d->triangle.geometry);
    screen_record(screen, PAINT_BAD,
                  "DIFFERS: from %s: %u instances, %u triangles; first instance %u%s\n",
                  told->scene, d->instances, d->triangles, d->instance, first);
}

void tree_print(const struct tree_told *told, const struct screen *screen)
{
    print_name(told, screen);
    print_tree(told, screen);
    print_aimed(told, screen);
    print_faults(told, screen);
    for (size_t i = 0; told->below && i < told->dump->below_count; i++)
        tree_print(&told->below[i], screen);
    if (told->compared)
        print_differences(told, screen);
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
    const bool small = fault->rule == DUMP_SMALL,
               place = fault->rule == DUMP_RANGE || fault->rule == DUMP_TAKEN;
    char text[DUMP_FAULT_TEXT];
    return json_record(
        "rule=%s node=%p child=%p triangle=%p place=%p side=%p bound=%p needs=%p steps=%p by=%p "
        "text=%s",
        dump_rule_names[fault->rule], number_or_null(fault->node), number_or_null(fault->child),
        number_or_null(place ? DUMP_NONE : fault->triangle),
        number_or_null(place ? fault->triangle : DUMP_NONE),
        json_text(small || fault->rule == DUMP_NAN ? sides[fault->side] : NULL),
        small ? word_json(fault->bound) : json_null(),
        small ? word_json(fault->needs) : json_null(),
        small ? json_integer(dump_steps(fault->bound, fault->needs)) : json_null(),
        small && isfinite(fault->needs - fault->bound)
            ? json_real(fabs((double)fault->needs - (double)fault->bound))
            : json_null(),
        dump_fault_text(fault, text));
}

/* What a top level lacks, or null. */
static json_t *lacks_json(const struct tree_told *told)
{
    const struct dump_lack *most = &told->lacks.most;
    char exact[8192];
    if (!told->measured)
        return json_null();
    json_t *out = json_record("judged=%u small=%u sides=%u", told->lacks.judged, told->lacks.small,
                              told->lacks.sides);
    if (told->lacks.sides)
        json_add(out, "floats=%u u=%g u_exact=%p instance=%u side=%s bound=%p lacks=%g",
                 told->lacks.most_steps, most->u,
                 json_text(fraction_text(&most->exact, exact, sizeof exact) ? exact : NULL),
                 told->dump->instance[most->item].number, sides[most->side], word_json(most->bound),
                 most->lacks);
    return out;
}

static json_t *differences_json(const struct tree_told *told)
{
    const struct dump_differences *d = &told->differences;
    if (!told->compared)
        return json_null();
    return json_record("instances=%u triangles=%u", d->instances, d->triangles);
}

/* What was found of one tree. */
static json_t *tree_json(const struct tree_told *told)
{
    const struct dump_report *r = &told->report;
    const struct tree_dump *dump = told->dump;
    json_t *counts = json_object(), *faults = json_array();
    for (int rule = 0; rule < DUMP_RULES; rule++)
        json_object_set_new(counts, dump_rule_names[rule],
                            json_integer((json_int_t)r->count[rule]));
    for (size_t i = 0; i < r->fault_count; i++)
        json_array_append_new(faults, fault_json(&r->fault[i]));
    return json_record(
        "format=%s scene=%p with_triangles=%i splits=%i nodes=%zu reached=%u "
        "inner=%u leaves=%u empty_leaves=%u width=%u triangles=%zu largest_leaf=%u depth=%u "
        "stack=%zu bytes=%p sah=%g sah_tight=%g overlap=%g boxes_judged=%u boxes_small=%u "
        "boxes_loose=%u gap=%p faults=%zu counts=%p named=%p",
        dump->format, json_text(told->scene), told->has_scene, dump->splits, dump->node_count,
        r->nodes, r->inner, r->leaves, r->empty_leaves, r->width, (size_t)r->items, r->largest_leaf,
        r->depth, (size_t)r->stack, json_known(dump->bytes), r->sah, r->sah_tight, r->overlap,
        r->judged, r->small_boxes, r->loose,
        r->gap == 0 || r->gap == DUMP_NONE ? json_null() : json_integer(r->gap), (size_t)r->faults,
        counts, faults);
}

enum status tree_write_json(const char *path, const struct tree_told *told, int code,
                            struct reason *reason)
{
    json_t *root = json_record("raydiff=%s exit=%d file=%s", RAYDIFF_VERSION, code, told->file);
    json_t *tree = tree_json(told), *below = json_array();
    if (root && tree)
        json_object_update(root, tree);
    json_decref(tree);
    for (size_t i = 0; told->below && i < told->dump->below_count; i++)
        json_array_append_new(below, tree_json(&told->below[i]));
    if (told->dump->instance)
        json_add(root, "driver=%p instances=%u placed=%p below=%p differences=%p",
                 json_text(told->driver), told->dump->tri_count, lacks_json(told), below,
                 differences_json(told));
    else
        json_decref(below);
    if (told->aimed.done)
        json_add(root, "aimed=%u hit=%u lost=%u found=%u", told->aimed.tries, told->aimed.aimed,
                 told->aimed.lost, told->aimed.found);
    return json_write(path, tree ? root : NULL, 17, reason);
}
