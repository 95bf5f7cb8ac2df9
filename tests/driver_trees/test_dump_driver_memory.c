/* Memory that runs out while a driver's structures are read, checked, measured and compared: each
 * allocation in turn fails, is told in one line, and leaves nothing behind. */
#include "tests/support/allocations.h"

#include "tests/driver_trees/radv_file.h"
#include "tests/driver_trees/tree_laws.h"

#include "tests/support/each_fails.h"

struct driver_work {
    const struct lvp_file *file;
    const struct world *world;
    bool small; /* boxes of instances lack something */
};

static enum status do_all(const void *of, struct reason *reason)
{
    const struct driver_work *work = of;
    struct tree_dump dump;
    struct dump_report report = {0};
    struct dump_lacks lacks = {0};
    struct dump_differences differences;
    enum status status = lvp_read(work->file, work->file->size, &dump, reason);
    if (status)
        assert_true(!dump.node && !dump.child && !dump.item && !dump.below && !dump.instance &&
                    !dump.source && !dump.scene.vertex);
    if (!status)
        status = dump_check(&dump, &dump.scene, 8, true, &report, reason);
    if (!status && dump.instance) {
        status = dump_measure(&dump, &lacks, reason);
        assert_true(status ? !lacks.side && lacks.sides == 0 : lacks.sides > 0 || !work->small);
    }
    if (!status)
        status = dump_compare(&dump, work->world, &differences, reason);
    free(lacks.side);
    free(report.fault);
    tree_dump_free(&dump);
    return status;
}

/* Some boxes of instances are points, which lack something on all sides. */
static void each_allocation_fails(void **state)
{
    (void)state;
    static struct lvp_file lavapipe;
    static struct rdv_file radv;
    struct world world = lvp_two_meshes(), mesh = lvp_world("sphere:n=1");
    struct box box[5];
    struct driver_work work = {&lavapipe, &world, true};
    assert_int_equal(world.instance_count, ARRAY_COUNT(box));
    for (uint32_t i = 0; i < ARRAY_COUNT(box); i++)
        for (int k = 0; k < 3; k++)
            box[i].lo[k] = box[i].hi[k] = world.instance[i].m[k][3];
    lvp_write(&lavapipe, &world, box);
    assert_true(each_fails("lavapipe", do_all, &work, 1) > 30);
    work.file = &radv.raw;
    work.small = false;
    for (int halves = 0; halves < 2; halves++) {
        rdv_write(&radv, &world, halves);
        work.world = &world;
        assert_true(each_fails("radv", do_all, &work, 1) > 30);
        rdv_write_mesh(&radv, &mesh, halves);
        work.world = &mesh;
        assert_true(each_fails("a mesh of radv", do_all, &work, 1) > 10);
    }
    world_free(&world);
    world_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_fails)};
    return cmocka_run_group_tests_name("dump_driver_memory", tests, NULL, NULL);
}
