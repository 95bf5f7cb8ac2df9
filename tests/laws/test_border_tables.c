/* Tables of objects from outside, at every border that their headers document: each number, each
 * letter of a name and each missing function is accepted or refused as ref/plugin.h and
 * ref/raydiff_engine.h state. */
#include "ref/guest/guest.h"
#include "ref/outside/plugin_layout.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

/* Never called. */
static int packs(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                 struct raydiff_out *out)
{
    (void)tree, (void)scene, (void)out;
    return RAYDIFF_LIMIT;
}

static void loads(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out)
{
    (void)packed, (void)ref, (void)out;
}

static struct raydiff_box boxes(const struct raydiff_packed *packed, uint32_t ref)
{
    (void)packed, (void)ref;
    return (struct raydiff_box){{0}, {0}};
}

static struct raydiff_plugin plugin_fine(void)
{
    return (struct raydiff_plugin){.version = RAYDIFF_PLUGIN_VERSION,
                                   .bytes = sizeof(struct raydiff_plugin),
                                   .name = "a",
                                   .node_bytes = 16,
                                   .width = 2,
                                   .pack = packs,
                                   .load = loads,
                                   .box = boxes};
}

static void must_be(bool accepted, const struct raydiff_plugin *plugin, const char *what,
                    uint32_t number)
{
    struct reason reason = {""};
    const enum status status = plugin_check("x.so", plugin, &reason);
    if (status != (accepted ? STATUS_OK : STATUS_INPUT))
        fail_msg("%s %u: %s, '%s'", what, number, status_text(status), reason.text);
    assert_int_equal(reason.text[0] == '\0', accepted);
}

static void numbers_of_a_layout(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 5000; i++) {
        struct raydiff_plugin plugin = plugin_fine();
        const uint32_t bytes = i < 4000 ? i : UINT32_MAX - 15 - 16 * (i - 4000);
        plugin.node_bytes = bytes;
        must_be(bytes > 0 && bytes % 16 == 0 && bytes <= 1024, &plugin, "node_bytes", bytes);
        const uint32_t width = i < 4000 ? i : UINT32_MAX - (i - 4000);
        plugin = plugin_fine();
        plugin.width = width;
        must_be(width == 2 || width == 4 || width == 8, &plugin, "width", width);
        plugin = plugin_fine();
        plugin.bytes = i;
        must_be(i == sizeof plugin, &plugin, "bytes", i);
        plugin = plugin_fine();
        plugin.version = i;
        must_be(i == 1, &plugin, "version", i);
    }
}

static void functions_of_a_layout(void **state)
{
    (void)state;
    for (uint32_t without = 0; without < 8; without++)
        for (uint32_t width = 2; width <= 8; width *= 2) {
            struct raydiff_plugin plugin = plugin_fine();
            plugin.width = width;
            plugin.pack = without & 1 ? NULL : packs;
            plugin.load = without & 2 ? NULL : loads;
            plugin.box = without & 4 ? NULL : boxes;
            must_be(!(without & 3) && (width > 2 || !(without & 4)), &plugin, "without", without);
        }
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_in_name(char c)
{
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_';
}

static int opens(const struct raydiff_engine_options *options, void **self, char *reason)
{
    (void)options, (void)self, (void)reason;
    return RAYDIFF_ENGINE_FAILED;
}

static void closes(void *self)
{
    (void)self;
}

static int builds(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    (void)self, (void)mesh, (void)reason;
    return RAYDIFF_ENGINE_FAILED;
}

static int traces(void *self, const struct raydiff_engine_ray *ray, size_t count, uint32_t query,
                  struct raydiff_engine_hit *hit, char *reason)
{
    (void)self, (void)ray, (void)count, (void)query, (void)hit, (void)reason;
    return RAYDIFF_ENGINE_FAILED;
}

static struct raydiff_engine engine_fine(void)
{
    return (struct raydiff_engine){.version = RAYDIFF_ENGINE_VERSION,
                                   .bytes = sizeof(struct raydiff_engine),
                                   .name = "a",
                                   .can = RAYDIFF_ENGINE_CLOSEST,
                                   .open = opens,
                                   .close = closes,
                                   .build = builds,
                                   .trace = traces};
}

static void engine_must_be(bool accepted, const struct raydiff_engine *table, const char *what,
                           uint32_t number)
{
    struct reason reason = {""};
    const enum status status = guest_check("x.so", table, &reason);
    if (status != (accepted ? STATUS_OK : STATUS_INPUT))
        fail_msg("%s %u: %s, '%s'", what, number, status_text(status), reason.text);
    assert_int_equal(reason.text[0] == '\0', accepted);
}

/* Every byte in every place, and every length up to 40. */
static void letters_of_names(void **state)
{
    (void)state;
    struct raydiff_plugin plugin = plugin_fine();
    struct raydiff_engine table = engine_fine();
    char name[42];
    plugin.name = table.name = name;
    for (uint32_t length = 0; length <= 40; length++) {
        memset(name, 'z', length);
        name[length] = '\0';
        must_be(length >= 1 && length <= 15, &plugin, "letters", length);
        engine_must_be(length >= 1 && length <= 31, &table, "letters", length);
        for (uint32_t at = 0; at < length && length <= 15; at++)
            for (uint32_t byte = 1; byte < 256; byte++) {
                name[at] = (char)byte;
                const bool fine = at ? is_in_name(name[at]) : is_letter(name[at]);
                must_be(fine, &plugin, "byte", byte);
                engine_must_be(fine, &table, "byte", byte);
                name[at] = 'z';
            }
    }
    static const char *const taken[] = {"all", "every", "auto"}; /* words of --layout */
    for (size_t i = 0; i < ARRAY_COUNT(taken); i++) {
        plugin.name = taken[i];
        must_be(false, &plugin, taken[i], 0);
    }
    plugin.name = table.name = NULL;
    must_be(false, &plugin, "no name", 0);
    engine_must_be(false, &table, "no name", 0);
}

static void versions_of_a_tracer(void **state)
{
    (void)state;
    for (uint32_t version = 0; version < 5; version++)
        for (uint32_t bytes = 0; bytes <= sizeof(struct raydiff_engine) + 8; bytes++) {
            struct raydiff_engine table = engine_fine();
            table.version = version;
            table.bytes = bytes;
            engine_must_be((version == 2 && bytes == sizeof table) ||
                               (version == 1 && bytes == offsetof(struct raydiff_engine, move)),
                           &table, "version and bytes", 1000 * version + bytes);
        }
}

/* What `can` needs, of all that it may be: a table with that and no more is accepted, one
 * without any part of it is not. */
static void functions_of_a_tracer(void **state)
{
    (void)state;
    enum { SCENES = RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY, FUNCTIONS = 12 };
    static const uint32_t needed_by[FUNCTIONS] = {UINT32_MAX,
                                                  UINT32_MAX,
                                                  SCENES | RAYDIFF_ENGINE_ALL,
                                                  SCENES | RAYDIFF_ENGINE_NATIVE,
                                                  RAYDIFF_ENGINE_ALL,
                                                  RAYDIFF_ENGINE_WORLDS,
                                                  RAYDIFF_ENGINE_WORLDS,
                                                  RAYDIFF_ENGINE_NATIVE,
                                                  RAYDIFF_ENGINE_NATIVE,
                                                  RAYDIFF_ENGINE_NATIVE,
                                                  RAYDIFF_ENGINE_NATIVE,
                                                  RAYDIFF_ENGINE_MOVE};
    static const size_t place[FUNCTIONS] = {
        offsetof(struct raydiff_engine, open),        offsetof(struct raydiff_engine, close),
        offsetof(struct raydiff_engine, build),       offsetof(struct raydiff_engine, trace),
        offsetof(struct raydiff_engine, trace_all),   offsetof(struct raydiff_engine, build_world),
        offsetof(struct raydiff_engine, trace_world), offsetof(struct raydiff_engine, rays_make),
        offsetof(struct raydiff_engine, rays_trace),  offsetof(struct raydiff_engine, hits_read),
        offsetof(struct raydiff_engine, rays_free),   offsetof(struct raydiff_engine, move)};
    for (uint32_t can = 0; can < 128; can++)
        for (uint32_t without = 0; without <= FUNCTIONS; without++) {
            struct raydiff_engine table = engine_fine();
            bool whole = true;
            table.can = can;
            table.build = NULL, table.trace = NULL;
            for (uint32_t f = 0; f < FUNCTIONS; f++) {
                const bool needed = f < 2 || (can & needed_by[f]);
                int (*const some)(void *, const struct raydiff_engine_mesh *, char *) = builds;
                memset((char *)&table + place[f], 0, sizeof some);
                if (needed && f != without)
                    memcpy((char *)&table + place[f], &some, sizeof some);
                whole = whole && !(needed && f == without);
            }
            engine_must_be(can < 64 && (can & (RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_WORLDS)) &&
                               whole,
                           &table, "can and without", 1000 * can + without);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_layout),   cmocka_unit_test(functions_of_a_layout),
        cmocka_unit_test(letters_of_names),      cmocka_unit_test(versions_of_a_tracer),
        cmocka_unit_test(functions_of_a_tracer),
    };
    return cmocka_run_group_tests_name("borders of tables", tests, NULL, NULL);
}
