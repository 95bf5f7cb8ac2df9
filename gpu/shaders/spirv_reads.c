#include "gpu/shaders/spirv_reads.h"

#include <stdlib.h>
#include <string.h>

void spirv_put(struct spirv_out *out, const uint32_t *word, size_t count)
{
    memcpy(out->word + out->count, word, count * sizeof *word);
    out->count += count;
}

void spirv_put_op(struct spirv_out *out, uint32_t op, const uint32_t *operand, uint32_t count)
{
    const uint32_t first = (count + 1) << 16 | op;
    spirv_put(out, &first, 1);
    spirv_put(out, operand, count);
}

static struct spirv_id *id_at(const struct spirv_reads *reads, const uint32_t *i, uint32_t at)
{
    const uint32_t id = at < i[0] >> 16 ? i[at] : 0;
    return &reads->id[id < reads->bound ? id : 0];
}

const struct spirv_id *spirv_id_at(const struct spirv_reads *reads, const uint32_t *i, uint32_t at)
{
    return id_at(reads, i, at);
}

static void note_type(struct spirv_reads *reads, const uint32_t *i, uint32_t count)
{
    const bool constant = (i[0] & 0xFFFFu) == OP_CONSTANT;
    struct spirv_id *id = id_at(reads, i, constant ? 2 : 1);
    const uint32_t at = (uint32_t)(id - reads->id);
    id->op = i[0] & 0xFFFFu;
    for (uint32_t k = 0; k < 3; k++)
        id->word[k] = k + 2 < count ? i[k + 2] : 0;
    if (id->op == OP_TYPE_INT && id->word[0] == 32 && id->word[1] == 0)
        reads->uint_type = at;
    if (id->op == OP_TYPE_VECTOR && id->word[0] == reads->uint_type && reads->uint_type) {
        if (id->word[1] == 2)
            reads->uvec2_type = at;
        if (id->word[1] == 4)
            reads->uvec4_type = at;
    }
}

static const struct spirv_id *known(const struct spirv_reads *reads, uint32_t id)
{
    return &reads->id[id < reads->bound ? id : 0];
}

/* A pointer to a structure of an array without an end, of words or of quads. */
static void note_variable(struct spirv_reads *reads, const uint32_t *i, uint32_t bindings)
{
    struct spirv_id *id = id_at(reads, i, 2);
    const struct spirv_id *pointer = id_at(reads, i, 1);
    const struct spirv_id *block = known(reads, pointer->word[1]);
    const struct spirv_id *array = known(reads, block->word[0]);
    const struct spirv_id *element = known(reads, array->word[0]);
    const uint32_t binding = id->binding - 1;
    if (pointer->op != OP_TYPE_POINTER || pointer->word[0] != CLASS_STORAGE_BUFFER ||
        id->binding == 0 || binding > 31 || !(bindings >> binding & 1))
        return;
    const bool quads = element->op == OP_TYPE_VECTOR && element->word[1] == 4;
    const uint32_t scalar = quads ? known(reads, element->word[0])->op : element->op;
    id->buffer.is = block->op == OP_TYPE_STRUCT && array->op == OP_TYPE_RUNTIME_ARRAY &&
                    (scalar == OP_TYPE_FLOAT || scalar == OP_TYPE_INT);
    id->buffer.words = !quads;
    id->buffer.real = scalar == OP_TYPE_FLOAT;
    id->buffer.element = array->word[0];
}

/* A chain to an element of such a buffer, or to its component. */
static enum status note_chain(struct spirv_reads *reads, const uint32_t *i, uint32_t count,
                              struct reason *reason)
{
    const struct spirv_id *buffer = id_at(reads, i, 3);
    struct spirv_id *id = id_at(reads, i, 2);
    if (!buffer->buffer.is)
        return STATUS_OK;
    if (count < 6 || count > (buffer->buffer.words ? 6u : 7u))
        return fail(reason, STATUS_UNSUPPORTED, "a part of a buffer that is no element");
    id->place.of = i[3];
    id->place.member = i[4];
    id->place.index = i[5];
    id->place.part = count > 6 ? i[6] : 0;
    *(buffer->buffer.words ? &reads->words : &reads->quads) |= 1u << (buffer->binding - 1);
    return STATUS_OK;
}

/* Whether an instruction that could use a pointer uses one to such a buffer. */
static bool uses(const struct spirv_reads *reads, const uint32_t *i, uint32_t count)
{
    const uint32_t op = i[0] & 0xFFFFu;
    const bool may = op == OP_FUNCTION_CALL || (op >= OP_STORE && op <= OP_COPY_MEMORY) ||
                     op == OP_ARRAY_LENGTH || op == OP_COPY_OBJECT || op == OP_SELECT ||
                     op == OP_PHI || op == OP_LOAD ||
                     (op >= OP_ATOMIC_FIRST && op <= OP_ATOMIC_LAST);
    for (uint32_t at = 1; may && at < count; at++) {
        const struct spirv_id *id = id_at(reads, i, at);
        const bool whole = id->buffer.is, part = id->place.of != 0;
        if (whole && !(op == OP_LOAD && at > 3))
            return true;
        if (part && op != OP_LOAD)
            return true;
    }
    return false;
}

static enum status note(struct spirv_reads *reads, const uint32_t *i, uint32_t bindings,
                        struct reason *reason)
{
    const uint32_t op = i[0] & 0xFFFFu, count = i[0] >> 16;
    if (op == OP_DECORATE && count == 4 && i[2] == DECORATION_BINDING)
        id_at(reads, i, 1)->binding = i[3] + 1;
    if ((op >= OP_TYPE_VOID && op <= OP_TYPE_POINTER) || op == OP_CONSTANT)
        note_type(reads, i, count);
    if (op == OP_VARIABLE)
        note_variable(reads, i, bindings);
    if (op == OP_ACCESS_CHAIN || op == OP_IN_BOUNDS_ACCESS_CHAIN)
        return note_chain(reads, i, count, reason);
    return uses(reads, i, count)
               ? fail(reason, STATUS_UNSUPPORTED, "a buffer is more than read (instruction %u)", op)
               : STATUS_OK;
}

enum status spirv_reads_make(const uint32_t *word, size_t count, uint32_t bindings,
                             struct spirv_reads *out, struct reason *reason)
{
    *out = (struct spirv_reads){.word = word, .count = count};
    if (count < SPIRV_HEADER_WORDS || word[0] != SPIRV_MAGIC || word[3] == 0 ||
        word[3] > SPIRV_BOUND_MOST)
        return fail(reason, STATUS_INPUT, "no SPIR-V module");
    out->bound = word[3];
    out->id = alloc_zeroed(out->bound, sizeof *out->id);
    if (!out->id)
        return fail(reason, STATUS_MEMORY, "no memory for %u SPIR-V ids", out->bound);
    enum status status = STATUS_OK;
    for (size_t at = SPIRV_HEADER_WORDS; at < count && !status; at += word[at] >> 16) {
        if (word[at] >> 16 == 0 || word[at] >> 16 > count - at)
            return fail(reason, STATUS_INPUT, "word %zu: no SPIR-V instruction", at);
        status = note(out, word + at, bindings, reason);
        out->id[0] = (struct spirv_id){0};
    }
    return status;
}

void spirv_reads_free(struct spirv_reads *reads)
{
    free(reads->id);
    reads->id = NULL;
}
