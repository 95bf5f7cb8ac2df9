/* Options as rows: one row per flag. Rows define parsing, error messages, --help, the man page and
 * shell completions. For commands only.
 *   #define ROWS_OF struct my_options
 *   static const struct option_row rows[] = {
 *       {"count", "N", "rays", OF_COUNT(count, 1, 1u << 30), .value = "1000"},
 *       {"json", "FILE", "all rows, for machines", OF_DATA(json)},
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
    OPTION_FLAG,    /* no value; stores true in a bool */
    OPTION_COUNT,   /* a whole number; stores 4 or 8 bytes */
    OPTION_REAL,    /* a float */
    OPTION_CHOICE,  /* a word of `choice`; stores its index */
    OPTION_ONE,     /* a member of a table; stores its index */
    OPTION_MEMBER,  /* the same; stores a pointer to the member */
    OPTION_LIST,    /* members of a table; stores a struct list */
    OPTION_TEXT,    /* text; stored unchanged */
    OPTION_FILE,    /* a file to read */
    OPTION_FOLDER,  /* a folder */
    OPTION_OUTPUT,  /* a file, or a prefix of file names; not "-" */
    OPTION_WRITTEN, /* a file written at the end and tried before; not "-" */
    OPTION_DATA,    /* the same; for one of them "-" is standard output */
    OPTION_OWN,     /* `take` reads the value */
    OPTION_ACT      /* no value; `take` is called */
};

struct option_row;

/* A flag as it was given. */
struct option_value {
    const struct option_row *row;
    char *text;        /* the value; NULL: none */
    char *const *word; /* in sets with `words`: all values */
    size_t count;      /* number of values */
};

/* Stores an option in the struct of its rows. Errors: STATUS_INPUT with the flag, text and rule. */
typedef enum status option_take_fn(void *options, const struct option_value *given,
                                   struct reason *reason);

struct option_row {
    const char *name; /* without dashes; NULL ends the rows */
    const char *word; /* stands for the value in help texts; NULL: no value */
    const char *help;
    enum option_type type;
    size_t place, size;   /* offset and size of the member */
    uint64_t least, most; /* of counts; with `words` their number, and another one or 0 */
    const char *words;    /* in sets with `words`: describes them; NULL: `take` counts them */
    double low, high;     /* of reals */
    unsigned table;       /* enum table + 1; 0: no table */
    const char *const *choice;
    option_take_fn *take;
    const char *value; /* the default as text; NULL: the struct holds it */
    const char *shown; /* the default in words, for help texts */
    double standard;   /* the default that 0 in the struct stands for */
    char letter;       /* a short name, as in -w; or 0 */
    bool repeats;      /* may be given more than once */
    bool optional;     /* the value may be omitted */
    bool file;         /* for OPTION_OWN: the value is a file's name */
};

/* Types and members of rows. ROWS_OF is the struct of the members: #define ROWS_OF struct
 * my_options */
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
/* `to` INFINITY: no upper limit. `from` ABOVE_0: must be above 0. */
#define OF_REAL(member, from, to)   OF_PLACE(REAL, member), .low = from, .high = to
#define OF_LIST(member, of_table)   OF_PLACE(LIST, member), .table = 1 + (of_table)
#define OF_ONE(member, of_table)    OF_PLACE(ONE, member), .table = 1 + (of_table)
#define OF_MEMBER(member, of_table) OF_PLACE(MEMBER, member), .table = 1 + (of_table)
#define OF_CHOICE(member, names)    OF_PLACE(CHOICE, member), .choice = names
#define OF_OWN(function)            .type = OPTION_OWN, .take = function
#define OF_ACT(function)            .type = OPTION_ACT, .take = function
#define ABOVE_0                     (-0.0)

/* Groups of rows: for members of ROWS_OF, or of a struct inside it. */
#define GROUP(rows)                                                                                \
    {                                                                                              \
        .row = rows                                                                                \
    }
#define GROUP_AT(rows, member)                                                                     \
    {                                                                                              \
        .row = rows, .place = offsetof(ROWS_OF, member)                                            \
    }

/* The options and texts of a command. Texts are filled to 80 columns. Each line is a paragraph, but
 * a line that begins with a blank is not filled. */
struct option_set {
    const char *command;
    const char *usage; /* lines that follow "raydiff" */
    const char *about;
    struct option_group {
        const struct option_row
            *row;     /* NULL ends the groups; of rows with the same name the first counts */
        size_t place; /* offset of their struct in the command's */
        const char *title;
    } group[10]; /* the last one is NULL */
    const char *notes;
    const char *codes;     /* exit codes */
    const char *example;   /* lines that follow "raydiff" */
    option_take_fn *taken; /* called with each option; or NULL */
    void (*more)(void);    /* prints the end of --help and the man page; or NULL */
    bool words;        /* a value is all words up to the next flag, which begins with two dashes */
    bool makes_folder; /* makes a folder for its outputs, so these are not tried */
};

/* Rows shared by commands: for CPU and Vulkan engines, for engines and layouts from outside (both
 * in struct engine_options), for trees (struct build_options) and for demands (struct
 * match_demands). */
extern const struct option_row engine_rows[], outside_rows[], leaf_rows[], build_rows[],
    displacement_rows[], watertight_rows[];

/* A row --seed. */
#define SEED_ROW(member)                                                                           \
    {                                                                                              \
        "seed", "S", "of rays, and of generators whose text gives none",                           \
            OF_COUNT(member, 0, UINT64_MAX), .value = "1"                                          \
    }
/* The same of commands that draw no rays. */
#define SCENE_SEED_ROW(member)                                                                     \
    {                                                                                              \
        "seed", "S", "of generators whose text gives none", OF_COUNT(member, 0, UINT64_MAX),       \
            .value = "1"                                                                           \
    }

/* A row --braid, a uint32_t. */
#define BRAID_ROW(member)                                                                          \
    {                                                                                              \
        "braid", "N",                                                                              \
            "of a world: opens instances into parts until the top level has N entries for each; "  \
            "0 and 1 open none",                                                                   \
            OF_COUNT(member, 0, BRAID_MOST), .value = "0"                                          \
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

/* Default: no thread limit, any Vulkan device. */
struct engine_options engine_options_default(void);

/* Default: BUILD_LEAF_DEFAULT and BUILD_EPS_DEFAULT; all else is left to each builder. */
struct build_options build_options_default(void);

/* Stores the rows' defaults in `options`, then all options of the command line. Returns -1 to
 * continue. *first is then the index of the first argument that is no option, and all options are
 * before it. Else returns the exit code, after --help or -h or a usage error was printed. Output
 * files are tried (output_try). If the file of an OPTION_DATA is "-", everything printed goes to
 * standard error, so that standard output holds only what options_out writes. */
int options_read(const struct option_set *set, void *options, int argc, char **argv, int *first);

/* Returns the row of an option, or NULL if there is none. *owner (unless NULL) becomes the struct
 * that holds the option. */
const struct option_row *option_find(const struct option_set *set, const char *name, void *options,
                                     void **owner);

/* Stores one option as if it was given. Errors: as options_read, in *reason. */
enum status option_put(const struct option_set *set, void *options, const char *name, char *text,
                       struct reason *reason) MUST_USE;

/* The formats of options_print: --help, man page and shell completions. */
enum option_form { FORM_HELP, FORM_MAN, FORM_BASH, FORM_ZSH };
extern enum option_form option_form;

/* Prints text for `more` in the current format. The first line begins at column `at`. */
void options_text(const char *text, size_t at);

/* Prints the set in the format option_form. */
void options_print(const struct option_set *set);

#endif
