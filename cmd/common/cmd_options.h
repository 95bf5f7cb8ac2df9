/* Options that several commands take alike. For commands only. */
#ifndef CMD_OPTIONS_H
#define CMD_OPTIONS_H

#include "ref/match/match.h"
#include "ref/files/file.h"

#include <getopt.h>

enum {
    OPT_THREADS = 1024,
    OPT_DRIVER,
    OPT_DEVICE,
    OPT_WORKGROUP,
    OPT_PEER_TIME,
    OPT_PEER_MEMORY,
    OPT_SHADER,
    OPT_BVH, /* see cmd/common/cmd_tree.h */
    OPT_BINS,
    OPT_RADIUS,
    OPT_SPLIT_BUDGET,
    OPT_SPLIT_ALPHA,
    OPT_OPTIMIZE,
    OPT_DISPLACEMENT,
    OPT_DEMAND,
    OPT_HELP
};

/* Entries of a getopt_long table; OPT_HELP ends it. */
#define ENGINE_OPTIONS                                                                             \
    {"threads", 1, NULL, OPT_THREADS}, {"driver", 1, NULL, OPT_DRIVER},                            \
        {"device", 1, NULL, OPT_DEVICE}, {"workgroup", 1, NULL, OPT_WORKGROUP},                    \
        {"peer-time", 1, NULL, OPT_PEER_TIME}, {"peer-memory", 1, NULL, OPT_PEER_MEMORY},          \
        {"shader", 1, NULL, OPT_SHADER}, {"help", 0, NULL, OPT_HELP},                              \
    {                                                                                              \
        NULL, 0, NULL, 0                                                                           \
    }

/* What they mean, for the end of a help text. */
#define ENGINE_OPTIONS_HELP                                                                        \
    "  --threads N     CPU threads, 0 is all                                     [0]\n"            \
    "  --driver NAME   Vulkan: stock, mesa25, swiftshader (make drivers), hardware, a driver's\n"  \
    "                  JSON file, or part of a driver's or device's name\n"                        \
    "  --device N      Vulkan: device by the number that raydiff doctor gives\n"                   \
    "  --workgroup N   Vulkan: rays per workgroup                                [64]\n"           \
    "  --peer-time S   pipe:COMMAND: seconds that it may take for a request; --layout FILE.so:\n"  \
    "                  for packing a tree                                        [60]\n"           \
    "  --peer-memory M their address space in MB, 0 is no limit                  [8192]\n"         \
    "  --shader FILE   GLSL of a layout from outside, --layout FILE.so, for engine vulkan\n"

/* How trees are built beyond builder, leaf size and eps: entries of a getopt_long table, before
 * ENGINE_OPTIONS, and what they mean. */
#define BUILD_OPTIONS                                                                              \
    {"bins", 1, NULL, OPT_BINS}, {"radius", 1, NULL, OPT_RADIUS},                                  \
        {"split-budget", 1, NULL, OPT_SPLIT_BUDGET}, {"split-alpha", 1, NULL, OPT_SPLIT_ALPHA},    \
    {                                                                                              \
        "optimize", 1, NULL, OPT_OPTIMIZE                                                          \
    }

#define BUILD_OPTIONS_HELP                                                                         \
    "  --bins N        builder sah_binned: bins per axis, 2 to 64                [16]\n"           \
    "  --radius N      builder ploc: neighbours on either side, 1 to 256         [16]\n"           \
    "  --split-budget X  builder sbvh: items beyond one a triangle, at most, in parts of these\n"  \
    "                                                                            [1]\n"            \
    "  --split-alpha X builder sbvh: overlap of children in parts of the root's area from which\n" \
    "                  on planes are tried                                       [1e-5]\n"         \
    "  --optimize O    reinsert or reinsert=N: move subtrees of what a builder made to where "     \
    "they\n"                                                                                       \
    "                  cost less, N (4) times over the tree\n"

/* Takes one of BUILD_OPTIONS; *flag (may be NULL) becomes its name. Errors: STATUS_INPUT with the
 * flag, text and rule. */
enum status build_option_take(int option, const char *text, struct build_options *out,
                              const char **flag, struct reason *reason) MUST_USE;

/* No thread limit, any Vulkan device. */
struct engine_options engine_options_default(void);

/* Takes one of ENGINE_OPTIONS. Errors: STATUS_INPUT with the flag, text and range; also for any
 * other option, which the caller must have handled. */
enum status engine_option_take(int option, const char *text, struct engine_options *out,
                               struct reason *reason) MUST_USE;

/* What --require of a row may name: "watertight", no hit lost inside a closed fan. Errors:
 * STATUS_INPUT for anything else. */
enum status require_watertight(const char *text, struct reason *reason) MUST_USE;

/* What is demanded of answers (ref/match/match.h): entries of a getopt_long table. */
#define DEMAND_OPTIONS                                                                             \
    {"displacement", 1, NULL, OPT_DISPLACEMENT},                                                   \
    {                                                                                              \
        "require", 1, NULL, OPT_DEMAND                                                             \
    }

/* Takes one of DEMAND_OPTIONS. Errors: STATUS_INPUT with the flag, text and rule. */
enum status demand_take(int option, const char *text, struct match_demands *out,
                        struct reason *reason) MUST_USE;

/* Takes one option of a command into `user`. Errors: STATUS_INPUT with the flag, text and rule. */
typedef enum status option_fn(void *user, int option, char *text, struct reason *reason);

/* Hands every option of the command line to `take`. Returns -1 to go on, with *first the index of
 * the first argument that is no option; else the exit code: --help (OPT_HELP in the table, or -h)
 * was printed by `print_help`, or a usage error was. Files that are to be written (--json, --csv
 * and the like) are tried (output_try). With `--json -` or `--csv -` what is printed goes to the
 * standard error output, so that what options_out writes stands alone; other files cannot be "-".
 */
int options_take(const char *command, void (*print_help)(void), const struct option *table,
                 option_fn *take, void *user, int argc, char **argv, int *first);

/* Name of the i-th option that the last options_take was given, without dashes and each once; NULL
 * past the end. */
const char *option_given(size_t i);

/* Whether that option was given. */
bool option_was_given(const char *name);

/* For those that read command lines: forgets what was given; notes that an option was, which is an
 * error the second time unless it repeats; notes an output, and tries
 * all that were noted; puts what is printed on the standard error output from here on, for "-"; and
 * prints why an option is wrong, and returns the exit code. */
void options_begin(void);
enum status option_note(const char *name, bool repeats, struct reason *reason) MUST_USE;
void output_note(const char *path);
enum status outputs_try(struct reason *reason) MUST_USE;
enum status output_aside(struct reason *reason) MUST_USE;
int option_error(const char *command, enum status status, const struct reason *reason);

/* Proves that a file can be written, before work is done for it: what is there stays as it is, and
 * nothing is left behind. What is no regular file is not opened. Errors: as file_out_open. */
enum status output_try(const char *path, struct reason *reason) MUST_USE;

/* Opens the file of an option: `path`, or for "-" what was the standard output, once. Errors: as
 * file_out_open. */
enum status options_out(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

#endif
