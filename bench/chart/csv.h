/* Texts in CSV files. */
#ifndef CSV_H
#define CSV_H

#include <stdio.h>

/* Writes a field as RFC 4180 has it: in quotes if need be, quotes doubled. Write errors are left in
 * the stream for its owner. */
void csv_text(FILE *stream, const char *text);

#endif
