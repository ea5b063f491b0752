#!/bin/sh
# SPDX-License-Identifier: MIT
# tools/mutate on a project of one file: what a test notices is killed, what none does survives, what does not compile, hangs or
# gives the same object is told as such; a judged survivor is no failure, and its entry is told once its line has gone.
. tests/cli/functions
for p in python3 make nm objcopy; do
	command -v $p >/dev/null || { echo "$p is not there"; exit 77; }
done

mkdir -p toy/src/math toy/tests toy/tools own
cat >toy/src/math/sum.c <<'END'
int sum(int a, int b);
int unseen(int a);
int count(int n);
int sum(int a, int b)
{
	const int all = a + b;
	return all * 1;
}
int unseen(int a)
{
	return a + 7;
}
int count(int n)
{
	while (n > 0)
		n -= 1;
	return n;
}
END
cat >toy/tests/test_sum.c <<'END'
int sum(int a, int b);
int count(int n);
int main(void)
{
	return sum(2, 3) != 5 || count(3) != 0;
}
END
cat >toy/Makefile <<'END'
b = build/release
CC = cc
all: $b/src/math/sum.o
$b/%.o: %.c
	@mkdir -p $(@D)
	$(CC) -O1 -c -o $@ $<
$b/tests/test_sum: $b/tests/test_sum.o $b/src/math/sum.o
	$(CC) -o $@ $^
END

# mutate STATUS ARGUMENT...
mutate()
{
	wanted=$1
	shift
	TMPDIR=$PWD/own python3 "$TOP/tools/mutate" --tree toy "$@" >out 2>err
	got=$?
	[ $got -eq "$wanted" ] || fail "tools/mutate $*: exit status $got, wanted $wanted"
	[ -z "$(ls own)" ] || fail "tools/mutate leaves something behind"
}

file=src/math/sum.c
mutate 0 --list
cp out first
for id in 6:sign 7:term 11:sign 15:turn 16:sign 16:statement; do
	grep -q "^$file:$id	" out || fail "$id is not listed"
done
mutate 1 --only $file:6:sign --only $file:7:term --only $file:11:sign --only $file:16:sign
says out "^killed +$file:6:sign \\(test_sum: exit 1"
says out "^killed +$file:16:sign \\(test_sum: "
says out "^not viable +$file:7:term \\(same object"
says out "^survived +$file:11:sign "
says out '^66.7 % of 3 killed$'
grep -q 'a + b' toy/$file || fail "the tree itself was changed"

# What the journal says was killed is not run again, also where its line has moved; a survivor is.
mutate 1 --only $file:6:sign --only $file:11:sign --journal journal
cp toy/tests/test_sum.c kept
echo 'int main(void) { return 0; }' >toy/tests/test_sum.c
cp toy/$file first.c
{ echo; cat first.c; } >toy/$file
mutate 1 --only $file:7:sign --only $file:12:sign --journal journal
says out "^killed +$file:7:sign \\(test_sum: exit 1"
says out "^survived +$file:12:sign "
[ "$(grep -c -v ^took journal)" -eq 3 ] || fail "the journal tells of $(grep -c -v ^took journal) changes, wanted 3"
says journal '^took	test_sum\*	[0-9.]+	$'
cp kept toy/tests/test_sum.c
cp first.c toy/$file

# A line more elsewhere does not change what a seed draws.
mutate 0 --list
sed -i 's/^int count(int n)$/int more(int a);\nint more(int a)\n{\n\treturn a - 9;\n}\nint count(int n)/' toy/$file
python3 - "$TOP/tools/mutate" toy >drawn <<'END'
import importlib.machinery, importlib.util, sys
loader = importlib.machinery.SourceFileLoader("mutate", sys.argv[1])
tool = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutate", loader))
sys.dont_write_bytecode = True
loader.exec_module(tool)
after = tool.mutants_of(sys.argv[2], "src/math/sum.c")
before = [m for m in after if "9" not in m.was]
drawn = [[m.key() for m in tool.chosen(some, len(some), 5)] for some in (before, after)]
kinds = [[k for k in drawn[1] if k in drawn[0] and kind in k[0]] == [k for k in drawn[0] if kind in k[0]]
         for kind in ("sign", "term", "statement")]
print(all(kinds))
END
says drawn '^True$'

printf '%s\n' "$file:sign" 'return a + 7;' 'nobody calls it' >toy/tools/mutate-equivalent
mutate 0 --only $file:11:sign
says out "^equivalent +$file:11:sign "
mutate 0 --check
sed -i 's/a + 7/a + 8/' toy/$file
mutate 1 --check
says err 'no such line any more: src/math/sum.c:sign: return a \+ 7;'
mutate 1 --only $file:99:sign
says err "no such change: $file:99:sign"
