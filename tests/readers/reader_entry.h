/* The readers under fuzzing: every reader of what comes from outside has an entry point of its own,
 * a program of entry_NAME.c, harness.c and the library. libFuzzer or AFL++ drives it, or main.c,
 * which feeds it files. Whatever the bytes, an entry must
 *   - keep the promises of the reader's header, which its `play` checks,
 *   - hold no more memory at a time than READER_TIMES times the input and a fixed amount,
 *   - hold none of it afterwards,
 * or the program aborts with a line that says which. Sanitizers and the driver see to the rest. */
#ifndef READER_ENTRY_H
#define READER_ENTRY_H

#include "ref/base/base.h"
#include "ref/scene/scene.h"
#include "ref/world/world.h"

#define READER_TIMES 64u

struct reader_entry {
    const char *name;
    size_t fixed; /* bytes that may be held beyond READER_TIMES times the input, or READER_ANY */
    /* One input; bytes[size] is 0. Returns whether the reader took it. */
    bool (*play)(const char *bytes, size_t size);
};

#define READER_ANY SIZE_MAX

/* Each entry_NAME.c defines it. */
extern const struct reader_entry reader_entry;

/* What drives an entry: libFuzzer's interface. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What the entry has seen so far. */
struct reader_tally {
    uint64_t inputs, taken;
    uint64_t slowest_ns;
    size_t slowest_size; /* of that input */
    size_t most;         /* bytes held at a time, and by which size of input */
    size_t most_size;
    double times; /* most bytes held over the size, of inputs of READER_TIMES_LEAST bytes or more */
    double share; /* most bytes held over what may be held; at most 1 */
};

/* Shorter inputs are left out of `times`: buffers of a fixed size would be all of it. */
#define READER_TIMES_LEAST 1024u

const struct reader_tally *reader_tally(void);

/* A line "reader NAME inputs N taken N slowest S ms ..." */
void reader_say(void);

/* Aborts if `holds` is false. */
#define READER_MUST(holds) ((holds) ? (void)0 : reader_broken(#holds, __FILE__, __LINE__))
_Noreturn void reader_broken(const char *rule, const char *file, int line);

/* Of a refusal: one printable line, not empty. */
void reader_must_be_reason(const struct reason *reason);

/* A scene that a reader let through: scene_check accepts it, and it survives writing as PLY and
 * reading back to the bit. */
void reader_must_be_scene(const struct scene *scene);

/* The whole of an entry for a reader of meshes: what it takes is a scene, what it refuses has a
 * reason. Returns whether it took it. */
bool reader_play_mesh(enum status (*read)(const char *name, const char *bytes, size_t size,
                                          struct scene *out, struct reason *reason),
                      const char *bytes, size_t size);

/* What a reader of worlds gave: a world that world_finish accepts, which survives writing as world
 * JSON, and as glTF where that can hold it, to the bit; or nothing, and a reason. */
void reader_must_be_world(enum status status, const struct world *world,
                          const struct reason *reason);

/* What --bvh does with a tree from outside, JSON or packed: a tree that `readable` (its reader lets
 * it through) is taken, or refused as another scene's; one that is not is refused. What is taken
 * decodes to a tree, or says why not. */
void reader_must_be_tree_file(const char *bytes, size_t size, const struct scene *scene,
                              bool readable);

/* An anonymous file that holds the bytes; its path is written to `path`. The caller closes the
 * descriptor. */
#define READER_PATH_MOST 40
int reader_file(const char *bytes, size_t size, char path[READER_PATH_MOST]);

/* Counting of what a thread allocates (count.c). Between begin and end a block beyond `most`, or
 * more than that held at a time, aborts. */
void reader_count_begin(size_t most);
void reader_count_end(size_t *most_held, ptrdiff_t *left);
/* What an entry itself holds to check a reader is not the reader's: false, and true again. */
void reader_count_limit(bool on);
/* True if this build can count at all. */
bool reader_counts(void);

#endif
