# make check and its slower sisters.
.PHONY: check rooms-graph agree conform-all deep slow sanitize-check tsan-check validate-check validate-gpu-check drivers \
        mutants lint fuzz-files fuzz-afl fuzz-oss readers-engine honest leaks bounds parallel-check slurm-check \
        report-check selftest selftest-quick fresh-check arm-check warnings-check adversaries

check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all tests
	@sh tests/run.sh $(B)

# More Vulkan drivers that need no GPU, fetched beside the system's; exit code 77: not to be had.
drivers:
	@sh .ci/drivers.sh $(OUT)/drivers

# The README's two commands in a minimal system of each release of Debian that is supported, or of
# RELEASE=trixie; as root; exit code 77: it cannot be tried here. A line for each that passes goes into tests/fresh.txt. Slow.
fresh-check:
	@sh .ci/fresh.sh tests/fresh.txt $(RELEASE)

# The same way, in the release that has it: suites compiled for aarch64, under qemu-user; every compiler that
# is supported, without a warning.
arm-check:
	@sh .ci/other.sh tests/fresh.txt aarch64
warnings-check:
	@sh .ci/other.sh tests/fresh.txt warnings

# Everybody against everybody, 300,000 rays a scene; the result is committed. Slow.
RESULTS ?= bench/results/lavapipe-22.3.6
agree: all
	sh tests/scripts/agree.sh $(B) full $(RESULTS)/agree

# The conformance suite, every combination of members once. Slow.
conform-all: all
	$(B)/raydiff conform --all $(ARGS)

# Dishonest tracers on a large mesh: what each uses up, and what it gets away with.
adversaries: tests
	RAYDIFF_ADVERSARIES=$(or $(SCENE),scenes/fetched/dragon-203k.ply.gz) $(B)/tests/test_adversaries

# Rays at edges and vertices of closed meshes from inside, 10^6 a mesh, on each CPU driver.
leaks: all
	sh tests/scripts/leaks.sh $(B) $(RESULTS)/leaks

# Every system call of campaigns, merges, shrinkings, checks and reports fails once in each of its ways. ARGS:
# '-n merge' one command, '-o 0:openat:3:EIO' one fault, '-s 10' each tenth. Exit code 77: processes may not be traced here.
.PHONY: faults
faults: all
	@sh tests/scripts/faults.sh $(B)/raydiff $(or $(ARGS),-s 1)

# The recipes for many machines, with what they need from Debian; exit code 77: not to be had.
recipe_check = sh .ci/deps.sh $(1) || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }; \
    $(MAKE) --no-print-directory -s -j$(JOBS) all && sh tests/scripts/$(1).sh $(B)
parallel-check:
	@$(call recipe_check,parallel)
slurm-check:
	@$(call recipe_check,slurm)

# A report in headless Chromium; build/report has it with its screenshot. Exit code 77: not to be had.
report-check:
	@sh .ci/deps.sh report || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }
	@$(MAKE) --no-print-directory -s -j$(JOBS) all
	@sh tests/scripts/report_browser.sh $(B)/raydiff $(B)/report

# Is every planted bug found by the fuzzer? All, and some of every kind.
selftest:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted
	$(B)/raydiff fuzz --self-test $(ARGS)
selftest-quick:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted-quick
	$(B)/raydiff fuzz --self-test --only $(QUICK_NAMES) $(ARGS)

mutants: all tests
	@CC_CMD='$(subst ',,$(CC) $(CPPFLAGS) $(CFLAGS))' LIBS='$(LDLIBS) $(PROGRAM_LIBS)' TOOL_SRC='$(TOOL_SRC)' \
	    sh tests/planted/run.sh $(B) $(ONLY)

# The picture of docs/rooms.txt; exit code 77: Graphviz is not here.
rooms-graph:
	@command -v dot >/dev/null || { echo "SKIPPED $@: apt-get install graphviz"; exit 77; }
	@sh docs/rooms_graph.sh | dot -Tsvg >docs/rooms.svg

lint:
	@sh tests/house/rules.sh
	@sh tests/house/constants.sh

# Everything slow: sanitizers, threads, validation, all 2^32 half conversions, bugs planted for the rules
# of the house: they kill no bug of the product, so they are no part of `make check`.
deep: sanitize-check tsan-check validate-check validate-gpu-check slow

sanitize-check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) config=sanitize all tests
	@sh tests/run.sh build/sanitize sanitize

tsan-check:
	@sh .ci/deps.sh deep
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) config=tsan all tests
	@sh tests/run.sh build/tsan tsan

validate-check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all tests
	@RAYDIFF_VALIDATE=1 sh tests/run.sh $(B) validate

# The same, every access of a shader to memory watched (GPU-assisted validation).
validate-gpu-check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all tests
	@RAYDIFF_VALIDATE=gpu sh tests/run.sh $(B) watch

# Every reader under libFuzzer, one after the other, TIME seconds each: a crash, a leak, a hang, or an
# allocation far beyond the input's size ends it with exit code 1. ENTRY='obj ply' chooses.
fuzz-files:
	@sh .ci/deps.sh deep
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/readers/seeds
	@$(MAKE) --no-print-directory -s -j$(JOBS) READER_OUT=$(OUT)/readers-libfuzzer readers-engine
	@sh tests/readers/run.sh $(OUT)/readers-libfuzzer $(B)/readers/seeds $(or $(TIME),60) $(or $(ENTRY),$(READER_NAMES))

# The same under AFL++ (Debian package afl++).
fuzz-afl:
	@command -v afl-fuzz >/dev/null || { echo "afl-fuzz is missing: apt-get install afl++"; exit 77; }
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/readers/seeds
	@$(MAKE) --no-print-directory -s -j$(JOBS) READER_OUT=$(OUT)/readers-afl READER_CC=afl-clang-fast \
	    READER_FLAGS='-g -O2 -fsanitize=undefined -fno-sanitize-recover=all' readers-engine
	@sh tests/readers/afl.sh $(OUT)/readers-afl $(B)/readers/seeds $(or $(TIME),60) $(or $(ENTRY),$(READER_NAMES))

# The script for OSS-Fuzz, with what is on this machine in place of its image.
fuzz-oss:
	@sh .ci/deps.sh deep
	@sh tests/house/oss_fuzz.sh $(OUT)/oss-fuzz

# Every rounding constant tightened until something breaks; CONTRIBUTING.md has what it prints.
bounds:
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(BOUNDS_TESTS)
	@for test in $(BOUNDS_TESTS); do echo "# $$(basename $$test)"; \
	    RAYDIFF_SLOW=1 $$test >$(B)/bounds.log 2>&1; code=$$?; \
	    grep -v '^\[' $(B)/bounds.log; [ $$code -eq 0 ] || exit 1; done

# No honest answer is refused: 10^6 that are exactly right and 10^6 evaluations of each formula and black
# box; CONTRIBUTING.md has what it prints.
HONEST_TESTS := $(B)/tests/test_judge_exact $(B)/tests/test_judge_noise $(B)/tests/test_judge_blackbox
honest:
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(HONEST_TESTS)
	@sh tests/scripts/honest.sh $(HONEST_TESTS)

slow: all tests
	RAYDIFF_SLOW=1 $(B)/tests/test_half
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle_scene
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle_redecide
	RAYDIFF_SLOW=1 $(B)/tests/test_vulkan_render
	for test in $(BOUNDS_TESTS); do RAYDIFF_SLOW=1 $$test || exit 1; done
	$(B)/raydiff conform --hard
	sh tests/house/stubs.sh $(B) all
	sh tests/house/rules_planted.sh
	sh tests/house/constants_planted.sh
