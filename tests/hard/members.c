#include "tests/hard/members.h"

#include <fnmatch.h>
#include <string.h>

static bool asks(const struct hard_case *one, enum query query)
{
    return query != QUERY_ALL || one->flags & HARD_PARITY;
}

static void each_engine(const struct hard_case *one, struct hard_member *member, hard_visit *visit,
                        void *user)
{
    for (enum query q = QUERY_CLOSEST; q < QUERY_COUNT; q++)
        for (size_t e = 0; asks(one, q) && engines[e]; e++)
            if (engines[e]->needs_packed) {
                member->query = q;
                member->engine = engines[e];
                visit(user, one, member);
            }
}

static void each_without_tree(const struct hard_case *one, const struct hard_tables *tables,
                              hard_visit *visit, void *user)
{
    for (size_t e = 0; engines[e]; e++)
        for (size_t t = 0; tables->tri[t] && (t == 0 || !engines[e]->own_tri); t++)
            for (enum query q = QUERY_CLOSEST; q < QUERY_COUNT; q++)
                if (!engines[e]->needs_packed && asks(one, q))
                    visit(user, one,
                          &(struct hard_member){
                              .query = q, .engine = engines[e], .tri = tables->tri[t]});
}

/* A member of no table: what it does not name is repaired. */
static void visit_made(const struct hard_case *one, const struct hard_defect *defect,
                       hard_visit *visit, void *user)
{
    struct hard_member member = {.query = QUERY_CLOSEST,
                                 .engine = defect->engine ? defect->engine : engine_reference(true),
                                 .layout = defect->layout ? defect->layout : layout_find("f32"),
                                 .builder = builder_find("median"),
                                 .box = box_test_find("robust")};
    for (size_t t = 0; tri_tests[t]; t++) {
        member.tri = tri_tests[t];
        if (tri_tests[t]->core && !tri_tests[t]->faithful)
            visit(user, one, &member);
    }
}

/* --- the others ---------------------------------------------------------------------------------
 * The product is of a few layouts and builders. Every other layout meets one of any three
 * neighbouring cases on engine cpu, and every case all builders. With k = (case + layout) / 3,
 * places in their tables, k says builder, box test, triangle test and query, so that for a case as
 * for a layout they come by turns. Of the other engines that walk trees each meets a layout in one
 * of so many of these, since each of its layouts costs a program. */
#define CASES_APART        3u
#define CASES_OF_AN_ENGINE 16u

bool hard_table_has(const struct layout *const *table, const struct layout *layout)
{
    while (*table && *table != layout)
        table++;
    return *table != NULL;
}

/* How many builders are repaired; *out (may be NULL) is the one at `place` among them. */
static uint32_t repaired_builders(const struct builder **out, uint32_t place)
{
    uint32_t count = 0;
    for (size_t b = 0; builders_all[b]; b++)
        if (!builders_all[b]->faithful && count++ == place && out)
            *out = builders_all[b];
    return count;
}

/* Repaired members only: the errors of published ones are known. */
static struct hard_member covered(uint32_t k, const struct layout *layout)
{
    struct hard_member m = {.layout = layout, .engine = engine_reference(true)};
    const uint32_t count = repaired_builders(NULL, 0);
    const uint32_t tests = k + k / count; /* every builder meets all that these say */
    (void)repaired_builders(&m.builder, k % count);
    m.box = box_test_find(tests % 2 ? "watertight" : "robust");
    m.tri = tri_test_find(tests / 2 % 2 ? "woop" : "mt");
    m.query = tests / 4 % 2 ? QUERY_ANY : QUERY_CLOSEST;
    return m;
}

/* Which of the other engines meets the layout, too, if any. */
static const struct engine *covered_by(uint32_t k, const struct layout *layout)
{
    uint32_t turn = k % CASES_OF_AN_ENGINE;
    for (size_t e = 0; engines[e]; e++)
        if (engines[e]->needs_packed && engines[e] != engine_reference(true) && turn-- == 0)
            return engine_takes(engines[e], layout) ? engines[e] : NULL;
    return NULL;
}

static void each_other_layout(const struct hard_case *one, hard_visit *visit, void *user)
{
    const uint32_t count = repaired_builders(NULL, 0);
    uint32_t first = 0;
    while (hard_case_at(first) != one)
        first++;
    for (uint32_t turn = 0; turn < count; turn++) /* neighbours share the tree */
        for (uint32_t l = 0; layouts_all[l]; l++) {
            const struct layout *layout = layouts_all[l];
            const uint32_t s = first + l, k = s / CASES_APART;
            if (layout->faithful || layout->outside || hard_table_has(layouts, layout) ||
                s % CASES_APART != 0 || k % count != turn)
                continue;
            struct hard_member member = covered(k, layout);
            visit(user, one, &member);
            member.engine = covered_by(k, layout);
            if (member.engine)
                visit(user, one, &member);
        }
}

/* --- worlds ---------------------------------------------------------------------------------- */

static bool traces_worlds(const struct engine *engine, enum query query)
{
    return engine->worlds && (query != QUERY_ALL || engine->worlds->trace_world_all);
}

/* Every query of each engine that walks such trees. The vulkan engine has one layout for both. */
static void each_tree_of_worlds(const struct hard_case *one, struct hard_member *m,
                                hard_visit *visit, void *user)
{
    for (size_t e = 0; engines[e]; e++)
        for (enum query q = QUERY_CLOSEST; q < QUERY_COUNT; q++) {
            if (!engines[e]->needs_packed || !traces_worlds(engines[e], q) ||
                (m->top && engines[e] != engine_reference(true)))
                continue;
            m->engine = engines[e];
            m->query = q;
            visit(user, one, m);
        }
}

/* Repaired members alone: what is as published loses instances as it does triangles. */
static void each_test_in_world(const struct hard_case *one, const struct hard_tables *tables,
                               struct hard_member m, hard_visit *visit, void *user)
{
    for (size_t x = 0; tables->box[x]; x++)
        for (size_t t = 0; tables->tri[t]; t++) {
            m.box = tables->box[x];
            m.tri = tables->tri[t];
            if (hard_member_published(&m) == 0)
                each_tree_of_worlds(one, &m, visit, user);
        }
}

/* The layouts with one builder. Without a choice of the user's each is once the layout of the
 * meshes below the one before it. */
static void each_layout_in_world(const struct hard_case *one, const struct hard_tables *tables,
                                 const struct builder *builder, hard_visit *visit, void *user)
{
    struct hard_member m = {.builder = builder};
    const struct layout *before = NULL;
    for (size_t l = 0; tables->layout[l]; l++) {
        m.layout = tables->layout[l];
        m.top = NULL;
        if (m.layout->faithful)
            continue;
        each_test_in_world(one, tables, m, visit, user);
        m.top = tables->chosen ? NULL : before;
        if (m.top)
            each_test_in_world(one, tables, m, visit, user);
        before = m.layout;
    }
}

static void each_treeless_in_world(const struct hard_case *one, const struct hard_tables *tables,
                                   hard_visit *visit, void *user)
{
    for (size_t e = 0; engines[e]; e++)
        for (size_t t = 0; tables->tri[t] && (t == 0 || !engines[e]->own_tri); t++)
            for (enum query q = QUERY_CLOSEST; q < QUERY_COUNT; q++)
                if (!engines[e]->needs_packed && traces_worlds(engines[e], q) &&
                    !tables->tri[t]->faithful)
                    visit(user, one,
                          &(struct hard_member){
                              .query = q, .engine = engines[e], .tri = tables->tri[t]});
}

/* Without a choice of the user's the builder is one that comes by turns. */
static void each_in_world(const struct hard_case *one, const struct hard_tables *tables,
                          hard_visit *visit, void *user)
{
    const struct builder *turn = NULL;
    (void)repaired_builders(&turn, one->number % repaired_builders(NULL, 0));
    for (size_t b = 0; tables->chosen && tables->builder[b]; b++)
        each_layout_in_world(one, tables, tables->builder[b], visit, user);
    if (!tables->chosen)
        each_layout_in_world(one, tables, turn, visit, user);
    each_treeless_in_world(one, tables, visit, user);
}

struct hard_tables hard_tables_all(void)
{
    return (struct hard_tables){layouts, builders, box_tests, tri_tests, false};
}

void hard_each_member(const struct hard_case *one, const struct hard_tables *tables,
                      hard_visit *visit, void *user)
{
    struct hard_member m = {0};
    if (one->probe) {
        m.engine = engine_find("vulkan");
        m.tri = tri_tests[0];
        visit(user, one, &m);
        return;
    }
    if (one->flags & HARD_WORLD) {
        each_in_world(one, tables, visit, user);
        return;
    }
    for (size_t b = 0; tables->builder[b] && !(one->flags & HARD_NO_TREES); b++)
        for (size_t l = 0; tables->layout[l]; l++)
            for (size_t x = 0; tables->box[x]; x++)
                for (size_t t = 0; tables->tri[t]; t++) {
                    m.builder = tables->builder[b];
                    m.layout = tables->layout[l];
                    m.box = tables->box[x];
                    m.tri = tables->tri[t];
                    each_engine(one, &m, visit, user);
                }
    for (size_t d = 0; d < HARD_DEFECTS_MOST && one->defect[d].fault && !tables->chosen; d++)
        if (one->defect[d].layout || one->defect[d].engine)
            visit_made(one, &one->defect[d], visit, user);
    if (!(one->flags & HARD_NO_TREES) && !tables->chosen)
        each_other_layout(one, visit, user);
    if (!(one->flags & HARD_TREES_ONLY))
        each_without_tree(one, tables, visit, user);
}

/* An engine that makes its own records of a tree, with box tests of its own, has no defect of a
 * layout or a box test, and none of a triangle test that it does not use: what it can show is the
 * builder's, or that of a published triangle test. */
static bool can_show(const struct hard_defect *defect, const struct hard_member *member)
{
    const struct engine *engine = member->engine;
    bool own = engine->needs_packed && (engine->own_tri || engine->own_tree);
    bool published = (member->builder && member->builder->faithful) ||
                     (!engine->own_tri && member->tri && member->tri->faithful);
    return !own || defect->engine || published;
}

const struct hard_defect *hard_defect_of(const struct hard_case *one,
                                         const struct hard_member *member)
{
    char name[HARD_NAME_MOST];
    hard_member_print(member, name);
    for (size_t d = 0; d < HARD_DEFECTS_MOST && one->defect[d].fault; d++) {
        const struct hard_defect *defect = &one->defect[d];
        if (!can_show(defect, member) || (defect->layout && defect->layout != member->layout) ||
            (defect->engine && defect->engine != member->engine))
            continue;
        if (fnmatch(defect->members, name, 0) == 0)
            return defect;
    }
    return NULL;
}
