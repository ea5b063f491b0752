#!/bin/sh
# SPDX-License-Identifier: MIT
# Scenes that would keep the machine busy, take its memory, end the program or get out of the sandbox are refused: with status 65
# and a message, within seconds, never by a signal and never by the last resort that leaves a recording open.
. tests/cli/functions

case ${RBSIM_MODE:-release} in
tsan) echo "tsan holds signals back where nothing of the system's library is called"; exit 77 ;;
release) enough=0.3 ;;
*) enough=1 ;;
esac

# nested NAME PATTERN BEFORE LEFT MIDDLE RIGHT: left and right three thousand times around the middle
nested()
{
	echo "=== $1 | check | $2"
	awk -v before="$3" -v left="$4" -v middle="$5" -v right="$6" 'BEGIN {
		printf "%s", before
		for (i = 0; i < 3000; i++) printf "%s", left
		printf "%s", middle
		for (i = 0; i < 3000; i++) printf "%s", right
		print ""
	}'
}
{
	sed -n '/^=== /,$p' "$TOP/tests/scenes/hostile.txt"
	nested parser-parentheses 'C stack overflow' 'x = ' '(' 1 ')'
	nested parser-blocks 'C stack overflow' '' 'do ' '' 'end '
	nested parser-functions 'C stack overflow' '' 'return function() ' '' 'end '
	nested parser-tables 'C stack overflow' 'x = ' '{' '' '}'
	nested parser-signs 'C stack overflow' 'x = ' '- ' 1 ''
	nested parser-texts 'C stack overflow' 'x = ' '1 .. ' 1 ''
	nested parser-locals 'too many local variables' '' 'local a ' '' ''
	nested parser-digits 'malformed number' 'x = ' 9 e+ ''
} >list

# ask NAME VERB PATTERN: the scene is NAME.lua
ask()
{
	tried=$((tried + 1))
	case $2 in
	check) set -- "$1" "$3" check "$1.lua" ;;
	run) set -- "$1" "$3" "$1.lua" -o "$1.h5" ;;
	*) fail "$1: no verb '$2'" ;;
	esac
	name=$1 pattern=$2
	shift 2
	# of processor time: what has no end needs no more than to begin
	case $pattern in 'longer than') seconds=0.2 ;; *) seconds=$enough ;; esac
	RBSIM_SCRIPT_SECONDS=$seconds timeout "$PATIENCE" "$RBSIM" "$@" >out 2>err </dev/null
	got=$?
	if [ $got -ne 65 ] || ! grep -Eq -- "$pattern" err || grep -q "can't be stopped" err; then
		through=$((through + 1))
		echo "$name: exit status $got, wanted 65 and '$pattern'; it says: $(head -n 3 err | cut -c 1-300)" >&2
	fi
	[ ! -e "$name.h5.partial" ] || fail "$name: the recording was left open"
}

tried=0 through=0
awk '/^=== / { name = $2; print substr($0, 5) >"names"; next } { print >(name ".lua") }' list
while IFS='|' read -r name verb pattern; do
	ask "${name% }" "$(echo "$verb" | tr -d ' ')" "${pattern# }"
done <names
[ "$tried" -ge 40 ] || fail "only $tried scenes were tried"
[ "$(sort names | cut -d '|' -f 1 | uniq -d)" = "" ] || fail "a name stands twice"
[ ! -e touched ] || fail "a scene ran a program"
echo "$tried hostile scenes, $through got through"
[ "$through" -eq 0 ]
