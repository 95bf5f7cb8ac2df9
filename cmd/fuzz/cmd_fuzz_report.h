/* Shared by cmd_fuzz_report.c and cmd_fuzz_ci.c; private to them. */
#ifndef CMD_FUZZ_REPORT_H
#define CMD_FUZZ_REPORT_H

#include "cmd/fuzz/cmd_fuzz.h"
#include "fuzz/findings/findings_report.h"
#include "ref/outside/pipe.h"

#define NAME_MOST   64
#define UNUSED_MOST 512

/* The texts that describe a finding, in all formats. */
struct finding_words {
    enum findings_report_state state;
    struct baseline_answer answer;
    char signature[FUZZ_SIGNATURE_MOST], first[FUZZ_PATH_MOST], smallest[FUZZ_PATH_MOST];
    char replay[FUZZ_PATH_MOST + PIPE_NAME_MOST]; /* the command */
};

void fuzz_describe(const struct fuzz_command *c, const struct campaign_view *view, size_t i,
                   struct finding_words *out);

double fuzz_seconds(uint64_t ns);

/* Finds the next baseline entry from *at on that excused nothing; false: none left. Call it after
 * all findings were described. */
bool fuzz_unused_line(const struct fuzz_command *c, const struct campaign_view *view, size_t *at,
                      char line[UNUSED_MOST]);

void fuzz_contestant_name(const struct campaign_view *view, size_t i, char name[NAME_MOST]);

/* Writes the files of --junit, --tap and --jsonl. Errors: those of the writers in
 * fuzz/findings/findings_report.h; STATUS_MEMORY. */
enum status fuzz_write_ci(const struct fuzz_command *c, const struct campaign_view *view,
                          struct reason *reason) MUST_USE;

#endif
