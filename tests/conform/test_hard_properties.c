/* Every property of the hard cases, broken on purpose: an engine that spoils the right answers in
 * one way, which the property must see, and a case that it must pass unspoilt. */
#include "tests/hard/members.h"
#include "tests/hard/parts.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* How the engine spoils answers. */
static enum spoil {
    NOTHING,
    LOSE,         /* every hit */
    INVENT,       /* a hit for every miss */
    OTHER,        /* the hit triangle's number */
    FARTHER,      /* t, by one part in 2^20 */
    INFINITE,     /* t, of all hits */
    OUT_OF_SCENE, /* the number of no triangle */
    SECOND_TIME,  /* t, in every second call */
    LAST_BIT,     /* t, by an ulp */
    BEHIND,       /* what lies behind the last answer is written */
    MANY_THREADS, /* t, if it may use more than one */
    ANY_LOST,     /* every any-hit */
    EXPENSIVE,    /* a thousand boxes per ray */
    TWICE,        /* the first of all hits is listed twice */
    LAST_DROPPED, /* the last of all hits is not listed */
    SAYS_SO,      /* does not finish, and says so */
    REFUSES,      /* refuses, without a reason */
    ABSENT,       /* cannot run here */
} spoil;

struct spoilt {
    void *cpu;
    unsigned calls, threads;
    enum query query;
};

static enum status open(const struct engine *engine, const struct engine_options *options,
                        void **self, struct reason *reason)
{
    (void)engine;
    struct spoilt *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *self = NULL;
    if (spoil == ABSENT) {
        free(s);
        return (fail)(reason, STATUS_UNSUPPORTED, "not here");
    }
    s->threads = options->threads;
    enum status status = engine_open(engine_find("cpu"), options, &s->cpu, reason);
    *self = s;
    return status;
}

static enum status prepare(void *self, const struct job *job, struct reason *reason)
{
    struct spoilt *s = self;
    s->query = job->query;
    if (spoil == REFUSES) {
        reason->text[0] = '\0';
        return STATUS_LIMIT;
    }
    return engine_find("cpu")->prepare(s->cpu, job, reason);
}

static void spoil_hit(const struct spoilt *s, struct hit *hit)
{
    bool is = hit->prim != ABI_NO_PRIM;
    if (!is && spoil == INVENT)
        *hit = (struct hit){1, 0.25f, 0.25f, 0};
    if (!is)
        return;
    if (spoil == LOSE || (spoil == ANY_LOST && s->query == QUERY_ANY))
        *hit = (struct hit){.prim = ABI_NO_PRIM};
    else if (spoil == OTHER)
        hit->prim = hit->prim < 4 ? hit->prim + 4 : hit->prim - 4;
    else if (spoil == FARTHER)
        hit->t *= 1 + 0x1p-20f;
    else if (spoil == INFINITE)
        hit->t = INFINITY;
    else if (spoil == OUT_OF_SCENE)
        hit->prim = 1000000;
    else if ((spoil == SECOND_TIME && s->calls % 2 == 0) || spoil == LAST_BIT ||
             (spoil == MANY_THREADS && s->threads != 1))
        hit->t = nextafterf(hit->t, INFINITY);
}

static enum status trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                         struct trace_report *report, struct reason *reason)
{
    struct spoilt *s = self;
    enum status status = engine_find("cpu")->trace(s->cpu, ray, ray_count, hit, report, reason);
    s->calls++;
    if (spoil == SAYS_SO)
        return (fail)(reason, STATUS_DEVICE, "ray 0 was not finished");
    for (size_t i = 0; i < ray_count; i++)
        spoil_hit(s, &hit[i]);
    if (spoil == BEHIND)
        hit[ray_count].t = 1;
    if (spoil == EXPENSIVE)
        report->boxes = 1000 * ray_count;
    return status;
}

static enum status trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                             struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    struct spoilt *s = self;
    enum status status =
        engine_find("cpu")->trace_all(s->cpu, ray, ray_count, capacity, hit, hit_count, reason);
    for (size_t i = 0; i < ray_count; i++) {
        struct hit *list = hit + i * capacity;
        if (spoil == TWICE && hit_count[i] > 0 && hit_count[i] < capacity)
            list[hit_count[i]++] = list[0];
        if (spoil == LAST_DROPPED && hit_count[i] > 0)
            hit_count[i]--;
    }
    return status;
}

static struct model model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)engine;
    return engine_model(engine_find("cpu"), ((struct spoilt *)self)->cpu, tri);
}

static void close(void *self)
{
    if (self)
        engine_find("cpu")->close(((struct spoilt *)self)->cpu);
    free(self);
}

static const struct engine engine_spoilt = {
    .name = "spoilt",
    .needs_packed = true,
    .open = open,
    .prepare = prepare,
    .trace = trace,
    .trace_all = trace_all,
    .model = model,
    .close = close,
};

static const struct hard_case *find(unsigned number)
{
    for (size_t i = 0; hard_case_at(i); i++)
        if (hard_case_at(i)->number == number)
            return hard_case_at(i);
    fail_msg("no hard case %u", number);
    return NULL;
}

static struct hard_result play(unsigned number, enum query query, const char *layout,
                               enum spoil how)
{
    const struct engine_options options = {.threads = 2, .device = -1};
    struct hard_stage stage = hard_stage_make(&options);
    struct hard_member member = {.query = query,
                                 .engine = &engine_spoilt,
                                 .layout = layout_find(layout),
                                 .builder = builder_find("median"),
                                 .box = box_test_find("watertight"),
                                 .tri = tri_test_find("mt")};
    struct hard_result result;
    struct reason reason = {""};
    spoil = how;
    if (hard_run(&stage, find(number), &member, &result, &reason))
        fail_msg("%s", reason.text);
    hard_stage_free(&stage);
    return result;
}

static void each_property_sees_its_breach(void **state)
{
    static const struct {
        unsigned number;
        enum query query;
        enum spoil how;
        enum hard_property broken;
    } planted[] = {
        {5, QUERY_CLOSEST, LOSE, PROPERTY_HIT},
        {1, QUERY_CLOSEST, LOSE, PROPERTY_VERDICT},
        {5, QUERY_CLOSEST, LOSE, PROPERTY_CULLED},
        {19, QUERY_CLOSEST, INVENT, PROPERTY_MISS},
        {1, QUERY_CLOSEST, OTHER, PROPERTY_ID},
        {5, QUERY_CLOSEST, FARTHER, PROPERTY_T},
        {40, QUERY_CLOSEST, LOSE, PROPERTY_ENDS},
        {55, QUERY_CLOSEST, SECOND_TIME, PROPERTY_LIKE},
        {1, QUERY_CLOSEST, LAST_BIT, PROPERTY_BITS},
        {43, QUERY_CLOSEST, INVENT, PROPERTY_MISS},
        {44, QUERY_CLOSEST, SECOND_TIME, PROPERTY_REPEAT},
        {59, QUERY_ANY, ANY_LOST, PROPERTY_ANY},
        {60, QUERY_CLOSEST, MANY_THREADS, PROPERTY_MODE},
        {54, QUERY_CLOSEST, BEHIND, PROPERTY_STRAY},
        {1, QUERY_CLOSEST, INFINITE, PROPERTY_FINITE},
        {1, QUERY_CLOSEST, OUT_OF_SCENE, PROPERTY_FINITE},
        {63, QUERY_CLOSEST, EXPENSIVE, PROPERTY_BUDGET},
        {57, QUERY_ALL, TWICE, PROPERTY_PARITY},
        {57, QUERY_ALL, LAST_DROPPED, PROPERTY_PARITY},
        {1, QUERY_CLOSEST, REFUSES, PROPERTY_REFUSAL},
    };
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(planted); i++) {
        struct hard_result well = play(planted[i].number, planted[i].query, "f32", NOTHING);
        struct hard_result ill = play(planted[i].number, planted[i].query, "f32", planted[i].how);
        char text[700];
        hard_result_print(&well, text, sizeof text);
        if (well.outcome != HARD_PASSED)
            fail_msg("case %u is broken unspoilt: %s", planted[i].number, text);
        hard_result_print(&ill, text, sizeof text);
        if (ill.outcome != HARD_FAILED || ill.broken[planted[i].broken] == 0)
            fail_msg("case %u does not see '%s': %s", planted[i].number,
                     hard_property_name(planted[i].broken), text);
    }
}

static void confessions_and_absence(void **state)
{
    (void)state;
    struct hard_result r = play(1, QUERY_CLOSEST, "f32", SAYS_SO);
    assert_int_equal(r.outcome, HARD_FAILED);
    assert_true(r.unfinished);
    assert_non_null(strstr(r.reason.text, "not finished"));
    r = play(1, QUERY_CLOSEST, "f32", ABSENT);
    assert_int_equal(r.outcome, HARD_SKIPPED);
    assert_string_equal(r.reason.text, "not here");
}

/* rf16 cannot hold case 26 (a million from the origin): refused, with the layout's reason; and a
 * layout that holds what it must refuse is caught by case 37. */
static struct layout careless;

static void refusals(void **state)
{
    (void)state;
    struct hard_result r = play(26, QUERY_CLOSEST, "rf16", NOTHING);
    assert_int_equal(r.outcome, HARD_REFUSED);
    assert_non_null(strstr(r.reason.text, "65504"));
    const struct engine_options options = {.threads = 1, .device = -1};
    struct hard_stage stage = hard_stage_make(&options);
    careless = *layout_find("f32");
    careless.name = "rf16";
    struct hard_member member = {.query = QUERY_CLOSEST,
                                 .engine = engine_find("cpu"),
                                 .layout = &careless,
                                 .builder = builder_find("median"),
                                 .box = box_test_find("robust"),
                                 .tri = tri_test_find("mt")};
    struct reason reason = {""};
    assert_int_equal(hard_run(&stage, find(37), &member, &r, &reason), STATUS_OK);
    assert_int_equal(r.outcome, HARD_FAILED);
    assert_true(r.broken[PROPERTY_REFUSAL] > 0);
    hard_stage_free(&stage);
}

/* Bounds one float inside the tree's: seen without a ray. */
static struct box shrunk_box(const struct packed *packed, uint32_t ref)
{
    struct box box = layout_find("f32")->box(packed, ref);
    box.hi[0] = nextafterf(box.hi[0], -INFINITY);
    return box;
}

static void structure_is_checked(void **state)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct hard_stage stage = hard_stage_make(&options);
    struct layout shrunk = *layout_find("f32");
    shrunk.box = shrunk_box;
    struct hard_member member = {.query = QUERY_CLOSEST,
                                 .engine = engine_find("cpu"),
                                 .layout = &shrunk,
                                 .builder = builder_find("median"),
                                 .box = box_test_find("robust"),
                                 .tri = tri_test_find("mt")};
    struct hard_result r;
    struct reason reason = {""};
    (void)state;
    assert_int_equal(hard_run(&stage, find(58), &member, &r, &reason), STATUS_OK);
    assert_int_equal(r.outcome, HARD_FAILED);
    assert_true(r.broken[PROPERTY_STRUCTURE] > 0);
    hard_stage_free(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_property_sees_its_breach),
        cmocka_unit_test(confessions_and_absence),
        cmocka_unit_test(refusals),
        cmocka_unit_test(structure_is_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
