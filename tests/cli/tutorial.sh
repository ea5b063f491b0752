#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands, scenes and scripts of the guide are run as they stand: blocks of docs/tutorial.md and docs/analysis.md.
# A block of Lua or Python is saved under the name in its first line; a block of the shell is run line by line; recipes in Python too.
. tests/cli/functions
python=
find_python
case $RBSIM in /*) ;; *) RBSIM=$TOP/$RBSIM ;; esac
export RBSIM PYTHONDONTWRITEBYTECODE=1
PYTHONPATH=$TOP/tools/python
export PYTHONPATH

mkdir bin
cat >bin/rbsim <<'END'
#!/bin/sh
# a program that this machine lacks is no fault of the guide
"$RBSIM" "$@"
status=$?
[ $status = 69 ] && exit 0
exit $status
END
if [ -n "$python" ]; then
	printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >bin/python3
else
	printf '#!/bin/sh\nexit 0\n' >bin/python3
fi
chmod +x bin/rbsim bin/python3
PATH=$PWD/bin:$PATH

# blocks DOCUMENT: numbered files block-NN.KIND in the order of the document
blocks()
{
	rm -f block-*
	awk '/^```[a-z]+$/ { kind = substr($0, 4); file = sprintf("block-%02d.%s", ++n, kind); next }
		/^```$/ { kind = ""; next }
		kind != "" { print >file }' "$1"
}

# named FILE: the name in the first line of a block
named()
{
	sed -n '1s/^\(--\|#\) \([a-z_]*\.[a-z]*\)$/\2/p' "$1"
}

count=0
for document in tutorial analysis; do
	blocks "$TOP/docs/$document.md"
	for block in block-*; do
		case $block in
		*.sh)
			while read -r line; do
				count=$((count + 1))
				sh -c "$line" >out 2>err </dev/null || fail "docs/$document.md: $line"
			done <"$block"
			;;
		*)
			name=$(named "$block")
			[ -n "$name" ] || fail "docs/$document.md: a block without a name: $(head -n 1 "$block")"
			cp "$block" "$name"
			[ $document = analysis ] || continue
			case $name in
			*.py)
				count=$((count + 1))
				python3 "$name" >out 2>err </dev/null || fail "docs/$document.md: $name"
				;;
			esac
			;;
		esac
	done
done
[ $count -ge 25 ] || fail "only $count commands"

# the first steps of rbsim(1), one after the other, but for what is no scene's; two methods do differ
mkdir steps && cd steps || exit 1
cp "$TOP/scenes/bounce.lua" .
sed -n '/^\.Sh FIRST STEPS/,/^\.Sh DESCRIPTION/s/^\.Dl //p' "$TOP/man/rbsim.1" >lines
while read -r line; do
	case $line in 'rbsim verify '* | 'rbsim converge '*) continue ;; esac
	sh -c "$line" >out 2>err </dev/null
	status=$?
	[ $status = 0 ] || case "$status $line" in '1 rbsim diff '* | '1 '*'--method classic'*) ;; *) fail "rbsim(1): $line" ;; esac
done <lines
cd .. || exit 1

# the ball of docs/README.md is as exact as it says
blocks "$TOP/docs/README.md"
cat block-*.lua >ball.lua
exits 0 ball.lua --no-record
awk '/largest relative error: / { found = 1; if ($NF > 4e-15) exit 1 } END { exit !found }' err || fail "docs/README.md: another error"

# what documents link to is there
cd "$TOP" || exit 1
for document in docs/*.md README.md tools/python/README.md; do
	grep -o '](\([^):#]*\))' "$document" | sed 's/](\(.*\))/\1/' | while read -r target; do
		[ -e "$(dirname "$document")/$target" ] || fail "$document links to '$target', which is not there"
	done || exit 1
done
grep -o '`src/[a-z_/]*\.h`' docs/physics.md | tr -d '`' | while read -r file; do
	[ -e "$file" ] || fail "docs/physics.md names '$file', which is not there"
done || exit 1
[ "$(sed -n 's/^version: //p' CITATION.cff)" = "$(sed -n 's/^version = "\(.*\)"/\1/p' tools/python/pyproject.toml)" ] ||
	fail "CITATION.cff and tools/python are of different versions"
[ -n "$python" ] || { echo "no Python with numpy and h5py: its recipes were not run"; exit 77; }
