/* How a module reads its storage buffers, for making another that reads them otherwise
 * (gpu/shaders/spirv_memory.h). */
#ifndef SPIRV_READS_H
#define SPIRV_READS_H

#include "gpu/shaders/spirv_words.h"
#include "ref/base/base.h"

/* What is known of an id. 0: nothing. */
struct spirv_id {
    uint32_t op, word[3]; /* of types and constants: the instruction and its first operands */
    uint32_t binding;     /* 1 + that of a variable */
    struct {
        bool is;          /* a buffer that is read otherwise */
        bool words;       /* its elements are words, not quads */
        bool real;        /* of floats, not of unsigned integers */
        uint32_t element; /* their type */
    } buffer;
    struct {
        uint32_t of, index; /* of != 0: a pointer to an element of that buffer, at that id */
        uint32_t member;    /* id of the number of the structure's member, 0 */
        uint32_t part;      /* id of the component; 0: the element */
    } place;
};

/* A module and its ids. Owns `id`, see spirv_reads_free. */
struct spirv_reads {
    const uint32_t *word;
    size_t count;
    struct spirv_id *id;
    uint32_t bound;
    uint32_t uint_type, uvec2_type, uvec4_type; /* ids, or 0: the module has none */
    uint32_t words, quads;                      /* bindings that are read as such */
};

/* Examines a module whose buffers of these bindings (bit 1 << binding) are to be read otherwise.
 * *out is to be freed, on errors, too. Errors: STATUS_INPUT it is no module; STATUS_UNSUPPORTED it
 * does more with such a buffer than read elements and components; STATUS_MEMORY. */
enum status spirv_reads_make(const uint32_t *word, size_t count, uint32_t bindings,
                             struct spirv_reads *out, struct reason *reason) MUST_USE;
/* What is known of the id that word `at` of an instruction is: nothing beyond the instruction's end
 * and of ids beyond the bound. */
const struct spirv_id *spirv_id_at(const struct spirv_reads *reads, const uint32_t *i, uint32_t at);

/* Whether a type's instruction makes that type; 0 is none. */
static inline bool spirv_is(const struct spirv_reads *reads, const uint32_t *i, uint32_t type)
{
    return type && spirv_id_at(reads, i, 1) == &reads->id[type];
}

void spirv_reads_free(struct spirv_reads *reads);

/* A module that is being written. */
struct spirv_out {
    uint32_t *word;
    size_t count;
    uint32_t bound; /* the next free id */
};

void spirv_put(struct spirv_out *out, const uint32_t *word, size_t count);
/* An instruction of these operands, at most 9. */
void spirv_put_op(struct spirv_out *out, uint32_t op, const uint32_t *operand, uint32_t count);
#define SPIRV_PUT(out, op, ...)                                                                    \
    spirv_put_op(out, op, (const uint32_t[]){__VA_ARGS__},                                         \
                 (uint32_t)(sizeof((const uint32_t[]){__VA_ARGS__}) / sizeof(uint32_t)))

#endif
