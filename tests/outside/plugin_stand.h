/* What a layout from outside is tried on, and how its lies are held against what is said of them.
 * Include after <cmocka.h>. */
#ifndef RAYDIFF_TESTS_PLUGIN_STAND_H
#define RAYDIFF_TESTS_PLUGIN_STAND_H

#include "ref/outside/plugin_layout.h"
#include "ref/packed/packed_check.h"
#include "scenes/scenes.h"

#include <string.h>

struct stand {
    struct scene scene;
    struct bvh bvh;
    const struct layout *layout;
};

/* What packed_make() says of a lie, and the rule that it breaks; says is NULL where it packs. */
struct lie_case {
    unsigned lie;
    const char *says;
    enum packed_rule rule;
};

/* A sphere in leaves of 4 and the layout of raydiff_plugin() under this name; 0 when it stands. */
static inline int stand_open(void **state, const char *name)
{
    static struct stand stand;
    struct reason reason;
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    *state = &stand;
    return scene_open("sphere:n=8", 1, &stand.scene, &reason) ||
           bvh_build(builder_find("median"), &stand.scene, &options, &stand.bvh, &reason) ||
           plugin_layout_add(name, raydiff_plugin(), &stand.layout, &reason);
}

static inline int stand_free(void **state)
{
    struct stand *stand = *state;
    bvh_free(&stand->bvh);
    scene_free(&stand->scene);
    return 0;
}

/* Sets *told to each case in turn, packs, and sets it back to `honest`. */
static inline void stand_hears(const struct stand *s, unsigned *told, unsigned honest,
                               const struct lie_case *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct packed packed;
        struct reason reason = {""};
        *told = cases[i].lie;
        enum status status = packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason);
        packed_free(&packed);
        *told = honest;
        if (status != (cases[i].says ? STATUS_INPUT : STATUS_OK) ||
            (cases[i].says && !strstr(reason.text, cases[i].says)))
            fail_msg("lie %u: %s: %s", cases[i].lie, status_text(status), reason.text);
        if (plugin_rule() != cases[i].rule)
            fail_msg("lie %u: rule %d", cases[i].lie, (int)plugin_rule());
    }
}

#endif
