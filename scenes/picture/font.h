/* A bitmap font of our own: printable ASCII, 5 dots wide, 7 above the line and 2 below it. */
#ifndef FONT_H
#define FONT_H

#include "ref/base/base.h"

#define FONT_WIDTH   5
#define FONT_HEIGHT  9
#define FONT_ADVANCE 6 /* from one character to the next */

/* Whether a character has a dot at that column and row, of FONT_WIDTH and FONT_HEIGHT, row 0 at the
 * top. What is not printable ASCII looks like '?'. */
bool font_dot(unsigned char character, int column, int row);

#endif
