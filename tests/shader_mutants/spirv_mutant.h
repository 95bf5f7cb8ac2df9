/* Mutants of a SPIR-V module: copies with one small change each, as a driver's compiler with a bug
 * could make them. What no suite sees of them is a blind spot of the suites. */
#ifndef SPIRV_MUTANT_H
#define SPIRV_MUTANT_H

#include "gpu/bisect/spirv_say.h"

#define MUTANT_TEXT     160u
#define MUTANT_FUNCTION 48u
#define MUTANT_WORDS    24u /* longer instructions are left alone */

enum mutant_kind {
    MUTANT_DECORATION,  /* one NoContraction is gone */
    MUTANT_CONTRACTION, /* a product and its sum are rounded once, as a driver may without it */
    MUTANT_OPERANDS,    /* two operands or arguments are swapped */
    MUTANT_COMPARISON,  /* < became <=, > or its unordered form, and so on */
    MUTANT_LITERAL,     /* one use of a constant: one more or less, an ulp, twice, a mask widened */
    MUTANT_OPERATION,   /* a sum became a difference, an And an Or, a negation a copy */
    MUTANT_STORE,       /* a store is gone */
    MUTANT_BRANCH,      /* a condition is negated */
    MUTANT_INDEX,       /* another member, element or component */
    MUTANT_CONVERSION,  /* signed became unsigned, bits became a value */
    MUTANT_BARRIER,     /* a barrier is gone */
    MUTANT_KINDS
};
extern const char *const mutant_kind_names[MUTANT_KINDS + 1]; /* NULL-terminated */

/* One change. Its name FUNCTION.KIND.NUMBER stays the same as long as the function does. */
struct spirv_mutant {
    enum mutant_kind kind;
    size_t at;                            /* the instruction */
    char function[MUTANT_FUNCTION];       /* as the source has it; "module": none */
    uint32_t number;                      /* among those of its kind in that function */
    char text[MUTANT_TEXT];               /* "OpFSub became OpFAdd" */
    uint32_t word[MUTANT_WORDS], count;   /* in its place; none: it is gone */
    uint32_t before[24], before_count;    /* in front of it */
    uint32_t constant[8], constant_count; /* in front of the first function */
    uint32_t ids;                         /* new ones, from the module's bound on */
    bool doubles;                         /* it needs the capability Float64 */
};

struct spirv_mutants {
    struct spirv_mutant *one;
    size_t count, capacity;
};

/* Lists all mutants, in the order of instructions. Not all are valid modules. Errors:
 * STATUS_INPUT; STATUS_MEMORY. Free in either case. */
enum status spirv_mutants_make(const struct spirv_code *code, struct spirv_mutants *out,
                               struct reason *reason) MUST_USE;
void spirv_mutants_free(struct spirv_mutants *mutants);

/* Makes the module, which the caller frees. Errors: STATUS_MEMORY. */
enum status spirv_mutate(const struct spirv_code *code, const struct spirv_mutant *mutant,
                         uint32_t **out, size_t *out_count, struct reason *reason) MUST_USE;

/* "slab_robust.comparison.3". */
void spirv_mutant_name(const struct spirv_mutant *mutant, char text[MUTANT_TEXT]);

/* --- for spirv_mutant*.c alone ------------------------------------------------------------- */

/* A module that is looked at. */
struct mutant_look {
    const struct spirv_code *code;
    size_t *maker;            /* of each id, the instruction; SIZE_MAX: none */
    uint32_t bound, extended; /* extended: GLSL.std.450, 0: not imported */
    size_t functions;         /* the first instruction of them */
    char function[MUTANT_FUNCTION];
    struct spirv_mutants *out;
    enum status status;
};

/* The instruction that makes an id, or NULL. */
const uint32_t *mutant_maker(const struct mutant_look *look, uint32_t id);

/* The opcode that makes an id; 0: none. */
uint32_t mutant_op(const struct mutant_look *look, uint32_t id);

/* A mutant of instruction `at` that is still the instruction itself. */
struct spirv_mutant mutant_of(const struct mutant_look *look, enum mutant_kind kind, size_t at);

/* Adds it, with its text. */
void mutant_add(struct mutant_look *look, struct spirv_mutant *mutant, const char *format, ...)
    PRINTF_LIKE(3, 4);

/* Adds those of swapped operands, and of a sum of a product. */
void mutant_swap_operands(struct mutant_look *look, size_t at);
void mutant_contract(struct mutant_look *look, size_t at);

/* Adds those of literals, indices and conversions of instruction `at`. */
void mutant_values(struct mutant_look *look, size_t at);

#endif
