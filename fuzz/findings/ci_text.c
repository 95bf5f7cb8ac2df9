#include "fuzz/findings/ci.h"

/* The length of the character of well-formed UTF-8 (RFC 3629) that `text` starts with, 0 if there
 * is none; *code: which. */
static size_t character(const char *text, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *byte = (const unsigned char *)text;
    size_t length = byte[0] < 0x80   ? 1
                    : byte[0] < 0xC2 ? 0
                    : byte[0] < 0xE0 ? 2
                    : byte[0] < 0xF0 ? 3
                                     : 4;
    if (byte[0] > 0xF4)
        length = 0;
    *code = length == 1 ? byte[0] : length ? byte[0] & (0xFFu >> (length + 1)) : 0;
    for (size_t i = 1; i < length; i++) {
        if ((byte[i] & 0xC0) != 0x80) /* the 0 at the end, too */
            return 0;
        *code = *code << 6 | (byte[i] & 0x3Fu);
    }
    if (length && (*code < least[length] || *code > 0x10FFFF || *code >> 11 == 0x1B))
        return 0;
    return length;
}

/* False: not allowed in XML 1.0, or invisible. */
static bool is_printable(uint32_t code)
{
    return code >= 0x20 && (code < 0x7F || code > 0x9F) && code != 0xFFFE && code != 0xFFFF;
}

/* Takes one character off: *code is it, or '?'; returns what follows. */
static const char *next(const char *text, const char **from, size_t *length, uint32_t *code)
{
    *from = text;
    *length = character(text, code);
    bool kept = *length && (is_printable(*code) || *code == '\n' || *code == '\t');
    text += *length ? *length : 1;
    if (!kept) {
        *from = "?";
        *length = 1;
        *code = '?';
    }
    return text;
}

struct escape {
    uint32_t code;
    const char *as;
};

static void put(FILE *to, const char *text, const struct escape *escape, size_t escapes)
{
    const char *from;
    size_t length;
    uint32_t code;
    while (*text) {
        size_t e = 0;
        text = next(text, &from, &length, &code);
        while (e < escapes && escape[e].code != code)
            e++;
        if (e < escapes)
            fputs(escape[e].as, to);
        else
            fwrite(from, 1, length, to);
    }
}

void ci_xml(FILE *to, const char *text)
{
    /* An attribute would turn the last two into blanks. */
    static const struct escape escape[] = {{'<', "&lt;"},   {'>', "&gt;"},   {'&', "&amp;"},
                                           {'"', "&quot;"}, {'\n', "&#10;"}, {'\t', "&#9;"}};
    put(to, text, escape, ARRAY_COUNT(escape));
}

void ci_quote(FILE *to, const char *text)
{
    static const struct escape escape[] = {
        {'"', "\\\""}, {'\\', "\\\\"}, {'\n', "\\n"}, {'\t', "\\t"}};
    fputc('"', to);
    put(to, text, escape, ARRAY_COUNT(escape));
    fputc('"', to);
}

void ci_line(FILE *to, const char *text)
{
    static const struct escape escape[] = {{'#', "\\#"}, {'\\', "\\\\"}, {'\n', " "}, {'\t', " "}};
    put(to, text, escape, ARRAY_COUNT(escape));
}

void ci_plain(FILE *to, const char *text)
{
    put(to, text, NULL, 0);
}
