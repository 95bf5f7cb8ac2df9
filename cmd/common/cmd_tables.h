/* The tables of the product as a user names them: access to all by one switch, lists such as
 * "f32,rf16" or "all". For commands only. */
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

#define LIST_MOST 320

/* Some members of one table, by index. */
struct list {
    size_t index[LIST_MOST];
    size_t count;
    bool all, every; /* named by the word "all" or "every" */
};

/* True if the index is in the list. */
bool list_has(const struct list *list, size_t index);

/* True if the engine is in a list of TABLE_ENGINES. */
bool list_names(const struct list *list, const struct engine *engine);

/* "layouts", "engines", ... */
const char *table_name(enum table table);

/* Name of member `i`, or NULL past the end. *summary (unless NULL) becomes its description. */
const char *table_member(enum table table, size_t i, const char **summary);

/* Member `i` itself; NULL past the end, and for queries. */
const void *table_pointer(enum table table, size_t i);

/* The members that "all" stands for: of layouts those in layouts[], of other tables all. */
struct list table_all(enum table table);

/* Adds the member at that address. Adds nothing if it is NULL or not in the table, such as an
 * engine with recorded answers. */
void list_add(struct list *list, enum table table, const void *member);

/* A list of only that member; empty if list_add adds nothing. */
struct list list_of_one(enum table table, const void *member);

/* Adds the layouts from outside that `text`, the value of a --layout, names: each of the findings
 * that a command reads names its layout, so that it takes only FILE.so. Errors: those of
 * table_parse; STATUS_INPUT one is built in, or was added before. */
enum status list_bring_layouts(struct list *list, const char *text, struct reason *reason) MUST_USE;

/* Writes the listed members to `out`. */
void list_engines(const struct list *list, const struct engine *out[LIST_MOST]);
void list_layouts(const struct list *list, const struct layout *out[LIST_MOST]);

struct turnout;
/* Enters the listed members in the turnout: each must answer something. */
void list_expect(enum table table, const struct list *list, struct turnout *turnout);

/* True if an engine of the list uses trees, so that layouts and builders can answer. */
bool list_needs_trees(const struct list *engine);

/* The number of rows that a run over all these members has at most, to know how far it has come.
 * Engines without a tree have a row a triangle test. */
struct list_rows {
    const struct list *engine, *tri, *box;
    size_t trees, storages; /* builders; layouts times storages */
};
size_t list_rows(const struct list_rows *rows);

/* Enters the named engines and layouts (NULL: none was named). Layouts are entered only if an
 * engine of `playing` uses trees. */
void turnout_expect(struct turnout *turnout, const struct list *engine, const struct list *playing,
                    const struct list *layout);

/* Prints a record (screen_record) for each engine and for each other member that did not answer
 * all. */
struct screen;
void turnout_print(const struct turnout *turnout, const struct screen *screen);

/* Parses a list of names "a,b". "all" is table_all (for queries a member, not the whole table) and
 * "every" the whole table. A name with * or ? is all members that it matches. An engine
 * "pipe:COMMAND" is added to the table; a command may contain commas, but not ",pipe:". A layout
 * "PATH.so" comes from outside (ref/outside/plugin_guard.h). Errors: STATUS_INPUT an unknown name
 * (with the flag and the known names), or a member named twice; as plugin_open. */
enum status table_parse(enum table table, const char *flag, const char *text, struct list *out,
                        struct reason *reason) MUST_USE;

/* As table_parse, for exactly one name. */
enum status table_parse_one(enum table table, const char *flag, const char *text, size_t *index,
                            struct reason *reason) MUST_USE;

/* Returns "LAYOUT", or "LAYOUT:STORAGE" if the storage is neither `indexed` nor NULL, or "-"
 * without a layout. May use `text` as room for it, or return another string. */
#define STORED_NAME_MOST 160
const char *stored_name(const struct layout *layout, const struct tri_store *store,
                        char text[STORED_NAME_MOST]);

#endif
