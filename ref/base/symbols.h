/* Functions of a shared library that is opened while the program runs. */
#ifndef SYMBOLS_H
#define SYMBOLS_H

#include <stddef.h>

struct symbol {
    const char *name;
    size_t place; /* of the pointer to it, in bytes from the beginning of a struct of such */
};

/* Finds `count` functions of `library`, a handle of dlopen(), and writes pointers to them into
 * `to`. Returns NULL; or the name of the first that it lacks, and then `to` is not whole. */
const char *symbols_find(void *library, const struct symbol *symbols, size_t count, void *to);

#endif
