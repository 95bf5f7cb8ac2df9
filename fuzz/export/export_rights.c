#include "fuzz/export/export_rights.h"

#include "fuzz/export/export_inner.h"

#include <stdlib.h>

static enum status find(struct export_case *the)
{
    struct judge *judge = NULL;
    the->truth = alloc_zeroed((size_t)the->ray_count + 1, sizeof *the->truth);
    if (!the->truth)
        return fail(the->reason, STATUS_MEMORY, "no memory for the truth");
    enum status status = oracle_make(&the->trial->scene, &the->oracle, the->reason);
    if (!status)
        status = oracle_closest(the->oracle, ORACLE_AUTO, ORACLE_CLOSED, the->ray, the->ray_count,
                                1, the->truth, NULL, the->reason);
    if (!status)
        status = judge_make(the->oracle, &the->model, the->trial->query, &judge, the->reason);
    if (!status) {
        judge_by_bounds(judge, true);
        status = export_find_right(the, judge);
    }
    judge_free(judge);
    return status;
}

enum status export_rights_make(const struct fuzz_trial *trial, const struct model *model,
                               const struct ray *ray, uint32_t ray_count, struct export_right **out,
                               size_t *count, struct reason *reason)
{
    struct export_case the = {
        .trial = trial, .model = *model, .ray_count = ray_count, .reason = reason};
    *out = NULL;
    *count = 0;
    the.ray = alloc_copy(ray, ray_count, sizeof *ray);
    enum status status = the.ray ? find(&the) : fail(reason, STATUS_MEMORY, "no memory for rays");
    free(the.ray);
    free(the.truth);
    oracle_free(the.oracle);
    if (status) {
        free(the.right);
        return status;
    }
    *out = the.right;
    *count = the.right_count;
    return STATUS_OK;
}
