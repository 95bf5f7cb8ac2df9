/* Memory that runs out while a tree of another program is read and checked: each allocation in turn
 * fails, of each format and way to check, is told in one line, and leaves nothing behind. */
#define _GNU_SOURCE
#include "tests/support/allocations.h"

#include "scenes/scenes.h"
#include "tests/trees/saved.h"

#include "tests/support/each_fails.h"

struct dump_work {
    const char *bytes;
    size_t size;
    const struct scene *scene;
    bool splits;
};

static enum status do_work(const void *of, struct reason *reason)
{
    const struct dump_work *work = of;
    struct tree_dump dump;
    struct dump_report report = {0};
    enum status status = tree_dump_read("t", work->bytes, work->size, DUMP_GUESSED, &dump, reason);
    if (status)
        assert_true(!dump.node && !dump.child && !dump.item && !dump.spec && !dump.scene.vertex);
    dump.splits = dump.splits || work->splits;
    if (!status)
        status = dump_check(&dump, work->scene, 8, true, &report, reason);
    if (status)
        assert_true(!report.fault && report.faults == 0);
    free(report.fault);
    tree_dump_free(&dump);
    return status;
}

/* Some boxes are too small, so that faults are kept. */
static void each_allocation_fails(void **state)
{
    (void)state;
    static struct saved file;
    struct scene needles;
    assert_int_equal(scene_open("needles:n=60", 1, &needles, NULL), STATUS_OK);
    struct dumped d = dumped_make(needles, "median", 3);
    for (uint32_t i = 0; i < d.bvh.node_count; i += 3)
        d.dump.node[i].box.lo[0] = d.bvh.node[i].bounds.lo[0] =
            nextafterf(d.bvh.node[i].bounds.lo[0], INFINITY);
    size_t size;
    d.dump.spec = strdup("needles:n=60");
    char *text = dump_text(&d.dump, &size);
    for (uint32_t i = 0; i < 12; i++) {
        struct dump_work work = {
            .bytes = (const char *)file.bytes, .scene = i & 1 ? &d.scene : NULL, .splits = i & 2};
        if (i / 4 == 0)
            work.bytes = text, work.size = size;
        else if (i / 4 == 1)
            saved_tinybvh(&d.bvh, false, &file), work.size = file.size;
        else
            saved_bvh2(&d.bvh, &file), work.size = file.size;
        assert_true(each_fails("dump", do_work, &work, 1) >= 10);
    }
    free(text);
    dumped_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_fails)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
