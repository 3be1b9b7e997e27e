#!/bin/sh
# hbil-viewer without and with a window, on Vulkan and GL: exit codes, pictures that show what they should, keys.
#
#   sh tests/viewer/run.sh HBIL-VIEWER VIEWER-CHECK ROOM.gltf
#
# A line per fault and a count at the end. A backend without a driver is left out and said so; 77 if neither runs. Without
# xvfb-run the windows are left out: 77, too, if all else passes.
set -u

if [ $# -ne 3 ] || [ ! -x "$1" ] || [ ! -x "$2" ] || [ ! -f "$3" ]; then
    echo "usage: sh run.sh HBIL-VIEWER VIEWER-CHECK ROOM.gltf" >&2
    exit 2
fi
viewer=$1
checker=$2
room=$3
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
export LP_NUM_THREADS="${LP_NUM_THREADS:-16}" # Mesa's software rasterisers share out uneven frames better so

checks=0
failed=0
fault() { failed=$((failed + 1)); echo "FAIL  $*"; }
# Does the program end with this code? Its words are in log.
expect() # CODE COMMAND ...
{
    wanted=$1
    shift
    checks=$((checks + 1))
    code=0
    "$@" > "$work/log" 2>&1 < /dev/null || code=$?
    [ "$code" -eq "$wanted" ] && return 0
    fault "exit code $code, not $wanted: $*"
    sed 's/^/      /' "$work/log" | tail -5
    return 1
}
check() { expect 0 "$checker" "$@"; }
says()
{
    checks=$((checks + 1))
    grep -qF -e "$1" "$work/log" && return 0
    fault "not said: $1"
    sed 's/^/      /' "$work/log" | tail -5
}

# ---------------------------------------------------------------------------------------------------- command line

expect 0 "$viewer" --help && says "Shift+D" && says "bitmask"
expect 2 "$viewer" --bogus && says "--bogus"
expect 2 "$viewer" --headless && says "--frames"
expect 2 "$viewer" --headless --frames 1 --size 0x4 && says "--size 0x4"
expect 2 "$viewer" --headless --frames 1 --view top && says "--view top"
expect 2 "$viewer" --headless --frames 1 --scene moon && says "--scene moon"
expect 2 "$viewer" --headless --frames 1 --press "V Nix" && says "no key Nix"
expect 2 "$viewer" --headless --frames 1 --preset nix
expect 1 "$viewer" --headless --frames 1 --set slices=0.5
expect 1 "$viewer" --headless --frames 1 --set occluder=thick && says "estimator=bitmask"
expect 1 "$viewer" --headless --frames 1 --set depth=linear && says "depth follows"
expect 3 "$viewer" --headless --frames 1 --model "$work/none.gltf" && says "none.gltf"
expect 3 "$viewer" --headless --frames 1 --png "$work/none/none" && says "none/none"

# -------------------------------------------------------------------------------------------------------- headless
# Each V takes the next view: frame 0 is composite, then split, direct, ao, near, far, bent, and composite again.

backends=
for backend in vulkan gl; do
    flag=--validate
    [ "$backend" = vulkan ] || flag='--gl --validate'
    code=0
    # shellcheck disable=SC2086
    "$viewer" $flag --headless --frames 1 --size 16x9 > "$work/log" 2>&1 || code=$?
    if [ "$code" -eq 5 ] && ! grep -q messages "$work/log"; then
        echo "viewer: $backend left out: $(tail -1 "$work/log")"
        continue
    fi
    backends="$backends $backend"
    for scene in cornell room; do
        what="--scene $scene"
        [ "$scene" = cornell ] || what="--model $room"
        out=$work/$backend-$scene
        # shellcheck disable=SC2086
        expect 0 "$viewer" $flag --headless $what --frames 8 --size 240x135 --press 'V V V V V V V' --png "$out" \
            || continue
        says median
        says sweep
        check differ "$out/frame-000.png" "$out/frame-002.png" 15 200 # composite is more than the direct light
        check differ "$out/frame-001.png" "$out/frame-000.png" 5 100  # split: half of it
        check differ "$out/frame-001.png" "$out/frame-002.png" 5 100
        check mean "$out/frame-003.png" 20 235                        # ao: neither black nor white,
        check spread "$out/frame-003.png" 20 128                      # nor flat
        check spread "$out/frame-004.png" 20 128                      # near
        check spread "$out/frame-005.png" 10 128                      # far
        check spread "$out/frame-006.png" 5 128                       # bent
        check differ "$out/frame-007.png" "$out/frame-000.png" 0.1 20 # the camera has moved, a little
    done
done
if [ -z "$backends" ]; then
    echo "viewer: skipped, neither Vulkan nor GL runs here"
    exit 77
fi
if [ "$backends" = ' vulkan gl' ]; then
    for scene in cornell room; do
        for frame in 000 003 004 006; do
            check differ "$work/vulkan-$scene/frame-$frame.png" "$work/gl-$scene/frame-$frame.png" 0 0.3
        done
    done
fi

# History: the running mean takes the noise away, whether it follows last frame's camera or our motion vectors.

flag=
[ "$backends" = ' gl' ] && flag=--gl
noisy=march=sampled,slices=1,steps=4,outputs=ao+near+far+composite
for history in no yes "yes,reproject=gather"; do
    out=$work/history-${history#yes,reproject=}
    # shellcheck disable=SC2086
    expect 0 "$viewer" $flag --headless --model "$room" --frames 8 --size 240x135 --png "$out" \
        --set "$noisy,temporal=$history"
done
check differ "$work/history-no/frame-007.png" "$work/history-yes/frame-007.png" 4 20
check differ "$work/history-gather/frame-007.png" "$work/history-yes/frame-007.png" 0 0.2 # 2.7 with motion backwards

# ---------------------------------------------------------------------------------------------------------- windows

if command -v xvfb-run > /dev/null; then
    # GLX unloads its driver with all that it has not freed, so that no suppression can name it
    export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"
    for backend in $backends; do
        flag=
        [ "$backend" = vulkan ] || flag=--gl
        # occluder: thick is refused with horizons, and the config stays; steps: none in a sweep
        # shellcheck disable=SC2086
        expect 0 xvfb-run -a -s '-screen 0 640x480x24' "$viewer" $flag --validate --size 240x135 --frames 5 \
            --press 'O ] T PageDown' --screenshot "$work/window-$backend.png" || continue
        says "set estimator=bitmask"
        says "steps has no effect"
        says "temporal=yes"
        says "preset quality"
        check spread "$work/window-$backend.png" 30 128
        check differ "$work/window-$backend.png" "$work/$backend-cornell/frame-000.png" 0.1 40
    done
fi

echo "viewer: $checks checks, $failed failed, on$backends"
[ "$failed" -eq 0 ] || exit 1
if ! command -v xvfb-run > /dev/null; then
    echo "viewer: no window was opened: apt-get install xvfb xauth"
    exit 77
fi
