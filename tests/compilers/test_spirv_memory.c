/* Modules that read their inputs otherwise (gpu/shaders/spirv_memory.h): laws of every module that
 * traces, counted by another walk through its words; what cannot be read otherwise is refused. */
#include "gpu/shaders/compiler.h"
#include "gpu/shaders/compiler_tools.h"
#include "gpu/shaders/shaders.h"
#include "gpu/shaders/spirv_look.h"
#include "gpu/shaders/spirv_memory.h"
#include "gpu/shaders/spirv_words.h"
#include "ref/abi_world.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define INPUTS                                                                                     \
    (1u << ABI_BIND_RAYS | 1u << ABI_BIND_NODES | 1u << ABI_BIND_ITEMS | 1u << ABI_BIND_TRIS |     \
     1u << ABI_BIND_WORLD)

/* The instruction that makes an id; NULL: there is none. */
static const uint32_t *maker(const uint32_t *word, size_t count, uint32_t op, uint32_t id)
{
    for (size_t i = 5; i < count; i += word[i] >> 16) {
        const bool type = op < OP_VARIABLE;
        if ((word[i] & 0xFFFFu) == op && word[i + (type ? 1 : 2)] == id)
            return word + i;
    }
    return NULL;
}

static uint32_t binding_of(const uint32_t *word, size_t count, uint32_t id)
{
    for (size_t i = 5; i < count; i += word[i] >> 16)
        if ((word[i] & 0xFFFFu) == OP_DECORATE && word[i + 1] == id &&
            word[i + 2] == DECORATION_BINDING)
            return word[i + 3];
    return 32;
}

static uint32_t how_many(const uint32_t *word, size_t count, uint32_t op)
{
    uint32_t out = 0;
    for (size_t i = 5; i < count; i += word[i] >> 16)
        out += (word[i] & 0xFFFFu) == op;
    return out;
}

/* Loads from storage buffers of these bindings; *words: the bindings whose elements are words. */
static uint32_t reads(const uint32_t *word, size_t count, uint32_t bindings, uint32_t *words)
{
    uint32_t out = 0;
    *words = 0;
    for (size_t i = 5; i < count; i += word[i] >> 16) {
        if ((word[i] & 0xFFFFu) != OP_LOAD)
            continue;
        const uint32_t *chain = maker(word, count, OP_ACCESS_CHAIN, word[i + 3]);
        const uint32_t *variable = chain ? maker(word, count, OP_VARIABLE, chain[3]) : NULL;
        const uint32_t at = variable ? binding_of(word, count, variable[2]) : 32;
        if (at > 31 || variable[3] != CLASS_STORAGE_BUFFER || !(bindings >> at & 1))
            continue;
        out++;
        const uint32_t *pointer = maker(word, count, OP_TYPE_POINTER, variable[1]);
        const uint32_t *block = maker(word, count, OP_TYPE_STRUCT, pointer[3]);
        const uint32_t *array = maker(word, count, OP_TYPE_RUNTIME_ARRAY, block[2]);
        if (array && !maker(word, count, OP_TYPE_VECTOR, array[2]))
            *words |= 1u << at;
    }
    return out;
}

static bool may_read(const struct shader *shader)
{
    return strncmp(shader->name, "trace_", 6) == 0 || strncmp(shader->name, "world_", 6) == 0 ||
           strncmp(shader->name, "stackless_", 10) == 0;
}

static void validate(const char *name, const uint32_t *word, size_t count)
{
    struct reason reason;
    const enum status status = compiler_validate(word, count, &reason);
    if (status && status != STATUS_UNSUPPORTED) /* spirv-val is not here: recompiled.sh needs it */
        fail_msg("%s: %s", name, reason.text);
}

/* The arithmetic is that of before, and all of it is still decorated. */
static void same_arithmetic(const struct shader *shader, const uint32_t *word, size_t count)
{
    struct spirv_found before, after;
    struct reason reason;
    assert_int_equal(spirv_look(shader->word, shader->word_count, &before, &reason), 0);
    assert_int_equal(spirv_look(word, (uint32_t)count, &after, &reason), 0);
    assert_int_equal(after.float_ops, before.float_ops);
    assert_int_equal(after.bare, 0);
    assert_int_equal(after.inexact_ext, before.inexact_ext);
    assert_int_equal(after.other_capabilities, before.other_capabilities + 1);
}

static void every_load_becomes_a_fetch(void **state)
{
    (void)state;
    size_t played = 0;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        uint32_t *word, words, wanted, none;
        size_t count;
        struct reason reason;
        if (!may_read(shader))
            continue;
        played++;
        if (spirv_texels(shader->word, shader->word_count, INPUTS, &word, &count, &words, &reason))
            fail_msg("%s: %s", shader->name, reason.text);
        const uint32_t loads = reads(shader->word, shader->word_count, INPUTS, &wanted);
        assert_true(loads > 3);
        assert_int_equal(how_many(word, count, OP_IMAGE_FETCH), loads);
        assert_int_equal(how_many(word, count, OP_TYPE_IMAGE), 1);
        assert_int_equal(reads(word, count, INPUTS, &none), 0);
        assert_int_equal(words, wanted);
        same_arithmetic(shader, word, count);
        validate(shader->name, word, count);
        free(word);
    }
    assert_true(played > 30);
}

/* Of buffers whose elements are floats, which only probes have: a word of a fetch is the float's
 * bits, in the result of the load. */
static void words_that_are_floats_are_their_bits(void **state)
{
    (void)state;
    static const char *const names[] = {"probe_free", "probe_card", "probe_ops"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        const struct shader *shader = shader_find(names[i]);
        uint32_t *word, words, wanted, none;
        size_t count;
        struct reason reason;
        assert_non_null(shader);
        if (spirv_texels(shader->word, shader->word_count, 1, &word, &count, &words, &reason))
            fail_msg("%s: %s", shader->name, reason.text);
        const uint32_t loads = reads(shader->word, shader->word_count, 1, &wanted);
        assert_true(loads > 0);
        assert_int_equal(wanted, 1);
        assert_int_equal(words, wanted);
        assert_int_equal(how_many(word, count, OP_IMAGE_FETCH), loads);
        assert_int_equal(how_many(word, count, OP_BITCAST),
                         how_many(shader->word, shader->word_count, OP_BITCAST) + loads);
        assert_int_equal(reads(word, count, 1, &none), 0);
        validate(shader->name, word, count);
        free(word);
    }
}

/* Loads that name an alignment: that of what is loaded, a quad or one word, and no more. */
static uint32_t aligned_loads(const char *name, const uint32_t *word, size_t count)
{
    uint32_t out = 0;
    for (size_t i = 5; i < count; i += word[i] >> 16) {
        if ((word[i] & 0xFFFFu) != OP_LOAD || word[i] >> 16 == 4)
            continue;
        const uint32_t bytes = maker(word, count, OP_TYPE_VECTOR, word[i + 1]) ? 16 : 4;
        assert_true(word[i] >> 16 == 6 && word[i + 4] == 2);
        if (word[i + 5] != bytes)
            fail_msg("%s: %u bytes are aligned to %u", name, bytes, word[i + 5]);
        out++;
    }
    return out;
}

static void every_load_goes_by_an_address(void **state)
{
    (void)state;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        uint32_t *word, words;
        size_t count;
        struct reason reason;
        if (!may_read(shader))
            continue;
        if (spirv_references(shader->word, shader->word_count, INPUTS, &word, &count, &reason))
            fail_msg("%s: %s", shader->name, reason.text);
        /* Each load is of an address first, and then by it. */
        const uint32_t loads = reads(shader->word, shader->word_count, INPUTS, &words);
        assert_int_equal(how_many(word, count, OP_LOAD),
                         how_many(shader->word, shader->word_count, OP_LOAD) + loads);
        assert_int_equal(aligned_loads(shader->name, word, count), loads);
        assert_int_equal(reads(word, count, INPUTS, &words), loads);
        same_arithmetic(shader, word, count);
        validate(shader->name, word, count);
        free(word);
    }
}

/* A copy of a module that traces, to be spoilt. */
static uint32_t *copy_of(const struct shader *shader)
{
    uint32_t *word = alloc_copy(shader->word, shader->word_count, sizeof *word);
    assert_non_null(word);
    return word;
}

/* Loads of that component of a storage buffer's quads. */
static uint32_t how_many_parts(const uint32_t *word, size_t count, uint32_t part)
{
    uint32_t out = 0;
    for (size_t i = 5; i < count; i += word[i] >> 16) {
        const uint32_t *chain = (word[i] & 0xFFFFu) == OP_LOAD
                                    ? maker(word, count, OP_ACCESS_CHAIN, word[i + 3])
                                    : NULL;
        const uint32_t *variable = chain ? maker(word, count, OP_VARIABLE, chain[3]) : NULL;
        out += variable && variable[3] == CLASS_STORAGE_BUFFER && chain[0] >> 16 == 7 &&
               chain[6] == part;
    }
    return out;
}

static enum status try_both(const uint32_t *word, size_t count, uint32_t bindings, bool texels,
                            struct reason *reason)
{
    uint32_t *out, words;
    size_t out_count;
    enum status status = texels
                             ? spirv_texels(word, count, bindings, &out, &out_count, &words, reason)
                             : spirv_references(word, count, bindings, &out, &out_count, reason);
    assert_true((status == STATUS_OK) == (out != NULL));
    free(out);
    return status;
}

static void what_is_written_is_refused(void **state)
{
    (void)state;
    const struct shader *shader = shader_find("trace_f32");
    static const uint32_t written[] = {ABI_BIND_HITS, ABI_BIND_FLAGS, ABI_BIND_FOUND};
    for (int texels = 0; texels < 2; texels++)
        for (size_t i = 0; i < ARRAY_COUNT(written); i++) {
            struct reason reason;
            assert_int_equal(try_both(shader->word, shader->word_count, INPUTS | 1u << written[i],
                                      texels, &reason),
                             STATUS_UNSUPPORTED);
            assert_non_null(strstr(reason.text, "more than read (instruction 62)"));
        }
}

/* Items, which are words, bound where nodes are, which are quads. */
static void words_and_quads_of_one_binding_are_refused_as_texels_alone(void **state)
{
    (void)state;
    const struct shader *shader = shader_find("trace_f32");
    uint32_t *word = copy_of(shader);
    struct reason reason;
    for (size_t i = 5; i < shader->word_count; i += word[i] >> 16)
        if ((word[i] & 0xFFFFu) == OP_DECORATE && word[i + 2] == DECORATION_BINDING &&
            word[i + 3] == ABI_BIND_ITEMS)
            word[i + 3] = ABI_BIND_NODES;
    assert_int_equal(try_both(word, shader->word_count, INPUTS, true, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "a buffer is read both as words and as quads");
    assert_int_equal(try_both(word, shader->word_count, INPUTS, false, &reason), STATUS_OK);
    free(word);
}

/* Components are those that are asked for, whichever: each in turn is another constant. */
static void components_are_those_asked_for(void **state)
{
    (void)state;
    const struct shader *shader = shader_find("world_f32");
    uint32_t *word = copy_of(shader), played = 0;
    for (size_t at = 5; at < shader->word_count; at += word[at] >> 16) {
        if ((word[at] & 0xFFFFu) != OP_ACCESS_CHAIN || word[at] >> 16 != 7)
            continue;
        uint32_t *made, words, found = 0;
        size_t count;
        struct reason reason;
        const uint32_t before = word[at + 6];
        word[at + 6] = word[at + 4]; /* the number of the member */
        assert_int_equal(
            spirv_texels(word, shader->word_count, INPUTS, &made, &count, &words, &reason), 0);
        for (size_t i = 5; i < count; i += made[i] >> 16)
            found += (made[i] & 0xFFFFu) == OP_EXTRACT_DYNAMIC && made[i + 4] == word[at + 4];
        free(made);
        assert_int_equal(found, how_many_parts(word, shader->word_count, word[at + 4]));
        word[at + 6] = before;
        played += found > 0;
    }
    assert_true(played > 1);
    free(word);
}

/* Whatever the words are: a status, and nothing beyond them is touched (under ASan). */
static void broken_modules_are_refused(void **state)
{
    (void)state;
    const struct shader *shader = shader_find("trace_rf16");
    struct reason reason;
    for (int texels = 0; texels < 2; texels++) {
        for (size_t count = 0; count < shader->word_count; count += 1 + count / 50) {
            uint32_t *word = alloc_copy(shader->word, count ? count : 1, sizeof *word);
            assert_non_null(word);
            const enum status status = try_both(word, count, INPUTS, texels, &reason);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            assert_true(count >= 5 || status == STATUS_INPUT);
            free(word);
        }
        for (size_t at = 0; at < shader->word_count; at += 7) {
            uint32_t *word = copy_of(shader);
            word[at] ^= 1u << (at % 32);
            (void)!try_both(word, shader->word_count, INPUTS, texels, &reason);
            free(word);
        }
    }
}

/* What an engine of that name has its driver read: the module and the bindings. One that reads as
 * ever under another name would have equal bits. */
static void names_have_the_modules_that_they_say(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool texels, references;
    } way[] = {{"raw", false, false},      {"raw:none", false, false},
               {"texel", true, false},     {"texel:raw:none", true, false},
               {"reference", false, true}, {"reference:raw:none", false, true}};
    const struct shader *found = shader_find("trace_f32");
    const struct vk_shader shader = {
        .name = found->name, .word = found->word, .word_count = found->word_count};
    for (size_t i = 0; i < ARRAY_COUNT(way); i++) {
        struct compiler compiler;
        struct compiled made;
        struct reason reason;
        char text[COMPILER_NAME_MOST + 32];
        uint32_t words, wanted;
        const uint32_t loads = reads(found->word, found->word_count, INPUTS, &wanted);
        assert_int_equal(compiler_parse(way[i].name, &compiler, &reason), 0);
        compiler_name(&compiler, text);
        assert_string_equal(text, way[i].name);
        assert_int_equal(compiler_ways(&compiler).texels, way[i].texels ? INPUTS : 0);
        assert_int_equal(compiler_ways(&compiler).references, way[i].references ? INPUTS : 0);
        assert_int_equal(compiler_changes_nothing(&compiler), i == 0);
        assert_int_equal(compiler_run(&compiler, &shader, &made, &reason), 0);
        assert_int_equal(how_many(made.word, made.count, OP_IMAGE_FETCH),
                         way[i].texels ? loads : 0);
        assert_int_equal(how_many(made.word, made.count, OP_LOAD),
                         how_many(found->word, found->word_count, OP_LOAD) +
                             (way[i].references ? loads : 0));
        assert_int_equal(reads(made.word, made.count, INPUTS, &words), way[i].texels ? 0 : loads);
        assert_int_equal(made.words_of, way[i].texels ? wanted : 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_load_becomes_a_fetch),
        cmocka_unit_test(every_load_goes_by_an_address),
        cmocka_unit_test(what_is_written_is_refused),
        cmocka_unit_test(components_are_those_asked_for),
        cmocka_unit_test(words_that_are_floats_are_their_bits),
        cmocka_unit_test(words_and_quads_of_one_binding_are_refused_as_texels_alone),
        cmocka_unit_test(broken_modules_are_refused),
        cmocka_unit_test(names_have_the_modules_that_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
