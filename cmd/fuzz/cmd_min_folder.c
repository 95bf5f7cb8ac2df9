/* raydiff min DIR: shrinks the smallest trial of each finding in a folder. */
#include "cmd/fuzz/cmd_min.h"

#include "fuzz/findings/findings.h"
#include "ref/base/command.h"
#include "ref/base/text.h"

#include <stdlib.h>
#include <string.h>

static void shrink_entry(const struct min_options *options, struct findings *findings, size_t i,
                         struct min_row *row)
{
    const struct findings_entry *entry = findings_entry(findings, i);
    struct findings_news news;
    row->file.signature = entry->signature; /* for the table, even if it cannot be read */
    /* A writer that was killed has written the first trial but maybe not the smallest. */
    const char *name = entry->has_smallest ? "smallest.trial" : "first.trial";
    findings_path(findings, &entry->signature, name, row->path, sizeof row->path);
    if (entry->signature.cause == CAUSE_NOT_REPEATABLE) {
        row->fate = MIN_SKIPPED; /* it may not show again, so shrinking cannot follow it */
        fail(&row->reason, STATUS_UNSUPPORTED, "not repeatable");
        return;
    }
    const struct fuzz_signature signature = entry->signature;
    enum status status = findings_get(findings, &signature, name, &row->file, &row->reason);
    min_shrink(options, row, status);
    if (row->fate == MIN_FAILED)
        row->file.signature = signature;
    if (row->fate != MIN_SMALLER)
        return;
    status = findings_offer(findings, &row->smaller, &news, &row->reason);
    if (status) {
        row->fate = MIN_FAILED;
        row->code = exit_of_status(status);
    } else if (news.smallest) {
        strcpy(row->written, row->path);
    }
}

static bool is_on(const void *user, const struct layout *layout)
{
    const struct findings *findings = user;
    for (size_t i = 0; i < findings_count(findings); i++)
        if (findings_entry(findings, i)->signature.layout == layout)
            return true;
    return false;
}

static struct list engines_of(const struct findings *findings)
{
    struct list list = {.count = 0};
    for (size_t i = 0; i < findings_count(findings); i++) {
        const struct engine *engine =
            fuzz_signature_engine(&findings_entry(findings, i)->signature);
        if (engine && !list_names(&list, engine))
            list_add(&list, TABLE_ENGINES, engine);
    }
    return list;
}

int min_folder(const struct min_options *options, const char *folder)
{
    struct findings *findings;
    struct reason reason;
    if (!findings_is_folder(folder))
        return usage_error("min", "%s is no folder of findings", folder);
    enum status status = findings_open(folder, &findings, &reason);
    if (status)
        return exit_with_reason("min", status, &reason);
    if (min_check_layouts(options, folder, is_on, findings, &reason)) {
        findings_close(findings);
        return usage_error("min", "%s", reason.text);
    }
    const struct list of = engines_of(findings);
    int unused = min_check_use(options, &of);
    if (unused >= 0) {
        findings_close(findings);
        return unused;
    }
    size_t count = findings_count(findings), smaller = 0;
    struct min_row *row = alloc_zeroed(count, sizeof *row);
    int code = row ? EXIT_AGREE : EXIT_INTERNAL;
    if (!row)
        fputs("raydiff min: out of memory\n", stderr);
    else if (count > 0)
        min_print_line(NULL);
    for (size_t i = 0; i < count && row; i++) {
        shrink_entry(options, findings, i, &row[i]);
        min_print_line(&row[i]);
        fflush(stdout);
        code = exit_worse(code, row[i].code);
        smaller += row[i].written[0] != '\0';
    }
    if (row)
        printf("%s: %s, %zu of them smaller now\n", folder, COUNTED(count, "finding"), smaller);
    findings_close(findings);
    if (row && options->json) {
        status = min_write_json(options->json, row, count, code, &reason);
        code = exit_worse(code, exit_with_reason("min", status, &reason));
    }
    for (size_t i = 0; i < count && row; i++)
        min_row_free(&row[i]);
    free(row);
    return code;
}
