/* Laws that hold for the structures of every driver that is read. The files are in a struct
 * lvp_file, whoever wrote them. Includes cmocka.h, whose macros must come last. */
#ifndef TREE_LAWS_H
#define TREE_LAWS_H

#include "tests/driver_trees/lavapipe_file.h"

/* Worlds of every kind of instances; the last one is lvp_two_meshes. */
static const char *const tree_specs[] = {"crowd:n=20",
                                         "placed-turned:count=12",
                                         "placed-mirrored:count=5",
                                         "placed-far:count=7",
                                         "nest:count=9",
                                         "sphere:n=3",
                                         "placed-thin:count=4",
                                         "two meshes"};

static inline struct world tree_world(size_t i)
{
    return i + 1 == ARRAY_COUNT(tree_specs) ? lvp_two_meshes() : lvp_world(tree_specs[i]);
}

/* The world comes again, and nothing is at fault. `format` is that of its trees; bounds of boxes
 * are looser than need be only where `loose` says so. Returns how many inner nodes the top has. */
static inline uint64_t tree_must_be_world(const struct tree_dump *dump, const struct world *world,
                                          const char *format, bool loose)
{
    struct dump_report report = lvp_found(dump);
    const uint64_t inner = report.inner;
    assert_int_equal(dump->tri_count, world->instance_count);
    assert_int_equal(dump->below_count, world->mesh_count);
    assert_int_equal(report.faults, 0);
    assert_int_equal(report.leaves, world->instance_count);
    assert_int_equal(report.nodes, dump->node_count);
    assert_true(loose || report.loose == 0);
    free(report.fault);
    for (size_t i = 0; i < dump->below_count; i++) {
        report = lvp_found(&dump->below[i]);
        assert_string_equal(dump->below[i].format, format);
        assert_int_equal(report.faults, 0);
        assert_int_equal(report.items, dump->below[i].scene.tri_count);
        assert_int_equal(report.judged, report.nodes);
        assert_true(loose || report.loose == 0);
        free(report.fault);
    }
    const struct dump_differences d = lvp_compared(dump, world);
    assert_int_equal(d.instances + d.triangles, 0);
    const struct dump_lacks lacks = lvp_measured(dump);
    assert_int_equal(lacks.judged, world->instance_count);
    assert_int_equal(lacks.small + lacks.sides, 0);
    for (uint32_t i = 0; i < dump->tri_count; i++)
        assert_int_equal(dump->instance[i].number, i);
    return inner;
}

/* A bottom level alone is a tree with its own triangles, those of the world's first mesh. */
static inline void tree_must_be_mesh(const struct tree_dump *dump, const struct world *world)
{
    assert_null(dump->instance);
    assert_int_equal(dump->scene.tri_count, world->mesh[0].scene->tri_count);
    const struct dump_differences d = lvp_compared(dump, world);
    assert_int_equal(d.instances + d.triangles, 0);
}

/* One number of the four is twice in the leaves of the top level, and one in those of its mesh. */
static inline void tree_must_have_doubles(const struct tree_dump *dump)
{
    struct dump_report report = lvp_found(dump);
    char text[DUMP_FAULT_TEXT];
    assert_int_equal(report.count[DUMP_DOUBLED], 1);
    assert_int_equal(dump->tri_count, 3);
    for (size_t i = 0; i < report.fault_count; i++)
        if (report.fault[i].rule == DUMP_DOUBLED)
            assert_non_null(strstr(dump_fault_text(&report.fault[i], text), "instance 1"));
    free(report.fault);
    report = lvp_found(&dump->below[0]);
    assert_int_equal(report.count[DUMP_DOUBLED], 1);
    free(report.fault);
}

/* One triangle of a mesh cannot be hit: its leaf is empty, and that is no fault. */
static inline void tree_must_lack_one(const struct tree_dump *bottom, const struct scene *mesh)
{
    struct dump_report report = lvp_found(bottom);
    assert_int_equal(report.items, mesh->tri_count - 1);
    assert_int_equal(report.empty_leaves, 1);
    assert_int_equal(report.judged, report.nodes - 1); /* of nothing no box is too large */
    assert_int_equal(report.faults, 0);
    free(report.fault);
}

/* The only fault of the tree is that side of that node, which is too small. */
static inline void tree_must_be_small(const struct tree_dump *dump, uint32_t node, unsigned side)
{
    struct dump_report report = lvp_found(dump);
    assert_int_equal(report.faults, 1);
    assert_int_equal(report.fault[0].rule, DUMP_SMALL);
    assert_int_equal(report.fault[0].node, node);
    assert_int_equal(report.fault[0].side, side);
    free(report.fault);
}

static inline void tree_must_refuse(const struct lvp_file *file, const char *rule)
{
    struct tree_dump dump;
    struct reason reason = {""};
    assert_int_equal(lvp_read(file, file->size, &dump, &reason), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        fail_msg("%s, not %s", reason.text, rule);
    assert_true(!dump.node && !dump.below && !dump.instance && !dump.source);
}

/* A file of two meshes that is cut anywhere is refused, but where its top level ends: that is read
 * without trees. `write` writes it anew. */
static inline void tree_must_be_whole(struct lvp_file *file, void (*write)(void))
{
    struct reason reason = {""};
    struct tree_dump dump;
    write();
    for (size_t size = 0; size < file->size; size += size < 256 ? 1 : 61 + size % 2) {
        const unsigned char was = file->bytes[size];
        if (size == file->begin[1])
            continue;
        file->bytes[size] = 0; /* as behind a file that is read */
        assert_int_equal(lvp_read(file, size, &dump, &reason), STATUS_INPUT);
        file->bytes[size] = was;
    }
    file->size = file->begin[1];
    if (lvp_read(file, file->size, &dump, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(dump.below_count, 0);
    assert_int_equal(dump.scene.tri_count, 0);
    for (uint32_t i = 0; i < dump.tri_count; i++)
        assert_true(dump.instance[i].below == DUMP_NO_TREE);
    tree_dump_free(&dump);
    file->size = file->begin[2];
    tree_must_refuse(file, "t: 1 structures below the top level, whose handles name 2");
}

/* The same file with a structure twice, with another top level, and with its end alone. */
static inline void tree_must_be_of_handles(struct lvp_file *file, void (*write)(void))
{
    write();
    const size_t length = file->begin[2] - file->begin[1], whole = file->size;
    memcpy(file->bytes + whole, file->bytes + file->begin[1], length);
    file->size += length;
    tree_must_refuse(file, "one more than the 2 that handles name");
    memcpy(file->bytes + whole, file->bytes, file->begin[1]);
    file->size = whole + file->begin[1];
    tree_must_refuse(file, "one more than the 2 that handles name");
    write();
    memcpy(file->bytes + file->begin[1], file->bytes, file->begin[1]);
    file->size = 2 * file->begin[1];
    tree_must_refuse(file, "a top level below another");
    write();
    memmove(file->bytes, file->bytes + file->begin[1], file->size - file->begin[1]);
    file->size -= file->begin[1];
    tree_must_refuse(file, "bytes behind a bottom level");
}

/* What is wrong with a structure is told with the byte at which it begins, and bytes behind the
 * last one with their number, however few. */
static inline void tree_must_say_where(struct lvp_file *file, void (*write)(void))
{
    char rule[120];
    write();
    const size_t whole = file->size;
    assert_int_equal(file->begin[0], 0);
    for (uint32_t level = 0; level < 3; level++) {
        write();
        lvp_put(file, file->begin[level], 1); /* the driver's UUID */
        snprintf(rule, sizeof rule, "t: structure at byte %zu: ", file->begin[level]);
        tree_must_refuse(file, rule);
    }
    for (size_t behind = 1; behind < 2 * 104; behind++) { /* the heads have 96 and 104 bytes */
        write();
        memset(file->bytes + whole, 0, behind);
        file->size = whole + behind;
        snprintf(rule, sizeof rule, "t: structure at byte %zu: ", whole);
        tree_must_refuse(file, rule);
        write();
        memmove(file->bytes, file->bytes + file->begin[1], whole - file->begin[1]);
        file->size = file->begin[2] - file->begin[1] + behind;
        snprintf(rule, sizeof rule, "t: %zu bytes behind a bottom level", behind);
        tree_must_refuse(file, rule);
    }
}

/* Whatever a word says, reading and checking end. */
static inline void tree_must_end(struct lvp_file *file, const uint32_t *words, size_t count)
{
    const size_t words_of = file->size / 4;
    for (size_t at = 0; at < words_of; at += at < 310 ? 1 : 1 + words_of / 200)
        for (size_t i = 0; i < count; i++) {
            const uint32_t was = lvp_get(file, 4 * at);
            struct tree_dump dump;
            struct reason reason = {""};
            lvp_put(file, 4 * at, words[i]);
            const enum status status = lvp_read(file, file->size, &dump, &reason);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            if (!status) {
                struct dump_report report = lvp_found(&dump);
                free(report.fault);
                if (dump.scene.tri_count && dump.instance)
                    (void)lvp_measured(&dump);
                tree_dump_free(&dump);
            }
            lvp_put(file, 4 * at, was);
        }
}

#endif
