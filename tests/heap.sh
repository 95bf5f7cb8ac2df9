# Variables under which the C library looks at a block of memory when it is freed: a byte written behind it, or a
# second free, ends the program. A new block is not zero unless it was zeroed. Read by shells: . tests/heap.sh
heap='LD_PRELOAD=libc_malloc_debug.so.0 MALLOC_CHECK_=3 MALLOC_PERTURB_=165'
# The variables for a suite, by its name. What runs shaders goes without: a driver's own blocks take most of the time.
heap_of() {
    case $1 in
    *vulkan* | *gpu* | test_abi | test_rayquery*) ;;
    test_*) echo "$heap" ;;
    esac
}
