/* Texts made from a command's rows: --help, the man page and shell completions. */
#include "cmd/common/cmd_rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH      80
#define COLUMN     18     /* where the texts of options begin */
#define LABEL_MOST 26     /* longer labels get their own line */
#define RANGE_MOST 100000 /* larger ranges are not printed */

enum option_form option_form;

/* --- plain text --------------------------------------------------------------------------- */

/* Prints a paragraph that begins at column `at`, broken into lines. `end` is put before each
 * break. */
static void fill_line(const char *text, size_t length, size_t at, size_t indent, const char *end)
{
    const size_t width = WIDTH - strlen(end);
    bool first = true;
    for (size_t i = 0; i < length; i++) {
        const size_t word = strcspn(text + i, " \n");
        if (!first && at + 1 + word > width) {
            printf("%s\n%*s", end, (int)indent, "");
            at = indent;
        } else if (!first) {
            putchar(' ');
            at++;
        }
        printf("%.*s", (int)word, text + i);
        at += word;
        i += word;
        first = false;
    }
    putchar('\n');
}

/* Prints a line unchanged if it fits. Else fills the text after its first gap of two blanks, at
 * that column. */
static void keep_line(const char *text, size_t length)
{
    size_t gap = strspn(text, " ");
    while (gap < length && !(text[gap - 1] == ' ' && text[gap - 2] == ' ' && text[gap] != ' ' &&
                             gap > strspn(text, " ")))
        gap++;
    if (length <= WIDTH || gap == length) {
        printf("%.*s\n", (int)length, text);
        return;
    }
    printf("%.*s", (int)gap, text);
    fill_line(text + gap, length - gap, gap, gap, "");
}

static void print_lines(const char *text, size_t at, size_t indent)
{
    for (; text && *text; at = 0) {
        const size_t length = strcspn(text, "\n");
        if (*text == ' ')
            keep_line(text, length);
        else
            fill_line(text, length, at, indent, "");
        text += length + (text[length] == '\n');
    }
}

/* Writes the row's help text with its range and default. */
static void describe(const struct option_row *row, char *text, size_t text_bytes)
{
    char range[48] = "", standard[24];
    const char *shown = row->shown ? row->shown : row->value;
    if (row->type == OPTION_COUNT && row->most <= RANGE_MOST)
        snprintf(range, sizeof range, " (%" PRIu64 " to %" PRIu64 ")", row->least, row->most);
    else if (row->type == OPTION_REAL && isfinite(row->high))
        snprintf(range, sizeof range, " (%g to %g)", row->low, row->high);
    snprintf(standard, sizeof standard, "%g", row->standard);
    if (!shown && row->standard > 0)
        shown = standard;
    snprintf(text, text_bytes, "%s%s%s%s%s", row->help, range, shown ? " [" : "",
             shown ? shown : "", shown ? "]" : "");
}

static void help_row(const struct option_row *row, const char *text)
{
    char label[80];
    const char letter[] = {'-', row->letter, ',', ' ', '\0'};
    snprintf(label, sizeof label, "  %s--%s%s%s%s%s", row->letter ? letter : "", row->name,
             row->word ? " " : "", row->optional ? "[" : "", row->word ? row->word : "",
             row->optional ? "]" : "");
    size_t at = strlen(label);
    if (at + 1 < COLUMN)
        at += (size_t)printf("%-*s", COLUMN, label) - at;
    else if (at < LABEL_MOST)
        at = (size_t)printf("%s  ", label);
    else
        at = (size_t)(printf("%s\n%*s", label, COLUMN, "") - (int)at - 1);
    fill_line(text, strlen(text), at, COLUMN, "");
}

/* --- roff --------------------------------------------------------------------------------- */

static void roff(const char *text, size_t length, const char *end)
{
    for (size_t i = 0; i < length; i++) {
        if (i == 0 && (text[0] == '.' || text[0] == '\''))
            fputs("\\&", stdout);
        if (text[i] == '\\')
            fputs("\\e", stdout);
        else
            printf("%s%c", text[i] == '-' ? "\\" : "", text[i]);
    }
    fputs(end, stdout);
}

/* Lines that begin with a blank, or all if `kept`, are not filled. `before` is put before each line
 * that does not begin with a blank. */
static void roff_lines(const char *text, const char *before, bool kept)
{
    bool is_kept = false;
    for (; text && *text;) {
        const size_t length = strcspn(text, "\n");
        const bool keep = kept || *text == ' ';
        if (keep != is_kept)
            puts(keep ? ".PP\n.nf" : ".fi");
        if (!keep)
            puts(".PP");
        is_kept = keep;
        if (*text != ' ')
            fputs(before, stdout);
        roff(text, length, "\n");
        text += length + (text[length] == '\n');
    }
    if (is_kept)
        puts(".fi");
}

static void roff_row(const struct option_row *row, const char *text)
{
    printf(".TP\n.BI \"");
    if (row->letter)
        printf("\\-%c, ", row->letter);
    printf("\\-\\-");
    roff(row->name, strlen(row->name), row->word ? " \" \"" : "\"\n");
    if (row->word)
        roff(row->word, strlen(row->word), "\"\n");
    roff(text, strlen(text), "\n");
}

/* --- shells ------------------------------------------------------------------------------- */

static bool names_files(const struct option_row *row)
{
    return row->file || (row->type >= OPTION_FILE && row->type <= OPTION_DATA);
}

/* Prints the values that can be listed, separated by blanks. Returns false if there are none. */
static bool print_values(const struct option_row *row)
{
    const char *name;
    for (size_t i = 0; row->table && (name = table_member((enum table)(row->table - 1), i, NULL));
         i++)
        printf("%s%s", i ? " " : "", name);
    for (size_t i = 0; row->choice && row->choice[i]; i++)
        printf("%s%s", i ? " " : "", row->choice[i]);
    return row->table || row->choice;
}

static void bash_row(const struct option_row *row, const char *text)
{
    (void)text;
    printf("    options+=' --%s'\n", row->name);
    if (!row->word)
        return;
    printf("    [[ $before = --%s ]] && words=1 values='", row->name);
    print_values(row);
    printf("'%s\n", names_files(row) ? " files=1" : "");
}

static void zsh_row(const struct option_row *row, const char *text)
{
    printf("        '%s--%s[", row->repeats ? "*" : "", row->name);
    for (; *text; text++)
        printf(*text == '\'' ? "'\\''" : strchr("[]:\\", *text) ? "\\%c" : "%c", *text);
    putchar(']');
    if (row->word) {
        printf(":%s:", row->optional ? ":" : "");
        if (row->table || row->choice) {
            putchar('(');
            print_values(row);
            putchar(')');
        } else if (names_files(row)) {
            fputs("_files", stdout);
        }
    }
    puts("'");
}

/* --- all of a command --------------------------------------------------------------------- */

static void print_rows(const struct option_set *set,
                       void (*print)(const struct option_row *row, const char *text))
{
    char text[1024];
    for (const struct option_group *group = set->group; group->row; group++) {
        if (group->title && option_form == FORM_HELP)
            print_lines(group->title, 0, 0);
        if (group->title && option_form == FORM_MAN)
            roff_lines(group->title, "", false);
        for (const struct option_row *row = group->row; row->name; row++) {
            if (option_find(set, row->name, NULL, NULL) != row)
                continue;
            describe(row, text, sizeof text);
            print(row, text);
        }
    }
}

void options_text(const char *text, size_t at)
{
    if (option_form == FORM_HELP)
        print_lines(text, at, 0);
    else
        roff_lines(text, "", false);
}

/* Prints commands: each line follows "raydiff", unless it begins with a blank and continues the
 * line before. */
static void print_commands(const char *first, const char *then, const char *end, const char *lines)
{
    for (const char *head = first; *lines; head = then) {
        const size_t length = strcspn(lines, "\n");
        const size_t at = *lines == ' ' ? 0 : (size_t)printf("%sraydiff ", head);
        fill_line(lines, length, at, strlen(first) + 4, end);
        lines += length + (lines[length] == '\n');
    }
}

static void print_help(const struct option_set *set)
{
    print_commands("usage: ", "       ", "", set->usage);
    print_lines(set->about, 0, 0);
    putchar('\n');
    print_rows(set, help_row);
    putchar('\n');
    print_lines(set->notes, 0, 0);
    fputs("exit codes: ", stdout);
    print_lines(set->codes, strlen("exit codes: "), strlen("exit codes: "));
    print_commands("example: ", "example: ", " \\", set->example);
    if (set->more)
        set->more();
}

static void print_man(const struct option_set *set)
{
    puts(".SH SYNOPSIS");
    roff_lines(set->usage, "raydiff ", true);
    puts(".SH DESCRIPTION");
    roff_lines(set->about, "", false);
    puts(".SH OPTIONS");
    print_rows(set, roff_row);
    if (set->notes) {
        puts(".SH NOTES");
        roff_lines(set->notes, "", false);
    }
    puts(".SH EXIT STATUS");
    roff_lines(set->codes, "", false);
    puts(".SH EXAMPLES");
    roff_lines(set->example, "raydiff ", true);
    if (set->more) {
        puts(".SH MORE\n.nf");
        set->more();
        puts(".fi");
    }
}

void options_print(const struct option_set *set)
{
    switch (option_form) {
    case FORM_HELP:
        print_help(set);
        return;
    case FORM_MAN:
        print_man(set);
        return;
    case FORM_BASH:
        printf("%s)\n", set->command);
        print_rows(set, bash_row);
        puts("    options+=' --help' ;;&");
        return;
    case FORM_ZSH:
        printf("    (%s) specs+=(\n", set->command);
        print_rows(set, zsh_row);
        puts("        '--help[what the command does]') ;|");
        return;
    }
}
