#include "ref/base/text.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void text_append(char *text, size_t text_bytes, const char *format, ...)
{
    size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    vsnprintf(text + used, text_bytes - used, format, args);
    va_end(args);
}

size_t utf8_bytes(const char *text)
{
    const unsigned char *byte = (const unsigned char *)text;
    const size_t bytes = byte[0] < 0x80   ? byte[0] != 0
                         : byte[0] < 0xE0 ? 2
                         : byte[0] < 0xF0 ? 3
                                          : 4;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (bytes < 2)
        return bytes;
    uint32_t value = byte[0] & (0x7Fu >> bytes);
    for (size_t i = 1; i < bytes; i++) {
        if ((byte[i] & 0xC0) != 0x80)
            return 0;
        value = value << 6 | (byte[i] & 0x3F);
    }
    if (byte[0] < 0xC0 || byte[0] > 0xF7 || value < least[bytes] || value > 0x10FFFF)
        return 0;
    return value >= 0xD800 && value <= 0xDFFF ? 0 : bytes;
}

bool utf8_is_text(const char *text)
{
    for (size_t bytes; (bytes = utf8_bytes(text)) > 0;)
        text += bytes;
    return *text == '\0';
}

const char *counted_text(char text[COUNTED_MOST], uint64_t count, const char *noun)
{
    static const struct {
        const char *end, *plural;
    } rules[] = {{"ex", "ices"}, {"leaf", "leaves"}, {"x", "xes"},
                 {"sh", "shes"}, {"ch", "ches"},     {"s", "ses"}};
    size_t length = strlen(noun);
    const char *end = "s";
    for (size_t i = 0; i < ARRAY_COUNT(rules) && count != 1; i++) {
        size_t tail = strlen(rules[i].end);
        if (length < tail || strcmp(noun + length - tail, rules[i].end) != 0)
            continue;
        length -= tail;
        end = rules[i].plural;
        break;
    }
    snprintf(text, COUNTED_MOST, "%" PRIu64 " %.*s%s", count, (int)length, noun,
             count == 1 ? "" : end);
    return text;
}

const char *bound_text(char text[BOUND_TEXT], double bound)
{
    /* A ten-thousandth is less than a step of the last digit, so no step is left out. */
    for (double up = bound;; up *= 1.0001) {
        snprintf(text, BOUND_TEXT, "%.4g", up);
        if (!(strtod(text, NULL) < bound))
            return text;
    }
}
