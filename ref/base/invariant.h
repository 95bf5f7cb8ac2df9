/* What the code itself guarantees: a breach is a bug of raydiff, never of its input. */
#ifndef REF_BASE_INVARIANT_H
#define REF_BASE_INVARIANT_H

/* In the rooms of the shared library it stands where assert does elsewhere, since these are
 * compiled once for both. */
#define invariant(truth) ((truth) ? (void)0 : invariant_broken(#truth, __FILE__, __LINE__))

/* Ends a program by SIGABRT, with a line on standard error. The shared library must not end its
 * user's program: there library_goes_on takes its place (ref/library/library.mk). */
void invariant_broken(const char *truth, const char *file, int line);

#endif
