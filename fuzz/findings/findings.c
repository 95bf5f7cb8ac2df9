#include "fuzz/findings/findings_inner.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct findings_order findings_order(const struct fuzz_trial *trial)
{
    const struct fuzz_origin *origin = &trial->origin;
    return (struct findings_order){origin->mutated, origin->seed, origin->index, origin->version,
                                   fuzz_trial_hash(trial)};
}

int findings_order_compare(const struct findings_order *a, const struct findings_order *b)
{
    int order = order_numbers(a->mutated, b->mutated);
    order = order ? order : order_numbers(a->seed, b->seed);
    order = order ? order : order_numbers(a->index, b->index);
    order = order ? order : order_numbers(a->version, b->version);
    return order ? order : order_numbers(a->hash, b->hash);
}

static struct findings_member *find(const struct findings *findings,
                                    const struct fuzz_signature *signature)
{
    for (size_t i = 0; i < findings->count; i++)
        if (fuzz_signature_same(&findings->member[i].entry.signature, signature))
            return &findings->member[i];
    return NULL;
}

struct findings_member *findings_member_of(struct findings *findings,
                                           const struct fuzz_signature *signature)
{
    struct findings_member *known = find(findings, signature);
    if (known)
        return known;
    void *array = findings->member;
    enum status status =
        array_reserve(&array, &findings->capacity, findings->count + 1, sizeof *findings->member);
    findings->member = array;
    if (status)
        return NULL;
    struct findings_member *member = &findings->member[findings->count++];
    *member = (struct findings_member){.entry.signature = *signature};
    return member;
}

static uint64_t mix(uint64_t hash, uint64_t word)
{
    for (int i = 0; i < 8; i++)
        hash = (hash ^ (word >> (8 * i) & 0xFF)) * 0x100000001B3u;
    return hash;
}

static uint64_t key_of(const struct fuzz_signature *signature, const struct findings_order *order,
                       uint32_t ray)
{
    char text[FUZZ_SIGNATURE_MOST];
    uint64_t hash = 0xCBF29CE484222325u;
    fuzz_signature_print(signature, text);
    for (const char *at = text; *at; at++)
        hash = mix(hash, (unsigned char)*at);
    hash = mix(mix(hash, order->mutated), order->seed);
    hash = mix(mix(mix(hash, order->index), order->version), order->hash);
    hash = mix(hash, ray);
    return hash ? hash : 1;
}

bool findings_is_known(const struct findings *findings, const struct fuzz_signature *signature,
                       const struct findings_order *order, uint32_t ray)
{
    return number_set_has(&findings->keys, key_of(signature, order, ray));
}

bool findings_know(struct findings *findings, const struct fuzz_signature *signature,
                   const struct findings_order *order, uint32_t ray)
{
    return number_set_add(&findings->keys, key_of(signature, order, ray));
}

static enum status open_folder(const char *folder, bool writable, struct findings **out,
                               struct reason *reason)
{
    enum status status = findings_folder_open(folder, writable, out, reason);
    if (!status)
        status = findings_read(*out, NULL, NULL, reason);
    if (!status && writable) /* of a writer that was killed */
        status = findings_folder_counts(*out, reason);
    if (status) {
        if (*out && (*out)->made) /* the lock is still ours */
            folder_remove(&(*out)->folder, "findings.jsonl", NULL);
        findings_close(*out);
        *out = NULL;
    }
    return status;
}

enum status findings_open(const char *folder, struct findings **out, struct reason *reason)
{
    return open_folder(folder, true, out, reason);
}

enum status findings_look(const char *folder, struct findings **out, struct reason *reason)
{
    return open_folder(folder, false, out, reason);
}

void findings_close(struct findings *findings)
{
    if (!findings)
        return;
    if (findings->log >= 0)
        close(findings->log);
    folder_close(&findings->folder);
    free(findings->member);
    free(findings->keys.slot);
    free(findings);
}

const struct folder *findings_folder(const struct findings *findings)
{
    return &findings->folder;
}

const char *findings_said(const struct findings *findings)
{
    return findings->said.text;
}

const char *findings_state(const struct findings *findings)
{
    return findings->state;
}

size_t findings_count(const struct findings *findings)
{
    return findings->count;
}

const struct findings_entry *findings_entry(const struct findings *findings, size_t i)
{
    return &findings->member[i].entry;
}

const struct findings_entry *findings_find(const struct findings *findings,
                                           const struct fuzz_signature *signature)
{
    const struct findings_member *member = find(findings, signature);
    return member ? &member->entry : NULL;
}

enum status findings_get(const struct findings *findings, const struct fuzz_signature *signature,
                         const char *name, struct finding_file *out, struct reason *reason)
{
    char path[FINDINGS_PATH_MOST];
    bool there;
    enum status status = findings_folder_get(findings, signature, name, out, &there, reason);
    if (status || there)
        return status;
    findings_path(findings, signature, name, path, sizeof path);
    return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), strerror(ENOENT));
}

void findings_path(const struct findings *findings, const struct fuzz_signature *signature,
                   const char *name, char *path, size_t path_bytes)
{
    char text[FUZZ_SIGNATURE_MOST];
    findings_member_name(findings, signature, text);
    snprintf(path, path_bytes, "%s/%s/%s", findings->folder.path, text, name);
}

/* Writes smallest.trial if this is it. */
static enum status put_smallest(struct findings *findings, struct findings_member *member,
                                const struct finding_file *file, struct findings_news *news,
                                struct reason *reason)
{
    struct fuzz_trial_size size = fuzz_trial_size(&file->trial);
    if (member->entry.has_smallest && fuzz_trial_size_compare(&size, &member->entry.smallest) >= 0)
        return STATUS_OK;
    enum status status = findings_folder_put(findings, file, "smallest.trial", reason);
    if (status)
        return status;
    member->entry.has_smallest = true;
    member->entry.smallest = size;
    news->smallest = true;
    return STATUS_OK;
}

static enum status put_first(struct findings *findings, struct findings_member *member,
                             const struct finding_file *file, struct findings_news *news,
                             struct reason *reason)
{
    struct findings_order order = findings_order(&file->trial);
    if (member->entry.has_first && findings_order_compare(&order, &member->entry.first) >= 0)
        return STATUS_OK;
    enum status status = findings_folder_put(findings, file, "first.trial", reason);
    if (status)
        return status;
    member->entry.has_first = true;
    member->entry.first = order;
    strcpy(member->entry.versions, file->versions);
    news->first = true;
    return STATUS_OK;
}

enum status findings_add(struct findings *findings, const struct finding_file *file, uint32_t ray,
                         const char *opinion, struct findings_news *news, struct reason *reason)
{
    *news = (struct findings_news){0};
    if (!file->has_signature)
        return fail(reason, STATUS_INPUT, "%s: a finding has a signature", findings->folder.path);
    if (ray != FINDINGS_NO_RAY && ray >= file->trial.ray_count)
        return fail(reason, STATUS_INPUT, "%s: ray %u of %u", findings->folder.path, ray,
                    file->trial.ray_count);
    size_t before = findings->count;
    struct findings_member *member = findings_member_of(findings, &file->signature);
    if (!member)
        return fail(reason, STATUS_MEMORY, "no memory for %zu signatures", before + 1);
    bool logged = member->entry.lines < FINDINGS_LINES_MOST;
    struct findings_order order = findings_order(&file->trial);
    if (findings_is_known(findings, &file->signature, &order, ray)) {
        news->repeated = true;
        return STATUS_OK;
    }
    news->signature = member->entry.count == 0;
    enum status status = put_first(findings, member, file, news, reason);
    if (!status)
        status = put_smallest(findings, member, file, news, reason);
    if (!status && logged)
        status = findings_log_add(findings, file, ray, opinion, reason);
    if (!status && logged && !findings_know(findings, &file->signature, &order, ray))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu findings", findings->keys.count);
    if (status)
        return status;
    member->entry.lines += logged;
    member->pending += !logged;
    member->entry.count++;
    member->stale = true;
    return STATUS_OK;
}

enum status findings_offer(struct findings *findings, const struct finding_file *file,
                           struct findings_news *news, struct reason *reason)
{
    *news = (struct findings_news){0};
    struct findings_member *member = file->has_signature ? find(findings, &file->signature) : NULL;
    if (!member)
        return fail(reason, STATUS_INPUT, "%s: no finding has this signature",
                    findings->folder.path);
    return put_smallest(findings, member, file, news, reason);
}

enum status findings_checkpoint(struct findings *findings, const char *state, struct reason *reason)
{
    if (strlen(state) >= sizeof findings->state)
        return fail(reason, STATUS_INPUT, "%s: a state has at most %d characters",
                    findings->folder.path, FINDINGS_STATE_MOST - 1);
    enum status status = findings_log_checkpoint(findings, state, reason);
    if (status)
        return status;
    strcpy(findings->state, state);
    return findings_folder_counts(findings, reason);
}
