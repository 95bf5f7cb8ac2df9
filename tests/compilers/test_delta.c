/* Delta debugging (gpu/bisect/delta.h): laws of its results. */
#include "gpu/bisect/delta.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#define MOST 40

enum rule_kind { NEEDS, PAIRED, HASHED, RULE_KINDS };

/* What shows: a rule over sets of elements. */
struct delta_rule {
    enum rule_kind kind;
    size_t count;
    bool needs[MOST];     /* NEEDS, PAIRED: all of these */
    size_t partner[MOST]; /* PAIRED: nothing can be said of one without the other */
    uint64_t seed;        /* HASHED: any answer to any set, but for the whole, which shows it */
    size_t asked, stop;   /* DELTA_STOP at this question; 0: never */
};

static uint64_t state = 1;

static uint64_t next(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return state >> 33;
}

static enum delta_answer answer(const struct delta_rule *rule, const bool *in)
{
    uint64_t hash = rule->seed;
    bool whole = true;
    for (size_t i = 0; i < rule->count; i++) {
        if (rule->kind == PAIRED && in[i] != in[rule->partner[i]])
            return DELTA_UNRESOLVED;
        whole = whole && in[i];
        hash = (hash ^ (in[i] + 2 * i)) * 0x9E3779B97F4A7C15u;
    }
    if (rule->kind == HASHED)
        return whole || (hash >> 40) % 5 == 0 ? DELTA_SHOWS
               : (hash >> 50) % 2             ? DELTA_SHOWS_NOT
                                              : DELTA_UNRESOLVED;
    for (size_t i = 0; i < rule->count; i++)
        if (rule->needs[i] && !in[i])
            return DELTA_SHOWS_NOT;
    return DELTA_SHOWS;
}

static enum delta_answer ask(void *user, const bool *in)
{
    struct delta_rule *rule = user;
    bool any = false;
    for (size_t i = 0; i < rule->count; i++)
        any = any || in[i];
    assert_true(any); /* never of none */
    rule->asked++;
    return rule->stop && rule->asked == rule->stop ? DELTA_STOP : answer(rule, in);
}

static struct delta_rule draw(enum rule_kind kind)
{
    struct delta_rule rule = {.kind = kind, .count = 1 + next() % MOST, .seed = next()};
    for (size_t i = 0; i < rule.count; i++) {
        rule.needs[i] = next() % 6 == 0;
        rule.partner[i] = i;
    }
    rule.needs[next() % rule.count] = true;
    for (size_t i = 0; kind == PAIRED && i + 1 < rule.count; i += 2) {
        rule.partner[i] = i + 1;
        rule.partner[i + 1] = i;
    }
    return rule;
}

/* Reduces the whole set; returns what delta_reduce does. */
static bool reduce(struct delta_rule *rule, size_t most, bool *in, struct delta *delta)
{
    enum status status;
    *delta = (struct delta){.ask = ask, .user = rule, .count = rule->count, .most = most};
    for (size_t i = 0; i < rule->count; i++)
        in[i] = true;
    rule->asked = 0;
    const bool least = delta_reduce(delta, in, &status);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(delta->tries, rule->asked);
    return least;
}

static size_t size_of(const struct delta_rule *rule, const bool *in)
{
    size_t size = 0;
    for (size_t i = 0; i < rule->count; i++)
        size += in[i];
    return size;
}

static void no_element_can_be_left_out(void **state_)
{
    (void)state_;
    for (int round = 0; round < 3000; round++) {
        struct delta_rule rule = draw((enum rule_kind)(round % RULE_KINDS));
        struct delta delta;
        bool in[MOST], again[MOST];
        assert_true(reduce(&rule, 100000, in, &delta));
        assert_int_equal(answer(&rule, in), DELTA_SHOWS);
        for (size_t i = 0; i < rule.count && size_of(&rule, in) > 1; i++) {
            if (!in[i])
                continue;
            in[i] = false;
            assert_int_not_equal(answer(&rule, in), DELTA_SHOWS);
            in[i] = true;
        }
        assert_true(reduce(&rule, 100000, again, &delta));
        assert_memory_equal(in, again, rule.count);
    }
}

static void what_is_needed_is_what_is_found(void **state_)
{
    (void)state_;
    for (int round = 0; round < 1000; round++) {
        struct delta_rule rule = draw(NEEDS);
        struct delta delta;
        bool in[MOST];
        assert_true(reduce(&rule, 100000, in, &delta));
        assert_memory_equal(in, rule.needs, rule.count);
    }
}

static void one_of_many_takes_few_questions(void **state_)
{
    (void)state_;
    for (size_t one = 0; one < MOST; one++) {
        struct delta_rule rule = {.kind = NEEDS, .count = MOST};
        struct delta delta;
        bool in[MOST];
        rule.needs[one] = true;
        assert_true(reduce(&rule, 100000, in, &delta));
        assert_true(delta.tries <= 12); /* two halves, six times */
    }
}

static void what_is_ended_early_still_shows(void **state_)
{
    (void)state_;
    for (int round = 0; round < 1000; round++) {
        struct delta_rule rule = draw((enum rule_kind)(round % RULE_KINDS));
        struct delta delta;
        bool in[MOST];
        const size_t most = next() % 6;
        const bool least = reduce(&rule, most, in, &delta);
        assert_true(delta.tries <= most);
        assert_int_equal(answer(&rule, in), DELTA_SHOWS);
        rule.stop = 1 + next() % 4;
        assert_true(!reduce(&rule, 100000, in, &delta) || rule.asked < rule.stop);
        assert_int_equal(answer(&rule, in), DELTA_SHOWS);
        assert_true(least || delta.tries > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_element_can_be_left_out),
        cmocka_unit_test(what_is_needed_is_what_is_found),
        cmocka_unit_test(one_of_many_takes_few_questions),
        cmocka_unit_test(what_is_ended_early_still_shows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
