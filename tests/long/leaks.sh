#!/bin/sh
# leaks.sh - our programs lose no memory, read none that is not theirs, and decide nothing by what was never written.
#   leaks.sh BIN                  the quick part: valgrind on what needs no GPU; 77: no valgrind
#   leaks.sh BIN SANITIZED_BIN    that, and on both backends valgrind on frames of BIN, and AddressSanitizer with LeakSanitizer
#                                 on the programs of SANITIZED_BIN (preset sanitize)
# First it proves that it would notice: forgetful.c errs on purpose. What drivers lose is in valgrind.supp and, for LeakSanitizer, which
# knows no whole stacks, in lsan.supp; there the bytes are counted, too. Exit: 0 clean, 1 not.
set -u
bin=$1 sanitized=${2-}
here=$(cd "$(dirname "$0")" && pwd)
model=$here/../../examples/viewer/room.gltf
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0 checks=0
LP_NUM_THREADS=${LP_NUM_THREADS:-2}
export LP_NUM_THREADS

if ! command -v valgrind >/dev/null; then
    echo "leaks: no valgrind: apt-get install valgrind"
    [ -z "$sanitized" ] && exit 77
    exit 1
fi

# verdict GOOD NAME: 0 is good; else the log is shown
verdict() {
    checks=$((checks + 1))
    if [ "$1" -eq 0 ]; then echo "ok      $2"; else echo "FAULT   $2"; tail -60 "$work/log"; bad=$((bad + 1)); fi
}

memcheck() {
    valgrind -q --error-exitcode=99 --leak-check=full --show-leak-kinds=definite,indirect --errors-for-leak-kinds=definite \
        --num-callers=30 --suppressions="$here/valgrind.supp" "$@" >"$work/log" 2>&1
}
# by valgrind: clean NAME COMMAND...; found NAME COMMAND...: an error must be reported
clean() { name=$1; shift; memcheck "$@"; verdict $? "valgrind: $name"; }
found() { name=$1; shift; memcheck "$@"; [ $? -eq 99 ]; verdict $? "valgrind notices: $name"; }

lsan() {
    ASAN_OPTIONS=detect_leaks=1:exitcode=98 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 \
        LSAN_OPTIONS="suppressions=$here/../lsan.supp:print_suppressions=1:exitcode=99" "$@" >"$work/log" 2>&1
}
# by LeakSanitizer: most BYTES that a driver may lose, NAME, COMMAND...
sane() {
    most=$1 name=$2; shift 2
    lsan "$@"; code=$?
    lost=$(awk '/^ *count +bytes +template/ { on = 1; next } /^---/ { on = 0 } on { sum += $2 } END { print sum + 0 }' "$work/log")
    [ $code -eq 0 ] && [ "$lost" -le "$most" ]
    verdict $? "sanitizers: $name${lost:+, $lost bytes lost by drivers}"
}
noticed() { # by AddressSanitizer, or by the bytes that count as a driver's
    most=$1 name=$2; shift 2
    lsan "$@"; code=$?
    lost=$(awk '/^ *count +bytes +template/ { on = 1; next } /^---/ { on = 0 } on { sum += $2 } END { print sum + 0 }' "$work/log")
    [ $code -eq 98 ] || [ $code -eq 99 ] || { [ $code -eq 0 ] && [ "$lost" -gt "$most" ]; }
    verdict $? "sanitizers notice: $name"
}

osmesa=480 # bytes: see valgrind.supp

# ---- the check can fail
found 'a lost allocation' "$bin/forgetful" leak
found 'a read behind the end' "$bin/forgetful" read
found 'a branch on what was never written' "$bin/forgetful" jump
clean 'a program without fault' "$bin/forgetful" nothing

# ---- no GPU
clean 'shadergen, GLSL' "$bin/shadergen" --preset quality -o "$work/glsl/"
memcheck "$bin/shadergen" --set slices=99; [ $? -eq 1 ]; verdict $? 'valgrind: shadergen, a config that is refused'
clean 'hbil-emit' "$bin/hbil-emit" outputs=ao+near+sh march=sweep
[ -n "$sanitized" ] || { echo "$checks checks, $bad faults"; [ $bad -eq 0 ]; exit; }

# ---- sanitizers, both backends
history='temporal=yes,bounces=recursive,reproject=scatter,filter=3x3,filter_passes=3'
frames='--scene cornell --size 33x19 --rays 1 --frames 0:2 --move .05,0,.02'
noticed 0 'a lost allocation' "$sanitized/forgetful" leak
noticed 0 'a read behind the end' "$sanitized/forgetful" read
noticed 0 'a forgotten Vulkan device' "$sanitized/forgetful" vulkan
noticed $osmesa 'a forgotten GL context' "$sanitized/forgetful" gl
for format in glsl spirv hlsl msl c manifest; do
    sane 0 "shadergen, $format" "$sanitized/shadergen" --preset quality --format $format -o "$work/$format/"
done
for backend in vulkan gl gles; do
    most=0; [ $backend = gl ] && most=$osmesa
    set=$history; [ $backend = gles ] && set=filter=3x3 # images that passes read and write: not on ES of all drivers
    # shellcheck disable=SC2086
    sane $most "hbil-frame, $backend" "$sanitized/hbil-frame" $frames --set "$set" --backend $backend --out "$work/%d.exr" --png "$work"
done
sane $osmesa 'hbil-frame, fragment shaders' "$sanitized/hbil-frame" --scene cornell --size 33x19 --rays 1 --backend gl --set stage=fragment,filter=3x3
sane 0 'hbil-frame, a config that is refused' sh -c '"$0" --scene cornell --set slices=99 >/dev/null; [ $? -eq 1 ]' "$sanitized/hbil-frame"
sane 0 'hbil-viewer, vulkan' "$sanitized/hbil-viewer" --headless --model "$model" --frames 3 --size 64x36 --set temporal=yes --png "$work/"
sane $osmesa 'hbil-viewer, gl' "$sanitized/hbil-viewer" --gl --headless --model "$model" --frames 3 --size 64x36 --set temporal=yes --png "$work/"
sane 0 'hbil-tradeoff' "$sanitized/hbil-tradeoff" sweep --out "$work/s.csv" --options 'slices=1,2 outputs=ao+near' --scene cornell --size 48x27 \
    --rays 1 --converged 4x32x1 --seconds .5 --cache "$work/cache" -q
sane $osmesa 'hbil-long-run' "$sanitized/hbil-long-run" --frames 32 --poses 4 --size 32x18 --turns

# ---- valgrind, both backends: minutes, for the drivers compile under it
frames='--scene cornell --size 16x8 --rays 0 --frames 0:1 --move .05,0,.02 -q'
for backend in vulkan gl; do
    found "a forgotten device, $backend" "$bin/forgetful" $backend
    # shellcheck disable=SC2086
    clean "hbil-frame, $backend" "$bin/hbil-frame" $frames --backend $backend \
        --set outputs=ao+near,slices=1,steps=2,temporal=yes,bounces=recursive,reproject=scatter
done
clean 'shadergen, the cost' "$bin/shadergen" --cost
clean 'shadergen, SPIR-V' "$bin/shadergen" --preset quality --format spirv -o "$work/spirv/"
echo "$checks checks, $bad faults"
[ $bad -eq 0 ]
