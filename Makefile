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

WARN := -Wall -Wextra -Wconversion -Wvla -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Werror
# No contraction anywhere: an fma would change the bits that the shaders are compared with.
FP   := -ffp-contract=off -fno-fast-math
OPT_release  := -O3 -g
OPT_debug    := -O0 -g3 -D_GLIBCXX_ASSERTIONS
OPT_sanitize := -O1 -g -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT_tsan     := -O1 -g -fsanitize=thread
OPT_coverage := -O0 -g --coverage
ifeq ($(OPT_$(config)),)
  $(error unknown config '$(config)': debug, release, sanitize, tsan or coverage)
endif

HAVE_EMBREE := $(if $(wildcard /usr/include/embree4/rtcore.h),4,$(if $(wildcard /usr/include/embree3/rtcore.h),3))
CPPFLAGS += -I. -I$(B)/gen -DRAYDIFF_VERSION='"$(VERSION)"' -DHAVE_EMBREE=$(or $(HAVE_EMBREE),0)
CFLAGS   := -std=c17 $(OPT_$(config)) $(WARN) $(FP) -fopenmp $(CFLAGS_EXTRA)
LDLIBS   := $(if $(HAVE_EMBREE),-lembree$(HAVE_EMBREE)) -ljansson -lz -ldl -lm -lpthread

LIB_SRC  := $(filter-out %/cmd_%,$(wildcard ref/*.c ref/*/*.c gpu/*.c scenes/*.c scenes/*/*.c))
CMD_SRC  := raydiff.c $(wildcard */cmd_*.c)
TEST_SRC := $(wildcard tests/test_*.c)
SHADERS  := $(wildcard shaders/*.comp)

LIB_OBJ  := $(LIB_SRC:%.c=$(B)/obj/%.o) $(B)/obj/gen/shaders.o
CMD_OBJ  := $(CMD_SRC:%.c=$(B)/obj/%.o)
TESTS    := $(TEST_SRC:tests/%.c=$(B)/tests/%)
SPV      := $(SHADERS:shaders/%.comp=$(B)/spv/%.spv)

# A member that no table names would never be tested: the tables compare these with their length.
CPPFLAGS += -DLAYOUT_FILES=$(words $(wildcard ref/layouts/layout_*.c)) \
            -DBUILDER_FILES=$(words $(wildcard ref/builders/build_*.c)) \
            -DENGINE_FILES=$(words $(wildcard ref/engines/engine_*.c gpu/engine_*.c)) \
            -DGENERATOR_FILES=$(words $(wildcard scenes/generators/gen_*.c)) \
            -DTRACE_SHADERS=$(words $(wildcard shaders/trace_*.comp))

.PHONY: all lib tests spv clean
.DELETE_ON_ERROR:
.SECONDARY:
all: $(B)/raydiff
lib: $(B)/libraydiff.a
tests: $(TESTS)
spv: $(SPV)

$(B)/raydiff: $(CMD_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS)

$(B)/libraydiff.a: $(LIB_OBJ)
	@rm -f $@
	$(AR) rcs $@ $^

# The dependence on this file's flags: a change of the set of files changes the tables' checks.
$(B)/obj/%.o: %.c | $(B)/gen/.made
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(B)/obj/gen/%.o: $(B)/gen/%.c
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(B)/gen/.made:
	@mkdir -p $(@D)
	@touch $@

$(B)/tests/%: $(B)/obj/tests/%.o $(B)/libraydiff.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) -lcmocka $(TEST_LIBS)

include shaders/shaders.mk # $(SPV), $(B)/gen/shaders.c

clean:
	rm -rf $(OUT)

-include $(LIB_OBJ:.o=.d) $(CMD_OBJ:.o=.d) $(TESTS:$(B)/tests/%=$(B)/obj/tests/%.d)
