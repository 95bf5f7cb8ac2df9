/* raydiff explain of a finding about a tree: shows which record, slot and bound are at fault, and
 * by which rule. Such a finding has no ray, and any engine that takes trees can be used. */
#include "cmd/explain/cmd_explain_inner.h"

#include "fuzz/play/player.h"
#include "ref/outside/plugin_shader.h"
#include "fuzz/play/trial_tree.h"
#include "cmd/common/cmd_json.h"
#include "ref/base/json_record.h"
#include "ref/base/command.h"

#include <stdio.h>

/* Plays the trial and finds the fault of its tree, as raydiff fuzz and replay do. The kind of
 * *finding is FUZZ_KIND_TREE, or FUZZ_KIND_COUNT if nothing is at fault. */
static enum status find_fault(const struct explain_options *o, const struct fuzz_trial *trial,
                              struct fuzz_finding *finding, struct reason *reason)
{
    const struct fuzz_field field = {
        .who = {{o->of.engine, o->of.layout}}, .count = 1, .options = o->engines};
    struct fuzz_player *player;
    struct fuzz_result result;
    *finding = (struct fuzz_finding){.signature = {.kind = FUZZ_KIND_COUNT}};
    enum status status = fuzz_player_open(&field, &player, reason);
    if (!status)
        status = fuzz_play(player, trial, 1, &result, NULL, NULL, reason);
    for (size_t i = 0; !status && i < result.finding_count; i++)
        if (result.finding[i].signature.kind == FUZZ_KIND_TREE) {
            *finding = result.finding[i];
            status = fuzz_explain(player, trial, finding, reason);
        }
    fuzz_player_close(player);
    return status;
}

/* Packs the tree and compares what C and GLSL decode. A layout that cannot hold the tree or fails
 * to pack it is an error, not a fault of the tree. */
static enum status try_packing(const struct explain_options *o, const struct fuzz_trial *trial,
                               struct explain_decode *decode, struct reason *reason)
{
    struct bvh bvh;
    struct packed packed;
    enum status status = fuzz_trial_tree(trial, o->of.layout, &bvh, &packed, NULL, reason);
    if (!status)
        status = explain_decode(o, &packed, decode, reason);
    packed_free(&packed);
    bvh_free(&bvh);
    return status;
}

static enum status write_json(const struct explain_options *o, const struct fuzz_finding *finding,
                              const struct explain_decode *decode, const char *again, int code,
                              struct reason *reason)
{
    const bool sound = finding->signature.kind == FUZZ_KIND_COUNT;
    json_t *subject =
        json_record("scene=%s layout=%s store=%s builder=%s leaf=%u", o->of.spec,
                    o->of.layout->name, o->of.store ? o->of.store->name : tri_stores[0]->name,
                    o->of.builder->name, o->of.build.leaf);
    json_t *root = json_record(
        "raydiff=%s exit=%d subject=%p command=%s cause=%s tree=%s decode=%p", RAYDIFF_VERSION,
        code, subject, again, cause_name(sound ? CAUSE_NONE : finding->signature.cause),
        finding->said, explain_decode_json(decode));
    return json_write(o->json, root, 9, reason);
}

static void print_page(const struct explain_options *o, const struct fuzz_trial *trial,
                       const struct fuzz_finding *finding, const char *again,
                       const struct screen *screen)
{
    char text[STORED_NAME_MOST];
    enum cause cause = finding->signature.cause;
    screen_text(screen, "scene     %s: %u triangle%s\n", o->of.spec, trial->scene.tri_count,
                plural(trial->scene.tri_count));
    screen_text(screen, "tree      layout %s, builder %s, leaf %u\n",
                stored_name(o->of.layout, o->of.store, text), o->of.builder->name,
                o->of.build.leaf);
    if (finding->signature.kind == FUZZ_KIND_COUNT) {
        screen_text(screen, "verdict   its bytes are the tree that was built\n");
    } else {
        screen_text(screen, "verdict   WRONG: %s\n", finding->said);
        screen_text(screen, "cause     %s: %s\n", cause_name(cause), cause_text(cause));
    }
    printf("again     %s\n", again);
}

static void print_conclusion(const struct fuzz_finding *finding,
                             const struct explain_decode *decode, const struct screen *screen)
{
    const enum cause cause = finding->signature.cause;
    char text[EXPLAIN_CONCLUSION_MOST] = "the bytes are the tree that was built";
    if (finding->signature.kind != FUZZ_KIND_COUNT)
        snprintf(text, sizeof text, "WRONG: the tree, by %s: %s", cause_name(cause),
                 cause_text(cause));
    explain_print_conclusion(text, decode, screen);
}

enum status explain_tree_finding(const struct explain_options *o, const struct finding_file *file,
                                 int *code, struct reason *reason)
{
    struct fuzz_finding finding;
    struct explain_decode decode = {.asked = false};
    char again[EXPLAIN_COMMAND_MOST] = "raydiff explain";
    enum status status = find_fault(o, &file->trial, &finding, reason);
    if (!status && finding.signature.kind == FUZZ_KIND_COUNT)
        status = try_packing(o, &file->trial, &decode, reason);
    if (status)
        return status;
    command_word(again, sizeof again, o->of.spec);
    plugin_command(again, sizeof again, o->of.layout);
    *code =
        finding.signature.kind == FUZZ_KIND_COUNT ? explain_decode_code(&decode) : EXIT_MISMATCH;
    const struct screen screen = screen_make(&o->screen);
    print_page(o, &file->trial, &finding, again, &screen);
    explain_decode_print(&decode, &screen);
    print_conclusion(&finding, &decode, &screen);
    return o->json ? write_json(o, &finding, &decode, again, *code, reason) : STATUS_OK;
}
