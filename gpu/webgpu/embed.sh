#!/bin/sh
# Writes C with the text of files, for gpu/webgpu/webgpu_text.h:
#   sh gpu/webgpu/embed.sh FILE... >OUT.c
echo '#include "gpu/webgpu/webgpu_text.h"'
echo 'const struct wgsl_source wgsl_sources[] = {'
for file; do
    printf '{"%s",\n' "${file##*/}"
    sed 's/[\\"?]/\\&/g; s/.*/"&\\n"/' "$file" || exit 1
    echo '},'
done
echo '{0, 0}};'
