/* The corpus of a campaign as files. */
#define _POSIX_C_SOURCE 200809L /* strdup */
#include "fuzz/feedback/feedback_inner.h"

#include "fuzz/findings/finding_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum status save_one(const struct folder *folder, const struct fuzz_trial *trial,
                            struct reason *reason)
{
    char name[32];
    bool there;
    snprintf(name, sizeof name, "%016llx.trial", (unsigned long long)fuzz_trial_hash(trial));
    enum status status = folder_has(folder, name, &there, reason);
    if (status || there)
        return status;
    const struct finding_file file = {.trial = *trial}; /* borrowed */
    return finding_file_put(&file, folder, name, reason);
}

enum status feedback_save(struct feedback *feedback, const struct folder *folder,
                          struct reason *reason)
{
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

/* Names of a folder's trials. */
struct names {
    char **name;
    size_t count, capacity;
};

static enum status take_name(void *user, const char *name, struct reason *reason)
{
    struct names *names = user;
    void *array = names->name;
    const char *end = strrchr(name, '.');
    if (name[0] == '.' || !end || strcmp(end, ".trial") != 0)
        return STATUS_OK;
    enum status status =
        array_reserve(&array, &names->capacity, names->count + 1, sizeof *names->name);
    names->name = array;
    char *copy = status ? NULL : strdup(name);
    if (!copy)
        return fail(reason, STATUS_MEMORY, "no memory for %zu names", names->count + 1);
    names->name[names->count++] = copy;
    return STATUS_OK;
}

/* In any locale. */
static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void leave_out(struct feedback_list *list, const struct reason *why)
{
    if (list->left_out++ == 0)
        list->said = *why;
}

/* Adds the trial of one file, or notes why it is left out. *bytes: of all that were added. */
static enum status load_one(const struct folder *folder, const char *name, size_t bytes_most,
                            size_t *bytes, struct feedback_list *list, struct reason *reason)
{
    char path[FOLDER_PATH_MOST];
    struct finding_file file;
    struct reason why;
    enum status status = finding_file_get(folder, name, &file, &why);
    folder_path(folder, name, path, sizeof path);
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

enum status feedback_load(const struct folder *folder, size_t bytes_most, struct feedback_list *out,
                          struct reason *reason)
{
    struct names names = {NULL, 0, 0};
    size_t bytes = 0;
    *out = (struct feedback_list){0};
    enum status status = folder_list(folder, take_name, &names, reason);
    if (names.count > 0)
        qsort(names.name, names.count, sizeof *names.name, compare_names);
    for (size_t i = 0; i < names.count; i++) {
        if (!status)
            status = load_one(folder, names.name[i], bytes_most, &bytes, out, reason);
        free(names.name[i]);
    }
    free(names.name);
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
