/* The results of raydiff replay, as text and as JSON. */
#include "cmd/fuzz/cmd_replay.h"

#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

static const char *fate_name(enum replay_fate fate)
{
    static const char *const names[] = {"played",  "skipped", "refused",
                                        "crashed", "hung",    "failed"};
    return names[fate];
}

static const char *outcome(const struct replay_file *file)
{
    if (file->code == 77)
        return "not played: its engine cannot run here";
    if (file->refused)
        return "not played: refused, so nothing is tested";
    if (!file->file.has_signature)
        return file->fails ? "FAILS" : "clean";
    return file->fails ? "STILL FAILS" : "does not fail";
}

static void expectation(const struct finding_file *file, char text[FUZZ_SIGNATURE_MOST])
{
    snprintf(text, FUZZ_SIGNATURE_MOST, "clean");
    if (file->has_signature)
        fuzz_signature_print(&file->signature, text);
}

void replay_finding_line(const struct fuzz_trial *trial, const struct fuzz_finding *finding,
                         char *text, size_t size)
{
    text[0] = '\0';
    if (finding->ray < trial->ray_count && finding->judgement.verdict == VERDICT_WRONG)
        fuzz_finding_line(trial, finding, text, size);
}

void replay_command(const char *path, const struct engine *engine, const struct layout *layout,
                    char *text, size_t text_bytes)
{
    snprintf(text, text_bytes, "raydiff replay");
    command_word(text, text_bytes, path);
    if (layout && layout->outside)
        plugin_command(text, text_bytes, layout);
    if (!engine || !(pipe_is_peer(engine->name) || file_of_engine(engine->name)))
        return;
    command_word(text, text_bytes, "--engine");
    command_word(text, text_bytes, engine->name);
}

void replay_plugins(const struct findings *findings, char *text, size_t text_bytes)
{
    for (size_t i = 0; i < findings_count(findings); i++) {
        const struct layout *layout = findings_entry(findings, i)->signature.layout;
        bool before = false;
        for (size_t k = 0; k < i; k++)
            before = before || findings_entry(findings, k)->signature.layout == layout;
        if (layout && layout->outside && !before)
            plugin_command(text, text_bytes, layout);
    }
}

static void print_lines(const struct screen *screen, const char *title, const char *lines)
{
    for (const char *at = lines; *at;) {
        size_t length = strcspn(at, "\n");
        screen_record(screen, PAINT_PLAIN, "  %-8s %.*s\n", at == lines ? title : "", (int)length,
                      at);
        at += length + (at[length] == '\n');
    }
}

static void print_finding(const struct screen *screen, const struct replay_file *file,
                          const struct replay_played *played, size_t i, const char *who)
{
    const struct fuzz_finding *finding = &played->finding[i];
    char text[512], what[600] = "";
    replay_finding_line(&file->file.trial, finding, text, sizeof text);
    if (finding->said[0])
        snprintf(what, sizeof what, ", %s", finding->said);
    else if (text[0])
        snprintf(what, sizeof what, ", ray %u %s", finding->ray, text);
    screen_record(screen, PAINT_PLAIN, "  %s %s %s%s%s\n", who,
                  fuzz_kind_name(finding->signature.kind), cause_name(finding->signature.cause),
                  what, file->file.has_signature && i == played->expected ? " <- expected" : "");
}

static void print_played(const struct screen *screen, const struct replay_file *file,
                         const struct replay_played *played)
{
    char who[160];
    snprintf(who, sizeof who, "%-13s %-13s", played->who.engine->name,
             played->who.layout ? played->who.layout->name : "-");
    if (played->fate != REPLAYED)
        screen_record(screen, PAINT_PLAIN, "  %s %s: %s%s\n", who, fate_name(played->fate),
                      played->reason, played->crashed_as_expected ? ", as expected" : "");
    else if (played->finding_count == 0)
        screen_record(screen, PAINT_PLAIN, "  %s nothing wrong\n", who);
    for (size_t i = 0; i < played->finding_count && played->fate == REPLAYED; i++) {
        print_finding(screen, file, played, i, who);
        snprintf(who, sizeof who, "%-13s %-13s", "", "");
    }
}

static void print_head(const struct screen *screen, const struct replay_file *file)
{
    char text[FUZZ_SIGNATURE_MOST];
    expectation(&file->file, text);
    screen_record(screen,
                  file->code == EXIT_AGREE     ? PAINT_GOOD
                  : file->code == EXIT_SKIPPED ? PAINT_DIM
                                               : PAINT_BAD,
                  "%s: %s: %s\n", file->path, text, outcome(file));
}

void replay_print(const struct screen *screen, bool brief, const struct replay_file *file)
{
    const struct fuzz_trial *trial = &file->file.trial;
    const struct fuzz_origin *origin = &trial->origin;
    print_head(screen, file);
    if (brief) { /* unexpected results only */
        for (size_t i = 0; i < file->played_count; i++) {
            const struct replay_played *played = &file->played[i];
            if (played->fate >= REPLAY_CRASHED ||
                (!file->file.has_signature && played->finding_count > 0))
                print_played(screen, file, played);
        }
        return;
    }
    char instances[40] = "";
    if (trial->world.is)
        snprintf(instances, sizeof instances, "%u instance%s, ", trial->world.instance_count,
                 plural(trial->world.instance_count));
    screen_record(screen, PAINT_PLAIN,
                  "  trial    %s%u triangle%s, %u ray%s, builder %s, leaf %u, box %s, triangle %s, "
                  "query %s\n",
                  instances, trial->scene.tri_count, plural(trial->scene.tri_count),
                  trial->ray_count, plural(trial->ray_count), trial->builder->name,
                  trial->build.leaf, trial->box->name, trial->tri->name, query_name(trial->query));
    if (origin->recipe[0])
        screen_record(screen, PAINT_PLAIN, "  made as  %s\n", origin->recipe);
    if (origin->version > 0)
        screen_record(screen, PAINT_PLAIN,
                      "  from     seed %llu, trial %llu of stream %s, generators %u\n",
                      (unsigned long long)origin->seed, (unsigned long long)origin->index,
                      origin->mutated ? "mut" : "gen", origin->version);
    for (size_t i = 0; i < file->played_count; i++)
        print_played(screen, file, &file->played[i]);
    print_lines(screen, "then", file->file.versions);
    print_lines(screen, "now", file->now);
}

static json_t *finding_json(const struct replay_file *file, const struct replay_played *played,
                            size_t i)
{
    const struct fuzz_finding *finding = &played->finding[i];
    char signature[FUZZ_SIGNATURE_MOST], text[512];
    fuzz_signature_print(&finding->signature, signature);
    replay_finding_line(&file->file.trial, finding, text, sizeof text);
    const enum fuzz_kind kind = finding->signature.kind;
    const bool on_ray = kind != FUZZ_KIND_TREE && kind != FUZZ_KIND_REFUSED &&
                        finding->ray < file->file.trial.ray_count;
    return json_record("signature=%s ray=%p text=%s expected=%i", signature,
                       on_ray ? json_integer((json_int_t)finding->ray) : json_null(), text,
                       i == played->expected);
}

static json_t *played_json(const struct replay_file *file, const struct replay_played *played)
{
    json_t *findings = json_array();
    for (size_t i = 0; i < played->finding_count; i++)
        json_array_append_new(findings, finding_json(file, played, i));
    return json_record(
        "engine=%s layout=%p status=%s reason=%s findings=%p", played->who.engine->name,
        json_text(played->who.layout ? played->who.layout->name : NULL), fate_name(played->fate),
        played->fate == REPLAYED ? "" : played->reason, findings);
}

static json_t *lines_json(const char *lines)
{
    json_t *out = json_array();
    for (const char *at = lines; *at;) {
        size_t length = strcspn(at, "\n");
        json_array_append_new(out, json_stringn(at, length));
        at += length + (at[length] == '\n');
    }
    return out;
}

static json_t *file_json(const struct replay_file *file)
{
    char expect[FUZZ_SIGNATURE_MOST];
    json_t *played = json_array();
    expectation(&file->file, expect);
    for (size_t i = 0; i < file->played_count; i++)
        json_array_append_new(played, played_json(file, &file->played[i]));
    json_t *root = json_record(
        "file=%s expect=%s fails=%i exit=%d triangles=%u rays=%u then=%p now=%p played=%p",
        file->path, expect, file->fails, file->code, file->file.trial.scene.tri_count,
        file->file.trial.ray_count, lines_json(file->file.versions), lines_json(file->now), played);
    if (file->file.trial.world.is)
        json_add(root, "instances=%u", file->file.trial.world.instance_count);
    return root;
}

enum status replay_write_json(const char *path, const struct replay_file *file, size_t count,
                              const struct turnout *turnout, int code, struct reason *reason)
{
    json_t *files = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(files, file_json(&file[i]));
    json_t *root = json_record("raydiff=%s exit=%d named=%p files=%p", RAYDIFF_VERSION, code,
                               json_turnout(turnout), files);
    return json_write(path, root, 17, reason);
}
