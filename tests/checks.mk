# make check and slower checks.
.PHONY: check rooms-graph agree conform-all deep slow seldom-check sanitize-check tsan-check validate-check validate-gpu-check drivers webgpu \
        mutants lint fuzz-files fuzz-afl fuzz-oss readers-engine honest leaks bounds parallel-check slurm-check \
        report-check selftest selftest-quick fresh-check arm-check warnings-check adversaries

check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all lib tests
	@sh tests/run.sh $(B)

# Fetches more Vulkan drivers that need no GPU, next to the system's. Exit code 77: not available.
drivers:
	@sh .ci/drivers.sh $(OUT)/drivers
# Installs Dawn for Node, for engine webgpu. Exit code 77: not available.
webgpu:
	@sh .ci/webgpu.sh $(OUT)/webgpu

# Runs the README's two commands in a minimal system of each supported Debian release, or of
# RELEASE=trixie. Needs root. Each release that passes adds a line to tests/fresh.txt. Exit code 77:
# not possible here. Slow.
fresh-check:
	@sh .ci/fresh.sh tests/fresh.txt $(RELEASE)

# The same for suites compiled for aarch64, under qemu-user, and for every supported compiler without
# a warning; each in the release that has it.
arm-check:
	@sh .ci/other.sh tests/fresh.txt aarch64
warnings-check:
	@sh .ci/other.sh tests/fresh.txt warnings

# trimesh's own tracer, judged through raydiff.py in a minimal Debian 13.
.PHONY: trimesh-check
trimesh-check:
	@sh .ci/other.sh tests/fresh.txt trimesh

# Debian packages of both releases, or of RELEASE=trixie: built without network, clean under lintian, installed
# in another minimal system, used and purged. Needs root. Exit code 77: not possible here. Slow.
.PHONY: deb-check
deb-check:
	@sh .ci/deb.sh tests/fresh.txt $(RELEASE)

# An image for containers of those packages and debootstrap's system alone, tried by buildah without network.
.PHONY: image-check
image-check:
	@sh .ci/image.sh tests/fresh.txt $(RELEASE)

# Compares all engines with each other, 300,000 rays per scene; the result is committed. Slow.
RESULTS ?= bench/results/lavapipe-22.3.6
agree: all
	sh tests/scripts/agree.sh $(B) full $(RESULTS)/agree

# Runs the conformance suite, every combination of members once. Slow.
conform-all: all
	$(B)/raydiff conform --all $(ARGS)

# Runs dishonest tracers on a large mesh: what each consumes, and what goes undetected.
adversaries: tests
	RAYDIFF_ADVERSARIES=$(or $(SCENE),scenes/fetched/dragon-203k.ply.gz) $(B)/tests/test_adversaries

# Traces rays at edges and vertices of closed meshes from inside, 10^6 per mesh, on each CPU driver.
leaks: all
	sh tests/scripts/leaks.sh $(B) $(RESULTS)/leaks

# Lets every system call of campaigns, merges, shrinkings, checks and reports fail once with each of
# its errors. ARGS: '-n merge' one command, '-o 0:openat:3:EIO' one fault, '-s 10' every tenth.
# Exit code 77: processes must not be traced here.
.PHONY: faults
faults: all
	@sh tests/scripts/faults.sh $(B)/raydiff $(or $(ARGS),-s 1)

# Runs the recipes for many machines, with the Debian packages they need. Exit code 77: not available.
recipe_check = sh .ci/deps.sh $(1) || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }; \
    $(MAKE) --no-print-directory -s -j$(JOBS) all && sh $(2) $(B)
parallel-check:
	@$(call recipe_check,parallel,tests/scripts/parallel.sh)
slurm-check:
	@$(call recipe_check,slurm,tests/scripts/slurm.sh)

# Shows a report in headless Chromium; build/report has it and a screenshot. Exit code 77: not
# available.
report-check:
	@sh .ci/deps.sh report || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }
	@$(MAKE) --no-print-directory -s -j$(JOBS) all
	@sh tests/scripts/report_browser.sh $(B)/raydiff $(B)/report

# Checks that the fuzzer finds every planted bug, or some of each kind (-quick).
selftest:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted
	$(B)/raydiff fuzz --self-test $(ARGS)
selftest-quick:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted-quick
	$(B)/raydiff fuzz --self-test --only $(QUICK_NAMES) $(ARGS)

mutants: all tests
	@CC_CMD='$(subst ',,$(CC) $(CPPFLAGS) $(CFLAGS))' LIBS='$(LDLIBS) $(PROGRAM_LIBS)' TOOL_SRC='$(TOOL_SRC)' \
	    PART='$(PART)' sh tests/planted/run.sh $(B) $(ONLY)

# A graphics card: its arithmetic, agreement, hard cases, leaks, a campaign, speeds; all in FOLDER, under 10 minutes.
#   make hardware [FOLDER=build/hardware] [DRIVER=hardware] [SECONDS=560]       exit code 77: there is no such device
.PHONY: hardware
hardware: all
	@sh bench/hardware.sh $(B)/raydiff $(or $(FOLDER),$(OUT)/hardware) $(or $(DRIVER),hardware) $(SECONDS)

# Holds the speed of engine embree to a plain loop of rtcIntersect1. Exit code 77: without Embree.
.PHONY: bench-fair
bench-fair: all
	@sh tests/bench/fair.sh $(B)/raydiff

# Races the user's copy of tinybvh: its answers are judged first; version and checksum are told.
#   make bench-tinybvh TINYBVH=FOLDER-OF-tiny_bvh.h [SCENE=...]
.PHONY: bench-tinybvh
bench-tinybvh: all
	@sh tests/bench/tinybvh.sh $(B)/raydiff '$(TINYBVH)' '$(SCENE)'

# Draws docs/rooms.txt. Exit code 77: Graphviz is not installed.
.PHONY: site
# The pages as HTML, to read without network.
site:
	@sh .ci/deps.sh site || { echo "SKIPPED $@: pandoc cannot be had"; exit 77; }
	@sh docs/site/site.sh build/site

rooms-graph:
	@command -v dot >/dev/null || { echo "SKIPPED $@: apt-get install graphviz"; exit 77; }
	@sh tests/house/rooms_graph.sh | dot -Tsvg >docs/rooms.svg

lint:
	@sh tests/house/rules.sh
	@sh tests/house/constants.sh

# All slow checks: sanitizers, threads, validation, all 2^32 half conversions, all planted bugs (of which
# `make check` plays one in 24), those for the rules of the house included. What finds few bugs of the product
# for its time stands here.
deep: seldom-check sanitize-check tsan-check validate-check validate-gpu-check slow mutants
	@sh tests/conform/conform.sh $(B)/raydiff $(B)/check/hard-deep.xml 8000 --hard --quick
	@sh tests/scripts/agree.sh $(B) deep $(B)/check/agree-deep
	SHADER=all $(B)/tests/test_vulkan_shaders
	$(B)/raydiff conform
	RAYDIFF_WHOLE_MODULES=1 $(B)/raydiff conform --engine vulkan,vulkan_brute,vulkan_stackless
	@sh tests/worlds/worlds_piped.sh $(B)/raydiff lies

seldom-check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all lib tests
	@sh tests/run.sh $(B) seldom

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

# The same with every memory access of shaders checked (GPU-assisted validation).
validate-gpu-check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all tests
	@RAYDIFF_VALIDATE=gpu sh tests/run.sh $(B) watch

# Runs every reader under libFuzzer, one after the other, TIME seconds each. Exit code 1: a crash, a
# leak, a hang, or an allocation far beyond the input's size. ENTRY='obj ply' selects readers.
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

# Runs the script for OSS-Fuzz with the tools of this machine in place of its image.
fuzz-oss:
	@sh .ci/deps.sh deep
	@sh tests/house/oss_fuzz.sh $(OUT)/oss-fuzz

# Tightens every rounding constant until a check fails; docs/numerics.md has the output.
bounds:
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(BOUNDS_TESTS)
	@for test in $(BOUNDS_TESTS); do echo "# $$(basename $$test)"; \
	    RAYDIFF_SLOW=1 $$test >$(B)/bounds.log 2>&1; code=$$?; \
	    grep -v '^\[' $(B)/bounds.log; [ $$code -eq 0 ] || exit 1; done

# Checks that no correct answer is rejected: 10^6 exact ones and 10^6 evaluations of each formula and
# black box. docs/numerics.md has the output.
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
	$(B)/raydiff conform --worlds
	sh tests/house/stubs.sh $(B) all
	sh tests/house/rules_planted.sh
	sh tests/house/constants_planted.sh
