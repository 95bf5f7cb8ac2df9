/* Tokens of C and GLSL, as far as telling mutations apart needs them. */
#ifndef TOKEN_H
#define TOKEN_H

#include <stdbool.h>
#include <stddef.h>

enum token_kind { TOKEN_WORD, TOKEN_NUMBER, TOKEN_TEXT, TOKEN_SIGN };

struct token {
    enum token_kind kind;
    size_t at, length; /* bytes of the source */
    size_t line;       /* from 1 */
    size_t mate;     /* of ( [ { and ) ] }: the token that closes or opens it; else its own place */
    unsigned braces; /* open { before it */
    unsigned parens; /* open ( and [ before it, since the last { */
};

/* Owns its arrays. */
struct tokens {
    char *source; /* ends in 0 */
    size_t bytes;
    struct token *token;
    size_t count;
};

/* Reads a file and takes it apart; comments and preprocessor lines are no tokens. False, with a
 * line on stderr: it cannot be read, there is no memory, or brackets do not match. */
bool tokens_read(const char *path, struct tokens *out);
void tokens_free(struct tokens *tokens);

/* True if token i exists and is `text`. */
bool token_is(const struct tokens *tokens, size_t i, const char *text);

/* True if it is one of the words of `list`, blanks between. */
bool token_among(const struct tokens *tokens, size_t i, const char *list);

#endif
