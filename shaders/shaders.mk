# SPIR-V of every shader, checked and decorated by $(TOOL), and embedded into C.
SHADERS  := $(wildcard shaders/*.comp shaders/probes/*.comp shaders/build/*.comp)
# Shaders generated for each layout: its tracer, its renderer, a tracer of worlds, a probe of its nodes and, for
# binary layouts, a tracer without a stack.
LAYOUTS  := $(patsubst shaders/layouts/layout_%.glsl,%,$(wildcard shaders/layouts/layout_*.glsl))
BINARY   := $(patsubst shaders/layouts/layout_%.glsl,%,$(shell grep -L 'define WIDE' shaders/layouts/layout_*.glsl))
TRACED   := $(LAYOUTS:%=trace_%)
RENDERED := $(LAYOUTS:%=render_%)
STACKLESS := $(BINARY:%=stackless_%)
WORLDS   := $(LAYOUTS:%=world_%)
NODES    := $(LAYOUTS:%=nodes_%)
MADE     := $(TRACED) $(RENDERED) $(STACKLESS) $(WORLDS) $(NODES)
SPV      := $(patsubst %,$(B)/spv/%.spv,$(basename $(notdir $(SHADERS))) $(MADE))

GLSLANG ?= glslangValidator
HOSTCC  ?= cc

TOOL := $(B)/spirv_tool

TOOL_SRC := shaders/spirv_tool.c gpu/shaders/spirv_fix.c ref/base/base.c ref/base/memory.c
$(TOOL): $(TOOL_SRC) gpu/shaders/spirv_fix.h gpu/shaders/spirv_words.h ref/base/base.h
	@mkdir -p $(@D)
	$(call warned,$(HOSTCC) -I. -std=c17 -O1 $(WARN) -o $@ $(TOOL_SRC))

# $(call made,LAYOUT,DEFINE,FILE) writes such a shader; DEFINE may be empty.
hash := \#
made = @mkdir -p $(@D); printf '%s\n' '$(hash)version 450' '$(hash)extension GL_GOOGLE_include_directive : require' \
    $(if $(2),'$(hash)define $(2)') '$(hash)include "layout_$(1).glsl"' '$(hash)include "$(3).glsl"' >$@
$(TRACED:%=$(B)/gen/%.comp): $(B)/gen/trace_%.comp: shaders/shaders.mk
	$(call made,$*,,trace)
$(RENDERED:%=$(B)/gen/%.comp): $(B)/gen/render_%.comp: shaders/shaders.mk
	$(call made,$*,RENDERING,render_tree)
$(STACKLESS:%=$(B)/gen/%.comp): $(B)/gen/stackless_%.comp: shaders/shaders.mk
	$(call made,$*,STACKLESS,trace)

$(WORLDS:%=$(B)/gen/%.comp): $(B)/gen/world_%.comp: shaders/shaders.mk
	$(call made,$*,WORLDS,world)
$(NODES:%=$(B)/gen/%.comp): $(B)/gen/nodes_%.comp: shaders/shaders.mk
	$(call made,$*,,nodes)

# Of its names $(TOOL) keeps those of functions, for raydiff bisect. The depfile lists the includes and abi.h.
# Ray queries need SPIR-V 1.4 and so Vulkan 1.2.
$(B)/spv/plain/query_%.spv: TARGET := vulkan1.2
TARGET := vulkan1.1
compile = @mkdir -p $(@D); $(GLSLANG) --quiet -V --target-env $(TARGET) -I. \
    -Ishaders -Ishaders/layouts --depfile $(@:.spv=.d) -o $@ $<
$(B)/spv/plain/%.spv: shaders/%.comp shaders/shaders.mk
	$(compile)
$(B)/spv/plain/%.spv: shaders/probes/%.comp shaders/shaders.mk
	$(compile)
$(B)/spv/plain/%.spv: shaders/build/%.comp shaders/shaders.mk
	$(compile)
$(B)/spv/plain/%.spv: $(B)/gen/%.comp
	$(compile)

$(B)/spv/%.spv: $(B)/spv/plain/%.spv $(TOOL)
	$(TOOL) fix $< $@

# The list of shaders is a prerequisite, too: a removed shader must be removed from the table.
$(B)/spv/list: FORCE
	@mkdir -p $(@D)
	@echo '$(SPV)' | cmp -s - $@ || echo '$(SPV)' >$@

$(B)/gen/shaders.c: $(SPV) $(B)/spv/list $(TOOL)
	@mkdir -p $(@D)
	$(TOOL) embed $@ $(SPV)

# If an included file was removed, the shaders that included it are rebuilt.
shaders/%.glsl: ;
-include $(wildcard $(B)/spv/plain/*.d)

# The text of WGSL and of the program that runs it, for engine webgpu.
WGSL_TEXTS := $(sort $(wildcard shaders/wgsl/*.wgsl) gpu/webgpu/core.js gpu/webgpu/peer.js)
$(B)/gen/wgsl_sources.c: gpu/webgpu/embed.sh $(WGSL_TEXTS)
	@mkdir -p $(@D)
	@sh gpu/webgpu/embed.sh $(WGSL_TEXTS) >$@

# The text of the shaders, for those that are compiled at run time.
GLSL_TEXTS := $(sort $(wildcard shaders/*.glsl shaders/layouts/*.glsl)) ref/abi.h ref/abi_frame.h ref/abi_world.h
$(B)/gen/glsl_sources.c: $(GLSL_TEXTS) Makefile
	@mkdir -p $(@D)
	@{ echo '#include "gpu/shaders/glsl_text.h"'; echo 'const struct glsl_source glsl_sources[] = {'; \
	  for file in $(GLSL_TEXTS); do printf '{"%s",\n' "$$(echo $$file | sed 's|^shaders/\(.*/\)*||')"; \
	      sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$file; echo '},'; done; \
	  echo '{0, 0}};'; } >$@
