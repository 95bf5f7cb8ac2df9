/* The mutations of a source:
 *   mutate list FILE            a line each: NUMBER LINE KIND OLD => NEW
 *   mutate apply FILE NUMBER    the source with one of them, on stdout
 * Exit codes: 0; 2: bad arguments, or the file cannot be read. */
#include "tests/mutation/mutation.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Text on one line, blanks as one. */
static void print_flat(const char *text, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        if (!strchr(" \t\n", text[i]))
            putchar(text[i]);
        else if (i > 0 && !strchr(" \t\n", text[i - 1]))
            putchar(' ');
}

static void list(const struct tokens *tokens, const struct mutations *all)
{
    for (size_t i = 0; i < all->count; i++) {
        const struct mutation *m = &all->mutation[i];
        printf("%zu %zu %s ", i, m->line, m->kind);
        print_flat(tokens->source + m->at, m->bytes);
        fputs(" => ", stdout);
        print_flat(m->text, strlen(m->text));
        putchar('\n');
    }
}

static void apply(const struct tokens *tokens, const struct mutation *m)
{
    fwrite(tokens->source, 1, m->at, stdout);
    fputs(m->text, stdout);
    size_t rest = m->at + m->bytes;
    fwrite(tokens->source + rest, 1, tokens->bytes - rest, stdout);
}

int main(int argc, char **argv)
{
    bool lists = argc == 3 && strcmp(argv[1], "list") == 0;
    bool applies = argc == 4 && strcmp(argv[1], "apply") == 0;
    struct tokens tokens;
    struct mutations all;
    if (!lists && !applies) {
        fputs("usage: mutate list FILE | mutate apply FILE NUMBER\n", stderr);
        return 2;
    }
    if (!tokens_read(argv[2], &tokens))
        return 2;
    mutations_of(&tokens, &all);
    size_t number = applies ? strtoul(argv[3], NULL, 10) : 0;
    bool fine = !all.failed && (lists || number < all.count);
    if (fine && lists)
        list(&tokens, &all);
    else if (fine)
        apply(&tokens, &all.mutation[number]);
    else
        fprintf(stderr, "mutate: %s: no mutation %zu of %zu\n", argv[2], number, all.count);
    mutations_free(&all);
    tokens_free(&tokens);
    return fine && fflush(stdout) == 0 ? 0 : 2;
}
