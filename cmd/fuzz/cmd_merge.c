/* raydiff merge: findings of several campaigns, such as shards, in one folder. */
#include "fuzz/findings/findings.h"
#include "cmd/common/cmd_options.h"
#include "ref/base/command.h"

static const char help[] =
    "usage: raydiff merge --to DIR DIR...\n"
    "Joins folders of raydiff fuzz into a new one: of each distinct finding the counts are added,\n"
    "the first and the smallest trial are kept. Shards of a campaign give what one run gives.\n\n"
    "  --to DIR   the new folder; it must not exist or be empty\n\n"
    "exit codes: 0 done, 2 bad input, 4 internal error\n"
    "example: raydiff merge --to all shard1 shard2 shard3\n";

enum { OPT_TO = 256 };

static const struct option long_options[] = {
    {"to", 1, NULL, OPT_TO}, {"help", 0, NULL, OPT_HELP}, {NULL, 0, NULL, 0}};

static void print_help(void)
{
    fputs(help, stdout);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    if (option != OPT_TO)
        return fail(reason, STATUS_INPUT, "unknown option");
    *(const char **)user = text;
    return STATUS_OK;
}

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
               signature, entry->smallest.triangles, entry->smallest.triangles == 1 ? "" : "s",
               entry->smallest.rays, entry->smallest.rays == 1 ? "" : "s");
    }
    findings_close(findings);
    return STATUS_OK;
}

int cmd_merge(int argc, char **argv)
{
    const char *to = NULL;
    struct reason reason = {""};
    int first, code = options_take("merge", print_help, long_options, take_option, &to, argc, argv,
                                   &first);
    if (code >= 0)
        return code;
    if (!to)
        return usage_error("merge", "--to DIR says where to");
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
    if (!status)
        return EXIT_AGREE;
    fprintf(stderr, "raydiff merge: %s\n", reason.text);
    return exit_of_status(status);
}
