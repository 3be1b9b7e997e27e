#!/bin/sh
# What hbil.h costs the program that includes it: compile time (median of five, seconds), object code, lines and bytes.
set -eu

header=$(dirname "$0")/../../hbil.h
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cp "$header" "$work/hbil.h"
cd "$work"
printf '#include "hbil.h"\nint declarations_only;\n' > declarations.c
printf '#define HBIL_IMPLEMENTATION\n#include "hbil.h"\n' > implementation.c

# GNU date counts nanoseconds; the shell has no clock of its own.
now() { date +%s%N; }

# Median of five, in seconds.
seconds() # COMMAND ...
{
    for run in 1 2 3 4 5; do
        begin=$(now)
        "$@"
        echo "$run $(($(now) - begin))"
    done | sort -n -k 2 | awk 'NR == 3 { printf "%.3f", $2 / 1e9 }'
}

printf '\n%-8s %-24s %10s %10s %8s\n' compiler 'what, flags' 'seconds' 'code B' 'data B'
for compiler in gcc clang; do
    command -v $compiler > /dev/null || { echo "$compiler is not installed"; continue; }
    for what in 'declarations -O0' 'implementation -O0' 'implementation -O2' 'implementation -Os'; do
        file=${what% *}
        flag=${what#* }
        took=$(seconds $compiler -std=c99 "$flag" -c "$file.c" -o "$file.o")
        printf '%-8s %-24s %10s' $compiler "$what" "$took"
        size "$file.o" | awk 'NR == 2 { printf " %10d %8d\n", $1, $2 + $3 }'
    done
done
echo "hbil.h: $(wc -l < hbil.h) lines, $(wc -c < hbil.h) bytes"
