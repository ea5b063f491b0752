#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim methods names every method and every rollback that a scene may have, in words and as JSON.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3"; exit 77; }

exits 0 methods
cp out text
exits 0 methods --json
python3 - text out >names <<'END' || fail "the words and the JSON differ"
import json, re, sys
words = open(sys.argv[1]).read()
told = json.load(open(sys.argv[2]))
for method in told["methods"]:
    print("method", method["name"])
    for key in "what", "good_for", "mind":
        assert len(method[key]) > 10 and method[key] in words, method
for rollback in told["rollbacks"]:
    print("rollback", rollback["name"])
    assert len(rollback["what"]) > 10 and rollback["what"] in words, rollback
assert len(set(m["what"] for m in told["methods"])) == len(told["methods"])
heads = re.findall(r"^  (\S+) ", words, re.M)
assert heads == [m["name"] for m in told["methods"]] + [r["name"] for r in told["rollbacks"]], heads
END
[ "$(wc -l <names)" -ge 7 ] || fail "$(wc -l <names) methods and rollbacks"

# each can be chosen, and there are no others
echo 'world { duration = 0.01 } sphere { radius = 1 }' >s.lua
while read -r option name; do
	exits 0 s.lua --no-record -q --"$option" "$name"
done <names
exits 64 s.lua --no-record --method other
for name in $(sed -n 's/^method //p' names); do
	says err "$name"
done
exits 64 s.lua --no-record --rollback other
for name in $(sed -n 's/^rollback //p' names); do
	says err "$name"
done
if [ -e /dev/full ]; then
	"$RBSIM" methods >/dev/full 2>err
	got=$?
	[ $got -eq 74 ] || fail "methods >/dev/full: $got, not 74"
fi
