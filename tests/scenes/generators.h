/* What the tests of scene generators share. */
#ifndef TESTS_GENERATORS_H
#define TESTS_GENERATORS_H

#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

/* A parameter that differs from its default; ends at the first without a name. */
struct setting {
    const char *name;
    double value;
};

static inline enum status try_make(const char *name, const struct setting *setting, uint64_t seed,
                                   struct scene *out, struct reason *reason)
{
    const struct generator *generator = generator_find(name);
    double value[GENERATOR_PARAMS] = {0};
    assert_non_null(generator);
    for (int k = 0; k < GENERATOR_PARAMS && generator->param[k].name; k++)
        value[k] = generator->param[k].value;
    for (; setting && setting->name; setting++) {
        int k = 0;
        while (strcmp(generator->param[k].name, setting->name) != 0)
            assert_non_null(generator->param[++k].name);
        value[k] = setting->value;
    }
    return generator_make(generator, value, seed, out, reason);
}

#define SETTINGS(...) ((const struct setting[]){__VA_ARGS__, {NULL, 0}})

static inline struct scene make(const char *name, const struct setting *setting, uint64_t seed)
{
    struct scene scene;
    struct reason reason = {""};
    if (try_make(name, setting, seed, &scene, &reason))
        fail_msg("%s", reason.text);
    if (scene_check(&scene, &reason))
        fail_msg("%s: %s", name, reason.text);
    return scene;
}

#endif
