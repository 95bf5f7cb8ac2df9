# The public library (ref/library/raydiff.h) as a shared object, which `make lib` makes beside the static one.
# Of the rooms below only what the interface needs is linked. Their objects are those of the program: compiled once, so
# that both have the same bits. config=mutation and config=coverage have a shared object of their own.
ABI := $(shell sed -n 's/^\#define RAYDIFF_ABI //p' ref/library/raydiff.h)
SHARED_ROOMS := $(addprefix ref/,base build builders fast integers judge layouts library match oracle outside packed \
                  primitives scene staged store trace tree twin two_level world) scenes/rays fuzz/play fuzz/shrink
SHARED_OBJ := $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(SHARED_ROOMS:%=%/*.c) scenes/life_*.c scenes/world_motion.c) scenes/move.c)
SHARED_OWN := $(filter $(B)/obj/ref/library/%,$(SHARED_OBJ))
SHARED     := $(B)/shared/libraydiff.so.$(ABI)
PIC        := -fPIC -fvisibility=hidden -ffunction-sections -fdata-sections
ifeq ($(IN_ONE),)
$(SHARED_OBJ): ref/library/library.mk
$(SHARED_OBJ): private CFLAGS := $(CFLAGS) $(PIC)
# Its types are told to debuggers, and compared with those of its interface before.
$(SHARED_OWN): private CFLAGS := $(CFLAGS:-g1=-g) $(PIC)
endif

$(B)/shared/pic.a: $(SHARED_OBJ)
	@mkdir -p $(@D)
	@rm -f $@
	$(AR) rcs $@ $^

# Sanitizers leave symbols to the program. A library must not end its user's program: a broken invariant
# (ref/base/invariant.h) is gone past.
$(SHARED): $(SHARED_OWN) $(B)/shared/pic.a ref/library/raydiff.map
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,--version-script=ref/library/raydiff.map \
	    -Wl,--defsym,invariant_broken=library_goes_on -Wl,--gc-sections -Wl,--as-needed \
	    $(if $(filter sanitize tsan,$(config)),,-Wl,--no-undefined) \
	    -o $@ $(SHARED_OWN) $(B)/shared/pic.a -lm -lpthread
	@ln -sf $(@F) $(B)/shared/libraydiff.so

ifeq ($(IN_ONE),)
lib: $(SHARED)
endif

# Where Python looks for modules depends on the system: Debian's packages set this to dist-packages.
PYTHON_DIR ?= $(PREFIX)/share/raydiff/python
.PHONY: install-library uninstall-library
install: install-library
install-library: lib
	install -Dm644 $(B)/libraydiff.a $(DESTDIR)$(LIBDIR)/libraydiff.a
	install -Dm644 $(SHARED) $(DESTDIR)$(LIBDIR)/libraydiff.so.$(ABI)
	ln -sf libraydiff.so.$(ABI) $(DESTDIR)$(LIBDIR)/libraydiff.so
	install -Dm644 ref/library/raydiff.h $(DESTDIR)$(PREFIX)/include/raydiff/raydiff.h
	install -Dm644 ref/library/raydiff.py $(DESTDIR)$(PYTHON_DIR)/raydiff.py
	install -d $(DESTDIR)$(LIBDIR)/pkgconfig
	for pc in ref/raydiff.pc ref/library/libraydiff.pc; do \
	    sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@LIBS@|$(LDLIBS)|' \
	        $$pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/$${pc##*/} || exit 1; done
uninstall: uninstall-library
uninstall-library:
	rm -f $(addprefix $(DESTDIR)$(LIBDIR)/,libraydiff.a libraydiff.so libraydiff.so.$(ABI) \
	      pkgconfig/raydiff.pc pkgconfig/libraydiff.pc) $(DESTDIR)$(PYTHON_DIR)/raydiff.py
	-rmdir $(DESTDIR)$(PREFIX)/share/raydiff/python $(DESTDIR)$(PREFIX)/share/raydiff 2>/dev/null
