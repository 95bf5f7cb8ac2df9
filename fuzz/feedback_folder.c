/* The corpus of a campaign as files. */
#define _GNU_SOURCE /* scandir */
#include "fuzz/feedback_inner.h"

#include "fuzz/finding_file.h"
#include "scenes/file.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_BYTES 4096

static enum status system_fail(const char *path, struct reason *reason)
{
    return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), strerror(errno));
}

static enum status join(char path[PATH_BYTES], const char *folder, const char *name,
                        struct reason *reason)
{
    if (snprintf(path, PATH_BYTES, "%s/%s", folder, name) >= PATH_BYTES)
        return fail(reason, STATUS_INPUT, "%s: the name is too long", file_label(folder));
    return STATUS_OK;
}

static enum status save_one(const char *folder, const struct fuzz_trial *trial,
                            struct reason *reason)
{
    char path[PATH_BYTES], name[32];
    snprintf(name, sizeof name, "%016llx.trial", (unsigned long long)fuzz_trial_hash(trial));
    enum status status = join(path, folder, name, reason);
    if (status || access(path, F_OK) == 0)
        return status;
    const struct finding_file file = {.trial = *trial}; /* borrowed */
    return finding_file_write(&file, path, reason);
}

enum status feedback_save(struct feedback *feedback, const char *folder, struct reason *reason)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return system_fail(folder, reason);
    for (size_t i = 0; i < feedback->count; i++) {
        struct feedback_entry *entry = &feedback->entry[i];
        if (entry->saved)
            continue;
        enum status status = save_one(folder, &entry->trial, reason);
        if (status)
            return status;
        entry->saved = true;
    }
    return STATUS_OK;
}

static int is_trial(const struct dirent *one)
{
    const char *end = strrchr(one->d_name, '.');
    return one->d_name[0] != '.' && end && strcmp(end, ".trial") == 0;
}

/* In any locale. */
static int compare_names(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static void leave_out(struct feedback_list *list, const struct reason *why)
{
    if (list->left_out++ == 0)
        list->said = *why;
}

/* Adds what one file holds, or says why it does not. *bytes: of all that was added. */
static enum status load_one(const char *folder, const char *name, size_t bytes_most, size_t *bytes,
                            struct feedback_list *list, struct reason *reason)
{
    char path[PATH_BYTES];
    struct finding_file file;
    struct reason why;
    enum status status = join(path, folder, name, reason);
    if (!status)
        status = finding_file_read(path, &file, &why);
    if (status == STATUS_MEMORY)
        return fail(reason, status, "%s", why.text);
    size_t more = status ? 0 : feedback_bytes(&file.trial);
    if (!status && more > bytes_most - *bytes) {
        finding_file_free(&file);
        status = fail(&why, STATUS_LIMIT, "%s: with it the corpus is larger than %zu bytes",
                      file_label(path), bytes_most);
    }
    if (status) {
        leave_out(list, &why);
        return STATUS_OK;
    }
    void *array = list->trial;
    status = array_reserve(&array, &list->capacity, list->count + 1, sizeof *list->trial);
    list->trial = array;
    if (status) {
        finding_file_free(&file);
        return fail(reason, STATUS_MEMORY, "no memory for %zu trials", list->count + 1);
    }
    *bytes += more;
    list->trial[list->count++] = file.trial;
    return STATUS_OK;
}

enum status feedback_load(const char *folder, size_t bytes_most, struct feedback_list *out,
                          struct reason *reason)
{
    struct dirent **name = NULL;
    size_t bytes = 0;
    *out = (struct feedback_list){0};
    int count = scandir(folder, &name, is_trial, compare_names);
    if (count < 0)
        return errno == ENOENT ? STATUS_OK : system_fail(folder, reason);
    enum status status = STATUS_OK;
    for (int i = 0; i < count; i++) {
        if (!status)
            status = load_one(folder, name[i]->d_name, bytes_most, &bytes, out, reason);
        free(name[i]);
    }
    free(name);
    if (status)
        feedback_list_free(out);
    return status;
}

void feedback_list_free(struct feedback_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        fuzz_trial_free(&list->trial[i]);
    free(list->trial);
    *list = (struct feedback_list){0};
}
