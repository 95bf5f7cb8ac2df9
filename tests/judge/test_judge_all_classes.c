/* Lists of all hits before the judge: what is allowed has its class, and what cannot be known is
 * not judged. */
#include "ref/base/rng.h"
#include "ref/judge/leaks.h"
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
    memset(&said, 0x5A, sizeof said); /* what was there before does not count */
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

static void parity_of_an_open_mesh_is_not_known(void **state)
{
    (void)state;
    struct scene scene = closed_box();
    scene.tri_count = 11;
    struct all_mesh mesh = mesh_of(scene);
    struct judged_list none = empty;
    mesh.c->ray = up(0.5f, 0.25f, -5);
    assert_false(mesh.closed);
    assert_false(said_of(&mesh, &none).parity);
    must_say(&mesh, LIST(mesh.c, 0, 1, 2), true, false);
    mesh_free(&mesh);
}

/* --- parity, by the geometry of the box alone --- */

/* What a ray meets at one t of the line from its origin. */
struct contact {
    double t;
    bool wall; /* the inside of a triangle; else an edge */
};

/* Contacts of a ray with the box from t = 0 on; directions are 0 or powers of 2, so that every
 * number is exact. Diagonals run where both coordinates of a face are equal. -1 if the ray lies in
 * a face's plane. */
static int contacts_of(const struct ray *ray, struct contact out[6])
{
    int count = 0;
    for (int k = 0; k < 3; k++) {
        if (ray->dir[k] == 0 && fabsf(ray->org[k]) == 1)
            return -1;
        for (int side = -1; side <= 1 && ray->dir[k] != 0; side += 2) {
            double t = ((double)side - (double)ray->org[k]) / (double)ray->dir[k], at[2];
            for (int j = 0; j < 2; j++) {
                int axis = (k + 1 + j) % 3;
                at[j] = (double)ray->org[axis] + t * (double)ray->dir[axis];
            }
            if (t < 0 || fabs(at[0]) > 1 || fabs(at[1]) > 1)
                continue;
            bool wall = fabs(at[0]) < 1 && fabs(at[1]) < 1 && at[0] != at[1];
            out[count++] = (struct contact){t, wall};
        }
    }
    return count;
}

static bool is_within_box(const struct ray *ray, double t)
{
    bool within = !isinf(t);
    for (int k = 0; k < 3 && within; k++)
        within = fabs((double)ray->org[k] + t * (double)ray->dir[k]) < 1;
    return within;
}

/* Known if the ray crosses nothing but walls; or if it meets edges between its ends, nothing at
 * them, nothing but walls beyond, and begins its line off the walls: then a generic direction tells
 * where. */
static bool parity_can_be_known(const struct ray *ray, const struct contact *contact, int count)
{
    double lo = (double)ray->tmin, hi = (double)ray->tmax;
    bool walls = true, around = true;
    for (int i = 0; i < count; i++) {
        const double t = contact[i].t;
        bool between = t > lo && t < hi, beyond = t < lo || t > hi;
        walls = walls && (beyond || (between && contact[i].wall));
        around = around && t > 0 && (between || (beyond && contact[i].wall));
    }
    return walls || around;
}

/* What judge_list_mesh finds in a list of any triangles, some of them twice, some that do not
 * exist. */
static void check_any_list(struct all_mesh *mesh, struct rng *rng, bool known, unsigned parity)
{
    uint32_t prim[MOST], group[MOST], pair[2] = {ABI_NO_PRIM, ABI_NO_PRIM};
    struct judged_list list = {.count = rng_below(rng, MOST + 1)};
    size_t kept = 0;
    for (size_t i = 0; i < list.count; i++) {
        list.hit[i] = (struct hit){.prim = rng_below(rng, 14)};
        bool again = list.hit[i].prim >= 12;
        for (size_t k = 0; k < kept; k++)
            again = again || prim[k] == list.hit[i].prim;
        if (!again)
            prim[kept++] = list.hit[i].prim;
    }
    size_t extra =
        leaks_extra(&mesh->topology, mesh->c->oracle, &mesh->c->ray, prim, kept, pair, group);
    struct list_mesh said = said_of(mesh, &list);
    assert_int_equal(said.parity, known);
    assert_int_equal(said.parity_off, known && (kept + extra + parity) % 2 == 1);
    assert_int_equal(said.doubled, extra > 0);
    assert_true(said.pair[0] == pair[0] && said.pair[1] == pair[1]);
}

/* From a lattice in and around the box, many of whose lines meet edges and corners, with ends on
 * walls, before and behind them. */
static void parity_is_known_and_right_wherever_it_can_be(void **state)
{
    (void)state;
    static const float steps[] = {0, 1, -1, 0.5f, -2}, ends[] = {0, 0.5f, 1, 2, INFINITY};
    struct all_mesh mesh = mesh_of(closed_box());
    struct rng rng = rng_make(1, 1);
    size_t count[2][2] = {{0}};
    for (int i = 0; i < 40000; i++) {
        struct contact contact[6];
        struct ray ray = {.tmax = 1};
        for (int k = 0; k < 3; k++) {
            ray.org[k] = 0.25f * (float)rng_below(&rng, 13) - 1.5f;
            ray.dir[k] = steps[rng_below(&rng, ARRAY_COUNT(steps))];
        }
        uint32_t from = rng_below(&rng, 4);
        ray.tmin = ends[from];
        ray.tmax = ends[from + 1 + rng_below(&rng, 4 - from)];
        int contacts = contacts_of(&ray, contact);
        if (contacts < 0 || !ray_in_contract(&ray))
            continue;
        bool known = parity_can_be_known(&ray, contact, contacts);
        unsigned parity =
            is_within_box(&ray, (double)ray.tmin) != is_within_box(&ray, (double)ray.tmax);
        mesh.c->ray = ray;
        check_any_list(&mesh, &rng, known, parity);
        count[known][parity]++;
    }
    assert_true(count[0][0] > 1000 && count[0][1] > 500);
    assert_true(count[1][0] > 5000 && count[1][1] > 2000);
    mesh_free(&mesh);
}

/* The directions that are tried from the origin of a ray. */
#define TRIED 8u
static const float tried[TRIED][3] = {{0.5413f, 0.7291f, -0.4187f},  {-0.6821f, 0.2719f, 0.6793f},
                                      {0.1373f, -0.8117f, 0.5677f},  {-0.4391f, -0.5323f, -0.7237f},
                                      {0.8819f, 0.0947f, 0.4618f},   {0.3331f, 0.6197f, 0.7109f},
                                      {-0.2411f, 0.9043f, -0.3527f}, {-0.9341f, -0.1879f, 0.3037f}};

/* The box, made larger, with a corner of a small tetrahedron in each of these directions. */
static struct scene box_with_corners_at(const float at[][3], uint32_t count)
{
    static const uint32_t index[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    struct scene box = closed_box(), scene;
    assert_int_equal(scene_make(8 + 4 * count, 12 + 4 * count, &scene), STATUS_OK);
    for (size_t i = 0; i < 24; i++)
        scene.vertex[i] = 4 * box.vertex[i];
    memcpy(scene.index, box.index, 36 * sizeof *box.index);
    scene_free(&box);
    for (uint32_t n = 0; n < count; n++)
        for (uint32_t c = 0; c < 4; c++)
            for (uint32_t k = 0; k < 3; k++) {
                float aside = c == k + 1 ? 0.0625f : 0;
                scene.vertex[3 * (8 + 4 * n + c) + k] = (c ? 1.25f : 1.0f) * at[n][k] + aside;
                scene.index[3 * (12 + 4 * n + c) + k] = 8 + 4 * n + index[c][k];
            }
    return scene;
}

/* From the inside of a box, at a corner: one generic direction of eight is enough to know where the
 * origin is, whichever it is, and if each of them meets a corner, it is not known. */
static void eight_directions_are_tried_for_a_generic_one(void **state)
{
    (void)state;
    for (uint32_t free_one = 0; free_one <= TRIED; free_one++) {
        float at[TRIED][3];
        uint32_t count = 0;
        for (uint32_t d = 0; d < TRIED; d++)
            if (d != free_one)
                memcpy(at[count++], tried[d], sizeof tried[d]);
        struct all_mesh mesh = mesh_of(box_with_corners_at((const float(*)[3])at, count));
        struct judged_list none = empty;
        assert_true(mesh.closed);
        mesh.c->ray = (struct ray){{0, 0, 0}, 0, {0, 0, 0}, 1e30f};
        memcpy(mesh.c->ray.dir, at[0], sizeof at[0]);
        struct list_mesh said = said_of(&mesh, &none);
        assert_int_equal(said.parity, free_one < TRIED);
        assert_int_equal(said.parity_off, free_one < TRIED);
        mesh_free(&mesh);
    }
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
        cmocka_unit_test(parity_of_an_open_mesh_is_not_known),
        cmocka_unit_test(parity_is_known_and_right_wherever_it_can_be),
        cmocka_unit_test(eight_directions_are_tried_for_a_generic_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
