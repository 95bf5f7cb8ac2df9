/* Welding, edges, fans, and which meshes are closed. */
#include "ref/scene/topology.h"
#include "scenes/scenes.h"

#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct scene generated(const char *spec)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, 1, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

static struct topology topology_of(const struct scene *scene)
{
    struct topology topology;
    assert_int_equal(topology_make(scene, &topology, NULL), STATUS_OK);
    return topology;
}

/* A tetrahedron whose corners are `vertices` indices into 5 vertices, the last a -0 twin of the
 * first. */
static struct scene tetrahedron(const uint32_t index[12])
{
    static const float at[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -0.0f, 0, -0.0f};
    struct scene scene;
    assert_int_equal(scene_make(5, 4, &scene), STATUS_OK);
    memcpy(scene.vertex, at, sizeof at);
    memcpy(scene.index, index, 12 * sizeof *index);
    return scene;
}

static const uint32_t closed_index[12] = {0, 2, 1, 0, 1, 3, 4, 3, 2, 1, 2, 3};

static void weld_takes_minus_zero_for_zero(void **state)
{
    (void)state;
    struct scene scene = tetrahedron(closed_index);
    struct topology topology = topology_of(&scene);
    assert_int_equal(topology.point_count, 4);
    assert_int_equal(topology.point[4], topology.point[0]);
    assert_int_equal(topology.vertex[topology.point[4]], 0);
    assert_int_equal(topology.edge_count, 6);
    topology_free(&topology);
    scene_free(&scene);
}

/* Every list against its definition, on a mesh with shared and one with repeated vertices. */
static void lists_agree_with_their_definitions(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere", "flake", "platonic", "soup:n=100", "terrain"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene = generated(specs[s]);
        struct topology t = topology_of(&scene);
        size_t sides = 0;
        for (uint32_t e = 0; e < t.edge_count; e++) {
            const struct topology_edge *edge = &t.edge[e];
            assert_true(edge->a < edge->b && edge->first == sides);
            sides += edge->forward + edge->backward;
            for (uint32_t i = 0; i < edge->forward + edge->backward; i++) {
                uint32_t tri = t.side[edge->first + i];
                size_t c = 0;
                while (c < 3 && t.edge_of[3 * (size_t)tri + c] != e)
                    c++;
                assert_true(c < 3);
                uint32_t from = t.point[scene.index[3 * (size_t)tri + c]];
                uint32_t to = t.point[scene.index[3 * (size_t)tri + (c + 1) % 3]];
                assert_int_equal(from, i < edge->forward ? edge->a : edge->b);
                assert_int_equal(to, i < edge->forward ? edge->b : edge->a);
            }
        }
        assert_int_equal(sides, 3 * (size_t)(scene.tri_count - t.collapsed));
        assert_int_equal(t.fan_first[t.point_count], sides);
        for (uint32_t p = 0; p < t.point_count; p++)
            for (uint32_t i = t.fan_first[p]; i < t.fan_first[p + 1]; i++) {
                const uint32_t *v = scene.index + 3 * (size_t)t.fan[i];
                assert_true(t.point[v[0]] == p || t.point[v[1]] == p || t.point[v[2]] == p);
                assert_true(i == t.fan_first[p] || t.fan[i - 1] < t.fan[i]);
            }
        for (size_t i = 0; i < 3 * (size_t)scene.tri_count; i++)
            assert_int_equal(t.corner[i], t.point[scene.index[i]]);
        for (uint32_t i = 0; i < scene.vertex_count; i++) {
            const float *a = scene.vertex + 3 * (size_t)i;
            const float *b = scene.vertex + 3 * (size_t)t.vertex[t.point[i]];
            assert_true(a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
        }
        topology_free(&t);
        scene_free(&scene);
    }
}

static void generators_that_say_so_are_closed(void **state)
{
    (void)state;
    static const char *const closed[] = {"sphere", "sphere:n=3", "platonic", "flake"};
    static const char *const open[] = {"grid", "terrain", "soup:n=10"};
    for (size_t s = 0; s < ARRAY_COUNT(closed); s++) {
        struct reason reason = {""};
        struct scene scene = generated(closed[s]);
        struct topology topology = topology_of(&scene);
        if (topology_is_closed(&topology, &scene, &reason))
            fail_msg("%s: %s", closed[s], reason.text);
        for (uint32_t p = 0; p < topology.point_count; p++)
            assert_true(topology_fan_closed(&topology, p));
        for (uint32_t p = 0; p < topology.point_count && s < 3; p++) /* flake's spheres touch */
            assert_true(topology_fan_is_ring(&topology, p));
        topology_free(&topology);
        scene_free(&scene);
    }
    for (size_t s = 0; s < ARRAY_COUNT(open); s++) {
        struct reason reason = {""};
        struct scene scene = generated(open[s]);
        struct topology topology = topology_of(&scene);
        assert_int_equal(topology_is_closed(&topology, &scene, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "the mesh is open there"));
        topology_free(&topology);
        scene_free(&scene);
    }
}

/* What is wrong, where, and which fans it spoils. */
static void faults_are_named(void **state)
{
    (void)state;
    static const struct {
        uint32_t index[12];
        const char *text;
        int closed_fans;
    } fault[] = {
        {{0, 2, 1, 0, 1, 3, 4, 3, 2, 1, 2, 3}, NULL, 4},
        {{0, 2, 1, 0, 3, 1, 4, 3, 2, 1, 2, 3}, "a triangle is turned round", 1}, /* second turned */
        {{0, 2, 1, 0, 1, 3, 4, 3, 2, 1, 1, 3}, "the mesh is open there", 1}, /* fourth collapsed */
        {{0, 2, 1, 0, 1, 3, 4, 3, 2, 0, 1, 2}, "the mesh is open there", 0}, /* fourth misplaced */
    };
    for (size_t f = 0; f < ARRAY_COUNT(fault); f++) {
        struct reason reason = {""};
        struct scene scene = tetrahedron(fault[f].index);
        struct topology topology = topology_of(&scene);
        enum status status = topology_is_closed(&topology, &scene, &reason);
        assert_int_equal(status, fault[f].text ? STATUS_INPUT : STATUS_OK);
        if (fault[f].text && !strstr(reason.text, fault[f].text))
            fail_msg("%s", reason.text);
        int closed = 0;
        for (uint32_t p = 0; p < topology.point_count; p++)
            closed += topology_fan_closed(&topology, p);
        assert_int_equal(closed, fault[f].closed_fans);
        topology_free(&topology);
        scene_free(&scene);
    }
}

/* Two tetrahedra that touch in a point: closed fans all of them, but the one in the middle is two
 * rings. */
static void touching_cones_are_no_ring(void **state)
{
    (void)state;
    static const float at[21] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1};
    static const uint32_t index[24] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,
                                       0, 4, 5, 0, 6, 4, 0, 5, 6, 4, 6, 5};
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_make(7, 8, &scene), STATUS_OK);
    memcpy(scene.vertex, at, sizeof at);
    memcpy(scene.index, index, sizeof index);
    struct topology topology = topology_of(&scene);
    if (topology_is_closed(&topology, &scene, &reason))
        fail_msg("%s", reason.text);
    for (uint32_t p = 0; p < 7; p++) {
        assert_true(topology_fan_closed(&topology, p));
        assert_int_equal(topology_fan_is_ring(&topology, p), p != 0);
    }
    topology_free(&topology);
    scene_free(&scene);
}

/* Neighbours share an edge, triangles that only touch in a point do not; a turned one runs the same
 * way and is no neighbour of one winding. */
static void neighbours_share_an_edge(void **state)
{
    (void)state;
    struct scene scene = generated("platonic");
    struct topology t = topology_of(&scene);
    size_t shared = 0;
    for (uint32_t a = 0; a < scene.tri_count; a++)
        for (uint32_t b = 0; b < scene.tri_count; b++) {
            uint32_t e = a == b ? TOPOLOGY_NONE : topology_shared_edge(&t, a, b);
            if (e == TOPOLOGY_NONE)
                continue;
            shared++;
            const uint32_t *side = t.side + t.edge[e].first;
            assert_true((side[0] == a && side[1] == b) || (side[0] == b && side[1] == a));
        }
    assert_int_equal(shared, 3 * scene.tri_count);
    topology_free(&t);
    scene_free(&scene);
    struct scene turned = tetrahedron((const uint32_t[12]){0, 2, 1, 0, 3, 1, 4, 3, 2, 1, 2, 3});
    t = topology_of(&turned);
    assert_int_equal(topology_shared_edge(&t, 0, 1), TOPOLOGY_NONE);
    assert_int_not_equal(topology_shared_edge(&t, 0, 2), TOPOLOGY_NONE);
    topology_free(&t);
    scene_free(&turned);
}

static void nothing_is_no_closed_mesh(void **state)
{
    (void)state;
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    struct topology topology = topology_of(&scene);
    assert_int_equal(topology_is_closed(&topology, &scene, &reason), STATUS_INPUT);
    assert_int_equal(topology.edge_count, 0);
    topology_free(&topology);
    scene_free(&scene);
    struct scene speck = tetrahedron((const uint32_t[12]){0, 4, 1, 0, 4, 1, 0, 4, 1, 0, 4, 1});
    topology = topology_of(&speck);
    assert_int_equal(topology.collapsed, 4);
    assert_int_equal(topology_is_closed(&topology, &speck, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "no triangle"));
    topology_free(&topology);
    scene_free(&speck);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weld_takes_minus_zero_for_zero),
        cmocka_unit_test(lists_agree_with_their_definitions),
        cmocka_unit_test(generators_that_say_so_are_closed),
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(touching_cones_are_no_ring),
        cmocka_unit_test(neighbours_share_an_edge),
        cmocka_unit_test(nothing_is_no_closed_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
