/* The page of raydiff explain as HTML: one file that fetches nothing, with pictures that turn. */
#include "cmd/explain/cmd_explain_inner.h"

#include "bench/report/report_html.h"
#include "cmd/explain/cmd_explain_oriented.h"
#include "cmd/explain/cmd_explain_picture.h"
#include "ref/base/ray_text.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>

#define VIEW_PIXELS 460u

extern const char turn_shipped[]; /* cmd/explain/turn.js */

const char explain_html_style[] =
    ":root{color-scheme:light dark;--bg:#fff;--fg:#1c2127;--dim:#66707a;--line:#d9dfe5;"
    "--bad:#c4262e}\n"
    "@media (prefers-color-scheme:dark){:root{--bg:#14181c;--fg:#e4e8ec;--dim:#98a2ac;"
    "--line:#333b43;--bad:#ff6b6b}.other{fill:#5a646e;stroke:#5a646e}"
    ".way{fill:#98a2ac;stroke:#98a2ac}"
    ".exact{fill:#5fd38d;stroke:#5fd38d}.tree{fill:#7db8f5;stroke:#7db8f5}"
    ".bytes{fill:#ff6b6b;stroke:#ff6b6b}.ray{stroke:#9ec5ff}.hit{fill:#9ec5ff}}\n"
    "body{margin:0 auto;max-width:1020px;padding:0 20px 60px;background:var(--bg);color:var(--fg);"
    "font:15px/1.5 system-ui,sans-serif}\n"
    "h1{font-size:24px;margin:24px 0 4px}h2{font-size:18px;margin:32px 0 8px}\n"
    "p{margin:6px 0;max-width:95ch}.bad{color:var(--bad);font-weight:700}.dim{color:var(--dim)}\n"
    "pre,code,td.bits{font:12.5px/1.5 ui-monospace,'DejaVu Sans Mono',monospace}\n"
    "pre{border:1px solid var(--line);border-radius:4px;padding:8px 10px;overflow-x:auto}\n"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:8px 0}\n"
    "th,td{border:1px solid var(--line);padding:3px 8px;text-align:left}td.n{text-align:right}\n"
    "td.bits b{color:var(--bg);background:var(--bad)}tr.fault td{font-weight:600}\n"
    ".views{display:flex;flex-wrap:wrap;gap:16px}figure{margin:0}\n"
    "figure svg{border:1px solid var(--line);border-radius:4px;max-width:100%;height:auto;"
    "touch-action:none;cursor:grab}\n"
    "svg polygon,svg polyline{vector-effect:non-scaling-stroke}\n"
    "ul.legend{list-style:none;padding:0;display:flex;flex-wrap:wrap;gap:4px 18px}\n"
    "ul.legend li{cursor:pointer}ul.legend li.off{opacity:.35}ul.legend svg{vertical-align:-3px;"
    "margin-right:5px;border:0}\n"
    ".no-other svg .other,.no-expected svg .expected,.no-answered svg .answered,.no-exact svg "
    ".exact,.no-way svg .way,"
    ".no-tree svg .tree,.no-bytes svg .bytes,.no-ray svg .ray,.no-hit svg .hit{display:none}\n"
    "ul.legend svg *{display:inline!important}\n";

/* --- numbers ---------------------------------------------------------------------------------- */

/* Writes the bits of a float as sign, exponent and mantissa; bold where `other` differs. */
static void write_bits(struct html *html, float value, float other)
{
    uint32_t bits, from;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&from, &other, sizeof from);
    html_begin(html, "td", "class", "bits", NULL);
    for (int i = 31; i >= 0; i--) {
        const char digit[2] = {bits >> i & 1u ? '1' : '0', '\0'};
        if ((bits ^ from) >> i & 1u)
            html_element(html, "b", NULL, digit);
        else
            html_text(html, digit);
        if (i == 31 || i == 23)
            html_text(html, " ");
    }
    html_end(html, "td");
}

static void write_bound(struct html *html, const char *name, const struct explain_bound *bound)
{
    html_begin(html, "tr", "class", bound->fault == BOUND_OK ? NULL : "fault", NULL);
    html_element(html, "td", NULL, name);
    html_element_format(html, "td", "n", "%.9g", (double)bound->exact);
    write_bits(html, bound->exact, bound->decoded);
    html_element_format(html, "td", "n", "%.9g", (double)bound->decoded);
    write_bits(html, bound->decoded, bound->exact);
    html_element_format(html, "td", "n", "%.4g", bound->half_steps);
    html_element_format(html, "td", "n", "%lld", (long long)bound->float_steps);
    html_element(html, "td", bound->fault == BOUND_OK ? NULL : "bad",
                 explain_fault_text(bound->fault));
    html_end(html, "tr");
}

static void write_node(struct html *html, const struct explain_step *step)
{
    static const char *const names[] = {"x lo", "x hi", "y lo", "y hi", "z lo", "z hi"};
    html_element_format(html, "h2", NULL, "Node %u, record %u", step->note.node, step->record);
    html_begin(html, "p", "class", "dim", NULL);
    html_text(html, "words ");
    html_begin(html, "code", NULL, NULL);
    for (uint32_t i = 0; i < step->word_count; i++)
        html_format(html, "%s%08x", i ? " " : "", step->word[i]);
    html_end(html, "code");
    html_end(html, "p");
    html_table(html, NULL, NULL);
    html_heads(html,
               "bound;#of its triangles;bits;#in the bytes;bits;#float16 steps;#float32 steps;");
    html_body(html);
    for (int k = 0; k < 3; k++) {
        write_bound(html, names[2 * k], &step->lo[k]);
        write_bound(html, names[2 * k + 1], &step->hi[k]);
    }
    html_table_end(html);
    html_element(html, "p", "dim",
                 "Bits: sign, exponent, mantissa of float32; those that differ are marked. Steps "
                 "count outward from the triangles' bound to the bytes'.");
}

/* --- pictures --------------------------------------------------------------------------------- */

static void write_legend(struct html *html, const struct picture_view *view, size_t count)
{
    html_begin(html, "ul", "class", "legend", NULL);
    for (enum shape_role role = 0; role < SHAPE_ROLES; role++) {
        bool shown = false;
        for (size_t i = 0; i < count; i++)
            shown = shown || view_has(&view[i], role);
        if (!shown)
            continue;
        html_begin(html, "li", "data-role", shape_role_name(role), NULL);
        html_begin(html, "svg", "width", "16", "height", "16", NULL);
        html_void(html, "rect", "class", shape_role_name(role), "x", "2", "y", "2", "width", "12",
                  "height", "12", NULL);
        html_end(html, "svg");
        html_text(html, shape_role_text(role));
        html_end(html, "li");
    }
    html_end(html, "ul");
}

static void write_view(struct html *html, const struct picture_view *view)
{
    html_begin(html, "figure", "class", "view", NULL);
    view_write_svg(html->out, view, 0, VIEW_PIXELS);
    html_begin(html, "script", "type", "application/json", NULL);
    view_write_json(html->out, view);
    html_end(html, "script");
    char left_out[64] = "";
    if (view->left_out)
        snprintf(left_out, sizeof left_out, "; %zu other triangles are left out", view->left_out);
    html_element_format(html, "figcaption", "dim", "%s: from %.9g to %.9g along x%s", view->name,
                        view->focus[0] - view->radius, view->focus[0] + view->radius, left_out);
    html_end(html, "figure");
}

static enum status write_views(struct html *html, const struct explain_page *page,
                               struct reason *reason)
{
    if (!picture_exists(page))
        return STATUS_OK;
    html_element(html, "h2", NULL, "Where it happens");
    struct picture_view view[VIEW_KINDS] = {{.name = NULL}};
    size_t count = 0;
    enum status status = STATUS_OK;
    for (int kind = picture_has_way(page) ? VIEW_WAY : VIEW_NODE; kind < VIEW_KINDS && !status;
         kind++)
        status = view_make(page, (enum view_kind)kind, &view[count++], reason);
    if (!status) {
        html_begin(html, "div", "class", "views", NULL);
        for (size_t i = 0; i < count; i++)
            write_view(html, &view[i]);
        html_end(html, "div");
        write_legend(html, view, count);
    }
    for (size_t i = 0; i < count; i++)
        view_free(&view[i]);
    if (status)
        return status;
    html_element(html, "p", "dim",
                 "Drag to turn, wheel to come closer, double click to start again; a click on the "
                 "legend hides a part.");
    return STATUS_OK;
}

/* --- page ------------------------------------------------------------------------------------- */

static void write_head(struct html *html, const struct explain_page *page)
{
    fputs("<!DOCTYPE html>\n", html->out);
    html_begin(html, "html", "lang", "en", NULL);
    html_begin(html, "head", NULL, NULL);
    html_void(html, "meta", "charset", "utf-8", NULL);
    html_void(html, "meta", "name", "viewport", "content", "width=device-width", NULL);
    html_element_format(html, "title", NULL, "raydiff explain %s", page->of->spec);
    html_begin(html, "style", NULL, NULL);
    fputs(picture_style, html->out);
    fputs(explain_html_style, html->out);
    html_end(html, "style");
    html_end(html, "head");
    html_begin(html, "body", NULL, NULL);
    explain_html_verdict(html, page);
}

void explain_html_verdict(struct html *html, const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    const char *layout = page->of->layout ? page->of->layout->name : NULL;
    html_element_format(html, "h1", NULL, "%s%s%s", page->of->engine->name, layout ? " on " : "",
                        layout ? layout : "");
    if (!ray->answer.finished)
        html_element_format(html, "p", "bad", "not finished: %s", ray->reason.text);
    else if (ray->judgement.verdict == VERDICT_WRONG)
        html_element_format(html, "p", "bad", "WRONG: %s", wrong_name(ray->judgement.wrong));
    else
        html_element_format(html, "p", explain_is_wrong(ray) ? "bad" : NULL, "%s%s%s",
                            ray->judgement.verdict == VERDICT_RIGHT ? "" : "allowed: ",
                            verdict_name(ray->judgement.verdict),
                            explain_is_wrong(ray) ? ", but not C's bits" : "");
    if (ray->why.cause != CAUSE_NONE)
        html_element_format(html, "p", NULL, "Cause: %s, %s.", cause_name(ray->why.cause),
                            cause_text(ray->why.cause));
}

/* --- facts ------------------------------------------------------------------------------------ */

static void write_hit(struct html *html, const char *what, const struct hit *hit)
{
    if (hit->prim == ABI_NO_PRIM)
        html_element_format(html, "p", NULL, "%s: a miss", what);
    else
        html_element_format(html, "p", NULL, "%s: triangle %u at t = %.9g (%a), u = %.9g, v = %.9g",
                            what, hit->prim, (double)hit->t, (double)hit->t, (double)hit->u,
                            (double)hit->v);
}

static void write_facts(struct html *html, const struct explain_page *page)
{
    const struct judged_ray *ray = page->ray;
    const struct oracle_answer *truth = &ray->truth;
    const float *o = ray->ray.org, *d = ray->ray.dir;
    html_element(html, "h2", NULL, "The ray");
    html_element_format(html, "p", NULL,
                        "from (%.9g, %.9g, %.9g) along (%.9g, %.9g, %.9g), t from "
                        "%.9g to %.9g",
                        (double)o[0], (double)o[1], (double)o[2], (double)d[0], (double)d[1],
                        (double)d[2], (double)ray->ray.tmin, (double)ray->ray.tmax);
    if (truth->flags & ORACLE_REFUSED)
        html_element(html, "p", NULL, "Truth: none, the ray is not finite or its range is empty");
    else if (truth->prim == ABI_NO_PRIM)
        html_element(html, "p", NULL, "Truth: a miss");
    else
        html_element_format(html, "p", NULL, "Truth: triangle %u at t in [%.17g, %.17g], %s",
                            truth->prim, truth->t_lo, truth->t_hi,
                            oracle_class_name((enum oracle_class)truth->class));
    if (ray->answer.finished)
        write_hit(html, "Answer", &ray->answer.hit);
}

static void write_path(struct html *html, const struct explanation *why)
{
    if (why->step_count == 0)
        return;
    html_element_format(html, "h2", NULL, "Traversal path to triangle %u", why->prim);
    html_table(html, NULL, NULL);
    html_heads(html, "#node;#record;kind;box test");
    html_body(html);
    for (uint32_t i = 0; i < why->step_count && i <= why->last; i++) {
        const struct explain_step *step = &why->step[i];
        html_begin(html, "tr", "class", i == why->last ? "fault" : NULL, NULL);
        html_element_format(html, "td", "n", "%u", step->note.node);
        if (step->record == EXPLAIN_NONE)
            html_element(html, "td", "n", "-");
        else
            html_element_format(html, "td", "n", "%u", step->record);
        html_element(html, "td", NULL, step->leaf ? "leaf" : "inner");
        html_element(html, "td", NULL, explain_note_text(&step->note));
        html_end(html, "tr");
    }
    html_table_end(html);
}

static void write_tried(struct html *html, const struct explanation *why)
{
    if (!why->inside || why->attempt_count == 0)
        return;
    html_element(html, "h2", NULL, "One repair at a time");
    html_table(html, NULL, NULL);
    html_heads(html, "repair;answer;verdict");
    html_body(html);
    for (size_t i = 0; i < why->attempt_count; i++) {
        const struct explain_attempt *attempt = &why->attempt[i];
        if (!attempt->changed)
            continue;
        html_begin(html, "tr", "class", attempt->opinion.allowed ? "fault" : NULL, NULL);
        html_element_format(html, "td", NULL, "%s", repair_text(attempt->repair));
        if (attempt->end != REPLAY_DONE)
            html_element(html, "td", NULL, "not finished");
        else if (attempt->hit.prim == ABI_NO_PRIM)
            html_element(html, "td", NULL, "a miss");
        else
            html_element_format(html, "td", NULL, "triangle %u at t = %.9g", attempt->hit.prim,
                                (double)attempt->hit.t);
        html_element_format(html, "td", NULL, "%s%s", explain_opinion(&attempt->opinion),
                            attempt->opinion.text);
        html_end(html, "tr");
    }
    html_table_end(html);
    html_element(html, "p", "dim", "Repairs that change nothing are left out.");
}

static void write_again(struct html *html, const struct explain_page *page)
{
    char command[EXPLAIN_COMMAND_MOST];
    explain_command(page->of, &page->ray->ray, command);
    html_element(html, "h2", NULL, "Again");
    html_element(html, "pre", NULL, page->again ? page->again : command);
}

void explain_html_numbers(struct html *html, const struct explain_page *page)
{
    const struct explanation *why = &page->ray->why;
    if (why->end == END_BOX || why->end == END_SKIPPED || why->end == END_ORIENTED) {
        write_node(html, &why->step[why->last]);
        explain_oriented_html(html, &why->step[why->last].oriented);
    }
    write_facts(html, page);
    write_path(html, why);
    write_tried(html, why);
    write_again(html, page);
}

enum status explain_write_html(const char *path, const struct explain_page *page,
                               struct reason *reason)
{
    struct file_out out;
    enum status status = file_out_open(path, &out, reason);
    if (status)
        return status;
    struct html html = {.out = out.stream};
    write_head(&html, page);
    status = write_views(&html, page, reason);
    if (status) {
        file_out_discard(&out);
        return status;
    }
    explain_html_numbers(&html, page);
    html_begin(&html, "script", NULL, NULL);
    fprintf(html.out, "//<![CDATA[\n%s//]]>\n", turn_shipped);
    html_end(&html, "script");
    html_end(&html, "body");
    html_end(&html, "html");
    return file_out_commit(&out, reason);
}
