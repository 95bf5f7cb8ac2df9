# Files under fire (tests/readers/fire.h): a program per entry_NAME.c, in three ways.
FIRE_NAMES := $(patsubst tests/readers/entry_%.c,%,$(wildcard tests/readers/entry_*.c))
FIRE_SRC   := tests/readers/harness.c tests/readers/count.c

# 1. With main.c, compiled as everything else is: make check plays all seeds with them.
FIRE := $(addprefix $(B)/fire/,$(FIRE_NAMES))
FIRE_LINK_peer := -Wl,--wrap=pipe_child_start,--wrap=pipe_child_stop,--wrap=pipe_child_is_early
$(B)/fire/%: $(B)/obj/tests/readers/entry_%.o $(addprefix $(B)/obj/,$(FIRE_SRC:.c=.o) tests/readers/main.o) \
    $(B)/libraydiff.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(FIRE_LINK_$*)
tests: $(FIRE)
$(B)/tests/test_fire: $(addprefix $(B)/obj/,$(FIRE_SRC:.c=.o))
$(B)/tests/test_fire: TEST_LIBS += $(B)/libraydiff.a $(LDLIBS) # what these need

# 2. With a fuzzing engine, the library compiled for it: make fire-engine FIRE_OUT=FOLDER.
#   FIRE_CC, FIRE_FLAGS        compiler and its flags
#   FIRE_LINK, FIRE_LINK_FLAGS linker and its flags
#   FIRE_ENGINE                what to link as the engine
#   FIRE_LIBS                  libraries
FIRE_OUT    ?= $(OUT)/fire-libfuzzer
FIRE_CC     ?= clang
FIRE_FLAGS  ?= -g -O1 -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow \
               -fno-sanitize-recover=all -fno-omit-frame-pointer
FIRE_LINK   ?= $(FIRE_CC)
FIRE_LINK_FLAGS ?= $(FIRE_FLAGS)
FIRE_ENGINE ?= -fsanitize=fuzzer
FIRE_LIBS   ?= $(LDLIBS)
# -Itests/readers/single: without OpenMP, in one thread.
FIRE_CMD = $(FIRE_CC) -Itests/readers/single $(CPPFLAGS) -std=c17 $(FIRE_FLAGS) $(FP)
FIRE_LIB_OBJ := $(LIB_SRC:%.c=$(FIRE_OUT)/obj/%.o) $(GEN_SRC:$(B)/%.c=$(FIRE_OUT)/obj/%.o)

$(FIRE_OUT)/flags: FORCE
	$(call written,'$(subst ','\'',$(FIRE_CMD) $(FIRE_LINK) $(FIRE_ENGINE))')
$(FIRE_OUT)/obj/gen/%.o: $(B)/gen/%.c $(FIRE_OUT)/flags
	@mkdir -p $(@D)
	$(FIRE_CMD) -MMD -MP -c -o $@ $<
$(FIRE_OUT)/obj/%.o: %.c $(FIRE_OUT)/flags | $(B)/gen/counts.h
	@mkdir -p $(@D)
	$(FIRE_CMD) -MMD -MP -c -o $@ $<
$(FIRE_OUT)/libfire.a: $(FIRE_LIB_OBJ) $(FIRE_SRC:%.c=$(FIRE_OUT)/obj/%.o)
	@rm -f $@
	$(AR) rcs $@ $^
$(FIRE_OUT)/fuzz_%: $(FIRE_OUT)/obj/tests/readers/entry_%.o $(FIRE_OUT)/libfire.a
	$(FIRE_LINK) $(FIRE_LINK_FLAGS) -o $@ $^ $(FIRE_ENGINE) $(FIRE_LIBS) $(FIRE_LINK_$*)
fire-engine: $(addprefix $(FIRE_OUT)/fuzz_,$(FIRE_NAMES))
-include $(wildcard $(FIRE_OUT)/obj/*/*.d $(FIRE_OUT)/obj/*/*/*.d)

# Seeds are made by the program itself, and what was once found is kept in tests/readers/found.
$(B)/fire/seeds: $(B)/raydiff tests/readers/seeds.sh $(wildcard fuzz/corpus/*.trial)
	sh tests/readers/seeds.sh $(B) $@
tests: $(B)/fire/seeds
