/* The program as a process: its standard files, and how signals end it. */
#ifndef CMD_PROCESS_H
#define CMD_PROCESS_H

#include "ref/base/base.h"

#include <signal.h>

/* Opens /dev/null for each closed standard file, in the opposite direction: reading standard input
 * and writing standard output or error then fail as on a closed file. Call it before anything is
 * opened. Returns false if it cannot be opened. */
bool process_standard_files(void) MUST_USE;

/* From now on, SIGINT, SIGTERM and SIGHUP remove the temporary files (file_out_abandon) and end the
 * process by that signal. Signals that are ignored (nohup) stay ignored. */
void process_signals(void);

/* From now on, these signals set *caught to their number, so that a command with results to save
 * can end by itself. If it does not call process_signal_taken within PROCESS_GRACE_MS, or if
 * another signal arrives, the process is ended as above. An engine that hangs cannot delay that. */
#define PROCESS_GRACE_MS 700
void process_signals_caught(volatile sig_atomic_t *caught);

/* The command has seen *caught and now only writes its results, so PROCESS_GRACE_MS no longer
 * applies. No effect before a signal. */
void process_signal_taken(void);

#endif
