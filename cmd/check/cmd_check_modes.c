/* The report of raydiff check on modes of a library, beside its engine of the same formula. */
#include "cmd/check/cmd_check.h"

void check_print_modes(const struct check_scene *scene, const struct screen *screen)
{
    for (size_t e = 0; engines[e]; e++) {
        struct row sum = {.engine = NULL};
        for (size_t i = 0; i < scene->row_count; i++) {
            const struct row *row = &scene->row[i];
            if (row->status != ROW_OK || !row->engine->plain || row->against != engines[e])
                continue;
            sum.engine = engines[e];
            sum.rays += row->rays;
            sum.moved += row->moved;
            sum.beside.both += row->beside.both;
            sum.beside.own += row->beside.own;
            sum.beside.plain += row->beside.plain;
            sum.beside.neither += row->beside.neither;
        }
        if (sum.engine)
            screen_text(screen,
                        "  bits of modes beside %s: %zu of %zu answers differ; right are both in "
                        "%zu, the mode alone in %zu, %s alone in %zu, neither in %zu\n",
                        sum.engine->name, sum.moved, sum.rays, sum.beside.both, sum.beside.own,
                        sum.engine->name, sum.beside.plain, sum.beside.neither);
    }
}
