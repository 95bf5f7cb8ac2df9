/* Which pairs can meet, and how often they did. */
#include "fuzz/feedback/pair_coverage_inner.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

const char *pair_factor_name(enum pair_factor factor)
{
    static const char *const names[MEET_FACTORS] = {"engine", "layout", "builder",  "store",
                                                    "tri",    "box",    "optimize", "motion"};
    return names[factor];
}

const struct pair_tables *pair_coverage_tables(const struct pair_coverage *m)
{
    return &m->tables;
}

const char *pair_coverage_name(const struct pair_coverage *m, enum pair_factor factor, uint32_t i)
{
    static const char *const optimize[MEET_OPTIMIZATIONS] = {"plain", "reinsert", "rotate"};
    if (factor == MEET_OPTIMIZE)
        return optimize[i];
    if (factor == MEET_MOTION)
        return i == 0 ? "still" : "moved";
    return *(const char *const *)m->tables.member[factor][i]; /* all begin with their names */
}

struct coverage_pair *pair_coverage_of_pair(const struct pair_coverage *m, enum pair_factor a,
                                            uint32_t i, enum pair_factor b, uint32_t j)
{
    assert(a != b); /* a factor is in no pair with itself */
    if (a > b)
        return pair_coverage_of_pair(m, b, j, a, i);
    return &m->pair[m->place[a][b] + (size_t)i * m->tables.count[b] + j];
}

/* --- what can meet --------------------------------------------------------------------------- */

bool pair_coverage_meets(const struct engine *engine, enum pair_factor factor)
{
    bool tests = factor == MEET_TRI || factor == MEET_BOX;
    if (factor == MEET_ENGINE)
        return true;
    if (engine->own_tri && !engine->needs_packed) /* all is its own: it is drawn for itself */
        return factor == MEET_MOTION;
    if (engine->own_tri && tests) /* its traversal is its own, too */
        return false;
    return engine->needs_packed || factor == MEET_TRI;
}

/* Triangles that every layout and storage can hold if it can hold any: few, and on a grid. */
static enum status make_sample(struct scene *out, struct bvh *bvh, struct reason *reason)
{
    const struct build_options build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT, .threads = 1};
    enum status status = scene_make(12, 4, out);
    if (status)
        return fail(reason, status, "no memory for a sample of four triangles");
    for (uint32_t i = 0; i < 12; i++) {
        out->index[i] = i;
        out->vertex[3 * i] = (float)(4 * (i / 3) + i % 3);
        out->vertex[3 * i + 1] = (float)(i % 3 == 1);
        out->vertex[3 * i + 2] = (float)(i % 3 == 2);
    }
    status = builders[0]->build(out, &build, bvh, reason);
    if (status)
        scene_free(out);
    return status;
}

static enum status layout_takes(const struct layout *layout, const struct tri_store *store,
                                bool *takes, struct reason *reason)
{
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    enum status status = make_sample(&scene, &bvh, reason);
    if (status)
        return status;
    status = packed_make_stored(layout, store, &bvh, &scene, &packed, reason);
    *takes = status == STATUS_OK;
    if (!status)
        packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    return status == STATUS_MEMORY ? status : STATUS_OK;
}

/* a < b. Pairs of the same factor of the product that no rule refuses are possible. */
static enum status can_meet(const struct pair_tables *t, enum pair_factor a, uint32_t i,
                            enum pair_factor b, uint32_t j, bool *can, struct reason *reason)
{
    const void *x = t->member[a][i], *y = t->member[b][j];
    *can = true;
    if (a == MEET_ENGINE) {
        const struct engine *engine = x;
        *can = pair_coverage_meets(engine, b);
        if (b == MEET_LAYOUT && engine->needs_packed)
            *can = engine_takes(engine, y);
        if (b == MEET_MOTION && !engine->needs_packed) /* it has no tree to refit; drawn or not */
            *can = *can && j == 0 && t->count[MEET_MOTION] > 1;
    } else if (a == MEET_LAYOUT && b == MEET_STORE) {
        return layout_takes(x, y, can, reason);
    } else if (a == MEET_LAYOUT && b == MEET_MOTION) {
        *can = j == 0 || ((const struct layout *)x)->rebound;
    } else if (a == MEET_BUILDER && b == MEET_OPTIMIZE) {
        *can = j == 0 || !((const struct builder *)x)->faithful;
    } else if (a == MEET_STORE && b == MEET_TRI) {
        *can = tri_store_answers(x, ((const struct tri_test *)y)->id);
    } else if (a == MEET_STORE && b == MEET_MOTION) { /* what moved is on no grid */
        *can = j == 0 || !((const struct tri_store *)x)->lossy;
    }
    return STATUS_OK;
}

/* True if an engine of the tables meets both factors: else no trial shows a pair of them. */
static bool is_shared(const struct pair_tables *t, enum pair_factor a, enum pair_factor b)
{
    for (uint32_t i = 0; i < t->count[MEET_ENGINE]; i++)
        if (pair_coverage_meets(t->member[MEET_ENGINE][i], a) &&
            pair_coverage_meets(t->member[MEET_ENGINE][i], b))
            return true;
    return false;
}

static enum status find_possible(struct pair_coverage *m, struct reason *reason)
{
    const struct pair_tables *t = &m->tables;
    enum status status = STATUS_OK;
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
        for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++)
            for (uint32_t i = 0; i < t->count[a] && is_shared(t, a, b); i++)
                for (uint32_t j = 0; j < t->count[b] && !status; j++)
                    status = can_meet(t, a, i, b, j,
                                      &pair_coverage_of_pair(m, a, i, b, j)->possible, reason);
    return status;
}

enum status pair_coverage_open(const struct pair_tables *tables, struct pair_coverage **out,
                               struct reason *reason)
{
    struct pair_coverage *m = alloc_zeroed(1, sizeof *m);
    *out = NULL;
    if (!m)
        return fail(reason, STATUS_MEMORY, "no memory to count pairs");
    m->tables = *tables;
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++) {
        if (tables->count[a] == 0) {
            free(m);
            return fail(reason, STATUS_INPUT, "pairs: there is no %s", pair_factor_name(a));
        }
        for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++) {
            m->place[a][b] = m->pairs;
            m->pairs += (size_t)tables->count[a] * tables->count[b];
        }
    }
    m->pair = alloc_zeroed(m->pairs, sizeof *m->pair);
    m->program = alloc_zeroed((size_t)tables->count[MEET_ENGINE] * tables->count[MEET_LAYOUT],
                              sizeof *m->program);
    enum status status = m->pair && m->program
                             ? find_possible(m, reason)
                             : fail(reason, STATUS_MEMORY, "no memory to count pairs");
    if (status)
        pair_coverage_close(m);
    else
        *out = m;
    return status;
}

void pair_coverage_close(struct pair_coverage *m)
{
    if (m) {
        free(m->pair);
        free(m->program);
    }
    free(m);
}

/* --- how often they did ---------------------------------------------------------------------- */

static uint16_t place_of(const struct pair_tables *t, enum pair_factor factor, const void *member)
{
    for (uint32_t i = 0; i < t->count[factor]; i++)
        if (t->member[factor][i] == member)
            return (uint16_t)i;
    return MEET_NONE;
}

struct combination pair_coverage_of(const struct pair_coverage *m, const struct engine *engine,
                                    const struct layout *layout, const struct builder *builder,
                                    const struct tri_store *store, const struct tri_test *tri,
                                    const struct box_test *box, uint32_t optimized, bool moved)
{
    const struct pair_tables *t = &m->tables;
    const void *const member[] = {engine, layout, builder, store, tri, box};
    struct combination out;
    for (enum pair_factor f = 0; f < MEET_OPTIMIZE; f++)
        out.member[f] = place_of(t, f, member[f]);
    out.member[MEET_OPTIMIZE] =
        optimized < t->count[MEET_OPTIMIZE] ? (uint16_t)optimized : MEET_NONE;
    out.member[MEET_MOTION] = moved < t->count[MEET_MOTION] ? moved : MEET_NONE;
    for (enum pair_factor f = 0; f < MEET_FACTORS; f++)
        if (!pair_coverage_meets(engine, f))
            out.member[f] = MEET_NONE;
    return out;
}

void pair_coverage_add(struct pair_coverage *m, const struct combination *met)
{
    for (enum pair_factor a = 0; a < MEET_FACTORS; a++)
        for (enum pair_factor b = a + 1; b < MEET_FACTORS; b++)
            if (met->member[a] != MEET_NONE && met->member[b] != MEET_NONE)
                pair_coverage_of_pair(m, a, met->member[a], b, met->member[b])->met++;
}
