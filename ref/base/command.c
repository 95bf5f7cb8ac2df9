#include "ref/base/command.h"
#include "ref/base/text.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

int exit_worse(int a, int b)
{
    static const int order[] = {EXIT_INTERNAL, EXIT_ENGINE,  EXIT_USAGE,
                                EXIT_MISMATCH, EXIT_SKIPPED, EXIT_AGREE};
    for (size_t i = 0; i < ARRAY_COUNT(order); i++)
        if (a == order[i] || b == order[i])
            return order[i];
    return EXIT_INTERNAL;
}

int exit_of_status(enum status status)
{
    switch (status) {
    case STATUS_OK:
        return EXIT_AGREE;
    case STATUS_INPUT:
    case STATUS_LIMIT:
        return EXIT_USAGE;
    case STATUS_REFUSED:
        return EXIT_MISMATCH;
    case STATUS_UNSUPPORTED:
        return EXIT_SKIPPED;
    case STATUS_DEVICE:
        return EXIT_ENGINE;
    case STATUS_MEMORY:
    case STATUS_INTERNAL:
        return EXIT_INTERNAL;
    }
    return EXIT_INTERNAL;
}

int exit_with_reason(const char *command, enum status status, const struct reason *reason)
{
    if (status)
        fprintf(stderr, "raydiff %s: %s\n", command, reason->text);
    return exit_of_status(status);
}

const char *plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

int usage_error(const char *command, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "raydiff %s: ", command);
    vfprintf(stderr, format, args);
    fprintf(stderr, " (see raydiff %s --help)\n", command);
    va_end(args);
    return EXIT_USAGE;
}

void command_word(char *text, size_t text_bytes, const char *word)
{
    bool plain = word[0] != 0;
    for (const char *at = word; *at; at++)
        plain = plain && (strchr("._-/:=,+", *at) || (*at >= '0' && *at <= '9') ||
                          (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z'));
    text_append(text, text_bytes, "%s", plain ? " " : " '");
    for (const char *at = word; *at; at++)
        text_append(text, text_bytes, "%s", *at == '\'' ? "'\\''" : (const char[2]){*at, '\0'});
    text_append(text, text_bytes, "%s", plain ? "" : "'");
}

enum status parse_count(const char *flag, const char *text, uint64_t least, uint64_t most,
                        uint64_t *out, struct reason *reason)
{
    *out = 0;
    char *end = NULL;
    errno = 0;
    double value = strtod(text, &end);
    /* strtod also accepts blanks, hexadecimal, inf and nan. */
    bool decimal = text[strspn(text, "0123456789.eE+-")] == '\0';
    bool whole = decimal && end != text && *end == '\0' && errno == 0 && value == floor(value);
    /* From 2^53 on a double skips integers, so these are read as integers. */
    if (whole && value >= 0x1p53) {
        *out = strtoull(text, &end, 10);
        whole = *end == '\0' && errno == 0;
    } else if (whole && value >= 0) {
        *out = (uint64_t)value;
    }
    if (!whole || value < 0 || *out < least || *out > most) {
        *out = 0;
        return fail(reason, STATUS_INPUT, "%s: '%s' is not a whole number from %llu to %llu", flag,
                    text, (unsigned long long)least, (unsigned long long)most);
    }
    return STATUS_OK;
}

enum status parse_float(const char *flag, const char *text, float *out, struct reason *reason)
{
    char *end = NULL;
    *out = strtof(text, &end);
    if (end != text && *end == '\0' && float_is_finite(*out))
        return STATUS_OK;
    *out = 0;
    return fail(reason, STATUS_INPUT, "%s: '%s' is not a finite number", flag, text);
}
