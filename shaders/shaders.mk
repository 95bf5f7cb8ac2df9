# SPIR-V of every shaders/*.comp, checked and decorated by our tool, and its embedding into C.
GLSLANG ?= glslangValidator
HOSTCC  ?= cc
# Number of a planted bug (ref/mutant.h); 0 in everything that is shipped.
MUTANT  ?= 0

TOOL := $(B)/spirv_tool

$(TOOL): shaders/spirv_tool.c ref/mutant.h
	@mkdir -p $(@D)
	$(HOSTCC) -I. -std=c17 -O1 $(WARN) -DMUTANT=$(MUTANT) -o $@ $<

# -g0: names are no use at run time. Includes and abi.h come back through the depfile.
$(B)/spv/raw/%.spv: shaders/%.comp
	@mkdir -p $(@D)
	$(GLSLANG) --quiet -V --target-env vulkan1.1 -g0 -DMUTANT=$(MUTANT) -I. -Ishaders \
	    --depfile $(@:.spv=.d) -o $@ $<

$(B)/spv/%.spv: $(B)/spv/raw/%.spv $(TOOL)
	$(TOOL) fix $< $@

# The set of shaders is a prerequisite too: a shader removed must leave the table.
$(B)/spv/list: FORCE
	@mkdir -p $(@D)
	@echo '$(SPV)' | cmp -s - $@ || echo '$(SPV)' >$@

$(B)/gen/shaders.c: $(SPV) $(B)/spv/list $(TOOL)
	@mkdir -p $(@D)
	$(TOOL) embed $@ $(SPV)

-include $(wildcard $(B)/spv/raw/*.d)
