#include "cmd/common/cmd_finding.h"

#include "ref/outside/recorded.h"
#include "ref/store.h"

#include <stdio.h>

/* How far before the faulty hit of a list the explained ray begins, relative to that hit's t. */
#define BEFORE 0x1p-18f

static void start_before(const struct finding *finding, struct ray *ray)
{
    bool lost = finding->got.prim == ABI_NO_PRIM;
    float t = finding->got.t;
    if (lost)
        t = finding->bits ? finding->expected.t : (float)finding->judgement.t_lo;
    t -= BEFORE * t;
    if (t > ray->tmin && t < ray->tmax)
        ray->tmin = t;
}

bool finding_command(const struct row *row, const struct finding *finding, const char *spec,
                     uint64_t seed, const char *driver, char text[EXPLAIN_COMMAND_MOST])
{
    struct explain_of of = explain_of_row(row, spec, seed, driver);
    struct ray ray = finding->ray;
    enum wrong kind = finding->bits ? WRONG_NOT : finding->judgement.wrong;
    text[0] = '\0';
    /* One run cannot explain answers that vary, and a closest hit cannot explain a whole list. */
    if (kind == WRONG_NOT_REPEATABLE || kind == WRONG_TWICE || kind == WRONG_ORDER)
        return false;
    if (row->options.rest) /* explain cannot move the scene */
        return false;
    if (row->options.store && row->options.store->head)
        return false; /* no file has the decoded scene */
    if (of.query == QUERY_ALL) {
        of.query = QUERY_CLOSEST;
        start_before(finding, &ray);
    }
    char name[RECORDED_NAME_MOST];
    struct engine answered = *row->engine;
    if (row->engine->recorded) { /* cannot trace again: the name holds the answer */
        recorded_name(row->engine->name, &finding->got, name);
        answered.name = name;
        of.engine = &answered;
    }
    explain_command(&of, &ray, text);
    return true;
}

void finding_line(const struct finding *finding, char *line, size_t line_bytes)
{
    if (finding->bits)
        judge_bits_line(&finding->ray, &finding->expected, &finding->got, line, line_bytes);
    else
        judge_line(&finding->ray, &finding->judgement, &finding->got, line, line_bytes);
}

void finding_print(const struct screen *screen, const struct row *row,
                   const struct finding *finding, const char *spec, uint64_t seed,
                   const char *driver, bool first)
{
    char line[512], command[EXPLAIN_COMMAND_MOST];
    finding_line(finding, line, sizeof line);
    screen_record(
        screen, PAINT_BAD, "%s %s %s.%s.%s.%s ray %zu %s\n", finding->bits ? "BITS" : "WRONG",
        finding->bits ? "differ from engine cpu's:" : wrong_name(finding->judgement.wrong),
        query_name(row->options.query), row->engine->name, row->layout ? row->layout->name : "-",
        row_tri_name(row), finding->ray_index, line);
    if ((first || !screen->terminal || screen->wide) &&
        finding_command(row, finding, spec, seed, driver, command))
        printf("  explain: %s\n", command);
}
