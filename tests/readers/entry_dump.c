/* Trees of other programs: our text, files of tinybvh, bvh v2, lavapipe and RADV. Whatever a file
 * says of its nodes, the check ends, names faults in printable lines, and the tree goes through our
 * text. */
#define _POSIX_C_SOURCE 200809L
#include "tests/readers/reader_entry.h"
#include "ref/dump/dump_check.h"
#include "ref/dump/dump_instances.h"
#include "scenes/scenes.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define NAMED 5u

static void must_be_report(const struct tree_dump *dump, const struct dump_report *report)
{
    uint64_t sum = 0;
    size_t named = 0;
    for (int rule = 0; rule < DUMP_RULES; rule++) {
        sum += report->count[rule];
        const bool once = rule == DUMP_UNCOVERED && report->count[rule];
        named += once ? 1 : report->count[rule] < NAMED ? report->count[rule] : NAMED;
    }
    READER_MUST(sum == report->faults && named == report->fault_count);
    READER_MUST(report->nodes <= dump->node_count &&
                report->inner + report->leaves == report->nodes);
    READER_MUST(report->loose <= report->judged && report->small_boxes <= report->judged);
    READER_MUST(report->items <= dump->item_count && report->depth < report->nodes);
    for (size_t i = 0; i < report->fault_count; i++) {
        char text[DUMP_FAULT_TEXT];
        for (const char *at = dump_fault_text(&report->fault[i], text); *at; at++)
            READER_MUST(isprint((unsigned char)*at));
        READER_MUST(report->fault[i].node == DUMP_NONE || report->fault[i].node < dump->node_count);
    }
}

/* Returns whether all of it lies within its arrays. */
static bool check(const struct tree_dump *dump, const struct scene *scene)
{
    struct dump_report report;
    struct reason reason = {""};
    enum status status = dump_check(dump, scene, NAMED, true, &report, &reason);
    READER_MUST(status == STATUS_OK || (status == STATUS_INPUT && scene));
    if (status) {
        reader_must_be_reason(&reason);
        return false;
    }
    must_be_report(dump, &report);
    /* What was not looked at may have ranges beyond the list. */
    const bool looked =
        report.nodes == dump->node_count && !report.count[DUMP_RANGE] && !report.count[DUMP_TAKEN];
    free(report.fault);
    return looked;
}

static char *text_of(const struct tree_dump *dump, size_t *size)
{
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    READER_MUST(stream);
    tree_dump_write(dump, stream);
    READER_MUST(fclose(stream) == 0);
    return text;
}

/* Its text is read as a tree with that text. */
static void must_come_again(const struct tree_dump *dump)
{
    struct tree_dump again;
    struct reason reason = {""};
    size_t size[2];
    reader_count_limit(false);
    char *text = text_of(dump, &size[0]);
    READER_MUST(tree_dump_read("again", text, size[0], DUMP_GUESSED, &again, &reason) == STATUS_OK);
    char *other = text_of(&again, &size[1]);
    READER_MUST(size[0] == size[1] && memcmp(text, other, size[0]) == 0);
    tree_dump_free(&again);
    free(other);
    free(text);
    reader_count_limit(true);
}

/* What the boxes of a top level lack, and the trees below it. */
static void check_levels(const struct tree_dump *dump)
{
    struct dump_lacks lacks;
    struct reason reason = {""};
    if (dump->instance && dump->scene.tri_count) {
        READER_MUST(dump_measure(dump, &lacks, &reason) == STATUS_OK);
        READER_MUST(lacks.small <= lacks.judged && lacks.small <= lacks.sides);
        READER_MUST(!lacks.sides || lacks.most.u > 0);
        free(lacks.side);
    }
    for (size_t i = 0; i < dump->below_count; i++)
        (void)check(&dump->below[i], &dump->below[i].scene);
}

static bool play(const char *bytes, size_t size)
{
    struct scene scene;
    struct tree_dump dump;
    struct reason reason = {""};
    READER_MUST(scene_open("soup:n=4,seed=1", 1, &scene, &reason) == STATUS_OK);
    bool taken = false;
    for (unsigned format = 0; format <= DUMP_FORMATS; format++) {
        enum status status = tree_dump_read("fuzz", bytes, size, format, &dump, &reason);
        READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
        if (status) {
            READER_MUST(!dump.node && !dump.child && !dump.item && !dump.spec);
            reader_must_be_reason(&reason);
            continue;
        }
        taken = true;
        if (dump.scene.tri_count) {
            reader_must_be_scene(&dump.scene);
            (void)check(&dump, &dump.scene);
        } else {
            (void)check(&dump, &scene);
        }
        check_levels(&dump);
        if (check(&dump, NULL))
            must_come_again(&dump);
        tree_dump_free(&dump);
    }
    scene_free(&scene);
    return taken;
}

const struct reader_entry reader_entry = {"dump", 1 << 18, play};
