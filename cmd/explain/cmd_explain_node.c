/* The node where a traversal ended, as text: words, bounds, slabs. */
#include "cmd/explain/cmd_explain_inner.h"
#include "cmd/explain/cmd_explain_oriented.h"

#include "ref/base/ray_text.h"

#include <stdio.h>

/* In 80 columns the fault stands below the steps. */
static void print_bound(FILE *out, const char *name, const struct explain_bound *bound, bool wide)
{
    char exact[32], canonical[32], decoded[32];
    const int width = wide ? 18 : 16;
    const char *fault = explain_fault_text(bound->fault);
    float_text_write(bound->exact, exact);
    float_text_write(bound->canonical, canonical);
    float_text_write(bound->decoded, decoded);
    fprintf(out, "  %-*s %*s %*s %*s %*.4g %*lld", wide ? 5 : 4, name, width, exact, width,
            canonical, width, decoded, wide ? 12 : 10, bound->half_steps, wide ? 12 : 11,
            (long long)bound->float_steps);
    fprintf(out, wide ? "  %s\n" : "\n", fault);
    fprintf(out, "  %-*s %*.9g %*.9g %*.9g", wide ? 5 : 4, "", width, (double)bound->exact, width,
            (double)bound->canonical, width, (double)bound->decoded);
    fprintf(out, wide || !fault[0] ? "\n" : "  %s\n", fault);
}

/* In 80 columns the exact ends stand below the computed ones. */
static void print_slab(FILE *out, char axis, const struct slab_axis *slab, bool wide)
{
    if (wide)
        fprintf(out, "  %-5c %18.9g %18.9g %24.17g %24.17g\n", axis, (double)slab->enter,
                (double)slab->leave, slab->exact_enter, slab->exact_leave);
    else
        fprintf(out, "  %-4c %24.9g %24.9g\n  %-4s %24.17g %24.17g\n", axis, (double)slab->enter,
                (double)slab->leave, "", slab->exact_enter, slab->exact_leave);
}

void explain_node_print(FILE *out, const struct explain_step *step, bool wide)
{
    static const char *const names[] = {"x lo", "x hi", "y lo", "y hi", "z lo", "z hi"};
    const int width = wide ? 18 : 16;
    fprintf(out, "node %u, record %u, words", step->note.node, step->record);
    for (uint32_t i = 0; i < step->word_count; i++)
        fprintf(out, " %08x", step->word[i]);
    fprintf(out, "\n  %-*s %*s %*s %*s %*s %*s\n", wide ? 5 : 4, wide ? "bound" : "side", width,
            "of its triangles", width, "of the tree", width, "in the bytes", wide ? 12 : 10,
            "float16", wide ? 12 : 11, "float32");
    for (int k = 0; k < 3; k++) {
        print_bound(out, names[2 * k], &step->lo[k], wide);
        print_bound(out, names[2 * k + 1], &step->hi[k], wide);
    }
    fputs("  (the last two: steps outward from the triangles' bound to the bytes')\n", out);
    if (wide)
        fprintf(out, "  %-5s %18s %18s %24s %24s\n", "slab", "enter", "leave, padded",
                "enter exactly", "leave exactly");
    else
        fprintf(out, "  %-4s %24s %24s\n  %-4s %24s %24s\n", "slab", "enter", "leave, padded", "",
                "enter exactly", "leave exactly");
    for (int k = 0; k < 3; k++)
        print_slab(out, "xyz"[k], &step -> slab[k], wide);
    if (step->note.tested)
        fprintf(out, "  box test: entry %.9g, best t so far %.9g, %s\n", (double)step->note.entry,
                (double)step->note.tbest, step->note.hit ? "hit" : "no hit");
    explain_oriented_print(out, &step->oriented, wide);
}
