#!/bin/sh
# SPDX-License-Identifier: MIT
# What README, ARCHITECTURE and CONTRIBUTING name exists: the order, files, tests, make targets, and the first scene runs.
. tests/cli/functions
cd "$TOP" || exit 1

# ARCHITECTURE.md quotes src/ORDER
sed -n '/^```order$/,/^```$/p' ARCHITECTURE.md | sed '/^```/d' | awk '
/^[a-z]/ { layer = $1; $1 = "" }
{ for (i = 1; i <= NF; i++) if ($i != "") print layer "/" $i }' >"$TMPDIR/quoted"
tools/modules src/ORDER | diff -u - "$TMPDIR/quoted" >&2 || fail "ARCHITECTURE.md does not quote src/ORDER"

# words in backticks that look like files of ours, or like tests
for document in README.md ARCHITECTURE.md CONTRIBUTING.md; do
	tr '\n' ' ' <$document | grep -o '`[^`]*`' | tr -d '`' >"$TMPDIR/words"
	while read -r word; do
		case $word in
		*NAME* | *' '* | *'<'* | *'...'*) ;;
		src/* | include/* | tests/* | tools/* | man/* | scenes/* | lua/* | .ci/*)
			for file in $word; do
				[ -e "$file" ] || case $word in
				tests/long/* | tests/fuzz/*) ;; # may be none
				*) fail "$document names '$word', which is not there" ;;
				esac
			done
			;;
		base/* | math/* | geom/* | model/* | world/* | step/* | flow/* | sink/* | script/* | app/*)
			ls src/${word%.[ch]}* >/dev/null 2>&1 || [ "$word" = world/id ] || [ "$word" = world/checkpoint ] ||
				fail "$document names module '$word', which is not there"
			;;
		*_*_*_*)
			grep -q "$word" tests/*.c || fail "$document names a test '$word', which is not there"
			;;
		esac
	done <"$TMPDIR/words"
done
grep -o '^| `make [a-z-]*' CONTRIBUTING.md | sed 's/.*make //' | while read -r target; do
	grep -Eq "^([a-z-]+ )*$target( [a-z-]+)*:" Makefile || fail "CONTRIBUTING.md names 'make $target', which is not there"
done || exit 1

# what merging writes twice, or leaves without its beginning
grep '^- ' CHANGELOG.md | sort | uniq -d >"$TMPDIR/twice"
[ ! -s "$TMPDIR/twice" ] || fail "CHANGELOG.md says twice: $(head -1 "$TMPDIR/twice")"
awk '/^  [a-z]/ && last ~ /\.$/ {print; bad = 1} {last = $0} END {exit bad}' CHANGELOG.md >&2 ||
	fail "CHANGELOG.md has lines that continue nothing"

# one screen, four pages
[ "$(wc -l <README.md)" -le 90 ] || fail "README.md is longer than a screen"
[ "$(sed "/^\`\`\`order/,/^\`\`\`$/d; /^## Names that were/,/^## /d" ARCHITECTURE.md | wc -w)" -le 2650 ] || fail "ARCHITECTURE.md is longer than four pages"

# the first scene
cd "$TMPDIR" || exit 1
sed -n '/^```lua$/,/^```$/p' "$TOP/README.md" | sed '/^```/d' >drop.lua
[ -s drop.lua ] || fail "README.md has no scene"
exits 0 drop.lua --no-record
exits 0 drop.lua --no-record --param e=0.5

# the gallery is what its script makes of the scenes' first lines
(cd "$TOP" && tools/gallery --text) | diff "$TOP/docs/gallery.md" - >&2 || fail "docs/gallery.md is behind: tools/gallery makes it"
