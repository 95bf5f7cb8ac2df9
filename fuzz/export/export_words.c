/* The finding in words, for the head of every form. */
#include "fuzz/export/export_inner.h"

#include "ref/base/command.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define COLUMNS 96
#define INDENT  12 /* of what stands beside a title */

/* A comment being written: lines with the same beginning, broken between words. */
struct comment {
    const char *begin;
    size_t column;
    FILE *to;
};

static void begin_line(struct comment *c, size_t indent)
{
    if (c->column)
        fputc('\n', c->to);
    fputs(c->begin, c->to);
    for (size_t i = 0; i < indent; i++)
        fputc(' ', c->to);
    c->column = strlen(c->begin) + indent;
}

/* The text must not end a comment of C, or begin another one. */
static char safe(const char *text)
{
    if (text[0] == '/' && text[1] == '*')
        return '|';
    if (text[0] == '*' && text[1] == '/')
        return '|';
    return text[0] >= 0x20 && text[0] <= 0x7E ? text[0] : '?';
}

/* Writes a paragraph beside its title, which may be "". NULL: without an indent. */
static void say(struct comment *c, const char *title, const char *format, ...) PRINTF_LIKE(3, 4);
static void say(struct comment *c, const char *title, const char *format, ...)
{
    const size_t indent = title ? INDENT : 0;
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    begin_line(c, 0);
    fprintf(c->to, "%-*s", (int)indent, title ? title : "");
    c->column += indent;
    bool first = true;
    for (const char *at = text; *at;) {
        size_t length = strcspn(at, " ");
        if (!first && c->column + 1 + length > COLUMNS) {
            begin_line(c, indent);
        } else if (!first) {
            fputc(' ', c->to);
            c->column++;
        }
        for (size_t i = 0; i < length; i++)
            fputc(safe(at + i), c->to);
        c->column += length;
        first = false;
        at += length + (at[length] == ' ');
    }
}

static void blank(struct comment *c)
{
    fputc('\n', c->to);
    size_t length = strlen(c->begin);
    while (length && c->begin[length - 1] == ' ')
        length--;
    fwrite(c->begin, 1, length, c->to);
    c->column = 1;
}

static void say_lines(struct comment *c, const char *title, const char *lines)
{
    for (const char *at = lines; *at;) {
        size_t length = strcspn(at, "\n");
        say(c, at == lines ? title : "", "%.*s", (int)length, at);
        at += length + (at[length] == '\n');
    }
}

static void hit_text(const struct export_case *the, const struct hit *hit, char *text, size_t size)
{
    if (hit->prim == ABI_NO_PRIM)
        snprintf(text, size, "a miss");
    else if (export_is_unnamed(the))
        snprintf(text, size, "a hit");
    else
        snprintf(text, size, "triangle %u at t = %.9g, u = %.9g, v = %.9g", hit->prim,
                 (double)hit->t, (double)hit->u, (double)hit->v);
}

static void print_interval(const char *name, const float x[2], FILE *to)
{
    if (x[0] <= -FLT_MAX && x[1] >= FLT_MAX)
        fprintf(to, ", any %s", name);
    else
        fprintf(to, ", %s in [%.9g, %.9g]", name, (double)x[0], (double)x[1]);
}

void export_print_right(const struct export_case *the, const struct export_right *right, FILE *to)
{
    fprintf(to, "# ray %u, right: ", right->ray);
    if (right->prim == ABI_NO_PRIM || export_is_unnamed(the)) {
        fputs(right->prim == ABI_NO_PRIM ? "a miss" : "a hit", to);
    } else {
        char place[EXPORT_PLACE_MOST];
        export_place(the, right->prim, place);
        fputs(place, to);
        if (the->world)
            fprintf(to, ", %s", !right->back ? "front" : !right->front ? "back" : "either side");
        print_interval("t", right->t, to);
        if (export_is_followed(the)) {
            fputs(", u and v of the ray's point there", to);
        } else {
            print_interval("u", right->u, to);
            print_interval("v", right->v, to);
        }
    }
    fputc('\n', to);
}

const char *export_what_any(const struct export_case *the)
{
    return the->world ? "a miss is right, and any hit of what mask, flags and filter let it meet, "
                        "as the side that it sees"
                      : "any answer is right";
}

bool export_is_wrong_here(const struct export_case *the, uint32_t i)
{
    return the->judgement[i].verdict == VERDICT_WRONG ||
           (the->bits_matter && memcmp(&the->here[i], &the->reference[i], sizeof *the->here) != 0);
}

/* The ray that the comment describes: the first that was wrong here, else wrong in C, else the
 * first. */
static uint32_t telling_ray(const struct export_case *the)
{
    for (uint32_t i = 0; i < the->ray_count && the->here; i++)
        if (export_is_wrong_here(the, i))
            return i;
    for (uint32_t i = 0; i < the->ray_count && the->reference; i++)
        if (!export_is_right(the, i, &the->reference[i]))
            return i;
    return 0;
}

static void say_truth(struct comment *c, const struct export_case *the, uint32_t i)
{
    const struct oracle_answer *truth = &the->truth[i];
    char t[ORACLE_T_TEXT] = "", place[EXPORT_PLACE_MOST] = "";
    if (truth->prim != ABI_NO_PRIM)
        oracle_t_text(the->oracle, &the->ray[i], truth->prim, t);
    if (truth->prim != ABI_NO_PRIM)
        export_place(the, truth->prim, place);
    if (truth->flags & ORACLE_REFUSED)
        say(c, "Exactly", "ray %u is not finite, or its range is empty: %s", i,
            export_what_any(the));
    else if (truth->prim == ABI_NO_PRIM)
        say(c, "Exactly", "ray %u hits nothing.", i);
    else
        say(c, "Exactly", "ray %u hits %s%s first, at t %s (%s).", i, place,
            truth->tie_count > 1 ? " and others at the same t" : "", t,
            oracle_class_name((enum oracle_class)truth->class));
}

static void say_answers(struct comment *c, const struct export_case *the, uint32_t i)
{
    char text[200];
    if (the->here) {
        hit_text(the, &the->here[i], text, sizeof text);
        say(c, "Answered", "%s%s%s. Where this file was written, that is:", text,
            the->judgement[i].verdict == VERDICT_WRONG ? ": WRONG, " : ", which is allowed: ",
            the->judgement[i].verdict == VERDICT_WRONG ? wrong_name(the->judgement[i].wrong)
                                                       : verdict_name(the->judgement[i].verdict));
        say_lines(c, "", the->versions);
    } else {
        say(c, "Answered", "it was not run where this file was written: %s", the->not_asked);
    }
    if (!the->reference)
        return;
    hit_text(the, &the->reference[i], text, sizeof text);
    say(c, "In C", "%s: raydiff's reference on the same bytes.%s", text,
        the->reference_fails
            ? " C fails there, too: the fault lies in the bytes or in the algorithm, not in the "
              "driver."
            : "");
}

static void say_tolerance(struct comment *c, const struct export_case *the)
{
    const char *whose = the->measured ? "whose operators were measured where this file was written"
                                      : "in the precision that Vulkan's specification asks for";
    if (the->model.formula == TWIN_UNKNOWN)
        say(c, "Tolerance",
            "the formula is not known: an answer is right if it is exact for vertices moved by at "
            "most 2^-14 of the largest distance of a vertex from the ray's origin. u and v must "
            "give the ray's point at t as exactly.%s",
            the->world ? " In an instance it is more by as much as its transform may lose." : "");
    else if (export_is_vulkan(the))
        say(c, "Tolerance",
            "proven error bounds of the shader's own formula around the exact values, for a driver "
            "%s. Every answer that they allow is listed.",
            whose);
    else
        say(c, "Tolerance",
            "proven error bounds of Embree's published formula around the exact values. Every "
            "answer that they allow is listed.");
}

static void say_subject(struct comment *c, const struct export_case *the)
{
    const struct fuzz_trial *trial = the->trial;
    const char *what =
        trial->query == QUERY_ANY ? "whether anything is hit" : "for the nearest hit";
    char rays[40];
    snprintf(rays, sizeof rays, the->ray_count == 1 ? "One ray asks" : "%u rays ask",
             the->ray_count);
    switch (the->subject) {
    case SUBJECT_VULKAN:
        say(c, NULL,
            "%s a compute shader %s among %u triangles, by a tree of %u records of %u bytes "
            "(layout %s, builder %s, leaf %u, box test %s, triangle test %s).",
            rays, what, trial->scene.tri_count, the->packed.node_count, the->layout->node_bytes,
            the->layout->name, trial->builder->name, trial->build.leaf, trial->box->name,
            trial->tri->name);
        break;
    case SUBJECT_BRUTE:
        say(c, NULL,
            "%s a compute shader %s among %u triangles; it tests each of them (triangle test "
            "%s).",
            rays, what, trial->scene.tri_count, trial->tri->name);
        break;
    case SUBJECT_QUERY:
        say(c, NULL, "%s the driver's ray queries (VK_KHR_ray_query) %s among %u triangles.", rays,
            what, trial->scene.tri_count);
        break;
    case SUBJECT_EMBREE:
    case SUBJECT_EMBREE_ROBUST:
        say(c, NULL, "%s Embree%s %s among %u triangles.%s", rays,
            the->subject == SUBJECT_EMBREE_ROBUST ? " (RTC_SCENE_FLAG_ROBUST)" : "", what,
            trial->scene.tri_count,
            the->left_out ? " Rays that Embree does not promise to survive are left out." : "");
        break;
    case SUBJECT_TRACER:
        if (the->world)
            say(c, NULL, "%s %s in a world of %u instance%s, %u placed triangle%s.", rays, what,
                the->world->instance_count, plural(the->world->instance_count),
                export_tri_count(the), plural(export_tri_count(the)));
        else
            say(c, NULL, "%s %s among %u triangles.", rays, what, trial->scene.tri_count);
        break;
    }
}

/* How it is run, and what the exit codes mean. */
static void say_use(struct comment *c, const struct export_case *the)
{
    char stem[64];
    const char *name = the->options->name;
    if (!name || !*name)
        name = the->options->form == EXPORT_AMBER ? "finding.amber" : "finding.c";
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
    if (!*stem)
        snprintf(stem, sizeof stem, "finding");
    if (the->options->form == EXPORT_AMBER) {
        say(c, "Run", "amber -v 1.1 -t vulkan1.1 %.60s", name);
        say(c, "", "It passes where the driver is right, and fails while the bug shows.");
        return;
    }
    if (export_is_vulkan(the))
        say(c, "Run", "cc %.60s -lvulkan -o %s && ./%s [DEVICE]", name, stem, stem);
    else
        say(c, "Run",
            "cc %.60s -lembree3 -lm -o %s && ./%s      (or -lembree4, which -DEMBREE=3 "
            "or 4 forces)",
            name, stem, stem);
    say(c, "Exit code", "0 every answer is right (fixed), 1 the bug shows%s, 2 it cannot run here.",
        the->file->has_signature && the->file->signature.kind == FUZZ_KIND_CRASH
            ? " (or the program crashes)"
            : "");
}

void export_comment(const struct export_case *the, const char *begin, FILE *to)
{
    struct comment c = {.begin = begin, .to = to};
    const struct finding_file *file = the->file;
    uint32_t i = telling_ray(the);
    say(&c, NULL, "%s", the->title);
    blank(&c);
    say_subject(&c, the);
    blank(&c);
    if (the->options->form != EXPORT_TEXT)
        say_use(&c, the);
    say_truth(&c, the, i);
    if (the->subject != SUBJECT_TRACER)
        say_answers(&c, the, i);
    if (the->bits_matter)
        say(&c, "Bits",
            "the finding is that these bits differ from C's although every operator of the driver "
            "was found to round as C's does; so other bits than C's count as WRONG here.");
    if (file->has_signature)
        say(&c, "Cause", "%s: %s.", cause_name(file->signature.cause),
            cause_text(file->signature.cause));
    say_tolerance(&c, the);
    if (file->versions[0])
        say_lines(&c, "Seen with", file->versions);
    if (the->trial->origin.recipe[0])
        say(&c, "Scene", "%s", the->trial->origin.recipe);
    say(&c, "Written by", "raydiff " RAYDIFF_VERSION "; nothing of raydiff is needed.");
    fputc('\n', to);
}
