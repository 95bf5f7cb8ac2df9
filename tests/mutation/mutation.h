/* Mutations of a C or GLSL source: small changes of its code, each of which a test should
 * notice. */
#ifndef MUTATION_H
#define MUTATION_H

#include "tests/mutation/token.h"

/* A change: `bytes` bytes at `at` become `text`. */
struct mutation {
    const char *kind;
    size_t line;
    size_t at, bytes;
    char *text;
};

/* Owns its arrays. */
struct mutations {
    struct mutation *mutation;
    size_t count, room;
    bool failed; /* no memory */
};

/* All mutations of a source, in the order of their places:
 *   border     < and <=, > and >=              compare   < and >=, > and <=, == and !=
 *   arithmetic + and -, * and /, % and *, ++ and --, also of assignments
 *   logic      && and ||, ! dropped            bits      << and >>, & and |, ^, ~ dropped
 *   constant   an integer one more and one less; a float doubled
 *   statement  an assignment, a call, a break, continue or return dropped
 *   arguments  two neighbours of a call exchanged
 *   return     0 in place of the value; of 0, false and true the other
 *   index      one more                        sign      a minus dropped
 *   ignored    0 in place of what a call returned
 * The size of a declared array does not grow. Some do not compile, and some change nothing: that is
 * for the compiler to tell. */
void mutations_of(const struct tokens *tokens, struct mutations *out);
void mutations_free(struct mutations *mutations);

#endif
