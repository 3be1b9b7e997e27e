# lib.sh - what the tests of shadergen's command lines share; sourced by them, with the program as $1 and `command` set to what stands
# between its name and the arguments. Leaves the shell in an empty folder that is gone afterwards.
if [ $# -ne 1 ] || [ ! -x "$1" ]; then
    echo "usage: sh $(basename "$0") SHADERGEN" >&2
    exit 2
fi
bin=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 1
mounted=
cleanup() { [ -z "$mounted" ] || umount "$mounted"; rm -rf "$work"; }
trap cleanup EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1

checks=0
failed=0
group=

say()  { group=$1; }
fault() { failed=$((failed + 1)); echo "FAIL  $group: $1"; }
skip() { echo "skip  $group: $1"; }
# Is the rest, a command, true?
check() # WHAT COMMAND ...
{
    what=$1
    shift
    checks=$((checks + 1))
    "$@" > check.log 2>&1 || { fault "$what"; sed 's/^/      /' check.log | head -5; }
}
# Runs shadergen into out.txt and err.txt, and checks its exit code.
expect() # CODE ARGUMENT ...
{
    want=$1
    shift
    checks=$((checks + 1))
    code=0
    # shellcheck disable=SC2086
    "$bin" $command "$@" > out.txt 2> err.txt < /dev/null || code=$?
    [ "$code" -eq "$want" ] || { fault "exit code $code, not $want: $command $*"; sed 's/^/      /' err.txt | head -3; }
}
says()    { check "message has: $1" grep -qF -e "$1" err.txt; }
silent()  { check "nothing on the error stream" test ! -s err.txt; }
no_data() { check "nothing on the output" test ! -s out.txt; }
same()    { check "$1 equals $2" diff -r "$1" "$2"; }
absent()  { check "$1 is not there" test ! -e "$1"; }
no_temporaries() { check "no temporary file left in $1" test -z "$(find "$1" -name '*.tmp*' -type f)"; }
