# raydiff. `make run` and `make check` set everything up themselves; bare `make` builds the program.
#   make [config=debug|release|sanitize|tsan|coverage] [CC=clang]
config ?= release
PREFIX ?= /usr/local
VERSION := 0.1.0

ifeq ($(origin CC),default)
  CC := $(if $(filter tsan,$(config)),clang,gcc)
endif
OUT := build
B   := $(if $(filter release,$(config)),$(OUT),$(OUT)/$(config))

WARN := -Wall -Wextra -Wundef -Wconversion -Wvla -Wshadow -Wstrict-prototypes -Wmissing-prototypes
# How vectors are passed depends on the processor; functions that take them are all inlined.
WARN += -Wno-psabi
# No contraction anywhere: an fma would change the bits that the shaders are compared with.
# gcc 12.2 takes (double)(float)x for x where it packs two of them in a vector: no packing.
FP   := -ffp-contract=off -fno-fast-math -fno-tree-slp-vectorize
OPT_release  := -O3 -g
OPT_debug    := -O0 -g3 -D_GLIBCXX_ASSERTIONS
OPT_sanitize := -O1 -g -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT_tsan     := -O1 -g -fsanitize=thread
OPT_coverage := -O0 -g --coverage
ifeq ($(OPT_$(config)),)
  $(error unknown config '$(config)': debug, release, sanitize, tsan or coverage)
endif

# Warnings are errors in checks alone: `make check` and its sisters say WERROR=1, and WERROR=0 stops
# them. That is none of the flags, so that a check compiles nothing anew but what was warned about.
WERROR ?=
CHECKED := WERROR=$(or $(WERROR),1)
WARNED  := $(if $(filter 1,$(WERROR)),$(shell find $(B) -name '*.warned' 2>/dev/null))
# $(call warned,COMMAND) makes $@; what it warns of is shown, and kept in $@.warned.
warned = $(1) $(if $(filter 1,$(WERROR)),-Werror) 2>$@.warned; code=$$?; cat $@.warned >&2; \
         [ -s $@.warned ] || rm -f $@.warned; exit $$code

# Libraries, as this machine tells of them. HAVE_EMBREE=0 leaves Embree out, HAVE_GLSLANG=0 glslang.
PKG_CONFIG ?= pkg-config
$(shell mkdir -p $(B)/gen && CC='$(CC)' PKG_CONFIG='$(PKG_CONFIG)' sh .ci/libs.sh >$(B)/gen/libs.$$$$ && \
    mv $(B)/gen/libs.$$$$ $(B)/gen/libs.mk)
include $(B)/gen/libs.mk
EMBREE := $(filter 3 4,$(HAVE_EMBREE))
CPPFLAGS += -I. -I$(B)/gen $(LIBS_CFLAGS) $(if $(EMBREE),$(EMBREE_CFLAGS)) -DRAYDIFF_VERSION='"$(VERSION)"' \
            -DHAVE_EMBREE=$(or $(EMBREE),0)
CFLAGS   := -std=c17 $(OPT_$(config)) $(WARN) $(FP) -fopenmp $(CFLAGS_EXTRA)
LDLIBS   := $(if $(EMBREE),$(EMBREE_LIBS)) $(LIBS) -ldl -lm -lpthread
# Only the program is linked with glslang, and only it compiles anew when that comes or goes.
PROGRAM_LIBS := $(if $(filter 1,$(HAVE_GLSLANG)),$(GLSLANG_LIBS))

# The commands are the program's, all else of these folders is the library's.
FUZZ     := gen play shrink feedback campaign findings selftest export
LIB_SRC  := $(wildcard ref/*/*.c gpu/*/*.c scenes/*.c scenes/*/*.c bench/*/*.c tests/hard/*.c $(FUZZ:%=fuzz/%/*.c))
CMD_SRC  := raydiff.c $(wildcard cmd/*/*.c)
TEST_SRC := $(wildcard tests/test_*.c)
SHADERS  := $(wildcard shaders/*.comp)

GEN_SRC  := $(addprefix $(B)/gen/,shaders.c baseline.c waivers.c templates.c glsl_sources.c) # the library's, made
LIB_OBJ  := $(patsubst %.c,$(B)/obj/%.o,$(LIB_SRC)) $(GEN_SRC:$(B)/%.c=$(B)/obj/%.o)
CMD_OBJ  := $(CMD_SRC:%.c=$(B)/obj/%.o)
TESTS    := $(TEST_SRC:tests/%.c=$(B)/tests/%)
SAMPLES  := $(addprefix $(B)/samples/,tracer tracer_bug1 tracer_bug2 refuser)
RENDERED := $(patsubst shaders/layout_%.glsl,render_%,$(wildcard shaders/layout_*.glsl))
STACKLESS := $(patsubst shaders/layout_%.glsl,stackless_%,\
               $(shell grep -L 'define WIDE' shaders/layout_*.glsl)) # of binary layouts
SPV      := $(SHADERS:shaders/%.comp=$(B)/spv/%.spv) $(RENDERED:%=$(B)/spv/%.spv) \
            $(STACKLESS:%=$(B)/spv/%.spv)

# A member that no table names would never be tested: the tables compare these with their length.
COUNTS := LAYOUT_FILES=$(words $(wildcard ref/layouts/layout_*.c)) \
          BUILDER_FILES=$(words $(wildcard ref/builders/build_*.c)) \
          ENGINE_FILES=$(words $(wildcard ref/engines/engine_*.c gpu/engines/engine_*.c)) \
          STORE_FILES=$(words $(wildcard ref/store/store_*.c)) \
          GENERATOR_FILES=$(words $(wildcard scenes/generators/gen_*.c)) \
          TRACE_SHADERS=$(words $(filter-out %/trace_brute.comp,$(wildcard shaders/trace_*.comp)))

.PHONY: all lib tests spv clean run check bench agree conform-all deep slow sanitize-check tsan-check \
        validate-check validate-gpu-check format format-check drivers install uninstall scenes mutants \
        lint fuzz-files fuzz-afl fuzz-oss fire-engine truth honest leaks bounds parallel-check slurm-check report-check \
        selftest selftest-quick fresh-check arm-check warnings-check adversaries
.DELETE_ON_ERROR:
.SECONDARY:
all: $(B)/raydiff
lib: $(B)/libraydiff.a
tests: $(TESTS) $(SAMPLES)
spv: $(SPV)

$(B)/raydiff: $(CMD_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(PROGRAM_LIBS)

$(B)/libraydiff.a: $(LIB_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^

# Everything is compiled anew when the command changes, the tables when a member comes or goes.
$(B)/obj/%.o: %.c $(B)/gen/flags | $(B)/gen/counts.h $(B)/gen/have_sdl2.h $(B)/gen/have_glslang.h
	@mkdir -p $(@D)
	$(call warned,$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<)

$(B)/obj/gen/%.o: $(B)/gen/%.c $(B)/gen/flags
	@mkdir -p $(@D)
	$(call warned,$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<)

# $(call written,TEXT): the file is touched only if its text changes.
written = @mkdir -p $(@D); printf '%s\n' $(1) | cmp -s - $@ || printf '%s\n' $(1) >$@
$(WARNED:.warned=): FORCE
$(B)/gen/flags: FORCE
	@$(if $(LIBS_MISSING),echo "make: missing to build raydiff: $(LIBS_MISSING)" >&2; exit 2)
	$(call written,'$(subst ','\'',$(CC) $(CPPFLAGS) $(CFLAGS))')
$(B)/gen/counts.h: FORCE
	$(call written,$(foreach count,$(COUNTS),'#define $(subst =, ,$(count))'))
# Only SDL2's headers: the library is opened when a window is asked for. Not one of the flags, so that
# installing them compiles nothing else anew.
$(B)/gen/have_sdl2.h: FORCE
	$(call written,'#define HAVE_SDL2 $(or $(HAVE_SDL2),0)')
$(B)/gen/have_glslang.h: FORCE
	$(call written,'#define HAVE_GLSLANG $(or $(HAVE_GLSLANG),0)')
$(B)/obj/scenes/render/window.o: CPPFLAGS += $(SDL2_CFLAGS)
$(B)/obj/cmd/doctor/cmd_glsl.o: CPPFLAGS += $(GLSLANG_CFLAGS)
.PHONY: FORCE

# What is known to fail is part of the program, so that an installed one has it.
$(B)/gen/baseline.c: fuzz/baseline.txt
$(B)/gen/waivers.c: tests/waivers.txt
$(B)/gen/baseline.c $(B)/gen/waivers.c:
	@mkdir -p $(@D)
	@{ echo 'extern const char $(basename $(@F))_shipped[];' && \
	  echo 'const char $(basename $(@F))_shipped[] =' && \
	  sed -e 's/[\\"?]/\\&/g' -e 's/^/    "/' -e 's/$$/\\n"/' $< && echo ';'; } >$@

$(B)/tests/%: $(B)/obj/tests/%.o $(B)/libraydiff.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(CMOCKA_LIBS) $(TEST_LIBS)

$(TESTS:$(B)/%=$(B)/obj/%.o): | test_libs
.PHONY: test_libs
test_libs:
	@$(if $(TEST_LIBS_MISSING),echo "make: missing to build the tests: $(TEST_LIBS_MISSING)" >&2; exit 2,:)

# Sample tracers for `--engine pipe:`, compiled as a stranger would: with nothing of raydiff. The
# planted bugs must be found.
$(B)/samples/%: fuzz/samples/tracer.c
	@mkdir -p $(@D)
	$(call warned,$(CC) -std=c17 -O2 $(WARN) $(if $(findstring _bug,$*),-DBUG=$(lastword $(subst _bug, ,$*))) -o $@ $<)

# A tracer that tests nothing, which must be noticed.
$(B)/samples/refuser: tests/refuser.c
	@mkdir -p $(@D)
	$(CC) -std=c17 -O2 $(WARN) -o $@ $<

# The oracle is checked by a second road, GMP rationals, which only tests have.
ORACLE_TESTS := $(filter $(B)/tests/test_oracle%,$(TESTS))
$(ORACLE_TESTS): $(B)/obj/tests/exact_gmp.o $(B)/obj/tests/exact_gmp_bounds.o \
    $(B)/obj/tests/exact_gmp_bounds_baldwin.o $(B)/obj/tests/exact_gmp_redecide.o \
    $(B)/obj/tests/exact_gmp_replay.o $(B)/obj/tests/oracle_cases.o
$(ORACLE_TESTS): TEST_LIBS += $(GMP_LIBS)
BOUNDS_TESTS := $(filter $(B)/tests/test_bounds% $(B)/tests/test_judge_noise $(B)/tests/test_judge_range $(B)/tests/test_judge_unnamed,$(TESTS))
TRIAL_TESTS := $(BOUNDS_TESTS) $(B)/tests/test_judge_exact
$(TRIAL_TESTS): $(addprefix $(B)/obj/tests/,trials.o legal.o exact_gmp.o oracle_cases.o)
$(TRIAL_TESTS): TEST_LIBS += $(GMP_LIBS)

# Published triangle tests, compiled as their users do.
$(B)/tests/test_judge_blackbox $(B)/tests/test_match_edges: $(addprefix $(B)/obj/tests/,honest_plain.o honest_fast.o)
$(B)/obj/tests/honest_fast.o: CFLAGS += -ffast-math -ffp-contract=fast $(if $(filter x86_64%,$(shell $(CC) -dumpmachine)),-mfma)

$(B)/tests/test_adversaries: $(addprefix $(B)/obj/tests/adversaries/,cheats.o outsiders.o outsiders_table.o table.o)

# Their allocations are told to fail, or weighed.
$(B)/tests/test_out_of_memory $(B)/tests/test_memory: TEST_LIBS += \
    -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free

# The campaign of truth; needs GMP, so it is no part of the program.
TRUTH_OBJ := $(patsubst %.c,$(B)/obj/%.o,$(wildcard tests/truth/*.c tests/exact_gmp*.c) \
               cmd/common/cmd_tables.c cmd/common/cmd_options.c)
$(B)/truth: $(TRUTH_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(GMP_LIBS)
truth:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/truth
	@mkdir -p $(B)/truth-found
	$(B)/truth --out $(B)/truth-found $(ARGS)

include shaders/shaders.mk # $(SPV), $(B)/gen/shaders.c
include mutants.mk # planted, planted-quick
include tests/readers/fire.mk # files under fire

# Parts of the C programs that `raydiff export` writes, as text. They are read as they are, never
# compiled here.
TEMPLATES := $(sort $(wildcard fuzz/templates/*.c))
$(B)/gen/templates.c: $(TEMPLATES) Makefile
	@mkdir -p $(@D)
	{ echo '#include "fuzz/export/export_template.h"'; \
	  echo 'const struct export_template export_templates[] = {'; \
	  for file in $(TEMPLATES); do printf '{"%s",\n' "$${file##*/}"; \
	      sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$file; echo '},'; done; \
	  echo '{0, 0}};'; } >$@

# The text of our shaders, for those that are compiled at run time.
GLSL_TEXTS := $(sort $(wildcard shaders/*.glsl)) ref/abi.h ref/base/mutant.h
$(B)/gen/glsl_sources.c: $(GLSL_TEXTS) Makefile
	@mkdir -p $(@D)
	@{ echo '#include "gpu/shaders/glsl_text.h"'; echo 'const struct glsl_source glsl_sources[] = {'; \
	  for file in $(GLSL_TEXTS); do printf '{"%s",\n' "$${file#shaders/}"; \
	      sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$file; echo '},'; done; \
	  echo '{0, 0}};'; } >$@

# --- what people type -------------------------------------------------------------------------

# The main job: a real mesh that fits the 16-byte layout and one that does not.
#   make run                     make run SCENE=my.obj ARGS='--layout all'
RF_FITS   := scenes/fetched/assimp-wuson.obj
RF_BURSTS := scenes/fetched/glmark2-bunny.obj
RF_MADE   := terrain:k=5 terrain:k=8
run:
	@sh .ci/deps.sh run
	@$(MAKE) --no-print-directory -s -j$(JOBS) all
	@$(if $(SCENE),,sh scenes/fetch.sh scenes/fetched --minimal --quiet || true)
	@scenes='$(SCENE)'; [ -n "$$scenes" ] || scenes=$$(ls $(RF_FITS) $(RF_BURSTS) 2>/dev/null); \
	[ -n "$$scenes" ] || { scenes='$(RF_MADE)'; echo "no mesh is here: generated scenes instead"; }; \
	$(B)/raydiff check $$scenes $(ARGS)

JOBS := $(shell nproc 2>/dev/null || echo 2)

check:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(CHECKED) all tests
	@sh tests/run.sh $(B)

bench: all
	$(B)/raydiff bench $(ARGS)

scenes:
	@sh scenes/fetch.sh scenes/fetched

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
	sh tests/agree.sh $(B) full $(RESULTS)/agree

# The conformance suite, every combination of members once. Slow.
conform-all: all
	$(B)/raydiff conform --all $(ARGS)

# Dishonest tracers on a large mesh: what each uses up, and what it gets away with.
adversaries: tests
	RAYDIFF_ADVERSARIES=$(or $(SCENE),scenes/fetched/dragon-203k.ply.gz) $(B)/tests/test_adversaries

# Rays at edges and vertices of closed meshes from inside, 10^6 a mesh, on each CPU driver.
leaks: all
	sh tests/leaks.sh $(B) $(RESULTS)/leaks

# Every system call of campaigns, merges, shrinkings, checks and reports fails once in each of its ways. ARGS:
# '-n merge' one command, '-o 0:openat:3:EIO' one fault, '-s 10' each tenth. Exit code 77: processes may not be traced here.
.PHONY: faults
faults: all
	@sh tests/faults.sh $(B)/raydiff $(or $(ARGS),-s 1)

# The recipes for many machines, with what they need from Debian; exit code 77: not to be had.
recipe_check = sh .ci/deps.sh $(1) || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }; \
    $(MAKE) --no-print-directory -s -j$(JOBS) all && sh tests/$(1).sh $(B)
parallel-check:
	@$(call recipe_check,parallel)
slurm-check:
	@$(call recipe_check,slurm)

# A report in headless Chromium; build/report has it with its screenshot. Exit code 77: not to be had.
report-check:
	@sh .ci/deps.sh report || { echo "SKIPPED $@: its packages cannot be had"; exit 77; }
	@$(MAKE) --no-print-directory -s -j$(JOBS) all
	@sh tests/report_browser.sh $(B)/raydiff $(B)/report

# Is every planted bug found by the fuzzer? All, and some of every kind.
selftest:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted
	$(B)/raydiff fuzz --self-test $(ARGS)
selftest-quick:
	@$(MAKE) --no-print-directory -s -j$(JOBS) planted-quick
	$(B)/raydiff fuzz --self-test --only $(QUICK_NAMES) $(ARGS)

mutants: all tests
	@CC_CMD='$(subst ',,$(CC) $(CPPFLAGS) $(CFLAGS))' LIBS='$(LDLIBS) $(PROGRAM_LIBS)' TOOL_SRC='$(TOOL_SRC)' \
	    sh tests/mutants.sh $(B) $(ONLY)

lint:
	@sh tests/rules.sh
	@sh tests/constants.sh

# Everything slow: sanitizers, threads, validation, all 2^32 half conversions.
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
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/fire/seeds
	@$(MAKE) --no-print-directory -s -j$(JOBS) FIRE_OUT=$(OUT)/fire-libfuzzer fire-engine
	@sh tests/readers/run.sh $(OUT)/fire-libfuzzer $(B)/fire/seeds $(or $(TIME),60) $(or $(ENTRY),$(FIRE_NAMES))

# The same under AFL++ (Debian package afl++).
fuzz-afl:
	@command -v afl-fuzz >/dev/null || { echo "afl-fuzz is missing: apt-get install afl++"; exit 77; }
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/fire/seeds
	@$(MAKE) --no-print-directory -s -j$(JOBS) FIRE_OUT=$(OUT)/fire-afl FIRE_CC=afl-clang-fast \
	    FIRE_FLAGS='-g -O2 -fsanitize=undefined -fno-sanitize-recover=all' fire-engine
	@sh tests/readers/afl.sh $(OUT)/fire-afl $(B)/fire/seeds $(or $(TIME),60) $(or $(ENTRY),$(FIRE_NAMES))

# The script for OSS-Fuzz, with what is on this machine in place of its image.
fuzz-oss:
	@sh .ci/deps.sh deep
	@sh tests/oss_fuzz.sh $(OUT)/oss-fuzz

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
	@sh tests/honest.sh $(HONEST_TESTS)

slow: all tests
	RAYDIFF_SLOW=1 $(B)/tests/test_half
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle_scene
	RAYDIFF_SLOW=1 $(B)/tests/test_oracle_redecide
	RAYDIFF_SLOW=1 $(B)/tests/test_vulkan_render
	for test in $(BOUNDS_TESTS); do RAYDIFF_SLOW=1 $$test || exit 1; done
	$(B)/raydiff conform --hard

SOURCES = $(shell git ls-files '*.c' '*.h')
format:
	@clang-format -i $(SOURCES)
format-check:
	clang-format --dry-run -Werror $(SOURCES)

HEADERS := $(wildcard ref/*.h $(patsubst %,ref/%/*.h,base files judge match packed primitives scene trace tree twin) \
             scenes/*.h scenes/*/*.h) ref/oracle/oracle.h
install: all lib
	install -Dm755 $(B)/raydiff $(DESTDIR)$(PREFIX)/bin/raydiff
	install -Dm644 $(B)/libraydiff.a $(DESTDIR)$(PREFIX)/lib/libraydiff.a
	for h in $(HEADERS); do \
	    install -Dm644 $$h $(DESTDIR)$(PREFIX)/include/raydiff/$$h || exit 1; done
	install -d $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/share/man/man1
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@LIBS@|$(LDLIBS)|' \
	    ref/raydiff.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/raydiff.pc
	sed -e 's|@VERSION@|$(VERSION)|' ref/raydiff.1 > $(DESTDIR)$(PREFIX)/share/man/man1/raydiff.1

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/raydiff $(DESTDIR)$(PREFIX)/lib/libraydiff.a \
	      $(DESTDIR)$(PREFIX)/lib/pkgconfig/raydiff.pc \
	      $(DESTDIR)$(PREFIX)/share/man/man1/raydiff.1
	rm -rf $(DESTDIR)$(PREFIX)/include/raydiff

clean:
	rm -rf $(OUT)

-include $(wildcard $(B)/obj/*.d $(B)/obj/*/*.d $(B)/obj/*/*/*.d)
