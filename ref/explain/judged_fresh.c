#include "ref/explain/judged.h"

/* Explains with an engine that is opened and prepared. */
static enum status ask(const struct judged_job *from, const struct ray *ray, bool *right,
                       struct reason *reason)
{
    struct judged fresh;
    struct judged_ray answer;
    enum status status = judged_make(from, &fresh, reason);
    if (status)
        return status;
    status = judged_explain(&fresh, ray, &answer, reason);
    if (!status) {
        *right = answer.answer.finished && answer.why.cause == CAUSE_NONE;
        explain_free(&answer.why);
    }
    judged_free(&fresh);
    return status;
}

enum status judged_fresh(const struct judged *judged, const struct engine_options *options,
                         const struct ray *ray, bool *right, struct reason *reason)
{
    struct judged_job from = judged->from;
    struct reason why = {""};
    *right = false;
    from.self = NULL;
    enum status status = engine_open(from.engine, options, &from.self, &why);
    if (!status)
        status = from.engine->prepare(from.self, from.job, &why);
    if (status == STATUS_OK)
        status = ask(&from, ray, right, reason);
    else
        status = status == STATUS_MEMORY ? fail(reason, status, "%s", why.text) : STATUS_OK;
    if (from.self && from.engine->close)
        from.engine->close(from.self);
    return status;
}

enum status judged_stale(const struct judged *judged, const struct engine_options *options,
                         struct judged_ray *ray, struct reason *reason)
{
    bool right;
    if (ray->why.cause == CAUSE_NONE || ray->why.cause == CAUSE_NOT_REPEATABLE)
        return STATUS_OK;
    enum status status = judged_fresh(judged, options, &ray->ray, &right, reason);
    if (!status && right)
        ray->why.cause = CAUSE_STALE;
    return status;
}
