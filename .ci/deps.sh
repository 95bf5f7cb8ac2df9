#!/bin/sh
# Installs the Debian packages that a purpose needs and that are missing, saying what and why.
#   .ci/deps.sh run|check|deep|report|parallel|slurm|site
# Does nothing, without network, once they are there. Uses sudo when not root.
set -u

purpose=${1:-run}
run='gcc:compiler libc6-dev:C_library pkg-config:finds_the_libraries libembree-dev:Embree,_the_third_opinion
libvulkan-dev:Vulkan_headers_and_loader mesa-vulkan-drivers:lavapipe,_Vulkan_without_a_GPU
glslang-tools:compiles_the_shaders libjansson-dev:JSON zlib1g-dev:gz_files
libpng-dev:pictures'
check="$run glslang-dev:shaders_of_layouts_from_outside g++:the_C++_library_that_glslang_wants
libcmocka-dev:unit_tests spirv-tools:validates_and_optimises_SPIR-V
spirv-cross:translates_shaders_to_GLSL_and_HLSL glslc:compiles_them_as_shaderc_does
vulkan-validationlayers:Vulkan_validation libgmp-dev:rationals_that_check_the_oracle
tmux:screens_of_terminals libsdl2-dev:the_window xvfb:a_screen_for_it xdotool:presses_its_keys
python3-numpy:the_library_from_Python"
deep="$check clang:second_compiler,_TSan libomp-dev:OpenMP_that_TSan_understands
clang-format:make_format zsh:reads_its_completion
abigail-tools:abidiff"
parallel="$run parallel:shards_on_many_machines"
report="$check chromium:opens_the_report"
site=pandoc:the_pages_as_HTML
slurm="$run slurm-wlm:shards_as_a_job_array munge:which_Slurm_needs"
case $purpose in
run) wanted=$run ;;
check) wanted=$check ;;
deep) wanted=$deep ;;
report) wanted=$report ;;
parallel) wanted=$parallel ;;
slurm) wanted=$slurm ;;
site) wanted=$site ;;
*)
    echo "usage: .ci/deps.sh run|check|deep|report|parallel|slurm|site" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null 2>&1; then
    echo "setup: not a Debian system: nothing is installed; needed: $(echo $wanted | sed 's/:[^ ]*//g')"
    exit 0
fi

missing=
for entry in $wanted; do
    package=${entry%%:*}
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)
    if [ "$state" != installed ]; then
        missing="$missing $package"
        echo "setup: will install $package ($(echo "${entry#*:}" | tr _ ' '))"
    fi
done
[ -n "$missing" ] || exit 0

sudo=
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
        echo "setup: neither root nor sudo: ask an administrator for: apt-get install$missing" >&2
        exit 2
    fi
    sudo=sudo
fi
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp) || exit 4
trap 'rm -f "$log"' EXIT
install() { $sudo apt-get install -y --no-install-recommends $missing >"$log" 2>&1; }
echo "setup: apt-get install$missing"
# Package lists may be absent or old: update once and try again.
if ! install && ! { $sudo apt-get update >"$log" 2>&1 && install; }; then
    tail -n 5 "$log" >&2
    echo "setup: apt-get failed (above); needed:$missing" >&2
    exit 2
fi
