/* Whether a run uses the options that it was given. What it does not use is refused before anything
 * is played: an option without effect is a misunderstanding. For commands only.
 *   struct option_use use = {.engine = &list, ...};
 *   if (options_check(&use, &reason)) return usage_error(command, "%s", reason.text); */
#ifndef CMD_USE_H
#define CMD_USE_H

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"

/* What takes part in a run, as far as options depend on it. A list that is NULL is not known, or is
 * not what options depend on: then they are used. */
struct option_use {
    const char *by;    /* what `only` and `never` are of: "benchmark builders" */
    const char *only;  /* names of the options that are used, blanks between; NULL: all */
    const char *never; /* of those that are not; NULL: none */
    const struct list *engine, *layout, *builder, *store, *rays;
    char *const *scene; /* as users name them, for options of generators; NULL: not known */
    size_t scene_count;
    bool seeded;   /* more than rays and scenes depends on --seed */
    bool compares; /* shaders of layouts are compiled, whichever engine plays */
};

/* True if a name is among names with blanks between. */
bool option_among(const char *names, const char *name);

/* True if the option (without dashes) is used; else *why names what it needs. */
bool option_is_used(const struct option_use *use, const char *option, struct reason *why);

/* Looks at all options of the last options_read. Errors: STATUS_INPUT with the first that is not
 * used, and why. */
enum status options_check(const struct option_use *use, struct reason *reason) MUST_USE;

/* The same, which prints the reason: -1 to go on, else EXIT_USAGE. */
int options_refused(const char *command, const struct option_use *use);

/* True if the engine is a child process: naming it is what brings it. */
bool engine_is_peer(const struct engine *engine);

#endif
