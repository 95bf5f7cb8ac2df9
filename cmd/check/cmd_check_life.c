/* The report of raydiff check --steps on trees and engines. */
#include "cmd/check/cmd_check.h"

#include "ref/base/text.h"
#include "ref/store.h"

#include <string.h>

#define NAMES_MOST 2000u /* bytes of a line of names */

const char *check_fate_name(enum life_fate fate)
{
    static const char *const name[] = {"built", "refitted", "rebuilt", "forced"};
    return name[fate];
}

/* Adds a name, unless the text has it. */
static void add_name(char text[NAMES_MOST], const char *name)
{
    size_t length = strlen(name);
    for (const char *at = text; (at = strstr(at, name)) != NULL; at += length)
        if ((at == text || at[-1] == ' ') && (at[length] == ',' || !at[length]))
            return;
    text_append(text, NAMES_MOST, "%s%s", text[0] ? ", " : "", name);
}

static void print_trees(const struct check_scene *scene, const struct screen *screen)
{
    static const char *const said[] = {
        NULL, "refitted", "built again",
        "built again: a refit cannot be stored or is not made (docs/layouts.md)"};
    for (enum life_fate fate = LIFE_REFITTED; fate <= LIFE_FORCED; fate++) {
        char names[NAMES_MOST] = "", name[STORED_NAME_MOST];
        for (size_t i = 0; i < scene->row_count; i++) {
            const struct row *row = &scene->row[i];
            if (row->layout && row->status != ROW_REFUSED && row->life.fate == fate)
                add_name(names, stored_name(row->layout, row->options.store, name));
        }
        if (names[0])
            screen_text(screen, "  trees %s: %s\n", said[fate], names);
    }
}

static void print_engines(const struct check_scene *scene, const struct screen *screen)
{
    for (int updated = 1; updated >= 0; updated--) {
        char names[NAMES_MOST] = "";
        for (size_t i = 0; i < scene->row_count; i++)
            if (scene->row[i].status == ROW_OK && scene->row[i].life.updated == updated)
                add_name(names, scene->row[i].engine->name);
        if (names[0])
            screen_text(screen, "  engines %s: %s\n",
                        updated ? "that updated what they held" : "prepared anew", names);
    }
}

/* Engines with WRONG answers, beside themselves without the steps. */
static void print_again(const struct check_scene *scene, const struct screen *screen)
{
    for (size_t i = 0; i < scene->row_count; i++) {
        const struct row *row = &scene->row[i];
        if (!row->life.again)
            continue;
        screen_text(screen, "  prepared anew: %s%s%s: %zu WRONG in place of %zu%s\n",
                    row->engine->name, row->layout ? " " : "", row->layout ? row->layout->name : "",
                    row->life.wrong_again, row->count[VERDICT_WRONG],
                    row->life.wrong_again ? "" : ": its update kept something of before (stale)");
    }
}

void check_print_life(const struct check_scene *scene, const struct screen *screen)
{
    if (scene->step == 0)
        return;
    print_trees(scene, screen);
    print_engines(scene, screen);
    print_again(scene, screen);
}
