/* Layout amd64: what each pointer says, whatever the words are: of every type and place, in every
 * slot, of both forms of a record. */
#include "ref/layout.h"
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/records.h"

#define NONE 0xFFFFFFFFu

/* The only pointer of a record that is none of the others. */
static void check_pointer(struct packed *packed, uint32_t record, bool f32, uint32_t s,
                          uint32_t type, uint32_t place)
{
    const uint32_t records = packed->node_count;
    struct wide node;
    packed->word[16 * record + s] = place << 3 | type;
    packed->layout->load(packed, record + (f32 ? records : 0), &node);
    const bool cut = f32 && record + 1 == records; /* it needs two records */
    const bool is = !cut && (type < 4 || (type < 6 && place < records));
    assert_int_equal(node.child_count, is);
    if (!is)
        return;
    assert_int_equal(node.leaf_count[0], type < 4 ? type + 1 : 0);
    if (type < 4)
        assert_int_equal(node.leaf_first[0], place);
    else
        assert_int_equal(node.child[0], place + (type == 5 ? records : 0));
    if (type < 4) {
        struct wide leaf;
        packed->layout->load(packed, node.child[0], &leaf);
        assert_int_equal(leaf.child_count, 0);
        assert_int_equal(leaf.item_first, place);
        assert_int_equal(leaf.item_count, type + 1);
    }
}

static void pointers_are_what_their_bits_say(void **state)
{
    (void)state;
    static const char *const layout[] = {"amd64", "amd64_f16", "amd64_f32", "amd64_g1"};
    for (size_t l = 0; l < ARRAY_COUNT(layout); l++) {
        struct packed packed;
        struct scene scene = trees_grid(60);
        pack(&packed, layout[l], &scene, 2);
        const uint32_t records = packed.node_count;
        const uint32_t places[] = {0,           1,           records - 1, records,
                                   records + 1, 2 * records, 0x1FFFFFFF};
        assert_true(records > 8);
        for (uint32_t record = 0; record < records;
             record += record + 2 < records ? records / 4 : 1)
            for (uint32_t n = 0; n < 2 * 4 * 8 * ARRAY_COUNT(places); n++) {
                for (uint32_t s = 0; s < 4; s++)
                    packed.word[16 * record + s] = NONE;
                check_pointer(&packed, record, n % 2, n / 2 % 4, n / 8 % 8, places[n / 64]);
            }
        packed_free(&packed);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pointers_are_what_their_bits_say),
    };
    return cmocka_run_group_tests_name("amd_words", tests, NULL, NULL);
}
