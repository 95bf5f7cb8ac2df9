/* Laws of the calls of a tracer from outside (ref/guest/): none is made that its `can` does not
 * have, the reason names what it lacks, and with it the call is made, and told as it returned. The
 * table is this program's own: no object is loaded. */
#include "ref/guest/guest.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static const uint32_t bits[] = {RAYDIFF_ENGINE_CLOSEST, RAYDIFF_ENGINE_ANY,    RAYDIFF_ENGINE_ALL,
                                RAYDIFF_ENGINE_WORLDS,  RAYDIFF_ENGINE_NATIVE, RAYDIFF_ENGINE_MOVE};
static char called; /* the function that was called last: a letter, or 0 */
static int returns;

static int answer(char function, char *reason)
{
    called = function;
    snprintf(reason, RAYDIFF_ENGINE_REASON, "as it was told");
    return returns;
}

static int build(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    (void)self, (void)mesh;
    return answer('b', reason);
}

static int move(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    (void)self, (void)mesh;
    return answer('m', reason);
}

static int trace_all(void *self, const struct raydiff_engine_ray *ray, size_t count,
                     uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                     char *reason)
{
    (void)self, (void)ray, (void)count, (void)capacity, (void)hit, (void)hit_count;
    return answer('a', reason);
}

static int build_world(void *self, const struct raydiff_engine_world *world, char *reason)
{
    (void)self, (void)world;
    return answer('w', reason);
}

/* A call, the bit that it takes, and how reasons name both. */
static const struct {
    uint32_t takes;
    char letter;
    const char *bit, *function;
} calls[] = {{RAYDIFF_ENGINE_CLOSEST, 'b', "CLOSEST", "build"},
             {RAYDIFF_ENGINE_MOVE, 'm', "MOVE", "move"},
             {RAYDIFF_ENGINE_ALL, 'a', "ALL", "trace_all"},
             {RAYDIFF_ENGINE_WORLDS, 'w', "WORLDS", "build_world"}};

static enum status call(struct guest *guest, char letter, struct reason *reason)
{
    const struct raydiff_engine_mesh mesh = {.vertex_count = 0};
    const struct raydiff_engine_world world = {.mesh_count = 0};
    switch (letter) {
    case 'b':
        return guest_build(guest, &mesh, reason);
    case 'm':
        return guest_move(guest, &mesh, reason);
    case 'a':
        return guest_trace_all(guest, NULL, 0, 0, NULL, NULL, reason);
    default:
        return guest_build_world(guest, &world, reason);
    }
}

static void must_be_called(struct guest *guest, size_t k)
{
    static const enum status told[] = {STATUS_OK, STATUS_REFUSED, STATUS_MEMORY, STATUS_DEVICE};
    for (returns = RAYDIFF_ENGINE_OK; returns <= RAYDIFF_ENGINE_FAILED; returns++) {
        struct reason reason = {""};
        called = 0;
        assert_int_equal(call(guest, calls[k].letter, &reason), told[returns]);
        assert_int_equal(called, calls[k].letter);
        if (returns)
            assert_non_null(strstr(reason.text, "as it was told"));
        if (returns > RAYDIFF_ENGINE_REFUSED)
            assert_non_null(strstr(reason.text, calls[k].function));
    }
}

static void nothing_is_called_that_it_cannot(void **state)
{
    (void)state;
    struct raydiff_engine table = {
        .build = build, .move = move, .trace_all = trace_all, .build_world = build_world};
    struct guest guest = {.path = "mine.so", .table = &table};
    for (uint32_t can = 0; can < 1u << (sizeof bits / sizeof bits[0]); can++)
        for (size_t k = 0; k < sizeof calls / sizeof calls[0]; k++) {
            char words[64];
            struct reason reason = {""};
            table.can = 0;
            for (size_t i = 0; i < sizeof bits / sizeof bits[0]; i++)
                table.can |= can >> i & 1 ? bits[i] : 0;
            if (table.can & calls[k].takes) {
                must_be_called(&guest, k);
                continue;
            }
            called = 0;
            returns = RAYDIFF_ENGINE_OK;
            assert_int_equal(call(&guest, calls[k].letter, &reason), STATUS_REFUSED);
            assert_int_equal(called, 0);
            snprintf(words, sizeof words, "mine.so refused: its `can` has no %s", calls[k].bit);
            assert_string_equal(reason.text, words);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_called_that_it_cannot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
