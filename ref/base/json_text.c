#include "ref/base/json_text.h"

#include <string.h>

#define ALWAYS 256u /* objects */

bool json_text_fits(const char *bytes, size_t size)
{
    size_t objects = 0;
    const char *end = bytes + size;
    for (const char *at = bytes; at < end && (at = memchr(at, '{', (size_t)(end - at))); at++)
        objects++; /* also counts braces in strings */
    return objects <= size / JSON_TEXT_OBJECT + ALWAYS;
}
