/* The files of a folder of findings: one folder per signature. */
#define _GNU_SOURCE /* O_CLOEXEC, strdup */
#include "fuzz/findings_inner.h"

#include "scenes/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum status system_fail(const char *path, struct reason *reason)
{
    return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), strerror(errno));
}

/* A lock of this process: it ends with it, and no child that an engine runs in inherits it. */
static enum status lock(struct findings *findings, const char *path, struct reason *reason)
{
    struct flock all = {.l_type = findings->writable ? F_WRLCK : F_RDLCK, .l_whence = SEEK_SET};
    if (fcntl(findings->log, F_SETLK, &all) == 0)
        return STATUS_OK;
    if (errno == EACCES || errno == EAGAIN)
        return fail(reason, STATUS_INPUT, "%s: another process is writing to it", file_label(path));
    return system_fail(path, reason);
}

enum status findings_folder_open(const char *folder, bool writable, struct findings **out,
                                 struct reason *reason)
{
    char path[FINDINGS_PATH_MOST];
    *out = NULL;
    if (strlen(folder) + 2 * FUZZ_SIGNATURE_MOST > sizeof path)
        return fail(reason, STATUS_INPUT, "%s: the name is too long", file_label(folder));
    if (writable && mkdir(folder, 0777) != 0 && errno != EEXIST)
        return system_fail(folder, reason);
    struct findings *findings = alloc_zeroed(1, sizeof *findings);
    if (findings)
        *findings = (struct findings){.log = -1, .writable = writable, .folder = strdup(folder)};
    if (!findings || !findings->folder) {
        free(findings);
        return fail(reason, STATUS_MEMORY, "no memory for a folder of findings");
    }
    snprintf(path, sizeof path, "%s/findings.jsonl", folder);
    int flags = writable ? O_RDWR | O_CREAT | O_APPEND : O_RDONLY;
    findings->log = open(path, flags | O_CLOEXEC, 0666);
    enum status status =
        findings->log < 0 ? system_fail(path, reason) : lock(findings, path, reason);
    if (status) {
        findings_close(findings);
        return status;
    }
    *out = findings;
    return STATUS_OK;
}

/* Reads one trial of a signature's folder; *there: it is there. */
static enum status read_trial(const struct findings *findings,
                              const struct fuzz_signature *signature, const char *name,
                              struct finding_file *file, bool *there, struct reason *reason)
{
    char path[FINDINGS_PATH_MOST];
    findings_path(findings, signature, name, path, sizeof path);
    *there = access(path, F_OK) == 0;
    *file = (struct finding_file){0};
    if (!*there)
        return STATUS_OK;
    enum status status = finding_file_read(path, file, reason);
    if (!status && (!file->has_signature || !fuzz_signature_same(&file->signature, signature))) {
        finding_file_free(file);
        status = fail(reason, STATUS_INPUT, "%s: expects something else than its folder says",
                      file_label(path));
    }
    return status;
}

static enum status read_member(struct findings *findings, const struct fuzz_signature *signature,
                               struct reason *reason)
{
    struct finding_file file;
    struct findings_member *member = findings_member_of(findings, signature);
    if (!member)
        return fail(reason, STATUS_MEMORY, "no memory for %zu signatures", findings->count + 1);
    struct findings_entry *entry = &member->entry;
    member->stale = true;
    enum status status =
        read_trial(findings, signature, "first.trial", &file, &entry->has_first, reason);
    if (!status && entry->has_first)
        entry->first = findings_order(&file.trial);
    finding_file_free(&file);
    if (!status)
        status =
            read_trial(findings, signature, "smallest.trial", &file, &entry->has_smallest, reason);
    if (!status && entry->has_smallest)
        entry->smallest = fuzz_trial_size(&file.trial);
    finding_file_free(&file);
    return status;
}

enum status findings_folder_read(struct findings *findings, struct reason *reason)
{
    DIR *listing = opendir(findings->folder);
    if (!listing)
        return system_fail(findings->folder, reason);
    enum status status = STATUS_OK;
    struct dirent *one;
    while (!status && (one = readdir(listing)) != NULL) {
        struct fuzz_signature signature;
        if (fuzz_signature_parse(one->d_name, &signature, NULL))
            continue;             /* somebody else's */
        if (findings->writable) { /* the lock says that there is no other writer */
            char path[FINDINGS_PATH_MOST];
            findings_path(findings, &signature, "", path, sizeof path);
            file_out_clean(path);
        }
        status = read_member(findings, &signature, reason);
    }
    closedir(listing);
    return status;
}

enum status findings_folder_put(struct findings *findings, const struct finding_file *file,
                                const char *name, struct reason *reason)
{
    char path[FINDINGS_PATH_MOST];
    findings_path(findings, &file->signature, "", path, sizeof path);
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return system_fail(path, reason);
    findings_path(findings, &file->signature, name, path, sizeof path);
    return finding_file_write(file, path, reason);
}

/* Not synced: it can be made again from the log, and there may be many. */
static enum status put_count(const struct findings *findings, const struct findings_entry *entry,
                             struct reason *reason)
{
    char path[FINDINGS_PATH_MOST], temporary[FINDINGS_PATH_MOST];
    findings_path(findings, &entry->signature, "", path, sizeof path);
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return system_fail(path, reason);
    findings_path(findings, &entry->signature, "count", path, sizeof path);
    findings_path(findings, &entry->signature, "count.tmp", temporary, sizeof temporary);
    FILE *stream = fopen(temporary, "we");
    if (!stream)
        return system_fail(temporary, reason);
    bool good = fprintf(stream, "%llu\n", (unsigned long long)entry->count) > 0;
    good = fclose(stream) == 0 && good;
    return good && rename(temporary, path) == 0 ? STATUS_OK : system_fail(path, reason);
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
