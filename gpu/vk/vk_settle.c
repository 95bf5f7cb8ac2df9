#include "gpu/vk/vk_settle.h"

#include <stdlib.h>
#include <string.h>

#define MAGIC        0x07230203u
#define HEADER_WORDS 5u
#define BOUND_MOST   0x3FFFFFu /* the specification's limit of ids */
#define SPEC_ID      1u        /* decoration */

/* Opcodes of SPIR-V, by the names of its specification. */
enum settle_opcode {
    SETTLE_NOP = 0,
    SETTLE_TRUE = 41,
    SETTLE_FALSE = 42,
    SETTLE_CONSTANT = 43,
    SETTLE_SPEC_CONSTANT = 50,
    SETTLE_SPEC_OP = 52,
    SETTLE_DECORATE = 71,
    SETTLE_LOGICAL_EQUAL = 164,
    SETTLE_LOGICAL_NOT_EQUAL = 165,
    SETTLE_OR = 166,
    SETTLE_AND = 167,
    SETTLE_NOT = 168,
    SETTLE_EQUAL = 170,
    SETTLE_NOT_EQUAL = 171,
    SETTLE_PHI = 245,
    SETTLE_SELECTION_MERGE = 247,
    SETTLE_LABEL = 248,
    SETTLE_BRANCH = 249,
    SETTLE_BRANCH_IF = 250
};

/* What is known of an id. */
struct settle_id {
    uint32_t spec;  /* 1 + its SpecId; 0: has none */
    uint32_t value; /* of a constant of one word; 0 or 1 of a truth value */
    bool known;
    bool phis; /* a block that begins with OpPhi, which tells from where it is reached */
};

struct settle_module {
    uint32_t *word;
    uint32_t count, bound;
    const uint32_t *value; /* of specialization constants */
    uint32_t values;
    struct settle_id *id;
};

static uint32_t op_of(const uint32_t *word)
{
    return word[0] & 0xFFFF;
}

static uint32_t length_of(const uint32_t *word)
{
    return word[0] >> 16;
}

/* Every instruction ends within the module. */
static bool is_whole(const struct settle_module *m)
{
    if (m->count < HEADER_WORDS || m->word[0] != MAGIC || m->bound == 0 || m->bound > BOUND_MOST)
        return false;
    uint32_t at = HEADER_WORDS;
    while (at < m->count && length_of(m->word + at) > 0 && length_of(m->word + at) <= m->count - at)
        at += length_of(m->word + at);
    return at == m->count;
}

/* What is known of the id; of one out of range nothing. */
static struct settle_id *id_at(struct settle_module *m, uint32_t id)
{
    return &m->id[id < m->bound ? id : 0];
}

static void learn(struct settle_module *m, uint32_t id, uint32_t value)
{
    if (id > 0 && id < m->bound) {
        m->id[id].known = true;
        m->id[id].value = value;
    }
}

static void learn_operation(struct settle_module *m, const uint32_t *word)
{
    const uint32_t length = length_of(word), op = word[3];
    if (length != 5 && length != 6)
        return;
    const struct settle_id *a = id_at(m, word[4]), *b = id_at(m, word[length - 1]);
    if (!a->known || !b->known || (length == 5) != (op == SETTLE_NOT))
        return;
    switch (op) {
    case SETTLE_NOT:
        learn(m, word[2], !a->value);
        break;
    case SETTLE_OR:
        learn(m, word[2], a->value | b->value);
        break;
    case SETTLE_AND:
        learn(m, word[2], a->value & b->value);
        break;
    case SETTLE_EQUAL:
    case SETTLE_LOGICAL_EQUAL:
        learn(m, word[2], a->value == b->value);
        break;
    case SETTLE_NOT_EQUAL:
    case SETTLE_LOGICAL_NOT_EQUAL:
        learn(m, word[2], a->value != b->value);
        break;
    default:
        break;
    }
}

/* One instruction before the first function, or a label with the instruction behind it. */
static void look_at(struct settle_module *m, const uint32_t *word, const uint32_t *next)
{
    const uint32_t length = length_of(word);
    switch (op_of(word)) {
    case SETTLE_DECORATE:
        if (length == 4 && word[2] == SPEC_ID && word[1] > 0 && word[1] < m->bound)
            m->id[word[1]].spec = 1 + word[3];
        break;
    case SETTLE_TRUE:
    case SETTLE_FALSE:
        if (length == 3)
            learn(m, word[2], op_of(word) == SETTLE_TRUE);
        break;
    case SETTLE_CONSTANT:
    case SETTLE_SPEC_CONSTANT:
        if (length == 4) {
            const uint32_t spec = id_at(m, word[2])->spec;
            learn(m, word[2], spec > 0 && spec <= m->values ? m->value[spec - 1] : word[3]);
        }
        break;
    case SETTLE_SPEC_OP:
        if (length >= 5)
            learn_operation(m, word);
        break;
    case SETTLE_LABEL:
        if (length == 2 && word[1] > 0 && word[1] < m->bound)
            m->id[word[1]].phis = op_of(next) == SETTLE_PHI;
        break;
    default:
        break;
    }
}

/* OpSelectionMerge and the branch behind it. */
static void settle_branch(struct settle_module *m, uint32_t *merge, uint32_t *branch)
{
    const uint32_t words = length_of(merge) + length_of(branch);
    if (length_of(merge) != 3 || op_of(branch) != SETTLE_BRANCH_IF || length_of(branch) < 4)
        return;
    const struct settle_id *condition = id_at(m, branch[1]);
    if (!condition->known)
        return;
    const uint32_t taken = branch[condition->value ? 2 : 3],
                   left = branch[condition->value ? 3 : 2];
    if (id_at(m, left)->phis)
        return;
    for (uint32_t i = 0; i < words - 2; i++)
        merge[i] = 1u << 16 | SETTLE_NOP;
    merge[words - 2] = 2u << 16 | SETTLE_BRANCH;
    merge[words - 1] = taken;
}

static void settle_all(struct settle_module *m)
{
    for (uint32_t at = HEADER_WORDS; at < m->count; at += length_of(m->word + at))
        look_at(m, m->word + at, m->word + at + length_of(m->word + at));
    for (uint32_t at = HEADER_WORDS, next; at < m->count; at = next) {
        next = at + length_of(m->word + at);
        if (op_of(m->word + at) == SETTLE_SELECTION_MERGE && next < m->count)
            settle_branch(m, m->word + at, m->word + next);
    }
}

enum status vk_settle(const uint32_t *word, uint32_t count, const uint32_t *value, uint32_t values,
                      uint32_t **out)
{
    *out = NULL;
    struct settle_module m = {.count = count, .value = value, .values = values};
    if (count < HEADER_WORDS)
        return STATUS_OK;
    m.word = malloc((count + (size_t)1) * sizeof *m.word);
    if (!m.word)
        return STATUS_MEMORY;
    memcpy(m.word, word, count * sizeof *m.word);
    m.word[count] = 0; /* behind the last instruction: none */
    m.bound = m.word[3];
    if (!is_whole(&m)) {
        free(m.word);
        return STATUS_OK;
    }
    m.id = alloc_zeroed(m.bound, sizeof *m.id);
    if (!m.id) {
        free(m.word);
        return STATUS_MEMORY;
    }
    settle_all(&m);
    free(m.id);
    *out = m.word;
    return STATUS_OK;
}
