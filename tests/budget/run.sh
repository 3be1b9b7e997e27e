#!/bin/sh
# Keeps the header small enough to drop into a project and to read. Raise a limit only together with the reason in the
# changelog. sizeof(hbil_plan) has its limit in the header itself, as a static assert.
#
#   sh tests/budget/run.sh [HEADER]        default: hbil.h
set -u

header=${1:-$(dirname "$0")/../../hbil.h}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
failed=0

within() # WHAT VALUE LIMIT
{
    verdict=ok
    if [ "$2" -le 0 ] || [ "$2" -gt "$3" ]; then verdict=FAIL; failed=1; fi
    printf '%-4s  %-44s %7d of %7d\n' "$verdict" "$1" "$2" "$3"
}

[ -r "$header" ] || { echo "budget: cannot read $header" >&2; exit 1; }
within 'lines' "$(wc -l < "$header")" 10000
within 'bytes' "$(wc -c < "$header")" 500000
# What a reader of the API sees: all before the implementation. 0 if the marker is gone, which fails too.
within 'lines of documentation and declarations' \
    "$(awk '/^#ifdef HBIL_IMPLEMENTATION$/ { print NR; seen = 1; exit } END { if (!seen) print 0 }' "$header")" 1200

# Twice the size of the first version, text of the shaders included: what a program grows by.
if command -v gcc >/dev/null && command -v size >/dev/null; then
    cp "$header" "$work/hbil.h"
    printf '#define HBIL_IMPLEMENTATION\n#include "hbil.h"\n' > "$work/hbil.c"
    gcc -std=c99 -O2 -c "$work/hbil.c" -o "$work/hbil.o" || exit 1
    within 'bytes of object code and constants, gcc -O2' "$(size "$work/hbil.o" | awk 'NR == 2 { print $1 + $2 + $3 }')" 245760
else
    echo 'skip  object code: gcc or size is not installed'
fi
exit $failed
