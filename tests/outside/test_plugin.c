/* What a layout from outside says is believed only after a look, and every lie is told by the
 * record; the text of its shader names its own lines. */
#include "ref/outside/plugin_guard.h"
#include "gpu/shaders/glsl_text.h"
#include "gpu/shaders/shaders.h"

static unsigned lie; /* enum lie */
#define LIE lie
#include "tests/peers/plugin_liar.c"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/outside/plugin_stand.h"

#include <string.h>

static int stand_make(void **state)
{
    return stand_open(state, "liar");
}

static void plugin_that_lies_is_refused_by_the_record(void **state)
{
    static const struct lie_case cases[] = {
        {LIE_HONEST, NULL, PACKED_SOUND},
        {LIE_ULP, "liar: record 334: x bounds", PACKED_BOUND},
        {LIE_CHILD, "liar: record 0: child 1 is reference 340 of 335", PACKED_REFERENCE},
        {LIE_LOST, "liar: triangle 151 is in no leaf", PACKED_LOST},
        {LIE_TWICE, "liar: record 334: item slot 511 names triangle 151 a second time",
         PACKED_TWICE},
        {LIE_SIZE, "liar: pack() was given 335 records and 512 items, and returned 1340 and 512",
         PACKED_RESULT},
        {LIE_FEWER, "was given 335 records and 512 items, and returned 334 and 512", PACKED_RESULT},
        {LIE_ITEMS, "was given 335 records and 512 items, and returned 335 and 513", PACKED_RESULT},
        {LIE_WORDS, "returned 335 and 512 in other arrays", PACKED_RESULT},
        {LIE_PLACES, "returned 335 and 512 in other arrays", PACKED_RESULT},
        {LIE_CYCLE, "liar: record 0 is reached more than once", PACKED_REFERENCE},
        {LIE_NAN, "liar: record 334: x bounds", PACKED_BOUND},
        {LIE_CHILDREN, "liar: record 1: 9 children, 2 at most", PACKED_RECORD},
        {LIE_TRIANGLE, "names triangle 1073741824 of 512", PACKED_ITEM},
        {LIE_LEAF, "liar: record 334: a leaf without items", PACKED_RECORD},
        {LIE_ROOT, "liar: the root is record 335 of 335", PACKED_REFERENCE},
        {LIE_ONE, "liar: record 0: one child, not two", PACKED_RECORD},
        {LIE_NOTHING, "liar: pack() asked for no records", PACKED_RESULT},
        {LIE_CODE, "liar: pack() returned 99", PACKED_RESULT},
        {LIE_AGAIN, NULL, PACKED_SOUND},
    };
    stand_hears(*state, &lie, LIE_HONEST, cases, ARRAY_COUNT(cases));
}

static void plugin_limit_is_a_limit(void **state)
{
    struct stand *s = *state;
    struct packed packed;
    struct reason reason = {""};
    lie = LIE_LIMIT;
    assert_int_equal(packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason), STATUS_LIMIT);
    lie = LIE_HONEST;
    assert_string_equal(reason.text, "liar: at most 3 nodes, this tree has 335");
}

/* After packing nothing holds a plugin to what it said: its references stay in range all the same.
 */
static void plugin_references_are_dropped_where_out_of_range(void **state)
{
    struct stand *s = *state;
    struct packed packed;
    struct reason reason;
    struct wide node;
    assert_int_equal(packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason), STATUS_OK);
    s->layout->load(&packed, 0, &node);
    assert_int_equal(node.child_count, 2);
    packed.word[6] = packed.ref_count;
    s->layout->load(&packed, 0, &node);
    assert_int_equal(node.child_count, 0);
    assert_int_equal(s->layout->item(&packed, packed.item_count), ABI_NO_PRIM);
    packed_free(&packed);
}

static void plugin_that_dies_is_a_status(void **state)
{
    static const struct {
        enum lie lie;
        enum status status;
        bool hung;
        const char *says;
    } cases[] = {
        {LIE_CRASH, STATUS_DEVICE, false, "liar: crashed while packing: "},
        {LIE_ABORT, STATUS_DEVICE, false, "liar: crashed while packing: "},
        {LIE_EXIT, STATUS_DEVICE, false, "liar: crashed while packing: ended itself with code"},
        {LIE_HANG, STATUS_DEVICE, true, "liar: hung while packing: no end after 200 ms"},
        {LIE_EXIT, STATUS_DEVICE, false, "liar: crashed while packing: ended itself with code"},
        {LIE_ULP, STATUS_INPUT, false, "liar: record 334: x bounds"},
        {LIE_HONEST, STATUS_OK, false, ""},
    };
    struct stand *s = *state;
    struct packed here;
    struct reason reason = {""};
    assert_int_equal(packed_make(s->layout, &s->bvh, &s->scene, &here, &reason), STATUS_OK);
    plugin_pack_with(plugin_pack_guarded);
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct packed packed;
        lie = cases[i].lie;
        plugin_limits(lie == LIE_HANG ? 200 : 0, 0);
        reason.text[0] = '\0';
        enum status status = packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason);
        if (status != cases[i].status || !strstr(reason.text, cases[i].says))
            fail_msg("lie %d: %s: %s", (int)lie, status_text(status), reason.text);
        if (status == STATUS_DEVICE)
            assert_int_equal(plugin_hung(), cases[i].hung);
        assert_int_equal(plugin_rule(), lie == LIE_ULP ? PACKED_BOUND : PACKED_SOUND);
        if (status == STATUS_OK) { /* the same bytes as from here */
            assert_int_equal(packed.word_count, here.word_count);
            assert_memory_equal(packed.word, here.word, 4 * (size_t)here.word_count);
            assert_memory_equal(packed.item, here.item, 4 * (size_t)here.item_count);
            assert_int_equal(packed.stack_need, here.stack_need);
        }
        packed_free(&packed);
    }
    plugin_pack_with(plugin_pack);
    packed_free(&here);
}

/* Boxes that the tree itself has too small are not the plugin's. */
static void plugin_boxes_are_excused_with_the_trees(void **state)
{
    struct stand *s = *state;
    struct packed packed;
    struct reason reason;
    float *bound = &s->bvh.node[s->bvh.node_count - 1].bounds.hi[0], was = *bound;
    *bound = nextafterf(was, -INFINITY);
    enum status status = packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason);
    *bound = was;
    packed_free(&packed);
    assert_int_equal(status, STATUS_OK);
}

static void plugin_of_another_version_is_refused(void **state)
{
    (void)state;
    static const struct {
        enum lie lie;
        const char *says;
    } cases[] = {{LIE_VERSION, "version 2 of"}, {LIE_WIDTH, "width 3 is not 2, 4 or 8"}};
    struct reason reason;
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        lie = cases[i].lie;
        assert_int_equal(plugin_check("x.so", raydiff_plugin(), &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, cases[i].says));
    }
    lie = LIE_HONEST;
    struct raydiff_plugin plugin = *raydiff_plugin();
    const struct layout *layout;
    plugin.name = "f32";
    assert_int_equal(plugin_layout_add("x.so", &plugin, &layout, &reason), STATUS_INPUT);
    plugin.name = "a/b";
    assert_int_equal(plugin_check("x.so", &plugin, &reason), STATUS_INPUT);
    plugin.name = "sixteen_letters_";
    assert_int_equal(plugin_check("x.so", &plugin, &reason), STATUS_INPUT);
    plugin.name = "fine";
    plugin.node_bytes = 24;
    assert_int_equal(plugin_check("x.so", &plugin, &reason), STATUS_INPUT);
    plugin.node_bytes = 32;
    plugin.box = NULL;
    assert_int_equal(plugin_check("x.so", &plugin, &reason), STATUS_INPUT);
    plugin.width = 4;
    assert_int_equal(plugin_check("x.so", &plugin, &reason), STATUS_OK);
}

/* --- the shader's text -------------------------------------------------------------------------
 */

static enum status read_made_up(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    static const struct {
        const char *path, *text;
    } files[] = {{"a/mine.glsl", "#include \"slab.glsl\"\n#include \"part.glsl\"\nLAST\n"},
                 {"a/part.glsl", "PART\n"},
                 {"a/round.glsl", "#include \"round.glsl\"\n"}};
    for (size_t i = 0; i < ARRAY_COUNT(files); i++)
        if (strcmp(files[i].path, path) == 0) {
            *size = strlen(files[i].text);
            *bytes = malloc(*size + 1);
            assert_non_null(*bytes);
            memcpy(*bytes, files[i].text, *size + 1);
            return STATUS_OK;
        }
    *bytes = NULL;
    snprintf(reason->text, sizeof reason->text, "%s: is not there", path);
    return STATUS_INPUT;
}

static void shader_text_names_lines_and_files(void **state)
{
    (void)state;
    struct glsl_text text;
    struct reason reason;
    assert_int_equal(glsl_text_make("a/mine.glsl", GLSL_TRACE, read_made_up, &text, &reason),
                     STATUS_OK);
    assert_ptr_equal(strstr(text.text, "#version 450\n"), text.text);
    assert_non_null(strstr(text.text, "PART\n#line 3 0\nLAST\n"));
    assert_non_null(strstr(text.text, "slab_watertight(")); /* slab.glsl */
    assert_non_null(strstr(text.text, "step_leaf("));       /* walk.glsl, of trace.glsl */
    assert_null(strstr(text.text, "#include \""));
    (void)glsl_text_blame(&text, "WARNING: x\nERROR: 0:3: 'LAST' : unknown\nERROR: 2", &reason);
    assert_string_equal(reason.text, "a/mine.glsl:3: 'LAST' : unknown");
    (void)glsl_text_blame(&text, "ERROR: no entry", &reason);
    assert_string_equal(reason.text, "a/mine.glsl: no entry");
    glsl_text_free(&text);
    assert_int_equal(glsl_text_make("a/round.glsl", GLSL_TRACE, read_made_up, &text, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "include each other"));
    assert_int_equal(glsl_text_make("a/none.glsl", GLSL_RENDER, read_made_up, &text, &reason),
                     STATUS_INPUT);
}

/* A module as a compiler leaves it: a decoration of ours is made one of another id, so that an
 * operation is bare. */
static void shader_from_outside_is_pinned(void **state)
{
    (void)state;
    const struct shader *from = shader_find("trace_f32");
    struct reason reason;
    uint32_t *word = malloc(sizeof *word * from->word_count), bared = 0;
    assert_non_null(word);
    memcpy(word, from->word, sizeof *word * from->word_count);
    for (uint32_t at = 5; at < from->word_count && !bared; at += word[at] >> 16)
        if (word[at] == (3u << 16 | 71u) && word[at + 2] == 42u)
            word[at + 1] = bared = 1;
    assert_int_equal(bared, 1);
    assert_int_equal(shader_add("liar", GLSL_TRACE, "x.glsl", word, from->word_count, &reason),
                     STATUS_OK);
    free(word);
    const struct shader *made = shader_find("trace_liar");
    assert_non_null(made);
    assert_int_equal(made->word_count, from->word_count);
    assert_int_equal(shader_add("liar", GLSL_TRACE, "x.glsl", from->word, 3, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "x.glsl: word 0"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plugin_that_lies_is_refused_by_the_record),
        cmocka_unit_test(plugin_limit_is_a_limit),
        cmocka_unit_test(plugin_references_are_dropped_where_out_of_range),
        cmocka_unit_test(plugin_that_dies_is_a_status),
        cmocka_unit_test(plugin_boxes_are_excused_with_the_trees),
        cmocka_unit_test(plugin_of_another_version_is_refused),
        cmocka_unit_test(shader_text_names_lines_and_files),
        cmocka_unit_test(shader_from_outside_is_pinned),
    };
    return cmocka_run_group_tests(tests, stand_make, stand_free);
}
