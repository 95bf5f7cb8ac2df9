/* Progress on standard error: what is done, and how long the rest may take. */
#include "cmd/common/cmd_progress.h"

#include "cmd/common/cmd_screen.h"
#include "ref/base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define PROGRESS_AFTER_NS 2000000000u
#define PROGRESS_TTY_NS   200000000u
#define PROGRESS_LOG_NS   10000000000u

struct progress progress_make(const char *command)
{
    uint64_t now = time_ns();
    return (struct progress){command, now, now, isatty(STDERR_FILENO) == 1, false, NULL, now, 0};
}

void progress_done(struct progress *progress, uint64_t done, uint64_t of, const char *part)
{
    if (done == 0)
        progress->part_ns = time_ns();
    progress->part = part;
    progress->share = of > 0 && done <= of ? (double)done / (double)of : 0;
}

void progress_step(struct progress *progress, const char *format, ...)
{
    uint64_t now = time_ns();
    uint64_t pause = progress->terminal ? PROGRESS_TTY_NS : PROGRESS_LOG_NS;
    if (now - progress->start_ns < PROGRESS_AFTER_NS || now - progress->last_ns < pause)
        return;
    progress->last_ns = now;
    progress->shown = true;
    char text[512] = "";
    const double share = progress->share, took = (double)(now - progress->part_ns) * 1e-9;
    text_append(text, sizeof text, "raydiff %s: %.0f s", progress->command,
                (double)(now - progress->start_ns) * 1e-9);
    if (share > 0)
        text_append(text, sizeof text, ", about %.0f s left%s%s", took * (1 - share) / share,
                    progress->part ? " of " : "", progress->part ? progress->part : "");
    text_append(text, sizeof text, ": ");
    va_list args;
    va_start(args, format);
    vsnprintf(text + strlen(text), sizeof text - strlen(text), format, args);
    va_end(args);
    if (progress->terminal) /* a line that is broken could not be overwritten */
        fprintf(stderr, "\r\033[K%.*s", (int)screen_width(STDERR_FILENO) - 1, text);
    else
        fprintf(stderr, "%s\n", text);
    fflush(stderr);
}

void progress_end(struct progress *progress)
{
    if (progress->shown && progress->terminal)
        fputs("\r\033[K", stderr);
    progress->shown = false;
}
