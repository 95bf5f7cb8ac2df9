/* Options as rows: one row a flag. Rows give parsing, refusals, --help, the man page and the shell
 * completions. For commands only.
 *   #define ROWS_OF struct my_options
 *   static const struct option_row rows[] = {
 *       {"count", "N", "rays", OF_COUNT(count, 1, 1u << 30), .value = "1000"},
 *       {"json", "FILE", "all rows, for machines", OF_JSON(struct my_options, json)},
 *       {0}};
 *   static const struct option_set set = {.command = "my", .group = {GROUP(rows),
 *       GROUP_AT(engine_rows, engines)}, ...};
 *   int first, code = options_read(&set, &options, argc, argv, &first); */
#ifndef CMD_ROWS_H
#define CMD_ROWS_H

#include "cmd/common/cmd_options.h"
#include "cmd/common/cmd_tables.h"

#include <stddef.h>

enum option_type {
    OPTION_FLAG,    /* no value; a bool becomes true */
    OPTION_COUNT,   /* a whole number, into 4 or 8 bytes */
    OPTION_REAL,    /* a float */
    OPTION_CHOICE,  /* a word of `choice`; its place */
    OPTION_ONE,     /* a member of a table; its place */
    OPTION_MEMBER,  /* the same; a pointer to the member */
    OPTION_LIST,    /* members of a table; a struct list */
    OPTION_TEXT,    /* kept as it is */
    OPTION_FILE,    /* a file that is read */
    OPTION_FOLDER,  /* a folder */
    OPTION_OUTPUT,  /* a file, or a name that begins those of files; not "-" */
    OPTION_WRITTEN, /* a file that is written at the end, and tried before; not "-" */
    OPTION_DATA,    /* the same; "-" is the standard output, for one of them */
    OPTION_OWN,     /* `take` reads the value */
    OPTION_ACT      /* `take` is called, there is no value */
};

struct option_row;

/* A flag as it was given. */
struct option_value {
    const struct option_row *row;
    char *text;        /* the value; NULL: none was given */
    char *const *word; /* in sets of words: all values */
    size_t count;      /* of them */
};

/* Takes an option into the struct that its rows are of. Errors: STATUS_INPUT with the flag, text and
 * rule. */
typedef enum status option_take_fn(void *options, const struct option_value *given,
                                   struct reason *reason);

struct option_row {
    const char *name; /* without dashes; NULL ends the rows */
    const char *word; /* what stands for the value in a help text; NULL: there is none */
    const char *help;
    enum option_type type;
    size_t place, size;   /* of the member */
    uint64_t least, most; /* of counts; with `words` their number, and another allowed one or 0 */
    const char *words;    /* in sets of words: what they are; NULL: `take` counts them */
    double low, high;     /* of reals */
    unsigned table;       /* enum table + 1; 0: no table */
    const char *const *choice;
    option_take_fn *take;
    const char *value; /* the default, read as if it was given; NULL: what the struct holds */
    const char *shown; /* the default in words */
    double standard;   /* the default that a 0 in the struct stands for */
    char letter;       /* a second name, as in -w; or 0 */
    bool repeats;      /* may be given more than once */
    bool optional;     /* the value may be left out */
    bool file;         /* of OPTION_OWN: the value is a file's name */
};

/* Types and places of rows. What they are of is ROWS_OF: #define ROWS_OF struct my_options */
#define OF_PLACE(of, member)                                                                       \
    .type = OPTION_##of, .place = offsetof(ROWS_OF, member), .size = sizeof(((ROWS_OF *)0)->member)
#define OF_FLAG(member)            OF_PLACE(FLAG, member)
#define OF_TEXT(member)            OF_PLACE(TEXT, member)
#define OF_FILE(member)            OF_PLACE(FILE, member)
#define OF_FOLDER(member)          OF_PLACE(FOLDER, member)
#define OF_OUTPUT(member)          OF_PLACE(OUTPUT, member)
#define OF_WRITTEN(member)         OF_PLACE(WRITTEN, member)
#define OF_DATA(member)            OF_PLACE(DATA, member)
#define OF_COUNT(member, from, to) OF_PLACE(COUNT, member), .least = from, .most = to
/* `to` INFINITY: no upper end; `from` ABOVE_0: that is the rule. */
#define OF_REAL(member, from, to)   OF_PLACE(REAL, member), .low = from, .high = to
#define OF_LIST(member, of_table)   OF_PLACE(LIST, member), .table = 1 + (of_table)
#define OF_ONE(member, of_table)    OF_PLACE(ONE, member), .table = 1 + (of_table)
#define OF_MEMBER(member, of_table) OF_PLACE(MEMBER, member), .table = 1 + (of_table)
#define OF_CHOICE(member, names)    OF_PLACE(CHOICE, member), .choice = names
#define OF_OWN(function)            .type = OPTION_OWN, .take = function
#define OF_ACT(function)            .type = OPTION_ACT, .take = function
#define ABOVE_0                     (-0.0)

/* Groups of rows: of ROWS_OF, or of a member of it. */
#define GROUP(rows)                                                                                \
    {                                                                                              \
        .row = rows                                                                                \
    }
#define GROUP_AT(rows, member)                                                                     \
    {                                                                                              \
        .row = rows, .place = offsetof(ROWS_OF, member)                                            \
    }

/* What a command takes. Texts are filled to 80 columns: each line is a paragraph, one that begins
 * with a blank stays as it is. */
struct option_set {
    const char *command;
    const char *usage; /* lines: what follows "raydiff" */
    const char *about;
    struct option_group {
        const struct option_row
            *row;     /* NULL ends the groups; of rows with one name the first counts */
        size_t place; /* of their struct in the command's */
        const char *title;
    } group[9];
    const char *notes;
    const char *codes;     /* exit codes */
    const char *example;   /* lines: what follows "raydiff" */
    option_take_fn *taken; /* called with each option that was taken; or NULL */
    void (*more)(void);    /* prints what follows in --help and the man page; or NULL */
    bool words;        /* a value is all words up to the next flag, which begins with two dashes */
    bool makes_folder; /* of its own, in which outputs may be: they are not tried */
};

/* Rows of several commands: of processors and Vulkan, of tracers and layouts from outside (both of
 * struct engine_options), of trees (struct build_options) and of demands (struct match_demands). */
extern const struct option_row engine_rows[], outside_rows[], leaf_rows[], build_rows[],
    displacement_rows[], watertight_rows[];

/* A row --seed. */
#define SEED_ROW(member)                                                                           \
    {                                                                                              \
        "seed", "S", "of rays, and of generators whose text gives none",                           \
            OF_COUNT(member, 0, UINT64_MAX), .value = "1"                                          \
    }

/* A row --bvh. */
#define TREE_ROW(member)                                                                           \
    {                                                                                              \
        "bvh", "FILE",                                                                             \
            "a tree of the scene as raydiff precompute writes it, as JSON or packed (of that "     \
            "layout), "                                                                            \
            "in place of a builder's",                                                             \
            OF_FILE(member)                                                                        \
    }

/* No thread limit, any Vulkan device. */
struct engine_options engine_options_default(void);

/* BUILD_LEAF_DEFAULT and BUILD_EPS_DEFAULT; all else as each builder has it. */
struct build_options build_options_default(void);

/* Puts the defaults of the rows into `options` and hands it every option of the command line. Returns
 * -1 to go on, with *first the index of the first argument that is no option (all others are then
 * before it); else the exit code: --help or -h was printed, or a usage error was. Files that are to
 * be written are tried (output_try). With "-" as the file of an OPTION_DATA what is printed goes to
 * the standard error output, so that what options_out writes stands alone. */
int options_read(const struct option_set *set, void *options, int argc, char **argv, int *first);

/* The row of an option, and (unless NULL) the struct that it is of; NULL: there is none. */
const struct option_row *option_find(const struct option_set *set, const char *name, void *options,
                                     void **owner);

/* Takes one option as if it was given. Errors: as options_read, in *reason. */
enum status option_put(const struct option_set *set, void *options, const char *name, char *text,
                       struct reason *reason) MUST_USE;

/* What --help prints, and what else is made of the rows. */
enum option_form { FORM_HELP, FORM_MAN, FORM_BASH, FORM_ZSH };
extern enum option_form option_form;

/* Prints text for `more`, in that form; the first line begins at column `at`. */
void options_text(const char *text, size_t at);

/* Prints the set in the form of option_form. */
void options_print(const struct option_set *set);

#endif
