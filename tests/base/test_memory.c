/* How much memory building takes, and that what is too large for the memory left is refused before
 * it is begun. */
#include "tests/support/allocations.h"

#include "ref/build/room.h"
#include "ref/base/memory.h"
#include "ref/store.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>
#include <cmocka.h>

#define WEIGHED 33000u /* just more than arrays that double have room for */

/* At least what they say, and not far from it: else trees are refused that could be built. */
static void builders_take_what_they_say(void **state)
{
    (void)state;
    struct scene scene = built_soup(WEIGHED, 1);
    for (size_t b = 0; builders_all[b]; b++)
        for (uint32_t how = 0; how <= (builders_all[b]->faithful ? 0u : 3u); how++) {
            const struct build_options options = {.leaf = 64,
                                                  .eps = BUILD_EPS_DEFAULT,
                                                  .passes = how == 1 || how == 2,
                                                  .rotates = how == 2,
                                                  .presplit = how == 3 ? 0.5f : 0,
                                                  .threads = 1};
            struct bvh bvh;
            long least = (long)bvh_build_bytes(builders_all[b], WEIGHED, &options);
            atomic_store(&bytes_held, 0);
            atomic_store(&bytes_most, 0);
            assert_int_equal(bvh_build(builders_all[b], &scene, &options, &bvh, NULL), STATUS_OK);
            bvh_free(&bvh);
            if (bytes_most < least || bytes_most > least / 10 * 14)
                fail_msg("%s, way %u: %ld bytes of %ld", builders_all[b]->name, how,
                         (long)bytes_most, least);
        }
    scene_free(&scene);
}

/* The address space that is there and so much more. */
static struct rlimit space_end(size_t more)
{
    struct rlimit before, limit;
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%lu", &pages), 1);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
    limit = before;
    limit.rlim_cur = pages * (rlim_t)sysconf(_SC_PAGESIZE) + more;
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
    return before;
}

static void what_is_too_large_is_refused_before(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_make(3, 10000000, &scene), STATUS_OK);
    assert_true(memory_left() <=
                (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE));
    struct rlimit before = space_end((size_t)400 << 20);
    assert_in_range(memory_left(), (uint64_t)200 << 20, (uint64_t)400 << 20);
    for (size_t b = 0; builders_all[b]; b++) {
        const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh = {.node_count = 7};
        struct reason reason = {""};
        enum status status = bvh_build(builders_all[b], &scene, &options, &bvh, &reason);
        if (status != STATUS_MEMORY || bvh.node_count ||
            !strstr(reason.text, builders_all[b]->name) ||
            !strstr(reason.text, "no memory: a tree of 10000000 triangles takes at least "))
            fail_msg("%s: status %d, %s", builders_all[b]->name, status, reason.text);
    }
    void *array = NULL, *room = alloc_zeroed((size_t)1 << 28, 2);
    size_t capacity = 0;
    assert_null(room);
    assert_null(alloc_zeroed(SIZE_MAX / 2, 3));
    assert_null(room_make((size_t)1 << 28, 2));
    assert_int_equal(array_reserve(&array, &capacity, (size_t)1 << 28, 2), STATUS_MEMORY);
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    assert_true(memory_fits(MEMORY_LARGE - 1));
    assert_false(memory_fits(UINT64_MAX - 1));
    scene_free(&scene);
}

/* Whether a reason tells the bytes of the arrays of a packed tree, or those of its records alone
 * where items are a matter of the storage. */
static bool tells_bytes(const char *text, const struct packed *packed)
{
    const uint32_t items[] = {0, packed->item_count};
    bool is_right = false;
    for (size_t i = 0; i < ARRAY_COUNT(items); i++) {
        char wanted[80];
        snprintf(wanted, sizeof wanted, "%s: no memory for %llu bytes", packed->layout->name,
                 4 * ((unsigned long long)packed->word_count + items[i]));
        is_right |= strcmp(text, wanted) == 0;
    }
    return is_right;
}

/* What there is no memory for is what is made where there is. */
static void bytes_that_are_not_there_are_told(void **state)
{
    (void)state;
    struct scene scene = built_soup(120, 1);
    const struct build_options options = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    size_t layouts_told = 0, taken = 0;
    assert_int_equal(bvh_build(builder_find("median"), &scene, &options, &bvh, NULL), STATUS_OK);
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed whole, packed;
        size_t told = 0;
        if (packed_make(layouts_all[l], &bvh, &scene, &whole, NULL))
            continue;
        for (long n = 0, last = 0; !last; n++) {
            struct reason reason = {""};
            fail_after(n);
            last = packed_make(layouts_all[l], &bvh, &scene, &packed, &reason) == STATUS_OK;
            atomic_store(&until_failure, -1);
            packed_free(&packed);
            if (!strncmp(reason.text, whole.layout->name, strlen(whole.layout->name)) &&
                strstr(reason.text, " bytes")) {
                told++;
                if (!tells_bytes(reason.text, &whole))
                    fail_msg("%s: %u words and %u items", reason.text, whole.word_count,
                             whole.item_count);
            }
        }
        packed_free(&whole);
        layouts_told += told > 0;
        taken++;
    }
    assert_true(taken > 30 && layouts_told == taken);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Number and size of the elements may be exchanged: as many bytes, all zero, or none. */
static void number_and_size_commute(void **state)
{
    (void)state;
    static const size_t count[] = {0, 1, 3, 8, 24, 100, 4097, SIZE_MAX / 8};
    for (size_t i = 0; i < ARRAY_COUNT(count); i++)
        for (size_t j = 0; j < ARRAY_COUNT(count); j++) {
            unsigned char *one = alloc_zeroed(count[i], count[j]);
            unsigned char *two = alloc_zeroed(count[j], count[i]);
            assert_int_equal(one != NULL, two != NULL);
            if (one && two) {
                size_t bytes = count[i] * count[j];
                assert_true(malloc_usable_size(one) >= bytes && malloc_usable_size(two) >= bytes);
                for (size_t at = 0; at < bytes; at++)
                    assert_true(one[at] == 0 && two[at] == 0);
            }
            free(one);
            free(two);
        }
}

/* An array that grows keeps what it has, and has room for what it needs; for one more than that it
 * holds the same. */
static void an_array_has_the_room_it_needs(void **state)
{
    (void)state;
    for (size_t more = 0; more < 2; more++) {
        uint16_t *array = NULL;
        size_t capacity = 0;
        for (size_t count = 0; count < 3000; count++) {
            assert_int_equal(array_reserve(&array, &capacity, count + 1 + more, sizeof *array), 0);
            assert_true(capacity >= count + 1 + more && capacity <= 2 * count + 17);
            array[count] = (uint16_t)(count + 7);
        }
        for (size_t i = 0; i < 3000; i++)
            assert_int_equal(array[i], i + 7);
        free(array);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(builders_take_what_they_say),
        cmocka_unit_test(number_and_size_commute),
        cmocka_unit_test(bytes_that_are_not_there_are_told),
        cmocka_unit_test(an_array_has_the_room_it_needs),
        cmocka_unit_test(what_is_too_large_is_refused_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
