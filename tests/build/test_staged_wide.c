/* Wide trees in stages in C: laws of what is opened, of numbers and of items, and what a comparison
 * names. */
#include "ref/packed/packed_check.h"
#include "tests/build/wide_fixture.h"

#define WIDTHS 3

static const uint32_t widths[WIDTHS] = {8, 4, 2};

/* --- a walk by calls, areas from floats ------------------------------------------------------- */

struct law {
    const struct staged *staged;
    const struct staged_wide *wide;
    uint32_t width, leaf_most;
    int unit;        /* exponent of the frame's unit */
    uint32_t *place; /* per inner node: how many leaves come before it */
};

static uint32_t count_below(const struct staged *staged, uint32_t link)
{
    return link & STAGED_LEAF ? 1
                              : count_below(staged, staged->child[link][0]) +
                                    count_below(staged, staged->child[link][1]);
}

static uint32_t set_places(const struct law *law, uint32_t link, uint32_t before)
{
    if (link & STAGED_LEAF)
        return before + 1;
    law->place[link] = before;
    before = set_places(law, law->staged->child[link][0], before);
    return set_places(law, law->staged->child[link][1], before);
}

static const uint32_t *box_at(const struct law *law, uint32_t link)
{
    const uint32_t inner = law->staged->count - 1;
    return law->staged->box[link & STAGED_LEAF ? inner + (link & ~STAGED_LEAF) : link];
}

/* Coordinates have at most 29 bits and a sign, so that the area is exact. */
static uint64_t area_at(const struct law *law, uint32_t link)
{
    const uint32_t *box = box_at(law, link);
    uint64_t side[3];
    for (int k = 0; k < 3; k++) {
        double lo = trunc(ldexp((double)float_from_bits(box[k]), -law->unit));
        double hi = trunc(ldexp((double)float_from_bits(box[3 + k]), -law->unit));
        side[k] = (uint64_t)(hi - lo);
    }
    return side[0] * (side[1] + side[2]) + side[1] * side[2];
}

static int unit_of(const struct law *law)
{
    const uint32_t *box = box_at(law, law->staged->root);
    int exponent = -125; /* of the least normal number, below 2^exponent */
    for (int k = 0; k < 6; k++) {
        int own = -125;
        if (float_from_bits(box[k]) != 0)
            (void)frexp((double)float_from_bits(box[k]), &own);
        exponent = own > exponent ? own : exponent;
    }
    return exponent - 29;
}

/* --- the laws --------------------------------------------------------------------------------- */

/* The nodes of the binary tree that a wide node opened: those above its children. */
struct now_open {
    uint32_t link[WIDE_TREE_MOST], count;
};

/* Lists them; the children stand in the order of the binary tree. Returns the next child. */
static uint32_t list_opened(const struct law *law, uint32_t link, uint32_t child, uint32_t end,
                            struct now_open *out)
{
    assert_true(child < end);
    if (law->wide->child[child].link == link)
        return child + 1;
    assert_false(link & STAGED_LEAF);
    assert_true(out->count < law->width - 1);
    out->link[out->count++] = link;
    child = list_opened(law, law->staged->child[link][0], child, end, out);
    return list_opened(law, law->staged->child[link][1], child, end, out);
}

/* Areas shrink on the way down, so what was opened has at least the area of all that was not; of
 * equal ones it is above the other one or comes before it. */
static void check_largest(const struct law *law, const struct now_open *opened,
                          const struct staged_child *child)
{
    uint64_t left = area_at(law, child->link);
    for (uint32_t i = 1; i < opened->count; i++) { /* the root is always opened */
        const uint32_t link = opened->link[i];
        uint64_t area = area_at(law, link);
        assert_true(area >= left);
        if (area == left)
            assert_true(law->place[link] <= law->place[child->link]);
    }
}

static uint32_t check_leaf(const struct law *law, uint32_t link, uint32_t item)
{
    if (!(link & STAGED_LEAF)) {
        item = check_leaf(law, law->staged->child[link][0], item);
        return check_leaf(law, law->staged->child[link][1], item);
    }
    assert_int_equal(law->wide->item[item], law->staged->order[link & ~STAGED_LEAF]);
    return item + 1;
}

/* `root` receives the links of the nodes. */
static void check_nodes(const struct law *law, uint32_t *root)
{
    const struct staged_wide *wide = law->wide;
    uint32_t nodes = 1, items = 0, children = 0;
    root[0] = law->staged->root;
    for (uint32_t n = 0; n < wide->node_count; n++) {
        const struct wide_node *node = &wide->node[n];
        struct now_open opened = {.count = 0};
        assert_true(n < nodes);
        assert_int_equal(node->first, children);
        children += node->count;
        assert_true(node->count <= law->width && (node->count > 1 || n == 0));
        assert_int_equal(list_opened(law, root[n], node->first, children, &opened), children);
        for (uint32_t c = node->first; c < children; c++) {
            const struct staged_child *child = &wide->child[c];
            if (child->count == 0) {
                assert_int_equal(node->count, law->width);
                assert_true(count_below(law->staged, child->link) > law->leaf_most);
                assert_int_equal(child->first, nodes);
                root[nodes++] = child->link;
                check_largest(law, &opened, child);
                continue;
            }
            assert_true(child->count <= law->leaf_most);
            assert_int_equal(child->count, count_below(law->staged, child->link));
            assert_int_equal(child->first, items);
            items = check_leaf(law, child->link, items);
        }
        for (uint32_t i = 0; i < opened.count; i++)
            assert_true(count_below(law->staged, opened.link[i]) > law->leaf_most);
    }
    assert_int_equal(nodes, wide->node_count);
    assert_int_equal(children, wide->child_count);
    assert_int_equal(items, law->staged->count);
    assert_int_equal(items, wide->item_count);
}

static void check_laws(const struct staged *staged, uint32_t width, uint32_t leaf_most)
{
    struct staged_wide wide;
    assert_int_equal(staged_wide_make(staged, width, leaf_most, &wide), STATUS_OK);
    assert_true(wide.node_count <= staged_wide_nodes_most(staged->count, width, leaf_most));
    if (staged->count == 0) {
        assert_int_equal(wide.node_count + wide.child_count + wide.item_count, 0);
        assert_null(wide.node);
        return;
    }
    struct law law = {staged, &wide, width, leaf_most, 0, NULL};
    uint32_t *root = calloc(staged->count, sizeof *root);
    law.place = calloc(staged->count, sizeof *law.place);
    assert_true(root && law.place);
    law.unit = unit_of(&law);
    assert_int_equal(set_places(&law, staged->root, 0), staged->count);
    check_nodes(&law, root);
    free(root);
    free(law.place);
    staged_wide_free(&wide);
}

static void the_largest_is_opened_and_all_is_in_order(void **state)
{
    (void)state;
    for (size_t i = 0; i < WIDE_SCENES; i++)
        for (int k = 0; k < STAGED_KINDS; k++) {
            const char *what;
            struct scene scene = wide_scene(i, &what);
            struct staged staged = wide_staged((enum staged_kind)k, &scene);
            for (uint32_t w = 0; w < WIDTHS; w++)
                for (uint32_t leaf = 1; leaf <= 14; leaf = leaf < 4 ? leaf + 1 : leaf + 5)
                    check_laws(&staged, widths[w], leaf);
            staged_free(&staged);
            scene_free(&scene);
        }
}

/* A node of `full` has eight children; the lowest ones have the fewest triangles that they may. */
static void the_most_nodes_are_reached(void **state)
{
    (void)state;
    assert_int_equal(staged_wide_nodes_most(0, 8, 3), 0);
    assert_int_equal(staged_wide_nodes_most(1, 8, 3), 1);
    assert_int_equal(staged_wide_nodes_most(3, 8, 3), 1);
    assert_int_equal(staged_wide_nodes_most(7, 8, 3), 1);
    assert_int_equal(staged_wide_nodes_most(32, 8, 3), 9); /* eight of four */
    assert_int_equal(staged_wide_nodes_most(2, 2, 1), 1);
    assert_int_equal(staged_wide_nodes_most(100, 2, 1), 99);
    struct scene scene = built_soup(100, 1);
    struct staged staged = wide_staged(STAGED_HPLOC, &scene);
    struct staged_wide wide;
    assert_int_equal(staged_wide_make(&staged, 2, 1, &wide), STATUS_OK);
    assert_int_equal(wide.node_count, 99);
    staged_wide_free(&wide);
    staged_free(&staged);
    scene_free(&scene);
}

/* --- packed ----------------------------------------------------------------------------------- */

static void packed_trees_are_trees_of_the_scene(void **state)
{
    (void)state;
    uint32_t packed_trees = 0;
    for (size_t i = 0; i < WIDE_SCENES; i++)
        for (size_t l = 0; l < ARRAY_COUNT(wide_layouts); l++) {
            const char *what;
            const struct layout *layout = layout_find(wide_layouts[l]);
            struct scene scene = wide_scene(i, &what);
            struct staged staged = wide_staged(STAGED_HPLOC, &scene);
            struct staged_wide wide;
            struct packed packed;
            struct reason reason = {""};
            assert_int_equal(staged_wide_make(&staged, layout->width, layout->leaf_most, &wide),
                             STATUS_OK);
            if (!wide_pack(&wide, &staged, layout, &scene, &packed, &reason)) {
                if (packed_check(&packed, &scene, NULL, &reason))
                    fail_msg("%s, %s: %s", what, layout->name, reason.text);
                assert_int_equal(packed.node_count, wide.node_count);
                assert_int_equal(packed.tri_count, scene.tri_count);
                packed_trees++;
            } else {
                assert_null(packed.word);
                if (!strstr(reason.text, "1.26765"))
                    fail_msg("%s: %s", what, reason.text);
            }
            packed_free(&packed);
            staged_wide_free(&wide);
            staged_free(&staged);
            scene_free(&scene);
        }
    assert_int_equal(packed_trees, (WIDE_SCENES - 3) * ARRAY_COUNT(wide_layouts));
}

/* --- comparing -------------------------------------------------------------------------------- */

static void must_differ(const struct staged_wide *mine, const struct staged_wide *other,
                        const char *stage, uint32_t element, uint64_t count, const char *text)
{
    struct staged_difference at = staged_wide_compare(mine, other);
    assert_non_null(at.stage);
    assert_string_equal(at.stage, stage);
    assert_int_equal(at.element, element);
    assert_int_equal(at.count, count);
    if (!strstr(at.text, text))
        fail_msg("'%s', not '%s'", at.text, text);
}

static void a_difference_is_named_by_stage_and_element(void **state)
{
    (void)state;
    struct scene scene = built_soup(200, 2);
    struct staged staged = wide_staged(STAGED_HPLOC, &scene);
    struct staged_wide mine, other;
    assert_int_equal(staged_wide_make(&staged, 8, 3, &mine), STATUS_OK);
    assert_int_equal(staged_wide_make(&staged, 8, 3, &other), STATUS_OK);
    assert_null(staged_wide_compare(&mine, &other).stage);
    other.item_count -= 2;
    must_differ(&mine, &other, "items", 198, 2, "200 of them, not 198");
    other.item_count += 2;
    mine.item[199] = 7;
    other.item[199] = 8;
    must_differ(&mine, &other, "items", 199, 1, "triangle 7, not triangle 8");
    mine.child[3] = (struct staged_child){STAGED_LEAF | 5, 9, 1};
    other.child[3] = (struct staged_child){17, 6, 0};
    must_differ(&mine, &other, "children", 3, 1, "items 1 from 9 of leaf 5, not node 6 of node 17");
    mine.node[1].count++;
    other.node[2].first++;
    must_differ(&mine, &other, "nodes", 1, 2, "children from 8, not ");
    staged_wide_free(&mine);
    staged_wide_free(&other);
    staged_free(&staged);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_is_opened_and_all_is_in_order),
        cmocka_unit_test(the_most_nodes_are_reached),
        cmocka_unit_test(packed_trees_are_trees_of_the_scene),
        cmocka_unit_test(a_difference_is_named_by_stage_and_element),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
