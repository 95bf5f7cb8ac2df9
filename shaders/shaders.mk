# SPIR-V of every shaders/*.comp, and of a renderer for each layout, checked and decorated by our
# tool, and its embedding into C.
SHADERS  := $(wildcard shaders/*.comp)
RENDERED := $(patsubst shaders/layout_%.glsl,render_%,$(wildcard shaders/layout_*.glsl))
STACKLESS := $(patsubst shaders/layout_%.glsl,stackless_%,\
               $(shell grep -L 'define WIDE' shaders/layout_*.glsl)) # of binary layouts
SPV      := $(SHADERS:shaders/%.comp=$(B)/spv/%.spv) $(RENDERED:%=$(B)/spv/%.spv) \
            $(STACKLESS:%=$(B)/spv/%.spv)


GLSLANG ?= glslangValidator
HOSTCC  ?= cc

TOOL := $(B)/spirv_tool

TOOL_SRC := shaders/spirv_tool.c gpu/shaders/spirv_fix.c ref/base/base.c ref/base/memory.c
$(TOOL): $(TOOL_SRC) gpu/shaders/spirv_fix.h ref/base/base.h
	@mkdir -p $(@D)
	$(call warned,$(HOSTCC) -I. -std=c17 -O1 $(WARN) -o $@ $(TOOL_SRC))

# A layout's renderer is made of its file alone: $(RENDERED).
$(RENDERED:%=$(B)/gen/%.comp): $(B)/gen/render_%.comp: shaders/shaders.mk
	@mkdir -p $(@D)
	@printf '%s\n' '#version 450' '#extension GL_GOOGLE_include_directive : require' \
	    '#define RENDERING' '#include "layout_$*.glsl"' '#include "render_tree.glsl"' >$@

# So is its tracer without a stack, if it is binary: $(STACKLESS).
$(STACKLESS:%=$(B)/gen/%.comp): $(B)/gen/stackless_%.comp: shaders/shaders.mk
	@mkdir -p $(@D)
	@printf '%s\n' '#version 450' '#extension GL_GOOGLE_include_directive : require' \
	    '#define STACKLESS' '#include "layout_$*.glsl"' '#include "trace.glsl"' >$@

# -g0: names are no use at run time. Includes and abi.h come back through the depfile.
# Ray queries need SPIR-V 1.4, so they are of Vulkan 1.2.
$(B)/spv/raw/query_%.spv: TARGET := vulkan1.2
TARGET := vulkan1.1
compile = @mkdir -p $(@D); $(GLSLANG) --quiet -V --target-env $(TARGET) -g0 -I. \
    -Ishaders --depfile $(@:.spv=.d) -o $@ $<
$(B)/spv/raw/%.spv: shaders/%.comp
	$(compile)
$(B)/spv/raw/%.spv: $(B)/gen/%.comp
	$(compile)

$(B)/spv/%.spv: $(B)/spv/raw/%.spv $(TOOL)
	$(TOOL) fix $< $@

# The set of shaders is a prerequisite too: a shader removed must leave the table.
$(B)/spv/list: FORCE
	@mkdir -p $(@D)
	@echo '$(SPV)' | cmp -s - $@ || echo '$(SPV)' >$@

$(B)/gen/shaders.c: $(SPV) $(B)/spv/list $(TOOL)
	@mkdir -p $(@D)
	$(TOOL) embed $@ $(SPV)

# One that is gone makes what included it anew.
shaders/%.glsl: ;
-include $(wildcard $(B)/spv/raw/*.d)

# The text of our shaders, for those that are compiled at run time.
GLSL_TEXTS := $(sort $(wildcard shaders/*.glsl)) ref/abi.h
$(B)/gen/glsl_sources.c: $(GLSL_TEXTS) Makefile
	@mkdir -p $(@D)
	@{ echo '#include "gpu/shaders/glsl_text.h"'; echo 'const struct glsl_source glsl_sources[] = {'; \
	  for file in $(GLSL_TEXTS); do printf '{"%s",\n' "$${file#shaders/}"; \
	      sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$file; echo '},'; done; \
	  echo '{0, 0}};'; } >$@
