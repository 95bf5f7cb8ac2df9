/* raydiff web: pages of findings and scenes, on which a visitor's browser traces the ray itself. */
#define _POSIX_C_SOURCE 200809L /* strdup */
#include "cmd/web/cmd_web.h"

#include "cmd/common/cmd_rows.h"
#include "fuzz/findings/findings.h"
#include "ref/base/command.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

#define PAGES_MOST 512u
#define SCENE_RAYS 20000u /* among which the ray of a scene is looked for */

struct web_options {
    struct explain_options explain;
    const char *out;
    bool force;
};

#define ROWS_OF struct web_options

static const struct option_row rows[] = {
    {"out", "DIR", "the folder, which must not exist", OF_TEXT(out), .file = true},
    {"force", NULL, "replaces a folder that holds nothing but pages", OF_FLAG(force)},
    {"ray", "R", "of a scene: this ray, as raydiff explain takes it", OF_TEXT(explain.ray_text)},
    {"rays", "SET", "of a scene: the first wrong ray of this set",
     OF_MEMBER(explain.rays, TABLE_RAY_SETS), .value = "mixed"},
    {"index", "I", "which ray of the file or of the set",
     OF_COUNT(explain.index, 0, SCENE_RAYS - 1), .shown = "the first one with a wrong answer"},
    {"engine", "E", "engine whose answer is explained", OF_MEMBER(explain.of.engine, TABLE_ENGINES),
     .shown = "the file's; else cpu"},
    {"layout", "L", "layout, traced in the browser beside f32",
     OF_MEMBER(explain.of.layout, TABLE_LAYOUTS), .shown = "the file's; else rf16"},
    {"box", "B", "of a scene: box test", OF_MEMBER(explain.of.box, TABLE_BOX_TESTS),
     .value = "robust"},
    {"tri", "T", "of a scene: triangle test", OF_MEMBER(explain.of.tri, TABLE_TRI_TESTS),
     .value = "mt"},
    {0},
};

static const struct option_set set = {
    .command = "web",
    .usage = "web FINDING|SCENE|FOLDER... --out DIR [OPTIONS]",
    .about = "Writes a folder of pages for a browser, one for each finding or scene, and one for "
             "each finding of a folder of raydiff fuzz; index.html lists them. A page shows "
             "triangles, the ray, the boxes on its way and the node that turned it away in three "
             "dimensions, with the numbers of raydiff explain. Where the browser has WebGPU it "
             "traces the ray by the WGSL of engine webgpu and says whether the visitor's own "
             "graphics card shows the finding. A page is one file and fetches nothing.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, explain.engines)},
    .notes = "Worlds, and findings about a tree or on no ray, have no page: named they are "
             "refused, in a folder the list says so.",
    .codes = "0 written, 2 bad input, 3 the engine failed, 4 internal error, 77 the engine cannot "
             "run here",
    .example = "web fuzz/corpus/rounded-inward.trial --out pages",
    .makes_folder = true,
};

/* A run. */
struct web {
    const struct web_options *options;
    struct web_folder folder;
    struct folder open;
    struct web_entry entry[PAGES_MOST];
    size_t count;
    int code; /* of a refusal that was told already; -1: none */
};

/* Gives an entry a name that no other one has. */
static void take_name(struct web *web, struct web_entry *entry, const char *text)
{
    char plain[WEB_NAME_MOST];
    web_name(text, plain);
    snprintf(entry->name, sizeof entry->name, "%s", plain);
    for (unsigned n = 2;; n++) {
        bool taken = strcmp(entry->name, "index") == 0 || !entry->name[0];
        for (size_t i = 0; i + 1 < web->count; i++)
            taken = taken || strcmp(web->entry[i].name, entry->name) == 0;
        if (!taken)
            return;
        snprintf(entry->name, sizeof entry->name, "%.*s-%u", (int)WEB_NAME_MOST - 8, plain, n);
    }
}

/* The name of a page: of a finding its signature, else the last part of what was named. */
static void name_entry(struct web *web, struct web_entry *entry, const struct explain_page *page)
{
    char text[FUZZ_SIGNATURE_MOST];
    const char *slash = strrchr(entry->subject, '/');
    if (page->file && page->file->has_signature) {
        fuzz_signature_print(&page->file->signature, text);
        take_name(web, entry, text);
    } else {
        take_name(web, entry, slash && slash[1] ? slash + 1 : entry->subject);
    }
}

static enum status write_page(struct web *web, const struct web_entry *entry,
                              const struct explain_page *page, int exit_code, struct reason *reason)
{
    struct web_data data;
    struct file_out out;
    char name[WEB_NAME_MOST + 8];
    snprintf(name, sizeof name, "%s.html", entry->name);
    enum status status = web_data_make(page, &data, reason);
    if (status)
        return status;
    status = folder_put(&web->open, name, &out, reason);
    if (!status) {
        status = web_page_write(out.stream, page, &data, exit_code, reason);
        if (status)
            file_out_discard(&out);
        else
            status = file_out_commit(&out, reason);
    }
    web_data_free(&data);
    return status;
}

/* Takes the page of raydiff explain. */
static enum status show(void *to, const struct explain_page *page, int exit_code,
                        struct reason *reason)
{
    struct web *web = to;
    struct web_entry *entry = &web->entry[web->count - 1];
    const struct judged_ray *ray = page->ray;
    name_entry(web, entry, page);
    const bool wrong = ray->answer.finished && ray->judgement.verdict == VERDICT_WRONG;
    snprintf(entry->verdict, sizeof entry->verdict, "%s%s%s, ray %zu: %s%s", page->of->engine->name,
             page->of->layout ? " on " : "", page->of->layout ? page->of->layout->name : "",
             page->index, wrong ? "WRONG: " : "",
             wrong                  ? wrong_name(ray->judgement.wrong)
             : ray->answer.finished ? verdict_name(ray->judgement.verdict)
                                    : "not finished");
    if (ray->why.cause != CAUSE_NONE)
        snprintf(entry->cause, sizeof entry->cause, "%s", cause_name(ray->why.cause));
    return write_page(web, entry, page, exit_code, reason);
}

static enum status add_entry(struct web *web, char *spec, struct reason *reason)
{
    if (web->count == PAGES_MOST)
        return fail(reason, STATUS_LIMIT, "more than %u pages", PAGES_MOST);
    struct web_entry *entry = &web->entry[web->count++];
    *entry = (struct web_entry){.subject = strdup(spec)};
    return entry->subject ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for a page");
}

/* Reads a subject and refuses options that it does not use; web->code is then what was told. */
static enum status take(struct web *web, char *spec, struct explain_options *options,
                        struct finding_file *file, struct reason *reason)
{
    *options = web->options->explain;
    *file = (struct finding_file){.has_signature = false};
    enum status status = explain_take_subject(options, spec, file, reason);
    if (status)
        return status;
    web->code = explain_check_use(options, &spec);
    if (web->code < 0 && !options->about_tree)
        return STATUS_OK;
    finding_file_free(file);
    return fail(reason, STATUS_UNSUPPORTED, "%s: it is about a tree, on no ray", spec);
}

static enum status make_page(struct web *web, char *spec, struct reason *reason)
{
    struct explain_options options;
    struct finding_file file;
    int code;
    enum status status = add_entry(web, spec, reason);
    if (!status)
        status = take(web, spec, &options, &file, reason);
    options.shows_to = web;
    return status ? status : explain_run(&options, &file, &code, reason);
}

/* A finding of a folder without a page is listed with the reason. */
static enum status make_pages(struct web *web, const char *path, struct reason *reason)
{
    struct findings *findings;
    enum status status = findings_look(path, &findings, reason);
    if (status)
        return status;
    for (size_t i = 0; i < findings_count(findings) && !status && web->code < 0; i++) {
        const struct findings_entry *entry = findings_entry(findings, i);
        const size_t before = web->count;
        char file[FOLDER_PATH_MOST], name[FUZZ_SIGNATURE_MOST];
        struct reason why = {""};
        findings_path(findings, &entry->signature,
                      entry->has_smallest ? "smallest.trial" : "first.trial", file, sizeof file);
        status = make_page(web, file, &why);
        if (status == STATUS_MEMORY || web->count == before || web->code >= 0) {
            *reason = why;
            break;
        }
        if (status) {
            struct web_entry *listed = &web->entry[web->count - 1];
            fuzz_signature_print(&entry->signature, name);
            take_name(web, listed, name);
            listed->why = why;
            status = STATUS_OK;
        }
    }
    findings_close(findings);
    return status;
}

static enum status write_index(struct web *web, struct reason *reason)
{
    struct file_out out;
    enum status status = folder_put(&web->open, "index.html", &out, reason);
    if (status)
        return status;
    web_index_write(out.stream, web->entry, web->count);
    return file_out_commit(&out, reason);
}

/* Refuses what can be refused before anything is made. */
static enum status check_all(struct web *web, char *const *spec, size_t count,
                             struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        struct explain_options options;
        struct finding_file file;
        if (findings_is_folder(spec[i]))
            continue;
        status = take(web, spec[i], &options, &file, reason);
        if (!status)
            finding_file_free(&file);
    }
    return status;
}

static enum status make_all(struct web *web, char *const *spec, size_t count, struct reason *reason)
{
    const struct web_options *o = web->options;
    enum status status = check_all(web, spec, count, reason);
    if (!status)
        status = web_folder_open(o->out, o->force, &web->folder, reason);
    if (!status)
        status = folder_open(web->folder.path, false, &web->open, reason);
    for (size_t i = 0; i < count && !status && web->code < 0; i++)
        status = findings_is_folder(spec[i]) ? make_pages(web, spec[i], reason)
                                      : make_page(web, spec[i], reason);
    if (!status)
        status = write_index(web, reason);
    folder_close(&web->open);
    if (!status)
        status = web_folder_commit(&web->folder, reason);
    web_folder_discard(&web->folder);
    return status;
}

static void print(const struct web *web)
{
    size_t pages = 0;
    for (size_t i = 0; i < web->count; i++) {
        const struct web_entry *entry = &web->entry[i];
        pages += !entry->why.text[0];
        if (entry->why.text[0])
            printf("  no page of %s: %s\n", entry->name, entry->why.text);
        else
            printf("  %s.html: %s%s%s\n", entry->name, entry->verdict,
                   entry->cause[0] ? ", by " : "", entry->cause);
    }
    printf("%s: %zu page%s and index.html\n", web->options->out, pages, plural(pages));
}

int cmd_web(int argc, char **argv)
{
    struct reason reason = {""};
    struct web_options options = {.explain = {.command = "web",
                                              .shows = show,
                                              .count = SCENE_RAYS,
                                              .of = {.seed = 1,
                                                     .engine = engine_find("cpu"),
                                                     .layout = layout_find("rf16"),
                                                     .builder = builders[0],
                                                     .store = tri_stores[0],
                                                     .query = QUERY_CLOSEST,
                                                     .build = build_options_default()},
                                              .engines = engine_options_default()}};
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    options.explain.has_index = option_was_given("index");
    options.explain.has_engine = option_was_given("engine");
    if (!options.out)
        return usage_error("web", "--out DIR is needed");
    if (first == argc)
        return usage_error("web", "no finding or scene given");
    struct web *web = alloc_zeroed(1, sizeof *web);
    if (!web)
        return fprintf(stderr, "raydiff web: out of memory\n"), EXIT_INTERNAL;
    web->options = &options;
    web->code = -1;
    web->folder.held = -1;
    enum status status = make_all(web, argv + first, (size_t)(argc - first), &reason);
    if (!status)
        print(web);
    code = web->code >= 0 ? web->code : exit_with_reason("web", status, &reason);
    for (size_t i = 0; i < web->count; i++)
        free(web->entry[i].subject);
    free(web);
    return code;
}
