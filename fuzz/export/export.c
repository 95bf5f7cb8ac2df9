#include "fuzz/export/export_inner.h"

#include "ref/outside/pipe_text.h"

#include <stdio.h>
#include <string.h>

/* Scene and rays for a tracer that reads text, what is right in comments. */
static void write_text(const struct export_case *the, FILE *to)
{
    size_t next = 0; /* right answers are in the order of their rays */
    export_comment(the, "# ", to);
    for (uint32_t i = 0; i < the->ray_count; i++) {
        if (next == the->right_count || the->right[next].ray != i)
            fprintf(to, "# ray %u is out of contract: %s\n", i, export_what_any(the));
        while (next < the->right_count && the->right[next].ray == i)
            export_print_right(the, &the->right[next++], to);
    }
    if (the->world)
        pipe_text_write_world(to, NULL, the->world, the->ray, the->mode, the->ray_count,
                              the->trial->query, false);
    else
        pipe_text_write(to, NULL, &the->trial->scene, the->ray, the->ray_count, the->trial->query,
                        false);
}

static void tell(struct export_said *said, const char *line)
{
    size_t used = strlen(said->text);
    snprintf(said->text + used, sizeof said->text - used, "%s%s", used ? "\n" : "", line);
}

static void tell_all(const struct export_case *the, struct export_said *said)
{
    bool wrong = false;
    for (uint32_t i = 0; i < the->ray_count && the->here; i++)
        wrong = wrong || export_is_wrong_here(the, i);
    if (the->reference_fails)
        tell(said, "C on the same bytes is wrong, too: no driver is at fault");
    if (the->here && the->file->has_signature && !wrong)
        tell(said, "the expected failure did not occur here: every answer was right");
    if (!the->here && the->not_asked[0] && the->subject != SUBJECT_TRACER) {
        char line[240];
        snprintf(line, sizeof line, "it was not run here: %s", the->not_asked);
        tell(said, line);
    }
}

enum status export_write(const struct finding_file *file, const struct export_options *options,
                         FILE *to, struct export_said *said, struct reason *reason)
{
    struct export_case the;
    said->text[0] = '\0';
    enum status status = export_case_make(file, options, &the, reason);
    if (status)
        return status;
    tell_all(&the, said);
    switch (options->form) {
    case EXPORT_C:
        export_write_c(&the, to);
        break;
    case EXPORT_AMBER:
        export_write_amber(&the, to);
        break;
    case EXPORT_TEXT:
    case EXPORT_FORMS:
        write_text(&the, to);
        break;
    }
    export_case_free(&the);
    return STATUS_OK;
}
