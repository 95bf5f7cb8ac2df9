# The planted bugs of raydiff fuzz --self-test (fuzz/selftest.txt): a program for each in $(B)/mutants,
# with one unit or one shader compiled with the bug. Their table is copied to the same folder.
SELFTEST := $(B)/mutants
# BUG:UNIT of every line.
PLANTED := $(shell awk '!/^#/ && NF {print $$1 ":" $$2}' fuzz/selftest.txt)
PLANTED_DIRS :=

RECORDS := $(wildcard tests/planted/*.txt) tests/planted/plant.sh
# The files with the bug, in a tree that is searched before the original files.
define plant_tree
$(SELFTEST)/$(1).$(2)/planted: $(RECORDS) $(3)
	@mkdir -p $$(@D)
	@rm -rf $$(@D)/tree && sh tests/planted/plant.sh $(1) $$(@D)/tree && touch $$@
endef
# $(call plant,BUG,UNIT) for a C unit. It is linked before the library, and so replaces its unit.
define plant_unit
$(call plant_tree,$(1),$(basename $(notdir $(2))),$(2))
$(SELFTEST)/$(1).$(basename $(notdir $(2)))/unit.o: $(SELFTEST)/$(1).$(basename $(notdir $(2)))/planted $(B)/gen/flags
	$$(CC) -iquote $$(@D)/tree $$(CPPFLAGS) $$(CFLAGS) -MMD -MP -c -o $$@ $$(or $$(wildcard $$(@D)/tree/$(2)),$(2))
endef
# For a shader: its SPIR-V replaces the original. The bug may also be in the tool that decorates it.
define plant_shader
$(call plant_tree,$(1),$(2),$(wildcard shaders/*.glsl shaders/*.comp shaders/*/*.glsl))
	@mkdir -p $$(@D)/shaders && sh tests/planted/shaders.sh $$(@D)/tree $$(@D)/shaders
$(SELFTEST)/$(1).$(2)/tool: $(SELFTEST)/$(1).$(2)/planted $(TOOL_SRC)
	$$(HOSTCC) -iquote $$(@D)/tree -I. -std=c17 -O1 $$(WARN) -o $$@ \
	    $$(foreach source,$(TOOL_SRC),$$(or $$(wildcard $$(@D)/tree/$$(source)),$$(source)))
$(SELFTEST)/$(1).$(2)/raw/$(2).spv: $(SELFTEST)/$(1).$(2)/planted $(B)/gen/$(2).comp
	@mkdir -p $$(@D)
	$$(GLSLANG) --quiet -V --target-env vulkan1.1 -I. -I$$(<D)/shaders -o $$@ $(B)/gen/$(2).comp
$(SELFTEST)/$(1).$(2)/$(2).spv: $(SELFTEST)/$(1).$(2)/raw/$(2).spv $(SELFTEST)/$(1).$(2)/tool
	$(SELFTEST)/$(1).$(2)/tool fix $$< $$@
$(SELFTEST)/$(1).$(2)/unit.c: $(SELFTEST)/$(1).$(2)/$(2).spv $(SPV) $(TOOL)
	$$(TOOL) embed $$@ $(SPV:$(B)/spv/$(2).spv=$(SELFTEST)/$(1).$(2)/$(2).spv)
$(SELFTEST)/$(1).$(2)/unit.o: $(SELFTEST)/$(1).$(2)/unit.c $(B)/gen/flags
	$$(CC) $$(CPPFLAGS) $$(CFLAGS) -c -o $$@ $$<
endef
plant = $(if $(filter %.c,$(2)),$(call plant_unit,$(1),$(2)),$(call plant_shader,$(1),$(2)))

$(foreach one,$(PLANTED),$(eval $(call plant,$(word 1,$(subst :, ,$(one))),$(word 2,$(subst :, ,$(one))))))
$(foreach one,$(PLANTED),$(eval PLANTED_DIRS += \
    $(SELFTEST)/$(word 1,$(subst :, ,$(one))).$(basename $(notdir $(word 2,$(subst :, ,$(one)))))))

$(SELFTEST)/%/raydiff: $(SELFTEST)/%/unit.o $(CMD_OBJ) $(B)/libraydiff.a
	$(CC) $(CFLAGS) -s -o $@ $(CMD_OBJ) $< $(B)/libraydiff.a $(LDLIBS) $(GLSLANG_LIBS)

$(SELFTEST)/selftest.txt: fuzz/selftest.txt
	@mkdir -p $(@D)
	cp $< $@

# All of them; or a few with at least one of each kind of program, for `make check`.
planted: $(B)/raydiff $(SELFTEST)/selftest.txt $(addsuffix /raydiff,$(PLANTED_DIRS))
.PHONY: planted planted-quick

comma := ,
empty :=
QUICK := HALF_NEAREST.half BOUNDS_BY_EXTENT.top_down CONTRACTED_EDGE.trace TMAX_UNREAD.trace \
         LOST_SLOT.trace_rf16 NO_PRECISE.trace_f32
planted-quick: $(B)/raydiff $(SELFTEST)/selftest.txt $(QUICK:%=$(SELFTEST)/%/raydiff)
QUICK_NAMES := $(subst $(empty) $(empty),$(comma),$(strip $(QUICK)))

-include $(wildcard $(addsuffix /unit.d,$(PLANTED_DIRS)))
