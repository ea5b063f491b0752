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

printf '%s\n' "$file:sign" 'return a + 7;' 'nobody calls it' >toy/tools/mutate-equivalent
mutate 0 --only $file:11:sign
says out "^equivalent +$file:11:sign "
mutate 0 --check
sed -i 's/a + 7/a + 8/' toy/$file
mutate 1 --check
says err 'no such line any more: src/math/sum.c:sign: return a \+ 7;'
mutate 1 --only $file:99:sign
says err "no such change: $file:99:sign"
