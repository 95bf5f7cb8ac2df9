/* The state of a campaign in its folder's log, from which it is resumed. */
#include "fuzz/campaign/campaign_inner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_plain(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           (c && strchr("_-+:.,/", c));
}

bool campaign_state_put(char *state, size_t size, const char *name, const char *value)
{
    size_t used = strlen(state), room = used + strlen(name) + 3 * strlen(value) + 3;
    if (room > size)
        return false;
    used += (size_t)sprintf(state + used, "%s%s=", used ? "|" : "", name);
    for (; *value; value++)
        if (is_plain(*value))
            state[used++] = *value;
        else
            used += (size_t)sprintf(state + used, "%%%02X", (unsigned char)*value);
    state[used] = '\0';
    return true;
}

/* Where the value of that name begins, or NULL. */
static const char *find(const char *state, const char *name)
{
    size_t length = strlen(name);
    while (state && !(strncmp(state, name, length) == 0 && state[length] == '=')) {
        state = strchr(state, '|');
        state = state ? state + 1 : NULL;
    }
    return state ? state + length + 1 : NULL;
}

bool campaign_state_get(const char *state, const char *name, char *value, size_t size)
{
    const char *from = find(state, name);
    size_t used = 0;
    if (size > 0)
        value[0] = '\0';
    if (!from)
        return false;
    for (; *from && *from != '|'; from++) {
        char c = *from;
        if (used + 1 >= size)
            return false;
        if (c == '%' && from[1] && from[2]) {
            const char hex[3] = {from[1], from[2], '\0'};
            c = (char)strtoul(hex, NULL, 16);
            from += 2;
        }
        value[used++] = c;
        value[used] = '\0';
    }
    return true;
}

static uint64_t number(const char *state, const char *name)
{
    char text[32];
    return campaign_state_get(state, name, text, sizeof text) ? strtoull(text, NULL, 10) : 0;
}

bool campaign_state_is_unplayed(const char *state)
{
    char text[1024];
    (void)campaign_state_get(state, "coverage", text, sizeof text);
    return number(state, "corpus_done") == 0 && number(state, "next") == 0 &&
           number(state, "mut") == 0 && text[strspn(text, "0")] == '\0';
}

static bool put_number(char *state, const char *name, uint64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    return campaign_state_put(state, FINDINGS_STATE_MOST, name, text);
}

/* A digit for each finding, in their order. */
static bool put_shrunk(const struct campaign *c, char *state)
{
    char text[1024];
    size_t count = c->marks < sizeof text - 1 ? c->marks : sizeof text - 1;
    for (size_t i = 0; i < count; i++)
        text[i] = c->mark[i].shrunk ? '1' : '0';
    text[count] = '\0';
    return campaign_state_put(state, FINDINGS_STATE_MOST, "shrunk", text);
}

#define TURNOUT_TEXT (FUZZ_CONTESTANTS_MOST * 3 * 21)

/* "PLAYED,DECLINED,PROVED" of each contestant, parted by ':'. */
static bool put_turnout(const struct campaign *c, char *state)
{
    char text[TURNOUT_TEXT] = "";
    size_t used = 0;
    for (size_t i = 0; i < c->rules.field.count && !c->view.turnout_unknown; i++) {
        const struct campaign_turnout *t = &c->view.turnout[i];
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%llu,%llu,%llu", i ? ":" : "",
                                 (unsigned long long)t->played, (unsigned long long)t->declined,
                                 (unsigned long long)t->proved);
    }
    return campaign_state_put(state, FINDINGS_STATE_MOST, "turnout", text);
}

/* A folder of an older raydiff has no turnout: it stays unknown. */
static void read_turnout(struct campaign *c, const char *state)
{
    char text[TURNOUT_TEXT];
    const char *at = text;
    (void)campaign_state_get(state, "turnout", text, sizeof text);
    c->view.turnout_unknown = text[0] == '\0' && !campaign_state_is_unplayed(state);
    for (size_t i = 0; i < c->rules.field.count; i++) {
        unsigned long long played, declined, proved;
        if (sscanf(at, "%llu,%llu,%llu", &played, &declined, &proved) != 3)
            break;
        c->view.turnout[i].played = played;
        c->view.turnout[i].declined = declined;
        c->view.turnout[i].proved = proved;
        at += strcspn(at, ":");
        at += *at == ':';
    }
}

#define EDGES_TEXT (FUZZ_CONTESTANTS_MOST * MATCH_EDGES * 2 * 12)

/* "HITS,LOST," of each class of each contestant with any hits beside edges, after its number. */
static bool put_edges(const struct campaign *c, char *state)
{
    char text[EDGES_TEXT + 1] = "";
    size_t used = 0;
    for (size_t i = 0; i < c->rules.field.count; i++) {
        const struct edges_lost *edges = c->view.turnout[i].edges;
        bool any = false;
        for (size_t e = 0; e < MATCH_EDGES; e++)
            any = any || edges[e].hits > 0;
        for (size_t e = 0; e < MATCH_EDGES && any && used + 48 < sizeof text; e++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%zu.%zu,%zu,%zu:", i, e,
                                     edges[e].hits, edges[e].lost);
    }
    return !used || campaign_state_put(state, FINDINGS_STATE_MOST, "edges", text);
}

static void read_edges(struct campaign *c, const char *state)
{
    char text[EDGES_TEXT + 1];
    (void)campaign_state_get(state, "edges", text, sizeof text);
    for (const char *at = text; *at; at += strcspn(at, ":"), at += *at == ':') {
        size_t i, e, hits, lost;
        if (sscanf(at, "%zu.%zu,%zu,%zu", &i, &e, &hits, &lost) == 4 && i < c->rules.field.count &&
            e < MATCH_EDGES)
            c->view.turnout[i].edges[e] = (struct edges_lost){hits, lost};
    }
}

static bool put_offered(const struct campaign *c, char *state)
{
    char text[64];
    if (c->offered == SIZE_MAX)
        return true;
    snprintf(text, sizeof text, "%zu:%016llx", c->offered, (unsigned long long)c->offered_hash);
    return campaign_state_put(state, FINDINGS_STATE_MOST, "offered", text);
}

/* A finding that was being written at a kill is shrunk if its file was written; the log is
 * updated. */
static void read_offered(struct campaign *c, const char *state)
{
    char text[64];
    size_t i;
    unsigned long long hash;
    if (campaign_state_get(state, "offered", text, sizeof text) &&
        sscanf(text, "%zu:%16llx", &i, &hash) == 2 && i < c->marks)
        c->dirty = c->mark[i].shrunk = findings_entry(c->findings, i)->smallest.hash == hash;
}

void campaign_state_read(struct campaign *c)
{
    const char *state = findings_state(c->findings);
    char text[1024];
    read_turnout(c, state);
    read_edges(c, state);
    c->corpus_done = number(state, "corpus_done") != 0;
    c->next = c->applied = number(state, "next");
    c->mut_next = number(state, "mut");
    c->trials_done = c->view.before = number(state, "trials");
    if (campaign_state_get(state, "coverage", text, sizeof text) &&
        strlen(text) == 16 * COVERAGE_WORDS)
        for (size_t w = 0; w < COVERAGE_WORDS; w++) {
            char word[17];
            memcpy(word, text + 16 * w, 16);
            word[16] = '\0';
            c->view.coverage[w] = strtoull(word, NULL, 16);
        }
    (void)campaign_state_get(state, "shrunk", text, sizeof text);
    for (size_t i = 0; i < c->marks && text[i]; i++)
        c->mark[i].shrunk = text[i] == '1';
    read_offered(c, state);
}

enum status campaign_state_write(struct campaign *c)
{
    char state[FINDINGS_STATE_MOST] = "", coverage[16 * COVERAGE_WORDS + 1];
    for (size_t w = 0; w < COVERAGE_WORDS; w++)
        sprintf(coverage + 16 * w, "%016llx", (unsigned long long)c->view.coverage[w]);
    if (strlen(c->options->identity) < sizeof state / 2)
        strcpy(state, c->options->identity);
    if (!state[0] || !put_number(state, "corpus_done", c->corpus_done) ||
        !put_number(state, "next", c->applied) || !put_number(state, "mut", c->mut_next) ||
        !put_number(state, "trials", c->trials_done) ||
        !campaign_state_put(state, sizeof state, "coverage", coverage) || !put_turnout(c, state) ||
        !put_edges(c, state) || !put_shrunk(c, state) || !put_offered(c, state))
        return fail(c->reason, STATUS_INPUT, "the options of a campaign are too long to be kept");
    enum status status = findings_checkpoint(c->findings, state, c->reason);
    if (!status)
        status = campaign_pairs_write(c);
    c->dirty = c->found = false;
    c->saved_ns = time_ns();
    return status;
}
