/* The program as a process: its standard files, and how signals end it. */
#ifndef CMD_PROCESS_H
#define CMD_PROCESS_H

#include "ref/base/base.h"

#include <signal.h>

/* Opens /dev/null in place of standard files that are closed, the other way round: reading the
 * standard input and writing the standard output fail as on a closed file. To be called before
 * anything is opened. False: it cannot be opened. */
bool process_standard_files(void) MUST_USE;

/* SIGINT, SIGTERM and SIGHUP remove the temporary files (file_out_abandon) and end the process, by
 * that signal. Ignored ones (nohup) stay ignored. */
void process_signals(void);

/* From now on they set *caught to their number, so that a command with results to save can end by
 * itself. It has PROCESS_GRACE_MS to call process_signal_taken; then, or at the next signal, the
 * process is ended as above. An engine that hangs cannot delay that. */
#define PROCESS_GRACE_MS 700
void process_signals_caught(volatile sig_atomic_t *caught);

/* The command has seen *caught and does no more than to write its results. No effect before a
 * signal. */
void process_signal_taken(void);

#endif
