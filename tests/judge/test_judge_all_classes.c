/* Lists of all hits before the judge: what is allowed has its class, and what cannot be known is
 * not judged. */
#include "tests/judge/judge_all_fixture.h"

/* On the diagonal of both quads each half is hit by chance, but of a watertight test one is. */
static void an_edge_is_chance_but_not_a_gap(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_ask(c, along_z(0.25f, 0.25f));
    for (size_t s = 0; s < SUBJECTS; s++) {
        bool watertight = subjects[s].model.watertight;
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must(c, LIST(c, 0, 1, 2, 3), VERDICT_RIGHT);
        must(c, LIST(c, 0, 2), VERDICT_BOUNDARY);
        must(c, LIST(c, 1, 2), VERDICT_BOUNDARY);
        must(c, LIST(c, 1, 2, 3), VERDICT_BOUNDARY);
        if (watertight) {
            must_wrong(c, empty, WRONG_MISSED, ABI_NO_PRIM, 0);
            must_wrong(c, LIST(c, 2, 3), WRONG_MISSED, ABI_NO_PRIM, 0);
            must_wrong(c, LIST(c, 1), WRONG_MISSED, ABI_NO_PRIM, 2);
        } else {
            struct judged_list list = must(c, LIST(c, 2), VERDICT_BOUNDARY);
            assert_int_equal(list.judged.judgement.fan, is_unknown(&subjects[s]));
            list = must(c, LIST(c, 1, 2), VERDICT_BOUNDARY);
            assert_false(list.judged.judgement.fan);
        }
    }
    judge_fixture_close(c);
}

/* Of a list of an unknown formula one exact hit is counted: how near to an edge it is, and whether
 * it was left out for that. Of other formulas, and away from edges, none is. */
static void one_hit_of_a_list_is_counted_beside_edges(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        const bool unknown = is_unknown(&subjects[s]);
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        judge_fixture_ask(c, along_z(0.25f + 0x1p-22f, 0.25f)); /* beside the diagonals */
        const uint32_t first = c->truth.prim;
        struct judged_list whole = LIST(c, first, first + 2), none = empty;
        struct judgement *said = &whole.judged.judgement;
        assert_true(first < 2);
        assert_int_equal(judge(c, &whole), VERDICT_RIGHT);
        assert_true(unknown ? said->margin > 0 && said->margin < 1 : said->margin == 0);
        assert_false(said->edge_lost);
        (void)judge(c, &none);
        assert_true(none.judged.judgement.margin == said->margin || !unknown);
        assert_int_equal(none.judged.judgement.edge_lost, unknown);
        judge_fixture_ask(c, along_z(0.5f, -0.25f)); /* far from all edges */
        whole = LIST(c, 0, 2);
        assert_int_equal(judge(c, &whole), VERDICT_RIGHT);
        assert_true(said->margin == 0 && !said->edge_lost);
    }
    judge_fixture_close(c);
}

static void an_end_of_the_range_is_chance(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    struct ray ray = along_z(0.5f, -0.25f);
    ray.tmax = 2;
    judge_fixture_ask(c, ray);
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must(c, LIST(c, 0), VERDICT_BORDER);
        if (subjects[s].model.open)
            must_wrong(c, LIST(c, 0, 2), WRONG_DISTANCE, 2, ABI_NO_PRIM);
        else
            must(c, LIST(c, 0, 2), VERDICT_RIGHT);
    }
    judge_fixture_close(c);
}

static void a_plane_may_be_listed_or_not(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_ask(c, (struct ray){{-5, -0.5f, 1}, 0, {1, 0, 0}, 1e30f});
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must(c, empty, VERDICT_RIGHT);
        struct judged_list list = {.hit = {{5, 0.25f, 0.25f, 0}}, .count = 1};
        if (is_unknown(&subjects[s])) { /* at x 0, y -0.5: that is v 0.25, u 0.25 */
            must(c, list, VERDICT_IN_PLANE);
        } else { /* along an axis every determinant is exactly 0 */
            must_wrong(c, list, WRONG_PHANTOM, 0, ABI_NO_PRIM);
        }
    }
    judge_fixture_close(c);
}

static void out_of_contract_says_nothing(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    c->ray = (struct ray){{0, 0, 0}, 0, {0, 0, 0}, 1};
    struct judged_list list = {.hit = {{NAN, 0, 0, 1}}, .count = 1}, beyond = list;
    beyond.hit[0].prim = 77;
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_ALL);
        must(c, empty, VERDICT_OUT_OF_CONTRACT);
        must(c, list, VERDICT_OUT_OF_CONTRACT);
        must_wrong(c, beyond, WRONG_PHANTOM, 77, ABI_NO_PRIM);
    }
    judge_fixture_close(c);
}

/* A closed box from -1 to 1; the diagonals of the faces across z run through x = y. Triangles 0 and
 * 1 are at z = -1, 2 and 3 at z = 1. */
static struct scene closed_box(void)
{
    struct scene scene;
    static const uint32_t index[12][3] = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6},
                                          {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                          {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    assert_int_equal(scene_make(8, 12, &scene), STATUS_OK);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            scene.vertex[3 * i + k] = i >> k & 1 ? 1.0f : -1.0f;
    memcpy(scene.index, index, sizeof index);
    return scene;
}

/* A fixture of a mesh, and what its topology says. */
struct all_mesh {
    struct judge_fixture *c;
    struct topology topology;
    bool closed;
};

static struct all_mesh mesh_of(struct scene scene)
{
    struct all_mesh mesh = {.c = judge_fixture_of(scene)};
    assert_int_equal(topology_make(&mesh.c->scene, &mesh.topology, NULL), STATUS_OK);
    mesh.closed = topology_open_edge(&mesh.topology) == TOPOLOGY_NONE;
    return mesh;
}

static struct list_mesh said_of(struct all_mesh *mesh, const struct judged_list *list)
{
    struct list_mesh said;
    assert_int_equal(judge_list_mesh(mesh->c->oracle, &mesh->topology, mesh->closed, &mesh->c->ray,
                                     list->hit, list->count, &said),
                     STATUS_OK);
    return said;
}

static void must_say(struct all_mesh *mesh, struct judged_list list, bool doubled, bool off)
{
    struct list_mesh said = said_of(mesh, &list);
    assert_int_equal(said.parity, mesh->closed);
    assert_int_equal(said.doubled, doubled);
    assert_int_equal(said.parity_off, off);
    if (doubled)
        assert_true(said.pair[0] != said.pair[1] && said.pair[0] < 4 && said.pair[1] < 4);
}

static void mesh_free(struct all_mesh *mesh)
{
    topology_free(&mesh->topology);
    judge_fixture_close(mesh->c);
}

static struct ray up(float x, float y, float z)
{
    return (struct ray){{x, y, z}, 0, {0, 0, 1}, 1e30f};
}

/* Through the box, at its diagonals or beside them. */
static void double_hits_and_parity_are_seen(void **state)
{
    (void)state;
    struct all_mesh mesh = mesh_of(closed_box());
    struct judge_fixture *c = mesh.c;
    assert_true(mesh.closed);
    c->ray = up(0.5f, 0.25f, -5); /* from outside, through interiors */
    must_say(&mesh, LIST(c, 0, 2), false, false);
    must_say(&mesh, LIST(c, 0), false, true);
    must_say(&mesh, LIST(c, 0, 1, 2), true, false); /* 1 is wrong, but no wall more */
    must_say(&mesh, LIST(c, 0, 0, 2), false, false);
    c->ray = up(0.25f, 0.25f, -5); /* through both diagonals */
    must_say(&mesh, LIST(c, 0, 2), false, false);
    must_say(&mesh, LIST(c, 1, 3), false, false);
    must_say(&mesh, LIST(c, 0, 1, 2), true, false);
    must_say(&mesh, LIST(c, 0, 1, 2, 3), true, false);
    must_say(&mesh, LIST(c, 0, 1), true, true);
    must_say(&mesh, empty, false, false); /* lost, but in pairs */
    c->ray = up(0.25f, 0.25f, 0);         /* from inside */
    must_say(&mesh, LIST(c, 2), false, false);
    must_say(&mesh, LIST(c, 2, 3), true, false);
    must_say(&mesh, empty, false, true);
    c->ray = (struct ray){{-5, 0, 0.5f}, 5, {1, 0, 0.0625f}, 1e30f}; /* begins inside */
    must_say(&mesh, empty, false, true);
    /* In through an interior, out through a diagonal. */
    c->ray = (struct ray){{-5, 0.125f, -0.625f}, 5, {1, 0.0625f, 0.1875f}, 1e30f};
    must_say(&mesh, empty, false, true);
    mesh_free(&mesh);
}

static void parity_is_silent_where_it_is_not_known(void **state)
{
    (void)state;
    struct all_mesh mesh = mesh_of(closed_box());
    struct judged_list none = empty;
    mesh.c->ray = up(0.25f, 0.25f, -1); /* on the wall */
    assert_false(said_of(&mesh, &none).parity);
    mesh.c->ray = up(0.25f, 0.25f, -5);
    mesh.c->ray.tmax = 4; /* ends on it */
    assert_false(said_of(&mesh, &none).parity);
    mesh.c->ray.tmin = 5; /* begins behind an edge, ends on one */
    mesh.c->ray.tmax = 6;
    assert_false(said_of(&mesh, &none).parity);
    mesh_free(&mesh);
    struct scene scene = closed_box();
    scene.tri_count = 11;
    mesh = mesh_of(scene);
    mesh.c->ray = up(0.5f, 0.25f, -5);
    assert_false(mesh.closed);
    assert_false(said_of(&mesh, &none).parity);
    must_say(&mesh, LIST(mesh.c, 0, 1, 2), true, false);
    mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edge_is_chance_but_not_a_gap),
        cmocka_unit_test(one_hit_of_a_list_is_counted_beside_edges),
        cmocka_unit_test(an_end_of_the_range_is_chance),
        cmocka_unit_test(a_plane_may_be_listed_or_not),
        cmocka_unit_test(out_of_contract_says_nothing),
        cmocka_unit_test(double_hits_and_parity_are_seen),
        cmocka_unit_test(parity_is_silent_where_it_is_not_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
