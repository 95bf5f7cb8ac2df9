/* Whether the parts of a folder of findings fit together. */
#include "fuzz/findings/findings_inner.h"

static enum status check_files(const struct findings *findings,
                               const struct findings_member *member, struct reason *reason)
{
    const struct findings_entry *entry = &member->entry;
    char signature[FUZZ_SIGNATURE_MOST];
    if (entry->count == 0 || (entry->has_first && entry->has_smallest))
        return STATUS_OK;
    findings_member_name(findings, &entry->signature, signature);
    return fail(reason, STATUS_INPUT, "%.120s/findings.jsonl:%llu: a finding whose %s/%s is gone",
                file_label(findings->folder.path), (unsigned long long)member->line, signature,
                entry->has_first ? "smallest.trial" : "first.trial");
}

static enum status check_count(const struct findings *findings,
                               const struct findings_member *member, struct reason *reason)
{
    char path[FINDINGS_PATH_MOST];
    if (member->counted <= member->entry.count)
        return STATUS_OK;
    findings_path(findings, &member->entry.signature, "count", path, sizeof path);
    return fail(reason, STATUS_INPUT, "%s: %llu, but findings.jsonl has %llu: lines of it are lost",
                file_label(path), (unsigned long long)member->counted,
                (unsigned long long)member->entry.count);
}

/* A campaign writes its first checkpoint before these. */
static enum status check_log(const struct findings *findings, struct reason *reason)
{
    static const char *const later[] = {"stats.json", "pairs.txt"};
    for (size_t i = 0; i < ARRAY_COUNT(later) && findings->checkpoints == 0; i++) {
        bool there;
        char path[FOLDER_PATH_MOST];
        enum status status = folder_has(&findings->folder, later[i], &there, reason);
        if (status)
            return status;
        folder_path(&findings->folder, later[i], path, sizeof path);
        if (there)
            return fail(reason, STATUS_INPUT,
                        "%s: exists, but findings.jsonl has no checkpoint: the checkpoint was lost",
                        file_label(path));
    }
    return STATUS_OK;
}

/* Drops members with an empty folder: the writer was killed before it wrote a finding's files. */
static void drop_empty(struct findings *findings)
{
    size_t kept = 0;
    for (size_t i = 0; i < findings->count; i++) {
        const struct findings_entry *entry = &findings->member[i].entry;
        if (entry->count > 0 || entry->has_first || entry->has_smallest)
            findings->member[kept++] = findings->member[i];
    }
    findings->count = kept;
}

enum status findings_read(struct findings *findings, findings_line_fn *each, void *user,
                          struct reason *reason)
{
    enum status status = findings_log_read(findings, each, user, reason);
    if (!status)
        status = findings_folder_read(findings, reason);
    for (size_t i = 0; i < findings->count && !status; i++) {
        status = check_files(findings, &findings->member[i], reason);
        if (!status)
            status = check_count(findings, &findings->member[i], reason);
        findings->member[i].stale = findings->member[i].counted != findings->member[i].entry.count;
    }
    drop_empty(findings);
    return status ? status : check_log(findings, reason);
}
