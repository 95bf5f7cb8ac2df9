/* OpenMP of one thread, for compilers without it: fuzzing is done by processes. */
#ifndef READER_OMP_H
#define READER_OMP_H

static inline int omp_get_max_threads(void)
{
    return 1;
}

#endif
