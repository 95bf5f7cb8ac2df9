#include "scenes/read/json_walk.h"

/* "NAME:LINE:COLUMN: rule" for a place `line` lines and `column` bytes from the cursor; `line` is 1
 * on the cursor's own. */
static enum status refuse(const struct json_walk *walk, int line, int column, const char *rule)
{
    unsigned long long lines = 0;
    const char *line_start = walk->start;
    for (const char *at = walk->start; at < walk->at; at++) {
        if (*at == '\n') {
            lines++;
            line_start = at + 1;
        }
    }
    long long before = line == 1 ? walk->at - line_start : 0;
    return fail(walk->reason, STATUS_INPUT, "%s:%llu:%lld: %s", walk->name,
                lines + (unsigned long long)line, before + column, rule);
}

static void skip_space(struct json_walk *walk)
{
    while (walk->at < walk->end &&
           (*walk->at == ' ' || *walk->at == '\n' || *walk->at == '\t' || *walk->at == '\r'))
        walk->at++;
}

static bool take(struct json_walk *walk, char c)
{
    skip_space(walk);
    if (walk->at == walk->end || *walk->at != c)
        return false;
    walk->at++;
    return true;
}

enum status json_walk_open(struct json_walk *walk, char bracket)
{
    walk->first = true;
    if (take(walk, bracket))
        return STATUS_OK;
    return refuse(walk, 1, 1,
                  bracket == '{' ? "an object must begin here" : "an array must begin here");
}

enum status json_walk_more(struct json_walk *walk, char bracket, bool *more)
{
    *more = !take(walk, bracket);
    bool first = walk->first;
    walk->first = false;
    if (!*more || first || take(walk, ','))
        return STATUS_OK;
    if (walk->at == walk->end)
        return refuse(walk, 1, 1, "the text is cut short");
    return refuse(walk, 1, 1,
                  bracket == '}' ? "',' or '}' must stand here" : "',' or ']' must stand here");
}

enum status json_walk_value(struct json_walk *walk, json_t **out)
{
    skip_space(walk);
    json_error_t error;
    *out = json_loadb(walk->at, (size_t)(walk->end - walk->at),
                      JSON_REJECT_DUPLICATES | JSON_DISABLE_EOF_CHECK | JSON_DECODE_ANY, &error);
    if (*out) {
        walk->at += error.position;
        return STATUS_OK;
    }
    if (json_error_code(&error) == json_error_out_of_memory)
        return fail(walk->reason, STATUS_MEMORY, "%s: no memory to parse the JSON text",
                    walk->name);
    if (walk->at == walk->end)
        return refuse(walk, 1, 1, "the text is cut short");
    return refuse(walk, error.line, error.column, error.text);
}

enum status json_walk_key(struct json_walk *walk, json_t **out)
{
    *out = NULL;
    skip_space(walk);
    if (walk->at == walk->end || *walk->at != '"')
        return refuse(walk, 1, 1, "a key in quotes must stand here");
    enum status status = json_walk_value(walk, out);
    if (status || take(walk, ':'))
        return status;
    json_decref(*out);
    *out = NULL;
    return refuse(walk, 1, 1, "':' must stand here");
}

enum status json_walk_end(struct json_walk *walk)
{
    skip_space(walk);
    return walk->at == walk->end ? STATUS_OK
                                 : refuse(walk, 1, 1, "nothing may follow the last bracket");
}

char json_walk_peek(struct json_walk *walk)
{
    skip_space(walk);
    return walk->at < walk->end ? *walk->at : '\0';
}

static const char *skip_digits(const char *at, const char *end)
{
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    return at;
}

enum status json_walk_number(struct json_walk *walk, const char **out)
{
    skip_space(walk);
    const char *start = walk->at, *end = walk->end;
    const char *at = start + (start < end && *start == '-');
    const char *whole = at;
    *out = start;
    at = skip_digits(at, end);
    bool good = at > whole && (*whole != '0' || at == whole + 1);
    if (good && at < end && *at == '.') {
        const char *part = ++at;
        at = skip_digits(at, end);
        good = at > part;
    }
    if (good && at < end && (*at == 'e' || *at == 'E')) {
        at++;
        at += at < end && (*at == '-' || *at == '+');
        const char *power = at;
        at = skip_digits(at, end);
        good = at > power;
    }
    if (!good)
        return refuse(walk, 1, 1, "a number must stand here");
    walk->at = at;
    return at < end ? STATUS_OK : refuse(walk, 1, 1, "the text is cut short");
}

/* Steps into a bracket, or reads a text, number or word. */
static enum status skip_start(struct json_walk *walk, char *open, size_t *depth)
{
    char c = json_walk_peek(walk);
    if (c == '{' || c == '[') {
        if (*depth == JSON_WALK_DEEP)
            return refuse(walk, 1, 1, "brackets are nested too deep");
        open[(*depth)++] = c;
        return json_walk_open(walk, c);
    }
    json_t *value;
    enum status status = json_walk_value(walk, &value);
    json_decref(value);
    return status;
}

enum status json_walk_skip(struct json_walk *walk)
{
    char open[JSON_WALK_DEEP];
    size_t depth = 0;
    enum status status = skip_start(walk, open, &depth);
    while (!status && depth > 0) {
        bool more, object = open[depth - 1] == '{';
        status = json_walk_more(walk, object ? '}' : ']', &more);
        if (!status && !more) {
            depth--;
            continue;
        }
        json_t *key = NULL;
        if (!status && object)
            status = json_walk_key(walk, &key);
        json_decref(key);
        if (!status)
            status = skip_start(walk, open, &depth);
    }
    return status;
}
