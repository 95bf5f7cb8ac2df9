#!/bin/sh
# Makes the seed corpora of the readers: sh tests/readers/seeds.sh BUILD FOLDER
# A folder per entry, of small files: what raydiff itself writes, the repository's trials, and files
# by hand for what it does not write. Some are to be refused.
set -eu
raydiff=$1/raydiff
out=$2
rm -rf "$out" "$out.new"
for entry in obj ply rtrs stl world gltf gz trial tree packed dump peer text log baseline play png page; do
    mkdir -p "$out.new/$entry"
done
cd "$out.new"
case $raydiff in /*) ;; *) raydiff=$OLDPWD/$raydiff ;; esac
repository=$OLDPWD
quiet() { "$@" 2>/dev/null >/dev/null; }
said() { quiet "$@" || true; } # its exit code is a result

# "X,X,...,X" so many times.
many() {
    printf '%s' "$1"
    awk -v word=",$1" -v count="$2" 'BEGIN { for (i = 1; i < count; i++) printf "%s", word }'
}

# --- meshes
for scene in soup:n=4 sphere:n=3 grid:n=3 platonic needles:n=3; do
    name=$(echo $scene | tr -d ':=')
    quiet "$raydiff" scene convert $scene obj/$name.obj
    quiet "$raydiff" scene convert $scene ply/$name.ply
    quiet "$raydiff" scene convert $scene rtrs/$name.json
done
cat >obj/forms.obj <<'EOF'
# every form of a corner, a joined line, a colour, a weight
v 0 0 0
v 1 0 0 1.0
v 1 1 0 0.5 0.5 0.5
v 0 1 -1e-3
vt 0 0
vn 0 0 1
f 1 2 3 4
f 1/1 2/1 3/1
f 1//1 2//1 -1//-1
f 1/1/1 \
  2/1/1 3/1/1
g name
usemtl m
EOF
# --- STL
for scene in soup:n=4 sphere:n=2; do
    quiet "$raydiff" scene convert $scene stl/$(echo $scene | tr -d ':=').stl
done
{ printf 'solid'; tail -c +6 stl/sphere*.stl; } >stl/solid.stl # its header begins as ASCII does
head -c 150 stl/soup*.stl >stl/cut.stl
cat >stl/ascii.stl <<'EOF'
solid two of them
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 1 1e0 0
 endloop
endfacet
endsolid two of them
SOLID
Facet Normal nan nan nan Outer Loop vertex 0 0 0 vertex 1 1 0 vertex -0.0 1 0 EndLoop EndFacet
EndSolid
EOF
head -c 120 stl/ascii.stl >stl/ascii_cut.stl

# --- worlds
for world in placed-turned:n=1 mixed:count=9 wall:n=2 placed-identity:n=1; do
    name=$(echo $world | tr -d ':=-')
    quiet "$raydiff" scene convert $world world/$name.json
    quiet "$raydiff" scene convert $world gltf/$name.gltf || true
    quiet "$raydiff" scene convert $world gltf/$name.glb || true
done
printf '{"raydiff_world":1,"meshes":[{"scene":"a.obj","geometries":[{"count":1,"opaque":false}]}],' >world/named.json
printf '"instances":[{"mesh":null},{"mesh":0,"transform":[1,0,0,0,0,1,0,0,0,0,1,-0.0],"custom":16777215,' >>world/named.json
printf '"mask":1,"flags":["flip_facing","cull_disable"]}],"filter":{"kind":"cells","seed":1,"share":7}}' >>world/named.json
sed 's/a.obj/none.obj/' world/named.json >world/gone.json
sed 's/"transform":.1,0,0/"transform":[0,0,0/' world/named.json >world/singular.json
printf '{"raydiff_world":1,"meshes":[%s],"instances":[]}' "$(many '{"scene":""}' 900)" >world/many.json
printf '{"raydiff_world":1,"meshes":[],"instances":[%s]}' "$(many '{"mesh":null}' 900)" >world/instances.json
printf '{"raydiff_world":1,"meshes":[{"vertices":[%s],"indices":[]}],"instances":[]}' "$(many 0 3000)" >world/zeros.json
printf '{"raydiff_world":1,"meshes":[{"vertices":[0,0,0],"indices":[%s]}],"instances":[]}' "$(many 0 3000)" >world/corners.json
gltf() { # of a mesh, its accessors, what stands before "nodes"
    printf '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],%s"nodes":[{"children":[1],' "$3"
    printf '"translation":[1,2,3],"rotation":[0,0,0.7071,0.7071],"scale":[1,2,-1]},{"mesh":0,"matrix":'
    printf '[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}],"meshes":[{"primitives":[%s]}],"accessors":[%s],' "$1" "$2"
    printf '"bufferViews":[{"buffer":0,"byteLength":64,"byteStride":12},{"buffer":0,"byteLength":64}],'
    printf '"buffers":[{"byteLength":64,"uri":"b"}]}'
}
points='{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}'
bytes='{"bufferView":1,"byteOffset":0,"componentType":5121,"count":2,"type":"SCALAR"}'
gltf '{"attributes":{"POSITION":0},"mode":5}' "$points" '' >gltf/strip.gltf
gltf '{"attributes":{"POSITION":0},"mode":6,"material":0}' "$points" \
    '"materials":[{"alphaMode":"BLEND","doubleSided":true}],' >gltf/fan.gltf
gltf '{"attributes":{"POSITION":0},"indices":1,"mode":5}' "$points,$bytes" '' >gltf/indices.gltf
gltf '{"attributes":{"POSITION":0},"mode":0}' "$points" '"extensionsUsed":["A"],' >gltf/points.gltf
gltf '{"attributes":{"POSITION":0},"mode":5}' "$points" '"extensionsRequired":["A"],' >gltf/required.gltf
gltf '{"attributes":{"POSITION":0},"mode":5}' "$points" '"extras":{"raydiff":{"filter":{"kind":"none"}}},' >gltf/filter.gltf
sed 's/"uri":"b"/"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"/;s/64/36/g;s/"count":5/"count":3/' \
    gltf/strip.gltf >gltf/data.gltf
sed 's/"children":.1./"children":[0]/' gltf/strip.gltf >gltf/circle.gltf
gltf "$(many '{"attributes":{"POSITION":0},"mode":5}' 300)" "$points" '' >gltf/primitives.gltf
printf '{"asset":{"version":"2.0"},"nodes":[%s]}' "$(many '{}' 4000)" >gltf/nodes.gltf
printf '{"asset":{"version":"2.0"},"nodes":[%s]}' "$(many '{"scale":[2,2,2]}' 800)" >gltf/scales.gltf
printf '{"asset":{"version":"2.0"},"nodes":[%s]}' "$(many '{"extras":{"raydiff":{}}}' 600)" >gltf/extras.gltf
printf '{"asset":{"version":"2.0"},"meshes":[%s]}' "$(many '{"primitives":[]}' 900)" >gltf/meshes.gltf
printf '{"asset":{"version":"2.0"},"buffers":[%s]}' "$(many '{"byteLength":0,"uri":""}' 600)" >gltf/buffers.gltf
printf '{"unknown":[%s]}' "$(many '{}' 4000)" >gltf/braces.gltf
{ printf "{\"a\":"; many "[" 600 | tr -d ,; } >gltf/deep.gltf

# The most triangles a byte can make: every " 1" is one.
{
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 '
    many 1 4000 | tr ',' ' '
    echo
} >obj/fan.obj
cat >ply/ascii.ply <<'EOF'
ply
format ascii 1.0
comment a square
element vertex 4
property double x
property double y
property double z
property uchar red
element face 2
property list uchar int vertex_index
element edge 1
property int vertex1
EOF
printf 'end_header\n0 0 0 255\n1 0 0 1\n1 1 0 2\n0 1 0.5 3\n3 0 1 2\n4 0 1 2 3\n7\n' >>ply/ascii.ply
head_ply() { # format, vertices, faces
    printf 'ply\nformat %s 1.0\nelement vertex %s\nproperty float x\nproperty float y\n' "$1" "$2"
    printf 'property float z\nelement face %s\nproperty list uchar uchar vertex_indices\n' "$3"
    printf 'end_header\n'
}
three='\000\000\000\000\000\000\000\000\000\000\000\000\077\200\000\000\000\000\000\000\000\000\000\000'
three=$three'\000\000\000\000\077\200\000\000\000\000\000\000'
{
    head_ply binary_big_endian 3 1
    printf "$three"'\003\000\001\002'
} >ply/big.ply
{
    head_ply binary_big_endian 3 8
    printf "$three"
    for i in 1 2 3 4 5 6 7 8; do
        printf '\377'
        head -c 255 /dev/zero
    done
} >ply/fans.ply
{
    head_ply binary_little_endian 4294967295 4294967295
    head -c 400 /dev/zero
} >ply/promises.ply
{ # so little that there is memory for it
    head_ply binary_little_endian 4000000 4000000
    head -c 400 /dev/zero
} >ply/promises_less.ply
{
    printf '{"prims":[{"indices":[0,1,2],"material":0}],"vertices":['
    printf '{"pos":[0,0,0],"normal":[0,0,1]},{"pos":[1,0,0],"normal":[0,0,1]},'
    printf '{"pos":[0,1,0],"normal":[0,0,1]}],"lights":[{"pos":[0,0,9],"strength":1.5}],'
    printf '"materials":[{"color":[1,0,0],"albedo":[0.6,0.3,0.1],"spec":50}],'
    printf '"camera":{"pos":[0,0,9],"at":[0,0,0]},"camera_controller":"Orbit","more":{"a":[true]}}'
} >rtrs/full.json
printf '{"unknown":[%s]}' "$(many '{}' 4000)" >rtrs/braces.json
printf '{"unknown":[%s]}' "$(many '[]' 4000)" >rtrs/brackets.json
printf '{"unknown":[%s]}' "$(many 0 8000)" >rtrs/numbers.json

echo 'f 1 2 3' >obj/nothing.obj

# --- files of any kind, zipped
for file in obj/soupn4.obj ply/soupn4.ply rtrs/soupn4.json; do
    gzip -nc $file >gz/$(basename $file).gz
done
cat gz/soupn4.obj.gz gz/soupn4.ply.gz >gz/two.gz
head -c 100 gz/soupn4.obj.gz >gz/cut.gz
head -c 16777216 /dev/zero | gzip -9nc >gz/bomb.gz
cp obj/soupn4.obj gz/plain

# --- pictures: every kind, one that says it has a gamma, sides that no file of its size has
picture() { echo "$2" | base64 -d >png/$1.png; }
picture rgb iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFUlEQVR42mP4z8DA8J+BEUhwcnICABoxAxoZHnzfAAAAAElFTkSuQmCC
picture gray1 iVBORw0KGgoAAAANSUhEUgAAAAkAAAADAQAAAABpcRjbAAAAEUlEQVR42mNY1cAQysDwvwEADQAC/0aFt0kAAAAASUVORK5CYII=
picture palette iVBORw0KGgoAAAANSUhEUgAAAAMAAAACBAMAAABvWnspAAAACVBMVEUBAgMoMjxGUFooJN8LAAAAAnRSTlMAgJsrThgAAAAOSURBVHjaY2BUYFBkAAAAzQBDeljbrQAAAABJRU5ErkJggg==
picture gray16 iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAQAAAAOu2tCAAAAEUlEQVR42mMQMvn/v4GBgREADvsCxmwaU74AAAAASUVORK5CYII=
picture interlaced iVBORw0KGgoAAAANSUhEUgAAAAMAAAADCAAAAAEERNr1AAAAF0lEQVR42mNgYGBiEBFjYGQQZeDi5gEAAmUAZNw4nKoAAAAASUVORK5CYII=
picture gamma iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAABGdBTUEAAYagMeiWXwAAAA10RVh0Q29tbWVudABoZWxsb+b/riQAAAAKSURBVHjaY2gAAACCAIHaRQg7AAAAAElFTkSuQmCC
picture huge iVBORw0KGgoAAAANSUhEUgAAQAAAAEAACAYAAACpyBCEAAAAC0lEQVR42mNggAAAAAgAAST8BHIAAAAASUVORK5CYII=
picture beyond iVBORw0KGgoAAAANSUhEUn////8AAAABCAAAAACFXWwBAAAAC0lEQVR42mNggAAAAAgAAST8BHIAAAAASUVORK5CYII=
picture flat iVBORw0KGgoAAAANSUhEUgAAAlgAAAJYAQAAAACWHaVxAAAAQ0lEQVR42u3BAQ0AAADCoPdPbQ43oAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAvg2yIAABW5v6kQAAAABJRU5ErkJggg==
head -c 60 png/rgb.png >png/cut.png
{ head -c 45 png/rgb.png && printf 'x' && tail -c +47 png/rgb.png; } >png/damaged.png
gzip -nc png/rgb.png >png/zipped.png
printf 'P6 1 1 255 abc' >png/ppm.png

# --- results that a report is put together from
said "$raydiff" check soup:n=9 --count 40 --repeat 1 --engine cpu --layout f32,rtrs_rf --query closest,all \
    --json page/check.json
for benchmark in error layouts; do
    said "$raydiff" bench $benchmark --scene sphere:n=2 --count 20 --rounds 1 --json page/$benchmark.json
done
said "$raydiff" doctor --json page/doctor.json
said "$raydiff" bench frames --scene sphere:n=2 --frames 2 --size 8x8 --engine cpu --out page/frames
said "$raydiff" diff cornell --engine cpu,embree -w 16 -h 16 --json page/diff.json
said "$raydiff" replay "$repository/fuzz/corpus/sentinel.trial" --engine cpu --json page/replay.json
rm -f page/frames.csv page/frames.svg page/frames.png
sed 's/"rows"/"rowz"/' page/error.json >page/no-rows.json
sed 's/[0-9][0-9.]*/null/g' page/layouts.json >page/nulls.json
sed 's/"[a-z0-9]*",/"<\&\\"\\u0007",/g' page/error.json >page/hostile.json
printf '{"scenes":[%s],"rows":[%s]}' "$(many '{"scene":""}' 60)" "$(many '{"scene":""}' 900)" >page/many.json

# --- trials
for file in "$repository"/fuzz/corpus/*.trial; do
    cp "$file" trial/
    cp "$file" play/
done
sed 's/^end/end end/' "$repository/fuzz/corpus/sentinel.trial" >trial/ends-twice
# Worlds: found and shrunk, as they were found, and some to be refused.
said "$raydiff" fuzz --worlds --engine cpu --layout rtrs_rf --faithful --trials 64 --rays 6 --triangles 4-12 --jobs 1 \
    --corpus none --dir worlds
for file in first smallest; do
    cp worlds/cpu.rtrs_rf.missed.unexplained/$file.trial trial/world-$file
    cp worlds/cpu.rtrs_rf.missed.unexplained/$file.trial play/world-$file
done
rm -r worlds
world=$repository/fuzz/corpus/inactive-instance.trial
sed 's/^instances 2/instances 3/' "$world" >trial/world-cut
sed 's/^mesh 1/mesh 7/' "$world" >trial/world-mesh
sed 's/^raydiff trial 2/raydiff trial 1/' "$world" >trial/world-of-scenes
sed 's/^1 0 255 0 0x1p+0/1 0 255 0 0x0p+0/' "$world" >trial/world-singular
printf '\001\002\003\004\005\006\007\010\160\170\161\162\163\164\165\166\167' >play/choices
for i in 1 2 3 4 5 6 7 8; do
    printf "$(awk -v s=$i 'BEGIN { for (i = 0; i < 40 * s; i++) {
        s = (s * 1103 + 12345) % 65536; printf "\\%03o", int(s / 256) } }')" >play/choices$i
done

# --- trees of the scene that the entries use
for builder in rtrs median; do
    quiet "$raydiff" precompute --scene soup:n=4,seed=1 --out tree/$builder.json --builder $builder --item-count 1
    for layout in f32 rf16 rtrs_rf rtrs_direct rtrs_rf_paper; do
        quiet "$raydiff" precompute --scene soup:n=4,seed=1 --out packed/$builder-$layout.rdpk \
            --builder $builder --item-count 1 --layout $layout
    done
done
printf '{"uniforms":[%s],"indices":[]}' "$(many '{}' 4000)" >tree/braces.json
printf '{"uniforms":[%s],"indices":[]}' "$(many '[]' 4000)" >tree/brackets.json
printf '{"uniforms":[],"indices":[%s]}' "$(many 0 8000)" >tree/numbers.json

# What leads nowhere, in a circle, or to no triangle.
head -c 76 packed/median-f32.rdpk >packed/cut
poke() { # byte, octal value: "\377"
    head -c $1 packed/median-f32.rdpk
    printf "$2"
    tail -c +$(($1 + 1 + $(printf "$2" | wc -c))) packed/median-f32.rdpk
}
poke 60 '\000\000\000\000' >packed/circle # record 0: snd is itself
poke 60 '\377\377\377\377' >packed/beyond
poke 32 '\007\000\000\177' >packed/promises
poke 36 '\011\000\000\000' >packed/root
poke 44 '\000\000\000\000' >packed/stack

# --- peers: a byte of length, then an answer
answer() { # count, hits
    printf 'RDRA\001\000\000\000\000\000\000\000\'$1'\000\000\000\001\000\000\000\000\000\000\000'
    printf '\000\000\000\000\000\000\000\000'
}
hits() {
    printf '\000\000\000\100\000\000\200\076\000\000\200\076\001\000\000\000'
    for i in 1 2 3 4; do
        printf '\000\000\000\000\000\000\000\000\000\000\000\000\377\377\377\377'
    done
}
{
    printf '\040'; answer 000
    for query in 1 2; do
        printf '\040'; answer 000
        printf '\160'; answer 005; hits
    done
} >peer/answers
{
    printf '\040'; answer 000
    printf '\045RDRA\001\000\000\000\001\000\000\000\005\000\000\000\001\000\000\000\000\000\000\000'
    printf '\000\000\000\000\000\000\000\000large'
} >peer/refused
# Of a peer of worlds: refusals of scenes, then a miss and hits of both sides.
world_answer() { # version, refused, count, flags
    printf 'RDRA\'$1'\000\000\000\'$2'\000\000\000\'$3'\000\000\000\000\000\000\000'
    printf '\000\000\000\000\'$4'\000\000\000\000\000\000\000'
}
world_hit() { # instance, geometry, triangle, side, custom
    printf '\000\000\000\100\000\000\200\076\000\000\200\076%b%b%b%b%b' "$@"
}
world_hits() { # what the last is
    none='\0377\0377\0377\0377' zero='\0000\0000\0000\0000' one='\0001\0000\0000\0000'
    for triangle in $zero $one; do world_hit $zero $zero $triangle $one $none; done
    world_hit $zero $zero $one $zero $zero
    world_hit $none $zero $zero $zero $zero
    "$@"
}
miss() { world_hit $none $zero $zero $zero $zero; }
sided_miss() { world_hit $none $zero $zero $one $zero; }
no_instance() { world_hit $one $zero $zero $one $zero; }
for last in miss sided_miss no_instance; do
    {
        printf '\040'; world_answer 001 000 000 010
        for query in 1 2; do printf '\042'; world_answer 001 001 002 010; printf no; done
        for query in 1 2; do
            printf '\040'; world_answer 002 000 000 010
            printf '\300'; world_answer 002 000 005 010; world_hits $last
        done
    } >peer/world-$last
done
printf '\040RDRX' >peer/short
printf 'R' >peer/nothing

# --- text
"$raydiff" gen soup:n=2 --count 2 --seed 1 >text/request
"$raydiff" gen soup:n=2 --count 2 --seed 1 --decimal --query any >text/decimal
awk -f "$repository/fuzz/samples/tracer.awk" text/decimal >text/answer
{
    printf '\001'
    printf '# answers\nformula mt vulkan_rte\nflags open watertight unnamed\nh 1 .25 0x1p-2 2\nm\nend\n'
} >text/limited
printf '\002refused too many triangles\n' >text/refused
printf 'v 0 0 0\nt 0 1 2\n' >text/forward
printf 'r 0 0 -1 0 nan 0 1 inf\nquery any\n' >text/rays

"$raydiff" gen placed-turned:n=1,count=2 --count 3 --modes drawn >text/world
"$raydiff" gen crowd:n=2,size=0.5 --count 2 --decimal --query any >text/world-decimal
sed 's/^g .*/g 3 opaque/' text/world >text/world-geometries
sed 's/^raydiff 2/raydiff 1/' text/world >text/world-of-scenes
printf '\003raydiff 2\nh 1 .25 0x1p-2 0 1 0 front\nh 2 0 0 0 0 0 back 7\nend\n' >text/world-answer
printf '\003raydiff 2\nm\nh 1 0 0 1 0 0 front\n' >text/world-no-mesh
printf '\003m\nh 1 0 0 0\n' >text/world-old

# --- trees of other programs
cp "$repository"/tests/golden/input/*.tree dump
printf 'raydiff tree 2\nend\n' >dump/version
printf 'raydiff tree 1 # wide\nscene soup:n=4\nsplits\nnode -inf -1e9 -0x1p+9 inf 1e9 nan 1 2 3\n' >dump/open
{
    cat dump/open
    printf 'leaf -1 -1 -1 1 1 1 0 1\r\nleaf -1 -1 -1 1 1 1 2 1\r\n\nleaf -1 -1 -1 1 1 1 3\nend\n'
} >dump/wide
# head, nodes as box, first, count; node 1 of tinybvh is left out
tiny='sub node { pack("f3Vf3V", @_[0 .. 2], $_[6], @_[3 .. 5], $_[7]) }
    sub object { my $o = "\253" x 288; substr($o, $_->[0], 4) = pack("V", $_->[1]) for [0, $_[0]], [32, 1], [40, $_[1]], [44, 4], [48, $_[2]]; $o }
    my @box = (-1, -1, -1, 1, 1, 1);'
perl -e "$tiny"' print pack("VV", 166 | 1 << 24, 4), object(0x01000101, 4, 4), node(@box, 2, 0), node(@box, 0, 0), node(@box, 0, 2), node(@box, 2, 2), pack("V4", 0 .. 3)' >dump/tiny
perl -e "$tiny"' print pack("VV", 166 | 1 << 24, 4), object(0x00010001, 4, 5), node(@box, 2, 0), node(@box, 0, 0), node(@box, 0, 3), node(@box, 3, 2), pack("V5", 0 .. 3, 1)' >dump/tiny-splits
perl -e "$tiny"' print pack("VV", 166 | 1 << 24, 4), object(0x01000101, 3, 4), node(@box, 0, 0), node(@box, 0, 4), node(@box, 1, 4), pack("V4", 0 .. 3)' >dump/tiny-circle
perl -e 'print pack("VV", 166 | 10 << 24, 4), "\0" x 300' >dump/tiny-wide
leaf='sub node { pack("f6V", @_[0, 3, 1, 4, 2, 5], $_[6] * 16 + $_[7]) } my @box = (-1, -1, -1, 1, 1, 1);'
perl -e "$leaf"' print pack("VV", 3, 4), node(@box, 1, 0), node(@box, 0, 2), node(@box, 2, 2), pack("V4", 0 .. 3)' >dump/bvh2
perl -e "$leaf"' print pack("VV", 3, 4), node(@box, 0, 0), node(@box, 1, 2), node(@box, 0xFFFFFFF, 15), pack("V4", 0, 0, 9, -1)' >dump/bvh2-faulty
encode=$repository/tests/driver_trees/encode.pl two=$repository/tests/driver_trees/two.lvp.txt
perl "$encode" <"$two" >dump/lavapipe
sed '/^handles$/,$d' "$two" | perl "$encode" >dump/lavapipe-top
sed -n '/^handles$/,/tri 0 1/p' "$two" | sed '/tri 0 1/q' | perl "$encode" >dump/lavapipe-mesh
sed 's/l2 3 0 0/b0 3 0 0/; s/l1 -1 0 0/l0 nan 0 0/; s/tri 0 1/tri 0 0/; s/ 4 0 1 / inf 0 1 /' "$two" | perl "$encode" >dump/lavapipe-faulty
encode=$repository/tests/driver_trees/encode_radv.pl two=$repository/tests/driver_trees/two.radv.txt
perl "$encode" <"$two" >dump/radv
sed '/^handles$/,$d' "$two" | perl "$encode" >dump/radv-top
sed -n '/^handles$/,/tri 0 1/p' "$two" | sed '/tri 0 1/q' | perl "$encode" >dump/radv-mesh
sed 's/l2 3 0 0/b0 3 0 0/; s/l1 -1 0 0/l0 nan 0 0/; s/tri 0 1/tri 0 0/; s/ 4 0 1 / inf 0 1 /' "$two" | perl "$encode" >dump/radv-faulty
perl -e 'print pack("Q2", 1, 1), pack("d6", -1, 1, -1, 1, -1, 1), pack("Q2", 1, 0)' >dump/bvh2-double

# --- logs
line='"stream":"gen","seed":"7","index":"12","version":1,"trial":"00000000000000ff","triangles":2'
{
    printf '{"signature":"cpu.rtrs_rf.missed.rounded_inward",%s,"rays":1,"ray":0,"at":"","opinion":"x"}\n' "$line"
    printf '{"signature":"vulkan.rtrs_rf.crash.unexplained",%s,"rays":1,"opinion":""}\n' "$line"
    printf '{"checkpoint":"engines=cpu%%2Cvulkan|seed=7|next=64|coverage=00ff|shrunk=01","more":{"cpu.rtrs_rf.missed.rounded_inward":3}}\n'
} >log/whole
{
    cat log/whole
    printf '{"signature":"vulkan.rtrs_r'
} >log/torn
printf '{"checkpoint":"","more":{"cpu.f32.missed.none":0}}\n' >log/zero
printf '{"checkpoint":"x","more":{},"a":[%s]}\n' "$(many '{}' 4000)" >log/braces
printf '{"checkpoint":"x","more":{},"a":[%s]}\n' "$(many '[]' 4000)" >log/brackets

# --- lists of what is known
cp "$repository/fuzz/baseline.txt" baseline/shipped
{
    echo '# a comment'
    echo 'vulkan.*.bits.driver_arithmetic @llvmpipe until 2026-12-31 why not https://example.org/1'
    echo '*.rtrs_rf.*.[!x]? until - the seed: see notes.md'
} >baseline/dated
{ printf '\001' && cat "$repository/tests/waivers.txt"; } >baseline/waivers
echo 'a.b.c.d until 2026-02-30 no such day x.md' >baseline/day

# --- large ones, for the plain programs: what takes the most memory a byte, in arrays that have just
# grown and been copied
for entry in obj ply rtrs tree text log dump; do
    mkdir -p large/$entry
done
{
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n'
    for i in 1 2 3; do
        printf 'f 1 2 3 '
        many 1 60000 | tr ',' ' '
        echo
    done
} >large/obj/fans.obj
{
    head_ply binary_big_endian 3 700
    printf "$three"
    i=0
    while [ $i -lt 700 ]; do
        printf '\377'
        head -c 255 /dev/zero
        i=$((i + 1))
    done
} >large/ply/fans.ply
printf '{"uniforms":[%s],"indices":[]}' "$(many '{"":0},[],[],[]' 65537)" >large/tree/dense.json
printf '{"unknown":[%s]}' "$(many '{"":0},[],[],[]' 65537)" >large/rtrs/dense.json
printf '{"checkpoint":"x","more":{},"a":[%s]}\n' "$(many '{"":0},[],[],[]' 65537)" >large/log/dense
{
    echo 'raydiff tree 1'
    many 'leaf 0 0 0 0 0 0' 20001 | tr ',' '\n'
    printf '\nnode 0 0 0 0 0 0 '
    many 1 65537 | tr ',' ' '
    printf '\nend\n'
} >large/dump/dense
{
    many m 131073 | tr ',' '\n'
    echo
} >large/text/misses

cd "$repository"
mv "$out.new" "$out"
