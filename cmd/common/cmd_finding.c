#include "cmd/common/cmd_finding.h"

#include "cmd/common/cmd_outside.h"

#include "ref/outside/recorded.h"
#include "ref/store.h"

#include <math.h>
#include <stdio.h>

/* How far before the faulty hit of a list the explained ray begins, relative to that hit's t: so
 * far that the range's end excuses nothing. */
#define BEFORE 0x1p-11f

/* Before both the hit that was answered and what is right in its place. */
static void start_before(const struct finding *finding, struct ray *ray)
{
    float t = finding->got.prim == ABI_NO_PRIM ? INFINITY : finding->got.t;
    if (finding->bits)
        t = fminf(t, finding->expected.prim == ABI_NO_PRIM ? INFINITY : finding->expected.t);
    else if (finding->judgement.expected != ABI_NO_PRIM)
        t = fminf(t, (float)finding->judgement.t_lo);
    t -= BEFORE * fabsf(t);
    if (t > ray->tmin && t < ray->tmax)
        ray->tmin = t;
}

/* The command of a list: of the list itself, or of the hit at fault. */
static void command_of_list(const struct finding *finding, struct explain_of *of, bool own,
                            char text[EXPLAIN_COMMAND_MOST])
{
    const enum wrong kind = finding->bits ? WRONG_NOT : finding->judgement.wrong;
    struct ray ray = finding->ray;
    if (!own && kind != WRONG_TWICE && kind != WRONG_ORDER) {
        of->query = QUERY_CLOSEST;
        start_before(finding, &ray);
    }
    explain_command(of, &ray, text);
}

bool finding_command(const struct row *row, const struct finding *finding,
                     const struct finding_of *from, char text[EXPLAIN_COMMAND_MOST])
{
    struct explain_of of = explain_of_row(row, from->spec, from->seed, from->driver);
    const bool own = outside_is_engine(row->engine->name) && !row->engine->needs_packed;
    char name[RECORDED_NAME_MOST];
    struct engine answered = *row->engine;
    text[0] = '\0';
    /* One run cannot explain answers that vary. */
    if (!finding->bits && finding->judgement.wrong == WRONG_NOT_REPEATABLE)
        return false;
    if (row->options.rest || row->options.life || row->of_world) /* explain has none of these */
        return false;
    if (row->options.store && row->options.store->head)
        return false;            /* no file has the decoded scene */
    if (row->engine->recorded) { /* cannot trace again: the name holds the answer */
        recorded_name(row->engine->name, &finding->got, name);
        answered.name = name;
        of.engine = &answered;
    }
    if (of.query == QUERY_ALL)
        command_of_list(finding, &of, own, text);
    else if (own && from->set.rays)
        explain_command_among(&of, &from->set, finding->ray_index, text);
    else
        explain_command(&of, &finding->ray, text);
    return true;
}

void finding_line(const struct finding *finding, char *line, size_t line_bytes)
{
    if (finding->bits)
        judge_bits_line(&finding->ray, &finding->expected, &finding->got, line, line_bytes);
    else
        judge_line(&finding->ray, &finding->judgement, &finding->got, line, line_bytes);
}

static void print_place(const char *what, uint32_t prim, const struct place *place)
{
    if (prim == ABI_NO_PRIM)
        printf("  %s nothing", what);
    else
        printf("  %s instance %u geometry %u triangle %u", what, place->instance, place->geometry,
               place->tri);
}

static void print_tag(uint32_t prim, uint32_t tag)
{
    if (prim != ABI_NO_PRIM || tag != 0)
        printf(" custom %u %s", tag & ABI_TAG_CUSTOM, tag & ABI_TAG_FRONT ? "front" : "back");
}

/* Lines of their own, which fit a terminal: what the ray may meet, and where the triangles are. */
static void print_world(const struct row *row, const struct finding *finding)
{
    const struct world_finding *w = &finding->world;
    char against[320];
    printf("  world: mask 0x%02X flags 0x%X\n", w->mode.mask, w->mode.flags);
    print_place("got:", finding->got.prim, &w->got);
    print_tag(finding->got.prim, w->tag);
    putchar('\n');
    if (finding->bits) {
        snprintf(against, sizeof against, "%s's:", row->against->name);
        print_place(against, finding->expected.prim, &w->expected);
        print_tag(finding->expected.prim, w->expected_tag);
    } else {
        print_place("expected:", finding->judgement.expected, &w->expected);
    }
    putchar('\n');
}

void finding_print(const struct screen *screen, const struct row *row,
                   const struct finding *finding, const struct finding_of *of, bool first)
{
    char line[512], command[EXPLAIN_COMMAND_MOST], kind[320];
    if (finding->bits)
        snprintf(kind, sizeof kind, "differ from engine %s's:", row->against->name);
    else
        snprintf(kind, sizeof kind, "%s", wrong_name(finding->judgement.wrong));
    finding_line(finding, line, sizeof line);
    screen_record(screen, PAINT_BAD, "%s %s %s.%s.%s.%s ray %zu %s\n",
                  finding->bits ? "BITS" : "WRONG", kind, query_name(row->options.query),
                  row->engine->name, row->layout ? row->layout->name : "-", row_tri_name(row),
                  finding->ray_index, line);
    if (finding->world.is)
        print_world(row, finding);
    if ((first || !screen->terminal || screen->wide) && finding_command(row, finding, of, command))
        printf("  explain: %s\n", command);
}
