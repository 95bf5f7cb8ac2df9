/* A bitmap font of our own: printable ASCII, 5 dots wide, 7 above the line and 2 below it. */
#ifndef FONT_H
#define FONT_H

#include "ref/base/base.h"

#define FONT_WIDTH   5
#define FONT_HEIGHT  9
#define FONT_ADVANCE 6 /* from one character to the next */

/* The dots of a character: [column], bit 0 the topmost row. What is not printable ASCII looks like
 * '?'. */
const uint16_t *font_glyph(unsigned char character);

#endif
