#!/bin/sh
# SPDX-License-Identifier: MIT
# Texts of scenes, arguments and files that would steer a terminal reach it as letters, on every way; machines get them whole.
. tests/cli/functions

# controls, a window's title, C1, overrides and isolates of direction, a byte that is no UTF-8, a forged line
bad='\27]0;x\7\27[2J\13\194\155\226\128\174\226\129\166\239\187\191\255'
cat >s.lua <<END
local n = param("n", 1, "how$bad\nok forged")
world { title = "T$bad\nok forged", description = "D$bad\nok forged", duration = 0.2, frame_rate = 10, gravity = {0, 0, -9.81} }
print("P$bad")
local m = material { name = "m$bad\nok forged", restitution = 0.5, density = 1000, friction = 0.4 }
plane { normal = {0, 0, 1}, material = m }
sphere { name = "b$bad\nok forged", radius = 0.1, position = {0, 0, 0.3}, material = m }
expect("E$bad\nok forged", function() return n < 2 end)
END
printf "%s\n" "error('R$bad\nok forged')" >bad.lua
printf "%s\n" "world { ['k$bad\nok forged'] = 1 }" >key.lua
cat >name.lua <<END
world { duration = 1 }
sphere { name = "x$bad\nok forged", radius = -1 }
END
cat >hook.lua <<END
world { duration = 1 }
sphere { radius = 1 }
function on_frame() error("H$bad\nok forged") end
END
nasty=$(printf 'f\033]0;x\007\n\342\200\256\377.lua')
cp s.lua "$nasty"

# clean NAME FILE...: nothing of what was said to people can steer
clean()
{
	name=$1
	shift
	for file; do
		LC_ALL=C grep -q "$(printf '[\001-\010\013-\037\177\377]')" "$file" && fail "$name: a control character, or a byte that is none, in $file"
		LC_ALL=C grep -qE "$(printf '\302[\200-\237]|\342\200[\250-\256]|\342\201[\246-\251]|\357\273\277')" "$file" && fail "$name: C1 or a mark of direction in $file"
		grep -q '^ *ok forged' "$file" && fail "$name: a forged line in $file"
	done
	return 0
}

# way STATUS ARGUMENT...
way()
{
	exits "$@"
	clean "$*" out err
}

way 0 s.lua --no-record
says err 'T\\x1b]0;x\\x07'
says err 'P.*\\u\{202e\}'
way 1 s.lua --no-record --param n=3
says err 'FAIL.*\\u\{9b\}'
way 0 check s.lua
way 0 run --help s.lua
says out 'how\\x1b'
way 0 run "$nasty" --no-record
way 66 run "$(printf 'none\033[1m\302\233\nok forged\377.lua')"
way 64 run s.lua --no-record "$(printf -- '--opt\033[1m\nok forged\377')"
way 64 run s.lua --no-record --param "$(printf 'p\033[1m\nok forged=1')"
way 65 bad.lua
way 65 bad.lua --debug
way 65 key.lua
way 65 name.lua
way 65 hook.lua --no-record
way 65 hook.lua --no-record --debug

# for machines all of it stays, as valid JSON, which escapes what a terminal would obey
way 0 s.lua --no-record --json
if command -v python3 >/dev/null; then
	python3 - <<'END' || fail "--json has lost what the texts hold"
import json
text = json.dumps(json.load(open("out", encoding="utf-8")))
assert "\\u001b]0;x" in text and "\\u202e" in text and "\\nok forged" in text
END
fi

# whatever else of app/ writes for people goes through rb_print: what writes otherwise has only texts of its own
(cd "$TOP" && grep -lE '(^|[^a-z_])f?printf\(.*%[-0-9.*]*s' src/app/*.c | grep -vE '/(chart|export_csv|export_vtk|help|main|plot|summary|verify)\.c') &&
	fail "these write texts without rb_print"

if [ -f "$(dirname "$RBSIM")/rbsim-hdf5.so" ]; then
	way 0 s.lua -o "$(printf 'r\033[1m\342\200\256.h5')"
	way 0 s.lua
	way 0 info s.h5
	way 0 diff s.h5 s.h5
	way 0 replay s.h5
	exits 0 info --scene s.h5
	cmp -s out s.lua || fail "info --scene differs from the scene"
	# a job script, with programs of ours in the place of Slurm's
	mkdir bin
	echo 'echo 4711' >bin/sbatch
	echo 'echo "MaxArraySize = 5"' >bin/scontrol
	chmod +x bin/*
	sed -i '1i#!/bin/sh' bin/sbatch bin/scontrol
	evil=$(printf 's\n#SBATCH --evil\033[1m.lua')
	cp s.lua "$evil"
	PATH=$PWD/bin:$PATH
	way 64 sweep "$evil" -p n=0,1 -o sw --slurm
	[ ! -e sw ] || fail "what is refused has a folder"
	evil=$(printf 'sw\n#SBATCH --evil\033[1m')
	way 0 sweep s.lua -p n=0,1 -o "$evil" --slurm
	clean "a job script" "$evil/sweep.sbatch"
	grep -q '^#SBATCH --evil' "$evil/sweep.sbatch" && fail "the name of a folder gives orders to Slurm"
fi
exit 0
