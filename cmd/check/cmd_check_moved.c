/* The report of raydiff check --move on refitted trees. */
#include "cmd/check/cmd_check.h"

#include "ref/store.h"

#include <stdio.h>

static bool same_tree(const struct row *a, const struct row *b)
{
    return a->options.builder == b->options.builder && a->options.tri == b->options.tri;
}

static bool same_packed(const struct row *a, const struct row *b)
{
    return a->layout == b->layout && a->options.store == b->options.store && same_tree(a, b);
}

static bool is_refitted(const struct row *row)
{
    return row->layout && row->status != ROW_REFUSED && row->refit.refit_ns > 0;
}

static void print_cost(const struct check_scene *scene, const struct row *row,
                       const struct screen *screen)
{
    const struct match_refit *r = &row->refit;
    double count = scene->tri_count ? scene->tri_count : 1;
    const struct tri_store *store = row->options.store;
    bool stored = store && store != tri_stores[0];
    const char *name = row->layout->name, *slash = stored ? "/" : "";
    const char *stored_as = stored ? store->name : "";
    if (r->build_ns == 0)
        screen_text(screen, "  %s%s%s: refitted in %.1f ns a triangle; packed in %.1f\n", name,
                    slash, stored_as, (double)r->refit_ns / count, (double)r->pack_ns / count);
    else
        screen_text(screen,
                    "  %s%s%s: refitted in %.1f ns a triangle; built in %.1f and packed in %.1f: "
                    "%.1f times as long\n",
                    name, slash, stored_as, (double)r->refit_ns / count,
                    (double)r->build_ns / count, (double)r->pack_ns / count,
                    (double)(r->build_ns + r->pack_ns) / (double)r->refit_ns);
}

void check_print_moved(const struct check_scene *scene, const struct screen *screen)
{
    const struct row *tree = NULL, *packed = NULL;
    for (size_t i = 0; i < scene->row_count && scene->move > 0; i++) {
        const struct row *row = &scene->row[i];
        if (!is_refitted(row))
            continue;
        if (row->refit.sah_after > 0 && (!tree || !same_tree(tree, row)))
            screen_text(
                screen,
                "  vertices moved by up to %g extents: SAH cost of the tree of %s %.1f before, "
                "%.1f refitted\n",
                scene->move, row->options.builder->name, row->refit.sah_before,
                row->refit.sah_after);
        tree = row;
        if (!packed || !same_packed(packed, row))
            print_cost(scene, row, screen);
        packed = row;
    }
}
