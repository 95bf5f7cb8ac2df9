/* Options from rows: reads the command line. */
#include "cmd/common/cmd_rows.h"

#include "ref/base/nearest_name.h"
#include "ref/base/text.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the value of a flag ------------------------------------------------------------------ */

static enum status take_count(const struct option_row *row, const char *flag, const char *text,
                              void *to, struct reason *reason)
{
    uint64_t n = 0;
    enum status status = parse_count(flag, text, row->least, row->most, &n, reason);
    const uint32_t narrow = (uint32_t)n;
    if (!status)
        memcpy(to, row->size == sizeof n ? (const void *)&n : &narrow, row->size);
    return status;
}

static enum status take_real(const struct option_row *row, const char *flag, const char *text,
                             float *to, struct reason *reason)
{
    float x = 0;
    enum status status = parse_float(flag, text, &x, reason);
    const bool above = row->low == 0 && signbit(row->low), most = isfinite(row->high);
    if (status || ((above ? x > 0 : (double)x >= row->low) && (double)x <= row->high)) {
        *to = x;
        return status;
    }
    if (above)
        return fail(reason, STATUS_INPUT, "%s: '%.60s' is not above 0", flag, text);
    if (most)
        return fail(reason, STATUS_INPUT, "%s: '%.60s' is not a number from %g to %g", flag, text,
                    row->low, row->high);
    return fail(reason, STATUS_INPUT, "%s: '%.60s' is below %g", flag, text, row->low);
}

/* Writes "a, b or c". */
static void name_choices(const char *const *choice, char *text, size_t text_bytes)
{
    text[0] = '\0';
    for (size_t i = 0; choice[i]; i++)
        text_append(text, text_bytes, "%s%s",
                    i == 0          ? ""
                    : choice[i + 1] ? ", "
                                    : " or ",
                    choice[i]);
}

static enum status take_place(const struct option_row *row, const char *flag, const char *text,
                              void *to, struct reason *reason)
{
    size_t i = 0;
    enum status status = STATUS_OK;
    if (row->type == OPTION_CHOICE) {
        char known[160];
        while (row->choice[i] && strcmp(row->choice[i], text) != 0)
            i++;
        name_choices(row->choice, known, sizeof known);
        if (!row->choice[i])
            return fail(reason, STATUS_INPUT, "%s: '%.60s' is not %s", flag, text, known);
    } else {
        status = table_parse_one((enum table)(row->table - 1), flag, text, &i, reason);
    }
    const void *member = NULL;
    const unsigned narrow = (unsigned)i;
    if (row->type == OPTION_MEMBER && !status)
        member = table_pointer((enum table)(row->table - 1), i);
    memcpy(to,
           row->type == OPTION_MEMBER ? (const void *)&member
           : row->size == sizeof i    ? (const void *)&i
                                      : &narrow,
           row->size);
    return status;
}

/* Stores a value in the row's member; for a flag, true. */
static enum status take(void *owner, const struct option_value *given, struct reason *reason)
{
    const struct option_row *row = given->row;
    char flag[40];
    void *to = (char *)owner + row->place;
    snprintf(flag, sizeof flag, "--%s", row->name);
    switch (row->type) {
    case OPTION_FLAG:
        *(bool *)to = true;
        return STATUS_OK;
    case OPTION_COUNT:
        return take_count(row, flag, given->text, to, reason);
    case OPTION_REAL:
        return take_real(row, flag, given->text, to, reason);
    case OPTION_LIST:
        return table_parse((enum table)(row->table - 1), flag, given->text, to, reason);
    case OPTION_CHOICE:
    case OPTION_ONE:
    case OPTION_MEMBER:
        return take_place(row, flag, given->text, to, reason);
    case OPTION_OWN:
    case OPTION_ACT:
        return row->take(owner, given, reason);
    default:
        memcpy(to, &given->text, sizeof given->text);
        return STATUS_OK;
    }
}

/* --- the command line --------------------------------------------------------------------- */

const struct option_row *option_find(const struct option_set *set, const char *name, void *options,
                                     void **owner)
{
    for (const struct option_group *group = set->group; group->row; group++)
        for (const struct option_row *row = group->row; row->name; row++)
            if (strcmp(row->name, name) == 0 ||
                (row->letter && name[0] == row->letter && !name[1])) {
                if (owner)
                    *owner = (char *)options + group->place;
                return row;
            }
    return NULL;
}

enum status option_put(const struct option_set *set, void *options, const char *name, char *text,
                       struct reason *reason)
{
    void *owner = NULL;
    const struct option_row *row = option_find(set, name, options, &owner);
    return take(owner, &(struct option_value){.row = row, .text = text}, reason);
}

static void take_defaults(const struct option_set *set, void *options)
{
    struct reason reason;
    for (const struct option_group *group = set->group; group->row; group++)
        for (const struct option_row *row = group->row; row->name; row++) {
            char text[64];
            void *owner;
            if (!row->value || option_find(set, row->name, options, &owner) != row)
                continue;
            snprintf(text, sizeof text, "%s", row->value);
            if (row->type >= OPTION_TEXT && row->type <= OPTION_DATA)
                memcpy((char *)owner + row->place, &row->value, row->size);
            else if (option_put(set, options, row->name, text, &reason))
                abort(); /* a default that its own row rejects is a bug */
        }
}

/* State of reading the command line. */
struct option_reading {
    const struct option_set *set;
    void *options;
    int argc, at; /* index of the next word */
    char **argv;
    int first; /* all before it are options and their values */
};

static bool is_flag(const struct option_reading *r, const char *word)
{
    return r->set->words ? strncmp(word, "--", 2) == 0 : word[0] == '-' && word[1];
}

static int unknown_option(const struct option_reading *r, const char *name, size_t length)
{
    struct nearest_name nearest = nearest_make(name, length);
    for (const struct option_group *group = r->set->group; group->row; group++)
        for (const struct option_row *row = group->row; row->name; row++)
            nearest_try(&nearest, row->name);
    /* What a person shortened may be far from all of them. */
    bool begun = length < 2;
    for (const struct option_group *group = r->set->group; group->row && !begun; group++)
        for (const struct option_row *row = group->row; row->name && !begun; row++)
            if (strncmp(row->name, name, length) == 0) {
                nearest.name = row->name;
                begun = true;
            }
    return usage_error(r->set->command, "unknown option: '--%.*s'%s%s%s",
                       (int)(length > 60 ? 60 : length), name,
                       nearest.name ? "; did you mean --" : "", nearest.name ? nearest.name : "",
                       nearest.name ? "?" : "");
}

/* For sets with `words`. Errors: STATUS_INPUT the row needs another number of words. */
static enum status count_words(const struct option_row *row, size_t count, struct reason *reason)
{
    const bool none = !row->word, own = row->type == OPTION_OWN;
    if (own ? !row->words || count == row->least || (row->most && count == row->most)
            : count == !none)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "--%s: takes %s, but %zu word%s follow%s", row->name,
                own    ? row->words
                : none ? "nothing"
                       : row->word,
                count, plural(count), count == 1 ? "s" : "");
}

/* Finds the option's value and moves r->at past it. Errors: STATUS_INPUT. */
static enum status find_value(struct option_reading *r, char *text, struct option_value *value,
                              struct reason *reason)
{
    const struct option_row *row = value->row;
    const bool words = r->set->words, none = !row->word;
    value->text = text;
    value->word = text ? (char *const *)&value->text : r->argv + r->at;
    value->count = text != NULL;
    while (r->at < r->argc && !text &&
           (words ? !is_flag(r, r->argv[r->at])
                  : !none && value->count == 0 && !(row->optional && is_flag(r, r->argv[r->at])))) {
        value->text = value->text ? value->text : r->argv[r->at];
        value->count++;
        r->at++;
    }
    if (words && count_words(row, value->count, reason))
        return STATUS_INPUT;
    if (words && !value->text)
        return STATUS_OK;
    if (none && text)
        return fail(reason, STATUS_INPUT, "--%s: takes no value", row->name);
    if (!none && !row->optional && !value->text)
        return fail(reason, STATUS_INPUT, "--%s: its value is missing: %s", row->name, row->word);
    if (value->text && strcmp(value->text, "-") == 0) {
        if (row->type == OPTION_OUTPUT || row->type == OPTION_WRITTEN)
            return fail(reason, STATUS_INPUT, "--%s: needs a file, not '-'", row->name);
        return row->type == OPTION_DATA ? output_aside(reason) : STATUS_OK;
    }
    return STATUS_OK;
}

/* Moves word i before the arguments that preceded it. */
static void put_first(struct option_reading *r, int i)
{
    char *word = r->argv[i];
    memmove(r->argv + r->first + 1, r->argv + r->first, (size_t)(i - r->first) * sizeof *r->argv);
    r->argv[r->first++] = word;
}

/* Reads the option at r->at. Returns -1, or the exit code. */
static int read_option(struct option_reading *r)
{
    const int start = r->at++;
    char *name = r->argv[start] + 1 + (r->argv[start][1] == '-'), *equals = strchr(name, '=');
    char known[64];
    struct option_value value = {0};
    struct reason reason;
    void *owner = NULL;
    const size_t length = equals ? (size_t)(equals - name) : strlen(name);
    snprintf(known, sizeof known, "%.*s", (int)(length < sizeof known ? length : 0), name);
    value.row = option_find(r->set, known, r->options, &owner);
    const bool short_of = r->argv[start][1] != '-';
    if (value.row && short_of != (value.row->letter && known[0] == value.row->letter && !known[1]))
        value.row = NULL;
    if ((strcmp(known, "help") == 0 && !equals) ||
        (short_of && strcmp(known, "h") == 0 &&
         (!value.row || r->at == r->argc || is_flag(r, r->argv[r->at])))) {
        options_print(r->set);
        return EXIT_AGREE;
    }
    if (!value.row)
        return short_of ? usage_error(r->set->command, "unknown option or missing value: '%.60s'",
                                      r->argv[start])
                        : unknown_option(r, name, length);
    enum status status = find_value(r, equals ? equals + 1 : NULL, &value, &reason);
    if (!status)
        status = option_note(value.row->name, value.row->repeats, &reason);
    if (!status)
        status = take(owner, &value, &reason);
    if (!status && r->set->taken)
        status = r->set->taken(r->options, &value, &reason);
    if (!status && value.row->type >= OPTION_OUTPUT && value.row->type <= OPTION_DATA)
        output_note(value.row->name, value.text, value.row->type != OPTION_OUTPUT);
    if (status)
        return option_error(r->set->command, status, &reason);
    for (int i = start; i < r->at; i++)
        put_first(r, i);
    return -1;
}

int options_read(const struct option_set *set, void *options, int argc, char **argv, int *first)
{
    struct option_reading r = {
        .set = set, .options = options, .argc = argc, .at = 1, .argv = argv, .first = 1};
    struct reason reason;
    int code = -1;
    options_begin();
    take_defaults(set, options);
    while (r.at < argc && code < 0) {
        if (!set->words && strcmp(argv[r.at], "--") == 0) {
            put_first(&r, r.at);
            break;
        }
        if (is_flag(&r, argv[r.at]))
            code = read_option(&r);
        else
            r.at++;
    }
    *first = r.first;
    enum status status = code < 0 ? plugin_shader_settle(&reason) : STATUS_OK;
    if (!status && code < 0)
        status = outputs_apart(&reason);
    if (!status && code < 0)
        status = outputs_can_tell(argc, argv, &reason);
    if (!status && code < 0 && !set->makes_folder)
        status = outputs_try(&reason);
    return status ? option_error(set->command, status, &reason) : code;
}
