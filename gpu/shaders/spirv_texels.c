#include "gpu/shaders/spirv_memory.h"
#include "gpu/shaders/spirv_reads.h"

#include <stdlib.h>

enum { SAMPLED_BUFFER = 46 /* capability */, DIM_BUFFER = 5, SAMPLED = 1 };

/* A module being made; the types that it adds. */
struct texels {
    struct spirv_reads reads;
    struct spirv_out out;
    uint32_t uint_type, uvec4_type, image_type, pointer_type;
    bool typed; /* they are written */
};

/* A type may stand only once in a module: those that it has come here, before all others. */
static void put_types(struct texels *t)
{
    t->uint_type = t->reads.uint_type ? t->reads.uint_type : t->out.bound++;
    t->uvec4_type = t->reads.uvec4_type ? t->reads.uvec4_type : t->out.bound++;
    t->image_type = t->out.bound++;
    t->pointer_type = t->out.bound++;
    SPIRV_PUT(&t->out, OP_TYPE_INT, t->uint_type, 32, 0);
    SPIRV_PUT(&t->out, OP_TYPE_VECTOR, t->uvec4_type, t->uint_type, 4);
    SPIRV_PUT(&t->out, OP_TYPE_IMAGE, t->image_type, t->uint_type, DIM_BUFFER, 0, 0, 0, SAMPLED, 0);
    SPIRV_PUT(&t->out, OP_TYPE_POINTER, t->pointer_type, CLASS_UNIFORM_CONSTANT, t->image_type);
    t->typed = true;
}

/* Loads the place of instruction i, an OpLoad, by a fetch. */
static void put_fetch(struct texels *t, const uint32_t *i)
{
    const struct spirv_id *place = &t->reads.id[i[3]];
    const struct spirv_id *of = &t->reads.id[place->place.of];
    const bool quad = !of->buffer.words && !place->place.part;
    const uint32_t image = t->out.bound++;
    const uint32_t fetched = quad && !of->buffer.real ? i[2] : t->out.bound++;
    SPIRV_PUT(&t->out, OP_LOAD, t->image_type, image, place->place.of);
    SPIRV_PUT(&t->out, OP_IMAGE_FETCH, t->uvec4_type, fetched, image, place->place.index);
    if (quad) {
        if (of->buffer.real)
            SPIRV_PUT(&t->out, OP_BITCAST, i[1], i[2], fetched);
        return;
    }
    const uint32_t word = of->buffer.real ? t->out.bound++ : i[2];
    if (of->buffer.words)
        SPIRV_PUT(&t->out, OP_COMPOSITE_EXTRACT, t->uint_type, word, fetched, 0);
    else
        SPIRV_PUT(&t->out, OP_EXTRACT_DYNAMIC, t->uint_type, word, fetched, place->place.part);
    if (of->buffer.real)
        SPIRV_PUT(&t->out, OP_BITCAST, i[1], i[2], word);
}

/* Whether the instruction goes, or was replaced. */
static bool replaced(struct texels *t, const uint32_t *i)
{
    const struct spirv_reads *reads = &t->reads;
    switch (i[0] & 0xFFFFu) {
    case OP_DECORATE: /* what is left of a buffer's is where it is bound */
        return i[0] >> 16 > 2 && spirv_id_at(reads, i, 1)->buffer.is &&
               i[2] != DECORATION_BINDING && i[2] != DECORATION_DESCRIPTOR_SET;
    case OP_TYPE_INT:
    case OP_TYPE_VECTOR:
        return spirv_is(reads, i, reads->uint_type) || spirv_is(reads, i, reads->uvec4_type);
    case OP_VARIABLE:
        if (!spirv_id_at(reads, i, 2)->buffer.is)
            return false;
        SPIRV_PUT(&t->out, OP_VARIABLE, t->pointer_type, i[2], CLASS_UNIFORM_CONSTANT);
        return true;
    case OP_ACCESS_CHAIN:
    case OP_IN_BOUNDS_ACCESS_CHAIN:
        return spirv_id_at(reads, i, 2)->place.of != 0;
    case OP_LOAD:
        if (!spirv_id_at(reads, i, 3)->place.of)
            return false;
        put_fetch(t, i);
        return true;
    default:
        return false;
    }
}

static void put_module(struct texels *t)
{
    const uint32_t *word = t->reads.word;
    bool able = false;
    spirv_put(&t->out, word, SPIRV_HEADER_WORDS);
    for (size_t at = SPIRV_HEADER_WORDS; at < t->reads.count; at += word[at] >> 16) {
        const uint32_t op = word[at] & 0xFFFFu;
        if (!t->typed && op >= OP_TYPE_VOID && op <= OP_TYPE_POINTER)
            put_types(t);
        if (!replaced(t, word + at))
            spirv_put(&t->out, word + at, word[at] >> 16);
        if (!able && op == OP_CAPABILITY) {
            SPIRV_PUT(&t->out, OP_CAPABILITY, SAMPLED_BUFFER);
            able = true;
        }
    }
    t->out.word[3] = t->out.bound;
}

enum status spirv_texels(const uint32_t *word, size_t count, uint32_t bindings, uint32_t **out,
                         size_t *out_count, uint32_t *words, struct reason *reason)
{
    struct texels t = {0};
    *out = NULL;
    enum status status = spirv_reads_make(word, count, bindings, &t.reads, reason);
    if (!status && (t.reads.words & t.reads.quads))
        status = fail(reason, STATUS_UNSUPPORTED, "a buffer is read both as words and as quads");
    /* A load of four words becomes at most 17. */
    if (!status && !(t.out.word = alloc_zeroed(5 * count + 64, sizeof *t.out.word)))
        status = fail(reason, STATUS_MEMORY, "no memory for a shader");
    if (!status) {
        t.out.bound = t.reads.bound;
        put_module(&t);
        *out = t.out.word;
        *out_count = t.out.count;
        *words = t.reads.words;
    }
    spirv_reads_free(&t.reads);
    return status;
}
