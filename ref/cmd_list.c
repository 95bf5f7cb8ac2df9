/* raydiff list: every member of every table. */
#include "ref/cmd_tables.h"
#include "ref/command.h"

#include <string.h>

static const char help[] =
    "usage: raydiff list [KIND]\n"
    "Lists what can be named on the command line: builders, layouts, box tests, triangle tests,\n"
    "queries, engines, scenes (generators), ray sets and storages (of triangles), each with what "
    "it\n"
    "is.\n"
    "  KIND   only one of them, by a word of its title: builders, layouts, box, triangle, "
    "queries,\n"
    "         engines, scenes, ray, storages\n"
    "example: raydiff list layouts\n"
    "exit codes: 0, 2 unknown kind\n";

static void print_table(enum table table)
{
    const char *name, *summary;
    printf("%s\n", table_name(table));
    for (size_t i = 0; (name = table_member(table, i, &summary)); i++)
        printf("  %-14s %s\n", name, summary);
}

static int unknown(const char *kind)
{
    char known[200] = "";
    size_t used = 0;
    for (enum table table = 0; table < TABLE_COUNT && used < sizeof known; table++)
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", table ? ", " : "",
                                 table_name(table));
    return usage_error("list", "unknown kind '%.60s'; kinds are: %s", kind, known);
}

int cmd_list(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        fputs(help, stdout);
        return EXIT_AGREE;
    }
    if (argc > 2)
        return usage_error("list", "one kind at a time");
    size_t shown = 0;
    for (enum table table = 0; table < TABLE_COUNT; table++) {
        size_t length = argc > 1 ? strlen(argv[1]) : 0;
        if (length > 0 && strncmp(table_name(table), argv[1], length) != 0)
            continue;
        print_table(table);
        shown++;
    }
    if (shown == 0)
        return unknown(argv[1]);
    return EXIT_AGREE;
}
