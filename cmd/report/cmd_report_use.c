/* Decides which of the options of raydiff report its parts use. */
#include "cmd/report/cmd_report_parts.h"

#include "cmd/bench/cmd_bench.h"
#include "cmd/common/cmd_use.h"

#include <string.h>

/* The members and options that a part uses. */
struct part_use {
    struct option_use use;
    struct list engine, layout, rays;
};

static const char *value_of(const struct line *line, const char *flag)
{
    for (int i = 0; i + 1 < line->argc; i++)
        if (strcmp(line->argv[i], flag) == 0)
            return line->argv[i + 1];
    return NULL;
}

/* The members in `named`, else in `or_else`, else the whole table. The text was parsed before; text
 * that cannot be parsed gives an empty list. */
static struct list list_of(enum table table, const char *named, const char *or_else)
{
    struct list list = {.count = 0};
    const char *text = named ? named : or_else;
    if (text && table_parse(table, "", text, &list, NULL))
        list.count = 0;
    return text ? list : table_all(table);
}

static void use_of_line(const struct line *line, const struct report_options *options, unsigned to,
                        struct part_use *out)
{
    const char *command = line->argv[0], *named = value_of(line, "--engine");
    const bool picture = strcmp(command, "render") == 0 || strcmp(command, "diff") == 0;
    const bool bench = strcmp(command, "bench") == 0;
    const char *layout = value_of(line, "--layout");
    named = named ? named : report_passed(options, to, "--engine");
    layout = layout ? layout : report_passed(options, to, "--layout");
    out->engine = list_of(TABLE_ENGINES, named, picture ? "cpu" : NULL);
    out->layout = list_of(TABLE_LAYOUTS, layout, NULL);
    out->rays = list_of(TABLE_RAY_SETS, report_passed(options, to, "--rays"), "mixed");
    out->use = (struct option_use){.engine = &out->engine,
                                   .layout = &out->layout,
                                   .rays = picture ? NULL : &out->rays,
                                   .scene = options->scene,
                                   .scene_count = options->scene_count,
                                   .seeded = bench};
    if (strcmp(command, "doctor") == 0)
        out->use.never = "peer-time peer-memory shader";
    if (bench)
        out->use.only =
            strcmp(line->argv[1], "error") == 0 ? bench_error.takes : bench_layouts.takes;
}

bool report_line_uses(const struct line *line, const struct report_options *options, unsigned to,
                      const char *flag)
{
    struct part_use part;
    struct reason why;
    use_of_line(line, options, to, &part);
    return option_is_used(&part.use, flag + strlen("--"), &why);
}

int report_check_use(const struct report_options *options)
{
    static const char machine[] = " threads driver device workgroup peer-time peer-memory shader";
    const bool plays = options->scene_count > 0, *wanted = options->wanted;
    char only[4000] = "out title time json parts check bench benchmark picture doctor findings";
    const struct list engine =
        list_of(TABLE_ENGINES, report_passed(options, TO_ALL, "--engine"), NULL);
    const struct list layout =
        list_of(TABLE_LAYOUTS, report_passed(options, TO_ALL, "--layout"), NULL);
    const struct option_use of_engines = {.engine = &engine, .layout = &layout};
    const struct {
        bool is_there;
        const char *options;
    } parts[] = {
        {plays && wanted[REPORT_CHECK], " quick count query layout engine tri box rays seed"},
        {plays && wanted[REPORT_BENCH], " quick count rounds layout engine tri box rays seed"},
        {plays && wanted[REPORT_PICTURES], " quick layout engine tri box seed"},
        {plays && (wanted[REPORT_CHECK] || wanted[REPORT_BENCH] || wanted[REPORT_PICTURES]),
         machine},
        {!options->doctor && wanted[REPORT_MACHINE], " threads driver device workgroup"},
        {options->findings_count > 0, " baseline web"},
        {options->findings_count > 0, machine},
    };
    for (size_t i = 0; options->findings_count && i < engine.count;
         i++) /* replay gets peers from here */
        if (engine_is_peer(engines[engine.index[i]]))
            strcat(only, " engine");
    for (size_t i = 0; options->findings_count && i < layout.count; i++)
        if (layouts_all[layout.index[i]]->outside)
            strcat(only, " layout");
    for (size_t i = 0; i < ARRAY_COUNT(parts); i++)
        if (parts[i].is_there)
            strncat(only, parts[i].options, sizeof only - strlen(only) - 1);
    const struct option_use of_parts = {.by = "the parts of this report", .only = only};
    int code = options_refused("report", &of_parts);
    return code < 0 && plays && !options->findings_count ? options_refused("report", &of_engines)
                                                         : code;
}
