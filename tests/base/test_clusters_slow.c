/* Clusters from below (ploc, ploctree), node by node, against a slow builder that compares every
 * cluster with each neighbour anew in every round; at the borders of parts and of rounds that join
 * little. */
#include "ref/tree/bvh.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/base/slow_tree.h"
#include "tests/support/built.h"

/* Nodes 0 .. triangles - 1 are the triangles. */
struct slow_join {
    uint32_t fst, snd, leaves;
};

struct slow_clusters {
    struct slow_join *join;
    struct box *box; /* of the clusters, in order */
    uint32_t *node;
    uint32_t *choice;
    uint32_t joins, count, radius, triangles;
    struct slow_tree tree;
    struct build_traffic traffic;
};

/* Integers: exact. */
static float common_area(const struct slow_clusters *s, uint32_t i, uint32_t j)
{
    struct box box = s->box[i];
    float side[3];
    box_add_box(&box, &s->box[j]);
    for (int k = 0; k < 3; k++)
        side[k] = box.hi[k] - box.lo[k];
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

/* The smallest common box; of equal ones the place that differs in lower bits. */
static uint32_t best_of(const struct slow_clusters *s, uint32_t i)
{
    uint32_t best = i;
    for (uint32_t j = 0; j < s->count; j++) {
        if (i == j || (i < j ? j - i : i - j) > s->radius)
            continue;
        float mine = common_area(s, i, j), other = best == i ? INFINITY : common_area(s, i, best);
        if (mine < other || (mine == other && (i ^ j) < (i ^ best)))
            best = j;
    }
    return best;
}

/* Joins the clusters that chose each other, at the place of the first. */
static void join(struct slow_clusters *s)
{
    uint32_t left = 0;
    s->traffic.sweeps++;
    s->traffic.boxes_read += s->count;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t j = s->choice[i], node = s->node[i];
        struct box box = s->box[i];
        if (s->choice[j] == i && j < i)
            continue;
        if (s->choice[j] == i) {
            box_add_box(&box, &s->box[j]);
            s->join[s->joins] = (struct slow_join){
                node, s->node[j], s->join[node].leaves + s->join[s->node[j]].leaves};
            node = s->joins++;
        }
        s->box[left] = box;
        s->node[left++] = node;
        s->traffic.boxes_written++;
    }
    s->count = left;
}

static void round_of(struct slow_clusters *s)
{
    uint32_t before = s->count;
    for (uint32_t i = 0; i < s->count; i++)
        s->choice[i] = best_of(s, i);
    join(s);
    /* Few of many have joined, less than a sixteenth: neighbours join in pairs, and a last one
     * that is alone chooses one that has another. */
    if (before <= 1024 || before - s->count >= before / 16)
        return;
    for (uint32_t i = 0; i < s->count; i++)
        s->choice[i] = i % 2 ? i - 1 : i + 1 < s->count ? i + 1 : i - 1;
    join(s);
}

/* The triangles below a node, in order. */
static uint32_t list(const struct slow_clusters *s, uint32_t node, uint32_t *out)
{
    if (node < s->triangles) {
        *out = node;
        return 1;
    }
    uint32_t first = list(s, s->join[node].fst, out);
    return first + list(s, s->join[node].snd, out + first);
}

static void write_halves(struct slow_clusters *s, const uint32_t *prim, uint32_t count)
{
    if (count == 1) {
        slow_leaf(&s->tree, prim, 1);
        return;
    }
    uint32_t mine = slow_open(&s->tree);
    s->tree.node[mine].fst = s->tree.nodes;
    write_halves(s, prim, count / 2);
    s->tree.node[mine].snd = s->tree.nodes;
    write_halves(s, prim + count / 2, count - count / 2);
}

/* What would be deeper than 60 is halved. */
static void write_node(struct slow_clusters *s, uint32_t node, uint32_t depth)
{
    if (node < s->triangles) {
        slow_leaf(&s->tree, &node, 1);
        return;
    }
    const struct slow_join *from = &s->join[node];
    uint32_t a = s->join[from->fst].leaves, b = s->join[from->snd].leaves, more = 0;
    while ((1u << more) < (a > b ? a : b))
        more++;
    if (depth + 1 + more > 60) {
        uint32_t *prim = calloc(from->leaves, sizeof *prim);
        assert_non_null(prim);
        write_halves(s, prim, list(s, node, prim));
        free(prim);
        return;
    }
    uint32_t mine = slow_open(&s->tree);
    s->tree.node[mine].fst = s->tree.nodes;
    write_node(s, from->fst, depth + 1);
    s->tree.node[mine].snd = s->tree.nodes;
    write_node(s, from->snd, depth + 1);
}

static void compare_builders(const struct slow_clusters *s, const struct scene *scene,
                             uint32_t radius)
{
    static const char *const names[] = {"ploc", "ploctree"};
    const struct build_options options = {.leaf = 1, .radius = radius};
    struct build_traffic traffic;
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        struct bvh bvh;
        assert_int_equal(builder_find(names[i])->build(scene, &options, &bvh, NULL), STATUS_OK);
        slow_compare(&s->tree, &bvh, scene, names[i]);
        bvh_free(&bvh);
    }
    assert_null(builder_find("ploc")->traffic);
    assert_int_equal(builder_find("ploctree")->traffic(scene, &options, &traffic, NULL), STATUS_OK);
    assert_int_equal(traffic.sweeps, s->traffic.sweeps);
    assert_int_equal(traffic.boxes_read, s->traffic.boxes_read);
    assert_int_equal(traffic.boxes_written, s->traffic.boxes_written);
}

static void compare(const struct scene *scene, uint32_t option, uint32_t radius)
{
    uint32_t count = scene->tri_count;
    struct slow_clusters s = {.join = calloc(2 * (size_t)count, sizeof *s.join),
                              .box = calloc(count, sizeof *s.box),
                              .node = calloc(count, sizeof *s.node),
                              .choice = calloc(count, sizeof *s.choice),
                              .joins = count,
                              .count = count,
                              .radius = radius,
                              .triangles = count,
                              .tree = slow_room(count)};
    struct slow_item *item = slow_items(scene);
    assert_true(s.join && s.box && s.node && s.choice);
    (void)slow_codes(item, count);
    for (uint32_t i = 0; i < count; i++) {
        s.box[i] = item[i].box;
        s.node[i] = item[i].prim;
        s.join[i].leaves = 1;
    }
    while (s.count > 1)
        round_of(&s);
    write_node(&s, s.node[0], 0);
    compare_builders(&s, scene, option);
    slow_free(&s.tree);
    free(item);
    free(s.join);
    free(s.box);
    free(s.node);
    free(s.choice);
}

/* 0 is the default of 16, and none is more than 256. */
static void clusters_are_the_slow_ones(void **state)
{
    static const uint32_t spans[] = {1, 3, 40, 3000}, sizes[] = {1, 2, 9};
    static const uint32_t radii[][2] = {{0, 16}, {1, 1}, {2, 2}, {256, 256}, {257, 256}};
    (void)state;
    for (size_t s = 0; s < ARRAY_COUNT(spans) * ARRAY_COUNT(sizes); s++)
        for (uint32_t count = 1; count <= 340; count += 1 + count * 3 / 4)
            for (size_t r = 0; r < ARRAY_COUNT(radii); r++) {
                struct scene scene = slow_scene(count, spans[s / 3], sizes[s % 3], s);
                compare(&scene, radii[r][0], radii[r][1]);
                scene_free(&scene);
            }
}

/* More than a thread chooses for at once. */
static void parts_are_the_slow_ones(void **state)
{
    static const uint32_t counts[] = {1023, 1024, 1025, 2048, 2049};
    (void)state;
    for (size_t c = 0; c < ARRAY_COUNT(counts); c++)
        for (uint32_t radius = 1; radius <= 40; radius += 39) {
            struct scene scene = slow_scene(counts[c], 60, 3, radius);
            compare(&scene, radius, radius);
            scene_free(&scene);
        }
}

/* Squares across a line, in runs of falling (or rising) sizes that are far from each other: in each
 * run only the smallest two choose each other. Runs have `run` squares, the last one the rest. */
static struct scene falling(uint32_t count, uint32_t run, bool rising)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *p = scene.vertex + 9 * (size_t)i + 3 * (size_t)c;
            float half = (float)(rising ? count + i % run : 2 * count - i % run);
            p[0] = (float)(i + i / run * 4096);
            p[1] = c == 0 ? -half : half;
            p[2] = c == 1 ? -half : half;
        }
    return scene;
}

/* A round of 1040 must join 65. */
static void rounds_that_join_few_are_the_slow_ones(void **state)
{
    static const uint32_t shape[][2] = {{1024, 1024}, {1025, 1025}, {1026, 1026},
                                        {1040, 16},   {1040, 17},   {1055, 16}};
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(shape); i++)
        for (int rising = 0; rising < 2; rising++) {
            struct scene scene = falling(shape[i][0], shape[i][1], rising);
            compare(&scene, 1, 1);
            scene_free(&scene);
        }
}

/* Whatever the scene, leaves of several triangles included. */
static void a_stream_makes_the_tree_of_ploc(void **state)
{
    static const uint32_t radii[] = {1, 5, 0, 256};
    (void)state;
    for (uint32_t i = 0; i < BUILT_SCENES * ARRAY_COUNT(radii); i++) {
        const struct build_options options = {.leaf = 1 + i % 3, .radius = radii[i % 4]};
        const char *what;
        struct scene scene = built_scene(i / 4, &what);
        struct bvh ploc, stream;
        assert_int_equal(builder_find("ploc")->build(&scene, &options, &ploc, NULL), STATUS_OK);
        assert_int_equal(builder_find("ploctree")->build(&scene, &options, &stream, NULL),
                         STATUS_OK);
        if (!built_same(&ploc, &stream))
            fail_msg("%s, radius %u: another tree", what, options.radius);
        bvh_free(&ploc);
        bvh_free(&stream);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_are_the_slow_ones),
        cmocka_unit_test(parts_are_the_slow_ones),
        cmocka_unit_test(rounds_that_join_few_are_the_slow_ones),
        cmocka_unit_test(a_stream_makes_the_tree_of_ploc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
