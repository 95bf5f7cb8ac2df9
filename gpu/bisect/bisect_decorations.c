/* Decorations that a module lacks: the least set that cures the symptom when it is put back. */
#include "gpu/bisect/bisect_inner.h"

#include "gpu/shaders/spirv_fix.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct curing {
    struct bisect_search *search;
    struct spirv_code code;
    uint32_t *id; /* of operations without a decoration that others of their kind have */
    size_t count;
};

static bool is_decoration(const struct spirv_code *code, size_t i)
{
    return spirv_op(code, i) == OP_DECORATE && spirv_length(code, i) == 3 &&
           spirv_words(code, i)[2] == NO_CONTRACTION;
}

static bool is_decorated(const struct spirv_code *code, uint32_t id)
{
    for (size_t i = 0; i < code->count; i++)
        if (is_decoration(code, i) && spirv_words(code, i)[1] == id)
            return true;
    return false;
}

/* The module with the decorations of those that are `in`, before its first one. */
static enum status put_back(const struct curing *c, const bool *in, struct bisect_module *out,
                            struct reason *reason)
{
    const struct spirv_code *code = &c->code;
    const size_t words = code->at[code->count];
    size_t first = 0;
    while (first < code->count && spirv_op(code, first) != OP_DECORATE)
        first++;
    const size_t front = first < code->count ? code->at[first] : words;
    *out = (struct bisect_module){alloc_zeroed(words + 3 * c->count, sizeof *out->word), front};
    if (!out->word)
        return fail(reason, STATUS_MEMORY, "no memory for a shader");
    memcpy(out->word, code->word, front * sizeof *out->word);
    for (size_t i = 0; i < c->count; i++)
        if (in[i]) {
            const uint32_t line[] = {3u << 16 | OP_DECORATE, c->id[i], NO_CONTRACTION};
            memcpy(out->word + out->count, line, sizeof line);
            out->count += 3;
        }
    memcpy(out->word + out->count, code->word + front, (words - front) * sizeof *out->word);
    out->count += words - front;
    return STATUS_OK;
}

/* Shows: cured. */
static enum delta_answer ask_cure(void *user, const bool *in)
{
    struct curing *c = user;
    struct bisect_search *search = c->search;
    struct bisect_module module;
    struct reason reason = {""};
    if (search->job->step)
        search->job->step(search->job->user, "decorations", ++search->out->edit_tries);
    enum status status = put_back(c, in, &module, &reason);
    if (status)
        return bisect_stop(search, status, &reason);
    const enum delta_answer answer = bisect_ask(search, module);
    return answer == DELTA_SHOWS       ? DELTA_SHOWS_NOT
           : answer == DELTA_SHOWS_NOT ? DELTA_SHOWS
                                       : answer;
}

/* Those that the build's tool would decorate, and that are not. */
static enum status find_bare(struct curing *c, size_t words, struct reason *reason)
{
    const struct spirv_rules rules = {.query = true};
    struct spirv_code fixed = {0};
    uint32_t *word;
    size_t count;
    enum status status = spirv_fix(c->code.word, words, &rules, &word, &count, reason);
    if (!status)
        status = spirv_code_make(word, count, &fixed, reason);
    c->id = alloc_zeroed(fixed.count, sizeof *c->id);
    if (!status && !c->id)
        status = fail(reason, STATUS_MEMORY, "no memory for ids");
    for (size_t i = 0; i < fixed.count && !status; i++)
        if (is_decoration(&fixed, i) && !is_decorated(&c->code, spirv_words(&fixed, i)[1]))
            c->id[c->count++] = spirv_words(&fixed, i)[1];
    spirv_code_free(&fixed);
    free(word);
    return status;
}

static void say(const struct curing *c, const bool *in, struct bisect *out)
{
    for (size_t i = 0; i < c->count; i++) {
        const size_t maker = spirv_maker(&c->code, c->id[i]);
        if (!in[i] || maker == c->code.count)
            continue;
        char name[SPIRV_SAY_MOST];
        spirv_say_name(spirv_words(&c->code, maker), name);
        if (out->edit_count++ == 0) {
            spirv_function(&c->code, maker, out->function);
            snprintf(out->what, sizeof out->what, "%%%u (%.100s) is without NoContraction",
                     c->id[i], name);
        }
        const uint32_t lost[] = {3u << 16 | OP_DECORATE, c->id[i], NO_CONTRACTION};
        bisect_put_line(out, '-', lost);
        bisect_put_line(out, ' ', spirv_words(&c->code, maker));
    }
}

static void search_cure(struct curing *c)
{
    struct bisect_search *search = c->search;
    struct bisect *out = search->out;
    bool *in = alloc_zeroed(c->count, sizeof *in);
    struct delta delta = {.ask = ask_cure, .user = c, .count = c->count, .most = search->job->most};
    enum status status = in ? STATUS_OK : STATUS_MEMORY;
    for (size_t i = 0; in && i < c->count; i++)
        in[i] = true;
    out->decorations = true;
    out->edits = c->count;
    if (!status && (c->count == 0 || ask_cure(c, in) != DELTA_SHOWS)) {
        out->end = BISECT_NO_CURE;
    } else if (!status) {
        out->end = BISECT_FOUND;
        out->least = delta_reduce(&delta, in, &status);
        say(c, in, out);
    }
    if (status)
        bisect_stop(search, status, NULL);
    free(in);
}

void bisect_decorations(struct bisect_search *search, struct bisect_module module)
{
    struct curing c = {.search = search};
    struct reason reason = {""};
    enum status status = spirv_code_make(module.word, module.count, &c.code, &reason);
    if (!status)
        status = find_bare(&c, module.count, &reason);
    if (status == STATUS_INPUT) /* the build's tool would refuse it */
        search->out->end = BISECT_NO_CURE;
    else if (status)
        bisect_stop(search, status, &reason);
    else
        search_cure(&c);
    spirv_code_free(&c.code);
    free(c.id);
    free(module.word);
}
