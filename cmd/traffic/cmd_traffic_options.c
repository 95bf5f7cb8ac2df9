/* Options of raydiff bench traffic. */
#include "cmd/traffic/cmd_traffic.h"

#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/nearest_name.h"

#include <stdlib.h>
#include <string.h>

/* Reads "4096", "32k", "1m" or "1g". */
static enum status parse_bytes(const char *flag, const char *text, size_t length, uint64_t most,
                               uint64_t *out, struct reason *reason)
{
    static const struct {
        char letter;
        uint64_t times;
    } unit[] = {{'k', 1u << 10}, {'m', 1u << 20}, {'g', 1u << 30}};
    char digits[24];
    uint64_t times = 1;
    for (size_t i = 0; i < ARRAY_COUNT(unit); i++)
        if (length > 1 && text[length - 1] == unit[i].letter)
            times = unit[i].times;
    if (times > 1)
        length--;
    if (length >= sizeof digits)
        return fail(reason, STATUS_INPUT, "%s: '%.40s' is too long a number", flag, text);
    snprintf(digits, sizeof digits, "%.*s", (int)length, text);
    enum status status = parse_count(flag, digits, 0, most / times, out, reason);
    *out = status ? 0 : *out * times;
    return status;
}

/* Reads BYTES:WAYS:LINE. */
static enum status take_cache(struct traffic_cache_size *out, const char *flag, const char *text,
                              struct reason *reason)
{
    uint64_t value[3];
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        size_t length = strcspn(at, ":");
        if (length == 0 || (at[length] == ':') != (i < 2))
            return fail(reason, STATUS_INPUT, "%s: '%.40s' is not BYTES:WAYS:LINE", flag, text);
        enum status status =
            parse_bytes(flag, at, length, i ? 1u << 20 : 1u << 30, &value[i], reason);
        if (status)
            return status;
        at += length + 1;
    }
    *out = (struct traffic_cache_size){
        .bytes = value[0], .ways = (uint32_t)value[1], .line = (uint32_t)value[2]};
    return STATUS_OK;
}

static enum status take_l1(void *options, const struct option_value *given, struct reason *reason)
{
    struct traffic_options *o = options;
    return take_cache(&o->machine.memory.cache[0], "--private", given->text, reason);
}

static enum status take_l2(void *options, const struct option_value *given, struct reason *reason)
{
    struct traffic_options *o = options;
    return take_cache(&o->machine.memory.cache[1], "--shared", given->text, reason);
}

static enum status take_row(void *options, const struct option_value *given, struct reason *reason)
{
    struct traffic_options *o = options;
    uint64_t bytes;
    enum status status =
        parse_bytes("--row", given->text, strlen(given->text), 1u << 30, &bytes, reason);
    o->machine.memory.row_bytes = (uint32_t)bytes;
    return status;
}

static enum status take_treelet(void *options, const struct option_value *given,
                                struct reason *reason)
{
    struct traffic_options *o = options;
    return parse_bytes("--treelet", given->text, strlen(given->text), 1u << 30, &o->machine.treelet,
                       reason);
}

static enum status unknown(const char *name, struct reason *reason)
{
    char known[200] = "", hint[NEAREST_HINT];
    size_t used = 0;
    struct nearest_name nearest = nearest_make(name, strlen(name));
    for (size_t i = 0; schedulers[i] && used < sizeof known; i++) {
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "",
                                 schedulers[i]->name);
        nearest_try(&nearest, schedulers[i]->name);
    }
    return fail(reason, STATUS_INPUT, "--scheduler: unknown scheduler '%.40s'; there are: %s%s",
                name, known, nearest_hint(&nearest, hint));
}

static enum status take_scheduler(void *options, const struct option_value *given,
                                  struct reason *reason)
{
    struct traffic_options *o = options;
    o->scheduler_count = 0;
    if (strcmp(given->text, "all") == 0)
        return STATUS_OK;
    for (char *at = strtok(given->text, ","); at; at = strtok(NULL, ",")) {
        const struct scheduler *one = scheduler_find(at);
        if (!one)
            return unknown(at, reason);
        for (size_t i = 0; i < o->scheduler_count; i++)
            if (o->scheduler[i] == one)
                return fail(reason, STATUS_INPUT, "--scheduler: '%s' is named twice", at);
        o->scheduler[o->scheduler_count++] = one;
    }
    return o->scheduler_count ? STATUS_OK
                              : fail(reason, STATUS_INPUT, "--scheduler: names no scheduler");
}

static enum status take_depths(void *options, const struct option_value *given,
                               struct reason *reason)
{
    struct traffic_options *o = options;
    o->depth_count = 0;
    for (char *at = strtok(given->text, ","); at; at = strtok(NULL, ",")) {
        uint64_t depth;
        enum status status = parse_count("--depths", at, 1, TRAFFIC_DEPTH_MOST, &depth, reason);
        if (status)
            return status;
        if (o->depth_count == TRAFFIC_DEPTHS_MOST)
            return fail(reason, STATUS_INPUT, "--depths: at most %d depths", TRAFFIC_DEPTHS_MOST);
        o->depth[o->depth_count++] = (uint32_t)depth;
    }
    return o->depth_count ? STATUS_OK : fail(reason, STATUS_INPUT, "--depths: names no depth");
}

#define ROWS_OF struct traffic_options

const struct option_row traffic_rows[] = {
    {"scheduler", "S,..", "of benchmark traffic, or 'all'", OF_OWN(take_scheduler), .shown = "all"},
    {"depths", "N,..", "most rays of a path, 1 to 64", OF_OWN(take_depths), .shown = "1"},
    {"units", "N", "each has a level 1 of its own; of mach_rt the chips",
     OF_COUNT(machine.memory.units, 1, TRAFFIC_UNITS_MOST), .standard = 4},
    {"lanes", "N", "rays that a unit traces in turn",
     OF_COUNT(machine.lanes, 1, TRAFFIC_LANES_MOST), .standard = 8},
    {"packet", "N", "rays of a packet", OF_COUNT(machine.packet, 1, TRAFFIC_PACKET_MOST),
     .standard = 32},
    {"treelet", "B", "most bytes of a treelet, as 4096, 4k, 1m", OF_OWN(take_treelet),
     .shown = "16k"},
    {"queue", "N", "rays in queues at a time; of mach_rt on each chip",
     OF_COUNT(machine.queue, 1, 1u << 28), .standard = 65536},
    {"private", "B:W:L", "level 1, one a unit: bytes, ways, bytes of a line", OF_OWN(take_l1),
     .shown = "32k:8:64"},
    {"shared", "B:W:L", "level 2, of all units", OF_OWN(take_l2), .shown = "512k:16:64"},
    {"row", "B", "bytes of a row of DRAM", OF_OWN(take_row), .shown = "2k"},
    {0},
};

enum status traffic_options_used(const struct traffic_options *options, struct reason *reason)
{
    static const char *const some[] = {"units", "lanes",   "packet", "treelet",
                                       "queue", "private", "layout", "store"};
    for (size_t i = 0; i < ARRAY_COUNT(some); i++) {
        bool used = options->scheduler_count == 0;
        for (size_t s = 0; s < options->scheduler_count; s++)
            used = used || option_among(options->scheduler[s]->uses, some[i]);
        if (option_was_given(some[i]) && !used)
            return fail(reason, STATUS_INPUT, "--%s: not used by the schedulers named", some[i]);
    }
    return STATUS_OK;
}

struct traffic_options traffic_options_default(void)
{
    return (struct traffic_options){
        .machine = {.memory = {.cache = {{32u << 10, 8, 64}, {512u << 10, 16, 64}},
                               .units = 4,
                               .row_bytes = 2048},
                    .lanes = 8,
                    .packet = 32,
                    .treelet = 16u << 10,
                    .queue = 65536}};
}
