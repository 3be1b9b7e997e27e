#!/bin/sh
# The command line of hbil-frame: exit codes, messages, that no file is touched on an error, and that exactly the outputs
# that were asked for are written.
#
#   sh tests/cli/hbil_frame.sh HBIL-FRAME
#
# A line per fault and a count at the end. A backend without a driver is left out and said so. Works as root, too.
set -u

if [ $# -ne 1 ] || [ ! -x "$1" ]; then
    echo "usage: sh hbil_frame.sh HBIL-FRAME" >&2
    exit 2
fi
bin=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
work=$(mktemp -d) || exit 1
mounted=
cleanup() { [ -z "$mounted" ] || umount "$mounted"; rm -rf "$work"; }
trap cleanup EXIT
trap 'exit 1' HUP INT TERM
# Every file of the test is in one folder, watched by comparing it with its copy; logs lie beside it.
mkdir "$work/here"
cd "$work/here" || exit 1

checks=0
failed=0
group=

say()   { group=$1; }
fault() { failed=$((failed + 1)); echo "FAIL  $group: $1"; }
# Is the rest, a command, true?
check() # WHAT COMMAND ...
{
    what=$1
    shift
    checks=$((checks + 1))
    "$@" > ../check.log 2>&1 || { fault "$what"; sed 's/^/      /' ../check.log | head -5; }
}
# Runs hbil-frame into ../out.txt and ../err.txt, and checks its exit code.
expect() # CODE ARGUMENT ...
{
    want=$1
    shift
    checks=$((checks + 1))
    code=0
    "$bin" "$@" > ../out.txt 2> ../err.txt < /dev/null || code=$?
    [ "$code" -eq "$want" ] && return 0
    fault "exit code $code, not $want: hbil-frame $*"
    sed 's/^/      /' ../err.txt | head -3
    return 1
}
# Refused: this code, this word in one message, nothing on the output, all files as they were.
refused() # CODE WORD ARGUMENT ...
{
    word=$2
    code_wanted=$1
    shift 2
    expect "$code_wanted" "$@" --out out.exr --report report.json --png png
    check "message names $word: hbil-frame $*" grep -qF -e "$word" ../err.txt
    check "nothing on the output: hbil-frame $*" test ! -s ../out.txt
    check "files are as they were: hbil-frame $*" diff -r ../kept .
}

# ---------------------------------------------------------------------------------------------------- frames

le32() # NUMBER, as four bytes
{
    # shellcheck disable=SC2059
    printf "$(printf '\\%03o\\%03o\\%03o\\%03o' $(($1 & 255)) $(($1 >> 8 & 255)) $(($1 >> 16 & 255)) $(($1 >> 24)))"
}

# All of an EXR but its table and lines.
write_exr_head() # WIDTH HEIGHT NAME=BYTES ...
{
    width=$1; height=$2
    shift 2
    bytes=1
    for channel in "$@"; do channel=${channel%%=*}; bytes=$((bytes + ${#channel} + 17)); done
    printf '\166\057\061\001'; le32 2
    printf 'channels\0chlist\0'; le32 $bytes
    for channel in "$@"; do printf '%s\0' "${channel%%=*}"; le32 2; le32 0; le32 1; le32 1; done
    printf '\0compression\0compression\0'; le32 1; printf '\0'
    for window in dataWindow displayWindow; do
        printf '%s\0box2i\0' $window; le32 16; le32 0; le32 0; le32 $((width - 1)); le32 $((height - 1))
    done
    printf 'lineOrder\0lineOrder\0'; le32 1; printf '\0'
    printf 'pixelAspectRatio\0float\0'; le32 4; printf '\000\000\200\077'
    printf 'screenWindowCenter\0v2f\0'; le32 8; le32 0; le32 0
    printf 'screenWindowWidth\0float\0'; le32 4; printf '\000\000\200\077'
    printf '\0'
}

# An EXR without compression: every channel has one value, given as the four bytes of a float, escaped. Sorted by name.
write_exr() # WIDTH HEIGHT NAME=BYTES ...
{
    write_exr_head "$@" > ../head.exr
    cat ../head.exr
    width=$1; height=$2
    shift 2
    line=$((width * $# * 4))
    begin=$(($(wc -c < ../head.exr) + height * 8))
    y=0
    while [ $y -lt "$height" ]; do le32 $((begin + y * (line + 8))); le32 0; y=$((y + 1)); done
    y=0
    while [ $y -lt "$height" ]; do
        le32 $y; le32 $line
        for channel in "$@"; do
            x=0
            # shellcheck disable=SC2059
            while [ $x -lt "$width" ]; do printf "${channel#*=}"; x=$((x + 1)); done
        done
        y=$((y + 1))
    done
}

zero='\000\000\000\000'; half='\000\000\000\077'; one='\000\000\200\077'; two='\000\000\000\100'
albedo="albedo.B=$half albedo.G=$half albedo.R=$half"
direct="direct.B=$half direct.G=$half direct.R=$one"
normal="normal.X=$zero normal.Y=$zero normal.Z=$one"

# A wall two metres in front of the camera.
write_camera() # WIDTH HEIGHT
{
    cat <<JSON
{ "width": $1, "height": $2, "near": 1, "far": 3,
  "projection_rows": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, -2, -3], [0, 0, -1, 0]],
  "view_rows": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]] }
JSON
}

mkdir png
# The words of these lists are meant to be split.
# shellcheck disable=SC2086
{
    write_exr 8 4 $albedo "depth.Z=$two" $direct $normal > good.exr
    write_exr 8 4 $albedo $direct $normal > no_depth.exr
    write_exr 8 4 $albedo "depth.Z=$two" $direct normal.X="$zero" normal.Z="$one" > no_normal_y.exr
}
size=$(wc -c < good.exr)
head -c $((size - 20)) good.exr > cut_pixels.exr
head -c 200 good.exr > cut_header.exr
: > empty.exr
echo 'no picture' > text.exr
write_camera 8 4 > good.json
write_camera 8 5 > other_size.json
write_camera 8 4 | sed 's/"near": 1/"nearer": 1/' > no_near.json
write_camera 8 4 | sed 's/"far": 3/"far": 4/' > other_far.json
write_camera 8 4 | sed 's/\[\[1, 0, 0, 0\], \[0, 1/[[2, 0, 0, 0], [0, 1/' > scaled_view.json
write_camera 8 4 | head -c 100 > cut.json
write_exr 12 2 B="$half" G="$one" R="$two" > cube.exr
write_exr 8 4 B="$half" G="$one" R="$two" > no_cube.exr
echo '1 1 1' > sh.txt
echo '1 1 1 1' > sh4.txt
probe='[[1,1,1],[0,0,0],[0,0,0],[0,0,0]]'
probes='"size": [2,1,1], "origin": [0,0,0], "step": [1,1,1], "order": 1'
echo "{$probes, \"coefficients\": [$probe, $probe]}" > probes.json
echo "{$probes, \"coefficients\": [$probe]}" > few_probes.json
head='vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {'
printf '%s\n    return vec3(0.5 + 0.5 * direction.z);\n}\n' "$head" > hook.glsl
printf '\n\n%s\n    return nonsense;\n}\n' "$head" > bad_hook.glsl
echo 'vec3 far_hook(vec3 direction) { return direction; }' > other_hook.glsl
for file in out.exr report.json png/before.png png/ao.png; do echo "old $file" > $file; done
cp -r . ../kept

# ---------------------------------------------------------------------------------------------------- refusals

frame='--frame good.exr --camera good.json'
scene='--scene cornell --size 16x8 --rays 0'
say 'help'
expect 0 --help
check 'usage on the output' grep -q '^usage: hbil-frame' ../out.txt
check 'lists a preset' grep -q '^  fast ' ../out.txt
expect 0 --version
check 'version' grep -Eq '^hbil-frame [0-9]+\.[0-9]+\.[0-9]+$' ../out.txt

say 'a config that is refused'
# shellcheck disable=SC2086
{
    refused 1 'slices=99' $frame --set slices=99
    refused 1 'did you mean slices?' $frame --set slicse=4
    refused 2 'frame-%03d.exr' $frame --frames 0:1
    refused 2 '--frames 2:1' $frame --frames 2:1
    refused 1 'did you mean balanced?' $frame --preset balnced
    refused 1 'reach' $scene --set slices=0,reach=-1
    refused 1 'target' $frame --backend gl --set target=vulkan
}

say 'an environment that does not fit the config'
# shellcheck disable=SC2086
{
    refused 1 '--env sky is environment=sh, but --set says environment=cube' $frame --env sky --set environment=cube
    refused 1 'environment=hook, but --set says environment=sh' $frame --hook hook.glsl --set environment=sh
    refused 1 '--env color:R,G,B' $frame --set environment=constant
    refused 1 '--env sky or --env sh:' $frame --set environment=sh
    refused 1 '--env CUBE.exr' $frame --set environment=cube
    refused 1 '--env PROBES.json' $frame --set environment=probes
    refused 1 '--hook H.glsl' $frame --set environment=hook
    refused 1 'environment=sh of preset hbil_screen' $frame --preset hbil_screen
    refused 1 'environment' $frame --set outputs=far
    refused 1 'spherical harmonics' $frame --env cube.exr --set far_visibility=cone
}

say 'wrong usage'
# shellcheck disable=SC2086
{
    refused 2 'frame'
    refused 2 '--nonsense' $frame --nonsense
    refused 2 '--camera' --frame good.exr
    refused 2 '--scene' $frame $scene
    refused 2 '--size' $frame --size 8x4
    refused 2 '--size' --scene cornell --size 0x4
    refused 2 '--size' --scene cornell --size 8
    refused 2 '--rays' --scene cornell --rays -1
    refused 2 '--repeat' $frame --repeat 0
    refused 2 '--backend' $frame --backend metal
    refused 2 'cornell' --scene teapot
    refused 2 '--env moon: must be sky' $frame --env moon
    refused 2 '--env sky:1,2' $frame --env sky:1,2
    refused 2 '--env color:1,2,-1' $frame --env color:1,2,-1
    refused 2 '3, 12 or 27' $frame --env sh:1,2,3,4
    refused 2 'one environment' $frame --env sky --hook hook.glsl
    expect 2 $frame --env
    refused 2 '--frame' --frame '' --camera good.json
    expect 2 $frame --out
}

say 'a file that cannot be read'
for bad in missing.exr png no_depth.exr no_normal_y.exr cut_pixels.exr cut_header.exr empty.exr text.exr; do
    refused 3 "$bad" --frame "$bad" --camera good.json
done
for bad in missing.json png no_near.json other_far.json scaled_view.json cut.json text.exr; do
    refused 3 "$bad" --frame good.exr --camera "$bad"
done

# shellcheck disable=SC2086
for bad in missing.exr no_cube.exr text.exr cut_pixels.exr good.exr missing.json few_probes.json cut.json good.json sh:missing.txt \
    sh:sh4.txt sh:text.exr; do
    refused 3 "${bad#sh:}" $frame --env $bad
done
# shellcheck disable=SC2086
{
    refused 3 'missing.glsl' $frame --hook missing.glsl
    refused 3 'vec3 hbil_far_hook(' $frame --hook other_hook.glsl
    check 'message names the file' grep -q 'other_hook.glsl' ../err.txt
}

say 'frame, camera and config that do not fit each other'
# shellcheck disable=SC2086
{
    refused 4 'other_size.json' --frame good.exr --camera other_size.json
    refused 4 'projection' $frame --set projection=orthographic
    refused 4 'width' $frame --set width=9,height=4
    refused 4 'f0=none' $frame --preset hbil_paper --env sky
    refused 4 'roughness=0.4' $frame --set outputs=specular_occlusion
    refused 4 'emission' $frame --emissive
}

say 'an output that cannot be written'
# shellcheck disable=SC2086
for output in '--out missing/out.exr' '--report missing/report.json' '--png missing/png' '--out png' '--report png' '--png text.exr' \
    '--out text.exr/out.exr'; do
    expect 3 $frame $output
    check "message names ${output#* }" grep -qF -e "${output#* }" ../err.txt
    check "files are as they were: $output" diff -r ../kept .
done
mkfifo ../pipe
for output in '--out ../pipe' '--report ../pipe'; do
    # shellcheck disable=SC2086
    expect 3 $frame $output
    check 'what is no file is not replaced by one' test -p ../pipe
done

say 'a missing driver'
# The loader takes the second name where it is older than the first.
VK_DRIVER_FILES=/nonexistent
VK_ICD_FILENAMES=/nonexistent
export VK_DRIVER_FILES VK_ICD_FILENAMES
# shellcheck disable=SC2086
{
    refused 5 'Vulkan' $frame
    refused 5 'Vulkan' $scene
}
unset VK_DRIVER_FILES VK_ICD_FILENAMES
HBIL_GL=egl
__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent
export HBIL_GL __EGL_VENDOR_LIBRARY_FILENAMES
# shellcheck disable=SC2086
refused 5 'OpenGL' $frame --backend gl
unset HBIL_GL __EGL_VENDOR_LIBRARY_FILENAMES

# ---------------------------------------------------------------------------------------------------- what is written

# Names of the channels of an EXR: each stands between zero bytes of the header.
channels() { head -c 2000 "$1" | tr '\000' '\n' | LC_ALL=C grep -aE '^[a-z_]+[0-3]?\.[A-Z]$' | sort | tr '\n' ' '; }
# Names of the outputs of a report, in its order.
reported() { sed -n '/"outputs":.*{/,$ s/^.*"\([a-z_]*\)":[[:space:]]*{$/\1/p' "$1" | sed 1d | tr '\n' ' '; }

writes() # BACKEND SET CHANNELS REPORTED PICTURES ARGUMENT ...
{
    group="$1 writes what is asked for, outputs=$2"
    backend_asked=$1
    outputs=$2
    channels=$3
    reported=$4
    pictures=$5
    shift 5
    rm -rf out.exr report.json png
    # shellcheck disable=SC2086
    expect 0 $frame --backend "$backend_asked" --set "outputs=$outputs" "$@" --out out.exr --report report.json --png png || return
    check 'prints a summary' grep -q '^total ' ../out.txt
    check "channels: $(channels out.exr)" test "$(channels out.exr)" = "$channels"
    check "reports: $(reported report.json)" test "$(reported report.json)" = "$reported"
    check "pictures: $(cd png && echo *)" test "$(cd png && echo *)" = "$pictures"
    for picture in png/*.png; do
        check "$picture is a PNG" test "$(od -An -tx1 -N4 "$picture" | tr -d ' ')" = 89504e47
    done
    mv out.exr report.json ..
    rm -rf png
    cp -r ../kept/. .
    check 'and no other file' diff -r ../kept .
}

rgb() { echo "$1.B $1.G $1.R "; }
sh=
for layer in 0 1 2 3; do sh="${sh}sh$layer.A $(rgb sh$layer)"; done
backends=0
for backend in vulkan gl; do
    say "$backend"
    # shellcheck disable=SC2086
    if "$bin" $scene --backend $backend -q > ../out.txt 2>&1; [ $? -eq 5 ]; then
        echo "skip  $backend: $(head -n 1 ../out.txt)"
        continue
    fi
    backends=$((backends + 1))
    writes $backend ao 'ao.Y ' 'ao ' 'ao.png before.png'
    writes $backend near 'near.B near.G near.R ' 'near ' 'before.png near.png'
    writes $backend ao+bent 'ao.Y bent.X bent.Y bent.Z ' 'ao bent ' 'ao.png before.png bent.png'
    writes $backend ao+near+bent+composite \
        'ao.Y bent.X bent.Y bent.Z composite.B composite.G composite.R near.B near.G near.R ' \
        'ao bent near composite ' 'after.png ao.png before.png bent.png near.png'
    writes $backend ao+multi_bounce 'ao.Y multi_bounce.B multi_bounce.G multi_bounce.R ' 'ao multi_bounce ' \
        'ao.png before.png multi_bounce.png'
    writes $backend ao+uniform_ao+bent+cone+near+sh+far+irradiance+specular_occlusion+composite \
        "ao.Y bent.X bent.Y bent.Z $(rgb composite)cone.A cone.X cone.Y cone.Z $(rgb far)$(rgb irradiance)$(rgb near)$sh"\
'specular_occlusion.Y uniform_ao.Y ' \
        'ao uniform_ao bent cone near sh far irradiance specular_occlusion composite ' \
        "after.png ao.png before.png bent.png cone.png cone_angle.png far.png irradiance.png near.png sh.png sh_visibility.png \
specular_occlusion.png uniform_ao.png" --env sky --set roughness=0.4
    # The report says what the environment made of the config.
    for given in '--env sky=sh' '--env sky:1,1,1,2,2,2=sh' '--env color:1,2,3=constant' '--env sh:1,1,1=sh' '--env sh:sh.txt=sh' \
        '--env cube.exr=cube' '--env probes.json=probes' '--hook hook.glsl=hook'; do
        say "$backend, ${given%=*}"
        # shellcheck disable=SC2086
        expect 0 $frame --backend $backend ${given%=*} --set outputs=far --report report.json -q
        check 'prints nothing' test ! -s ../out.txt -a ! -s ../err.txt
        check 'the config says so' grep -Eq "\"environment\":[[:space:]]*\"${given#*=}\"" report.json
        check 'the report names it' grep -qF "$(echo "${given%=*}" | cut -d' ' -f2)" report.json
        cp ../kept/report.json .
    done
    say "$backend, environment in --set, too"
    # shellcheck disable=SC2086
    expect 0 $frame --backend $backend --env sky --set environment=sh,sh_order=2 --set outputs=far --report report.json -q
    check 'sh_order is kept' grep -Eq '"sh_order":[[:space:]]*2' report.json
    cp ../kept/report.json .
    say "$backend, a hook that does not compile"
    # shellcheck disable=SC2086
    refused 5 'bad_hook.glsl' $frame --backend $backend --hook bad_hook.glsl
    check 'message has the line of the hook' grep -Eq ':4[:(]' ../err.txt
    check 'and what is wrong there' grep -q nonsense ../err.txt
    say "$backend, a sequence whose last frame is missing"
    cp good.exr f0.exr && cp good.json f0.json
    expect 3 --frame 'f%d.exr' --camera 'f%d.json' --frames 0:1 --backend $backend --out 'seq-%02d.exr'
    check 'message names it' grep -qF 'f1.exr' ../err.txt
    check 'nothing is written' test ! -e seq-00.exr
    rm f0.exr f0.json
    say "$backend, a sequence"
    expect 0 --scene cornell --size 32x18 --rays 4 --frames 3:5 --move 0.1,0,0.1 --turn 1 --cut 5 --backend $backend \
        --set outputs=ao+near,temporal=yes,bounces=recursive,filter=3x3 --out 'seq-%02d.exr' --png seq --report seq.json
    check 'a line for each frame' test "$(grep -c '^ *[345] .* ao 0' ../out.txt)" -eq 3
    check 'and files' test -s seq-03.exr -a -s seq-04.exr -a -s seq-05.exr -a -s seq/003/ao.png -a -s seq/005/near.png
    check 'the report has them' test "$(grep -c '"frame":[[:space:]]*[345]' seq.json)" -eq 3
    rm -r seq seq.json seq-0[345].exr
    for preset in $("$bin" --help | sed -n '/^presets:/,/^$/ s/^  \([a-z_]*\) .*/\1/p'); do
        say "$backend, preset $preset"
        more=
        case $preset in
            gtao) more='--set roughness=0.4' ;;
            hbil_paper) more='--env sky --set f0=none' ;;
            hbil_screen | bitmask) more='--env sky' ;;
            reference) more='--set slices=8,steps=16' ;;
        esac
        # shellcheck disable=SC2086
        expect 0 $frame --backend $backend --preset "$preset" $more -q
        check 'no fault of the light' test ! -s ../err.txt
    done
    say "$backend, -q"
    # shellcheck disable=SC2086
    expect 0 $frame --backend $backend -q
    check 'prints nothing' test ! -s ../out.txt -a ! -s ../err.txt
    check 'writes nothing' diff -r ../kept .
    say "$backend, its own output as a frame"
    cp ../out.exr own.exr
    expect 3 --frame own.exr --camera good.json --backend $backend
    check 'message names a layer' grep -q 'depth' ../err.txt
    rm own.exr
done
[ $backends -gt 0 ] || echo 'skip  what is written: no driver for any backend'

say 'a full disk'
mkdir ../disk
if [ $backends -eq 0 ]; then
    echo "skip  $group: no driver"
elif mount -t tmpfs -o size=8k tmpfs ../disk 2> /dev/null; then
    mounted=$work/disk
    echo 'old' > ../disk/out.exr
    expect 3 --scene cornell --size 64x64 --rays 0 --backend "$backend" --out ../disk/out.exr
    check 'the old file is whole' grep -qx old ../disk/out.exr
    check 'and alone' test "$(ls -A ../disk)" = out.exr
    umount ../disk && mounted=
else
    echo "skip  $group: no tmpfs can be mounted here"
fi

say 'contexts without compute shaders'
# Mesa can be made to be older than it is.
if expect 0 --scene cornell --size 64x36 --rays 0 --backend gl --set outputs=ao --out computed.exr; then
    expect 0 --scene cornell --size 64x36 --rays 0 --backend gl --set outputs=ao,stage=fragment --out drawn.exr
    check 'compute and fragment shaders give the same bytes' cmp computed.exr drawn.exr
    for old in 'gl 3.3 MESA_GL_VERSION_OVERRIDE=3.3 MESA_GLSL_VERSION_OVERRIDE=330' 'gles 3.0 MESA_GLES_VERSION_OVERRIDE=3.0'; do
        # shellcheck disable=SC2086
        set -- $old
        backend=$1 version=$2
        shift 2
        rm -f drawn.exr
        if env "$@" "$bin" --scene cornell --size 64x36 --rays 0 --backend "$backend" --set outputs=ao,stage=fragment --out drawn.exr \
            > ../out.txt 2> ../err.txt && grep -q "^driver .*$version" ../out.txt; then
            check "drawn on $backend $version: the same bytes" cmp computed.exr drawn.exr
            checks=$((checks + 1))
            env "$@" "$bin" --scene cornell --size 64x36 --rays 0 --backend "$backend" --set outputs=ao > ../out.txt 2> ../err.txt &&
                fault "compute shaders on $backend $version"
            check 'the message names the fix' grep -q 'stage=fragment' ../err.txt
        else
            echo "skip  $group: no $backend $version here"
            sed 's/^/      /' ../out.txt ../err.txt | head -5
        fi
    done
fi

echo "hbil-frame: $checks checks, $failed failed"
[ $failed -eq 0 ]
