/* Exported Amber scripts: they keep to the documented grammar, as far as they use it, hold the
 * bytes that the engine sends, and expect what is right. No Amber is needed, and none has read
 * them. */
#include "tests/gpu/exported.h"

#include <ctype.h>

#define BUFFERS_MOST 16

/* What a script says, read by the documented grammar, as far as it is used. */
struct amber_script {
    uint32_t *shader;
    size_t shader_words;
    struct {
        char name[32];
        uint32_t *word;
        size_t count;
        int binding; /* -1: push constants, -2: not bound */
    } buffer[BUFFERS_MOST];
    size_t buffer_count;
    uint32_t constant[DISPATCH_CONSTANTS];
    uint32_t groups;
    size_t expected; /* EXPECT lines */
    size_t failed;   /* those that do not hold of what was answered */
    char last[200];  /* the last one of these */
};

static size_t buffer_of(const struct amber_script *script, const char *name)
{
    size_t i = 0;
    while (i < script->buffer_count && strcmp(script->buffer[i].name, name) != 0)
        i++;
    assert_true(i < script->buffer_count);
    return i;
}

/* Reads as Amber does: what lies before END, by strtol, byte after byte, until every character is
 * used; one that is no digit would be read for ever. */
static const char *read_shader(struct amber_script *script, const char *at)
{
    const char *end = strstr(at, "END");
    assert_non_null(end);
    char *data = strndup(at, (size_t)(end - at));
    size_t capacity = strlen(data) / 5 + 1, bytes = 0;
    script->shader = calloc(capacity, sizeof *script->shader);
    for (const char *byte = data; *byte;) {
        char *next;
        unsigned long value = strtoul(byte, &next, 16);
        assert_true(next > byte && value < 256);
        script->shader[bytes / 4] |= (uint32_t)value << 8 * (bytes % 4);
        bytes++;
        byte = next;
    }
    free(data);
    assert_int_equal(bytes % 4, 0);
    script->shader_words = bytes / 4;
    assert_int_equal(end[3], '\n');
    return end + 4;
}

static const char *read_buffer(struct amber_script *script, const char *at)
{
    size_t i = script->buffer_count++;
    unsigned size;
    int used = 0;
    char type[16], what[16];
    assert_true(i < BUFFERS_MOST);
    assert_int_equal(
        sscanf(at, "BUFFER %31s DATA_TYPE %15s %15s%n", script->buffer[i].name, type, what, &used),
        3);
    assert_string_equal(type, "uint32");
    script->buffer[i].binding = -2;
    at += used;
    if (strcmp(what, "SIZE") == 0) {
        assert_int_equal(sscanf(at, " %u FILL 0\n%n", &size, &used), 1);
        script->buffer[i].count = size;
        script->buffer[i].word = calloc(size, sizeof(uint32_t));
        return at + used;
    }
    assert_string_equal(what, "DATA");
    size_t capacity = 0;
    for (;;) {
        at += strspn(at, " \n");
        if (*at == '#')
            at = strchr(at, '\n');
        else if (strncmp(at, "END\n", 4) == 0)
            return at + 4;
        else {
            char *next;
            void *array = script->buffer[i].word;
            assert_int_equal(array_reserve(&array, &capacity, script->buffer[i].count + 1, 4),
                             STATUS_OK);
            script->buffer[i].word = array;
            script->buffer[i].word[script->buffer[i].count++] = (uint32_t)strtoul(at, &next, 0);
            assert_true(next > at && isspace((unsigned char)*next));
            at = next;
        }
    }
}

static const char *read_pipeline(struct amber_script *script, const char *at)
{
    char name[32];
    unsigned a, b;
    int used;
    assert_int_equal(strncmp(at, "PIPELINE compute pipeline\n  ATTACH trace", 40), 0);
    at += 40;
    while (used = 0, sscanf(at, " SPECIALIZE %u AS uint32 %u%n", &a, &b, &used) == 2 && used) {
        assert_true(a < DISPATCH_CONSTANTS);
        script->constant[a] = b;
        at += used;
    }
    while (used = 0, sscanf(at, " BIND BUFFER %31s AS %n", name, &used) == 1 && used) {
        size_t i = buffer_of(script, name);
        at += used;
        if (strncmp(at, "push_constant\n", 14) == 0) {
            script->buffer[i].binding = -1;
            at += 14;
        } else {
            assert_int_equal(sscanf(at, "storage DESCRIPTOR_SET 0 BINDING %u\n%n", &a, &used), 1);
            script->buffer[i].binding = (int)a;
            at += used;
        }
    }
    assert_int_equal(strncmp(at, "END\n", 4), 0);
    return at + 4;
}

static bool holds(const char *comparator, uint32_t a, uint32_t b)
{
    if (strcmp(comparator, "EQ") == 0)
        return a == b;
    if (strcmp(comparator, "NE") == 0)
        return a != b;
    if (strcmp(comparator, "GE") == 0)
        return a >= b;
    assert_string_equal(comparator, "LE");
    return a <= b;
}

/* Looks at what is in the buffers, which the caller has answered. */
static void read_expectation(struct amber_script *script, const char *line)
{
    char name[32], comparator[8];
    const char *whole = line;
    unsigned at;
    int used = 0;
    assert_int_equal(sscanf(line, "EXPECT %31s IDX %u %7s%n", name, &at, comparator, &used), 3);
    size_t i = buffer_of(script, name);
    assert_int_equal(at % 4, 0); /* an offset in bytes */
    script->expected++;
    for (line += used, at /= 4;; at++) {
        line += strspn(line, " ");
        if (*line == '\n' || *line == '#')
            return;
        char *next;
        uint32_t value = (uint32_t)strtoul(line, &next, 10);
        assert_true(next > line && at < script->buffer[i].count);
        if (!holds(comparator, script->buffer[i].word[at], value)) {
            snprintf(script->last, sizeof script->last, "%.*s, but is %u",
                     (int)strcspn(whole, "\n"), whole, script->buffer[i].word[at]);
            script->failed++;
        }
        line = next;
    }
}

static struct amber_script read_script(const char *text, const struct hit *hit, size_t rays)
{
    struct amber_script script = {0};
    assert_int_equal(strncmp(text, "#!amber\n", 8), 0);
    for (const char *at = text; *at;) {
        unsigned groups;
        if (*at == '\n' || *at == '#' ||
            strncmp(at, "DEVICE_FEATURE robustBufferAccess\n", 34) == 0)
            at = strchr(at, '\n') + 1;
        else if (strncmp(at, "SHADER compute trace SPIRV-HEX TARGET_ENV vulkan1.1\n", 52) == 0)
            at = read_shader(&script, at + 52);
        else if (strncmp(at, "BUFFER ", 7) == 0)
            at = read_buffer(&script, at);
        else if (strncmp(at, "PIPELINE ", 9) == 0)
            at = read_pipeline(&script, at);
        else if (sscanf(at, "RUN pipeline %u 1 1", &groups) == 1) {
            size_t hits = buffer_of(&script, "hits"), flags = buffer_of(&script, "flags");
            script.groups = groups;
            assert_int_equal(script.buffer[hits].count, 4 * rays);
            memcpy(script.buffer[hits].word, hit, rays * sizeof *hit);
            for (size_t i = 0; i < rays; i++)
                script.buffer[flags].word[i] = ABI_FLAG_DONE;
            at = strchr(at, '\n') + 1;
        } else if (strncmp(at, "EXPECT ", 7) == 0) {
            assert_true(script.groups > 0);
            read_expectation(&script, at);
            at = strchr(at, '\n') + 1;
        } else {
            fail_msg("not understood: %.60s", at);
        }
    }
    return script;
}

static void free_script(struct amber_script *script)
{
    free(script->shader);
    for (size_t i = 0; i < script->buffer_count; i++)
        free(script->buffer[i].word);
}

static struct amber_script amber_of(const struct finding_file *file, const char *engine,
                                    const char *layout, const struct hit *hit)
{
    struct export_options options = options_of(EXPORT_AMBER, engine, layout);
    options.engines.driver = NO_DRIVER;
    char *text = exported(file, &options, NULL);
    struct amber_script script = read_script(text, hit, file->trial.ray_count);
    free(text);
    return script;
}

static void a_script_has_the_bytes_of_the_engine(void **state)
{
    (void)state;
    static const char *const names[] = {"vulkan", "vulkan_brute"};
    for (size_t e = 0; e < 2; e++) {
        struct finding_file file = generated_file(3 + e, 70, QUERY_CLOSEST);
        struct export_case the = make_case(&file, names[e], "f32");
        struct amber_script script = amber_of(&file, names[e], "f32", the.reference);
        struct export_buffer buffer[DISPATCH_BINDINGS];
        const void *data[DISPATCH_BINDINGS] = {[ABI_BIND_RAYS] = file.trial.ray,
                                               [ABI_BIND_NODES] = the.packed.word,
                                               [ABI_BIND_ITEMS] = the.packed.item};
        export_buffers(&the, buffer);
        assert_int_equal(script.shader_words, the.dispatch.shader->word_count);
        assert_memory_equal(script.shader, the.dispatch.shader->word, 4 * script.shader_words);
        assert_int_equal(script.shader[0], 0x07230203);
        assert_memory_equal(script.constant, the.dispatch.constant, sizeof script.constant);
        assert_int_equal(script.groups, 2);
        assert_int_equal(script.buffer_count, DISPATCH_BINDINGS + 1);
        for (size_t i = 0; i < script.buffer_count; i++) {
            int binding = script.buffer[i].binding;
            if (binding == -1) {
                assert_int_equal(4 * script.buffer[i].count, sizeof(struct push));
                assert_memory_equal(script.buffer[i].word, &the.dispatch.push, sizeof(struct push));
                assert_int_equal(script.buffer[i].word[0], 70);
                continue;
            }
            assert_in_range(binding, 0, DISPATCH_BINDINGS - 1);
            assert_string_equal(script.buffer[i].name, buffer[binding].name);
            assert_int_equal(4 * script.buffer[i].count, buffer[binding].bytes);
            if (data[binding])
                assert_memory_equal(script.buffer[i].word, data[binding],
                                    buffer[binding].data_bytes);
        }
        size_t tris = buffer_of(&script, "triangles");
        for (uint32_t i = 0; i < file.trial.scene.tri_count; i++) {
            float v[3][3];
            scene_tri(&file.trial.scene, i, v);
            assert_memory_equal(script.buffer[tris].word + 9 * i, v, sizeof v);
        }
        free_script(&script);
        export_case_free(&the);
        finding_file_free(&file);
    }
}

/* A script passes where the answers are right, and fails where the bug shows: C has the engine's
 * bits. */
static void a_script_fails_while_the_bug_shows(void **state)
{
    (void)state;
    static const char *const found[] = {"index-shifted", "sentinel", "wrong-item",
                                        "rounded-inward"};
    for (size_t i = 0; i < ARRAY_COUNT(found); i++)
        for (int repaired = 0; repaired < 2; repaired++) {
            struct finding_file file = corpus_file(found[i]);
            const char *layout = repaired ? "rf16" : NULL;
            struct export_case the = make_case(&file, "vulkan", layout);
            struct amber_script script = amber_of(&file, "vulkan", layout, the.reference);
            assert_true(script.expected >= 2);
            assert_int_equal(script.failed == 0, repaired);
            free_script(&script);
            export_case_free(&the);
            finding_file_free(&file);
        }
    for (uint64_t index = 0; index < 30; index++) {
        struct finding_file file = generated_file(index, 60, index % 2 ? QUERY_ANY : QUERY_CLOSEST);
        struct export_case the = make_case(&file, "vulkan_brute", NULL);
        struct amber_script script = amber_of(&file, "vulkan_brute", NULL, the.reference);
        assert_true(script.expected >= 60);
        if (script.failed)
            fail_msg("trial %u: %s", (unsigned)index, script.last);
        free_script(&script);
        export_case_free(&the);
        finding_file_free(&file);
    }
}

static void a_script_of_bits_asks_for_bits(void **state)
{
    (void)state;
    struct finding_file file = generated_file(3, 20, QUERY_CLOSEST);
    file.has_signature = true;
    file.signature = (struct fuzz_signature){
        .layout = layout_find("f32"), .kind = FUZZ_KIND_BITS, .cause = CAUSE_SHADER};
    fuzz_signature_set_engine(&file.signature, "vulkan");
    struct export_case the = make_case(&file, NULL, NULL);
    struct amber_script script = amber_of(&file, NULL, NULL, the.reference);
    assert_int_equal(script.failed, 0);
    free_script(&script);
    uint32_t i = 0;
    while (the.reference[i].prim == ABI_NO_PRIM)
        i++;
    the.reference[i].u = nextafterf(the.reference[i].u, 2.0f);
    script = amber_of(&file, NULL, NULL, the.reference);
    assert_int_equal(script.failed, 1);
    free_script(&script);
    export_case_free(&the);
    finding_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_script_has_the_bytes_of_the_engine),
        cmocka_unit_test(a_script_fails_while_the_bug_shows),
        cmocka_unit_test(a_script_of_bits_asks_for_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
