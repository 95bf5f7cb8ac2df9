#include "tests/shader_mutants/spirv_live.h"

#include <stdlib.h>
#include <string.h>

enum {
    OP_LIVE_CONSTANT_TRUE = 41,
    OP_LIVE_CONSTANT_FALSE = 42,
    OP_LIVE_SPEC_CONSTANT = 50,
    OP_LIVE_PARAMETER = 55,
    OP_LIVE_LOGICAL_NOT = 168,
    OP_LIVE_IEQUAL = 170,
    OP_LIVE_INOTEQUAL = 171,
    OP_LIVE_LABEL = 248,
    OP_LIVE_BRANCH = 249,
    OP_LIVE_BRANCH_CONDITIONAL = 250,
    OP_LIVE_SWITCH = 251,
    DEPTH = 32,
};

/* What is known of an id: of a constant its value, of a variable or parameter what it holds. */
enum knowledge { NOT_YET, KNOWN, VARIES };

struct live_id {
    size_t maker; /* instruction; SIZE_MAX: none */
    enum knowledge knowledge;
    uint32_t value;
    uint32_t stores, stored; /* of a pointer: how often it is stored to, and what last */
    bool passed;             /* an argument */
};

struct live_walk {
    const struct spirv_code *code;
    struct live_id *id;
    uint32_t bound;
    bool *live, changed;
};

static struct live_id *id_of(struct live_walk *w, uint32_t id)
{
    return &w->id[id < w->bound ? id : 0];
}

static void set(struct live_walk *w, uint32_t id, uint32_t value)
{
    id_of(w, id)->knowledge = KNOWN;
    id_of(w, id)->value = value;
}

/* The value of an id, if it depends on constants alone. */
static bool value_of(struct live_walk *w, uint32_t id, int depth, uint32_t *out)
{
    const struct live_id *of = id_of(w, id);
    uint32_t a, b;
    if (of->knowledge == KNOWN) {
        *out = of->value;
        return true;
    }
    if (of->maker == SIZE_MAX || depth == 0)
        return false;
    const uint32_t *word = spirv_words(w->code, of->maker);
    const uint32_t op = word[0] & 0xFFFFu;
    if (op == OP_LOAD) {
        const struct live_id *pointer = id_of(w, word[3]);
        const uint32_t made = pointer->maker == SIZE_MAX ? 0 : spirv_op(w->code, pointer->maker);
        if (made == OP_LIVE_PARAMETER && pointer->knowledge == KNOWN && pointer->stores == 0 &&
            !pointer->passed) {
            *out = pointer->value;
            return true;
        }
        return made == OP_VARIABLE && pointer->stores == 1 && !pointer->passed &&
               value_of(w, pointer->stored, depth - 1, out);
    }
    if (op == OP_LIVE_LOGICAL_NOT) {
        if (!value_of(w, word[3], depth - 1, &a))
            return false;
        *out = !a;
        return true;
    }
    const uint32_t first = op == OP_SPEC_CONSTANT_OP ? 4 : 3;
    const uint32_t what = op == OP_SPEC_CONSTANT_OP ? word[3] : op;
    if ((what != OP_LIVE_IEQUAL && what != OP_LIVE_INOTEQUAL) ||
        !value_of(w, word[first], depth - 1, &a) || !value_of(w, word[first + 1], depth - 1, &b))
        return false;
    *out = (a == b) == (what == OP_LIVE_IEQUAL);
    return true;
}

/* What an argument holds: the one value that its variable is given. */
static void pass(struct live_walk *w, uint32_t parameter, uint32_t argument)
{
    struct live_id *to = id_of(w, parameter), *from = id_of(w, argument);
    uint32_t value;
    const bool known = from->stores == 1 && value_of(w, from->stored, DEPTH, &value);
    if (to->knowledge == VARIES)
        return;
    if (!known || (to->knowledge == KNOWN && to->value != value)) {
        to->knowledge = VARIES;
        w->changed = true;
    } else if (to->knowledge == NOT_YET) {
        set(w, parameter, value);
        w->changed = true;
    }
}

static void reach(struct live_walk *w, uint32_t label)
{
    const size_t at = id_of(w, label)->maker;
    if (at != SIZE_MAX && !w->live[at]) {
        w->live[at] = true;
        w->changed = true;
    }
}

/* The function is reached: its header, parameters and first label are live. */
static size_t enter(struct live_walk *w, uint32_t function)
{
    size_t i = id_of(w, function)->maker;
    if (i == SIZE_MAX)
        return SIZE_MAX;
    const size_t first = i + 1;
    while (i < w->code->count && spirv_op(w->code, i) != OP_LIVE_LABEL)
        w->live[i++] = true;
    if (i < w->code->count && !w->live[i]) {
        w->live[i] = true;
        w->changed = true;
    }
    return first;
}

static void call(struct live_walk *w, const uint32_t *word)
{
    size_t parameter = enter(w, word[3]);
    for (uint32_t k = 4; k < word[0] >> 16 && parameter < w->code->count; k++, parameter++)
        pass(w, spirv_result(spirv_words(w->code, parameter)), word[k]);
}

/* Goes through a block that is live. */
static void block(struct live_walk *w, size_t at)
{
    for (; at < w->code->count; at++) {
        const uint32_t *word = spirv_words(w->code, at);
        const uint32_t op = word[0] & 0xFFFFu;
        uint32_t value;
        w->live[at] = true;
        if (op == OP_FUNCTION_CALL)
            call(w, word);
        if (op == OP_LIVE_BRANCH)
            reach(w, word[1]);
        if (op == OP_LIVE_BRANCH_CONDITIONAL) {
            const bool known = value_of(w, word[1], DEPTH, &value);
            if (!known || value)
                reach(w, word[2]);
            if (!known || !value)
                reach(w, word[3]);
        }
        if (op == OP_LIVE_SWITCH) {
            reach(w, word[2]);
            for (uint32_t k = 4; k < word[0] >> 16; k += 2)
                reach(w, word[k]);
        }
        if (op >= OP_LIVE_BRANCH && op <= 255)
            return;
    }
}

static void note(struct live_walk *w, const uint32_t *constant, uint32_t count, size_t at)
{
    const uint32_t *word = spirv_words(w->code, at);
    const uint32_t op = word[0] & 0xFFFFu, id = spirv_result(word);
    if (id)
        id_of(w, id)->maker = at;
    if (op == OP_CONSTANT)
        set(w, id, word[3]);
    if (op == OP_LIVE_CONSTANT_TRUE || op == OP_LIVE_CONSTANT_FALSE)
        set(w, id, op == OP_LIVE_CONSTANT_TRUE);
    if (op == OP_DECORATE && word[2] == DECORATION_SPEC_ID && word[3] < count)
        set(w, word[1], constant[word[3]]);
    if (op == OP_STORE) {
        id_of(w, word[1])->stores++;
        id_of(w, word[1])->stored = word[2];
    }
    for (uint32_t k = 4; op == OP_FUNCTION_CALL && k < word[0] >> 16; k++)
        id_of(w, word[k])->passed = true;
    /* A part of what it points to may be stored to. */
    if (op == OP_ACCESS_CHAIN || op == OP_IN_BOUNDS_ACCESS_CHAIN)
        id_of(w, word[3])->passed = true;
}

enum status spirv_live(const struct spirv_code *code, const uint32_t *constant, uint32_t count,
                       bool *live, struct reason *reason)
{
    struct live_walk w = {.code = code, .bound = code->word[3], .live = live};
    uint32_t entry = 0;
    size_t functions = code->count;
    w.id = alloc_zeroed(w.bound, sizeof *w.id);
    if (!w.id)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    for (uint32_t i = 0; i < w.bound; i++)
        w.id[i].maker = SIZE_MAX;
    for (size_t i = 0; i < code->count; i++) {
        note(&w, constant, count, i);
        if (spirv_op(code, i) == OP_ENTRY_POINT)
            entry = spirv_words(code, i)[2];
        if (spirv_op(code, i) == OP_FUNCTION && i < functions)
            functions = i;
        live[i] = i < functions;
    }
    w.changed = entry && enter(&w, entry) != SIZE_MAX;
    const bool ran = w.changed;
    while (w.changed) {
        w.changed = false;
        for (size_t i = functions; i < code->count; i++)
            if (live[i] && spirv_op(code, i) == OP_LIVE_LABEL)
                block(&w, i);
    }
    free(w.id);
    return ran ? STATUS_OK : fail(reason, STATUS_INPUT, "no entry point");
}
