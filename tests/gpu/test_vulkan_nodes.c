/* What the shaders of the layouts decode, node by node, is what C decodes: bounds by bits, in the
 * order in which rays of every octant meet them, kinds, children, numbers of items and items. */
#include "ref/base/rng.h"
#include "ref/store.h"
#include "tests/support/drivers.h"

#define GROUP    64u
#define BINDINGS (ABI_BIND_ASKED + 1)
#define OCTANTS  8u
#define LEAF     0x80000000u

struct node_question {
    uint32_t ref, what;
};

/* As shaders/nodes.glsl writes it. */
struct node_answer {
    float near[3];
    uint32_t a;
    float far[3];
    uint32_t b;
    uint32_t more[4];
    float near_all[3];
    uint32_t all_a;
    float far_all[3];
    uint32_t all_b;
};

struct nodes {
    const struct packed *packed;
    struct node_question *question;
    struct node_answer *answer;
    uint32_t count;
    bool any; /* any words: planes may be NaN, and what is out of range differs */
};

static uint32_t slots_of(const struct packed *packed)
{
    return layout_is_wide(packed->layout) ? packed->layout->width : 1;
}

/* References of nodes that are read as such: of wide layouts those of inner nodes. */
static uint32_t refs_of(const struct packed *packed)
{
    const uint32_t per_record = layout_is_wide(packed->layout) ? layout_refs(packed->layout) : 1;
    const uint32_t kinds = per_record == 2 + 2 * packed->layout->width ? 2 : 1; /* amd64 */
    return kinds * packed->node_count;
}

static void ask(struct vk *vk, struct nodes *n)
{
    const struct packed *packed = n->packed;
    uint32_t none[8] = {0};
    char name[64];
    const uint32_t constant[] = {GROUP,
                                 ABI_BOX_ROBUST,
                                 ABI_TRI_MT,
                                 ABI_QUERY_CLOSEST,
                                 16,
                                 packed->store->id,
                                 packed->layout->constant[0],
                                 packed->layout->constant[1]};
    const struct push push = {.ray_count = n->count,
                              .root = packed->root,
                              .node_count = packed->ref_count,
                              .item_count = packed->item_count,
                              .tri_count = packed->tri_count};
    const uint64_t item_bytes = 4 * (uint64_t)packed->item_count;
    uint64_t bytes[BINDINGS];
    void *data[BINDINGS];
    for (uint32_t i = 0; i < BINDINGS; i++) {
        bytes[i] = sizeof none;
        data[i] = none;
    }
    bytes[ABI_BIND_HITS] = n->count * sizeof *n->answer;
    data[ABI_BIND_HITS] = n->answer;
    bytes[ABI_BIND_NODES] = 4 * (uint64_t)packed->word_count;
    data[ABI_BIND_NODES] = packed->word;
    bytes[ABI_BIND_ASKED] = n->count * sizeof *n->question;
    data[ABI_BIND_ASKED] = n->question;
    if (item_bytes) {
        bytes[ABI_BIND_ITEMS] = item_bytes;
        data[ABI_BIND_ITEMS] = packed->item;
    }
    (void)snprintf(name, sizeof name, "nodes_%s", layout_shader(packed->layout));
    gpu_run_on(vk, name, constant, ARRAY_COUNT(constant), &push, sizeof push,
               (n->count + GROUP - 1) / GROUP, BINDINGS, bytes, data);
}

/* --- the comparison --------------------------------------------------------------------------- */

static void wrong(const struct nodes *n, uint32_t at, const char *what, double c, double glsl)
{
    const struct node_question *q = &n->question[at];
    fail_msg("%s, %s: reference %u, slot %u, item %u, octant %u: %s is %a in C, %a in the shader",
             n->packed->layout->name, n->packed->store->name, q->ref, q->what & 255,
             q->what >> 8 & 255, q->what >> 16, what, c, glsl);
}

static void same_number(const struct nodes *n, uint32_t at, const char *what, uint32_t c,
                        uint32_t glsl)
{
    if (c != glsl)
        wrong(n, at, what, c, glsl);
}

static void same_planes(const struct nodes *n, uint32_t at, const char *what, const struct box *box,
                        const float near[3], const float far[3])
{
    const uint32_t octant = n->question[at].what >> 16;
    for (int k = 0; k < 3 && !n->any; k++) {
        bool down = octant >> k & 1;
        float first = down ? box->hi[k] : box->lo[k], second = down ? box->lo[k] : box->hi[k];
        if (float_bits(first) != float_bits(near[k]))
            wrong(n, at, what, (double)first, (double)near[k]);
        if (float_bits(second) != float_bits(far[k]))
            wrong(n, at, what, (double)second, (double)far[k]);
    }
}

static void same_leaf(const struct nodes *n, uint32_t at, const struct wide *leaf)
{
    const uint32_t item = n->question[at].what >> 8 & 255;
    bool none = n->any && n->answer[at].more[0] == 0; /* or items that are none */
    for (uint32_t i = 0; i < leaf->item_count && i < 8 && none; i++)
        same_number(n, at, "an item of none", packed_item(n->packed, leaf, i), ABI_NO_PRIM);
    if (none)
        return;
    same_number(n, at, "the number of items", leaf->item_count, n->answer[at].more[0]);
    if (item < leaf->item_count) {
        const uint32_t c = packed_item(n->packed, leaf, item), glsl = n->answer[at].more[1];
        if (!n->any || c < n->packed->tri_count || glsl < n->packed->tri_count)
            same_number(n, at, "the item", c, glsl);
    }
}

static void same_binary(const struct nodes *n, uint32_t at)
{
    const struct node_answer *answer = &n->answer[at];
    const struct box box = n->packed->layout->box(n->packed, n->question[at].ref);
    struct wide node;
    n->packed->layout->load(n->packed, n->question[at].ref, &node);
    same_planes(n, at, "a plane", &box, answer->near, answer->far);
    if (!n->any || node.child_count > 0)
        same_number(n, at, "whether it is a leaf", node.child_count == 0, answer->a >> 31);
    if (answer->a >> 31) {
        same_leaf(n, at, &node);
        return;
    }
    uint32_t next = 0;
    for (uint32_t i = 0; i < 2; i++)
        if (!n->any || packed_ref_valid(n->packed, answer->more[i]))
            same_number(n, at, i ? "the second child" : "the first child",
                        next < node.child_count ? node.child[next++] : ABI_NO_PRIM,
                        answer->more[i]);
    same_number(n, at, "the number of children", node.child_count, next);
}

/* The child in a slot: the next of C's, unless the slot is empty. */
static void same_slot(const struct nodes *n, uint32_t at, const struct wide *record, uint32_t *next)
{
    const struct packed *packed = n->packed;
    const struct node_answer *answer = &n->answer[at];
    struct wide leaf;
    const bool checked = strncmp(layout_shader(packed->layout), "grid", 4) == 0;
    if (answer->a == LEAF ||
        (n->any && !checked && answer->a < LEAF && answer->a >= packed->node_count))
        return;
    if (*next >= record->child_count)
        wrong(n, at, "the number of children", record->child_count, *next + 1.0);
    const uint32_t child = record->child[*next], inner = refs_of(packed);
    same_planes(n, at, "a plane of the child", &record->box[*next], answer->near, answer->far);
    same_number(n, at, "whether the child is a leaf", child >= inner, answer->a >> 31);
    ++*next;
    if (child < inner) {
        same_number(n, at, "the record of the child", child % packed->node_count, answer->a);
        if (inner > packed->node_count)
            same_number(n, at, "the kind of the child", child / packed->node_count, answer->b);
        return;
    }
    packed->layout->load(packed, child, &leaf);
    same_leaf(n, at, &leaf);
}

/* All answers of a record, which begin at `at`: octant by octant, item by item, slot by slot. */
static void same_wide(const struct nodes *n, uint32_t at, uint32_t items)
{
    const uint32_t ref = n->question[at].ref, width = n->packed->layout->width;
    const struct box box = n->packed->layout->box(n->packed, ref);
    struct wide record;
    n->packed->layout->load(n->packed, ref, &record);
    for (uint32_t i = 0; i < OCTANTS * items; i++) {
        uint32_t next = 0;
        for (uint32_t slot = 0; slot < width; slot++, at++) {
            const struct node_answer *answer = &n->answer[at];
            same_slot(n, at, &record, &next);
            same_number(n, at, "the record", ref % n->packed->node_count, answer->all_a);
            same_number(n, at, "the kind", ref / n->packed->node_count, answer->all_b);
            same_planes(n, at, "a plane of the union", &box, answer->near_all, answer->far_all);
        }
        same_number(n, at - 1, "the number of children", record.child_count, next);
    }
}

/* The nodes of a tree that can be reached, each with `items` items for each octant. */
static uint32_t compare(struct vk *vk, const struct packed *packed, const bool *reached,
                        uint32_t items, bool any)
{
    const uint32_t slots = slots_of(packed), each = OCTANTS * items * slots;
    struct nodes n = {.packed = packed, .any = any};
    uint32_t refs = 0;
    n.question = calloc((size_t)refs_of(packed) * each, sizeof *n.question);
    n.answer = calloc((size_t)refs_of(packed) * each, sizeof *n.answer);
    assert_true(n.question && n.answer);
    for (uint32_t ref = 0; ref < refs_of(packed); ref++) {
        refs += reached[ref];
        for (uint32_t i = 0; i < each && reached[ref]; i++)
            n.question[n.count++] = (struct node_question){ref, i % slots | i / slots % items << 8 |
                                                                    i / slots / items << 16};
    }
    ask(vk, &n);
    for (uint32_t at = 0; at < n.count; at += each) {
        if (layout_is_wide(packed->layout)) {
            same_wide(&n, at, items);
            continue;
        }
        for (uint32_t i = 0; i < each; i++)
            same_binary(&n, at + i);
    }
    free(n.question);
    free(n.answer);
    return refs;
}

/* What can be reached from the root. */
static void reach(const struct packed *packed, uint32_t ref, bool *reached)
{
    struct wide node;
    if (reached[ref])
        return;
    reached[ref] = true;
    packed->layout->load(packed, ref, &node);
    for (uint32_t i = 0; i < node.child_count; i++)
        reach(packed, node.child[i], reached);
}

static uint32_t compare_tree(struct vk *vk, const struct packed *packed)
{
    bool *reached = calloc(packed->ref_count, sizeof *reached);
    assert_non_null(reached);
    reach(packed, packed->root, reached);
    uint32_t refs = compare(vk, packed, reached, 8, false);
    free(reached);
    return refs;
}

/* --- laws ------------------------------------------------------------------------------------- */

/* A scene with a tree of one builder. */
static struct drivers_view tree_of(const char *spec, const char *builder, uint32_t leaf)
{
    struct drivers_view view = view_make(spec, "vertices", 1);
    const struct build_options build = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    bvh_free(&view.bvh);
    assert_int_equal(builder_find(builder)->build(&view.scene, &build, &view.bvh, NULL), 0);
    return view;
}

/* Leaves of one to four items. */
static void every_layout_decodes_as_in_c(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct drivers_view view = tree_of("soup:n=200,size=0.4", "sah_sweep", 4);
    uint32_t count = 0;
    for (size_t i = 0; layouts_all[i]; i++, count++) {
        view_pack(&view, layouts_all[i]->name);
        assert_true(compare_tree(vk, &view.packed) > 2);
    }
    view_free(&view);
    assert_true(count > 50);
    gpu_close(vk);
}

/* Seven and eight items, all that a record of 16 bytes has. */
static void full_leaves_decode_as_in_c(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "rf16", "rtrs_direct", "rtrs_rf_paper"};
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct drivers_view view = tree_of("soup:n=250,size=0.4", "median", 8);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        view_pack(&view, names[i]);
        assert_true(compare_tree(vk, &view.packed) > 32);
    }
    view_free(&view);
    gpu_close(vk);
}

/* Flips a bit of every second word, but none that makes numbers of items of 2^31 and more. Some
 * words are numbers about that of the records, RTRS has children of 2^31, and its last record of 16
 * bytes is a leaf. */
static void spoil(struct packed *packed, uint64_t seed)
{
    const uint32_t words = packed->layout->node_bytes / 4;
    const uint32_t count_at = words == 8 ? 7 : words == 12 ? 3 : UINT32_MAX; /* f32, rtrs_direct */
    struct rng rng = rng_make(8, seed);
    for (uint32_t i = 0; i < packed->word_count; i++) {
        const uint32_t bit = rng_below(&rng, 32), kind = rng_below(&rng, 8);
        if (kind < 4 && (bit < 31 || i % words != count_at))
            packed->word[i] ^= 1u << bit;
        else if (kind == 4)
            packed->word[i] = packed->node_count - 4 + rng_below(&rng, 6);
        if (words == 12 && i % 48 == 0)
            packed->word[i] = LEAF;
    }
    if (words == 4 && packed->layout->faithful)
        packed->word[packed->word_count - 1] |= LEAF;
}

/* Every reference, whatever the words hold: kinds, children and items. Not cwbvh80, which has the
 * kinds of children twice; of grids, which differ in planes, some. */
static void any_words_decode_as_in_c(void **state)
{
    (void)state;
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct drivers_view view = tree_of("soup:n=200,size=0.4", "sah_sweep", 4);
    for (size_t i = 0; layouts_all[i]; i++) {
        const bool grid = strncmp(layout_shader(layouts_all[i]), "grid", 4) == 0;
        if (strcmp(layouts_all[i]->name, "cwbvh80") == 0 || (grid && i % 4))
            continue;
        view_pack(&view, layouts_all[i]->name);
        bool *all = calloc(view.packed.ref_count, sizeof *all);
        assert_non_null(all);
        for (uint32_t ref = 0; ref < refs_of(&view.packed); ref++)
            all[ref] = ref != 2 * view.packed.node_count - 1; /* of amd64 half a record */
        spoil(&view.packed, i);
        (void)compare(vk, &view.packed, all, 4, true);
        free(all);
    }
    view_free(&view);
    gpu_close(vk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_decodes_as_in_c),
        cmocka_unit_test(full_leaves_decode_as_in_c),
        cmocka_unit_test(any_words_decode_as_in_c),
    };
    return cmocka_run_group_tests_name("vulkan_nodes", tests, NULL, NULL);
}
