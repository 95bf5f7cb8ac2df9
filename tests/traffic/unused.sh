#!/bin/sh
# raydiff bench traffic: an option is refused exactly where none of the schedulers that are named uses it.
#   sh tests/traffic/unused.sh RAYDIFF
set -u
raydiff=$1
. tests/scripts/expect.sh

# scheduler: the options that it uses
uses() {
    case $1 in
    depth_first | sorted) echo units lanes private layout store ;;
    packets) echo units packet private layout store ;;
    treelets | strata | mach_rt) echo units treelet queue private layout store ;;
    dual) echo treelet layout store ;;
    raycore) echo units private ;;
    esac
}
for scheduler in depth_first sorted packets treelets strata dual mach_rt raycore; do
    for option in units=2 lanes=2 packet=3 treelet=4k queue=9 private=1k:2:64 layout=rf16 store=gathered; do
        name=${option%%=*}
        case " $(uses $scheduler) " in *" $name "*) code=0 ;; *) code=2 ;; esac
        expect $code "--$name: not used by the schedulers named" bench traffic --scene cornell --count 20 \
            --scheduler $scheduler "--$name" "${option#*=}"
    done
done
# One of two that are named is enough.
expect 0 . bench traffic --scene cornell --count 20 --scheduler raycore,packets --packet 3
expect 2 'packet: not used' bench traffic --scene cornell --count 20 --scheduler raycore,dual --packet 3
# A treelet that is smaller than a node of one of the layouts is refused, wherever that one stands.
for layouts in f32 rf16 cwbvh80 f32,rf16 rf16,f32 f32,rf16,cwbvh80 cwbvh80,f32,rf16 rf16,cwbvh80,f32; do
    for bytes in 8 24 48 79 4096; do
        least=
        for layout in $(echo $layouts | tr , ' '); do
            case $layout in rf16) node=16 ;; f32) node=32 ;; cwbvh80) node=80 ;; esac
            [ -n "$least" ] || [ $bytes -ge $node ] || least="treelet: $bytes bytes are smaller than a node of layout $layout, $node bytes"
        done
        [ -n "$least" ] || [ $bytes -eq 4096 ] || continue # its triangles are in it, too
        expect $([ -z "$least" ] && echo 0 || echo 2) "$least" bench traffic --scene cornell --count 20 --scheduler treelets \
            --layout $layouts --treelet $bytes
    done
done
echo "traffic options: $failed failed"
[ "$failed" -eq 0 ]
