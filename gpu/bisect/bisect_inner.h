/* Shared by the files of gpu/bisect/bisect.h. */
#ifndef BISECT_INNER_H
#define BISECT_INNER_H

#include "gpu/bisect/bisect.h"

/* A module; owned. */
struct bisect_module {
    uint32_t *word;
    size_t count;
};

/* A module that was tried, and what it showed. */
struct bisect_tried {
    uint64_t hash;
    struct bisect_module module;
    enum delta_answer answer;
};

struct bisect_search {
    const struct bisect_job *job;
    struct bisect *out;
    struct bisect_module begun; /* the shader as the first pass has it */
    struct bisect_tried *tried;
    size_t tried_count, tried_capacity;
    const char *what;   /* for job->step */
    enum status status; /* of what stopped the search */
    struct reason *reason;
};

/* Stops the search with a reason. Returns DELTA_STOP. */
enum delta_answer bisect_stop(struct bisect_search *search, enum status status,
                              const struct reason *reason);

/* Whether a module, before decorations that come last, shows the symptom: these are put on it, it
 * is validated, looked at or played. Takes the module, which is freed; keeps the answer.
 * DELTA_UNRESOLVED: not valid. */
enum delta_answer bisect_ask(struct bisect_search *search, struct bisect_module module);

/* The module that the passes make that are `in`; NULL: none of them. Errors: as compiler_list. */
enum status bisect_make(const struct bisect_search *search, const bool *in,
                        struct bisect_module *out, struct reason *reason);

/* Finds the list of passes, and the change that the last of them makes. Errors: in
 * search->status. */
void bisect_passes(struct bisect_search *search);
void bisect_change(struct bisect_search *search);

/* Finds the decorations that the module lacks and that cure it; takes the module. */
void bisect_decorations(struct bisect_search *search, struct bisect_module module);

/* Adds a line to out->line, if there is room. A blank sign: the instruction is what others are
 * about. */
void bisect_put_line(struct bisect *out, char sign, const uint32_t *word);

/* Says the change of such edits of a diff: function, what and lines. */
void bisect_say(const struct spirv_diff *diff, const bool *done, struct bisect *out);

#endif
