#!/bin/sh
# run.sh ROOT BIN - what README.md shows is true: every ```c block compiles without a warning, links and runs; every
# ```console block prints what stands below its `$ ` line; every local link leads to a file; every quote is what stands
# between the marks of a program that is built and tested.
set -u
root=$1 bin=$2 failed=0
temp=$(mktemp -d) || exit 1
trap 'rm -rf "$temp"' EXIT
flags="-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wdouble-promotion -Werror"

say() { printf '%-6s %s\n' "$1" "$2"; [ "$1" = ok ] || failed=1; }

awk -v dir="$temp" '/^```c$/ { n++; on = 1; next } /^```/ { on = 0 } on { print > (dir "/" n ".c") }' "$root/README.md"
awk -v dir="$temp" '/^```console$/ { n++; on = 1; next } /^```/ { on = 0 } on { print > (dir "/" n ".console") }' "$root/README.md"

for source in "$temp"/*.c; do
    # shellcheck disable=SC2086
    if cc $flags -I"$root" "$source" -o "$temp/program" && "$temp/program" > "$temp/output" && [ -s "$temp/output" ]; then
        say ok "C block $(basename "$source" .c): $(wc -l < "$temp/output") lines printed"
    else
        say FAILED "C block $(basename "$source" .c)"
    fi
done
for block in "$temp"/*.console; do
    command=$(sed -n 's/^\$ //p' "$block")
    sed 1d "$block" > "$temp/expected"
    PATH=$bin:$PATH sh -c "$command" | head -n "$(wc -l < "$temp/expected")" > "$temp/output"
    if diff "$temp/expected" "$temp/output"; then say ok "$command"; else say FAILED "$command"; fi
done
# quote NAME PAGE: below `<!-- quote of FILE: NAME -->` stands what FILE has between its marks <<NAME and >>NAME
for page in README.md backends/README.md; do
    for mark in $(sed -n 's/^<!-- quote of \(.*\): \(.*\) -->$/\1:\2/p' "$root/$page"); do
        file=${mark%:*} name=${mark#*:}
        sed -n "/^\/\* <<$name \*\//,/^\/\* >>$name \*\//p" "$root/$file" | sed '1d; $d' > "$temp/expected"
        sed -n "/^<!-- quote of .*: $name -->/,/^\`\`\`\$/p" "$root/$page" | sed '1,2d; $d' > "$temp/output"
        if [ -s "$temp/expected" ] && diff "$temp/expected" "$temp/output"; then say ok "$page quotes $name of $file"
        else say FAILED "$page: other than $name of $file"; fi
    done
done
for page in README.md backends/README.md; do
    for link in $(grep -o '](\([^)]*\))' "$root/$page" | sed 's/^](//; s/)$//; s/#.*//' | sort -u); do
        [ -e "$root/$(dirname "$page")/$link" ] || say FAILED "$page: no file $link"
    done
done
# messages of the table `refused`, in the last column between backticks
awk '/^<!-- refused: / { on = 1; next } on && /^\|/ { rows = 1; print } on && rows && !/^\|/ { exit }' "$root/README.md" |
    sed -n '3,$s/.*| `\(.*\)` |$/\1/p' > "$temp/messages"
while IFS= read -r message; do
    if cat "$root"/hbil.h "$root"/backends/*.h "$root"/examples/frame/*.c | tr -d '\n' | sed 's/" *"//g' | grep -qF -e "$message"; then say ok "message: $message"
    else say FAILED "no such message: $message"; fi
done < "$temp/messages"
[ "$(wc -l < "$temp/messages")" -ge 8 ] || say FAILED 'README.md: the table of what is refused is not found'
# figures of that chapter which files hold
figure() { if grep -qF -e "$1" "$root/README.md"; then say ok "figure: $1"; else say FAILED "README.md does not say: $1"; fi; }
figure " of $(find "$root/tests/fuzz/corpus" -type f ! -path '*/found/*' | wc -l) files in every \`make test\`"
if [ -x "$bin/hbil-mutate" ]; then
    figure "$("$bin/hbil-mutate" --root "$root" --lint | sed -n '/each has a case/p')"
fi
exit $failed
