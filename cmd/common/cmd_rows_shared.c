/* Options that several commands share. */
#include "cmd/common/cmd_rows.h"

#include "ref/outside/plugin_guard.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"

#include <math.h>
#include <string.h>

struct engine_options engine_options_default(void)
{
    return (struct engine_options){.device = -1};
}

struct build_options build_options_default(void)
{
    return (struct build_options){.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
}

#define ROWS_OF struct engine_options

const struct option_row engine_rows[] = {
    {"threads", "N", "CPU threads, 0 is all", OF_COUNT(threads, 0, 4096), .value = "0"},
    {"driver", "NAME",
     "Vulkan: stock, mesa25, swiftshader (make drivers), hardware, a driver's JSON file, or part "
     "of "
     "a driver's or device's name",
     OF_TEXT(driver)},
    {"device", "N", "Vulkan: device by the number that raydiff doctor gives",
     OF_COUNT(device, 0, 255)},
    {"workgroup", "N", "Vulkan: rays per workgroup", OF_COUNT(workgroup, 1, 1024),
     .standard = ABI_WORKGROUP},
    {0},
};

static enum status take_peer(void *options, const struct option_value *given, struct reason *reason)
{
    struct engine_options *o = options;
    const bool time = strcmp(given->row->name, "peer-time") == 0;
    uint64_t n = 0;
    enum status status = parse_count(time ? "--peer-time" : "--peer-memory", given->text, time,
                                     time ? 86400 : 1u << 24, &n, reason);
    if (time)
        o->peer_ms = (uint32_t)(1000 * n);
    else
        o->peer_mb = n ? (uint32_t)n : UINT32_MAX;
    plugin_limits(o->peer_ms, o->peer_mb);
    return status;
}

static enum status take_shader(void *options, const struct option_value *given,
                               struct reason *reason)
{
    (void)options;
    struct reason why = {""};
    enum status status = plugin_shader_take(given->text, &why);
    const bool named = strncmp(why.text, "--shader", 8) == 0;
    return status ? fail(reason, status, "%s%s", named ? "" : "--shader: ", why.text) : STATUS_OK;
}

const struct option_row outside_rows[] = {
    {"peer-time", "S",
     "seconds that pipe:COMMAND, webgpu or an engine FILE.so may take for a request, and a layout "
     "FILE.so "
     "for packing a tree",
     OF_OWN(take_peer), .standard = PLUGIN_MS / 1e3},
    {"peer-memory", "M", "their address space in MB, 0 is no limit", OF_OWN(take_peer),
     .standard = PLUGIN_MB},
    {"shader", "FILE", "GLSL of a layout from outside, --layout FILE.so, for engine vulkan",
     OF_OWN(take_shader), .file = true, .repeats = true},
    {0},
};

/* Stores a 0 as -1, since 0 in the options stands for the default. */
static enum status take_share(void *options, const struct option_value *given,
                              struct reason *reason)
{
    struct build_options *o = options;
    const bool alpha = strcmp(given->row->name, "split-alpha") == 0;
    const char *flag = alpha ? "--split-alpha" : "--split-budget";
    const float most = alpha ? 1 : BUILD_SPLIT_BUDGET_MOST;
    float x = 0;
    enum status status = parse_float(flag, given->text, &x, reason);
    if (!status && !(x >= 0 && x <= most))
        status = fail(reason, STATUS_INPUT, "%s: '%.60s' is not a number from 0 to %g", flag,
                      given->text, (double)most);
    *(alpha ? &o->split_alpha : &o->split_budget) = x > 0 ? x : -1;
    return status;
}

static enum status take_optimize(void *options, const struct option_value *given,
                                 struct reason *reason)
{
    struct build_options *o = options;
    const size_t length = strcspn(given->text, "=");
    uint64_t n = BUILD_PASSES_DEFAULT;
    enum status status = STATUS_OK;
    o->rotates = strncmp(given->text, "rotate", length) == 0;
    if (strlen(build_optimization(o)) != length ||
        strncmp(given->text, build_optimization(o), length) != 0)
        return fail(reason, STATUS_INPUT,
                    "--optimize: '%.60s' is not reinsert, reinsert=N, rotate or rotate=N",
                    given->text);
    if (given->text[length] == '=')
        status = parse_count("--optimize", given->text + length + 1, 1, 1000, &n, reason);
    o->passes = (uint32_t)n;
    return status;
}

#undef ROWS_OF
#define ROWS_OF struct build_options

const struct option_row leaf_rows[] = {
    {"leaf", "N", "items per leaf, 1 or more", OF_COUNT(leaf, 1, 1u << 20),
     .standard = BUILD_LEAF_DEFAULT},
    {"eps", "E", "builder rtrs: smallest box that is split", OF_REAL(eps, -INFINITY, INFINITY),
     .standard = BUILD_EPS_DEFAULT},
    {0},
};

const struct option_row build_rows[] = {
    {"bins", "N", "builder sah_binned: bins per axis", OF_COUNT(bins, 2, BUILD_BINS_MOST),
     .standard = BUILD_BINS_DEFAULT},
    {"radius", "N", "builders ploc, ploctree: neighbours on either side",
     OF_COUNT(radius, 1, BUILD_RADIUS_MOST), .standard = BUILD_RADIUS_DEFAULT},
    {"split-budget", "X",
     "builder sbvh: items beyond one a triangle, at most, in parts of the triangles",
     OF_OWN(take_share), .standard = BUILD_SPLIT_BUDGET_DEFAULT},
    {"split-alpha", "X",
     "builder sbvh: planes are tried where children overlap in at least this part of the root's "
     "area",
     OF_OWN(take_share), .standard = BUILD_SPLIT_ALPHA_DEFAULT},
    {"presplit", "X",
     "builders that do not split themselves: items beyond one a triangle, at most, in parts of the "
     "triangles, by cuts before the build",
     OF_REAL(presplit, 0, BUILD_PRESPLIT_MOST), .value = "0"},
    {"optimize", "O",
     "reinsert or reinsert=N: moves subtrees of what a builder made to where they cost less, N (4) "
     "times over the tree; rotate or rotate=N: exchanges children with grandchildren, likewise",
     OF_OWN(take_optimize)},
    {0},
};

static enum status take_require(void *options, const struct option_value *given,
                                struct reason *reason)
{
    ((struct match_demands *)options)->watertight = true;
    return strcmp(given->text, "watertight") == 0
               ? STATUS_OK
               : fail(reason, STATUS_INPUT, "--require: '%.60s' is not watertight", given->text);
}

#undef ROWS_OF
#define ROWS_OF struct match_demands

const struct option_row displacement_rows[] = {
    {"displacement", "U",
     "how far vertices may have to move to make an answer of an unknown formula right, in 2^-24 of "
     "their distance",
     OF_REAL(displacement, ABOVE_0, INFINITY), .standard = JUDGE_DISPLACEMENT_MOST},
    {0},
};

const struct option_row watertight_rows[] = {
    {"require", "watertight",
     "no hit inside a closed fan may be lost, by any engine; without it only by those that promise "
     "so. Of closest and any hits",
     OF_OWN(take_require)},
    {0},
};
