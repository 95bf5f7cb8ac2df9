/* Is a text one XML element? What tests of SVG and HTML ask. */
#ifndef TESTS_WELL_FORMED_H
#define TESTS_WELL_FORMED_H

#include "ref/base/base.h"

#include <ctype.h>
#include <string.h>

/* Skips a name; NULL if there is none. */
static inline const char *skip_name(const char *at)
{
    if (!isalpha((unsigned char)*at))
        return NULL;
    while (isalnum((unsigned char)*at) || *at == '-')
        at++;
    return at;
}

/* Skips text up to `end`: no markup inside, every & begins an entity that XML knows. */
static inline const char *skip_text(const char *at, char end)
{
    static const char *const entities[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#10;", "&#9;"};
    for (; *at && *at != end; at++) {
        bool known = *at != '&';
        for (size_t i = 0; i < ARRAY_COUNT(entities); i++)
            known = known || strncmp(at, entities[i], strlen(entities[i])) == 0;
        if (!known || *at == '<' || ((unsigned char)*at < 0x20 && *at != '\n'))
            return NULL;
    }
    return at;
}

/* The attributes of a tag, each once named and quoted. */
static inline const char *skip_attributes(const char *at)
{
    while (at && *at == ' ') {
        at++;
        if (*at == '/' || *at == '>') /* a space before the end is allowed */
            break;
        at = skip_name(at);
        if (!at || strncmp(at, "=\"", 2) != 0)
            return NULL;
        at = skip_text(at + 2, '"');
        at = at && *at == '"' ? at + 1 : NULL;
    }
    return at;
}

/* True if `text` is one element and nothing else: tags closed in order, attributes quoted. */
static inline bool well_formed(const char *text)
{
    const char *open[16];
    size_t depth = 0, roots = 0;
    while (*text) {
        if (*text != '<') {
            text = skip_text(text, '<');
            if (!text)
                return false;
            continue;
        }
        bool closing = text[1] == '/';
        const char *name = text + 1 + closing, *end = skip_name(name);
        if (!end)
            return false;
        if (closing) {
            size_t length = (size_t)(end - name);
            if (depth == 0 || strncmp(open[--depth], name, length) != 0 || *end != '>' ||
                isalnum((unsigned char)open[depth][length]))
                return false;
            text = end + 1;
            continue;
        }
        roots += depth == 0;
        end = skip_attributes(end);
        if (!end || depth == ARRAY_COUNT(open))
            return false;
        if (*end == '>')
            open[depth++] = name;
        else if (*end++ != '/' || *end != '>')
            return false;
        text = end + 1;
    }
    return depth == 0 && roots == 1;
}

static inline size_t occurrences(const char *text, const char *what)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, what)); at++)
        count++;
    return count;
}

#endif
