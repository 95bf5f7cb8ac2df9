/* The log of a folder of findings, and what a campaign reads of itself in it. */
#define _POSIX_C_SOURCE 200809L
#include "fuzz/campaign/campaign.h"
#include "fuzz/findings/findings_inner.h"
#include "tests/readers/reader_entry.h"

#include <stdlib.h>
#include <string.h>

static enum status count_line(void *user, const struct findings_line *line, struct reason *reason)
{
    (void)reason;
    size_t *lines = user;
    READER_MUST(line->length > 0 && line->text[line->length] == '\n');
    READER_MUST(findings_order_compare(&line->order, &line->order) == 0);
    ++*lines;
    return STATUS_OK;
}

/* Values of the state fit into what they are asked for. */
static void must_be_state(const char *state)
{
    static const char *const name[] = {"next", "seed", "coverage", "shrunk", ""};
    char value[64];
    for (size_t i = 0; i < ARRAY_COUNT(name); i++)
        for (size_t size = 1; size <= sizeof value; size *= 2)
            if (campaign_state_get(state, name[i], value, size))
                READER_MUST(strlen(value) < size);
}

/* A folder whose log is the bytes. */
static struct findings *open_log(const char *bytes, size_t size)
{
    char path[READER_PATH_MOST];
    struct findings *findings = alloc_zeroed(1, sizeof *findings);
    READER_MUST(findings);
    findings->log = reader_file(bytes, size, path);
    READER_MUST(folder_open(".", false, &findings->folder, NULL) == STATUS_OK);
    return findings;
}

static bool play(const char *bytes, size_t size)
{
    struct reason reason = {""};
    size_t lines = 0;
    uint64_t logged = 0;
    struct findings *findings = open_log(bytes, size);
    enum status status = findings_log_read(findings, count_line, &lines, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    for (size_t i = 0; i < findings_count(findings) && !status; i++) {
        const struct findings_entry *entry = findings_entry(findings, i);
        char text[FUZZ_SIGNATURE_MOST];
        struct fuzz_signature again;
        fuzz_signature_print(&entry->signature, text);
        READER_MUST(fuzz_signature_parse(text, &again, &reason) == STATUS_OK);
        READER_MUST(fuzz_signature_same(&again, &entry->signature));
        READER_MUST(findings_find(findings, &again) == entry);
        logged += entry->lines;
    }
    READER_MUST(status || logged == lines);
    READER_MUST(strlen(findings_state(findings)) < FINDINGS_STATE_MOST);
    must_be_state(findings_state(findings));
    bool taken = status == STATUS_OK && (lines > 0 || findings_state(findings)[0]);
    findings_close(findings);
    return taken;
}

/* It is read in pieces of 64 kB, into an array that doubles. */
const struct reader_entry reader_entry = {"log", 1 << 19, play};
