/* Exported findings, for the tests of the exporter. */
#ifndef TESTS_EXPORTED_H
#define TESTS_EXPORTED_H

#define _GNU_SOURCE /* open_memstream, mkdtemp, memmem */

#include "fuzz/export/export_inner.h"
#include "fuzz/gen/gen.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* A driver that is nowhere: nothing is asked, and Vulkan's specification holds. */
#define NO_DRIVER "no-such-driver"

static inline struct finding_file corpus_file(const char *name)
{
    char path[128];
    struct finding_file file;
    struct reason reason;
    snprintf(path, sizeof path, "fuzz/corpus/%s.trial", name);
    if (finding_file_read(path, &file, &reason))
        fail_msg("%s", reason.text);
    return file;
}

/* A trial of generated triangles and rays; closest unless that is said. */
static inline struct finding_file generated_file(uint64_t index, uint32_t rays, enum query query)
{
    const struct gen_options options = {.triangles_least = 16, .triangles_most = 24, .rays = rays};
    struct finding_file file = {0};
    struct reason reason;
    if (gen_trial(20, index, &options, &file.trial, &reason))
        fail_msg("%s", reason.text);
    file.trial.query = query;
    file.trial.step_count = 0; /* others are refused */
    return file;
}

static inline struct export_options options_of(enum export_form form, const char *engine,
                                               const char *layout)
{
    return (struct export_options){.form = form,
                                   .engine = engine ? engine_find(engine) : NULL,
                                   .layout = layout ? layout_find(layout) : NULL,
                                   .ray = EXPORT_ALL_RAYS,
                                   .engines = {.device = -1}};
}

/* What is written; the caller frees it. */
static inline char *exported(const struct finding_file *file, const struct export_options *options,
                             struct export_said *said)
{
    char *text = NULL;
    size_t size = 0;
    struct reason reason;
    struct export_said unused;
    FILE *to = open_memstream(&text, &size);
    assert_non_null(to);
    if (export_write(file, options, to, said ? said : &unused, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(fclose(to), 0);
    return text;
}

/* Everything that would be written, of an engine that is not here, until the next call. */
static inline struct export_case make_case(const struct finding_file *file, const char *engine,
                                           const char *layout)
{
    static struct export_options options; /* the case points to it */
    struct export_case the;
    struct reason reason;
    options = options_of(EXPORT_C, engine, layout);
    options.engines.driver = NO_DRIVER;
    if (export_case_make(file, &options, &the, &reason))
        fail_msg("%s", reason.text);
    return the;
}

#endif
