/* Progress on standard error. For commands only. */
#ifndef CMD_PROGRESS_H
#define CMD_PROGRESS_H

#include "ref/base/base.h"

/* Prints progress on stderr once a command has run for 2 seconds: on a terminal one line that is
 * overwritten, else a line every 10 seconds. */
struct progress {
    const char *command;
    uint64_t start_ns, last_ns;
    bool terminal, shown;
    const char *part; /* what the share is of; NULL: all of the work */
    uint64_t part_ns; /* when it began */
    double share;     /* of it that is done; 0: unknown */
};

struct progress progress_make(const char *command);
/* Says how much of the work is done, or of a part of it (`part`, a constant; NULL: all). It begins
 * with `done` 0. Steps from now on print how long the rest may take. */
void progress_done(struct progress *progress, uint64_t done, uint64_t of, const char *part);
void progress_step(struct progress *progress, const char *format, ...) PRINTF_LIKE(2, 3);
/* Clears the line. */
void progress_end(struct progress *progress);

#endif
