# Parts of the C programs that `raydiff export` writes, embedded as text and not compiled here.
TEMPLATES := $(sort $(wildcard fuzz/templates/*.c))
$(B)/gen/templates.c: $(TEMPLATES) Makefile
	@mkdir -p $(@D)
	{ echo '#include "fuzz/export/export_template.h"'; \
	  echo 'const struct export_template export_templates[] = {'; \
	  for file in $(TEMPLATES); do printf '{"%s",\n' "$${file##*/}"; \
	      sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' $$file; echo '},'; done; \
	  echo '{0, 0}};'; } >$@
