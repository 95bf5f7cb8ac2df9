/* The baseline: known findings that raydiff cannot repair, each with a reason, a link and a day
 * until which it is excused. Lines "PATTERN [@VERSION] until YYYY-MM-DD REASON...
 * LINK", "until -" for ever; see fuzz/findings/waivers.h. PATTERN is four fields, shell wildcards
 * each, of a signature: engine.layout.kind.cause; VERSION is of the finding's versions.
 * fuzz/baseline.txt is part of the program. */
#ifndef FUZZ_BASELINE_H
#define FUZZ_BASELINE_H

#include "fuzz/play/player.h"
#include "fuzz/findings/waivers.h"

struct baseline {
    struct waivers *list; /* the shipped one, then files in the order in which they were added */
    size_t count, capacity;
};

/* Reads the shipped list. Errors: STATUS_MEMORY; STATUS_INPUT our own list is wrong. */
enum status baseline_open(struct baseline *out, struct reason *reason) MUST_USE;

/* Adds a file. Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY. The baseline is then as it
 * was. */
enum status baseline_add_file(struct baseline *baseline, const char *path,
                              struct reason *reason) MUST_USE;

/* The same of bytes in memory, which are copied. */
enum status baseline_add(struct baseline *baseline, const char *name, const char *text, size_t size,
                         struct reason *reason) MUST_USE;

void baseline_close(struct baseline *baseline); /* a zero one is fine */

enum baseline_state {
    BASELINE_NEW,
    BASELINE_KNOWN,
    BASELINE_EXPIRED, /* was known; counts as new */
};

struct baseline_answer {
    enum baseline_state state;
    char text[768]; /* one line: reason, link, where that stands; "" if new */
};

/* Today in UTC, "YYYY-MM-DD". */
#define BASELINE_DAY 11
void baseline_today(char day[BASELINE_DAY]);

/* Looks up a finding with these versions (as in struct finding_file) on that day: the first entry
 * that matches and has not expired, else the first that has. Matching entries are noted as used. */
void baseline_ask(struct baseline *baseline, const struct fuzz_signature *signature,
                  const char *versions, const char *today, struct baseline_answer *answer);

/* Returns the next entry from *at on (0 to begin) that excused nothing although these contestants,
 * in these versions, could have shown a match; NULL: no more. *path: of its list. */
const struct waiver *baseline_unused(const struct baseline *baseline,
                                     const struct fuzz_field *field, const char *versions,
                                     size_t *at, const char **path);

#endif
