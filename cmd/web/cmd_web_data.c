/* What a page of raydiff web carries for the browser: trees, rays, C's answers, what is right. */
#include "cmd/web/cmd_web.h"

#include "fuzz/play/trial_tree.h"
#include "gpu/webgpu/webgpu_job.h"
#include "ref/store.h"
#include "ref/twin/twin.h"

#include <stdlib.h>
#include <string.h>

/* Rays times triangles that are judged for a page. */
#define TESTS_MOST ((size_t)1 << 22)

static enum status make_tree(const struct explain_page *page, const struct layout *layout,
                             const struct tri_store *store, struct bvh *bvh, struct packed *packed,
                             struct reason *reason)
{
    const struct explain_of *of = page->of;
    if (page->file) {
        struct fuzz_trial trial = page->file->trial;
        trial.store = store;
        return fuzz_trial_tree(&trial, layout, bvh, packed, NULL, reason);
    }
    const struct builder *builder = of->builder ? of->builder : builders[0];
    enum status status = bvh_build(builder, page->scene, &of->build, bvh, reason);
    return status ? status : packed_make_stored(layout, store, bvh, page->scene, packed, reason);
}

/* NULL: C did not finish. */
static struct hit *answers_of(const struct job *job, const struct ray *ray, size_t count)
{
    const struct engine *engine = engine_reference(true);
    const struct engine_options options = engine_options_default();
    struct hit *hit = alloc_zeroed(count, sizeof *hit);
    struct trace_report report;
    struct reason reason;
    void *self = NULL;
    enum status status = hit ? engine_open(engine, &options, &self, &reason) : STATUS_MEMORY;
    if (!status)
        status = engine->prepare(self, job, &reason);
    if (!status)
        status = engine->trace(self, ray, count, hit, &report, &reason);
    if (self)
        engine->close(self);
    if (!status)
        return hit;
    free(hit);
    return NULL;
}

static enum status add_job(const struct explain_page *page, const struct layout *layout,
                           const struct tri_store *store, struct web_data *out,
                           struct reason *reason)
{
    struct web_job *to = &out->job[out->job_count++];
    char room[STORED_NAME_MOST];
    struct bvh bvh = {0};
    struct packed packed = {0};
    struct webgpu_job as = {0};
    snprintf(to->name, sizeof to->name, "%s", stored_name(layout, store, room));
    enum status status = make_tree(page, layout, store, &bvh, &packed, &to->why);
    const struct job job = {.scene = page->scene,
                            .packed = &packed,
                            .box = page->of->box,
                            .tri = page->of->tri,
                            .query = page->of->query};
    if (!status)
        status = webgpu_job_make(&job, &as, &to->why);
    if (!status)
        status = webgpu_words(&as.program, &to->words, &to->word_count, &to->why);
    if (!status)
        to->answer = answers_of(&job, out->ray, out->count);
    webgpu_job_free(&as);
    packed_free(&packed);
    bvh_free(&bvh);
    return status == STATUS_MEMORY ? fail(reason, status, "%s", to->why.text) : STATUS_OK;
}

static enum status add_jobs(const struct explain_page *page, struct web_data *out,
                            struct reason *reason)
{
    const struct layout *own = page->of->layout, *plain = layouts[0];
    const struct tri_store *indexed = tri_stores[0];
    const struct tri_store *store = own && page->of->store ? page->of->store : indexed;
    enum status status = STATUS_OK;
    if (own && (own != plain || store != indexed))
        status = add_job(page, own, store, out, reason);
    return status ? status : add_job(page, plain, indexed, out, reason);
}

/* What WGSL's arithmetic may make of the triangle test; the faults of RTRS's are not excused. */
static enum status find_right(const struct explain_page *page, struct web_data *out,
                              struct reason *reason)
{
    const struct fuzz_trial trial = {.scene = *page->scene, .query = page->of->query};
    struct model model = engine_model(engine_find("webgpu"), NULL, page->of->tri);
    if (model.formula == TWIN_MT_RTRS)
        model.formula = TWIN_MT;
    return export_rights_make(&trial, &model, out->ray, (uint32_t)out->count, &out->right,
                              &out->right_count, reason);
}

enum status web_data_make(const struct explain_page *page, struct web_data *out,
                          struct reason *reason)
{
    const size_t triangles = page->scene->tri_count ? page->scene->tri_count : 1;
    size_t most = TESTS_MOST / triangles;
    most = most < 1 ? 1 : most < WEB_RAYS_MOST ? most : WEB_RAYS_MOST;
    *out = (struct web_data){.count = page->count < most ? page->count : most};
    out->first = page->index < out->count ? 0 : page->index - out->count + 1;
    out->ray = page->all + out->first;
    enum status status = add_jobs(page, out, reason);
    if (!status)
        status = find_right(page, out, reason);
    if (status)
        web_data_free(out);
    return status;
}

void web_data_free(struct web_data *data)
{
    for (size_t i = 0; i < data->job_count; i++) {
        free(data->job[i].words);
        free(data->job[i].answer);
    }
    free(data->right);
    *data = (struct web_data){.ray = NULL};
}
