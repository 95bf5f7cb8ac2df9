/* What the files of the exporter share. */
#ifndef FUZZ_EXPORT_INNER_H
#define FUZZ_EXPORT_INNER_H

#include "fuzz/export/export.h"
#include "fuzz/export/export_rights.h"
#include "gpu/trace/dispatch.h"
#include "ref/judge/judge_world.h"

/* The engine that a finding is exported for. */
enum export_subject {
    SUBJECT_VULKAN, /* a layout's tracing shader */
    SUBJECT_BRUTE,  /* the shader that tests every triangle */
    SUBJECT_QUERY,  /* the driver's ray queries */
    SUBJECT_EMBREE,
    SUBJECT_EMBREE_ROBUST,
    SUBJECT_TRACER, /* another tracer, which reads text */
};

/* Everything that a form writes; owns its arrays (export_case_free). */
struct export_case {
    const struct finding_file *file;
    const struct export_options *options;
    struct reason *reason; /* of what fails while the case is made */
    const struct fuzz_trial *trial;
    enum export_subject subject;
    const struct engine *engine;     /* NULL: SUBJECT_TRACER */
    const struct layout *layout;     /* SUBJECT_VULKAN, else NULL */
    char title[FUZZ_SIGNATURE_MOST]; /* the signature, or "clean" */
    bool bits_matter;                /* the finding is that C's bits were not met */
    struct trial_meshes meshes;      /* of a world */
    const struct world *world;       /* NULL: of a scene */
    struct ray *ray;                 /* those that are exported */
    struct ray_mode *mode;           /* of a world, else NULL */
    uint32_t *number;                /* their indices in the file */
    uint32_t ray_count, left_out;    /* left out: Embree does not promise to survive them */
    struct bvh bvh;
    struct packed packed;
    struct job job;
    struct dispatch dispatch; /* of the Vulkan subjects */
    struct model model;
    bool measured; /* the model is the engine's own, else what its specification allows */
    struct oracle *oracle;
    struct oracle_answer *truth;
    struct export_right *right;
    size_t right_count, right_capacity;
    struct hit *reference;       /* of C on the same bytes; SUBJECT_VULKAN and _BRUTE, else NULL */
    bool reference_fails;        /* it is not right either, or did not finish */
    struct hit *here;            /* what the engine answered here; NULL: it was not run */
    struct judgement *judgement; /* of that */
    char not_asked[200];         /* why it was not run */
    char versions[1024];         /* of what was run, lines */
};

enum status export_case_make(const struct finding_file *file, const struct export_options *options,
                             struct export_case *out, struct reason *reason) MUST_USE;
void export_case_free(struct export_case *the);

/* Triangles of the scene, or placed ones of the world. */
uint32_t export_tri_count(const struct export_case *the);

/* Vertices of one, in a world rounded to float32. */
void export_tri(const struct export_case *the, uint32_t prim, float v[3][3]);

/* Writes "triangle 3", in a world "instance 0, geometry 1, triangle 2". */
#define EXPORT_PLACE_MOST 80
void export_place(const struct export_case *the, uint32_t prim, char text[EXPORT_PLACE_MOST]);

/* True if it runs on Vulkan. */
bool export_is_vulkan(const struct export_case *the);

/* Finds all right answers to the rays: the judge is given every triangle, and a miss, and the
 * intervals of those that it allows are widened as far as it allows. A ray without one is out of
 * contract (export_what_any). Errors: STATUS_MEMORY. */
enum status export_find_right(struct export_case *the, const struct judge *judge) MUST_USE;

/* True if one of the right answers to ray `i` is this one (if export_is_followed: as far as its
 * triangle and t tell). */
bool export_is_right(const struct export_case *the, uint32_t i, const struct hit *hit);

/* The comment that heads every form: each line begins with `begin`. */
void export_comment(const struct export_case *the, const char *begin, FILE *to);

/* True if what the engine answered here to ray `i` is wrong, or has other bits than C's where those
 * are the finding. There is an answer. */
bool export_is_wrong_here(const struct export_case *the, uint32_t i);

/* Writes a comment line, "# ray 0, right: triangle 3, t in [1.5, 1.5000001]", "... a miss", "... a
 * hit". */
void export_print_right(const struct export_case *the, const struct export_right *right, FILE *to);

/* What is right of a ray that is out of contract: any answer, but in a world what the ray cannot
 * meet stays wrong (ref/judge/judge_world.h). */
const char *export_what_any(const struct export_case *the);

/* True if answers are a hit or a miss, without a triangle. */
bool export_is_unnamed(const struct export_case *the);

/* True if the formula is not known: then u and v must give the ray's point at t, to
 * JUDGE_DISPLACEMENT_MOST units, wherever in its interval t is. */
bool export_is_followed(const struct export_case *the);

void export_write_c(const struct export_case *the, FILE *to);
void export_write_amber(const struct export_case *the, FILE *to);

/* One of the storage buffers as the engine makes them: how many bytes, and what it begins with. */
struct export_buffer {
    const char *name;
    uint64_t bytes, data_bytes;
};

void export_buffers(const struct export_case *the, struct export_buffer out[DISPATCH_BINDINGS]);

#endif
