/* The options of raydiff fuzz. */
#include "cmd/fuzz/cmd_fuzz.h"

#include "ref/base/command.h"

#include <stdio.h>
#include <string.h>

/* Parses "A-B" or "A/B". */
static enum status set_pair(const char *flag, const char *text, char between, uint64_t most,
                            uint64_t pair[2], struct reason *reason)
{
    char first[40];
    const char *at = strchr(text, between);
    if (!at || (size_t)(at - text) >= sizeof first)
        return fail(reason, STATUS_INPUT, "%s: '%.40s' is not two numbers with a '%c' between",
                    flag, text, between);
    snprintf(first, sizeof first, "%.*s", (int)(at - text), text);
    enum status status = parse_count(flag, first, 1, most, &pair[0], reason);
    if (!status)
        status = parse_count(flag, at + 1, 1, most, &pair[1], reason);
    if (!status && pair[0] > pair[1])
        status = fail(reason, STATUS_INPUT, "%s: %llu is more than %llu", flag,
                      (unsigned long long)pair[0], (unsigned long long)pair[1]);
    return status;
}

/* --shard I/N and --triangles A-B. */
static enum status take_pair(void *options, const struct option_value *given, struct reason *reason)
{
    struct fuzz_command *c = options;
    const bool shard = strcmp(given->row->name, "shard") == 0;
    uint64_t pair[2] = {0, 0};
    enum status status =
        shard ? set_pair("--shard", given->text, '/', CAMPAIGN_SHARDS_MOST, pair, reason)
              : set_pair("--triangles", given->text, '-', FUZZ_TRIANGLES_MOST / 4, pair, reason);
    *(shard ? &c->shard : &c->triangles_least) = (uint32_t)pair[0];
    *(shard ? &c->shards : &c->triangles_most) = (uint32_t)pair[1];
    return status;
}

static enum status take_driver(void *options, const struct option_value *given,
                               struct reason *reason)
{
    struct fuzz_command *c = options;
    if (strlen(given->text) >= sizeof c->driver)
        return fail(reason, STATUS_INPUT, "--driver: too long a name");
    strcpy(c->driver, given->text);
    return STATUS_OK;
}

static enum status take_baseline(void *options, const struct option_value *given,
                                 struct reason *reason)
{
    return baseline_add_file(&((struct fuzz_command *)options)->baseline, given->text, reason);
}

#define ROWS_OF struct fuzz_command

static const struct option_row rows[] = {
    {"time", "S", "seconds of this run", OF_COUNT(seconds, 1, 1000000000), .value = "60",
     .shown = "60; none with --trials"},
    {"trials", "N", "trials of the whole campaign, the same on any number of workers",
     OF_COUNT(trials, 1, (uint64_t)1 << 60)},
    {"until", "N", "end after N distinct findings that the baseline does not know",
     OF_COUNT(until, 1, 1000000)},
    {"dir", "DIR", "where findings are kept", OF_FOLDER(folder), .value = "findings"},
    {"seed", "S", "of the campaign", OF_COUNT(seed, 0, UINT64_MAX), .value = "1"},
    {"jobs", "N", "worker processes", OF_COUNT(jobs, 1, CAMPAIGN_JOBS_MOST), .shown = "cores"},
    {"shard", "I/N", "only the blocks of shard I of N; join with raydiff merge", OF_OWN(take_pair)},
    {"engine", "E,..", "engines, also pipe:COMMAND, FILE.so, embree:MODE and rayquery:VARIANT",
     OF_LIST(engine, TABLE_ENGINES), .shown = FUZZ_ENGINES},
    {"layout", "L,..", "layouts", OF_LIST(layout, TABLE_LAYOUTS), .shown = FUZZ_LAYOUTS},
    {"builder", "B,..", "builders", OF_LIST(builder, TABLE_BUILDERS), .shown = "as generated"},
    {"faithful", NULL, "builders and tests as published take part, too", OF_FLAG(faithful)},
    {"worlds", NULL,
     "trials of worlds in place of scenes: instances of meshes, masks, flags, filters, and rays "
     "with "
     "masks and flags",
     OF_FLAG(worlds)},
    {"steps", NULL,
     "every trial has steps: vertices move, with --worlds also instances, trees are refitted or "
     "built "
     "again, engines update what they hold; by default one in 64, with --worlds none",
     OF_FLAG(steps)},
    {"rays", "N", "rays of a trial", OF_COUNT(rays, 1, FUZZ_RAYS_MOST), .value = "500"},
    {"triangles", "A-B", "triangles of an ordinary trial", OF_OWN(take_pair), .value = "16-64"},
    {"corpus", "DIR", "trials that are played first; none", OF_FOLDER(corpus),
     .shown = "fuzz/corpus"},
    {"feedback", NULL, "mutate what reached rare states also with --trials or --shard",
     OF_FLAG(feedback)},
    {"pairs", "N",
     "draws members anew for each block: those of the pair (of engine, layout, builder, storage, "
     "triangle test, box test, reinsertion, motion) that met in the fewest trials; every pair is "
     "to meet in N",
     OF_COUNT(pairs, 1, (uint64_t)1 << 40)},
    {"turns", NULL,
     "engines that differ only in --buffers take turns in blocks of 64 trials, of eight blocks the "
     "first named has all but one for each of the others",
     OF_FLAG(turns)},
    {"no-shrink", NULL, "leave findings as they are (raydiff min shrinks them later)",
     OF_FLAG(no_shrink)},
    {"baseline", "FILE", "known findings, besides those that are part of raydiff",
     OF_OWN(take_baseline), .file = true, .repeats = true},
    {"trial-time", "S", "seconds that an engine may take for a trial", OF_REAL(trial_s, 0.1, 86400),
     .value = "10"},
    {"memory", "MIB", "memory that a worker may hold, 0 is no limit",
     OF_COUNT(memory_mib, 0, (uint64_t)1 << 30), .value = "4096"},
    {"driver", "NAME", "Vulkan: as in raydiff check", OF_OWN(take_driver)},
    {"device", "N", "Vulkan: as in raydiff check", OF_COUNT(engines.device, 0, 255)},
    {"workgroup", "N", "Vulkan: as in raydiff check", OF_COUNT(engines.workgroup, 1, 1024)},
    {"json", "FILE", "results, for machines", OF_DATA(json)},
    {"junit", "FILE", "JUnit XML", OF_WRITTEN(junit)},
    {"tap", "FILE", "TAP 13", OF_WRITTEN(tap)},
    {"jsonl", "FILE", "a line of JSON for each finding", OF_WRITTEN(jsonl)},
    {0},
};

const struct option_set fuzz_set = {
    .command = "fuzz",
    .usage = "fuzz [OPTIONS]\n"
             "fuzz --self-test [OPTIONS]     (raydiff fuzz --self-test --help)",
    .about = "Plays random trials on engines and layouts, and keeps what they get wrong: a folder "
             "for each distinct finding, with the first and the smallest trial that shows it. An "
             "existing folder is resumed, also after a kill; its campaign's options need not be "
             "given again.",
    .group = {GROUP(rows), GROUP_AT(outside_rows, engines), GROUP_AT(compiler_rows, compilers)},
    .codes = "0 nothing that the baseline does not know, 1 a finding outside it or a pair that met "
             "in fewer than --pairs, 2 bad input, 3 an engine cannot be opened, 4 internal error, "
             "77 an engine cannot run here, 128 + the signal that ended it before all of --trials "
             "were played and shrunk; run again, the campaign ends as one that nothing "
             "interrupted (with --pairs other members are drawn)",
    .example = "fuzz --time 60\n"
               "fuzz --worlds --time 60 --dir of-worlds\n"
               "fuzz --time 3600 --pairs 1000",
    .makes_folder = true,
};
