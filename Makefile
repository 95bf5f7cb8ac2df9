# raydiff. `make run` and `make check` install what they need; plain `make` builds the program.
#   make [config=debug|release|sanitize|tsan|coverage|mutation] [CC=clang]
config ?= release
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
VERSION := 0.2.0

ifeq ($(origin CC),default)
  CC := $(if $(filter tsan,$(config)),clang,gcc)
endif
OUT := build
B   := $(if $(filter release,$(config)),$(OUT),$(OUT)/$(config))

WARN := -Wall -Wextra -Wundef -Wconversion -Wvla -Wshadow -Wstrict-prototypes -Wmissing-prototypes
# The calling convention for vectors depends on the processor; all functions with them are inlined.
WARN += -Wno-psabi
# No contraction: an fma would change the bits that the shaders are compared with.
# No vector packing: gcc 12.2 treats (double)(float)x as x if it packs two of them in a vector.
FP   := -ffp-contract=off -fno-fast-math -fno-tree-slp-vectorize
OPT_release  := -O3 -g1
OPT_debug    := -O0 -g3 -D_GLIBCXX_ASSERTIONS
OPT_sanitize := -O1 -g -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT_tsan     := -O1 -g -fsanitize=thread
OPT_coverage := -O1 -g -fPIC -fsanitize-coverage=trace-pc -fno-if-conversion -fno-if-conversion2 -fno-ssa-phiopt
OPT_mutation := -O1 -fPIC
ifeq ($(OPT_$(config)),)
  $(error unknown config '$(config)': debug, release, sanitize, tsan, coverage or mutation)
endif

# Warnings are errors only in checks: `make check` and similar targets set WERROR=1; WERROR=0 turns it
# off. It is not one of the flags, so that a check recompiles only the files with warnings.
WERROR ?=
CHECKED := WERROR=$(or $(WERROR),1)
WARNED  := $(if $(filter 1,$(WERROR)),$(shell find $(B) -name '*.warned' 2>/dev/null))
# $(call warned,COMMAND) makes $@. Its warnings are printed and kept in $@.warned.
warned = $(1) $(if $(filter 1,$(WERROR)),-Werror) 2>$@.warned; code=$$?; cat $@.warned >&2; \
         [ -s $@.warned ] || rm -f $@.warned; exit $$code

# Libraries found here. HAVE_EMBREE=0 leaves Embree out, of which only headers are needed; HAVE_GLSLANG=0 glslang.
PKG_CONFIG ?= pkg-config
$(shell mkdir -p $(B)/gen && CC='$(CC)' PKG_CONFIG='$(PKG_CONFIG)' sh .ci/libs.sh >$(B)/gen/libs.$$$$ && \
    mv $(B)/gen/libs.$$$$ $(B)/gen/libs.mk)
include $(B)/gen/libs.mk
EMBREE := $(filter 3 4,$(HAVE_EMBREE))
CPPFLAGS += -I. -I$(B)/gen $(LIBS_CFLAGS) $(if $(EMBREE),$(EMBREE_CFLAGS)) -DRAYDIFF_VERSION='"$(VERSION)"' \
            -DHAVE_EMBREE=$(or $(EMBREE),0)
CFLAGS   := -std=c17 $(OPT_$(config)) $(WARN) $(FP) -fopenmp $(CFLAGS_EXTRA)
LDLIBS   := $(LIBS) -ldl -lm -lpthread
# Only the program is linked with glslang, and only it is rebuilt when glslang is added or removed.
PROGRAM_LIBS := $(if $(filter 1,$(HAVE_GLSLANG)),$(GLSLANG_LIBS))

# The commands belong to the program, the other sources to the library.
FUZZ     := gen play shrink feedback campaign findings selftest export
LIB_SRC  := $(wildcard ref/*/*.c ref/*/*/*.c gpu/*/*.c scenes/*.c scenes/*/*.c bench/*/*.c tests/hard/*.c tests/hard/*/*.c $(FUZZ:%=fuzz/%/*.c))
CMD_SRC  := raydiff.c $(wildcard cmd/*/*.c)
GEN_SRC  := $(addprefix $(B)/gen/,shaders.c baseline.c waivers.c turn.c web_view.c web_gpu.c templates.c glsl_sources.c wgsl_sources.c) # generated, of the library
LIB_OBJ  := $(patsubst %.c,$(B)/obj/%.o,$(LIB_SRC)) $(GEN_SRC:$(B)/%.c=$(B)/obj/%.o)
CMD_OBJ  := $(CMD_SRC:%.c=$(B)/obj/%.o)
IN_ONE   := $(filter mutation coverage,$(config))
LIB_OBJ  += $(if $(IN_ONE),$(filter-out $(B)/obj/raydiff.o,$(CMD_OBJ)))
CMD_OBJ  := $(if $(IN_ONE),$(B)/obj/raydiff.o,$(CMD_OBJ))

# Commands parse, print and call: less of the optimiser builds them in two thirds of the time.
ifeq ($(config),release)
$(CMD_OBJ): private CFLAGS := $(CFLAGS:-O3=-O1)
endif

include shaders/shaders.mk         # $(SPV), $(B)/gen/shaders.c, $(B)/gen/glsl_sources.c

# Numbers of files, which the tables compare with their length: a file missing in its table would
# never be tested.
COUNTS := LAYOUT_FILES=$(words $(wildcard ref/layouts/layout_*.c)) \
          BUILDER_FILES=$(words $(wildcard ref/builders/build_*.c)) \
          ENGINE_FILES=$(words $(wildcard ref/engines/engine_*.c gpu/engines/engine_*.c)) \
          STORE_FILES=$(words $(wildcard ref/store/store_*.c)) \
          GENERATOR_FILES=$(words $(wildcard scenes/generators/gen_*.c)) \
          LAYOUT_SHADERS=$(words $(LAYOUTS))

.PHONY: all lib spv clean run bench format format-check install uninstall scenes
.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := all
all: $(B)/raydiff
lib: $(B)/libraydiff.a
spv: $(SPV)

$(B)/raydiff: $(CMD_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS) $(PROGRAM_LIBS)

ifeq ($(IN_ONE),)
$(B)/libraydiff.a: $(LIB_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^
endif

# All objects are rebuilt when the command changes, the tables when a file is added or removed.
$(B)/obj/%.o: %.c $(B)/gen/flags | $(B)/gen/counts.h $(B)/gen/have_sdl2.h $(B)/gen/have_glslang.h
	@mkdir -p $(@D)
	$(call warned,$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<)

$(B)/obj/gen/%.o: $(B)/gen/%.c $(B)/gen/flags
	@mkdir -p $(@D)
	$(call warned,$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<)

# $(call written,TEXT) writes $@ only if its text changes.
written = @mkdir -p $(@D); printf '%s\n' $(1) | cmp -s - $@ || printf '%s\n' $(1) >$@
$(WARNED:.warned=): FORCE
$(B)/gen/flags: FORCE
	@$(if $(LIBS_MISSING),echo "make: missing to build raydiff: $(LIBS_MISSING)" >&2; exit 2)
	$(call written,'$(subst ','\'',$(CC) $(CPPFLAGS) $(CFLAGS))')
$(B)/gen/counts.h: FORCE
	$(call written,$(foreach count,$(COUNTS),'#define $(subst =, ,$(count))'))
# Only the headers of SDL2: the library is loaded when a window is opened. Not one of the flags, so
# that installing them rebuilds nothing else.
$(B)/gen/have_sdl2.h: FORCE
	$(call written,'#define HAVE_SDL2 $(or $(HAVE_SDL2),0)')
$(B)/gen/have_glslang.h: FORCE
	$(call written,'#define HAVE_GLSLANG $(or $(HAVE_GLSLANG),0)')
$(B)/obj/scenes/render/window.o: CPPFLAGS += $(SDL2_CFLAGS)
$(B)/obj/cmd/doctor/cmd_glsl.o: CPPFLAGS += $(GLSLANG_CFLAGS)
.PHONY: FORCE

# The lists of known failures and the script of pages are part of the program, so that installed
# programs have them.
$(B)/gen/baseline.c: fuzz/baseline.txt
$(B)/gen/waivers.c: tests/waivers.txt
$(B)/gen/turn.c: cmd/explain/turn.js
$(B)/gen/web_view.c $(B)/gen/web_gpu.c: $(B)/gen/%.c: cmd/web/%.js
$(addprefix $(B)/gen/,baseline.c waivers.c turn.c web_view.c web_gpu.c):
	@mkdir -p $(@D)
	@{ echo 'extern const char $(basename $(@F))_shipped[];' && \
	  echo 'const char $(basename $(@F))_shipped[] =' && \
	  sed -e 's/[\\"?]/\\&/g' -e 's/^/    "/' -e 's/$$/\\n"/' $< && echo ';'; } >$@

include ref/library/library.mk    # the shared library, and what is installed of it
include fuzz/export/templates.mk  # $(B)/gen/templates.c
include tests/tests.mk            # $(TESTS), $(SAMPLES), and what they are linked with
include tests/checks.mk           # check and slower checks
include tests/planted/planted.mk  # planted, planted-quick
include tests/readers/readers.mk     # test programs of file readers
include tests/mutation/mutation.mk   # mutation
include tests/shader_mutants/shader_mutants.mk # shader-mutants

# --- targets for users ------------------------------------------------------------------------

# The main use: checks a real mesh that fits the 16-byte layout and one that does not.
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

bench: all
	$(B)/raydiff bench $(ARGS)

scenes:
	@sh scenes/fetch.sh scenes/fetched

SOURCES = $(shell git ls-files '*.c' '*.h')
format:
	@clang-format -i $(SOURCES)
format-check:
	clang-format --dry-run -Werror $(SOURCES)

# Programs include all headers but the last two: layout plugins include only the one, engines from outside the other.
HEADERS  := ref/abi.h ref/base/base.h ref/scene/scene.h ref/primitives/primitives.h ref/tree/bvh.h ref/tree/oblique_box.h \
            ref/layout.h ref/engine.h ref/plugin.h ref/raydiff_engine.h
BASH_DIR := share/bash-completion/completions
ZSH_DIR  := share/zsh/site-functions
install: all lib
	install -Dm755 $(B)/raydiff $(DESTDIR)$(PREFIX)/bin/raydiff
	for h in $(HEADERS); do \
	    install -Dm644 $$h $(DESTDIR)$(PREFIX)/include/raydiff/$$h || exit 1; done
	install -d $(DESTDIR)$(PREFIX)/share/man/man1
	$(B)/raydiff help --man | cat - ref/raydiff.1 > $(DESTDIR)$(PREFIX)/share/man/man1/raydiff.1
	for c in $$($(B)/raydiff help --commands); do \
	    $(B)/raydiff help --man $$c > $(DESTDIR)$(PREFIX)/share/man/man1/raydiff-$$c.1 || exit 1; done
	install -d $(DESTDIR)$(PREFIX)/$(BASH_DIR) $(DESTDIR)$(PREFIX)/$(ZSH_DIR)
	$(B)/raydiff help --bash > $(DESTDIR)$(PREFIX)/$(BASH_DIR)/raydiff
	$(B)/raydiff help --zsh > $(DESTDIR)$(PREFIX)/$(ZSH_DIR)/_raydiff

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/raydiff \
	      $(DESTDIR)$(PREFIX)/share/man/man1/raydiff.1 $(DESTDIR)$(PREFIX)/share/man/man1/raydiff-*.1 \
	      $(DESTDIR)$(PREFIX)/$(BASH_DIR)/raydiff $(DESTDIR)$(PREFIX)/$(ZSH_DIR)/_raydiff
	rm -rf $(DESTDIR)$(PREFIX)/include/raydiff

clean:
	rm -rf $(OUT)

-include $(wildcard $(B)/obj/*.d $(B)/obj/*/*.d $(B)/obj/*/*/*.d $(B)/obj/*/*/*/*.d)
