/* The tables of the product as a user names them: one switch that knows them all, lists like
 * "f32,rf16" or "all", and progress on the terminal. For commands only. */
#ifndef CMD_TABLES_H
#define CMD_TABLES_H

#include "ref/base/base.h"

struct engine;
struct layout;
struct tri_store;

enum table {
    TABLE_BUILDERS,
    TABLE_LAYOUTS,
    TABLE_BOX_TESTS,
    TABLE_TRI_TESTS,
    TABLE_QUERIES,
    TABLE_ENGINES,
    TABLE_GENERATORS,
    TABLE_RAY_SETS,
    TABLE_STORES,
    TABLE_COUNT
};

#define LIST_MOST 256

/* Some members of one table, by index. */
struct list {
    size_t index[LIST_MOST];
    size_t count;
    bool all, every; /* named by that word */
};

/* Whether a place of a table is in a list. */
bool list_has(const struct list *list, size_t index);

/* Whether an engine is in a list of TABLE_ENGINES. */
bool list_names(const struct list *list, const struct engine *engine);

/* "layouts", "engines", ... */
const char *table_name(enum table table);

/* Name of member `i`, or NULL past the end; *summary (may be NULL) is what it is. */
const char *table_member(enum table table, size_t i, const char **summary);

/* Member `i` itself; NULL past the end, and of queries. */
const void *table_pointer(enum table table, size_t i);

/* The members that products run over: of layouts those of layouts[], of the others all. */
struct list table_all(enum table table);

/* Adds the member at that address; nothing if the table lacks it, as an engine whose answers were
 * recorded, or if it is NULL. */
void list_add(struct list *list, enum table table, const void *member);

/* A list of that member alone, or an empty one. */
struct list list_of_one(enum table table, const void *member);

/* Puts the listed members into `out`. */
void list_engines(const struct list *list, const struct engine *out[LIST_MOST]);
void list_layouts(const struct list *list, const struct layout *out[LIST_MOST]);

struct turnout;
/* Enters the members of a list in the turnout: each must answer something. */
void list_expect(enum table table, const struct list *list, struct turnout *turnout);

/* True if an engine of the list plays on trees, so that layouts and builders can answer. */
bool list_needs_trees(const struct list *engine);

/* Enters the named engines and layouts (NULL: none was named). Layouts are entered only if an engine
 * of `playing` needs trees. */
void turnout_expect(struct turnout *turnout, const struct list *engine, const struct list *playing,
                    const struct list *layout);

/* Prints a line for each engine and for each other member that did not answer all. */
void turnout_print(const struct turnout *turnout);

/* Parses "a,b" or "all", which is table_all (of queries one member, not the whole table); "every"
 * is the whole table, and a name with * or ? all members that it matches. Of engines,
 * "pipe:COMMAND" is one, too, and is then in the table; a command may hold commas, but not
 * ",pipe:". Of layouts, "PATH.so" is one from outside (ref/outside/plugin_guard.h). Errors: STATUS_INPUT
 * with the flag, the unknown name and the known ones; a member named twice; as plugin_open. */
enum status table_parse(enum table table, const char *flag, const char *text, struct list *out,
                        struct reason *reason) MUST_USE;

/* As table_parse, for exactly one name. */
enum status table_parse_one(enum table table, const char *flag, const char *text, size_t *index,
                            struct reason *reason) MUST_USE;

/* "LAYOUT", or "LAYOUT:STORAGE" where that is not `indexed` (nor NULL); "-" for no layout. `text`
 * is room for it; what is returned may be another. */
#define STORED_NAME_MOST 160
const char *stored_name(const struct layout *layout, const struct tri_store *store,
                        char text[STORED_NAME_MOST]);

/* Prints progress to stderr, once something has taken 2 seconds: on a terminal one line
 * that is overwritten, else a line every 10 seconds. */
struct progress {
    const char *command;
    uint64_t start_ns, last_ns;
    bool terminal, shown;
};

struct progress progress_make(const char *command);
void progress_step(struct progress *progress, const char *format, ...) PRINTF_LIKE(2, 3);
/* Wipes the line. */
void progress_end(struct progress *progress);

#endif
