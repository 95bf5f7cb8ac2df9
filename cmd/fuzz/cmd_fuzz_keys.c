/* The options that decide what a campaign finds, as they are saved in its folder. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_fuzz.h"

#include "ref/outside/plugin_guard.h"
#include "ref/base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The defaults with --pairs. */
static const char *const pair_engines =
    "cpu,vulkan,fast,cpu_stackless,vulkan_stackless,brute,vulkan_brute,vulkan:texel,"
    "vulkan:reference";
static const char *const pair_layouts = "every";

const char *fuzz_key_name(enum fuzz_key key)
{
    static const char *const name[KEY_COUNT] = {
        "seed",   "shard",  "engine",    "layout", "builder", "faithful", "rays", "triangles",
        "driver", "device", "workgroup", "pairs",  "worlds",  "turns",    "steps"};
    return name[key];
}

bool fuzz_has_every_layout(const struct fuzz_command *c)
{
    return c->layout.count > table_all(TABLE_LAYOUTS).count &&
           !table_member(TABLE_LAYOUTS, c->layout.count, NULL);
}

static bool has_plugin(const struct list *list)
{
    bool has = false;
    for (size_t i = 0; i < list->count; i++)
        has = has || plugin_path(layouts_all[list->index[i]]);
    return has;
}

/* Appends the list. External layouts are written by path, so that the text can be parsed again. */
static void print_list(enum table table, const struct list *list, char text[FUZZ_VALUE_MOST])
{
    for (size_t i = 0; i < list->count; i++) {
        size_t index = list->index[i];
        const char *path = table == TABLE_LAYOUTS ? plugin_path(layouts_all[index]) : NULL;
        text_append(text, FUZZ_VALUE_MOST, "%s%s", i ? "," : "",
                    path ? path : table_member(table, index, NULL));
    }
}

void fuzz_key_print(const struct fuzz_command *c, enum fuzz_key key, char text[FUZZ_VALUE_MOST])
{
    text[0] = '\0';
    switch (key) {
    case KEY_SEED:
        snprintf(text, FUZZ_VALUE_MOST, "%llu", (unsigned long long)c->seed);
        break;
    case KEY_SHARD:
        if (c->shards > 0)
            snprintf(text, FUZZ_VALUE_MOST, "%u/%u", c->shard, c->shards);
        break;
    case KEY_ENGINE:
        print_list(TABLE_ENGINES, &c->engine, text);
        break;
    case KEY_LAYOUT:
        if (fuzz_has_every_layout(c) && !has_plugin(&c->layout))
            snprintf(text, FUZZ_VALUE_MOST, "every");
        else
            print_list(TABLE_LAYOUTS, &c->layout, text);
        break;
    case KEY_BUILDER:
        print_list(TABLE_BUILDERS, &c->builder, text);
        break;
    case KEY_FAITHFUL:
        snprintf(text, FUZZ_VALUE_MOST, "%s", c->faithful ? "yes" : "");
        break;
    case KEY_RAYS:
        snprintf(text, FUZZ_VALUE_MOST, "%u", c->rays);
        break;
    case KEY_TRIANGLES:
        snprintf(text, FUZZ_VALUE_MOST, "%u-%u", c->triangles_least, c->triangles_most);
        break;
    case KEY_DRIVER:
        snprintf(text, FUZZ_VALUE_MOST, "%s", c->driver);
        break;
    case KEY_DEVICE:
        if (c->engines.device >= 0)
            snprintf(text, FUZZ_VALUE_MOST, "%d", c->engines.device);
        break;
    case KEY_WORKGROUP:
        if (c->engines.workgroup > 0)
            snprintf(text, FUZZ_VALUE_MOST, "%u", c->engines.workgroup);
        break;
    case KEY_PAIRS:
        if (c->pairs > 0)
            snprintf(text, FUZZ_VALUE_MOST, "%llu", (unsigned long long)c->pairs);
        break;
    case KEY_WORLDS:
        snprintf(text, FUZZ_VALUE_MOST, "%s", c->worlds ? "yes" : "");
        break;
    case KEY_TURNS:
        snprintf(text, FUZZ_VALUE_MOST, "%s", c->turns ? "yes" : "");
        break;
    case KEY_STEPS:
        snprintf(text, FUZZ_VALUE_MOST, "%s", c->steps ? "yes" : "");
        break;
    case KEY_COUNT:
        break;
    }
}

/* --- engines that run here ------------------------------------------------------------------- */

struct probe {
    struct list list;
    struct engine_options options;
};

struct probed {
    bool runs[LIST_MOST];
    char why[LIST_MOST][100];
};

static void probe(struct child *parent, void *user)
{
    const struct probe *what = user;
    struct probed out = {.runs = {false}};
    for (size_t i = 0; i < what->list.count; i++) {
        const struct engine *engine = engines[what->list.index[i]];
        struct reason reason = {""};
        void *self = NULL;
        out.runs[i] = engine_open(engine, &what->options, &self, &reason) == STATUS_OK;
        if (out.runs[i])
            engine->close(self);
        snprintf(out.why[i], sizeof out.why[i], "%.99s", reason.text);
    }
    if (!child_send(parent, &out, sizeof out, CHILD_FOREVER))
        return;
}

enum status fuzz_default_engines(struct fuzz_command *c, struct reason *reason)
{
    struct probe what = {.options = c->engines};
    struct probed out;
    struct child child;
    enum status status = table_parse(
        TABLE_ENGINES, "--engine", c->pairs > 0 ? pair_engines : FUZZ_ENGINES, &what.list, reason);
    what.options.threads = 1;
    what.options.driver = c->driver[0] ? c->driver : NULL;
    if (!status)
        status = child_start(probe, &what, &child, reason);
    if (status)
        return status;
    bool heard = child_receive_into(&child, &out, sizeof out, 60000);
    child_end(&child, heard ? 5000 : 0, NULL);
    if (!heard) { /* opening an engine ended the process: the campaign reports it */
        c->engine = what.list;
        return STATUS_OK;
    }
    for (size_t i = 0; i < what.list.count; i++)
        if (out.runs[i])
            c->engine.index[c->engine.count++] = what.list.index[i];
        else
            text_append(c->left_out, sizeof c->left_out, "%s%s: %s", c->left_out[0] ? "; " : "",
                        engines[what.list.index[i]]->name, out.why[i]);
    return c->engine.count ? STATUS_OK : fail(reason, STATUS_UNSUPPORTED, "%.300s", c->left_out);
}

/* --- the folder's campaign ------------------------------------------------------------------- */

/* --compiler and --buffers make a list of engines, too. */
static bool was_given(const struct fuzz_command *c, enum fuzz_key key)
{
    return option_was_given(fuzz_key_name(key)) ||
           (key == KEY_ENGINE && (c->compilers.list || c->compilers.memory));
}

/* Options may still differ if nothing was played yet, so that a mistyped command can be
 * corrected. */
static enum status compare(struct fuzz_command *c, const char *state, enum fuzz_key key,
                           struct reason *reason)
{
    char kept[FUZZ_VALUE_MOST] = "", mine[FUZZ_VALUE_MOST];
    (void)campaign_state_get(state, fuzz_key_name(key), kept, sizeof kept);
    if (!was_given(c, key))
        return kept[0] ? option_put(&fuzz_set, c, fuzz_key_name(key), kept, reason) : STATUS_OK;
    fuzz_key_print(c, key, mine);
    if (strcmp(kept, mine) == 0 ||
        (findings_count(c->findings) == 0 && campaign_state_is_unplayed(state)))
        return STATUS_OK;
    return fail(reason, STATUS_INPUT,
                "--%s %.60s: the campaign in %.60s has %.60s (another --dir begins a new one)",
                fuzz_key_name(key), mine, c->folder, kept[0] ? kept : "none");
}

static enum status resume(struct fuzz_command *c, const char *state, struct reason *reason)
{
    char version[32] = "";
    enum status status = STATUS_OK;
    (void)campaign_state_get(state, "gen", version, sizeof version);
    if (strtoul(version, NULL, 10) != GEN_VERSION)
        return fail(reason, STATUS_INPUT,
                    "%.100s: its trials were made by version %.10s of the generators, this is %u "
                    "(another --dir begins a new campaign)",
                    c->folder, version[0] ? version : "0", GEN_VERSION);
    for (enum fuzz_key key = 0; key < KEY_COUNT && !status; key++)
        status = compare(c, state, key, reason);
    return status;
}

/* How many contestants engines and layouts make. */
static enum status check_count(const struct fuzz_command *c, struct reason *reason)
{
    size_t count = 0;
    for (size_t i = 0; i < c->engine.count; i++)
        count += engines[c->engine.index[i]]->needs_packed && c->pairs == 0 ? c->layout.count : 1;
    if (count <= FUZZ_CONTESTANTS_MOST)
        return STATUS_OK;
    if (c->pairs > 0)
        return fail(reason, STATUS_INPUT, "--engine: %zu engines, and at most %u are drawn", count,
                    FUZZ_CONTESTANTS_MOST);
    return fail(
        reason, STATUS_INPUT,
        "--engine, --layout: %zu contestants (%zu of --engine, on each of %zu layouts if one "
        "is needed), and at most %u take part",
        count, c->engine.count, c->layout.count, FUZZ_CONTESTANTS_MOST);
}

enum status fuzz_identify(struct fuzz_command *c, struct reason *reason)
{
    const char *state = findings_state(c->findings);
    char value[FUZZ_VALUE_MOST];
    enum status status = STATUS_OK;
    if (state[0])
        status = resume(c, state, reason);
    else if (findings_count(c->findings) > 0)
        status =
            fail(reason, STATUS_INPUT,
                 "%.100s: its findings come from raydiff merge, not from a campaign", c->folder);
    if (!status && c->layout.count == 0)
        status = table_parse(TABLE_LAYOUTS, "--layout", c->pairs > 0 ? pair_layouts : FUZZ_LAYOUTS,
                             &c->layout, reason);
    if (!status && c->engine.count == 0)
        status = fuzz_default_engines(c, reason);
    if (!status)
        status = check_count(c, reason);
    if (status)
        return status;
    snprintf(value, sizeof value, "%u", GEN_VERSION);
    bool fits = campaign_state_put(c->identity, sizeof c->identity, "gen", value);
    for (enum fuzz_key key = 0; key < KEY_COUNT && fits; key++) {
        fuzz_key_print(c, key, value);
        fits = strlen(value) < sizeof value - 1; /* else it may be cut */
        if (fits && value[0])
            fits = campaign_state_put(c->identity, sizeof c->identity, fuzz_key_name(key), value);
    }
    return fits ? STATUS_OK : fail(reason, STATUS_INPUT, "the options are too long to be kept");
}
