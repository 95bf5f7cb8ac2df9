/* A page of raydiff web as HTML: numbers, a view in three dimensions, and the WGSL engine for the
 * visitor's graphics card. All of it is in the one file. */
#include "cmd/web/cmd_web.h"

#include "bench/report/report_html.h"
#include "gpu/webgpu/webgpu_text.h"

#include <stdlib.h>
#include <string.h>

extern const char web_view_shipped[]; /* cmd/web/web_view.js */
extern const char web_gpu_shipped[];  /* cmd/web/web_gpu.js */

static const char style[] =
    "canvas{border:1px solid var(--line);border-radius:4px;max-width:100%;touch-action:none;"
    "cursor:grab}\n"
    "canvas:focus{outline:2px solid #1f77b4}\n"
    "button{font:inherit;margin-right:6px}\n"
    "ul.key{list-style:none;padding:0;display:flex;flex-wrap:wrap;gap:4px 18px}\n"
    "ul.key i{display:inline-block;width:14px;height:12px;margin-right:5px}\n"
    "table#steps tr[aria-current]{outline:2px solid #1f77b4}\n"
    "td code{overflow-wrap:anywhere}\n";

void web_html_begin(struct html *html, const char *title)
{
    fputs("<!DOCTYPE html>\n", html->out);
    html_begin(html, "html", "lang", "en", NULL);
    html_begin(html, "head", NULL, NULL);
    html_void(html, "meta", "charset", "utf-8", NULL);
    html_void(html, "meta", "http-equiv", "Content-Security-Policy", "content",
              "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'", NULL);
    html_void(html, "meta", "name", "viewport", "content", "width=device-width", NULL);
    html_element(html, "title", NULL, title);
    html_begin(html, "style", NULL, NULL);
    fputs(explain_html_style, html->out);
    fputs(style, html->out);
    html_end(html, "style");
    html_end(html, "head");
    html_begin(html, "body", NULL, NULL);
}

void web_html_end(struct html *html)
{
    html_end(html, "body");
    html_end(html, "html");
}

/* --- parts ------------------------------------------------------------------------------------ */

static void write_subject(struct html *html, const struct explain_page *page)
{
    char text[FUZZ_SIGNATURE_MOST];
    explain_html_verdict(html, page);
    html_begin(html, "p", "class", "dim", "id", "subject", NULL);
    html_text(html, page->of->spec);
    if (page->file && page->file->has_signature) {
        fuzz_signature_print(&page->file->signature, text);
        html_text(html, ", found as ");
        html_begin(html, "code", "id", "signature", NULL);
        html_text(html, text);
        html_end(html, "code");
    }
    html_format(html, "; ray %zu of %zu, %u triangles", page->index, page->count,
                page->scene->tri_count);
    html_end(html, "p");
}

static void write_view(struct html *html)
{
    static const struct {
        const char *id, *text;
    } button[] = {{"look-scene", "scene"},
                  {"look-node", "node"},
                  {"look-hit", "hit"},
                  {"step-up", "box above"},
                  {"step-down", "box below"}};
    html_element(html, "h2", NULL, "Where it happens");
    html_begin(html, "canvas", "id", "view", "width", "760", "height", "520", "tabindex", "0",
               NULL);
    html_end(html, "canvas");
    html_begin(html, "p", NULL, NULL);
    for (size_t i = 0; i < ARRAY_COUNT(button); i++) {
        html_begin(html, "button", "id", button[i].id, "type", "button", NULL);
        html_text(html, button[i].text);
        html_end(html, "button");
    }
    html_end(html, "p");
    html_begin(html, "ul", "class", "key", "id", "key", NULL);
    html_end(html, "ul");
    html_begin(html, "p", "class", "dim", "id", "shown", NULL);
    html_end(html, "p");
    html_element(html, "p", "dim",
                 "Drag or use the arrows to turn, wheel or + and - to come closer, [ and ] to walk "
                 "the boxes on the way, 0 to start again.");
}

static void write_gpu(struct html *html)
{
    html_element(html, "h2", NULL, "Your graphics card");
    html_begin(html, "section", "id", "gpu", "data-state", "waiting", NULL);
    html_begin(html, "p", "id", "gpu-says", NULL);
    html_text(html, "Without scripts nothing runs here.");
    html_end(html, "p");
    html_table(html, NULL, NULL);
    html_heads(html, "layout;answer to the ray;it is;C on the same bytes;#rays;#WRONG;#other bits "
                     "than C's");
    html_body(html);
    html_table_end(html);
    html_end(html, "section");
}

/* --- data ------------------------------------------------------------------------------------- */

/* Within an element of script no character of HTML may stand. */
static int put_safely(const char *bytes, size_t size, void *to)
{
    for (size_t i = 0; i < size; i++)
        if (bytes[i] == '<' || bytes[i] == '>' || bytes[i] == '&')
            fprintf(to, "\\u%04x", (unsigned)bytes[i]);
        else
            putc(bytes[i], to);
    return 0;
}

static void put_json(FILE *out, const char *name, json_t *json)
{
    fprintf(out, "\"%s\":", name);
    json_dump_callback(json, put_safely, out,
                       JSON_COMPACT | JSON_ENCODE_ANY | JSON_ENSURE_ASCII |
                           JSON_REAL_PRECISION(17));
    fputs(",\n", out);
    json_decref(json);
}

static void put_words(FILE *out, const char *name, const void *words, size_t bytes)
{
    fprintf(out, "\"%s\":", name);
    if (words) {
        putc('"', out);
        html_base64(out, words, bytes);
        putc('"', out);
    } else {
        fputs("null", out);
    }
    fputs(",\n", out);
}

static void put_triangles(FILE *out, const struct scene *scene)
{
    const size_t floats = ABI_TRI_FLOATS * (size_t)scene->tri_count;
    float *all = alloc_zeroed(floats + 1, sizeof *all);
    for (uint32_t i = 0; all && i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        memcpy(all + ABI_TRI_FLOATS * (size_t)i, v, sizeof v);
    }
    put_words(out, "triangles", all, 4 * floats);
    free(all);
}

static void put_rights(FILE *out, const struct web_data *data)
{
    enum { RIGHT_WORDS = 8 };
    uint32_t *all = alloc_zeroed(RIGHT_WORDS * data->right_count + 1, sizeof *all), *at = all;
    for (size_t i = 0; all && i < data->right_count; i++, at += RIGHT_WORDS) {
        const struct export_right *right = &data->right[i];
        const float range[6] = {right->t[0], right->t[1], right->u[0],
                                right->u[1], right->v[0], right->v[1]};
        at[0] = right->ray;
        at[1] = right->prim;
        memcpy(at + 2, range, sizeof range);
    }
    put_words(out, "rights", all, 4 * RIGHT_WORDS * data->right_count);
    free(all);
}

static void put_job(FILE *out, const struct web_job *job, const struct web_data *data)
{
    fputs("{", out);
    put_json(out, "layout", json_string(job->name));
    put_json(out, "why", json_string(job->words ? "" : job->why.text));
    put_words(out, "answers", job->answer, sizeof *job->answer * data->count);
    put_words(out, "words", job->words, 4 * job->word_count);
    fputs("\"end\":0}", out);
}

static enum status write_data(struct html *html, const struct explain_page *page,
                              const struct web_data *data, int exit_code, struct reason *reason)
{
    FILE *out = html->out;
    json_t *explained = explain_json(page, exit_code);
    if (!explained)
        return fail(reason, STATUS_MEMORY, "no memory for a page");
    html_begin(html, "script", "type", "application/json", "id", "data", NULL);
    fputs("{", out);
    put_json(out, "explained", explained);
    put_json(out, "first", json_integer((json_int_t)data->first));
    put_json(out, "shown", json_integer((json_int_t)(page->index - data->first)));
    put_json(out, "finding", json_boolean(page->file && page->file->has_signature));
    put_words(out, "rays", data->ray, sizeof *data->ray * data->count);
    put_triangles(out, page->scene);
    put_rights(out, data);
    fputs("\"jobs\":[", out);
    for (size_t i = 0; i < data->job_count; i++) {
        fputs(i ? ",\n" : "", out);
        put_job(out, &data->job[i], data);
    }
    fputs("]}", out);
    html_end(html, "script");
    return STATUS_OK;
}

enum status web_page_write(FILE *out, const struct explain_page *page, const struct web_data *data,
                           int exit_code, struct reason *reason)
{
    struct html html = {.out = out};
    char title[400];
    snprintf(title, sizeof title, "raydiff web %.300s", page->of->spec);
    web_html_begin(&html, title);
    write_subject(&html, page);
    write_view(&html);
    write_gpu(&html);
    explain_html_numbers(&html, page);
    enum status status = write_data(&html, page, data, exit_code, reason);
    html_begin(&html, "script", NULL, NULL);
    fprintf(out, "//<![CDATA[\n%s%s%s//]]>\n", wgsl_find("core.js"), web_view_shipped,
            web_gpu_shipped);
    html_end(&html, "script");
    web_html_end(&html);
    return status;
}
