/* A bitmap font: printable ASCII, 5 dots wide, 7 above the baseline and 2 below it. */
#ifndef FONT_H
#define FONT_H

#include "ref/base/base.h"

#define FONT_WIDTH   5
#define FONT_HEIGHT  9
#define FONT_ADVANCE 6 /* distance between characters */

/* Whether a character has a dot at `column` (< FONT_WIDTH) and `row` (< FONT_HEIGHT), row 0 at the
 * top. Anything but printable ASCII has the dots of '?'. */
bool font_dot(unsigned char character, int column, int row);

#endif
