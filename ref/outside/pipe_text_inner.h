/* What the readers of lines share; for ref/outside/pipe_text*.c alone. */
#ifndef PIPE_TEXT_INNER_H
#define PIPE_TEXT_INNER_H

#include "ref/outside/pipe_text.h"

#include "ref/files/scan.h"
#include "ref/scene/mesh.h"

/* A file being read. */
struct pipe_reading {
    struct scan scan;
    const struct pipe_limits *limits;
    struct mesh mesh;
    size_t ray_capacity, mode_capacity, hit_capacity, tag_capacity;
    size_t lines; /* with words, before this one */
    bool ended;
    struct {
        bool open; /* v, t and g lines belong to the last mesh of the world */
        size_t capacity, geometry_capacity, instance_capacity;
    } world;
    struct pipe_text *out;
    struct reason *reason;
};

/* Reasons, and words of the line. All errors are STATUS_INPUT "NAME:LINE: rule" or
 * STATUS_MEMORY. */
enum status pipe_text_no_memory(struct pipe_reading *r);
enum status pipe_text_floats(struct pipe_reading *r, const char *const *what, float *out,
                             int count) MUST_USE;
/* A whole number from 0 to `most`. */
enum status pipe_text_number(struct pipe_reading *r, const char *what, uint32_t most,
                             uint32_t *out) MUST_USE;
/* Reads the next word and returns its index in a table, or the table's length. */
uint32_t pipe_text_word(struct pipe_reading *r, const char *(*name)(uint32_t));
enum status pipe_text_add_hit(struct pipe_reading *r, struct hit hit, uint32_t tag) MUST_USE;

/* Lines of version 2, behind their first word; false if there is no such line. */
bool pipe_text_world_line(struct pipe_reading *r, const char *word, size_t length,
                          enum status *status);
/* What belongs to rays and answers in version 2. */
enum status pipe_text_mode(struct pipe_reading *r) MUST_USE;
enum status pipe_text_world_hit(struct pipe_reading *r) MUST_USE;
/* Ends the mesh that is open, at a line that is none of its own, or at the end. */
enum status pipe_text_end_mesh(struct pipe_reading *r) MUST_USE;

#endif
