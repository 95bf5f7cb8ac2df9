# Mutants of the shaders' SPIR-V: which of them the suites catch.
#   make shader-mutants [SHADER=trace_f32] [SAMPLE=200] [SEED=1] [PIPELINES=0]
SHADER_MUTANTS_SRC := $(filter-out tests/shader_mutants/test_% %/swap_layer.c,$(wildcard tests/shader_mutants/*.c))
SHADER_MUTANTS_OBJ := $(SHADER_MUTANTS_SRC:%.c=$(B)/obj/%.o)
$(B)/shader_mutants: $(SHADER_MUTANTS_OBJ) $(if $(filter mutation,$(config)),,$(B)/libcommands.a) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -o $@ $^ $(LDLIBS) $(PROGRAM_LIBS)
$(B)/tests/test_spirv_mutant: $(addprefix $(B)/obj/tests/shader_mutants/,spirv_mutant.o spirv_mutant_operands.o spirv_mutant_values.o spirv_live.o)
