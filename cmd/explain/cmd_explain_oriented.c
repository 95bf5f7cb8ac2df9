#include "cmd/explain/cmd_explain_oriented.h"

#include "cmd/common/cmd_json.h"
#include "cmd/explain/cmd_explain_inner.h"
#include "ref/base/json_record.h"
#include "ref/base/ray_text.h"

static const char *const sides[] = {"0 lo", "0 hi", "1 lo", "1 hi", "2 lo", "2 hi"};

/* The text of an axis, such as "(2,-1,2)". */
struct axis_name {
    char text[48];
};

static struct axis_name axis_name(const float axis[3])
{
    struct axis_name name;
    snprintf(name.text, sizeof name.text, "(%g,%g,%g)", (double)axis[0], (double)axis[1],
             (double)axis[2]);
    return name;
}

static const struct explain_bound *bound_of(const struct explain_oriented *oriented, uint32_t i)
{
    return i % 2 ? &oriented->hi[i / 2] : &oriented->lo[i / 2];
}

static void print_bound(FILE *out, const char *name, const struct explain_bound *bound, double step,
                        bool wide)
{
    char exact[32], decoded[32];
    const int width = wide ? 24 : 18;
    const double off =
        bound->float_steps == 0 ? 0 : ((double)bound->decoded - (double)bound->exact) / step;
    float_text_write(bound->exact, exact);
    float_text_write(bound->decoded, decoded);
    fprintf(out, "  %-5s %*s %*s %12.4g %12lld\n", name, width, exact, width, decoded,
            name[2] == 'h' ? off
            : off == 0     ? 0
                           : -off,
            (long long)bound->float_steps);
    fprintf(out, "  %-5s %*.9g %*.9g", "", width, (double)bound->exact, width,
            (double)bound->decoded);
    fprintf(out, bound->fault == BOUND_OK ? "\n" : "  %s\n", explain_fault_text(bound->fault));
}

void explain_oriented_print(FILE *out, const struct explain_oriented *oriented, bool wide)
{
    const struct oblique_box *box = &oriented->box;
    const int width = wide ? 24 : 18;
    uint32_t last = 0, first = 0;
    if (!oriented->there)
        return;
    fprintf(out, "oriented box along axes %s %s %s\n", axis_name(box->axis[0]).text,
            axis_name(box->axis[1]).text, axis_name(box->axis[2]).text);
    fprintf(out, "  %-5s %*s %*s %12s %12s\n", "bound", width, "of its triangles", width,
            "in the bytes", "planes", "float32");
    for (uint32_t i = 0; i < 6; i++)
        print_bound(out, sides[i], bound_of(oriented, i), (double)box->step[i / 2], wide);
    fputs("  (the last two: steps outward from the triangles' bound to the bytes')\n", out);
    fprintf(out, "  %-4s %24s %24s\n  %-4s %24s %24s\n", "slab", "enter, padded", "leave, padded",
            "", "enter exactly", "leave exactly");
    for (uint32_t j = 0; j < 3; j++) {
        fprintf(out, "  %-4u %24.9g %24.9g\n  %-4s %24.17g %24.17g\n", j, (double)box->enter[j],
                (double)box->leave[j], "", oriented->exact_enter[j], oriented->exact_leave[j]);
        last = box->enter[j] > box->enter[last] ? j : last;
        first = box->leave[j] < box->leave[first] ? j : first;
    }
    fprintf(out, "  oriented box test: enters axis %u at %.9g, leaves axis %u at %.9g, %s\n", last,
            (double)box->enter[last], first, (double)box->leave[first],
            oriented->missed ? "no hit" : "hit");
}

static json_t *bound_json(const struct explain_bound *bound)
{
    static const char *const faults[] = {"ok", "overflow", "flushed", "rounded", "stored", "cut"};
    return json_record("exact=%p decoded=%p float32_steps=%zu fault=%s", json_float(bound->exact),
                       json_float(bound->decoded), bound->float_steps, faults[bound->fault]);
}

json_t *explain_oriented_json(const struct explain_oriented *oriented)
{
    const struct oblique_box *box = &oriented->box;
    json_t *axes = json_array();
    if (!oriented->there) {
        json_decref(axes);
        return json_null();
    }
    for (uint32_t j = 0; j < 3; j++)
        json_array_append_new(
            axes, json_record("axis=%s step=%p lo=%p hi=%p enter=%p leave=%p exact_enter=%g "
                              "exact_leave=%g",
                              axis_name(box->axis[j]).text, json_float(box->step[j]),
                              bound_json(&oriented->lo[j]), bound_json(&oriented->hi[j]),
                              json_float(box->enter[j]), json_float(box->leave[j]),
                              oriented->exact_enter[j], oriented->exact_leave[j]));
    return json_record("hit=%i axes=%p", !oriented->missed, axes);
}

void explain_oriented_html(struct html *html, const struct explain_oriented *oriented)
{
    const struct oblique_box *box = &oriented->box;
    if (!oriented->there)
        return;
    html_element_format(html, "h2", NULL, "Oriented box along %s %s %s",
                        axis_name(box->axis[0]).text, axis_name(box->axis[1]).text,
                        axis_name(box->axis[2]).text);
    html_table(html, NULL, NULL);
    html_heads(html, "bound;#of its triangles;#in the bytes;#float32 steps;#enter;#leave;");
    html_body(html);
    for (uint32_t i = 0; i < 6; i++) {
        const struct explain_bound *bound = bound_of(oriented, i);
        html_begin(html, "tr", "class", bound->fault == BOUND_OK ? NULL : "fault", NULL);
        html_element(html, "td", NULL, sides[i]);
        html_element_format(html, "td", "n", "%.9g", (double)bound->exact);
        html_element_format(html, "td", "n", "%.9g", (double)bound->decoded);
        html_element_format(html, "td", "n", "%lld", (long long)bound->float_steps);
        html_element_format(html, "td", "n", "%.9g", (double)box->enter[i / 2]);
        html_element_format(html, "td", "n", "%.9g", (double)box->leave[i / 2]);
        html_element(html, "td", bound->fault == BOUND_OK ? NULL : "bad",
                     explain_fault_text(bound->fault));
        html_end(html, "tr");
    }
    html_table_end(html);
    html_element_format(html, "p", "dim", "The test of the oriented box: %s.",
                        oriented->missed ? "no hit" : "hit");
}
