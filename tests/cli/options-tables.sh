#!/bin/sh
# SPDX-License-Identifier: MIT
# The manual's list of options and both completions are what the option table gives.
. tests/cli/functions

exits 0 --print-tables options
sed -n '/^\.\\" table options$/,/^\.\\" end$/p' "$TOP/man/rbsim.1" >manual
cmp -s out manual || { diff out manual >&2; fail "man/rbsim.1 is behind: paste what rbsim --print-tables options prints"; }
for shell in bash:rbsim.bash zsh:_rbsim; do
	exits 0 --print-tables "${shell%:*}"
	cmp -s out "$TOP/tools/completion/${shell#*:}" || fail "tools/completion/${shell#*:} is behind: rbsim --print-tables ${shell%:*} makes it"
	command -v "${shell%:*}" >/dev/null && { "${shell%:*}" -n out || fail "${shell%:*} can't read its completion"; }
done
exits 0 --print-tables scene
says out 'table world'

# The completion completes.
command -v bash >/dev/null || exit 0
cat >complete.bash <<'END'
. "$1"
COMP_WORDS=(rbsim check a.lua --ti) COMP_CWORD=3
_rbsim 2>/dev/null
echo "${COMPREPLY[*]}"
COMP_WORDS=(rbsim a.lua --rollback se) COMP_CWORD=3
_rbsim 2>/dev/null
echo "${COMPREPLY[*]}"
COMP_WORDS=(rbsim me) COMP_CWORD=1
_rbsim 2>/dev/null
echo "${COMPREPLY[*]}"
END
cat >s.lua <<'END'
param("mu", 0.5)
param("mass", 1)
param("e", 0.5)
world { duration = 1 }
sphere { radius = 0.1 }
camera { name = "main", png = "%d.png" }
camera { name = "mouse", png = "%d.png" }
END
cat >>complete.bash <<'END'
COMP_WORDS=("$RBSIM" s.lua --param m) COMP_CWORD=3
_rbsim 2>/dev/null
echo "${COMPREPLY[*]}"
COMP_WORDS=("$RBSIM" s.lua --camera "") COMP_CWORD=3
_rbsim 2>/dev/null
echo "${COMPREPLY[*]}"
END
RBSIM=$RBSIM bash complete.bash "$TOP/tools/completion/rbsim.bash" >completed
printf '%s\n' --time-step selective methods 'mu= mass=' 'main mouse' | cmp -s - completed || fail "bash completes: $(cat completed)"
