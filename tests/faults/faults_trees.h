/* Folders: copied, removed, compared, and looked over for what may never be left in them. */
#ifndef FAULTS_TREES_H
#define FAULTS_TREES_H

#include <stdbool.h>

#define TREES_PATH_MOST 4096
#define TREES_WHY_MOST  512

/* False: it could not be done. */
bool tree_copy(const char *from, const char *to);
bool tree_remove(const char *path); /* it need not be there */

/* Whether both hold the same, byte for byte; `why` says what differs. Of stats.json only that both
 * are whole, of other files that tell times (JSON, HTML, XML, CSV) all but numbers; of
 * findings.jsonl the lines of findings, in order, and the last checkpoint: the others are a matter
 * of when. Temporary files are not looked at. */
bool tree_same(const char *wanted, const char *got, char why[TREES_WHY_MOST]);

/* Whether every file in it is whole, however it was left: a trial has its end, a count is a number,
 * a page is closed. `tidy`: and none is a temporary one. */
bool tree_is_whole(const char *path, bool tidy, char why[TREES_WHY_MOST]);

/* Whether each line of a finding in the first folder's log is in the second's. */
bool tree_keeps(const char *before, const char *after, char why[TREES_WHY_MOST]);

/* Size of a file, -1: there is none; whether there is one. */
long tree_file_size(const char *folder, const char *name);
bool tree_has(const char *folder, const char *name);

/* Whether the first 8 KiB of a file hold a text. */
bool tree_file_holds(const char *folder, const char *name, const char *text);

/* Whether nothing is in a folder, and whether files can be made in it without a name. */
bool tree_is_empty(const char *folder);
bool tree_takes_nameless(const char *folder);

#endif
