/* raydiff merge: joins the findings of several campaigns, such as shards, in one folder. */
#include "fuzz/findings/findings.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_tables.h"
#include "ref/base/command.h"

struct merge_options {
    const char *to;
    struct list layout;
};

static enum status take_layouts(void *options, const struct option_value *given,
                                struct reason *reason)
{
    return list_bring_layouts(&((struct merge_options *)options)->layout, given->text, reason);
}

#define ROWS_OF struct merge_options

static const struct option_row rows[] = {
    {"to", "DIR", "the new folder; it must not exist or be empty", OF_FOLDER(to)},
    {"layout", "L,..", "brings FILE.so, a layout from outside, to findings on it",
     OF_OWN(take_layouts), .file = true, .repeats = true},
    {0},
};

static const struct option_set set = {
    .command = "merge",
    .usage = "merge --to DIR DIR...",
    .about = "Joins folders of raydiff fuzz into a new one: of each distinct finding the counts "
             "are added, the first and the smallest trial are kept. Shards of a campaign give "
             "what one run gives.",
    .group = {GROUP(rows)},
    .codes = "0 done, 2 bad input, 4 internal error",
    .example = "fuzz --trials 200 --shard 1/2 --dir shard1\n"
               "fuzz --trials 200 --shard 2/2 --dir shard2\n"
               "merge --to all shard1 shard2",
};

static uint64_t total(const struct findings *findings)
{
    uint64_t count = 0;
    for (size_t i = 0; i < findings_count(findings); i++)
        count += findings_entry(findings, i)->count;
    return count;
}

static enum status print_folder(const char *folder, const char *what, bool list,
                                struct reason *reason)
{
    struct findings *findings;
    enum status status = findings_look(folder, &findings, reason);
    if (status)
        return status;
    printf("%-6s %s: %zu distinct, %llu in all%s%s\n", what, folder, findings_count(findings),
           (unsigned long long)total(findings), findings_said(findings)[0] ? "; " : "",
           findings_said(findings));
    for (size_t i = 0; i < findings_count(findings) && list; i++) {
        const struct findings_entry *entry = findings_entry(findings, i);
        char signature[FUZZ_SIGNATURE_MOST];
        fuzz_signature_print(&entry->signature, signature);
        printf("%8llu  %s  smallest: %u triangle%s, %u ray%s\n", (unsigned long long)entry->count,
               signature, entry->smallest.triangles, plural(entry->smallest.triangles),
               entry->smallest.rays, plural(entry->smallest.rays));
    }
    findings_close(findings);
    return STATUS_OK;
}

int cmd_merge(int argc, char **argv)
{
    struct merge_options options = {.to = NULL};
    struct reason reason = {""};
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    const char *to = options.to;
    if (!to)
        return usage_error("merge", "--to DIR is needed");
    if (first == argc)
        return usage_error("merge", "no folder given");
    enum status status = STATUS_OK;
    for (int i = first; i < argc && !status; i++)
        status = print_folder(argv[i], "from", false, &reason);
    if (!status)
        status =
            findings_merge((const char *const *)argv + first, (size_t)(argc - first), to, &reason);
    if (!status)
        status = print_folder(to, "to", true, &reason);
    return exit_with_reason("merge", status, &reason);
}
