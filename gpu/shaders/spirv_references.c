#include "gpu/shaders/spirv_memory.h"
#include "gpu/shaders/spirv_reads.h"

#include <stdlib.h>
#include <string.h>

enum { ADDRESSES = 5347 /* capability */, ADDRESSING_64 = 5348 };
enum { ALIGNED = 2 };

/* A buffer's new types. */
struct referred {
    uint32_t whole, element, part; /* pointers to its structure, an element and a component */
};

/* A module being made; the types that it adds. */
struct references {
    struct spirv_reads reads;
    struct spirv_out out;
    struct referred *referred; /* of each id */
    uint32_t uint_type, uvec2_type, holder, holder_pointer, address_pointer;
    bool able, extended, decorated, typed;
};

/* The structure that holds an address. */
static void put_decorations(struct references *r)
{
    SPIRV_PUT(&r->out, OP_DECORATE, r->holder, DECORATION_BLOCK);
    SPIRV_PUT(&r->out, OP_MEMBER_DECORATE, r->holder, 0, DECORATION_OFFSET, 0);
    r->decorated = true;
}

/* A type may stand only once in a module: those that it has come here, before all others. */
static void put_types(struct references *r)
{
    r->uint_type = r->reads.uint_type ? r->reads.uint_type : r->out.bound++;
    r->uvec2_type = r->reads.uvec2_type ? r->reads.uvec2_type : r->out.bound++;
    r->holder_pointer = r->out.bound++;
    r->address_pointer = r->out.bound++;
    SPIRV_PUT(&r->out, OP_TYPE_INT, r->uint_type, 32, 0);
    SPIRV_PUT(&r->out, OP_TYPE_VECTOR, r->uvec2_type, r->uint_type, 2);
    SPIRV_PUT(&r->out, OP_TYPE_STRUCT, r->holder, r->uvec2_type);
    SPIRV_PUT(&r->out, OP_TYPE_POINTER, r->holder_pointer, CLASS_STORAGE_BUFFER, r->holder);
    SPIRV_PUT(&r->out, OP_TYPE_POINTER, r->address_pointer, CLASS_STORAGE_BUFFER, r->uvec2_type);
    r->typed = true;
}

/* The variable holds the address; its old types are what that points to. */
static void put_variable(struct references *r, const uint32_t *i)
{
    const struct spirv_id *id = r->reads.id;
    const uint32_t block = id[i[1]].word[1], element = id[i[2]].buffer.element;
    struct referred *new = &r->referred[i[2]];
    *new = (struct referred){r->out.bound, r->out.bound + 1, r->out.bound + 2};
    r->out.bound += 3;
    SPIRV_PUT(&r->out, OP_TYPE_POINTER, new->whole, CLASS_PHYSICAL, block);
    SPIRV_PUT(&r->out, OP_TYPE_POINTER, new->element, CLASS_PHYSICAL, element);
    SPIRV_PUT(&r->out, OP_TYPE_POINTER, new->part, CLASS_PHYSICAL,
              id[i[2]].buffer.words ? element : id[element].word[0]);
    SPIRV_PUT(&r->out, OP_VARIABLE, r->holder_pointer, i[2], CLASS_STORAGE_BUFFER);
}

/* Loads the place of instruction i, an OpLoad, from the address that its buffer holds. */
static void put_load(struct references *r, const uint32_t *i)
{
    const struct spirv_id *place = &r->reads.id[i[3]];
    const struct referred *types = &r->referred[place->place.of];
    const bool quad = !r->reads.id[place->place.of].buffer.words && !place->place.part;
    const uint32_t held = r->out.bound, address = held + 1, pointer = held + 2, at = held + 3;
    r->out.bound += 4;
    SPIRV_PUT(&r->out, OP_ACCESS_CHAIN, r->address_pointer, held, place->place.of,
              place->place.member);
    SPIRV_PUT(&r->out, OP_LOAD, r->uvec2_type, address, held);
    SPIRV_PUT(&r->out, OP_BITCAST, types->whole, pointer, address);
    if (place->place.part)
        SPIRV_PUT(&r->out, OP_ACCESS_CHAIN, types->part, at, pointer, place->place.member,
                  place->place.index, place->place.part);
    else
        SPIRV_PUT(&r->out, OP_ACCESS_CHAIN, types->element, at, pointer, place->place.member,
                  place->place.index);
    SPIRV_PUT(&r->out, OP_LOAD, i[1], i[2], at, ALIGNED, quad ? 16 : 4);
}

/* Whether the instruction goes, or was replaced. */
static bool replaced(struct references *r, const uint32_t *i)
{
    static const char extension[32] = "SPV_KHR_physical_storage_buffer"; /* with its end, 8 words */
    const struct spirv_reads *reads = &r->reads;
    switch (i[0] & 0xFFFFu) {
    case OP_MEMORY_MODEL:
        if (i[0] >> 16 != 3)
            return false;
        SPIRV_PUT(&r->out, OP_MEMORY_MODEL, ADDRESSING_64, i[2]);
        return true;
    case OP_CAPABILITY:
        if (!r->able)
            SPIRV_PUT(&r->out, OP_CAPABILITY, ADDRESSES);
        r->able = true;
        return false;
    case OP_EXTENSION:
    case OP_EXT_INST_IMPORT: {
        uint32_t word[8];
        memcpy(word, extension, sizeof word);
        if (!r->extended)
            spirv_put_op(&r->out, OP_EXTENSION, word, 8);
        r->extended = true;
        return false;
    }
    case OP_TYPE_INT:
    case OP_TYPE_VECTOR:
        return spirv_is(reads, i, reads->uint_type) || spirv_is(reads, i, reads->uvec2_type);
    case OP_VARIABLE:
        if (spirv_id_at(reads, i, 2)->buffer.is)
            put_variable(r, i);
        return spirv_id_at(reads, i, 2)->buffer.is;
    case OP_ACCESS_CHAIN:
    case OP_IN_BOUNDS_ACCESS_CHAIN:
        return spirv_id_at(reads, i, 2)->place.of != 0;
    case OP_LOAD:
        if (spirv_id_at(reads, i, 3)->place.of)
            put_load(r, i);
        return spirv_id_at(reads, i, 3)->place.of != 0;
    default:
        return false;
    }
}

static void put_module(struct references *r)
{
    const uint32_t *word = r->reads.word;
    r->holder = r->out.bound++;
    spirv_put(&r->out, word, SPIRV_HEADER_WORDS);
    for (size_t at = SPIRV_HEADER_WORDS; at < r->reads.count; at += word[at] >> 16) {
        const uint32_t op = word[at] & 0xFFFFu;
        const bool type = op >= OP_TYPE_VOID && op <= OP_TYPE_POINTER;
        if (!r->decorated && (op == OP_DECORATE || op == OP_MEMBER_DECORATE || type))
            put_decorations(r);
        if (!r->typed && type)
            put_types(r);
        if (!replaced(r, word + at))
            spirv_put(&r->out, word + at, word[at] >> 16);
    }
    r->out.word[3] = r->out.bound;
}

enum status spirv_references(const uint32_t *word, size_t count, uint32_t bindings, uint32_t **out,
                             size_t *out_count, struct reason *reason)
{
    struct references r = {0};
    *out = NULL;
    enum status status = spirv_reads_make(word, count, bindings, &r.reads, reason);
    if (!status) {
        r.out.bound = r.reads.bound;
        r.referred = alloc_zeroed(r.reads.bound, sizeof *r.referred);
        /* A load of four words becomes at most 26, a variable of four 20. */
        r.out.word = alloc_zeroed(7 * count + 64, sizeof *r.out.word);
        if (!r.referred || !r.out.word)
            status = fail(reason, STATUS_MEMORY, "no memory for a shader");
    }
    if (status) {
        free(r.out.word);
    } else {
        put_module(&r);
        *out = r.out.word;
        *out_count = r.out.count;
    }
    free(r.referred);
    spirv_reads_free(&r.reads);
    return status;
}
