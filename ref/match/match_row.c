/* Names of a row of a match, and whether it fails. */
#include "ref/match/match.h"

const char *row_status_name(enum row_status status)
{
    static const char *const names[] = {"ok", "refused", "skipped", "failed", "vacuous"};
    return (size_t)status < ARRAY_COUNT(names) ? names[status] : "unknown";
}

const char *row_box_name(const struct row *row)
{
    if (row->engine && row->engine->own_tree)
        return "own";
    return row->layout ? row->options.box->name : "-";
}

const char *row_formula_name(enum twin_formula formula)
{
    for (size_t t = 0; tri_tests[t] && twin_is_own(formula); t++)
        if (twin_of_tri(tri_tests[t]->id) == formula)
            return tri_tests[t]->name;
    return NULL;
}

const char *row_tri_name(const struct row *row)
{
    if (row->engine && row->engine->tri_name)
        return row->engine->tri_name;
    if (row->engine && row->engine->own_tri)
        return row->formula ? row->formula : "own";
    return row->options.tri->name;
}

bool row_failed(const struct row *row)
{
    return row->status == ROW_VACUOUS || (row->status == ROW_OK && row->differences > 0);
}
