/* What C decodes is told apart from what GLSL does: a layout whose C code lies in one number of one
 * record is told by the record, the number and both values. One that never lies does not differ. */
#include "ref/outside/plugin_shader.h"
#include "gpu/trace/decode.h"
#include "ref/base/rng.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"
#include "tests/support/drivers.h"

#include <string.h>

enum decode_lie { HONEST, BOX, ITEMS, ITEM, CHILDREN, KIND };

static const struct layout *honest;
static enum decode_lie lie;
static uint32_t liar;     /* the record that it is about */
static unsigned at;       /* which coordinate */
static uint32_t end;      /* of the records: 1 the first one lies, 2 the last one; 0 any */
static uint32_t child[2]; /* of a wide record: places of the children that it is about */

static void lie_of_box(struct box *box)
{
    float *bound = at < 3 ? &box->lo[at] : &box->hi[at - 3];
    *bound += 1;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    honest->load(packed, ref, out);
    if (ref != liar)
        return;
    if (lie == BOX && honest->width > 2)
        lie_of_box(&out->box[child[0]]);
    out->item_count -= lie == ITEMS;
    out->item_first += lie == ITEM;
    if (lie == KIND) {
        out->child_count = out->item_first = 0;
        out->item_count = 1;
    }
    if (lie == CHILDREN) {
        const uint32_t first = out->child[child[0]];
        out->child[child[0]] = out->child[child[1]];
        out->child[child[1]] = first;
    }
}

static struct box own_box(const struct packed *packed, uint32_t ref)
{
    struct box box = honest->box(packed, ref);
    if (ref == liar && lie == BOX)
        lie_of_box(&box);
    return box;
}

/* Draws a record that the lie fits. Wide: a leaf is a slot, and a box is that of a child. */
static void draw_liar(const struct packed *packed, struct rng *rng)
{
    const bool leaf = lie == ITEMS || lie == ITEM, wide = honest->width > 2;
    for (;;) {
        struct wide node;
        const uint32_t count = leaf || !wide ? packed->ref_count : packed->node_count;
        liar = end ? (end - 1) * (count - 1) : rng_below(rng, count);
        honest->load(packed, liar, &node);
        if (leaf ? node.child_count == 0 && node.item_count > 1 &&
                       packed_item(packed, &node, 0) != packed_item(packed, &node, 1)
                 : node.child_count > 1 || !wide) {
            child[0] = node.child_count ? rng_below(rng, node.child_count) : 0;
            child[1] = node.child_count ? (child[0] + 1) % node.child_count : 0;
            if ((lie != CHILDREN && lie != KIND) ||
                (node.child_count > 1 && node.child[child[0]] < packed->node_count &&
                 node.child[child[1]] < packed->node_count))
                return;
        }
    }
}

static void expect_text(const struct packed *packed, char text[200])
{
    struct wide node;
    uint32_t who = liar;
    honest->load(packed, liar, &node);
    struct box box = honest->width > 2 ? node.box[child[0]] : honest->box(packed, liar);
    if (lie == BOX && honest->width > 2)
        who = node.child[child[0]];
    const float right = at < 3 ? box.lo[at] : box.hi[at - 3];
    int length = snprintf(text, 200, "%s: ", packed_name(packed, who).text);
    text += length;
    if (lie == BOX)
        snprintf(text, 200 - (size_t)length, "%c %s: C decodes %a (%.9g), GLSL %a (%.9g)",
                 "xyz"[at % 3], at < 3 ? "lo" : "hi", (double)(right + 1), (double)(right + 1),
                 (double)right, (double)right);
    else if (lie == KIND)
        snprintf(text, 200 - (size_t)length, "kind: C decodes a leaf, GLSL an inner node");
    else if (lie == ITEMS)
        snprintf(text, 200 - (size_t)length, "items: C decodes %u, GLSL %u", node.item_count - 1,
                 node.item_count);
    else if (lie == ITEM)
        snprintf(text, 200 - (size_t)length, "item slot 0: C decodes %u, GLSL %u",
                 packed_item(packed, &node, 1), packed_item(packed, &node, 0));
    else if (honest->width == 2)
        snprintf(text, 200 - (size_t)length, "first child: C decodes %u, GLSL %u", node.child[1],
                 node.child[0]);
    else
        snprintf(text, 200 - (size_t)length, "child of slot ");
}

/* What is compared of a tree without lies. */
static void must_be_complete(const struct packed *packed, const struct decoded *out)
{
    const uint32_t width = honest->width > 2 ? honest->width : 0;
    struct packed_walk walk;
    uint32_t records = 0, slots = 0;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        const uint32_t ref = walk.visit[i].ref;
        const bool record = !width || ref < packed->node_count;
        honest->load(packed, ref, &node);
        records += record;
        slots += record ? width : 0;
        if (node.child_count == 0 && node.item_count > 0)
            slots += node.item_count - (width > 0);
        else
            slots += width == 0;
    }
    packed_walk_free(&walk);
    assert_true(out->differ == 0 && !out->first[0]);
    assert_int_equal(out->records, records);
    assert_int_equal(out->slots, slots);
}

static void make_decoder(const char *name)
{
    char path[80];
    struct reason reason = {""};
    snprintf(path, sizeof path, "shaders/layouts/layout_%s.glsl", name);
    const enum status status = cmd_glsl_compile(layout_find(name), path, &reason);
    if (status == STATUS_UNSUPPORTED)
        skip();
    gpu_must(status, &reason);
}

static void lies_of_c_are_told(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "tiny8"};
    static const enum decode_lie lies[] = {HONEST, BOX,  BOX,      BOX,  BOX, BOX, BOX,
                                           ITEMS,  ITEM, CHILDREN, KIND, BOX, BOX, CHILDREN};
    static const uint32_t ends[ARRAY_COUNT(lies)] = {[11] = 1, [12] = 2, [13] = 1};
    struct drivers_view view = view_make("sphere:n=9", "mixed", 1);
    const struct engine_options options = {.device = -1};
    struct rng rng = rng_make(9, 0);
    for (size_t n = 0; n < 2; n++) {
        make_decoder(names[n]);
        for (size_t i = 0; i < ARRAY_COUNT(lies); i++) {
            struct reason reason = {""};
            struct decoded out;
            char text[200] = "";
            if ((lies[i] == BOX && i % 2 == n && !ends[i]) || (lies[i] == KIND && n))
                continue; /* half of the coordinates each; a wide record is asked for as inner */
            view_pack(&view, names[n]);
            honest = view.packed.layout;
            struct layout liars = *honest;
            liars.load = load;
            liars.box = own_box;
            lie = lies[i];
            end = ends[i];
            at = (unsigned)(i + 5) % 6;
            draw_liar(&view.packed, &rng);
            if (lie != HONEST)
                expect_text(&view.packed, text);
            view.packed.layout = &liars;
            gpu_must(decode_compare(&view.packed, &options, &out, &reason), &reason);
            view.packed.layout = honest;
            assert_int_equal(strncmp(out.first, text, strlen(text)), 0);
            assert_int_equal(out.differ, lie != HONEST);
            if (lie == HONEST)
                must_be_complete(&view.packed, &out);
        }
    }
    view_free(&view);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(lies_of_c_are_told)};
    return cmocka_run_group_tests_name("decode_lies", tests, NULL, NULL) ? 1 : 0;
}
