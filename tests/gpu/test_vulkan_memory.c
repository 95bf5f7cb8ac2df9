/* Memory of the program that runs out on the way to a picture or a hit on a Vulkan device: a status
 * and a reason, with nothing kept (tests/gpu/fake_vulkan.h). */
#define _DEFAULT_SOURCE /* setenv */
#include "tests/support/allocations.h"

#include "tests/gpu/fake_engines.h"

/* What is to be done without one of its allocations. */
struct memory_play {
    const char *name;
    const struct engine *engine; /* NULL: a picture */
    const struct fake_stage *stage;
    bool world; /* of the engine: its worlds */
    struct picture *picture;
    bool brute;
    enum frame_plan plan;
};

static enum status play(const struct memory_play *play, struct reason *reason)
{
    if (play->engine && play->picture)
        return engine_frame_play(play->engine, play->picture, reason);
    if (play->world)
        return world_play(play->engine, play->stage, reason);
    return play->engine ? engine_play(play->engine, play->stage, reason)
                        : frame_play(play->picture, play->brute, play->plan, reason);
}

/* Device extensions that cannot be listed are none. */
static void fail_each(const struct memory_play *what)
{
    for (long n = 0; n < 1000; n++) {
        struct reason reason = {""};
        fake_reset();
        fake.run = what->picture ? all_drawn : all_done;
        atomic_store(&held, 0);
        fail_after(n);
        enum status status = play(what, &reason);
        atomic_store(&until_failure, -1);
        must_be_clean(what->name);
        if (held != 0)
            fail_msg("%s: without allocation %ld %ld others are kept", what->name, n, held);
        if (!has_failed) {
            gpu_must(status, &reason);
            assert_true(n > 5);
            return;
        }
        if (status == STATUS_UNSUPPORTED && strstr(reason.text, "VK_KHR_ray_query"))
            continue;
        if (status != STATUS_MEMORY || !strstr(reason.text, "no memory"))
            fail_msg("%s: without allocation %ld: status %d, '%s'", what->name, n, (int)status,
                     reason.text);
    }
    fail_msg("%s: never ends", what->name);
}

static void engines_on_a_device(void **state)
{
    (void)state;
    struct fake_stage stage = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
        fail_each(&(struct memory_play){
            .name = engine_names[i], .engine = engine_find(engine_names[i]), .stage = &stage});
    for (size_t i = 0; i < ARRAY_COUNT(world_names); i++)
        fail_each(&(struct memory_play){.name = world_names[i],
                                        .engine = engine_find(world_names[i]),
                                        .stage = &stage,
                                        .world = true});
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&stage);
}

static void pictures_on_a_device(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    for (int i = 0; i < 4; i++)
        fail_each(&(struct memory_play){.name = "a picture",
                                        .picture = &p,
                                        .brute = i & 1,
                                        .plan = i & 2 ? FRAME_STEPS : FRAME_WHOLE});
    picture_free(&p);
}

static void pictures_of_engines(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(frame_names); i++)
        fail_each(&(struct memory_play){
            .name = frame_names[i], .engine = engine_find(frame_names[i]), .picture = &p});
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_on_a_device),
        cmocka_unit_test(pictures_on_a_device),
        cmocka_unit_test(pictures_of_engines),
    };
    fake_memory(__real_calloc, __real_free);
    assert_int_equal(unsetenv("RAYDIFF_VALIDATE"), 0); /* the layer is for drivers */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
