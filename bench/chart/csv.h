/* Text fields in CSV files. */
#ifndef CSV_H
#define CSV_H

#include <stdio.h>

/* Writes a field as in RFC 4180: quoted if needed, with quotes doubled. Write errors stay in the
 * stream for its owner. */
void csv_text(FILE *stream, const char *text);

#endif
