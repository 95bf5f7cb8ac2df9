#define _POSIX_C_SOURCE 200809L /* strndup */
#include "fuzz/findings/findings_inner.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A line of a source; owns `text`. */
struct kept {
    struct fuzz_signature signature;
    struct findings_order order;
    uint32_t ray;
    char *text;
};

struct merging {
    const char *const *folder;
    size_t folder_count;
    struct findings **from;
    struct findings *to;
    struct kept *kept;
    size_t kept_count, kept_capacity;
};

static enum status keep(void *user, const struct findings_line *line, struct reason *reason)
{
    struct merging *m = user;
    void *array = m->kept;
    char *text = strndup(line->text, line->length);
    enum status status =
        array_reserve(&array, &m->kept_capacity, m->kept_count + 1, sizeof *m->kept);
    m->kept = array;
    if (status || !text) {
        free(text);
        return fail(reason, STATUS_MEMORY, "no memory for %zu findings", m->kept_count + 1);
    }
    m->kept[m->kept_count++] = (struct kept){line->signature, line->order, line->ray, text};
    return STATUS_OK;
}

static int compare_signatures(const struct fuzz_signature *a, const struct fuzz_signature *b)
{
    char first[FUZZ_SIGNATURE_MOST], second[FUZZ_SIGNATURE_MOST];
    fuzz_signature_print(a, first);
    fuzz_signature_print(b, second);
    return strcmp(first, second);
}

static int compare_kept(const void *a, const void *b)
{
    const struct kept *x = a, *y = b;
    int order = compare_signatures(&x->signature, &y->signature);
    if (!order)
        order = findings_order_compare(&x->order, &y->order);
    if (!order && x->ray != y->ray)
        order = x->ray < y->ray ? -1 : 1;
    return order ? order : strcmp(x->text, y->text);
}

static int compare_members(const void *a, const void *b)
{
    const struct findings_member *x = a, *y = b;
    return compare_signatures(&x->entry.signature, &y->entry.signature);
}

static enum status open_sources(struct merging *m, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < m->folder_count && !status; i++) {
        struct stat mine, other;
        status = findings_folder_open(m->folder[i], false, &m->from[i], reason);
        if (status)
            return status;
        if (fstat(m->from[i]->log, &mine) != 0)
            return fail(reason, STATUS_INPUT, "%s: %s", file_label(m->folder[i]), strerror(errno));
        for (size_t k = 0; k < i; k++)
            if (fstat(m->from[k]->log, &other) == 0 && mine.st_dev == other.st_dev &&
                mine.st_ino == other.st_ino)
                return fail(reason, STATUS_INPUT, "%s: this folder is named twice",
                            file_label(m->folder[i]));
        status = findings_read(m->from[i], keep, m, reason);
    }
    return status;
}

/* Adds up the counts; all are pending until lines are written. */
static enum status add_counts(struct merging *m, struct reason *reason)
{
    for (size_t i = 0; i < m->folder_count; i++)
        for (size_t k = 0; k < m->from[i]->count; k++) {
            const struct findings_entry *entry = &m->from[i]->member[k].entry;
            struct findings_member *member = findings_member_of(m->to, &entry->signature);
            if (!member)
                return fail(reason, STATUS_MEMORY, "no memory for %zu signatures", m->to->count);
            member->entry.count += entry->count;
            member->pending += entry->count;
            member->stale = true;
        }
    if (m->to->count > 0)
        qsort(m->to->member, m->to->count, sizeof *m->to->member, compare_members);
    return STATUS_OK;
}

/* True if both are the same finding, in two folders. */
static bool is_same(const struct kept *a, const struct kept *b)
{
    return a->ray == b->ray && fuzz_signature_same(&a->signature, &b->signature) &&
           findings_order_compare(&a->order, &b->order) == 0;
}

static enum status put_lines(struct merging *m, struct reason *reason)
{
    enum status status = STATUS_OK;
    if (m->kept_count > 0)
        qsort(m->kept, m->kept_count, sizeof *m->kept, compare_kept);
    for (size_t i = 0; i < m->kept_count && !status; i++) {
        struct findings_member *member = findings_member_of(m->to, &m->kept[i].signature);
        if (!member)
            continue;
        if (i > 0 && is_same(&m->kept[i - 1], &m->kept[i])) {
            member->entry.count--;
            member->pending--;
            continue;
        }
        if (member->entry.lines == FINDINGS_LINES_MOST)
            continue;
        member->entry.lines++;
        member->pending--;
        status = findings_log_put(m->to, m->kept[i].text, strlen(m->kept[i].text), reason);
    }
    return status ? status : findings_checkpoint(m->to, "", reason);
}

/* Which of two files of one signature is kept: a if below 0. Equal trials may differ in the lines
 * beside them. */
static int compare_files(const struct finding_file *a, const struct finding_file *b, bool first)
{
    struct findings_order x = findings_order(&a->trial), y = findings_order(&b->trial);
    struct fuzz_trial_size s = fuzz_trial_size(&a->trial), t = fuzz_trial_size(&b->trial);
    int order = first ? findings_order_compare(&x, &y) : fuzz_trial_size_compare(&s, &t);
    if (!order) /* the smallest may come from several origins */
        order = findings_order_compare(&x, &y);
    if (!order)
        order = strcmp(a->trial.origin.recipe, b->trial.origin.recipe);
    return order ? order : strcmp(a->versions, b->versions);
}

static enum status put_best(struct merging *m, const struct fuzz_signature *signature,
                            const char *name, struct reason *reason)
{
    struct finding_file best = {0}, file;
    bool any = false, is_first = strcmp(name, "first.trial") == 0;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < m->folder_count && !status; i++) {
        const struct findings_entry *entry = findings_find(m->from[i], signature);
        if (!entry || !(is_first ? entry->has_first : entry->has_smallest))
            continue;
        status = findings_get(m->from[i], signature, name, &file, reason);
        if (!status && (!any || compare_files(&file, &best, is_first) < 0)) {
            finding_file_free(&best);
            best = file;
            any = true;
        } else {
            finding_file_free(&file);
        }
    }
    if (!status && any)
        status = findings_folder_put(m->to, &best, name, reason);
    finding_file_free(&best);
    return status;
}

static enum status put_files(struct merging *m, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < m->to->count && !status; i++) {
        const struct fuzz_signature *signature = &m->to->member[i].entry.signature;
        status = put_best(m, signature, "first.trial", reason);
        if (!status)
            status = put_best(m, signature, "smallest.trial", reason);
    }
    return status;
}

static enum status merge(struct merging *m, const char *to, struct reason *reason)
{
    char temporary[FINDINGS_PATH_MOST];
    enum status status = open_sources(m, reason);
    snprintf(temporary, sizeof temporary, "%s.%ld.tmp", to, (long)getpid());
    if (!status)
        findings_remove_killed(to);
    bool made = !status && mkdir(temporary, 0777) == 0;
    if (!status && !made)
        status = fail(reason, STATUS_INPUT, "%s: %s", file_label(temporary), strerror(errno));
    if (!status)
        status = findings_folder_open(temporary, true, &m->to, reason);
    if (!status)
        status = add_counts(m, reason);
    if (!status)
        status = put_files(m, reason);
    if (!status)
        status = put_lines(m, reason);
    if (!status && rename(temporary, to) != 0)
        status = fail(reason, STATUS_INPUT, "%s: cannot be made: %s", file_label(to),
                      errno == ENOTEMPTY || errno == EEXIST ? "it exists and is not empty"
                                                            : strerror(errno));
    if (status && made)
        findings_remove(temporary);
    return status;
}

enum status findings_merge(const char *const *folder, size_t count, const char *to,
                           struct reason *reason)
{
    struct merging m = {.folder = folder, .folder_count = count};
    char goal[FINDINGS_PATH_MOST / 2];
    size_t length = strlen(to);
    if (length == 0 || length >= sizeof goal)
        return fail(reason, STATUS_INPUT, "'%s' cannot be a folder's name", file_label(to));
    strcpy(goal, to);
    while (length > 1 && goal[length - 1] == '/')
        goal[--length] = '\0';
    m.from = alloc_zeroed(count, sizeof *m.from);
    if (!m.from)
        return fail(reason, STATUS_MEMORY, "no memory for %zu folders", count);
    enum status status = merge(&m, goal, reason);
    for (size_t i = 0; i < m.kept_count; i++)
        free(m.kept[i].text);
    free(m.kept);
    for (size_t i = 0; i < count; i++)
        findings_close(m.from[i]);
    findings_close(m.to);
    free(m.from);
    return status;
}
