/* The last line of raydiff explain: what its page comes to, in one sentence. */
#include "cmd/explain/cmd_explain_inner.h"

#include "ref/base/text.h"

#include <string.h>

void explain_conclude(const struct judged_ray *ray, char text[EXPLAIN_CONCLUSION_MOST])
{
    const struct judgement *judgement = &ray->judgement;
    const size_t size = EXPLAIN_CONCLUSION_MOST;
    text[0] = '\0';
    if (!ray->answer.finished)
        text_append(text, size, "the engine did not finish");
    else if (judgement->verdict == VERDICT_WRONG)
        text_append(text, size, "WRONG: %s", wrong_name(judgement->wrong));
    else if (explain_is_wrong(ray))
        text_append(text, size, "WRONG: not the bits that C gives");
    else if (judgement->verdict == VERDICT_RIGHT)
        text_append(text, size, "the answer is right");
    else
        text_append(text, size, "the answer is allowed: %s", verdict_name(judgement->verdict));
    if (ray->why.cause != CAUSE_NONE)
        text_append(text, size, ", by %s: %s", cause_name(ray->why.cause),
                    cause_text(ray->why.cause));
}

void explain_print_conclusion(const char *text, const struct explain_decode *decode,
                              const struct screen *screen)
{
    if (!decode->asked)
        screen_text(screen, "conclusion: %s\n", text);
    else if (!decode->compared)
        screen_text(screen, "conclusion: %s; C and GLSL are not compared\n", text);
    else if (decode->decoded.differ == 0)
        screen_text(screen, "conclusion: %s; C and GLSL decode the same\n", text);
    else
        screen_text(screen, "conclusion: decode DIFFERS: %s; %s\n", decode->decoded.first, text);
}
