/* Everything that an exported finding consists of. */
#include "fuzz/export/export_inner.h"

#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "fuzz/play/trial_tree.h"
#include "fuzz/findings/versions.h"
#include "ref/trace/trace.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORDS_MOST (1u << 21) /* of what is written; more is no file to send to anybody */

const char *const export_form_names[EXPORT_FORMS + 1] = {"c", "amber", "text", NULL};

bool export_is_vulkan(const struct export_case *the)
{
    return the->subject == SUBJECT_VULKAN || the->subject == SUBJECT_BRUTE ||
           the->subject == SUBJECT_QUERY;
}

bool export_is_unnamed(const struct export_case *the)
{
    return the->trial->query == QUERY_ANY && the->model.any_unnamed;
}

bool export_is_followed(const struct export_case *the)
{
    return the->model.formula == TWIN_UNKNOWN;
}

/* --- for whom --- */

/* What can be exported in a form that needs the engine. */
static bool find_subject(const char *engine, enum export_subject *out)
{
    static const struct {
        const char *engine;
        enum export_subject subject;
    } known[] = {{"vulkan", SUBJECT_VULKAN},
                 {"vulkan_brute", SUBJECT_BRUTE},
                 {"rayquery", SUBJECT_QUERY},
                 {"embree", SUBJECT_EMBREE},
                 {"embree_robust", SUBJECT_EMBREE_ROBUST}};
    for (size_t i = 0; i < ARRAY_COUNT(known); i++)
        if (strcmp(known[i].engine, engine) == 0) {
            *out = known[i].subject;
            return true;
        }
    return false;
}

/* Kinds that no answer of the engine shows. */
static enum status check_kind(const struct export_case *the)
{
    const struct finding_file *file = the->file;
    if (!file->has_signature)
        return STATUS_OK;
    switch (file->signature.kind) {
    case FUZZ_KIND_TREE:
        return fail(the->reason, STATUS_INPUT,
                    "the fault lies in the bytes that the layout packs, not in an engine: `raydiff "
                    "replay` shows it; name --engine to export its rays all the same");
    case FUZZ_KIND_REFUSED:
    case FUZZ_KIND_PROTOCOL:
        return fail(the->reason, STATUS_INPUT,
                    "a finding of kind %s has no wrong answer to show: `raydiff replay` plays it",
                    fuzz_kind_name(file->signature.kind));
    default:
        return STATUS_OK;
    }
}

/* A world is for any tracer that reads text. */
static enum status choose_world(struct export_case *the)
{
    if (the->options->form != EXPORT_TEXT)
        return fail(the->reason, STATUS_INPUT,
                    "is a trial of a world: --form text writes world, rays and what is right; "
                    "`raydiff replay` plays it");
    if (the->options->engine || the->options->layout)
        return fail(the->reason, STATUS_INPUT,
                    "--%s: is a trial of a world, whose text is for any tracer",
                    the->options->engine ? "engine" : "layout");
    the->subject = SUBJECT_TRACER;
    return trial_meshes_make(&the->trial->world, &the->trial->scene, &the->meshes, the->reason);
}

static enum status choose(struct export_case *the)
{
    const struct finding_file *file = the->file;
    const struct export_options *options = the->options;
    if (file->trial.world.is)
        return choose_world(the);
    const char *name = options->engine       ? options->engine->name
                       : file->has_signature ? file->signature.engine
                                             : "vulkan";
    the->layout = options->layout ? options->layout : file->signature.layout;
    if (find_subject(name, &the->subject)) {
        the->engine = engine_find(name);
        enum status status = options->engine ? STATUS_OK : check_kind(the);
        if (status)
            return status;
    } else if (options->form == EXPORT_TEXT) {
        the->subject = SUBJECT_TRACER;
    } else if (pipe_is_peer(name) || file_of_engine(name)) {
        return fail(the->reason, STATUS_INPUT,
                    "engine '%s' is a tracer of its own: --form text writes scene, rays and what "
                    "is right",
                    name);
    } else {
        return fail(the->reason, STATUS_INPUT,
                    "engine '%s' is raydiff's own C, it has no vendor to report to: `raydiff "
                    "replay` shows and explains it; --engine vulkan exports it for a driver",
                    name);
    }
    if (the->subject != SUBJECT_VULKAN)
        the->layout = NULL;
    else if (!the->layout)
        the->layout = layout_find("f32");
    if (options->form == EXPORT_AMBER && the->subject != SUBJECT_VULKAN &&
        the->subject != SUBJECT_BRUTE)
        return fail(the->reason, STATUS_INPUT,
                    "an Amber script holds a compute shader of vulkan or vulkan_brute, not engine "
                    "%s: --form c",
                    name);
    return STATUS_OK;
}

/* --- rays --- */

static bool is_embree(const struct export_case *the)
{
    return the->subject == SUBJECT_EMBREE || the->subject == SUBJECT_EMBREE_ROBUST;
}

/* True if the finding is that this engine crashes or hangs. */
static bool dies(const struct export_case *the)
{
    const struct fuzz_signature *signature = &the->file->signature;
    return the->file->has_signature && the->engine &&
           strcmp(signature->engine, the->engine->name) == 0 &&
           (signature->kind == FUZZ_KIND_CRASH || signature->kind == FUZZ_KIND_HANG);
}

static enum status take_rays(struct export_case *the)
{
    const uint32_t only = the->options->ray;
    const struct fuzz_trial *trial = the->trial;
    if (only != EXPORT_ALL_RAYS && only >= trial->ray_count)
        return fail(the->reason, STATUS_INPUT, "there is no ray %u: the file has %u", only,
                    trial->ray_count);
    the->ray = alloc_zeroed(trial->ray_count, sizeof *the->ray);
    the->number = alloc_zeroed(trial->ray_count, sizeof *the->number);
    the->mode = trial->world.is ? alloc_zeroed(trial->ray_count, sizeof *the->mode) : NULL;
    if (!the->ray || !the->number || (trial->world.is && !the->mode))
        return fail(the->reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
    for (uint32_t i = 0; i < trial->ray_count; i++) {
        if (only != EXPORT_ALL_RAYS && i != only)
            continue;
        /* Embree does not promise to survive such rays: engine embree does not trace them
         * either. */
        if (is_embree(the) && !dies(the) && !ray_in_contract(&trial->ray[i])) {
            the->left_out++;
            continue;
        }
        the->ray[the->ray_count] = trial->ray[i];
        if (the->mode)
            the->mode[the->ray_count] = trial->world.mode[i];
        the->number[the->ray_count++] = i;
    }
    if (the->ray_count == 0)
        return fail(the->reason, STATUS_INPUT, "there is no ray%s",
                    the->left_out ? " that Embree promises to survive" : "");
    return STATUS_OK;
}

/* --- bytes --- */

static enum status describe(struct export_case *the)
{
    const uint32_t asked = the->options->engines.workgroup;
    const uint32_t workgroup = asked ? asked : ABI_WORKGROUP;
    enum status status = STATUS_OK;
    if (the->subject == SUBJECT_VULKAN)
        status = dispatch_tree(&the->job, workgroup, &the->dispatch, the->reason);
    else if (the->subject == SUBJECT_BRUTE)
        the->dispatch = dispatch_brute(&the->job, workgroup);
    else if (the->subject == SUBJECT_QUERY)
        the->dispatch = dispatch_query(&the->job, workgroup);
    the->dispatch.push.ray_count = the->ray_count;
    if (the->subject == SUBJECT_BRUTE && the->trial->scene.tri_count > DISPATCH_PART)
        status = fail(the->reason, STATUS_LIMIT,
                      "vulkan_brute takes more than %u triangles in several dispatches: shrink the "
                      "finding first",
                      DISPATCH_PART);
    bool needs_one = the->subject == SUBJECT_QUERY || is_embree(the);
    if (!status && needs_one && the->trial->scene.tri_count == 0)
        status =
            fail(the->reason, STATUS_INPUT, "a scene without triangles has nothing to build from");
    return status;
}

static enum status pack(struct export_case *the)
{
    const struct fuzz_trial *trial = the->trial;
    enum status status = STATUS_OK;
    if (trial->step_count > 0 && !the->layout)
        return fail(the->reason, STATUS_INPUT,
                    "its steps are not exported for an engine that builds its own tree: replay it");
    if (the->layout)
        status = fuzz_trial_tree(trial, the->layout, &the->bvh, &the->packed, NULL, the->reason);
    the->job = (struct job){.scene = &trial->scene,
                            .packed = the->layout ? &the->packed : NULL,
                            .box = trial->box,
                            .tri = trial->tri,
                            .query = trial->query};
    if (!status && the->subject != SUBJECT_TRACER)
        status = describe(the);
    uint64_t words = (uint64_t)the->packed.word_count + the->packed.item_count +
                     9 * (uint64_t)trial->scene.tri_count + 8 * (uint64_t)the->ray_count;
    if (!status && words > WORDS_MOST)
        status = fail(the->reason, STATUS_LIMIT,
                      "%llu words of data, at most %u are written: shrink the finding first",
                      (unsigned long long)words, WORDS_MOST);
    return status;
}

/* --- answers --- */

/* C on the same bytes. */
static enum status make_reference(struct export_case *the)
{
    const struct fuzz_trial *trial = the->trial;
    if (the->subject != SUBJECT_VULKAN && the->subject != SUBJECT_BRUTE)
        return STATUS_OK;
    the->reference = alloc_zeroed(the->ray_count, sizeof *the->reference);
    uint32_t *flag = alloc_zeroed(the->ray_count, sizeof *flag);
    if (!the->reference || !flag) {
        free(flag);
        return fail(the->reason, STATUS_MEMORY, "no memory for the answers of C");
    }
    if (the->layout)
        the->reference_fails = trace_rays(&the->job, the->ray, the->ray_count, the->reference, flag,
                                          NULL) != STATUS_OK;
    for (uint32_t i = 0; i < the->ray_count && !the->layout; i++)
        trace_brute(&trial->scene, trial->tri, trial->query, &the->ray[i], &the->reference[i]);
    free(flag);
    return STATUS_OK;
}

/* What may be assumed of a Vulkan driver that cannot be measured here. */
static struct model specified(const struct tri_test *tri)
{
    return (struct model){
        .formula = twin_of_tri(tri->id), .rounding = ROUNDING_VULKAN, .open = tri->open};
}

/* As the player judges: of a triangle test as published the repaired one's bounds, and no
 * watertight triangles in boxes that are not. */
static void adjust(struct export_case *the)
{
    if (the->model.formula == TWIN_MT_RTRS)
        the->model.formula = TWIN_MT;
    if (!job_keeps_watertight(&the->job))
        the->model.watertight = false;
}

/* Opens the engine, takes its model and traces the rays once. A failure is noted in not_asked; it
 * is no error. */
static enum status ask_here(struct export_case *the)
{
    struct reason why = {""};
    struct trace_report report;
    void *self = NULL;
    enum status status = STATUS_UNSUPPORTED;
    if (the->subject == SUBJECT_TRACER || dies(the))
        (void)fail(&why, status, "it was not run here");
    else
        status = engine_open(the->engine, &the->options->engines, &self, &why);
    the->measured = status == STATUS_OK;
    if (the->subject == SUBJECT_TRACER)
        the->model = (struct model){.formula = TWIN_UNKNOWN, .rounding = ROUNDING_VULKAN};
    else if (!the->measured && (the->subject == SUBJECT_VULKAN || the->subject == SUBJECT_BRUTE))
        the->model = specified(the->trial->tri);
    else /* needs no engine of the others */
        the->model = engine_model(the->engine, self, the->trial->tri);
    adjust(the);
    if (!status) {
        the->here = alloc_zeroed(the->ray_count, sizeof *the->here);
        if (!the->here) {
            the->engine->close(self);
            return fail(the->reason, STATUS_MEMORY, "no memory for %u answers", the->ray_count);
        }
        status = the->engine->prepare(self, &the->job, &why);
        if (!status)
            status = the->engine->trace(self, the->ray, the->ray_count, the->here, &report, &why);
        the->engine->close(self);
        fuzz_versions(&the->engine, 1, &the->options->engines, the->versions, sizeof the->versions);
    }
    if (!status)
        return STATUS_OK;
    free(the->here);
    the->here = NULL;
    snprintf(the->not_asked, sizeof the->not_asked, "%.180s", why.text);
    return status == STATUS_MEMORY ? fail(the->reason, status, "%s", why.text) : STATUS_OK;
}

static enum status find_truth(struct export_case *the)
{
    const struct fuzz_trial *trial = the->trial;
    enum status status = the->world ? oracle_make_world(the->world, &the->oracle, the->reason)
                                    : oracle_make(&trial->scene, &the->oracle, the->reason);
    if (status)
        return status;
    if (the->world)
        return oracle_closest_world(the->oracle, ORACLE_AUTO, ORACLE_CLOSED, the->ray, the->mode,
                                    the->ray_count, 1, the->truth, NULL, the->reason);
    return oracle_closest(the->oracle, ORACLE_AUTO, ORACLE_CLOSED, the->ray, the->ray_count, 1,
                          the->truth, NULL, the->reason);
}

static enum status judge_all(struct export_case *the)
{
    const struct fuzz_trial *trial = the->trial;
    struct judge *judge = NULL;
    the->truth = alloc_zeroed(the->ray_count, sizeof *the->truth);
    the->judgement = alloc_zeroed(the->ray_count, sizeof *the->judgement);
    if (!the->truth || !the->judgement)
        return fail(the->reason, STATUS_MEMORY, "no memory for the truth");
    enum status status = find_truth(the);
    if (!status)
        status = judge_make(the->oracle, &the->model, trial->query, &judge, the->reason);
    if (!status) {
        judge_by_bounds(judge, true);
        status = export_find_right(the, judge);
        judge_by_bounds(judge, false);
    }
    for (uint32_t i = 0; i < the->ray_count && !status && the->here; i++)
        status =
            judge_answer(judge, &the->ray[i], &the->truth[i], &the->here[i], &the->judgement[i]);
    for (uint32_t i = 0; i < the->ray_count && !status && the->reference; i++)
        if (!export_is_right(the, i, &the->reference[i]))
            the->reference_fails = true;
    judge_free(judge);
    return status;
}

enum status export_case_make(const struct finding_file *file, const struct export_options *options,
                             struct export_case *out, struct reason *reason)
{
    *out = (struct export_case){
        .file = file, .trial = &file->trial, .options = options, .reason = reason};
    snprintf(out->title, sizeof out->title, "clean");
    enum status status = choose(out);
    out->world = file->trial.world.is ? &out->meshes.world : NULL;
    if (!status && file->has_signature) {
        struct fuzz_signature signature = file->signature;
        if (out->engine) {
            fuzz_signature_set_engine(&signature, out->engine->name);
            signature.layout = out->layout;
        }
        fuzz_signature_print(&signature, out->title);
        out->bits_matter = signature.kind == FUZZ_KIND_BITS;
    }
    if (!status)
        status = take_rays(out);
    if (!status)
        status = pack(out);
    if (!status)
        status = make_reference(out);
    if (!status)
        status = ask_here(out);
    if (!status)
        status = judge_all(out);
    if (status)
        export_case_free(out);
    return status;
}

void export_case_free(struct export_case *the)
{
    trial_meshes_free(&the->meshes);
    free(the->mode);
    free(the->ray);
    free(the->number);
    bvh_free(&the->bvh);
    packed_free(&the->packed);
    oracle_free(the->oracle);
    free(the->truth);
    free(the->right);
    free(the->reference);
    free(the->here);
    free(the->judgement);
    *the = (struct export_case){0};
}
