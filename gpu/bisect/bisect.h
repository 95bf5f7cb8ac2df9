/* Why does a symptom show with the shaders that one compiler makes, and not with another's? Finds
 * the shortest list of the compiler's passes that brings it, and of what the last of these passes
 * does to the module the least part that brings it: instructions of one function, as a rule.
 *
 * Between the module before that pass and the one after stand modules with some of the edits. Most
 * are not valid, and a driver may crash on the others: the caller plays them where that does no
 * harm.
 *
 * A translator through another language cannot be taken apart so, since all of its ids are new:
 * there the least set of decorations is looked for that, put back, cures the symptom. */
#ifndef BISECT_H
#define BISECT_H

#include "gpu/bisect/delta.h"
#include "gpu/bisect/spirv_say.h"
#include "gpu/shaders/compiler.h"

enum symptom {
    SYMPTOM_WRONG,   /* answers that are WRONG under this compiler alone */
    SYMPTOM_BITS,    /* answers with other bits than the other compiler's */
    SYMPTOM_PRECISE, /* decorations that were asked for are lost, or rounding was opened */
    SYMPTOM_COUNT
};
extern const char *const symptom_names[SYMPTOM_COUNT + 1]; /* NULL-terminated */

/* What is to be found out. All pointers are borrowed. */
struct bisect_job {
    struct compiler compiler;
    struct vk_shader shader; /* as built, with the constants of the dispatch */
    enum symptom symptom;
    unsigned loss; /* SYMPTOM_PRECISE: that which shows, of enum bisect_loss */
    /* Whether the symptom shows in the answers of a valid module. Not for SYMPTOM_PRECISE. */
    enum delta_answer (*play)(void *user, const uint32_t *word, size_t count);
    /* Told before a module is tried: what of, and which number it has there; or NULL. */
    void (*step)(void *user, const char *what, size_t tries);
    void *user;
    size_t most; /* modules tried in each of the searches, at most */
};

/* What is known of a result of a search. */
enum bisect_proof {
    BISECT_SHORTEST, /* every shorter one was tried */
    BISECT_MINIMAL,  /* nothing of it can be left out */
    BISECT_ENDED     /* `most` was reached */
};

#define BISECT_LINES_MOST 12

/* Instructions that are removed (-) and added (+); between them those that decorations are of. */
struct bisect_line {
    char sign;
    char text[SPIRV_SAY_MOST];
};

enum bisect_end {
    BISECT_FOUND,    /* the change is known */
    BISECT_WHOLE,    /* the pass is; no smaller change than all of its is a valid module */
    BISECT_AS_BUILT, /* the shader as built shows it: no pass brings it */
    BISECT_UNLIKE,   /* opt and size: the passes for which they stand do not show it */
    BISECT_NO_CURE,  /* of a translator: decorations do not cure it */
};

struct bisect {
    enum bisect_end end;
    /* Passes of the compiler, and which of them bring the symptom; none of a translator. */
    char *text;
    const char **pass;
    bool *in;
    size_t pass_count, found_count;
    enum bisect_proof proof;
    size_t pass_tries;
    /* The change: all edits of the last pass (or decorations that lack) and those that bring it. */
    bool decorations;
    size_t edits, edit_count, edit_tries;
    bool least;                    /* none of edit_count can be left out; else `most` was reached */
    char function[SPIRV_SAY_MOST]; /* "": outside of functions */
    char what[2 * SPIRV_SAY_MOST]; /* "NoContraction of %12 (OpFMul) is gone" */
    struct bisect_line line[BISECT_LINES_MOST]; /* the first of edit_count */
    size_t line_count;
};

/* Looks for it; the compiler's module of the shader must show the symptom. *out is to be freed, on
 * an error, too. Errors: as compiler_run; STATUS_DEVICE `play` said DELTA_STOP: no reason. */
enum status bisect_run(const struct bisect_job *job, struct bisect *out,
                       struct reason *reason) MUST_USE;

void bisect_free(struct bisect *bisect);

/* What a module of the compiler lost: bits of the following. Of a translator, which may have no
 * word for a negation's decoration, negations are left out. Errors: as compiler_look. */
enum bisect_loss {
    LOSS_DECORATION = 1, /* one that was asked for */
    LOSS_OPEN = 2        /* an instruction of open rounding that the source lacks */
};
enum status bisect_loses(const struct compiler *compiler, const struct vk_shader *shader,
                         const uint32_t *word, size_t count, unsigned *loss,
                         struct reason *reason) MUST_USE;

#endif
