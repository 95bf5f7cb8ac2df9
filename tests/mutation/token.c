#include "tests/mutation/token.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NESTED_MOST 256

static char *read_all(const char *path, size_t *bytes)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    if (size >= 0 && fseek(file, 0, SEEK_SET) == 0)
        text = malloc((size_t)size + 1);
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
        free(text);
        text = NULL;
    }
    if (file)
        fclose(file);
    if (text)
        text[size] = '\0';
    else
        fprintf(stderr, "mutate: %s: cannot be read\n", path);
    *bytes = text ? (size_t)size : 0;
    return text;
}

/* What is no token: blanks, comments, and lines that begin with '#'. */
static const char *skip(const char *p, const char *start)
{
    for (;;) {
        const char *before = p;
        while (isspace((unsigned char)*p))
            p++;
        if (p[0] == '/' && p[1] == '*') {
            const char *end = strstr(p + 2, "*/");
            p = end ? end + 2 : p + strlen(p);
        } else if (p[0] == '/' && p[1] == '/') {
            p += strcspn(p, "\n");
        } else if (*p == '#' &&
                   (p == start || memchr(before, '\n', (size_t)(p - before)) || before == start)) {
            while (*p && *p != '\n')
                p += p[0] == '\\' && p[1] == '\n' ? 2 : 1;
        }
        if (p == before)
            return p;
    }
}

static size_t number_length(const char *p)
{
    size_t n = 0;
    while (isalnum((unsigned char)p[n]) || p[n] == '.' || p[n] == '_' ||
           ((p[n] == '+' || p[n] == '-') && n > 0 &&
            (strchr("pP", p[n - 1]) || (strchr("eE", p[n - 1]) && strncmp(p, "0x", 2) != 0))))
        n++;
    return n;
}

static size_t text_length(const char *p)
{
    size_t n = 1;
    while (p[n] && p[n] != p[0])
        n += p[n] == '\\' && p[n + 1] ? 2 : 1;
    return p[n] ? n + 1 : n;
}

static size_t sign_length(const char *p)
{
    static const char *const sign[] = {"<<=", ">>=", "...", "->", "++", "--", "<<", ">>",
                                       "<=",  ">=",  "==",  "!=", "&&", "||", "+=", "-=",
                                       "*=",  "/=",  "%=",  "&=", "|=", "^=", "##"};
    for (size_t i = 0; i < sizeof sign / sizeof *sign; i++)
        if (strncmp(p, sign[i], strlen(sign[i])) == 0)
            return strlen(sign[i]);
    return 1;
}

static struct token next(const char *p)
{
    struct token token = {.kind = TOKEN_SIGN};
    if (isalpha((unsigned char)*p) || *p == '_') {
        token.kind = TOKEN_WORD;
        while (isalnum((unsigned char)p[token.length]) || p[token.length] == '_')
            token.length++;
    } else if (isdigit((unsigned char)*p) || (*p == '.' && isdigit((unsigned char)p[1]))) {
        token.kind = TOKEN_NUMBER;
        token.length = number_length(p);
    } else if (*p == '"' || *p == '\'') {
        token.kind = TOKEN_TEXT;
        token.length = text_length(p);
    } else {
        token.length = sign_length(p);
    }
    return token;
}

static bool add(struct tokens *out, size_t *room, struct token token)
{
    if (out->count == *room) {
        *room = *room ? 2 * *room : 1024;
        void *more = realloc(out->token, *room * sizeof *out->token);
        if (!more)
            return false;
        out->token = more;
    }
    token.mate = out->count;
    out->token[out->count++] = token;
    return true;
}

/* Pairs brackets and counts depths. */
static bool pair(struct tokens *out)
{
    size_t open[NESTED_MOST], depth = 0;
    unsigned parens[NESTED_MOST], braces = 0, inside = 0;
    for (size_t i = 0; i < out->count; i++) {
        struct token *token = &out->token[i];
        char c = token->kind == TOKEN_SIGN && token->length == 1 ? out->source[token->at] : ' ';
        bool opens = strchr("([{", c), closes = strchr(")]}", c);
        if ((closes && depth == 0) || (opens && depth == NESTED_MOST))
            return false;
        if (closes) {
            size_t mate = open[--depth];
            token->mate = mate;
            out->token[mate].mate = i;
            braces = out->token[mate].braces;
            inside = parens[depth];
        }
        token->braces = braces;
        token->parens = inside;
        if (opens) {
            parens[depth] = inside;
            open[depth++] = i;
            braces += c == '{';
            inside = c == '{' ? 0 : inside + 1;
        }
    }
    return depth == 0;
}

bool tokens_read(const char *path, struct tokens *out)
{
    size_t room = 0, line = 1;
    *out = (struct tokens){0};
    out->source = read_all(path, &out->bytes);
    if (!out->source)
        return false;
    bool fine = true;
    const char *p = skip(out->source, out->source), *counted = out->source;
    while (*p && fine) {
        struct token token = next(p);
        for (; counted < p; counted++)
            line += *counted == '\n';
        token.at = (size_t)(p - out->source);
        token.line = line;
        fine = add(out, &room, token);
        p = skip(p + token.length, out->source);
    }
    if (!fine || !pair(out)) {
        fprintf(stderr, "mutate: %s: %s\n", path, fine ? "brackets do not match" : "no memory");
        tokens_free(out);
        return false;
    }
    return true;
}

void tokens_free(struct tokens *tokens)
{
    free(tokens->source);
    free(tokens->token);
    *tokens = (struct tokens){0};
}

bool token_is(const struct tokens *tokens, size_t i, const char *text)
{
    return i < tokens->count && tokens->token[i].length == strlen(text) &&
           memcmp(tokens->source + tokens->token[i].at, text, strlen(text)) == 0;
}

bool token_among(const struct tokens *tokens, size_t i, const char *list)
{
    while (*list && i < tokens->count) {
        size_t length = strcspn(list, " ");
        if (tokens->token[i].length == length &&
            memcmp(tokens->source + tokens->token[i].at, list, length) == 0)
            return true;
        list += length + (list[length] == ' ');
    }
    return false;
}
