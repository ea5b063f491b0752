#!/bin/sh
# SPDX-License-Identifier: MIT
# A sweep has a run for each point, with the bits of single runs, in any way it is run; failed points are kept and told.
. tests/cli/functions

mkdir -p src/parts
cat >src/parts/box.lua <<'END'
return function(n) return 0.1 * n end
END
cat >src/s.lua <<'END'
local e = param("e", 0.5, "restitution", {min = 0, max = 2})
local n = param("n", 2, "balls")
local kind = param("kind", "plain", "what for", {choices = {"plain", "row"}})
local box = require "parts.box"
local place = function(i) return {box(5 * i), 0, 0.3 + 0.1 * math.random()} end
if kind == "row" then local lattice = require "rbsim.lattice" end
world { duration = 0.4, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = math.min(e, 1), density = 1000 }
plane { normal = {0, 0, 1}, material = m }
if n == 0 then error("no balls") end
for i = 1, n do sphere { radius = 0.1, position = place(i), material = m } end
expect("small", function() return e, 1.3 end)
END
exits 0 sweep src/s.lua -p e=0:1:0.5 -p kind=plain,row --seeds 2 -o d --jobs 2
says err 'd: 12 of 12 points done'
for i in 00 05 11; do
	for ending in h5 json log; do [ -f d/point-000$i.$ending ] || fail "no point-000$i.$ending"; done
done
for file in scene/s.lua scene/parts/box.lua lua/rbsim/lattice.lua; do [ -f d/$file ] || fail "no d/$file"; done

# plan.csv says what a point is; a single run of it ends in the same state
grep -v '^#' d/plan.csv >rows
[ "$(wc -l <rows)" -eq 13 ] || fail "rows: $(cat rows)"
sed -n '2,$p' rows | while IFS=, read -r index seed e kind; do
	exits 0 src/s.lua --no-record --json -p "e=$e" -p "kind=$kind" --seed "$seed"
	single=$(value state_hash)
	swept=$(value state_hash "$(printf 'd/point-%05d.json' "$index")")
	[ -n "$single" ] && [ "$single" = "$swept" ] || fail "point $index: state $swept, alone $single"
done || exit 1

# shares, in another folder that is moved before, and without the scene: the same
exits 0 sweep src/s.lua -p e=0:1:0.5 -p kind=plain,row --seeds 2 -o first --plan
says out '12 points of s.lua'
mkdir elsewhere && mv first elsewhere/second && mv src away
for k in 0 1 2 3 4; do
	exits 0 sweep elsewhere/second --task $k --tasks 5 --quiet --jobs 1
	says_nothing err
done
exits 0 sweep elsewhere/second --status --json
[ "$(value "done")" = 12 ] || fail "shares have not run all points"
for json in d/*.json; do
	[ "$(value state_hash "$json")" = "$(value state_hash "elsewhere/second/${json#d/}")" ] || fail "$json: other bits"
done
mv away src

# again: nothing is run; from the folder alone too
stamp=$(ls -l --time-style=full-iso d/*.h5)
exits 0 sweep src/s.lua -p e=0:1:0.5 -p kind=plain,row --seeds 2 -o d
exits 0 sweep d --json
[ "$(value runs)" = 0 ] || fail "$(value runs) points were run again"
[ "$stamp" = "$(ls -l --time-style=full-iso d/*.h5)" ] || fail "recordings were written again"

# what is lost or damaged is run again, and nothing else
rm d/point-00001.h5
cp d/point-00003.h5 d/point-00002.h5
: >d/point-00004.json
printf x >d/point-00005.h5
exits 0 sweep d --status
says out '12 points of s.lua: 8 done, 4 unfinished'
says out 'array=1-2,4-5'
exits 0 sweep d --json
[ "$(value runs)" = 4 ] || fail "$(value runs) points were run again, wanted 4"

# whose recording it is, is told by its parameters: as numbers where both are numbers, and nothing is no number
echo 'param("text", "", "any") world { duration = 0.01 } sphere { radius = 1, mass = 1 }' >text.lua
for text in "" 0 0.0 1 x; do exits 0 sweep text.lua -p "text=$text" -o "text-$text" -q; done
for a in "" 0 0.0 1 x; do
	for b in "" 0 0.0 1 x; do
		rm -rf other && cp -r "text-$a" other
		cp "text-$b"/point-* other
		exits 0 sweep other --status
		case "$a,$b" in
		0,0.0 | 0.0,0 | "$a,$a") says out '1 point of text.lua: 1 done' ;;
		*) says out ': 0 done, 1 unfinished' ;;
		esac
	done
done

# processor time told is that of the runs, of which the system knows too; a terminal is told a time that is left
cat >account.py <<'END'
import json, os, pty, resource, subprocess, sys
program = os.environ["RBSIM"]
words = [program, "sweep", "text.lua", "--seeds", "40", "--jobs", "2", "-o"]
told = json.loads(subprocess.run(words + ["c", "--json"], check=True, capture_output=True).stdout)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
assert 0 < told["processor_time"] < used.ru_utime + used.ru_stime, (told["processor_time"], used)
said = b""
child, terminal = pty.fork()
if child == 0:
    os.execve(program, words + ["t"], dict(os.environ, TERM="xterm"))
while True:
    try:
        said += os.read(terminal, 4096)
    except OSError:
        break
assert os.waitpid(child, 0)[1] == 0, said
assert b" left" in said and b"ages left" not in said, said
END
python3 account.py || fail "the account of a sweep is wrong"

# failing points: an expectation, a scene that is wrong there; they stop nothing and are told with reasons
exits 1 sweep src/s.lua -p e=1,1.5,0.5 -p n=1,0 -o f
says err 'point 2 \(e=1.5, n=1\) failed, exit status 1: 1 of 1 expectations failed'
says err 'point 1 \(e=1, n=0\) failed, exit status 65: .*s.lua:10: no balls'
says err 'f: 2 of 6 points done, 4 failed'
failed=4
exits 0 sweep f --status
says out 'failed +2 \(e=1.5, n=1\), exit status 1: 1 of 1 expectations failed'
[ "$(grep -c '^  failed' out)" = "$failed" ] || fail "not all $failed failed points are listed"
exits 0 sweep f --status --json
[ "$(value failed)" = "$failed" ] || fail "JSON: $(cat out)"
python3 -c 'import json; f = json.load(open("out"))["failures"]; assert f[0]["parameters"], f' || fail "JSON of the status"
exits 1 sweep f --json
[ "$(value runs)" = 0 ] || fail "failed points were run again without being asked for"
exits 1 sweep f --retry-failed --json
[ "$(value runs)" = "$failed" ] || fail "--retry-failed ran $(value runs)"

# without recordings; a sample; runs that cannot be begun again are those of this machine
exits 0 sweep src/s.lua -p e=0:1 --sample latin:5 --no-record --duration 0.1 -o n
[ ! -e n/point-00000.h5 ] || fail "--no-record left a recording"
exits 0 sweep n --status
says out '5 points of s.lua: 5 done'

# films: each run has a folder of its own
cat >>src/s.lua <<'END'
camera { name = "c", position = {0, -3, 1}, look_at = {0, 0, 0}, size = {64, 48}, fps = 5, png = "p/%03d.png" }
END
exits 0 sweep src/s.lua -p e=0.5,1 -o films
[ -f films/point-00001/p/000.png ] || fail "no films: $(ls films)"
[ -f films/point-00001.h5 ] || fail "no recording beside the films"
