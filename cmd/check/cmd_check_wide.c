/* The table of raydiff check --wide: every counter, whatever the width of the screen. */
#include "cmd/check/cmd_check.h"

#include "ref/store.h"

static void print_bytes(const struct row *row)
{
    if (row_bytes_known(row))
        printf("%9.1f", (double)row->node_bytes / 1e3);
    else
        printf("%9s", "-");
    if (row->layout || (row->engine && row->engine->own_tree))
        printf(" %9.1f", (double)row->item_bytes / 1e3);
    else
        printf(" %9s", "-");
}

static void print_wide_row(const struct row *row)
{
    const struct match_options *o = &row->options;
    char text[STORED_NAME_MOST];
    printf("%-13s %-13s %-7s %-7s %-7s ", stored_name(row->layout, row->options.store, text),
           row->engine ? row->engine->name : "-", row_box_name(row), row_tri_name(row),
           query_name(o->query));
    if (row->status == ROW_REFUSED || row->status == ROW_SKIPPED || row->status == ROW_FAILED) {
        printf("%s: %s\n", row_status_name(row->status), row->reason.text);
        return;
    }
    print_bytes(row);
    printf(" %7zu", row->hits);
    for (enum verdict v = VERDICT_TIE; v < VERDICT_WRONG; v++)
        printf(" %5zu", row->count[v]);
    if (row->displacement.count)
        printf(" %5s", "-");
    else
        printf(" %5.2f", row->worst_over);
    if (row->judged)
        printf(" %6zu", row->count[VERDICT_WRONG]);
    else
        printf(" %6s", "count");
    printf(" %6zu", row->bit_differences);
    printf(" %8.3f (%.3f-%.3f)", row->mrays[0], row->mrays[1], row->mrays[2]);
    char note[CHECK_NOTE_MOST];
    check_row_note(row, note);
    fputs(note, stdout);
    putchar('\n');
}

void check_print_wide(const struct check_scene *scene)
{
    printf("%-13s %-13s %-7s %-7s %-7s %9s %9s %7s %5s %5s %5s %5s %5s %5s %5s %5s %5s %6s %6s "
           "%8s\n",
           "layout", "engine", "box", "tri", "query", "nodes kB", "items kB", "hits", "tie", "near",
           "bound", "bordr", "plane", "slab", "noise", "out", "err/E", "WRONG", "bits",
           "Mray/s (least-most)");
    for (size_t i = 0; i < scene->row_count; i++)
        print_wide_row(&scene->row[i]);
}
