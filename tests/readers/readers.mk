# Test programs of file readers (tests/readers/reader_entry.h), one per entry_NAME.c: with main.c,
# with libFuzzer or with AFL++.
READER_NAMES := $(patsubst tests/readers/entry_%.c,%,$(wildcard tests/readers/entry_*.c))
READER_SRC   := tests/readers/harness.c tests/readers/count.c

# 1. With main.c and the usual flags: make check runs all seeds with them.
READERS := $(addprefix $(B)/readers/,$(READER_NAMES))
READER_LINK_peer := -Wl,--wrap=pipe_child_start,--wrap=pipe_child_stop,--wrap=pipe_child_is_early
$(B)/readers/%: $(B)/obj/tests/readers/entry_%.o $(addprefix $(B)/obj/,$(READER_SRC:.c=.o) tests/readers/main.o) \
    $(B)/libraydiff.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -o $@ $(filter %.o,$^) $(or $(READER_WHOLE_$*),$(filter %.a,$^)) $(LDLIBS) $(READER_LINK_$*)
tests: $(READERS)
$(B)/tests/test_readers: $(addprefix $(B)/obj/,$(READER_SRC:.c=.o))
$(B)/tests/test_readers: TEST_LIBS += $(B)/libraydiff.a $(LDLIBS) # needed by these objects

# 2. With a fuzzing engine and the library compiled for it: make readers-engine READER_OUT=FOLDER.
#   READER_CC, READER_FLAGS        compiler and its flags
#   READER_LINK, READER_LINK_FLAGS linker and its flags
#   READER_ENGINE                what to link as the engine
#   READER_LIBS                  libraries
READER_OUT    ?= $(OUT)/readers-libfuzzer
READER_CC     ?= clang
READER_FLAGS  ?= -g -O1 -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow \
               -fno-sanitize-recover=all -fno-omit-frame-pointer
READER_LINK   ?= $(READER_CC)
READER_LINK_FLAGS ?= $(READER_FLAGS)
READER_ENGINE ?= -fsanitize=fuzzer
READER_LIBS   ?= $(LDLIBS)
# -Itests/readers/single: no OpenMP, one thread.
READER_CMD = $(READER_CC) -Itests/readers/single $(CPPFLAGS) -std=c17 $(READER_FLAGS) $(FP)
READER_LIB_OBJ := $(LIB_SRC:%.c=$(READER_OUT)/obj/%.o) $(GEN_SRC:$(B)/%.c=$(READER_OUT)/obj/%.o)

$(READER_OUT)/flags: FORCE
	$(call written,'$(subst ','\'',$(READER_CMD) $(READER_LINK) $(READER_ENGINE))')
$(READER_OUT)/obj/gen/%.o: $(B)/gen/%.c $(READER_OUT)/flags
	@mkdir -p $(@D)
	$(READER_CMD) -MMD -MP -c -o $@ $<
$(READER_OUT)/obj/%.o: %.c $(READER_OUT)/flags | $(B)/gen/counts.h
	@mkdir -p $(@D)
	$(READER_CMD) -MMD -MP -c -o $@ $<
$(READER_OUT)/libreaders.a: $(READER_LIB_OBJ) $(READER_SRC:%.c=$(READER_OUT)/obj/%.o)
	@rm -f $@
	$(AR) rcs $@ $^
$(READER_OUT)/fuzz_%: $(READER_OUT)/obj/tests/readers/entry_%.o $(READER_OUT)/libreaders.a
	$(READER_LINK) $(READER_LINK_FLAGS) -o $@ $^ $(READER_ENGINE) $(READER_LIBS) $(READER_LINK_$*)
readers-engine: $(addprefix $(READER_OUT)/fuzz_,$(READER_NAMES))
-include $(wildcard $(READER_OUT)/obj/*/*.d $(READER_OUT)/obj/*/*/*.d)

# The program makes the seeds. Inputs that once failed are kept in tests/readers/found.
$(B)/readers/seeds: $(B)/raydiff tests/readers/seeds.sh $(wildcard fuzz/corpus/*.trial)
	sh tests/readers/seeds.sh $(B) $@
tests: $(B)/readers/seeds
