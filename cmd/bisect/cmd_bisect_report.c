/* What raydiff bisect prints. */
#include "cmd/bisect/cmd_bisect.h"

#include "ref/base/text.h"

#include <stdio.h>
#include <string.h>

void shown_text(const struct bisect_shown *shown, char *text, size_t bytes)
{
    snprintf(text, bytes, "none: nothing shows");
    if (!shown->is)
        return;
    snprintf(text, bytes, "%s: %zu of %zu ", symptom_names[shown->symptom], shown->count,
             shown->of);
    if (shown->symptom == SYMPTOM_PRECISE)
        text_append(text, bytes, "float operations without NoContraction, %u of open rounding",
                    shown->open);
    else
        text_append(text, bytes, "answers %s, to ray %zu first",
                    shown->symptom == SYMPTOM_WRONG ? "are WRONG" : "have other bits",
                    shown->first);
}

static const char *proof_text(const struct bisect *bisect)
{
    switch (bisect->proof) {
    case BISECT_SHORTEST:
        return "no shorter list shows it";
    case BISECT_MINIMAL:
        return "none of them can be left out";
    default:
        return "a smaller one may do: --tries was reached";
    }
}

static void print_passes(const struct bisect_result *result, const struct screen *screen)
{
    const struct bisect *bisect = &result->bisect;
    char text[4096] = "";
    if (compiler_translates(&result->subject->bad)) {
        screen_text(screen, "tool     %s\n", result->tool);
        return;
    }
    if (bisect->end == BISECT_UNLIKE) {
        screen_text(screen, "passes   those that spirv-opt names for %s do not show it\n",
                    result->subject->bad_name);
        return;
    }
    if (bisect->end == BISECT_AS_BUILT || bisect->decorations) {
        screen_text(screen, "passes   none: %s\n",
                    bisect->decorations ? "decorations that were left out are enough"
                                        : "the shader as built shows it, against this compiler");
        return;
    }
    for (size_t i = 0; i < bisect->pass_count; i++)
        if (bisect->in[i])
            text_append(text, sizeof text, "%s%s", text[0] ? " + " : "", bisect->pass[i]);
    screen_text(screen, "passes   %s: %zu of %zu, %s (%zu tried)\n", text, bisect->found_count,
                bisect->pass_count, proof_text(bisect), bisect->pass_tries);
}

static void print_change(const struct bisect_result *result, const struct screen *screen)
{
    const struct bisect *bisect = &result->bisect;
    if (bisect->end == BISECT_NO_CURE)
        screen_text(screen, "change   not in decorations: put back, they do not cure it\n");
    if (bisect->end == BISECT_WHOLE)
        screen_text(screen, "change   %s: in parts it does not show\n",
                    COUNTED(bisect->edits, "edit"));
    if (bisect->edit_count == 0)
        return;
    screen_text(screen, "shader   %s%s%s\n", result->shader,
                bisect->function[0] ? ", function " : "", bisect->function);
    screen_text(screen, "change   %s\n", bisect->what);
    for (size_t i = 0; i < bisect->line_count; i++)
        screen_text(screen, "  %c %s\n", bisect->line[i].sign, bisect->line[i].text);
    if (bisect->line_count == BISECT_LINES_MOST)
        screen_text(screen, "  ...\n");
    screen_text(screen, "         %zu of %s, %s (%zu tried)\n", bisect->edit_count,
                COUNTED(bisect->edits, bisect->decorations ? "lost decoration" : "edit"),
                bisect->least ? "none can be left out" : "fewer may do: --tries was reached",
                bisect->edit_tries);
}

void bisect_print(const struct bisect_result *result, const struct screen *screen)
{
    const struct bisect_options *o = result->options;
    const struct bisect_subject *subject = result->subject;
    char text[200];
    screen_text(screen, "%s against %s: %s, %s, engine %s%s%s\n", subject->bad_name,
                subject->good_name, subject->text, COUNTED(subject->ray_count, "ray"),
                o->engine->name, o->layout ? ", layout " : "", o->layout ? o->layout->name : "");
    shown_text(&result->shown, text, sizeof text);
    screen_text(screen, "symptom  %s\n", text);
    if (!result->shown.is)
        return;
    print_passes(result, screen);
    print_change(result, screen);
    if (result->crashed + result->hung > 0)
        screen_text(screen, "modules  %zu of those tried crashed the engine, %zu hung\n",
                    result->crashed, result->hung);
}
