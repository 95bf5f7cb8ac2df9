/* Checks whether a run uses the options that it was given. Unused options are rejected before
 * anything runs, since an option without effect is a misunderstanding. For commands only.
 *   struct option_use use = {.engine = &list, ...};
 *   if (options_check(&use, &reason)) return usage_error(command, "%s", reason.text); */
#ifndef CMD_USE_H
#define CMD_USE_H

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"

/* What takes part in a run, as far as options depend on it. If a list is NULL, options that depend
 * on it count as used. */
struct option_use {
    const char *by;    /* what `only` and `never` belong to: "benchmark builders" */
    const char *only;  /* names of the options that are used, separated by blanks; NULL: all */
    const char *never; /* names of options that are not used; NULL: none */
    const struct list *engine, *layout, *builder, *store, *rays;
    char *const *scene; /* as users name them, for options of generators; NULL: unknown */
    size_t scene_count;
    bool unnamed;  /* no option named these engines: they are all that there are */
    bool seeded;   /* more than rays and scenes depends on --seed */
    bool compares; /* shaders of layouts are compiled, whichever engine runs */
};

/* True if `name` is in `names`, which are separated by blanks. */
bool option_among(const char *names, const char *name);

/* True if the option (without dashes) is used. Else *why names what it needs. */
bool option_is_used(const struct option_use *use, const char *option, struct reason *why);

/* Checks all options of the last options_read. Errors: STATUS_INPUT with the first that is not
 * used, and why. */
enum status options_check(const struct option_use *use, struct reason *reason) MUST_USE;

/* The same, but prints the reason. Returns -1 to continue, else EXIT_USAGE. */
int options_refused(const char *command, const struct option_use *use);

/* True if the engine is a child process (pipe:COMMAND, FILE.so). It exists only if it is named. */
bool engine_is_peer(const struct engine *engine);

#endif
