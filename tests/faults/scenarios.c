#include "tests/faults/scenarios.h"

#define SMALL                                                                                      \
    " --rays 8 --triangles 1-4 --jobs 1 --corpus none --engine cpu --layout rtrs_rf --faithful"
#define PLAYED(folder, trials)                                                                     \
    "fuzz" SMALL " --seed 9 --no-shrink --dir " folder " --trials " trials
#define TREE  " soup:n=12 --engine cpu --layout f32 --tri mt --box robust --threads 1"
#define SCENE TREE " --query closest"

const struct scenario scenarios[] = {
    {.name = "fuzz", .command = PLAYED("found", "20")},
    {.name = "resume", .before = {PLAYED("found", "8")}, .command = PLAYED("found", "20")},
    {.name = "shrink", .command = "fuzz" SMALL " --seed 9 --dir found --trials 3"},
    {.name = "merge",
     .before = {PLAYED("one", "20 --shard 1/2"),
                "fuzz" SMALL " --seed 12 --no-shrink --dir two --trials 20"},
     .command = "merge --to all one two",
     .goal = "all"},
    {.name = "min", .before = {PLAYED("found", "20")}, .command = "min found --asks 40"},
    {.name = "check",
     .command = "check" SCENE " --count 20 --repeat 1 --json check.json",
     .goal = "check.json",
     .page = true},
    {.name = "conform",
     .command = "conform closest.cpu.f32.median.robust.mt.sphere.vertices.1 --count 20 --threads 1 "
                "--junit conform.xml",
     .goal = "conform.xml",
     .page = true},
    {.name = "report",
     .command = "report" SCENE " --parts check --count 20 --out report.html --json report.json",
     .goal = "report.html",
     .page = true},
    {.name = "pictures",
     .command = "report" TREE " --parts pictures --quick --out report.html --json report.json",
     .goal = "report.html",
     .page = true,
     .sample = "0:openat:*:EIO",
     .every = 4},
    {.name = "findings",
     .before = {"fuzz" SMALL " --seed 2 --no-shrink --dir found --trials 1"},
     .command = "report --findings found --out report.html --json report.json",
     .goal = "report.html",
     .page = true,
     .processes = 2,
     .sample = "1:write:*:EIO"},
};
const size_t scenario_count = sizeof scenarios / sizeof *scenarios;
