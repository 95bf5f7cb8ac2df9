# Mutants of the shaders' SPIR-V: which of them the suites catch.
#   make shader-mutants [SHADER=trace_f32] [SAMPLE=200] [SEED=1] [PIPELINES=0]
SHADER_MUTANTS_SRC := $(filter-out tests/shader_mutants/test_% %/swap_layer.c,$(wildcard tests/shader_mutants/*.c))
SHADER_MUTANTS_OBJ := $(SHADER_MUTANTS_SRC:%.c=$(B)/obj/%.o)
$(B)/shader_mutants: $(SHADER_MUTANTS_OBJ) $(if $(IN_ONE),,$(B)/libcommands.a) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(PROGRAM_LIBS)
$(B)/tests/test_spirv_mutant: $(addprefix $(B)/obj/tests/shader_mutants/,spirv_mutant.o spirv_mutant_operands.o spirv_mutant_values.o spirv_live.o)

# Plays mutants of the shaders that trace scenes; what is done is kept in build/shader-mutants: a run can be ended and
# resumed. Survivors of conform and the hard cases are played on the shaders' own tests.
TRACING := $(TRACED) $(STACKLESS) trace_brute
MUTANT_TESTS := $(addprefix $(B)/tests/test_,vulkan_shaders grid_gpu vulkan_drivers vulkan_trace vulkan_stores vulkan_slots stackless \
    vulkan_tasks vulkan_watertight vulkan_trace_ends lists_exact)
.PHONY: shader-mutants
shader-mutants:
	@$(MAKE) --no-print-directory -s -j$(JOBS) spv $(B)/shader_mutants $(MUTANT_TESTS)
	@sh tests/shader_mutants/run.sh $(B) $(B)/shader-mutants '$(or $(SAMPLE),200)' '$(or $(SEED),1)' $(or $(SHADER),$(TRACING))
tests: $(B)/shader_mutants
