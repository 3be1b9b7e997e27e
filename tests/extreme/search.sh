#!/bin/sh
# search.sh - hbil-search finds a planted fault and makes it small; its cases read back as they were written; wrong arguments are told.
# search.sh BIN
set -u
bin=$1
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
fail() { echo "search.sh: $*" >&2; test ! -e "$out/log" || cat "$out/log" >&2; exit 1; }

"$bin" --help | grep -q -- --replay || fail "--help does not name --replay"
"$bin" --seed none >"$out/log" 2>&1; test $? -eq 2 || fail "a wrong number is not told with exit code 2"
"$bin" --backend metal >"$out/log" 2>&1; test $? -eq 2 || fail "an unknown device is not told with exit code 2"
echo 'config outputs=ao slices=1000' >"$out/bad.case"
"$bin" --replay "$out/bad.case" >"$out/log" 2>&1; test $? -eq 4 || fail "a case with a wrong config is not told with exit code 4"
grep -q 'bad.case:1: .*slices' "$out/log" || fail "the message names neither line nor option"

# hazard H3: the cosine of a silhouette rounds above 1, and without its clamp the root of what is left of 1 is NaN
from='clamp(dot(h, r.v) * inv, -1.0, 1.0)'
to='(dot(h, r.v) * inv)'
"$bin" --seed 8 --seconds 60 --shrink 20 --plant "$from" "$to" --quiet --out "$out" >"$out/log" 2>&1
code=$?
test $code -eq 77 && exit 77
test $code -eq 1 || fail "the planted fault is not found: exit code $code"
found=$(ls "$out"/*-vulkan-*.case 2>/dev/null | head -1)
test -n "$found" || fail "no case was written"
pixels=$(awk '$1 == "width" { w = $2 } $1 == "height" { n += w * $2 } END { print n + 0 }' "$found")
test "$pixels" -ge 1 && test "$pixels" -le 16 || fail "shrunk to $pixels pixels only"
"$bin" --replay "$found" --plant "$from" "$to" >"$out/log"; test $? -eq 1 || fail "the case does not fail again"
"$bin" --replay "$found" >"$out/log"; test $? -eq 0 || fail "the case fails without the fault"
echo "search.sh: a planted fault was found and shrunk to $pixels pixels"
