#!/bin/sh
# SPDX-License-Identifier: MIT
# What a release is built with against mistakes of ours is in the program and its modules.
. tests/cli/functions

case ${RBSIM_MODE:-release} in
release) ;;
*) echo "only releases are hardened"; exit 77 ;;
esac
for tool in readelf objdump; do
	command -v $tool >/dev/null || { echo "no $tool here"; exit 77; }
done
echo 'int main(void){return 0;}' | cc -Werror -fstack-protector-strong -fstack-clash-protection -x c - -o probe 2>/dev/null ||
	{ echo "this compiler does not take the flags"; exit 77; }

# has WHAT PATTERN: a line of what was seen matches
has()
{
	grep -Eq -- "$2" seen || fail "$file: no $1"
}

for file in "$RBSIM" "${RBSIM%/*}"/rbsim-*.so; do
	readelf -W --file-header --program-headers --dynamic --dyn-syms "$file" >seen 2>err || fail "readelf cannot read $file"
	has "position independent code" '^ *Type: +DYN'
	has "table of addresses that becomes read-only" 'GNU_RELRO'
	has "binding of all names at the start" 'BIND_NOW'
	has "guard on the stack" ' __stack_chk_fail'
	has "calls that check sizes" ' __[a-z]+_chk'
	has "stack that holds no code" 'GNU_STACK .* RW +0x'
	! grep -Eq 'TEXTREL|RPATH|RUNPATH' seen || fail "$file: its code is written to at the start, or it has a path of its own"
	case $(uname -m) in
	x86_64) objdump -d --no-show-raw-insn -j .text "$file" | grep -q endbr64 || fail "$file: no marks of where jumps may lead" ;;
	esac
done
readelf -W --dynamic "$RBSIM" | grep -q 'FLAGS_1.* PIE' || fail "the program is at the same place in each run"
exit 0
