/* What world JSON and the extras of glTF have in common: the numbers and words of an instance, and
 * the filter. Each is left out where it has its default. */
#ifndef WORLD_FIELDS_H
#define WORLD_FIELDS_H

#include "ref/world/world.h"
#include "scenes/read/json_pull.h"

#include <stdio.h>

/* The identity, mask 0xFF, custom index 0, no flags, no mesh: what an instance has if its file does
 * not tell otherwise. */
struct instance instance_default(void);

/* Members of an instance (`self` is a struct instance): a custom index, a mask, and flags as an
 * array of words, each once: "cull_disable", "flip_facing", "force_opaque", "force_no_opaque". */
json_take_fn take_custom, take_mask, take_flags;
#define INSTANCE_MEMBERS                                                                           \
    {"custom", take_custom, false}, {"mask", take_mask, false},                                    \
    {                                                                                              \
        "flags", take_flags, false                                                                 \
    }

/* A filter (`self` is a struct filter_rule): an object with "kind" (all, none, triangles, cells),
 * "seed" and "share". */
json_take_fn take_filter;

/* Writes the members of an instance that do not have their default, as `, "mask": 1`; the first has
 * no comma if `first`. Returns whether there is one. */
bool put_instance_members(const struct instance *instance, bool first, FILE *stream);

/* True unless the rule is all zero, which files leave out. */
bool filter_is_told(const struct filter_rule *filter);

/* Writes the filter as an object. */
void put_filter(const struct filter_rule *filter, FILE *stream);

#endif
