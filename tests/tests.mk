# Unit test programs, sample tracers, and what they are linked with.
TEST_SRC := $(wildcard tests/*/test_*.c)
TESTS    := $(addprefix $(B)/tests/,$(notdir $(TEST_SRC:.c=)))
SAMPLES  := $(addprefix $(B)/samples/,tracer tracer_bug1 tracer_bug2 refuser)
TEST_OBJ := $(TEST_SRC:%.c=$(B)/obj/%.o)

tests: $(TESTS) $(SAMPLES)
.PHONY: tests truth

# All programs are in one folder, whatever the folder of their source. $(B)/links/NAME lists what a
# program is linked with except its own object, for scripts that link it again.
$(foreach object,$(TEST_OBJ),$(eval $(B)/tests/$(basename $(notdir $(object))): $(object)))
$(TESTS): $(B)/libraydiff.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(TEST_LDFLAGS) -o $@ $(filter %.o,$^) $(or $(WHOLE),$(filter %.a,$^)) $(LDLIBS) $(CMOCKA_LIBS) $(TEST_LIBS)
	@mkdir -p $(B)/links; echo '$(filter-out %/$(@F).o,$(filter %.o,$^)) $(filter %.a,$^) $(LDLIBS) $(CMOCKA_LIBS) $(TEST_LIBS)' >$(B)/links/$(@F)

# A test runs for seconds, nearly all of them in the library: without the optimiser it ends sooner, and so does what
# has no symbols for a debugger (config=debug has). What tests share computes more. The linker gold, where there is
# one, takes less than half of the time.
ifeq ($(config),release)
TEST_HELPERS := $(patsubst %.c,$(B)/obj/%.o,$(filter-out $(TEST_SRC),$(wildcard tests/*/*.c)))
$(TEST_OBJ): CFLAGS := $(filter-out -g -g1,$(CFLAGS:-O3=-O0))
$(TEST_HELPERS): CFLAGS := $(filter-out -g -g1,$(CFLAGS:-O3=-O1))
TEST_LDFLAGS := -Wl,-S $(if $(shell command -v ld.gold),-fuse-ld=gold)
endif

$(TEST_OBJ): | test_libs
.PHONY: test_libs
test_libs:
	@$(if $(TEST_LIBS_MISSING),echo "make: missing to build the tests: $(TEST_LIBS_MISSING)" >&2; exit 2,:)

# Sample tracers for `--engine pipe:`, compiled without anything of raydiff, as users would. The
# planted bugs must be found.
$(B)/samples/%: fuzz/samples/sample_tracer.c
	@mkdir -p $(@D)
	$(call warned,$(CC) -std=c17 -O2 $(WARN) $(if $(findstring _bug,$*),-DBUG=$(lastword $(subst _bug, ,$*))) -o $@ $<)

# A tracer that tests nothing, which must be detected.
$(B)/samples/refuser: tests/peers/refuser.c
	@mkdir -p $(@D)
	$(CC) -std=c17 -O2 $(WARN) -o $@ $<

# Tracers that are shared objects, compiled with one header of raydiff's.
$(B)/samples/guest_brute.so: fuzz/samples/engine/brute_engine.c
$(B)/samples/guest_bad.so $(B)/samples/guest_none.so: tests/peers/guest_bad.c
$(B)/samples/guest_none.so: GUEST_FLAGS := -DSYMBOL=another_name
GUESTS := $(addprefix $(B)/samples/guest_,brute.so bad.so none.so)
$(GUESTS): ref/raydiff_engine.h
	@mkdir -p $(@D)
	$(call warned,$(CC) -std=gnu11 -O2 -ffp-contract=off $(WARN) $(GUEST_FLAGS) -shared -fPIC -I. -o $@ $(filter %.c,$^))
$(B)/tests/test_guest $(addprefix $(B)/tests/test_guest_,load world lists move): | $(GUESTS)

# The oracle is checked against GMP rationals, which only tests use.
ORACLE_TESTS := $(filter $(B)/tests/test_oracle%,$(TESTS))
$(ORACLE_TESTS): $(B)/obj/tests/exact/exact_gmp.o $(B)/obj/tests/exact/exact_gmp_bounds.o \
    $(B)/obj/tests/exact/exact_gmp_allow.o \
    $(B)/obj/tests/exact/exact_gmp_bounds_baldwin.o $(B)/obj/tests/exact/exact_gmp_redecide.o \
    $(B)/obj/tests/exact/exact_gmp_replay.o $(B)/obj/tests/exact/oracle_cases.o \
    $(addprefix $(B)/obj/tests/exact/,pair_fault.o gmp_world.o world_cases.o)
$(ORACLE_TESTS): TEST_LIBS += $(GMP_LIBS)
BOUNDS_TESTS := $(filter $(B)/tests/test_bounds% $(B)/tests/test_judge_noise $(B)/tests/test_judge_range $(B)/tests/test_judge_unnamed,$(TESTS))
JUDGE_WORLD_TESTS := $(filter $(B)/tests/test_judge_world% $(B)/tests/test_judge_memory $(B)/tests/test_bounds_world,$(TESTS))
TRIAL_TESTS := $(BOUNDS_TESTS) $(B)/tests/test_judge_exact $(JUDGE_WORLD_TESTS)
$(JUDGE_WORLD_TESTS): $(B)/obj/tests/judge/honest_world.o
$(TRIAL_TESTS): $(addprefix $(B)/obj/tests/exact/,trials.o placed_trials.o legal.o legal_formulas.o exact_gmp.o oracle_cases.o)
$(TRIAL_TESTS): TEST_LIBS += $(GMP_LIBS)
$(B)/tests/test_bounds_placed_rays: $(B)/obj/tests/exact/exact_gmp_replay.o

$(B)/tests/test_scatter: $(B)/obj/tests/trace/scatter_truth.o
$(B)/tests/test_scatter $(B)/tests/test_kd_cover $(B)/tests/test_dump_lavapipe: TEST_LIBS += $(GMP_LIBS)
$(addprefix $(B)/tests/test_world_,inverse boxes redecide): TEST_LIBS += $(GMP_LIBS)
GMP_WORLD_OBJ := $(addprefix $(B)/obj/tests/exact/gmp_,world.o object_ray.o steady.o world_redecide.o)
$(B)/tests/test_world_redecide: $(GMP_WORLD_OBJ) $(addprefix $(B)/obj/tests/exact/,exact_gmp.o exact_gmp_replay.o)

# Published triangle tests, compiled with the flags of their users.
$(B)/tests/test_judge_blackbox $(B)/tests/test_match_edges: $(addprefix $(B)/obj/tests/judge/,honest_plain.o honest_fast.o)
$(B)/obj/tests/judge/honest_fast.o: CFLAGS += -ffast-math -ffp-contract=fast $(if $(filter x86_64%,$(shell $(CC) -dumpmachine)),-mfma)

$(B)/tests/test_adversaries: $(addprefix $(B)/obj/tests/adversaries/,cheats.o outsiders.o outsiders_table.o table.o)

$(B)/tests/test_traffic_memory: $(B)/obj/tests/traffic/plain_memory.o
$(addprefix $(B)/tests/test_,scene_treelets schedulers traffic_places): $(B)/obj/tests/traffic/traffic_fixture.o
$(addprefix $(B)/tests/test_,scene_treelets schedulers traffic_cuts traffic_no_memory traffic_order): $(B)/obj/tests/traffic/traffic_fixture.o

# Parts of commands, which are no part of the library (but of that for mutations).
COMMAND_TESTS := $(addprefix $(B)/tests/,$(notdir $(basename $(wildcard tests/commands/test_*.c))))
ifeq ($(IN_ONE),)
$(B)/libcommands.a: $(filter-out $(B)/obj/raydiff.o,$(CMD_OBJ))
	@rm -f $@
	$(AR) rcs $@ $^
$(COMMAND_TESTS): $(B)/libcommands.a
$(COMMAND_TESTS): TEST_LIBS += $(B)/libraydiff.a $(LDLIBS) $(PROGRAM_LIBS)
endif

# Events are put into the queue of SDL's library.
$(B)/obj/tests/scenes/test_window.o: CPPFLAGS += $(SDL2_CFLAGS)

# Their allocations are made to fail, or measured.
MEMORY_TESTS := $(addprefix $(B)/tests/test_,out_of_memory text_memory explain_memory cache_sim judge_memory oracle_world_memory hits_memory hits_tagged memory vulkan_memory world_memory worlds_memory library_memory wide_memory dump_memory dump_driver_memory world_life_memory traffic_no_memory accel_memory)
$(MEMORY_TESTS): TEST_LIBS += \
    -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free

# What it computes together is looked at.
$(B)/tests/test_judge_many: TEST_LIBS += -Wl,--wrap=twin_eval_many

# What the layer of validation tells is made up.
$(B)/tests/test_device_wide: TEST_LIBS += -Wl,--wrap=vk_messages

# What builders on a device compare is looked at.
$(B)/tests/test_builders_compare: TEST_LIBS += -Wl,--wrap=wide_compare

# Defects whose causes the test changes.
$(B)/tests/test_known_cause: TEST_LIBS += -Wl,--wrap=hard_defect_of
WRAPPED_TESTS := $(MEMORY_TESTS) $(addprefix $(B)/tests/test_,judge_many builders_compare known_cause)
# What build --same asks of a match is looked at, and answered.
$(B)/tests/test_build_same: TEST_LIBS += -Wl,--wrap=match_run
WRAPPED_TESTS := $(MEMORY_TESTS) $(B)/tests/test_judge_many $(B)/tests/test_builders_compare $(B)/tests/test_build_same

# A Vulkan within the program, which the loader of the library finds in it.
FAKE_VULKAN_TESTS := $(addprefix $(B)/tests/test_,card gather rays_grow world_words ways freed unlike_devices) \
    $(addprefix $(B)/tests/test_vulkan_,faults answers refusals frame_faults memory parts world_parts)
$(FAKE_VULKAN_TESTS): $(addprefix $(B)/obj/tests/gpu/,fake_vulkan.o fake_vulkan_device.o fake_vulkan_command.o \
        fake_vulkan_sets.o)
$(FAKE_VULKAN_TESTS): TEST_LIBS += -rdynamic

# Time of the library's judging beside the command's, and from Python. It measures: nothing else may run.
#   make library-speed [SCENE=flake:n=4] [RAYS=1000000]
.PHONY: library-speed
$(B)/library_speed: $(B)/obj/tests/library/library_speed.o $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS)
library-speed: all lib $(B)/library_speed
	@sh tests/library/speed.sh $(B) '$(or $(SCENE),flake:n=4)' $(or $(RAYS),1000000)

# The campaign of truth. It needs GMP, so it is not part of the program.
TRUTH_OBJ := $(patsubst %.c,$(B)/obj/%.o,$(wildcard tests/truth/*.c tests/exact/exact_gmp*.c tests/exact/gmp_*.c) \
               $(wildcard cmd/common/cmd_rows*.c) $(addprefix cmd/common/cmd_,tables.c options.c progress.c screen.c))
$(B)/truth: $(TRUTH_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(GMP_LIBS)
truth:
	@sh .ci/deps.sh check
	@$(MAKE) --no-print-directory -s -j$(JOBS) $(B)/truth
	@mkdir -p $(B)/truth-found
	$(B)/truth --out $(B)/truth-found $(ARGS)
