#define _POSIX_C_SOURCE 200809L /* strndup */
#include "tests/mutation/mutation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEYWORDS                                                                                   \
    "if for while do switch case default return sizeof else goto break continue _Static_assert "   \
    "layout"
#define TYPES                                                                                      \
    "const static extern inline struct enum union unsigned signed void bool char short int long "  \
    "float double size_t int32_t uint32_t int64_t uint64_t uint16_t uint8_t int16_t int8_t "       \
    "precise highp uint vec2 vec3 vec4 uvec2 uvec3 uvec4 ivec3 bvec3 in out inout uniform buffer"

/* The source from token `first` to the end of token `last`. */
struct span {
    const char *text;
    size_t at, bytes;
};

static struct span span_of(const struct tokens *t, size_t first, size_t last)
{
    size_t at = t->token[first].at, end = t->token[last].at + t->token[last].length;
    return (struct span){t->source + at, at, end - at};
}

static void add(struct mutations *out, const struct tokens *t, const char *kind, size_t i,
                struct span what, const char *text)
{
    if (out->count == out->room) {
        out->room = out->room ? 2 * out->room : 256;
        void *more = realloc(out->mutation, out->room * sizeof *out->mutation);
        out->failed = out->failed || !more;
        if (!more)
            return;
        out->mutation = more;
    }
    char *copy = strdup(text);
    out->failed = out->failed || !copy;
    out->mutation[out->count] =
        (struct mutation){kind, t->token[i].line, what.at, what.bytes, copy};
    out->count += copy != NULL;
}

/* printf of at most what a few arguments of a call need. */
#define TEXT_MOST 4096
#define ADD(out, t, kind, i, what, ...)                                                            \
    do {                                                                                           \
        char text_[TEXT_MOST];                                                                     \
        if (snprintf(text_, sizeof text_, __VA_ARGS__) < TEXT_MOST)                                \
            add(out, t, kind, i, what, text_);                                                     \
    } while (0)
#define SPAN(span) (int)(span).bytes, (span).text

/* True if a value ends before token i, so that + - * & there have two sides. */
static bool has_left_side(const struct tokens *t, size_t i)
{
    if (i == 0 || token_among(t, i - 1, KEYWORDS))
        return false;
    return t->token[i - 1].kind != TOKEN_SIGN || token_among(t, i - 1, ") ]");
}

/* True if the * at token i makes a type or a cast, or takes what a pointer points to. */
static bool is_pointer(const struct tokens *t, size_t i)
{
    return !has_left_side(t, i) || token_among(t, i - 1, TYPES) ||
           (i > 1 && token_among(t, i - 2, "struct enum union const")) || token_is(t, i + 1, ")") ||
           token_is(t, i + 1, "*") || token_is(t, i + 1, "const");
}

/* True if it declares: a type, or a word before another word, or before a * and a word. */
static bool declares(const struct tokens *t, size_t i)
{
    if (token_among(t, i, TYPES))
        return true;
    if (token_among(t, i, KEYWORDS))
        return false;
    if (t->token[i].kind != TOKEN_WORD || i + 2 >= t->count)
        return false;
    return t->token[i + 1].kind == TOKEN_WORD ||
           (token_is(t, i + 1, "*") && t->token[i + 2].kind == TOKEN_WORD);
}

/* True if the [ at token i begins the size of an array that is declared there: nothing depends on
 * how much longer than needed it is. */
static bool is_size_of(const struct tokens *t, size_t i)
{
    while (i > 0 && token_is(t, i - 1, "]"))
        i = t->token[i - 1].mate;
    if (i < 2 || t->token[i - 1].kind != TOKEN_WORD)
        return false;
    if (t->token[i - 2].kind == TOKEN_WORD)
        return !token_among(t, i - 2, "return case else sizeof goto do");
    if (!token_is(t, i - 2, ","))
        return false;
    size_t first = i - 1; /* of the statement */
    while (first > 0 && !token_among(t, first - 1, "; { } ("))
        first = token_among(t, first - 1, ") ]") ? t->token[first - 1].mate : first - 1;
    return declares(t, first);
}

/* --- operators, constants, signs
 * ---------------------------------------------------------------- */

static void operators(const struct tokens *t, size_t i, struct mutations *out)
{
    static const struct {
        const char *kind, *from, *to;
    } table[] = {
        {"border", "<", "<="},      {"border", "<=", "<"},      {"border", ">", ">="},
        {"border", ">=", ">"},      {"compare", "<", ">="},     {"compare", "<=", ">"},
        {"compare", ">", "<="},     {"compare", ">=", "<"},     {"compare", "==", "!="},
        {"compare", "!=", "=="},    {"arithmetic", "+", "-"},   {"arithmetic", "-", "+"},
        {"arithmetic", "*", "/"},   {"arithmetic", "/", "*"},   {"arithmetic", "%", "*"},
        {"arithmetic", "++", "--"}, {"arithmetic", "--", "++"}, {"arithmetic", "+=", "-="},
        {"arithmetic", "-=", "+="}, {"arithmetic", "*=", "/="}, {"arithmetic", "/=", "*="},
        {"logic", "&&", "||"},      {"logic", "||", "&&"},      {"bits", "<<", ">>"},
        {"bits", ">>", "<<"},       {"bits", "&", "|"},         {"bits", "|", "&"},
        {"bits", "^", "|"},         {"bits", "&=", "|="},       {"bits", "|=", "&="},
    };
    bool two_sided = has_left_side(t, i) && !is_pointer(t, i);
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        if (token_is(t, i, table[k].from) &&
            (two_sided || !strchr("+-*&", table[k].from[0]) || table[k].from[1]))
            add(out, t, table[k].kind, i, span_of(t, i, i), table[k].to);
    if (token_is(t, i, "!"))
        add(out, t, "logic", i, span_of(t, i, i), "");
    if (token_is(t, i, "~"))
        add(out, t, "bits", i, span_of(t, i, i), "");
    if (token_is(t, i, "-") && !has_left_side(t, i))
        add(out, t, "sign", i, span_of(t, i, i), "");
}

static void constants(const struct tokens *t, size_t i, struct mutations *out)
{
    const struct span span = span_of(t, i, i);
    bool hex = strncmp(span.text, "0x", 2) == 0 || strncmp(span.text, "0X", 2) == 0;
    bool is_float = false;
    for (size_t k = 0; k < span.bytes; k++)
        is_float = is_float || strchr(hex ? ".pP" : ".eEfF", span.text[k]) != NULL;
    bool zero = strtod(span.text, NULL) == 0;
    const bool is_size =
        i > 0 && token_is(t, i - 1, "[") && token_is(t, i + 1, "]") && is_size_of(t, i - 1);
    if (is_float && zero)
        add(out, t, "constant", i, span, "1.0");
    else if (is_float)
        ADD(out, t, "constant", i, span, "(%.*s * 2)", SPAN(span));
    else if (!is_size)
        ADD(out, t, "constant", i, span, zero ? "1" : "(%.*s + 1)", SPAN(span));
    if (!is_float && !zero)
        ADD(out, t, "constant", i, span, "(%.*s - 1)", SPAN(span));
}

/* --- statements
 * --------------------------------------------------------------------------------- */

/* The ; that ends the statement which begins at token i, or the count of tokens. */
static size_t end_of_statement(const struct tokens *t, size_t i)
{
    while (i < t->count && !token_is(t, i, ";")) {
        if (token_is(t, i, "}")) /* of an initializer */
            return t->count;
        i = token_among(t, i, "( [ {") ? t->token[i].mate + 1 : i + 1;
    }
    return i;
}

/* True if a statement begins at token i: after ; { } else do, or the parentheses of if, for,
 * while. */
static bool begins_statement(const struct tokens *t, size_t i)
{
    if (i == 0 || t->token[i].braces == 0 || t->token[i].parens > 0)
        return false;
    if (token_among(t, i - 1, "; { } else do"))
        return true;
    if (token_is(t, i - 1, ":"))
        return (i > 1 && token_is(t, i - 2, "default")) || (i > 2 && token_is(t, i - 3, "case"));
    return token_is(t, i - 1, ")") && t->token[i - 1].mate > 0 &&
           token_among(t, t->token[i - 1].mate - 1, "if for while");
}

/* The value of a return: token `first` to token `last`. */
static void returns(const struct tokens *t, size_t i, size_t first, size_t last,
                    struct mutations *out)
{
    const struct span value = span_of(t, first, last);
    const char *single = first < last                       ? NULL
                         : token_is(t, first, "false")      ? "true"
                         : token_is(t, first, "true")       ? "false"
                         : token_is(t, first, "0")          ? "1"
                         : token_is(t, first, "NULL")       ? "(void *)1"
                         : token_is(t, first, "STATUS_OK")  ? "STATUS_MEMORY"
                         : token_is(t, first, "EXIT_AGREE") ? "EXIT_MISMATCH"
                                                            : NULL;
    add(out, t, "return", i, value, single ? single : "0");
}

static void statements(const struct tokens *t, size_t i, struct mutations *out)
{
    if (!begins_statement(t, i) || declares(t, i))
        return;
    size_t end = end_of_statement(t, i);
    if (end >= t->count || end == i || token_is(t, i, "{"))
        return;
    bool leaves = token_among(t, i, "break continue return goto");
    if (token_is(t, i, "return") && end > i + 1)
        returns(t, i, i + 1, end - 1, out);
    else if (leaves || !token_among(t, i, KEYWORDS))
        add(out, t, "statement", i, span_of(t, i, end - 1), "");
}

/* --- calls
 * ---------------------------------------------------------------------------------------- */

/* Argument that begins at token i, before token `close`: the comma behind it, or `close`. */
static size_t end_of_argument(const struct tokens *t, size_t i, size_t close)
{
    while (i < close && !token_is(t, i, ","))
        i = token_among(t, i, "( [ {") ? t->token[i].mate + 1 : i + 1;
    return i;
}

static void arguments(const struct tokens *t, size_t open, struct mutations *out)
{
    size_t close = t->token[open].mate, first = open + 1;
    size_t comma = end_of_argument(t, first, close);
    while (comma < close && comma > first) {
        size_t end = end_of_argument(t, comma + 1, close);
        if (end == comma + 1)
            return;
        const struct span a = span_of(t, first, comma - 1), b = span_of(t, comma + 1, end - 1);
        if (a.bytes != b.bytes || memcmp(a.text, b.text, a.bytes) != 0)
            ADD(out, t, "arguments", open, span_of(t, first, end - 1), "%.*s, %.*s", SPAN(b),
                SPAN(a));
        first = comma + 1;
        comma = end;
    }
}

/* Token i is a name and the next opens the arguments of its call. */
static void calls(const struct tokens *t, size_t i, struct mutations *out)
{
    size_t open = i + 1;
    if (t->token[i].kind != TOKEN_WORD || !token_is(t, open, "(") || t->token[i].braces == 0 ||
        token_among(t, i, KEYWORDS " " TYPES))
        return;
    arguments(t, open, out);
    size_t close = t->token[open].mate;
    bool used = i > 0 && (token_is(t, i - 1, "=") ||
                          (token_is(t, i - 1, "(") && i > 1 && token_among(t, i - 2, "if while")));
    if (used && token_among(t, close + 1, "; ) ,")) {
        const struct span call = span_of(t, i, close);
        ADD(out, t, "ignored", i, call, "(%.*s, 0)", SPAN(call));
    }
}

static void indices(const struct tokens *t, size_t i, struct mutations *out)
{
    if (!token_is(t, i, "[") || t->token[i].mate == i + 1 || t->token[i].braces == 0 ||
        is_size_of(t, i))
        return;
    const struct span inside = span_of(t, i + 1, t->token[i].mate - 1);
    ADD(out, t, "index", i, inside, "(%.*s) + 1", SPAN(inside));
}

void mutations_of(const struct tokens *tokens, struct mutations *out)
{
    *out = (struct mutations){0};
    for (size_t i = 0; i < tokens->count; i++) {
        if (tokens->token[i].braces == 0)
            continue;
        if (tokens->token[i].kind == TOKEN_SIGN)
            operators(tokens, i, out);
        if (tokens->token[i].kind == TOKEN_NUMBER)
            constants(tokens, i, out);
        statements(tokens, i, out);
        calls(tokens, i, out);
        indices(tokens, i, out);
    }
}

void mutations_free(struct mutations *mutations)
{
    for (size_t i = 0; i < mutations->count; i++)
        free(mutations->mutation[i].text);
    free(mutations->mutation);
    *mutations = (struct mutations){0};
}
