/* raydiff list: prints every member of every table. */
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/text.h"

#include <string.h>

static const struct option_row rows[] = {{0}};

static const struct option_set set = {
    .command = "list",
    .usage = "list [KIND]",
    .about = "Lists what can be named on the command line: builders, layouts, box tests, triangle "
             "tests, queries, engines, scenes (generators), ray sets and storages (of triangles), "
             "each with what it is.\n"
             "KIND is only one of them, by a word of its title: builders, layouts, box, triangle, "
             "queries, engines, scenes, ray, storages.",
    .group = {GROUP(rows)},
    .codes = "0, 2 unknown kind",
    .example = "list layouts",
};

static void print_table(enum table table)
{
    const char *name, *summary;
    printf("%s\n", table_name(table));
    for (size_t i = 0; (name = table_member(table, i, &summary)); i++)
        screen_line(17, "  %-14s %s\n", name, summary);
}

static int unknown(const char *kind)
{
    char known[200] = "";
    for (enum table table = 0; table < TABLE_COUNT; table++)
        text_append(known, sizeof known, "%s%s", table ? ", " : "", table_name(table));
    return usage_error("list", "unknown kind '%.60s'; kinds are: %s", kind, known);
}

int cmd_list(int argc, char **argv)
{
    int first, code = options_read(&set, NULL, argc, argv, &first);
    if (code >= 0)
        return code;
    if (argc - first > 1)
        return usage_error("list", "one kind at a time");
    const char *kind = first < argc ? argv[first] : "";
    size_t shown = 0;
    for (enum table table = 0; table < TABLE_COUNT; table++) {
        if (strncmp(table_name(table), kind, strlen(kind)) != 0)
            continue;
        print_table(table);
        shown++;
    }
    return shown ? EXIT_AGREE : unknown(kind);
}
