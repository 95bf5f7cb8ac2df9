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
# Ray queries need SPIR-V 1.4, so they are of Vulkan 1.2.
$(B)/spv/raw/query_%.spv: TARGET := vulkan1.2
TARGET := vulkan1.1
$(B)/spv/raw/%.spv: shaders/%.comp
	@mkdir -p $(@D)
	$(GLSLANG) --quiet -V --target-env $(TARGET) -g0 -DMUTANT=$(MUTANT) -I. -Ishaders \
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
