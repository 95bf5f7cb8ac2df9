/* Answers before the judge. Include after cmocka.h. */
#ifndef JUDGE_FIXTURE_H
#define JUDGE_FIXTURE_H

#include "ref/judge/judge.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

/* Every kind of engine that can be judged. */
struct fixture_subject {
    const char *name;
    const char *tri; /* what it runs, or is asked to */
    struct model model;
};

static const struct fixture_subject subjects[] = {
    {"mt", "mt", {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}, .bits = true}},
    {"mt_rtrs",
     "mt_rtrs",
     {.formula = TWIN_MT_RTRS, .rounding = {1, 1, 1, 0x1p-149}, .bits = true, .open = true}},
    {"woop",
     "woop",
     {.formula = TWIN_WOOP, .rounding = {1, 1, 1, 0x1p-149}, .bits = true, .watertight = true}},
    {"mt, Vulkan's rounding", "mt", {.formula = TWIN_MT, .rounding = {2, 2, 5, 0x1p-126}}},
    {"woop, Vulkan's rounding", "woop", {.formula = TWIN_WOOP, .rounding = {2, 2, 5, 0x1p-126}}},
    {"pluecker",
     "pluecker",
     {.formula = TWIN_PLUECKER, .rounding = {1, 1, 1, 0x1p-149}, .bits = true}},
    {"baldwin_webber",
     "baldwin_webber",
     {.formula = TWIN_BALDWIN_WEBBER, .rounding = {1, 1, 1, 0x1p-149}, .bits = true}},
    {"embree",
     "mt",
     {.formula = TWIN_EMBREE,
      .rounding = {1, 1, 5.5, 0x1p-126},
      .slab = true,
      .any_unnamed = true}},
    {"embree_robust",
     "mt",
     {.formula = TWIN_EMBREE_ROBUST, .rounding = {1, 1, 5.5, 0x1p-126}, .any_unnamed = true}},
    {"unknown", "mt", {.formula = TWIN_UNKNOWN}},
};
#define SUBJECTS ARRAY_COUNT(subjects)

/* The subject of that name. */
static inline const struct fixture_subject *subject_of(const char *name)
{
    for (size_t s = 0; s < SUBJECTS; s++)
        if (strcmp(subjects[s].name, name) == 0)
            return &subjects[s];
    fail_msg("no subject is called %s", name);
    return NULL;
}

static inline bool is_unknown(const struct fixture_subject *subject)
{
    return subject->model.formula == TWIN_UNKNOWN;
}

/* A scene, its oracle, and the judge of one subject. */
struct judge_fixture {
    struct scene scene;
    struct oracle *oracle;
    struct judge *judge;
    const struct fixture_subject *subject;
    struct ray ray;
    struct oracle_answer truth;
    struct judgement judgement; /* the last */
};

static inline void judge_fixture_seat(struct judge_fixture *c,
                                      const struct fixture_subject *subject, enum query query)
{
    struct reason reason = {""};
    judge_free(c->judge);
    c->subject = subject;
    if (judge_make(c->oracle, &subject->model, query, &c->judge, &reason))
        fail_msg("%s", reason.text);
}

/* The fixture takes the scene. */
static inline struct judge_fixture *judge_fixture_of(struct scene scene)
{
    struct reason reason = {""};
    struct judge_fixture *c = calloc(1, sizeof *c);
    assert_non_null(c);
    c->scene = scene;
    if (oracle_make(&c->scene, &c->oracle, &reason))
        fail_msg("%s", reason.text);
    return c;
}

static inline struct judge_fixture *judge_fixture_open(const char *spec, uint64_t seed)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, seed, &scene, &reason))
        fail_msg("%s", reason.text);
    return judge_fixture_of(scene);
}

static inline void judge_fixture_close(struct judge_fixture *c)
{
    judge_free(c->judge);
    oracle_free(c->oracle);
    scene_free(&c->scene);
    free(c);
}

static inline void judge_fixture_ask(struct judge_fixture *c, struct ray ray)
{
    struct reason reason = {""};
    c->ray = ray;
    if (oracle_closest(c->oracle, ORACLE_BRUTE, ORACLE_CLOSED, &ray, 1, 1, &c->truth, NULL,
                       &reason))
        fail_msg("%s", reason.text);
}

static inline enum verdict verdict(struct judge_fixture *c, struct hit answer)
{
    assert_int_equal(judge_answer(c->judge, &c->ray, &c->truth, &answer, &c->judgement), STATUS_OK);
    assert_int_equal(c->judgement.verdict == VERDICT_WRONG, c->judgement.wrong != WRONG_NOT);
    return c->judgement.verdict;
}

static inline void must_be(struct judge_fixture *c, struct hit answer, enum verdict expected)
{
    char line[400];
    if (verdict(c, answer) == expected)
        return;
    judge_line(&c->ray, &c->judgement, &answer, line, sizeof line);
    fail_msg("%s: %s (%s), not %s: %s", c->subject->name, verdict_name(c->judgement.verdict),
             wrong_name(c->judgement.wrong), verdict_name(expected), line);
}

static inline void must_be_wrong(struct judge_fixture *c, struct hit answer, enum wrong expected)
{
    must_be(c, answer, VERDICT_WRONG);
    if (c->judgement.wrong != expected)
        fail_msg("%s: %s, not %s", c->subject->name, wrong_name(c->judgement.wrong),
                 wrong_name(expected));
}

static inline struct hit a_miss(void)
{
    return (struct hit){.prim = ABI_NO_PRIM};
}

/* The right answer for triangle `prim`, from the same numbers in double. */
static inline struct hit right_answer(const struct judge_fixture *c, uint32_t prim)
{
    float v[3][3];
    double p[3][3], n[3][3], w[3], side = 0;
    scene_tri(&c->scene, prim, v);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            p[i][k] = (double)v[i][k] - (double)c->ray.org[k];
    for (int i = 0; i < 3; i++) {
        const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
        w[i] = 0;
        for (int k = 0; k < 3; k++) {
            n[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
            w[i] += (double)c->ray.dir[k] * n[i][k];
        }
    }
    for (int k = 0; k < 3; k++)
        side += p[0][k] * n[0][k];
    double det = w[0] + w[1] + w[2];
    return (struct hit){(float)(side / det), (float)(w[1] / det), (float)(w[2] / det), prim};
}

/* Two layers of one quad each, at z = 1 and z = 2, and a duplicate of triangle 0 as triangle 4. */
static inline struct scene layers(void)
{
    struct scene scene;
    static const float vertex[8][3] = {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1},
                                       {-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
    static const uint32_t index[5][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {0, 1, 2}};
    assert_int_equal(scene_make(8, 5, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    return scene;
}

static inline struct ray along_z(float x, float y)
{
    return (struct ray){{x, y, 0}, 0, {0, 0, 1}, 1e30f};
}

/* The layers without the duplicate, before a ray through the inside of triangles 0 and 2. */
static inline struct judge_fixture *inside(void)
{
    struct scene scene = layers();
    scene.tri_count = 4;
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_ask(c, along_z(0.5f, -0.25f));
    assert_int_equal(c->truth.prim, 0);
    return c;
}

#endif
