#!/bin/sh
# The examples emit and own_engine: exit codes and output. And own_engine with one line of the contract wrong: its RHI
# must say so, or the checks there are worth nothing.
#
#   sh tests/consumers/examples.sh BIN        BIN: the folder of hbil-emit, hbil-own-engine and shadergen
set -u

if [ $# -ne 1 ] || [ ! -x "$1/hbil-emit" ]; then
    echo "usage: sh examples.sh BIN" >&2
    exit 2
fi
bin=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
checks=0
failed=0

# Runs a program of $bin into out.txt and err.txt, and checks its exit code.
expect() # CODE PROGRAM ARGUMENT ...
{
    code=0; want=$1; program=$2
    shift 2
    "$bin/$program" "$@" > "$work/out.txt" 2> "$work/err.txt" || code=$?
    check "exit code $code, not $want: $program $*" test $code -eq "$want"
}
# Is the rest, a command, true?
check() # WHAT COMMAND ...
{
    what=$1
    shift
    checks=$((checks + 1))
    "$@" > /dev/null 2>&1 || { failed=$((failed + 1)); echo "FAIL  $what"; }
}

for program in hbil-emit hbil-own-engine; do
    expect 0 "$program" --help
    check "$program --help" grep -q "^usage: $program" "$work/out.txt"
    expect 2 "$program" slices
    expect 1 "$program" slices=99 steps=-1
    check "$program names a fault" grep -q 'slices=99: must be in \[1, 64\]' "$work/err.txt"
    check "$program names the other one" grep -q 'steps=-1' "$work/err.txt"
    check "$program prints nothing" test ! -s "$work/out.txt"
    [ ! -c /dev/full ] ||
        check "$program tells that the disk is full" sh -c '"$0" slices=2 > /dev/full; test $? -eq 3' "$bin/$program"
done

expect 0 hbil-emit outputs=ao+near slices=2
"$bin/shadergen" --set outputs=ao+near,slices=2 > "$work/expected"
check 'hbil-emit prints what shadergen does' cmp "$work/expected" "$work/out.txt"
expect 0 hbil-emit
check 'hbil-emit prints three passes' test "$(grep -c '^#version' "$work/out.txt")" -eq 3
expect 1 hbil-emit outputs=far environment=hook
check 'hbil-emit says what a hook is' grep -q 'pass light: the pass needs your hook text' "$work/err.txt"

# each preset, and what no preset has
engine() # WHAT ARGUMENT ...
{
    case=$1; code=0
    shift
    "$bin/hbil-own-engine" "$@" > "$work/out.txt" 2> "$work/err.txt" || code=$?
    check "exit code $code, not 0: hbil-own-engine, $case" test $code -eq 0
    check "hbil-own-engine, $case: faults" grep -q '^[1-9][0-9]* checks, 0 faults$' "$work/out.txt"
    check "hbil-own-engine, $case: other than three frames" test "$(grep -c '^frame' "$work/out.txt")" -eq 3
}
engine 'no arguments'
for preset in $("$bin/shadergen" --list-presets | sed -n 's/^  \([a-z_][a-z_]*\)  *[^ ].*/\1/p'); do
    # shellcheck disable=SC2046
    engine "preset $preset" $("$bin/shadergen" --preset "$preset" --print-config)
done
engine hook outputs=ao+near+far environment=hook
engine mix outputs=ao+near+sh+cone temporal=yes reproject=gather filter=5x5 filter_passes=3 downscale=4 target=gl

# The contract with one line wrong. The edit must be one.
wrong() # WHAT FAULT SED-SCRIPT
{
    checks=$((checks + 1))
    sed "$3" "$root/examples/own_engine/main.c" > "$work/main.c"
    if cmp -s "$work/main.c" "$root/examples/own_engine/main.c" ||
        ! cc -I"$root/examples/own_engine" -I"$root" "$work/main.c" -o "$work/wrong" 2> "$work/err.txt"; then
        failed=$((failed + 1))
        echo "FAIL  own_engine has no such line, or does not compile without it: $1"
        cat "$work/err.txt"
        return
    fi
    code=0
    "$work/wrong" > "$work/out.txt" || code=$?
    [ $code -eq 4 ] && grep -q "^  FAULT .*: $2\$" "$work/out.txt" && return
    failed=$((failed + 1))
    echo "FAIL  unnoticed in own_engine: $1"
}
wrong 'no barriers' 'no barrier since it was used' '/rhi_barrier(/s/rhi_barrier.*/{}/'
wrong 'a barrier of the first copy only' 'no barrier since it was used' '/barrier->texture/s/k < .*copies/k < 1/'
wrong 'age is ignored' 'read and written by one dispatch' 's/ - bind->age//'
wrong 'frames are not counted' 'read before it was written' 's/++e->frames;/{}/'
wrong 'textures are not made' 'no such texture' 's/= rhi_texture(.*)/= 0/'
wrong 'no uniforms' 'not all that its text declares is bound' '/rhi_uniforms(/d'
wrong 'a binding left out' 'not all that its text declares is bound' '/pass->binding_count/s/b = 0/b = 1/'

echo "examples: $checks checks, $failed failed"
[ $failed -eq 0 ]
