/* Shared by the files of raydiff bisect. Commands only. */
#ifndef CMD_BISECT_H
#define CMD_BISECT_H

#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_screen.h"
#include "fuzz/findings/finding_file.h"
#include "gpu/bisect/bisect.h"
#include "ref/match/match.h"
#include "scenes/rays/rays.h"

struct bisect_options {
    const char *bad, *good; /* compilers; NULL: not named */
    size_t symptom;         /* 0: the first that shows; else 1 + enum symptom */
    const struct engine *engine;
    const struct layout *layout;
    const struct tri_store *store;
    const struct builder *builder;
    struct build_options build;
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query;
    const struct ray_set *rays;
    uint64_t count, seed;
    uint32_t seconds, tries;
    const char *json;
    struct engine_options engines;
    struct screen_options screen;
};

/* What is bisected. Owns scenes, world and rays. */
struct bisect_subject {
    const char *text;
    struct finding_file file; /* if a finding's file is bisected */
    struct scene scene, rest; /* rest: its vertices before it moved */
    bool moved;
    struct trial_meshes meshes; /* of a finding's world */
    struct world world;
    const struct world *is_world; /* one of the two, or NULL */
    struct ray *ray;
    struct ray_mode *mode; /* of a world */
    size_t ray_count;
    struct compiler bad, good;
    char bad_name[COMPILER_NAME_MOST + 32], good_name[COMPILER_NAME_MOST + 32];
};

/* Reads the subject: a scene or world, the name of a trial of raydiff conform, or a finding's file.
 * Names and files decide members, and may bring the compiler. The caller frees it with
 * bisect_subject_free, after an error, too. Errors: STATUS_INPUT; those of compiled_make,
 * finding_file_read, scene_open. */
enum status bisect_subject_open(struct bisect_options *options, const char *text,
                                struct bisect_subject *out, struct reason *reason) MUST_USE;
void bisect_subject_free(struct bisect_subject *subject);

/* --- answers ---------------------------------------------------------------------------------- */

/* Answers to all rays. Owns its arrays. */
struct bisect_answers {
    struct hit *hit;
    uint32_t *tag;  /* of a world */
    uint8_t *wrong; /* of each ray: the judge calls the answer WRONG */
    size_t wrong_count;
    uint64_t ns; /* what all of it took */
};
void answers_free(struct bisect_answers *answers);

/* Plays modules in child processes, one of which has the engine open until it fails. */
struct bisect_stage {
    const struct bisect_options *options;
    const struct bisect_subject *subject;
    struct match match; /* trees and truth */
    struct pool pool;   /* no engine is opened in this process */
    bool promised;      /* see struct play */
    struct child *child;
    size_t played;    /* by this child */
    uint64_t slowest; /* of the plays that count, in ns */
    /* Of the last play: the shader that the engine used, and its constants. */
    struct vk_shader shader;
    uint32_t constant[VK_CONSTANTS_MAX];
    size_t crashed, hung; /* modules that were only tried */
};

/* Builds, packs, and decides every ray exactly. Errors: those of match_make and match_pack. */
enum status bisect_stage_open(const struct bisect_options *options,
                              const struct bisect_subject *subject, struct bisect_stage *out,
                              struct reason *reason) MUST_USE;

/* Plays the engine with a module in place of its shader (NULL: as built). A module that is `tried`
 * may crash or hang: the time that others took decides how long it may take. Errors:
 * STATUS_UNSUPPORTED the engine cannot run here; STATUS_DEVICE it fails, crashes (the reason has
 * how) or hangs; STATUS_MEMORY. */
enum status bisect_stage_play(struct bisect_stage *stage, const uint32_t *word, size_t count,
                              bool tried, struct bisect_answers *out,
                              struct reason *reason) MUST_USE;

void bisect_stage_close(struct bisect_stage *stage);

/* --- the result ------------------------------------------------------------------------------- */

/* How much of it shows. */
struct bisect_shown {
    bool is; /* false: no symptom shows */
    enum symptom symptom;
    size_t count;  /* answers that are wrong or have other bits; else operations */
    size_t of;     /* rays, or float operations */
    size_t first;  /* ray */
    unsigned loss; /* SYMPTOM_PRECISE: one of enum bisect_loss, rounding that is open before a
                      decoration that is lost */
    uint32_t open; /* SYMPTOM_PRECISE: instructions of open rounding */
};

struct bisect_result {
    const struct bisect_options *options;
    const struct bisect_subject *subject;
    const char *shader;
    struct bisect_shown shown;
    struct bisect bisect;
    size_t crashed, hung;
    char tool[160]; /* of a translator: which step it is */
};

void bisect_print(const struct bisect_result *result, const struct screen *screen);

/* Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status bisect_write_json(const char *path, const struct bisect_result *result, int exit_code,
                              struct reason *reason) MUST_USE;

/* "wrong: 3 of 1000 answers are WRONG, that to ray 12 first" */
void shown_text(const struct bisect_shown *shown, char *text, size_t bytes);

#endif
