#include "scenes/read/json_pull.h"

#include "ref/base/decimal.h"
#include "ref/base/text.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct json_pull json_pull_make(const char *name, const char *bytes, size_t size,
                                struct reason *reason)
{
    return (struct json_pull){
        .walk = {.name = name, .start = bytes, .at = bytes, .end = bytes + size, .reason = reason}};
}

#define PLACE 120

/* "nodes[3].children[0]: ", or nothing for the whole file. */
static void write_place(const struct json_pull *pull, char place[PLACE])
{
    place[0] = '\0';
    for (size_t i = 0; i < pull->depth; i++) {
        if (pull->step[i].key)
            text_append(place, PLACE, "%s%s", i ? "." : "", pull->step[i].key);
        else
            text_append(place, PLACE, "[%zu]", pull->step[i].index);
    }
    if (pull->depth)
        text_append(place, PLACE, ": ");
}

enum status json_pull_fail(const struct json_pull *pull, const char *format, ...)
{
    char place[PLACE], rule[200];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(rule, sizeof rule, format, arguments);
    va_end(arguments);
    write_place(pull, place);
    return fail(pull->walk.reason, STATUS_INPUT, "%s: %s%s", pull->walk.name, place, rule);
}

static enum status step_in(struct json_pull *pull, const char *key, size_t index)
{
    if (pull->depth == JSON_PULL_DEEP)
        return json_pull_fail(pull, "brackets are nested too deep");
    pull->step[pull->depth].key = key;
    pull->step[pull->depth++].index = index;
    return STATUS_OK;
}

enum status json_pull_fail_at(struct json_pull *pull, const char *key, size_t element,
                              const char *rule)
{
    size_t depth = pull->depth;
    enum status status = step_in(pull, key, 0);
    if (!status && element != JSON_PULL_NONE)
        status = step_in(pull, NULL, element);
    if (!status)
        status = json_pull_fail(pull, "%s", rule);
    pull->depth = depth;
    return status;
}

size_t json_pull_index(const struct json_pull *pull)
{
    for (size_t i = pull->depth; i-- > 0;)
        if (!pull->step[i].key)
            return pull->step[i].index;
    return 0;
}

/* A member that no table has. */
static enum status take_unknown(struct json_pull *pull, const char *key)
{
    if (!pull->closed)
        return json_walk_skip(&pull->walk);
    return json_pull_fail(pull, "'%.40s' is no member of it", key);
}

/* Reads the member that follows; `seen` has a bit for each of the table. */
static enum status take_member(struct json_pull *pull, const struct json_member *member,
                               uint32_t *seen, void *self)
{
    json_t *key;
    enum status status = json_walk_key(&pull->walk, &key);
    if (status)
        return status;
    const char *word = json_string_value(key);
    unsigned i = 0;
    while (member[i].key && strcmp(member[i].key, word) != 0)
        i++;
    if (!member[i].key)
        status = take_unknown(pull, word);
    json_decref(key);
    if (status || !member[i].key)
        return status;
    status = step_in(pull, member[i].key, 0);
    if (!status && (*seen >> i & 1))
        status = json_pull_fail(pull, "is there twice");
    if (!status)
        status = member[i].take(pull, self);
    if (!status)
        pull->depth--;
    *seen |= UINT32_C(1) << i;
    return status;
}

enum status json_pull_object(struct json_pull *pull, const struct json_member *member, void *self)
{
    uint32_t seen = 0;
    if (json_walk_peek(&pull->walk) != '{' && pull->walk.at < pull->walk.end)
        return json_pull_fail(pull, "must be an object");
    enum status status = json_walk_open(&pull->walk, '{');
    while (!status) {
        bool more;
        status = json_walk_more(&pull->walk, '}', &more);
        if (status || !more)
            break;
        status = take_member(pull, member, &seen, self);
    }
    for (unsigned i = 0; member[i].key && !status; i++)
        if (member[i].needed && !(seen >> i & 1))
            status = json_pull_fail_at(pull, member[i].key, JSON_PULL_NONE, "is missing");
    return status;
}

enum status json_pull_array(struct json_pull *pull, json_take_fn *take, void *self)
{
    if (json_walk_peek(&pull->walk) != '[' && pull->walk.at < pull->walk.end)
        return json_pull_fail(pull, "must be an array");
    enum status status = json_walk_open(&pull->walk, '[');
    for (size_t i = 0; !status; i++) {
        bool more;
        status = json_walk_more(&pull->walk, ']', &more);
        if (status || !more || (status = step_in(pull, NULL, i)) != STATUS_OK)
            break;
        status = take(pull, self);
        if (!status)
            pull->depth--;
    }
    return status;
}

enum status json_pull_file(struct json_pull *pull, const struct json_member *member, void *self)
{
    enum status status = json_pull_object(pull, member, self);
    return status ? status : json_walk_end(&pull->walk);
}

/* A number; true where one begins, whatever becomes of it. */
static enum status pull_number(struct json_pull *pull, const char **out)
{
    char c = json_walk_peek(&pull->walk);
    *out = NULL;
    if (c == 'n')
        return json_pull_fail(pull, "must be a number; null (NaN, infinity) is none");
    if (c && c != '-' && (c < '0' || c > '9'))
        return json_pull_fail(pull, "must be a number");
    return json_walk_number(&pull->walk, out);
}

enum status json_pull_float(struct json_pull *pull, float *out)
{
    const char *text;
    enum status status = pull_number(pull, &text);
    *out = 0;
    if (status)
        return status;
    if (!decimal_read_float(text, out))
        return fail(pull->walk.reason, STATUS_MEMORY, "%s: no memory", pull->walk.name);
    return float_is_finite(*out) ? STATUS_OK
                                 : json_pull_fail(pull, "is beyond the range of a 32-bit float");
}

enum status json_pull_double(struct json_pull *pull, double *out)
{
    const char *text;
    enum status status = pull_number(pull, &text);
    *out = 0;
    if (status)
        return status;
    if (!decimal_read_double(text, out))
        return fail(pull->walk.reason, STATUS_MEMORY, "%s: no memory", pull->walk.name);
    return fabs(*out) <= DBL_MAX ? STATUS_OK
                                 : json_pull_fail(pull, "is beyond the range of a double");
}

enum status json_pull_whole(struct json_pull *pull, uint64_t most, uint64_t *out)
{
    double value;
    enum status status = json_pull_double(pull, &value);
    *out = 0;
    if (status)
        return status;
    if (!(value >= 0 && value <= (double)most) || floor(value) != value)
        return json_pull_fail(pull, "must be a whole number from 0 to %llu",
                              (unsigned long long)most);
    *out = (uint64_t)value;
    return STATUS_OK;
}

enum status json_pull_bool(struct json_pull *pull, bool *out)
{
    char c = json_walk_peek(&pull->walk);
    *out = false;
    if (c && c != 't' && c != 'f')
        return json_pull_fail(pull, "must be true or false");
    json_t *value;
    enum status status = json_walk_value(&pull->walk, &value);
    *out = json_is_true(value);
    json_decref(value);
    return status;
}

enum status json_pull_null(struct json_pull *pull, bool *out)
{
    *out = json_walk_peek(&pull->walk) == 'n';
    if (!*out)
        return STATUS_OK;
    json_t *value;
    enum status status = json_walk_value(&pull->walk, &value);
    json_decref(value);
    return status;
}

enum status json_pull_text(struct json_pull *pull, json_t **out)
{
    char c = json_walk_peek(&pull->walk);
    *out = NULL;
    if (c && c != '"')
        return json_pull_fail(pull, "must be a text");
    return json_walk_value(&pull->walk, out);
}

enum status json_pull_word(struct json_pull *pull, const char *const *word, unsigned *out)
{
    json_t *text;
    enum status status = json_pull_text(pull, &text);
    *out = 0;
    if (status)
        return status;
    while (word[*out] && strcmp(word[*out], json_string_value(text)) != 0)
        ++*out;
    char known[120] = "";
    for (unsigned i = 0; word[i]; i++)
        text_append(known, sizeof known, "%s%s", i ? ", " : "", word[i]);
    if (!word[*out])
        status = json_pull_fail(pull, "'%.40s' is none of %s", json_string_value(text), known);
    *out = status ? 0 : *out;
    json_decref(text);
    return status;
}
