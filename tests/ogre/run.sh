#!/bin/sh
# hbil-ogre: does hbil.h light a frame of OGRE's, the right way up, and do faults get their exit codes?
#
#   sh tests/ogre/run.sh HBIL-OGRE CHECK
set -u

bin=${1-}
check=${2-}
if [ ! -x "$bin" ]; then
    echo "skipped: hbil-ogre was not built: OGRE 1.12 is missing (Debian: libogre-1.12-dev)"
    exit 77
fi
if ! command -v xvfb-run >/dev/null || ! command -v xauth >/dev/null; then
    echo 'skipped: no xvfb-run (Debian: xvfb xauth)'
    exit 77
fi
# What leaks here lies in plugins and drivers that are unloaded at the end: no suppression names it.
export ASAN_OPTIONS="detect_leaks=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
# One display for all.
if [ -z "${HBIL_OGRE_INNER-}" ]; then
    HBIL_OGRE_INNER=1 exec xvfb-run -a sh "$0" "$bin" "$check"
fi

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
failed=0

# Runs hbil-ogre; the exit code, and what the message names if it is not 0.
expect() # CODE WORD ARGUMENT ...
{
    want=$1
    word=$2
    shift 2
    code=0
    "$bin" --size 320x180 "$@" > "$work/out" 2> "$work/err" < /dev/null || code=$?
    if [ "$code" -eq "$want" ] && { [ -z "$word" ] || grep -qF -e "$word" "$work/err"; }; then
        echo "ok    exit $code: hbil-ogre $*"
    else
        failed=1
        echo "FAIL  exit $code, not $want, or the message does not name '$word': hbil-ogre $*"
        sed 's/^/      /' "$work/err"
    fi
}

expect 0 '' --frames 3 --view direct --png "$work/direct.png"
expect 0 '' --frames 3 --view composite --png "$work/composite.png"
expect 0 '' --frames 3 --view ao --png "$work/ao.png"
expect 0 '' --frames 6 --set bounces=recursive,facing=half_space,temporal=yes --png "$work/recursive.png"
"$check" "$work/direct.png" "$work/composite.png" "$work/ao.png" "$work/recursive.png" || failed=1
# The same from fragment shaders, which touch far more of the state that OGRE caches.
expect 0 '' --frames 3 --preset sampled --set stage=fragment --view ao --png "$work/fragment.png"
"$check" "$work/direct.png" "$work/composite.png" "$work/fragment.png" "$work/recursive.png" || failed=1
expect 0 '' --frames 2 --view split

expect 2 --nonsense --nonsense 1
expect 2 --png --png
expect 2 --size --size 320
expect 2 --size --size 0x180
expect 2 --frames --frames 2x
expect 2 --view --view inside
expect 1 nonsense --preset nonsense
expect 1 slices --set slices=99
expect 3 nowhere --frames 1 --png "$work/nowhere/x.png"
(unset DISPLAY; expect 5 display --frames 1 --png "$work/x.png"; exit $failed) || failed=1

left=$(find "$work" -name 'x.png*' -o -name '*.tmp')
[ -z "$left" ] || { failed=1; echo "FAIL  left behind: $left"; }
exit $failed
