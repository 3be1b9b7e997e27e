#!/bin/sh
# Blender to hbil-frame: renders the built-in scene of examples/blender/export_frame.py, and the same from .blend files
# with awkward settings, holds the frames against the scene's own numbers, and lights one.
#
#   sh tests/blender/run.sh HBIL-FRAME BLENDER-CHECK
#
# Exit code 77 where Blender or its Cycles is missing.
set -u

if [ $# -ne 2 ] || [ ! -x "$1" ] || [ ! -x "$2" ]; then
    echo "usage: sh run.sh HBIL-FRAME BLENDER-CHECK" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
script=$here/../../examples/blender/export_frame.py
if ! command -v blender > /dev/null; then
    echo 'skip  blender is not installed. sh packages.sh blender installs it, with about 600 MB'
    exit 77
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

failed=0
verdict() # CODE WHAT
{
    if [ "$1" -eq 0 ]; then echo "ok    $2"; else echo "FAIL  $2"; failed=1; fi
}
# Runs Blender on a .blend, or on nothing, with what follows.
run() # WHAT ARGUMENT ...
{
    what=$1 code=0
    shift
    blender -b --factory-startup "$@" > "$work/out.txt" 2> "$work/err.txt" || code=$?
    [ "$code" -eq 77 ] && { echo 'skip  this blender has no Cycles'; exit 77; }
    verdict "$code" "$what"
    [ "$code" -eq 0 ] || tail -n 20 "$work/out.txt" "$work/err.txt"
}

run 'two .blend files, and what is refused' --python-exit-code 1 --python "$here/scenes.py" -- "${script%/*}" "$work"
grep -e '^ok' -e '^FAIL' "$work/out.txt"
sum=$(cksum "$work/perspective.blend")
run 'demo' --python "$script" -- --demo --out "$work/demo" --frames 0:1 --samples 16 --size 192x108 --truth
for scene in perspective orthographic; do
    run "$scene.blend" "$work/$scene.blend" --python "$script" -- --out "$work/$scene" --frames 0:1 --samples 16
done
test "$sum" = "$(cksum "$work/perspective.blend")"
verdict $? 'the .blend is as it was'
test "$(cd "$work/demo" && echo .[!.]* *)" = '.[!.]* camera-000.json camera-001.json frame-000.exr frame-001.exr'
verdict $? 'no other file'

no_driver=5 # exit code of hbil-frame
for backend in vulkan gl; do
    code=0
    "$1" --frame "$work/demo/frame-%03d.exr" --camera "$work/demo/camera-%03d.json" --frames 0:1 --preset balanced \
        --set temporal=yes,reproject=gather --backend "$backend" -q --out "$work/$backend-%03d.exr" \
        --png "$work/$backend" || code=$?
    if [ "$code" -eq "$no_driver" ]; then
        echo "skip  $backend: no driver"
        continue
    fi
    verdict "$code" "hbil-frame on $backend"
    test -s "$work/$backend/001/after.png"
    verdict $? 'pictures'
    cp "$work/$backend-000.exr" "$work/demo/ao.exr"
    "$2" "$work/demo" > "$work/check.txt"
    verdict $? "frames and ambient occlusion, $backend"
    grep -e FAIL -e ao -e correlation "$work/check.txt"
done
"$2" "$work/demo" "$work/perspective" "$work/orthographic"
verdict $? 'frames against the scene'
exit $failed
