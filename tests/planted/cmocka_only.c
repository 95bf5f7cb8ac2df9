/* Preloaded into a CMocka program (tests/planted/play.sh): of its unit tests only those run whose
 * names match the environment's CMOCKA_ONLY, in which * and ? stand for any text and any letter. */
#define _DEFAULT_SOURCE
#include <stdlib.h>

void cmocka_set_test_filter(const char *pattern) __attribute__((weak));

__attribute__((constructor)) static void choose(void)
{
    const char *only = getenv("CMOCKA_ONLY");
    if (only && *only && cmocka_set_test_filter)
        cmocka_set_test_filter(only);
    /* Not for the programs that it starts. */
    unsetenv("LD_PRELOAD");
}
