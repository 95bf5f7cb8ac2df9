/* The signature of a finding: engine, layout, kind and cause. Findings of one signature are one
 * bug. */
#ifndef FUZZ_SIGNATURE_H
#define FUZZ_SIGNATURE_H

#include "ref/explain/repair.h"
#include "ref/judge/judge.h"
#include "ref/layout.h"

/* What kind. The judge's kinds come first, with their names. */
enum fuzz_kind {
    FUZZ_KIND_WRONG,                                /* + enum wrong */
    FUZZ_KIND_BITS = FUZZ_KIND_WRONG + WRONG_COUNT, /* not engine cpu's bits on the same tree */
    FUZZ_KIND_UNFINISHED, /* stack, visits, loop cap: the engine said so */
    FUZZ_KIND_REFUSED,    /* the engine refused valid input (never a layout's documented
                             limit), or the program that a layout reproduces ends on the tree */
    FUZZ_KIND_TREE,       /* the packed bytes are no such tree: packed_check */
    FUZZ_KIND_CRASH,
    FUZZ_KIND_HANG,
    FUZZ_KIND_PROTOCOL, /* a pipe peer's answer was late, short or nonsense */
    FUZZ_KIND_COUNT
};

static inline enum fuzz_kind fuzz_kind_of_wrong(enum wrong wrong)
{
    return (enum fuzz_kind)((int)FUZZ_KIND_WRONG + (int)wrong);
}

struct fuzz_signature {
    char engine[96]; /* its name; of a shared object its file; of a pipe "pipe:" and its command,
                        words without their folders; letters, digits and _-+:. only, no point in
                        front: it names a folder */
    const struct layout *layout; /* NULL: none */
    enum fuzz_kind kind;
    enum cause cause;
};

/* "missed", "bits", "crash", ... */
const char *fuzz_kind_name(enum fuzz_kind kind);
/* Returns false if no kind has that name. */
bool fuzz_kind_find(const char *name, enum fuzz_kind *out);

/* Sets the engine from its name, what a signature cannot hold as '_', as much as fits; of
 * "pipe:COMMAND" the last part of each word's path, parted by '_': "pipe:tracer",
 * "pipe:python3_a.py". */
void fuzz_signature_set_engine(struct fuzz_signature *signature, const char *name);

/* Whether a signature holds all of an engine's name, so that no other has the same signature. */
bool fuzz_signature_holds(const char *name);

/* The engine of engines[] that the signature names, or NULL. */
const struct engine *fuzz_signature_engine(const struct fuzz_signature *signature);

#define FUZZ_SIGNATURE_MOST 160

/* "vulkan.rf16.missed.rounded_inward": unique. */
void fuzz_signature_print(const struct fuzz_signature *signature, char text[FUZZ_SIGNATURE_MOST]);
/* The name of its folder: the same with '=' for ':', which stores of files refuse. */
void fuzz_signature_folder(const struct fuzz_signature *signature, char text[FUZZ_SIGNATURE_MOST]);
/* The inverse; older folders, with ':', are read too. Errors: as fuzz_signature_parse. */
enum status fuzz_signature_of_folder(const char *name, struct fuzz_signature *out,
                                     struct reason *reason) MUST_USE;
/* The inverse. Errors: STATUS_INPUT with the field that is wrong; *out is zero. */
enum status fuzz_signature_parse(const char *text, struct fuzz_signature *out,
                                 struct reason *reason) MUST_USE;
bool fuzz_signature_same(const struct fuzz_signature *a, const struct fuzz_signature *b);

#endif
