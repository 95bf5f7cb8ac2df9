/* Dumps of our own trees. Includes cmocka.h, whose macros must come last. */
#ifndef TREES_DUMP_FIXTURE_H
#define TREES_DUMP_FIXTURE_H

#include "ref/dump/dump_check.h"
#include "ref/tree/tree_quality.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

/* A scene, one of our trees of it, and its dump. */
struct dumped {
    struct scene scene;
    struct bvh bvh;
    struct tree_dump dump;
};

static inline struct dumped dumped_make(struct scene scene, const char *builder, uint32_t leaf)
{
    struct dumped d = {.scene = scene};
    const struct build_options options = {.leaf = leaf};
    assert_int_equal(builder_find(builder)->build(&d.scene, &options, &d.bvh, NULL), STATUS_OK);
    assert_int_equal(tree_dump_make(&d.bvh, &d.dump), STATUS_OK);
    return d;
}

static inline void dumped_free(struct dumped *d)
{
    tree_dump_free(&d->dump);
    bvh_free(&d->bvh);
    scene_free(&d->scene);
}

/* The text of a dump, which the caller frees. */
static inline char *dump_text(const struct tree_dump *dump, size_t *size)
{
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    assert_non_null(stream);
    tree_dump_write(dump, stream);
    assert_int_equal(fclose(stream), 0);
    return text;
}

static inline struct tree_dump dump_read_again(const struct tree_dump *dump)
{
    size_t size;
    struct reason reason = {""};
    struct tree_dump again;
    char *text = dump_text(dump, &size);
    if (tree_dump_read("again", text, size, DUMP_GUESSED, &again, &reason))
        fail_msg("%s", reason.text);
    free(text);
    return again;
}

/* What is found; the caller frees its faults. */
static inline struct dump_report dump_found(const struct tree_dump *dump, const struct scene *scene)
{
    struct dump_report report;
    struct reason reason = {""};
    if (dump_check(dump, scene, SIZE_MAX, true, &report, &reason))
        fail_msg("%s", reason.text);
    uint64_t sum = 0;
    for (int rule = 0; rule < DUMP_RULES; rule++)
        sum += report.count[rule];
    assert_int_equal(sum, report.faults);
    return report;
}

static inline uint64_t dump_faults(const struct tree_dump *dump, const struct scene *scene)
{
    struct dump_report report = dump_found(dump, scene);
    free(report.fault);
    return report.faults;
}

/* The only fault of that rule. */
static inline struct dump_fault dump_fault_of(const struct dump_report *report, enum dump_rule rule)
{
    struct dump_fault found = {0};
    assert_int_equal(report->count[rule], 1);
    for (size_t i = 0; i < report->fault_count; i++)
        if (report->fault[i].rule == rule)
            found = report->fault[i];
    assert_int_equal(found.rule, rule);
    return found;
}

#endif
