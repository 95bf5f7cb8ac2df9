/* The table of raydiff leaks --wide: every counter, whatever the width of the screen. */
#include "cmd/leaks/cmd_leaks.h"

#include "ref/store.h"

#include <stdio.h>

/* Prints the rate per million of `rays`. For 0 events prints "<3 / N", which the true rate exceeds
 * in 5 of 100 such results. */
static void print_rate(size_t count, size_t rays)
{
    char text[32];
    double million = 1e6 / (double)(rays ? rays : 1);
    if (count == 0)
        snprintf(text, sizeof text, "<%.3g", 3 * million);
    else
        snprintf(text, sizeof text, "%.1f", (double)count * million);
    printf(" %9s", text);
}

static void print_aims(const struct leaks *leaks, size_t offset)
{
    for (enum leak_aim aim = 0; aim < LEAK_AIMS; aim++)
        printf(" %8zu", *(const size_t *)((const char *)&leaks->tally[aim] + offset));
}

static void print_row(const struct leak_row *row)
{
    char text[STORED_NAME_MOST];
    printf("%-13s %-13s %-10s %-7s", stored_name(row->layout, row->store, text),
           row->engine ? row->engine->name : "-",
           row->engine && !row->engine->needs_packed ? "-" : row->box->name, leak_row_tri(row));
    if (row->status) {
        printf(" %s: %s\n", leak_row_ended(row), row->reason.text);
        return;
    }
    struct leak_tally sum = leaks_total(&row->leaks);
    print_rate(sum.misses, sum.rays);
    print_aims(&row->leaks, offsetof(struct leak_tally, misses));
    if (row->leaks.lists) {
        print_rate(sum.doubles, sum.rays);
        print_aims(&row->leaks, offsetof(struct leak_tally, doubles));
        printf(" %8zu %6zu %7zu %6zu", sum.even, sum.lost, sum.phantoms, sum.repeated);
    } else {
        for (int i = 0; i < 9; i++)
            printf(" %*s", (const int[]){9, 8, 8, 8, 8, 8, 6, 7, 6}[i], "-");
    }
    if (row->compared)
        printf(" %7zu", row->bit_differences);
    else
        printf(" %7s", "-");
    printf(" %s%s\n",
           row->broken[0]  ? "BROKEN: "
           : row->promises ? "kept"
                           : "counted",
           row->broken);
}

void leaks_print_wide(const struct leak_scene *scene)
{
    printf("%-41s %-45s %s\n", "", "misses: per million, of rays aimed at a",
           "double hits: likewise");
    printf("%-13s %-13s %-10s %-7s", "layout", "engine", "box", "tri");
    for (int i = 0; i < 2; i++)
        printf(" %9s %8s %8s %8s %8s", "per 10^6", "vertex", "midpoint", "edge", "beside");
    printf(" %8s %6s %7s %6s %7s %s\n", "even", "lost", "phantom", "repeat", "bits", "word");
    for (size_t i = 0; i < scene->row_count; i++)
        print_row(&scene->row[i]);
}
