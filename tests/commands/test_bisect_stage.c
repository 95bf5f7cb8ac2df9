/* What a stage of raydiff bisect notes of a play: the shader that the engine used, with all of its
 * constants. Modules are made of it: where one is missing, another shader is bisected. */
#define _GNU_SOURCE
#include "cmd/bisect/cmd_bisect.h"

#include "gpu/trace/dispatch.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

/* What is played, each with a constant that no other has. */
static const struct played {
    const char *engine, *layout, *store, *box, *tri;
    enum query query;
} played[] = {
    {"vulkan", "f32", "indexed", "robust", "mt", QUERY_CLOSEST},
    {"vulkan", "f32", "indexed", "watertight", "woop", QUERY_ANY},
    {"vulkan", "bvh4_u8_node", "indexed", "robust", "mt", QUERY_CLOSEST},
    {"vulkan", "bvh4_u8_scene", "indexed", "robust", "mt", QUERY_CLOSEST},
    {"vulkan", "f32", "compact", "robust", "mt", QUERY_ANY},
    {"vulkan_brute", NULL, "indexed", "robust", "pluecker", QUERY_CLOSEST},
};

static struct bisect_options options_of(const struct played *of)
{
    return (struct bisect_options){.bad = "raw:none",
                                   .good = "raw",
                                   .engine = engine_find(of->engine),
                                   .layout = of->layout ? layout_find(of->layout) : NULL,
                                   .store = tri_store_find(of->store),
                                   .builder = builder_find("median"),
                                   .build = build_options_default(),
                                   .box = box_test_find(of->box),
                                   .tri = tri_test_find(of->tri),
                                   .query = of->query,
                                   .rays = ray_sets[0],
                                   .count = 20,
                                   .seconds = 60,
                                   .engines = engine_options_default()};
}

static void a_stage_knows_the_shader_that_was_used(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(played); i++) {
        struct reason reason = {""};
        struct bisect_options o = options_of(&played[i]);
        struct bisect_subject subject;
        struct bisect_stage stage;
        struct bisect_answers answers;
        struct dispatch want;
        enum status status = bisect_subject_open(&o, "soup:n=40", &subject, &reason);
        if (!status)
            status = bisect_stage_open(&o, &subject, &stage, &reason);
        if (!status)
            status = bisect_stage_play(&stage, NULL, 0, false, &answers, &reason);
        if (status == STATUS_UNSUPPORTED)
            skip();
        if (status)
            fail_msg("%s", reason.text);
        const struct job job = {.scene = &subject.scene,
                                .packed = o.layout ? &stage.match.packed : NULL,
                                .box = o.box,
                                .tri = o.tri,
                                .query = o.query};
        if (o.layout)
            assert_int_equal(dispatch_tree(&job, ABI_WORKGROUP, &want, &reason), STATUS_OK);
        else
            want = dispatch_brute(&job, ABI_WORKGROUP);
        const struct vk_shader shader = dispatch_shader(&want);
        assert_string_equal(stage.shader.name, shader.name);
        assert_ptr_equal(stage.shader.word, shader.word);
        assert_int_equal(stage.shader.word_count, shader.word_count);
        assert_int_equal(stage.shader.constant_count, shader.constant_count);
        assert_memory_equal(stage.shader.constant, shader.constant,
                            shader.constant_count * sizeof *shader.constant);
        answers_free(&answers);
        bisect_stage_close(&stage);
        bisect_subject_free(&subject);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stage_knows_the_shader_that_was_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
