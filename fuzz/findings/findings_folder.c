/* The files of a folder of findings: one folder per signature. */
#define _GNU_SOURCE /* struct flock */
#include "fuzz/findings/findings_inner.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOG_NAME   "findings.jsonl"
#define COUNT_MOST 64u /* bytes of a file `count`, and more */

/* A lock of this process: it ends with the process, and no child of an engine inherits it. */
static enum status lock(const struct findings *findings, struct reason *reason)
{
    struct flock all = {.l_type = findings->writable ? F_WRLCK : F_RDLCK, .l_whence = SEEK_SET};
    char path[FOLDER_PATH_MOST];
    int code;
    do
        code = fcntl(findings->log, F_SETLK, &all);
    while (code != 0 && errno == EINTR);
    if (code == 0)
        return STATUS_OK;
    bool held = errno == EACCES || errno == EAGAIN;
    const char *why = held ? "another process is writing to it" : strerror(errno);
    folder_path(&findings->folder, LOG_NAME, path, sizeof path);
    return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), why);
}

bool findings_is_folder(const char *path)
{
    struct folder folder;
    if (folder_open(path, false, &folder, NULL))
        return false;
    bool there = false;
    enum status status = folder_has(&folder, LOG_NAME, &there, NULL);
    folder_close(&folder);
    return there || status; /* what is no file there is for findings_open to refuse */
}

enum status findings_folder_open(const char *folder, bool writable, struct findings **out,
                                 struct reason *reason)
{
    *out = NULL;
    if (strlen(folder) + 2 * FUZZ_SIGNATURE_MOST > FINDINGS_PATH_MOST)
        return fail(reason, STATUS_INPUT, "%s: the name is too long", file_label(folder));
    struct findings *findings = alloc_zeroed(1, sizeof *findings);
    if (!findings)
        return fail(reason, STATUS_MEMORY, "no memory for a folder of findings");
    *findings = (struct findings){.log = -1, .writable = writable};
    bool there = true;
    enum status status = folder_open(folder, writable, &findings->folder, reason);
    if (!status)
        status = folder_has(&findings->folder, LOG_NAME, &there, reason);
    findings->made = !there;
    if (!status)
        status = folder_open_file(&findings->folder, LOG_NAME, writable, &findings->log, reason);
    if (!status)
        status = lock(findings, reason);
    if (status) {
        findings_close(findings);
        return status;
    }
    *out = findings;
    return STATUS_OK;
}

void findings_member_name(const struct findings *findings, const struct fuzz_signature *signature,
                          char name[FUZZ_SIGNATURE_MOST])
{
    char old[FUZZ_SIGNATURE_MOST];
    bool there = false, old_there = false;
    fuzz_signature_folder(signature, name);
    fuzz_signature_print(signature, old);
    if (strcmp(name, old) == 0)
        return;
    if (folder_has_folder(&findings->folder, name, &there, NULL) || there)
        return;
    if (folder_has_folder(&findings->folder, old, &old_there, NULL) == STATUS_OK && old_there)
        strcpy(name, old);
}

static enum status open_member(const struct findings *findings,
                               const struct fuzz_signature *signature, bool make,
                               struct folder *out, struct reason *reason)
{
    char name[FUZZ_SIGNATURE_MOST];
    findings_member_name(findings, signature, name);
    return folder_open_in(&findings->folder, name, make, out, reason);
}

/* Reads one trial of a signature's folder. */
static enum status get(const struct folder *folder, const struct fuzz_signature *signature,
                       const char *name, struct finding_file *file, bool *there,
                       struct reason *reason)
{
    *file = (struct finding_file){0};
    enum status status = folder_has(folder, name, there, reason);
    if (!status && *there)
        status = finding_file_get(folder, name, file, reason);
    if (status || !*there ||
        (file->has_signature && fuzz_signature_same(&file->signature, signature)))
        return status;
    char path[FOLDER_PATH_MOST];
    folder_path(folder, name, path, sizeof path);
    finding_file_free(file);
    return fail(reason, STATUS_INPUT, "%s: expects something else than its folder says",
                file_label(path));
}

enum status findings_folder_get(const struct findings *findings,
                                const struct fuzz_signature *signature, const char *name,
                                struct finding_file *file, bool *there, struct reason *reason)
{
    struct folder folder;
    *file = (struct finding_file){0};
    *there = false;
    enum status status = open_member(findings, signature, false, &folder, reason);
    if (!status)
        status = get(&folder, signature, name, file, there, reason);
    folder_close(&folder);
    return status;
}

/* An empty or incomplete file counts as missing: it is not synced. */
static enum status read_count(const struct folder *folder, uint64_t *count, struct reason *reason)
{
    char *text, *end;
    size_t size;
    bool there;
    enum status status = folder_has(folder, "count", &there, reason);
    *count = 0;
    if (status || !there)
        return status;
    status = folder_read(folder, "count", COUNT_MOST, &text, &size, NULL);
    if (status)
        return status == STATUS_INPUT ? STATUS_OK : fail(reason, status, "no memory for a count");
    errno = 0;
    unsigned long long said = strtoull(text, &end, 10);
    if (end != text && strcmp(end, "\n") == 0 && errno == 0)
        *count = said;
    free(text);
    return STATUS_OK;
}

static enum status read_files(const struct folder *folder, struct findings_member *member,
                              struct reason *reason)
{
    struct findings_entry *entry = &member->entry;
    struct finding_file file;
    enum status status =
        get(folder, &entry->signature, "first.trial", &file, &entry->has_first, reason);
    if (!status && entry->has_first) {
        entry->first = findings_order(&file.trial);
        strcpy(entry->versions, file.versions);
    }
    finding_file_free(&file);
    if (status)
        return status;
    status = get(folder, &entry->signature, "smallest.trial", &file, &entry->has_smallest, reason);
    if (!status && entry->has_smallest)
        entry->smallest = fuzz_trial_size(&file.trial);
    finding_file_free(&file);
    return status ? status : read_count(folder, &member->counted, reason);
}

/* Reads a signature's folder; other names are ignored. */
static enum status read_member(void *user, const char *name, struct reason *reason)
{
    struct findings *findings = user;
    struct fuzz_signature signature;
    struct folder folder;
    if (fuzz_signature_of_folder(name, &signature, NULL))
        return STATUS_OK;
    struct findings_member *member = findings_member_of(findings, &signature);
    if (!member)
        return fail(reason, STATUS_MEMORY, "no memory for %zu signatures", findings->count + 1);
    enum status status = folder_open_in(&findings->folder, name, false, &folder, reason);
    if (!status && findings->writable) /* the lock excludes other writers */
        status = folder_clean(&folder, reason);
    if (!status)
        status = read_files(&folder, member, reason);
    folder_close(&folder);
    return status;
}

enum status findings_folder_read(struct findings *findings, struct reason *reason)
{
    enum status status = STATUS_OK;
    if (findings->writable)
        status = folder_clean(&findings->folder, reason);
    return status ? status : folder_list(&findings->folder, read_member, findings, reason);
}

enum status findings_folder_put(struct findings *findings, const struct finding_file *file,
                                const char *name, struct reason *reason)
{
    struct folder folder;
    enum status status = open_member(findings, &file->signature, true, &folder, reason);
    if (!status)
        status = finding_file_put(file, &folder, name, reason);
    folder_close(&folder);
    return status;
}

/* Not synced: it can be made again from the log, and there may be many. */
static enum status put_count(const struct findings *findings, const struct findings_entry *entry,
                             struct reason *reason)
{
    struct folder folder;
    struct file_out out;
    enum status status = open_member(findings, &entry->signature, true, &folder, reason);
    if (!status)
        status = folder_put(&folder, "count", &out, reason);
    folder_close(&folder);
    if (status)
        return status;
    out.unsynced = true;
    fprintf(out.stream, "%llu\n", (unsigned long long)entry->count);
    return file_out_commit(&out, reason);
}

enum status findings_folder_counts(struct findings *findings, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < findings->count && !status; i++) {
        if (findings->member[i].stale)
            status = put_count(findings, &findings->member[i].entry, reason);
        findings->member[i].stale = status != STATUS_OK;
    }
    return status;
}
