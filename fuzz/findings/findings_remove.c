/* Folders that a merge did not finish. */
#define _GNU_SOURCE /* kill */
#include "fuzz/findings/findings_inner.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static enum status remove_file(void *user, const char *name, struct reason *reason)
{
    const struct folder *folder = user;
    (void)reason;
    folder_remove(folder, name, NULL);
    return STATUS_OK;
}

/* Removes a signature's folder with its files, or the log. Other files stay. */
static enum status remove_part(void *user, const char *name, struct reason *reason)
{
    const struct folder *folder = user;
    struct fuzz_signature signature;
    struct folder part;
    (void)reason;
    if (strcmp(name, "findings.jsonl") == 0)
        folder_remove(folder, name, NULL);
    if (fuzz_signature_of_folder(name, &signature, NULL) ||
        folder_open_in(folder, name, false, &part, NULL))
        return STATUS_OK;
    (void)!folder_list(&part, remove_file, &part, NULL);
    folder_close(&part);
    folder_remove(folder, name, NULL);
    return STATUS_OK;
}

void findings_remove(const char *path)
{
    struct folder folder;
    if (folder_open(path, false, &folder, NULL) == STATUS_OK)
        (void)!folder_list(&folder, remove_part, &folder, NULL);
    folder_close(&folder);
    rmdir(path);
}

struct killed {
    const char *parent, *base;
};

/* Removes "BASE.PID.tmp" of a process that has ended, on this machine or another: its log is not
 * locked. */
static enum status remove_one(void *user, const char *name, struct reason *reason)
{
    const struct killed *k = user;
    const size_t length = strlen(k->base);
    char path[FINDINGS_PATH_MOST], *end;
    struct findings *findings;
    (void)reason;
    if (strncmp(name, k->base, length) != 0 || name[length] != '.' || name[length + 1] < '1' ||
        name[length + 1] > '9')
        return STATUS_OK;
    long pid = strtol(name + length + 1, &end, 10);
    if (strcmp(end, ".tmp") != 0 || kill((pid_t)pid, 0) == 0 || errno != ESRCH ||
        snprintf(path, sizeof path, "%s/%s", k->parent, name) >= (int)sizeof path)
        return STATUS_OK;
    if (findings_folder_open(path, true, &findings, NULL) != STATUS_OK)
        return STATUS_OK;
    findings_close(findings);
    findings_remove(path);
    return STATUS_OK;
}

void findings_remove_killed(const char *to)
{
    const char *slash = strrchr(to, '/');
    char parent[FINDINGS_PATH_MOST];
    struct folder folder;
    snprintf(parent, sizeof parent, "%.*s", slash ? (int)(slash - to) + 1 : 1, slash ? to : ".");
    struct killed killed = {parent, slash ? slash + 1 : to};
    if (killed.base[0] && folder_open(parent, false, &folder, NULL) == STATUS_OK) {
        (void)!folder_list(&folder, remove_one, &killed, NULL);
        folder_close(&folder);
    }
}
