/* findings.jsonl: a line per finding, a line per checkpoint. Numbers of 64 bits are written as
 * text, since JSON readers keep 53 bits. */
#define _POSIX_C_SOURCE 200809L
#include "fuzz/findings/findings_inner.h"

#include "ref/base/ray_text.h"
#include "ref/base/json_text.h"
#include "ref/base/json_record.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static enum status cannot(const struct findings *findings, struct reason *reason)
{
    return fail(reason, STATUS_INPUT, "%.150s/findings.jsonl: cannot write: %s",
                findings->folder.path, strerror(errno));
}

/* Appends bytes, all or none. */
static enum status append(struct findings *findings, const char *bytes, size_t size,
                          struct reason *reason)
{
    size_t done = 0;
    while (done < size) {
        ssize_t wrote = write(findings->log, bytes + done, size - done);
        if (wrote < 0 && errno == EINTR)
            continue;
        if (wrote <= 0) {
            enum status status = cannot(findings, reason);
            if (done > 0 && ftruncate(findings->log, (off_t)findings->log_size) != 0)
                return cannot(findings, reason);
            return status;
        }
        done += (size_t)wrote;
    }
    findings->log_size += size;
    return STATUS_OK;
}

enum status findings_log_put(struct findings *findings, const char *text, size_t length,
                             struct reason *reason)
{
    char *line = malloc(length + 1);
    if (!line)
        return fail(reason, STATUS_MEMORY, "no memory for a line of %zu bytes", length);
    memcpy(line, text, length);
    line[length] = '\n';
    enum status status = append(findings, line, length + 1, reason);
    free(line);
    return status;
}

/* Takes `root`, NULL without memory. */
static enum status put_json(struct findings *findings, json_t *root, struct reason *reason)
{
    char *text = root ? json_dumps(root, JSON_COMPACT | JSON_ENSURE_ASCII) : NULL;
    json_decref(root);
    if (!text)
        return fail(reason, STATUS_MEMORY, "no memory for a line of the log");
    enum status status = findings_log_put(findings, text, strlen(text), reason);
    free(text);
    return status;
}

/* One line of printable ASCII. */
static void plain(const char *text, char *out, size_t size)
{
    size_t i = 0;
    for (; text[i] && i + 1 < size; i++)
        out[i] = text[i] >= 0x20 && text[i] <= 0x7E ? text[i] : '?';
    out[i] = '\0';
}

static json_t *decimal(uint64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    return json_string(text);
}

static json_t *hexadecimal(uint64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)value);
    return json_string(text);
}

enum status findings_log_add(struct findings *findings, const struct finding_file *file,
                             uint32_t ray, const char *opinion, struct reason *reason)
{
    const struct fuzz_trial *trial = &file->trial;
    struct findings_order order = findings_order(trial);
    char signature[FUZZ_SIGNATURE_MOST], ray_text[RAY_TEXT_MOST], said[512];
    fuzz_signature_print(&file->signature, signature);
    plain(opinion, said, sizeof said);
    json_t *root = json_record(
        "signature=%s stream=%s seed=%p index=%p version=%u trial=%p triangles=%u rays=%u",
        signature, order.mutated ? "mut" : "gen", decimal(order.seed), decimal(order.index),
        order.version, hexadecimal(order.hash), trial->scene.tri_count, trial->ray_count);
    if (ray != FINDINGS_NO_RAY) {
        ray_text_write(&trial->ray[ray], ray_text);
        json_add(root, "ray=%u at=%s", ray, ray_text);
    }
    json_add(root, "opinion=%s", said);
    return put_json(findings, root, reason);
}

static uint64_t total(const struct findings *findings)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < findings->count; i++)
        sum += findings->member[i].entry.count;
    return sum;
}

enum status findings_log_checkpoint(struct findings *findings, const char *state,
                                    struct reason *reason)
{
    json_t *root = json_object(), *more = json_object();
    char text[FINDINGS_STATE_MOST];
    plain(state, text, sizeof text);
    for (size_t i = 0; i < findings->count; i++) {
        const struct findings_member *member = &findings->member[i];
        char signature[FUZZ_SIGNATURE_MOST];
        fuzz_signature_print(&member->entry.signature, signature);
        if (member->pending > 0)
            json_object_set_new(more, signature, json_integer((json_int_t)member->pending));
    }
    json_add(root, "checkpoint=%s more=%p findings=%p", text, more, decimal(total(findings)));
    enum status status = put_json(findings, root, reason);
    if (status)
        return status;
    for (size_t i = 0; i < findings->count; i++)
        findings->member[i].pending = 0;
    return file_sync(findings->log) == 0 ? STATUS_OK : cannot(findings, reason);
}

/* --- reading --------------------------------------------------------------------------------- */

struct log_line {
    struct findings *findings;
    unsigned long long number;
    struct reason *reason;
};

static enum status bad(const struct log_line *line, const char *rule)
{
    return fail(line->reason, STATUS_INPUT, "%.150s/findings.jsonl:%llu: %.100s",
                line->findings->folder.path, line->number, rule);
}

static bool take_number(const json_t *root, const char *key, int base, uint64_t *out)
{
    const char *text = json_string_value(json_object_get(root, key));
    char *end = NULL;
    if (!text || !((*text >= '0' && *text <= '9') || (base == 16 && *text >= 'a' && *text <= 'f')))
        return false;
    errno = 0;
    *out = strtoull(text, &end, base);
    return errno == 0 && *end == '\0';
}

static bool take_u32(const json_t *root, const char *key, uint32_t *out)
{
    const json_t *value = json_object_get(root, key);
    json_int_t number = json_integer_value(value);
    *out = (uint32_t)number;
    return json_is_integer(value) && number >= 0 && number <= (json_int_t)UINT32_MAX;
}

static enum status read_finding(const struct log_line *line, const json_t *root,
                                struct findings_line *out)
{
    const char *signature = json_string_value(json_object_get(root, "signature"));
    const char *stream = json_string_value(json_object_get(root, "stream"));
    struct reason why;
    if (!signature)
        return bad(line, "neither a finding nor a checkpoint");
    if (fuzz_signature_parse(signature, &out->signature, &why))
        return bad(line, why.text);
    if (!stream || (strcmp(stream, "gen") != 0 && strcmp(stream, "mut") != 0) ||
        !take_number(root, "seed", 10, &out->order.seed) ||
        !take_number(root, "index", 10, &out->order.index) ||
        !take_number(root, "trial", 16, &out->order.hash) ||
        !take_u32(root, "version", &out->order.version))
        return bad(line, "stream, seed, index, version or trial is missing or wrong");
    out->order.mutated = strcmp(stream, "mut") == 0;
    out->ray = FINDINGS_NO_RAY;
    if (json_object_get(root, "ray") && !take_u32(root, "ray", &out->ray))
        return bad(line, "ray is no number");
    if (findings_is_known(line->findings, &out->signature, &out->order, out->ray))
        return bad(line, "the finding of an earlier line once more: the log was changed");
    struct findings_member *member = findings_member_of(line->findings, &out->signature);
    if (!member || !findings_know(line->findings, &out->signature, &out->order, out->ray))
        return fail(line->reason, STATUS_MEMORY, "no memory for the log");
    member->entry.count++;
    member->entry.lines++;
    member->line = member->line ? member->line : line->number;
    return STATUS_OK;
}

static enum status read_checkpoint(const struct log_line *line, const json_t *root)
{
    const char *state = json_string_value(json_object_get(root, "checkpoint"));
    json_t *more = json_object_get(root, "more");
    if (!state || strlen(state) >= FINDINGS_STATE_MOST || !json_is_object(more))
        return bad(line, "a checkpoint has a text and 'more'");
    for (void *at = json_object_iter(more); at; at = json_object_iter_next(more, at)) {
        struct fuzz_signature signature;
        struct reason why;
        json_int_t count = json_integer_value(json_object_iter_value(at));
        if (fuzz_signature_parse(json_object_iter_key(at), &signature, &why))
            return bad(line, why.text);
        if (count <= 0)
            return bad(line, "'more' has a number that is not above 0");
        struct findings_member *member = findings_member_of(line->findings, &signature);
        if (!member)
            return fail(line->reason, STATUS_MEMORY, "no memory for the log");
        member->entry.count += (uint64_t)count;
        member->line = member->line ? member->line : line->number;
    }
    uint64_t said = 0;
    if (json_object_get(root, "findings") && !take_number(root, "findings", 10, &said))
        return bad(line, "'findings' is no number");
    if (json_object_get(root, "findings") && said != total(line->findings))
        return bad(line, "the lines before it have not as many findings as it says: "
                         "the log was changed");
    line->findings->checkpoints++;
    strcpy(line->findings->state, state);
    return STATUS_OK;
}

static enum status read_line(const struct log_line *line, const char *text, size_t length,
                             findings_line_fn *each, void *user)
{
    json_error_t error;
    struct findings_line finding = {.text = text, .length = length};
    if (!json_text_fits(text, length))
        return bad(line, JSON_TEXT_RULE);
    json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    enum status status;
    if (!json_is_object(root))
        status = bad(line, root ? "no JSON object" : error.text);
    else if (json_object_get(root, "checkpoint"))
        status = read_checkpoint(line, root);
    else
        status = read_finding(line, root, &finding);
    if (!status && each && !json_object_get(root, "checkpoint"))
        status = each(user, &finding, line->reason);
    json_decref(root);
    return status;
}

/* The writer was killed while it wrote the last line. */
static enum status cut_torn(struct findings *findings, unsigned long long number, size_t torn,
                            struct reason *reason)
{
    fail(&findings->said, STATUS_OK, "%.150s/findings.jsonl:%llu: a torn last line of %zu bytes%s",
         findings->folder.path, number, torn, findings->writable ? ", cut off" : ", left out");
    if (findings->writable && ftruncate(findings->log, (off_t)findings->log_size) != 0)
        return cannot(findings, reason);
    return STATUS_OK;
}

/* Lines of a descriptor. Not stdio's: closing a copy of the descriptor would end the lock. */
struct lines {
    int from;
    char *bytes;
    size_t size, capacity; /* read, and room */
    size_t start;          /* of the next line */
};

/* The next line, *length with its '\n', which only the last may lack; NULL at the end. */
static const char *next_line(struct lines *lines, size_t *length, enum status *status)
{
    size_t seen = lines->start;
    for (;;) {
        char *end =
            lines->size > seen ? memchr(lines->bytes + seen, '\n', lines->size - seen) : NULL;
        if (end) {
            const char *line = lines->bytes + lines->start;
            *length = (size_t)(end + 1 - line);
            lines->start += *length;
            return line;
        }
        if (lines->start > 0)
            memmove(lines->bytes, lines->bytes + lines->start, lines->size - lines->start);
        lines->size -= lines->start;
        lines->start = 0;
        seen = lines->size;
        void *array = lines->bytes;
        *status = array_reserve(&array, &lines->capacity, lines->size + (1 << 16), 1);
        lines->bytes = array;
        if (*status)
            return NULL;
        ssize_t got = read(lines->from, lines->bytes + lines->size, 1 << 16);
        if (got < 0 && errno != EINTR)
            *status = STATUS_INPUT;
        if (got == 0 && lines->size > 0) {
            *length = lines->size;
            lines->start = lines->size;
            return lines->bytes;
        }
        if (got == 0 || *status)
            return NULL;
        lines->size += got > 0 ? (size_t)got : 0;
    }
}

enum status findings_log_read(struct findings *findings, findings_line_fn *each, void *user,
                              struct reason *reason)
{
    struct log_line line = {findings, 0, reason};
    struct lines lines = {.from = findings->log};
    enum status status = STATUS_OK;
    const char *text;
    size_t length = 0;
    if (lseek(findings->log, 0, SEEK_SET) < 0)
        return bad(&line, strerror(errno));
    while (!status && (text = next_line(&lines, &length, &status)) != NULL) {
        line.number++;
        if (text[length - 1] != '\n') {
            status = cut_torn(findings, line.number, length, reason);
            break;
        }
        status = read_line(&line, text, length - 1, each, user);
        findings->log_size += length;
        if (status)
            break;
        text = NULL;
    }
    if (status == STATUS_MEMORY)
        fail(reason, status, "no memory for the log of %.200s", findings->folder.path);
    else if (status && !text)
        bad(&line, strerror(errno));
    free(lines.bytes);
    return status;
}
