# Mutations: every small change of the code should make a test suite fail.
#   make mutation ROOM=ref/judge [SAMPLE=200] [SEED=1]      finished mutations are not repeated
# config=mutation builds library and commands as one shared object, which programs find by LD_LIBRARY_PATH
# first: one with a mutated unit in it takes its place in every program (tests/mutation/play.sh). config=coverage
# builds so, too: a basic block then has one address for all programs (tests/mutation/ran.c).
ifneq ($(IN_ONE),)
ifeq ($(config),coverage)
LIB_OBJ += $(B)/obj/tests/mutation/ran.o
LINK_IN_ONE := -Wl,-Bsymbolic-functions
$(B)/obj/tests/mutation/ran.o: private CFLAGS := $(filter-out -fsanitize-coverage=%,$(CFLAGS))
$(WRAPPED_TESTS): WHOLE = $(LIB_OBJ) $(PROGRAM_LIBS) # --wrap does not reach into a shared object
endif
$(B)/libraydiff.so: $(LIB_OBJ)
	$(CC) $(CFLAGS) -shared $(LINK_IN_ONE) -Wl,-soname,$(@F) -o $@ $^ $(LDLIBS) $(PROGRAM_LIBS)
	@echo '$^' | tr ' ' '\n' >$(B)/objects; echo '-fopenmp $(LDLIBS) $(PROGRAM_LIBS)' >$(B)/libraries
LDLIBS += -Wl,-rpath,$(abspath $(B))
$(B)/libraydiff.a: $(B)/libraydiff.so
	@echo 'INPUT($(abspath $<))' >$@
READER_WHOLE_peer = $(LIB_OBJ) $(PROGRAM_LIBS)
endif

MUTATE_SRC := $(addprefix tests/mutation/,mutator.c mutation.c token.c)
$(B)/mutate: $(MUTATE_SRC) $(wildcard tests/mutation/*.h)
	$(call warned,$(CC) -std=c17 -O2 $(WARN) -I. -o $@ $(MUTATE_SRC))

tests: $(B)/mutate

# Between a program and the Vulkan loader, to see which suites make which shader module.
$(B)/modules.so: tests/mutation/modules.c
	$(call warned,$(CC) -std=c17 -O2 $(WARN) -fPIC -shared -o $@ $<)
ifeq ($(config),coverage)
tests: $(B)/modules.so
endif

.PHONY: mutation mutation-map uncovered coverage
coverage:
	@$(MAKE) --no-print-directory -s -j$(JOBS) config=coverage all lib tests
	@perl tests/mutation/blocks.pl table $(OUT)/coverage/libraydiff.so >$(OUT)/coverage/table
# Lines that no suite of `make check` runs; about half an hour of two cores.
uncovered: coverage
	@rm -rf $(OUT)/coverage/ran && mkdir $(OUT)/coverage/ran
	-@RAN_BLOCKS=$(abspath $(OUT)/coverage/ran) sh tests/run.sh $(OUT)/coverage
	@perl tests/mutation/uncovered.pl $(OUT)/coverage $(ROOM)
mutation-map: coverage
	@sh tests/mutation/coverage.sh $(OUT)/coverage $(OUT)/mutation-map
mutation:
	@$(MAKE) --no-print-directory -s -j$(JOBS) config=mutation all tests $(OUT)/mutation/mutate
	@CC_CMD='$(subst ',,$(CC) $(CPPFLAGS) $(filter-out $(OPT_$(config)),$(CFLAGS)) $(OPT_mutation))' TOOL_SRC='$(TOOL_SRC)' \
	    sh tests/mutation/run.sh $(OUT)/mutation '$(ROOM)' '$(or $(SAMPLE),200)' '$(or $(SEED),1)'
