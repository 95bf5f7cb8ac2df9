/* Shared by the files of the public library; see ref/library/raydiff.h. */
#ifndef LIBRARY_H
#define LIBRARY_H

#include "ref/base/float_mode.h"
#include "ref/library/raydiff.h"
#include "ref/oracle/oracle_world.h"

/* Owns all of it. */
struct raydiff_oracle {
    struct scene scene; /* or */
    struct world world;
    bool is_world;
    struct oracle *oracle;
};

static inline uint32_t library_triangles(const struct raydiff_oracle *oracle)
{
    return oracle->is_world ? world_tri_count(&oracle->world) : oracle->scene.tri_count;
}

/* Takes the place of invariant_broken in the shared object: does nothing. */
void library_goes_on(const char *truth, const char *file, int line);

/* Checks masks of rays (NULL is fine). Errors: STATUS_INPUT one is over 255, or there are some and
 * no world. */
enum status library_masks(const struct raydiff_oracle *oracle, const uint32_t *mask, size_t count,
                          struct reason *reason) MUST_USE;

/* What ray i may meet. */
static inline struct ray_mode library_mode(const uint32_t *mask, size_t i)
{
    return mask ? (struct ray_mode){.mask = mask[i]} : ray_mode_all();
}

/* Sets the floating-point modes of the calling thread that change results. */
static inline void library_modes(unsigned long modes)
{
    float_mode_set((float_mode() & ~(unsigned long)FLOAT_MODES) | (modes & FLOAT_MODES));
}

/* Begins a public function: IEEE arithmetic, whatever the program or a library has set. Returns the
 * modes as they were, for library_end. */
static inline unsigned long library_begin(void)
{
    const unsigned long modes = float_mode();
    library_modes(0);
    return modes;
}

/* Ends a public function: sets the modes of library_begin again, writes the line of `reason`, empty
 * if status is STATUS_OK, and returns the error of that status. */
enum raydiff_error library_end(unsigned long modes, enum status status, const struct reason *reason,
                               struct raydiff_why *why) MUST_USE;

/* Errors: STATUS_INPUT a pointer is NULL, "WHAT: is NULL". */
enum status library_given(const void *pointer, const char *what, struct reason *reason) MUST_USE;

/* Copies triangles. Errors: those of raydiff_oracle_make, but for UNSUPPORTED; *out is then
 * zero. */
enum status library_scene(const struct raydiff_case *from, struct scene *out,
                          struct reason *reason) MUST_USE;

/* The place of `word` among the names that `name` gives, which end with NULL. Errors: STATUS_INPUT
 * it is none of them. */
enum status library_find(const char *what, const char *word, const char *(*name)(uint32_t),
                         uint32_t *out, struct reason *reason) MUST_USE;

/* Rays of the interface, which have the numbers of struct ray in its order. */
static inline const struct ray *library_rays(const float *ray)
{
    return (const struct ray *)(const void *)ray;
}

#endif
