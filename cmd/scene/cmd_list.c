/* raydiff list: every member of every table. */
#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"
#include "ref/base/command.h"

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

static void print_help(void)
{
    fputs(help, stdout);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    (void)user;
    (void)option;
    return fail(reason, STATUS_INPUT, "'%s' is not expected", text);
}

int cmd_list(int argc, char **argv)
{
    static const struct option long_options[] = {{"help", 0, NULL, OPT_HELP}, {NULL, 0, NULL, 0}};
    int first, code = options_take("list", print_help, long_options, take_option, NULL, argc, argv,
                                   &first);
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
