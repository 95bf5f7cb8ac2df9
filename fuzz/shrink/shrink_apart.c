/* Plays candidates in a child process, in which an engine may crash or hang. They are sent as the
 * text of finding files. */
#include "ref/outside/child.h"
#include "fuzz/shrink/shrink_inner.h"
#include "fuzz/findings/versions.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of all candidates of a call, at most, unless one has more. */
#define MESSAGE_MOST ((size_t)64 << 20)
/* The longest that an engine may take to open; drivers compile then. */
#define OPEN_MS 120000u
/* How often a child's memory is looked at while it works. */
#define LOOK_MS 50u
/* The longest that an idle child takes to end by itself. */
#define END_MS 5000u

/* The first message of the child, and its reply to every call. */
struct hello {
    enum status status;
    struct reason reason;
    char versions[1024];
};

struct reply {
    enum status status;
    struct reason reason;
    size_t first;
    struct fuzz_finding finding;
};

struct apart {
    const struct shrink_apart *how;
    const struct finding_file *file;
    struct child child; /* pid 0: none */
    char versions[1024];
    struct fuzz_finding finding; /* of the last trial that showed it */
};

/* --- the child ------------------------------------------------------------------------------- */

/* A message is the texts of candidates, each with a 0 behind it. */
static enum status read_candidates(const char *bytes, size_t size, struct fuzz_trial *trial,
                                   size_t *count, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (*count = 0; size > 0 && *count < SHRINK_BATCH && !status; ++*count) {
        struct finding_file file;
        size_t length = strlen(bytes);
        status = finding_file_parse("candidate", bytes, length, &file, reason);
        trial[*count] = file.trial;
        bytes += length + 1;
        size -= length + 1;
    }
    return status;
}

static void answer(struct shrink_asking *asking, const void *bytes, size_t size,
                   struct reply *reply)
{
    struct fuzz_trial trial[SHRINK_BATCH];
    size_t count;
    *reply = (struct reply){0};
    reply->status = read_candidates(bytes, size, trial, &count, &reply->reason);
    if (!reply->status)
        reply->status = shrink_ask_player(asking, trial, count, &reply->first, &reply->reason);
    reply->finding = asking->finding;
    for (size_t i = 0; i < count; i++)
        fuzz_trial_free(&trial[i]);
}

static void live(struct child *parent, void *user)
{
    const struct apart *apart = user;
    const struct fuzz_field field = {
        .who = {apart->how->who}, .count = 1, .options = apart->how->engines};
    struct shrink_asking asking = {.wanted = &apart->file->signature};
    struct hello hello = {0};
    const void *bytes;
    size_t size;
    hello.status = fuzz_player_open(&field, &asking.player, &hello.reason);
    if (!hello.status)
        fuzz_versions(&apart->how->who.engine, 1, &apart->how->engines, hello.versions,
                      sizeof hello.versions);
    bool heard = child_send(parent, &hello, sizeof hello, CHILD_FOREVER) && !hello.status;
    while (heard &&
           child_receive(parent, SIZE_MAX / 8, CHILD_FOREVER, &bytes, &size) == CHILD_GOT) {
        struct reply reply;
        answer(&asking, bytes, size, &reply);
        heard = child_send(parent, &reply, sizeof reply, CHILD_FOREVER);
    }
    fuzz_player_close(asking.player);
}

/* --- the parent ------------------------------------------------------------------------------ */

/* The result of a call. */
enum apart_fared { ANSWERED, DIED, HUNG };

/* Waits for a message of `size` bytes. A child that died or hung is ended. */
static enum apart_fared hear(struct apart *apart, void *to, size_t size, uint64_t ms)
{
    uint64_t start = time_ns(), most = apart->how->memory;
    enum apart_fared fared = ANSWERED;
    for (;;) {
        const void *bytes;
        size_t got_size;
        enum child_got got = child_receive(&apart->child, size, LOOK_MS, &bytes, &got_size);
        if (got == CHILD_GOT && got_size == size) {
            memcpy(to, bytes, size);
            return ANSWERED;
        }
        if (got != CHILD_LATE || (most && child_memory(&apart->child) > most))
            fared = DIED;
        else if (time_ns() - start > ms * 1000000u)
            fared = HUNG;
        else
            continue;
        child_end(&apart->child, 0, NULL);
        return fared;
    }
}

/* Starts the child, if there is none; *fared: the result of opening the engine. */
static enum status begin(struct apart *apart, enum apart_fared *fared, struct reason *reason)
{
    struct hello hello;
    *fared = ANSWERED;
    if (apart->child.pid)
        return STATUS_OK;
    enum status status = child_start(live, apart, &apart->child, reason);
    if (status)
        return status;
    *fared = hear(apart, &hello, sizeof hello, OPEN_MS);
    if (*fared != ANSWERED)
        return STATUS_OK;
    memcpy(apart->versions, hello.versions, sizeof apart->versions);
    if (hello.status)
        child_end(&apart->child, END_MS, NULL);
    return hello.status ? fail(reason, hello.status, "%s", hello.reason.text) : STATUS_OK;
}

/* Appends the text of a candidate. */
static enum status put(const struct fuzz_trial *trial, char **bytes, size_t *size, size_t *capacity,
                       struct reason *reason)
{
    const struct finding_file file = {.trial = *trial};
    char *text;
    size_t length;
    void *array = *bytes;
    enum status status = finding_file_print(&file, &text, &length, reason);
    if (status)
        return status;
    if (array_reserve(&array, capacity, *size + length + 1, 1)) {
        free(text);
        return fail(reason, STATUS_MEMORY, "no memory for the text of trials");
    }
    *bytes = array;
    memcpy(*bytes + *size, text, length + 1);
    *size += length + 1;
    free(text);
    return STATUS_OK;
}

/* Plays candidates in one call: *asked is how many, at least one. */
static enum status ask_some(struct apart *apart, const struct fuzz_trial *candidate, size_t count,
                            size_t *asked, struct reply *reply, enum apart_fared *fared,
                            struct reason *reason)
{
    char *bytes = NULL;
    size_t size = 0, capacity = 0;
    enum status status = begin(apart, fared, reason);
    *reply = (struct reply){0};
    for (*asked = 0; *asked < count && size < MESSAGE_MOST && !status; ++*asked)
        status = put(&candidate[*asked], &bytes, &size, &capacity, reason);
    uint64_t ms = (uint64_t)apart->how->ms * (*asked > 1 ? 2 : 1); /* many are small ones */
    if (!status && *fared == ANSWERED) {
        bool sent = child_send(&apart->child, bytes, size, (uint32_t)ms);
        *fared = sent ? hear(apart, reply, sizeof *reply, ms) : DIED;
        if (!sent)
            child_end(&apart->child, 0, NULL);
    }
    free(bytes);
    if (!status && *fared == ANSWERED && reply->status)
        status = fail(reason, reply->status, "%s", reply->reason.text);
    return status;
}

/* Plays one candidate. If the child dies, it shows a crash. */
static enum status ask_one(struct apart *apart, const struct fuzz_trial *candidate, bool *shown,
                           struct reason *reason)
{
    struct reply reply;
    enum apart_fared fared;
    size_t asked;
    enum status status = ask_some(apart, candidate, 1, &asked, &reply, &fared, reason);
    enum fuzz_kind kind = apart->file->signature.kind;
    *shown = false;
    if (status)
        return status;
    if (fared == ANSWERED) {
        *shown = reply.first == 0;
        if (*shown)
            apart->finding = reply.finding;
    } else if (kind == (fared == HUNG ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH) &&
               apart->file->signature.cause == CAUSE_UNEXPLAINED) {
        *shown = true;
        apart->finding = (struct fuzz_finding){.signature = apart->file->signature,
                                               .ray = candidate->ray_count,
                                               .answer = {.prim = ABI_NO_PRIM}};
    }
    return STATUS_OK;
}

static enum status ask_apart(void *user, const struct fuzz_trial *candidate, size_t count,
                             size_t *first, struct reason *reason)
{
    struct apart *apart = user;
    enum fuzz_kind kind = apart->file->signature.kind;
    bool singly = kind == FUZZ_KIND_CRASH || kind == FUZZ_KIND_HANG;
    enum status status = STATUS_OK;
    size_t done = 0;
    while (done < count && !singly && !status) {
        struct reply reply;
        enum apart_fared fared;
        size_t asked;
        status = ask_some(apart, candidate + done, count - done, &asked, &reply, &fared, reason);
        if (status || fared != ANSWERED)
            break; /* one of them ends the child: play them one by one */
        if (reply.first < asked) {
            *first = done + reply.first;
            apart->finding = reply.finding;
            return STATUS_OK;
        }
        done += asked;
    }
    for (; done < count && !status; done++) {
        bool shown;
        *first = done;
        status = ask_one(apart, &candidate[done], &shown, reason);
        if (!status && shown)
            return STATUS_OK;
    }
    *first = count;
    return status;
}

enum status fuzz_shrink_apart(const struct shrink_apart *how, const struct finding_file *file,
                              const struct shrink_options *options, struct finding_file *out,
                              struct shrink_stats *stats, struct reason *reason)
{
    struct apart apart = {.how = how, .file = file};
    struct fuzz_trial smaller;
    *out = (struct finding_file){0};
    *stats = (struct shrink_stats){0};
    enum status status = shrink_check_who(&how->who, file, reason);
    if (!status)
        status =
            fuzz_shrink_trial(&file->trial, ask_apart, &apart, options, &smaller, stats, reason);
    child_end(&apart.child, END_MS, NULL);
    if (status)
        return status;
    *out = *file;
    out->trial = smaller;
    if (apart.versions[0])
        memcpy(out->versions, apart.versions, sizeof out->versions);
    stats->finding = apart.finding;
    return STATUS_OK;
}
