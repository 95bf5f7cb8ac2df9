/* Our text of trees: what is written comes again to the bit, and measures of a dump are those of
 * the tree. */
#define _POSIX_C_SOURCE 200809L
#include "tests/trees/dump_fixture.h"

static void must_be_same(const struct tree_dump *a, const struct tree_dump *b)
{
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->child_count, b->child_count);
    assert_int_equal(a->item_count, b->item_count);
    assert_int_equal(a->splits, b->splits);
    assert_int_equal(a->bytes, b->bytes);
    for (size_t i = 0; i < a->node_count; i++) {
        assert_memory_equal(&a->node[i].box, &b->node[i].box, sizeof a->node[i].box);
        assert_int_equal(a->node[i].leaf, b->node[i].leaf);
        assert_int_equal(a->node[i].first, b->node[i].first);
        assert_int_equal(a->node[i].count, b->node[i].count);
    }
    assert_memory_equal(a->child, b->child, a->child_count * sizeof *a->child);
    assert_memory_equal(a->item, b->item, a->item_count * sizeof *a->item);
}

static void must_measure_as(const struct tree_dump *dump, const struct dumped *d)
{
    struct dump_report report = dump_found(dump, &d->scene);
    struct tree_quality quality;
    double overlap;
    assert_int_equal(tree_quality(&d->bvh, &d->scene, &quality, NULL), STATUS_OK);
    assert_int_equal(tree_overlap(&d->bvh, &d->scene, DUMP_OVERLAP_MOST, &overlap), STATUS_OK);
    assert_true(report.sah == quality.sah || !isfinite(quality.sah));
    assert_true(report.overlap == overlap || (isnan(overlap) && isnan(report.overlap)));
    assert_int_equal(report.leaves, quality.stats.leaf_count);
    assert_int_equal(report.nodes, quality.stats.node_count);
    assert_int_equal(report.depth, quality.stats.depth);
    assert_int_equal(report.stack, quality.stats.depth);
    assert_int_equal(report.largest_leaf, quality.stats.largest_leaf);
    assert_int_equal(report.items, d->bvh.prim_count);
    assert_int_equal(report.faults == 0, bvh_check(&d->bvh, &d->scene, NULL) == STATUS_OK);
    free(report.fault);
}

static void dumps_of_our_trees_come_again_and_measure_the_same(void **state)
{
    (void)state;
    static const char *const builder[] = {"median", "sah_sweep", "lbvh", "sbvh", "rtrs"};
    for (size_t i = 0; i < BUILT_SCENES; i++)
        for (size_t b = 0; b < ARRAY_COUNT(builder); b++) {
            const char *what;
            struct scene scene = built_scene(i, &what);
            struct bvh bvh;
            const struct build_options options = {.leaf = 1 + (uint32_t)i % 4};
            const bool builds =
                builder_find(builder[b])->build(&scene, &options, &bvh, NULL) == STATUS_OK;
            bvh_free(&bvh);
            if (!builds) {
                scene_free(&scene);
                continue;
            }
            struct dumped d = dumped_make(scene, builder[b], options.leaf);
            d.dump.bytes = 32 * (uint64_t)i;
            struct tree_dump again = dump_read_again(&d.dump);
            must_be_same(&d.dump, &again);
            must_measure_as(&again, &d);
            tree_dump_free(&again);
            dumped_free(&d);
        }
}

/* Adopts grandchildren of inner nodes at random; the nodes of our tree that it left out are not
 * dumped. */
static struct tree_dump widen(const struct bvh *bvh, struct rng *rng)
{
    uint32_t list[64], *number = calloc(bvh->node_count, sizeof *number), count = 0;
    struct tree_dump wide = {.node = calloc(bvh->node_count, sizeof *wide.node),
                             .child = calloc(2 * (size_t)bvh->node_count, sizeof *wide.child),
                             .item = calloc(bvh->prim_count, sizeof *wide.item)};
    uint32_t *of = calloc(bvh->node_count, sizeof *of); /* node of the tree by number in the dump */
    assert_true(number && of && wide.node && wide.child && wide.item);
    of[count++] = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct bvh_node *node = &bvh->node[of[i]];
        struct dump_node *to = &wide.node[i];
        *to = (struct dump_node){.box = node->bounds, .leaf = node->item_count > 0};
        to->first = (uint32_t)(to->leaf ? wide.item_count : wide.child_count);
        to->count = node->item_count;
        for (uint32_t k = 0; k < node->item_count; k++)
            wide.item[wide.item_count++] = bvh->prim[node->item_first + k];
        if (to->leaf)
            continue;
        list[0] = node->fst;
        list[1] = node->snd;
        to->count = 2;
        for (uint32_t most = 2 + rng_below(rng, 7), turns = 20; to->count < most && turns;
             turns--) {
            const uint32_t at = rng_below(rng, to->count);
            const struct bvh_node *child = &bvh->node[list[at]];
            if (child->item_count)
                continue;
            list[at] = child->fst;
            list[to->count++] = child->snd;
        }
        for (uint32_t k = 0; k < to->count; k++) {
            wide.child[wide.child_count++] = count;
            of[count++] = list[k];
        }
    }
    wide.node_count = count;
    free(of);
    free(number);
    return wide;
}

/* By the definitions, node by node. */
static void measure(const struct tree_dump *dump, uint32_t at, uint64_t waiting, uint32_t depth,
                    struct dump_report *out)
{
    const struct dump_node *node = &dump->node[at];
    out->sah += box_half_area(&node->box) * (node->leaf ? node->count : 1);
    out->leaves += node->leaf;
    out->depth = depth > out->depth ? depth : out->depth;
    out->stack = waiting > out->stack ? waiting : out->stack;
    for (uint32_t k = 0; k < node->count && !node->leaf; k++)
        measure(dump, dump->child[node->first + k], waiting + node->count - 1, depth + 1, out);
}

static void wide_trees_measure_as_defined(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 0);
    for (uint32_t turn = 0; turn < 60; turn++) {
        struct dumped d = dumped_make(built_soup(1 + rng_below(&rng, 400), turn), "sah_binned", 2);
        struct tree_dump wide = widen(&d.bvh, &rng), again = dump_read_again(&wide);
        struct dump_report report = dump_found(&again, &d.scene), want = {0};
        must_be_same(&wide, &again);
        measure(&wide, 0, 0, 0, &want);
        assert_int_equal(report.faults, 0);
        assert_int_equal(report.loose, 0);
        assert_int_equal(report.judged, wide.node_count);
        assert_int_equal(report.leaves, want.leaves);
        assert_int_equal(report.depth, want.depth);
        assert_int_equal(report.stack, want.stack);
        assert_true(fabs(report.sah * box_half_area(&wide.node[0].box) - want.sah) <=
                    1e-12 * want.sah);
        assert_true(report.sah_tight == report.sah);
        free(report.fault);
        tree_dump_free(&again);
        tree_dump_free(&wide);
        dumped_free(&d);
    }
}

/* Three triangles, the first apart from the others, then within the box of both. As children of the
 * root they lack the node of the second and third, and what that meets of the first. */
static void overlap_of_a_wide_tree_lacks_that_of_nodes_left_out(void **state)
{
    (void)state;
    for (int within = 0; within < 2; within++) {
        struct scene scene = trees_grid(3);
        for (uint32_t i = 0; i < 9; i++) /* the first and the last change places */
            scene.vertex[i] += i % 3 == 0 ? (within ? 0.25f : 1) : 0;
        for (uint32_t i = 9; i < 18; i++)
            scene.vertex[i] -= i % 3 == 0 && within ? 0.25f : 0;
        struct dumped d = dumped_make(scene, "median", 1);
        assert_int_equal(d.bvh.node_count, 5);
        const struct bvh_node *root = &d.bvh.node[0];
        const bool left = d.bvh.node[root->fst].item_count == 0;
        const struct bvh_node *inner = &d.bvh.node[left ? root->fst : root->snd];
        uint32_t child[3] = {left ? root->snd : root->fst, inner->fst, inner->snd};
        struct dump_node node[5];
        memcpy(node, d.dump.node, sizeof node);
        node[0].first = 0;
        node[0].count = 3;
        struct tree_dump wide = d.dump;
        wide.node = node;
        wide.child = child;
        wide.child_count = 3;
        wide.holes = true; /* the inner node stays in its place */
        struct dump_report binary = dump_found(&d.dump, &d.scene);
        struct dump_report three = dump_found(&wide, &d.scene);
        const uint32_t alone = d.bvh.prim[d.bvh.node[child[0]].item_first];
        const struct box box = scene_tri_bounds(&d.scene, alone);
        const bool meets = box_contains_box(&inner->bounds, &box);
        assert_int_equal(three.faults, 0);
        assert_true(fabs(binary.overlap - three.overlap - (meets ? 1.0 / 3 : 0)) < 1e-12);
        free(binary.fault);
        free(three.fault);
        dumped_free(&d);
    }
}

static void triangles_and_names_of_scenes_come_again(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(30, 3), "median", 2);
    struct scene scene = d.scene;
    d.dump.scene = scene;
    struct tree_dump again = dump_read_again(&d.dump);
    d.dump.scene = (struct scene){0};
    assert_int_equal(again.scene.tri_count, 30);
    assert_true(again.tri_known && again.tri_count == 30 && !again.spec);
    assert_memory_equal(again.scene.vertex, scene.vertex,
                        3 * sizeof(float) * (size_t)scene.vertex_count);
    assert_memory_equal(again.scene.index, scene.index, 3 * sizeof(uint32_t) * 30);
    assert_int_equal(dump_faults(&again, &again.scene), 0);
    tree_dump_free(&again);
    d.dump.spec = strdup("soup:n=30,seed=3 and more");
    again = dump_read_again(&d.dump);
    assert_string_equal(again.spec, "soup:n=30,seed=3 and more");
    assert_int_equal(again.scene.tri_count, 0);
    tree_dump_free(&again);
    dumped_free(&d);
}

static struct tree_dump read_text(const char *text)
{
    struct tree_dump dump;
    struct reason reason = {""};
    if (tree_dump_read("t", text, strlen(text), DUMP_GUESSED, &dump, &reason))
        fail_msg("%s", reason.text);
    return dump;
}

/* As printf writes floats; comments, blank lines and line ends of other systems. */
static void numbers_of_all_forms(void **state)
{
    (void)state;
    struct tree_dump dump =
        read_text("raydiff tree 1 # by hand\r\n\r\n# none\n  leaf -0x1p-149 1e-3 -inf  inf 0.1 "
                  "-nan 7 8\nleaf nan nan(ind) nan:0x7fc00001 0 -0 0x1.fffffep+127\nend");
    const float *lo = dump.node[0].box.lo, *hi = dump.node[0].box.hi;
    assert_int_equal(dump.node_count, 2);
    assert_true(lo[0] == -0x1p-149f && lo[1] == 1e-3f && lo[2] == -INFINITY);
    assert_true(hi[0] == INFINITY && hi[1] == 0.1f && isnan(hi[2]));
    assert_int_equal(dump.node[0].count, 2);
    assert_int_equal(dump.item[1], 8);
    assert_true(isnan(dump.node[1].box.lo[0]) && isnan(dump.node[1].box.lo[1]));
    assert_int_equal(float_bits(dump.node[1].box.lo[2]), 0x7fc00001);
    assert_int_equal(float_bits(dump.node[1].box.hi[1]), 0x80000000);
    assert_true(dump.node[1].leaf && dump.node[1].count == 0);
    tree_dump_free(&dump);
}

static void what_is_refused_has_its_line_and_rule(void **state)
{
    (void)state;
    static const struct {
        const char *text, *reason;
    } tries[] = {
        {"raydiff tree 2\nend\n", "t:1: version '2'; this reads version 1"},
        {"raydiff tree 11\nend\n", "t:1: version '11'; this reads version 1"},
        {"raydiff tree 1\nend\n", "t: no node, so no root"},
        {"raydiff tree 1\nleaf 0 0 0 1 1 1 0\n", "t:3: is cut short: no line 'end'"},
        {"raydiff tree 1\nleaf 0 0 0 1 1\nend\n", "t:2: most z: end of line is not a number"},
        {"raydiff tree 1\nleaf 0 0 0x 1 1 1\nend\n", "t:2: least z: '0x' is not "},
        {"raydiff tree 1\nleaf 0 0 0x1.0000001p+0 1 1 1\nend\n",
         "t:2: least z: '0x1.0000001p+0' is not exactly a 32-bit float"},
        {"raydiff tree 1\nleaf 0 0 0 1 1 1 -1\nend\n",
         "t:2: triangle: not a whole number from 0 to 4294967295"},
        {"raydiff tree 1\nnode 0 0 0 1 1 1 1 4294967296\nend\n",
         "t:2: child: not a whole number from 0 to 4294967295"},
        {"raydiff tree 1\nnode 0 0 0 1 1 1 1 x\nend\n", "t:2: child: 'x' is not a whole number"},
        {"raydiff tree 1\nsplits 1\nend\n", "t:2: '1' after the line's last value"},
        {"raydiff tree 1\nbox 1\nend\n", "t:2: 'box': a line is scene, vertex, triangle, splits,"},
        {"raydiff tree 1\nleaf 0 0 0 1 1 1\nend\nend\n", "t:4: a line after 'end'"},
        {"raydiff tree 1\nscene a\nscene b\nend\n", "t:3: a second scene"},
        {"raydiff tree 1\nscene # a\nend\n", "t:2: scene: no name"},
        {"raydiff tree 1\nscene a\033b\nend\n", "t:2: scene: a byte that is no letter"},
        {"raydiff tree 1\nvertex 0 inf 0\nend\n", "t:2: a vertex that is not finite"},
        {"raydiff tree 1\nbytes -1\nend\n", "t:2: bytes: below 0"},
        {"raydiff tree 1\nvertex 0 0 0\ntriangle 0 0 1\nleaf 0 0 0 1 1 1 0\nend\n",
         "t: triangle 0"},
        {"raydiff tree 1\nscene a\nvertex 0 0 0\nend\n", "t: has vertices and names a scene"},
        {"raydiff trees 1\n", "t: no tree of a known format"},
        {"", "t: no tree of a known format"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
        struct tree_dump dump;
        struct reason reason = {""};
        assert_int_equal(
            tree_dump_read("t", tries[i].text, strlen(tries[i].text), DUMP_GUESSED, &dump, &reason),
            STATUS_INPUT);
        if (strncmp(reason.text, tries[i].reason, strlen(tries[i].reason)) != 0)
            fail_msg("%s, not %s", reason.text, tries[i].reason);
        assert_null(dump.node);
    }
}

/* A line of each kind, and what is read of all. */
static const char *const each_line[] = {"raydiff tree 1",
                                        "splits",
                                        "bytes 96",
                                        "vertex 0 0 0",
                                        "vertex 1 0 0",
                                        "vertex 0 1 0",
                                        "triangle 0 1 2",
                                        "node 0 0 0 1 1 0 1 2",
                                        "leaf 0 0 0 1 1 0 0",
                                        "leaf 0 0 0 1 1 0",
                                        "end"};

/* What is behind the values of a line, whichever, is refused with the line and the word; a comment
 * or blanks there change nothing, nor do lines without a word anywhere. */
static void a_line_has_its_values_and_no_more(void **state)
{
    (void)state;
    static const char *const behind[] = {" x", "\t7x y", " # x", "\t \t", "\n\n# x\n"};
    char all[600];
    for (size_t b = 0; b < ARRAY_COUNT(behind); b++)
        for (size_t line = 0; line < ARRAY_COUNT(each_line); line++) {
            struct tree_dump dump;
            struct reason reason = {""};
            char want[64], *at = all;
            for (size_t i = 0; i < ARRAY_COUNT(each_line); i++)
                at += sprintf(at, "%s%s\n", each_line[i], i == line ? behind[b] : "");
            const enum status status =
                tree_dump_read("t", all, strlen(all), DUMP_GUESSED, &dump, &reason);
            assert_int_equal(status, b < 2 ? STATUS_INPUT : STATUS_OK);
            snprintf(want, sizeof want, "t:%zu: ", line + 1);
            if (status && (strncmp(reason.text, want, strlen(want)) != 0 ||
                           !strstr(reason.text, b ? "'7x'" : "'x'")))
                fail_msg("%s: %s", each_line[line], reason.text);
            if (status)
                continue;
            assert_int_equal(dump.node_count, 3);
            assert_true(dump.item_count == 1 && dump.child_count == 2);
            assert_true(dump.splits && dump.bytes == 96 && dump.scene.tri_count == 1);
            tree_dump_free(&dump);
        }
}

static void a_text_that_is_cut_anywhere_is_refused(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(12, 3), "median", 2);
    size_t size;
    char *text = dump_text(&d.dump, &size);
    for (size_t cut = 0; cut + 1 < size; cut++) { /* without its last line end it is whole */
        const char kept = text[cut];
        struct tree_dump dump;
        text[cut] = '\0';
        assert_int_equal(tree_dump_read("t", text, cut, DUMP_GUESSED, &dump, NULL), STATUS_INPUT);
        text[cut] = kept;
    }
    free(text);
    dumped_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dumps_of_our_trees_come_again_and_measure_the_same),
        cmocka_unit_test(wide_trees_measure_as_defined),
        cmocka_unit_test(overlap_of_a_wide_tree_lacks_that_of_nodes_left_out),
        cmocka_unit_test(triangles_and_names_of_scenes_come_again),
        cmocka_unit_test(numbers_of_all_forms),
        cmocka_unit_test(what_is_refused_has_its_line_and_rule),
        cmocka_unit_test(a_line_has_its_values_and_no_more),
        cmocka_unit_test(a_text_that_is_cut_anywhere_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
