/* Embree 3 or 4: the engine functions (ref/engine.h) that all its modes share. Without Embree
 * (embree_none.c) opening fails with STATUS_UNSUPPORTED. */
#ifndef EMBREE_DEVICE_H
#define EMBREE_DEVICE_H

#include "ref/engine.h"

/* Which of its code for processors Embree runs. */
enum embree_isa {
    EMBREE_ISA_OWN, /* whichever it chooses */
    EMBREE_ISA_SSE2,
    EMBREE_ISA_SSE42,
    EMBREE_ISA_AVX,
    EMBREE_ISA_AVX2,
    EMBREE_ISA_AVX512,
    EMBREE_ISAS
};

enum embree_quality { EMBREE_MEDIUM, EMBREE_LOW, EMBREE_HIGH, EMBREE_QUALITIES };

/* A mode of Embree; all 0 is its default. */
struct embree_mode {
    enum embree_isa isa;
    unsigned packet;             /* 0: single rays; else 4, 8 or 16 at once */
    enum embree_quality quality; /* RTC_BUILD_QUALITY_* */
    bool robust, compact;        /* RTC_SCENE_FLAG_* */
    bool dynamic, refit;         /* RTC_SCENE_FLAG_DYNAMIC; and RTC_BUILD_QUALITY_REFIT of meshes,
                                    which Embree heeds only in dynamic scenes */
};

#define EMBREE_PACKET_MOST 16u

/* As engine.open. options->compact is as mode->compact. Errors: STATUS_UNSUPPORTED no library
 * (embree_load), no device for this processor, or one of another ISA than that asked for
 * (embree_isa_check); STATUS_MEMORY. */
enum status embree_open_mode(const struct engine_options *options, const struct embree_mode *mode,
                             void **self, struct reason *reason) MUST_USE;

/* Asks a device made for that ISA which one it runs: of those that Embree was compiled with the
 * best that the device is told of. Embree has no call for that, but says it where it is verbose, to
 * the standard output: so a process is forked for the first question. EMBREE_ISA_OWN is always
 * right. Errors: STATUS_UNSUPPORTED no library, no such device for this processor, or Embree runs
 * another one in its place (the reason names it); STATUS_DEVICE it could not be asked. */
enum status embree_isa_check(enum embree_isa isa, struct reason *reason) MUST_USE;

enum status embree_prepare(void *self, const struct job *job, struct reason *reason) MUST_USE;
/* As engine.move: new vertices in the buffer that Embree has, and the scene committed again. Embree
 * builds it anew, or refits it where the mode has that. */
enum status embree_move(void *self, const struct job *job, struct reason *reason) MUST_USE;
enum status embree_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason) MUST_USE;
enum status embree_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason) MUST_USE;
void embree_close(void *self);

/* Worlds, for modes of single rays. Embree has no custom indices: those of the tags
 * come from the world. What QUERY_ANY and ABI_RAY_FIRST find is not named: triangle 0 at t = 0 with
 * tag 0. A ray that Embree may abort on in the space of some meshes does not meet their instances;
 * where the library was built without masks of rays, it meets nothing. prepare_world returns also
 * STATUS_UNSUPPORTED, unless `unguarded`: Embree may abort on every ray through a transform (the
 * instance); the quality is low, whose builder asserts that boxes have an extent. */
extern const struct world_tracer embree_worlds;

void embree_describe(const struct engine *engine, const struct engine_options *options, char *text,
                     size_t text_bytes);

#endif
