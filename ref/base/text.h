/* Text that grows in a buffer of fixed size. */
#ifndef TEXT_H
#define TEXT_H

#include "ref/base/base.h"

/* Appends to the text in `text`, cut to what fits. */
void text_append(char *text, size_t text_bytes, const char *format, ...) PRINTF_LIKE(3, 4);

#endif
