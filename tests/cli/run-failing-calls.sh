#!/bin/sh
# SPDX-License-Identifier: MIT
# A write, sync, truncation or renaming that fails at its k-th call, once or from then on, for recording and checkpoint: the run
# ends well with the right bits, or says why not and can be gone on with to these bits. So it is on a file system that fills.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
asan | tsan) echo "what is put before the C library gets in a sanitizer's way"; exit 77 ;;
esac
command -v cc >/dev/null || { echo "no compiler for what fails"; exit 77; }

cat >failing.c <<'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static atomic_int calls;

/* Whether this call, by its number among those of its kind on a file of this name, is to fail. */
static int fails(const char *call, const char *path)
{
	const char *const wanted = getenv("FAIL_CALL"), *const at = getenv("FAIL_AT"), *const most = getenv("FAIL_FOR");
	const char *const name = getenv("FAIL_NAME");
	const char *const slash = strrchr(path, '/');

	if (!wanted || !name || strcmp(wanted, call) != 0 || fnmatch(name, slash ? slash + 1 : path, 0) != 0)
		return 0;
	const int number = atomic_fetch_add(&calls, 1) + 1;
	if (number < atoi(at) || number >= atoi(at) + atoi(most))
		return 0;
	close(open("failed", O_CREAT | O_WRONLY, 0666));
	errno = ENOSPC;
	return 1;
}

static int fails_file(const char *call, int file)
{
	char link[64], path[4096];
	snprintf(link, sizeof link, "/proc/self/fd/%d", file);
	const ssize_t size = readlink(link, path, sizeof path - 1);
	if (size <= 0)
		return 0;
	path[size] = '\0';
	return fails(call, path);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
ssize_t write(int f, const void *b, size_t n) { return fails_file("write", f) ? -1 : NEXT(write)(f, b, n); }
ssize_t pwrite(int f, const void *b, size_t n, off_t o) { return fails_file("write", f) ? -1 : NEXT(pwrite)(f, b, n, o); }
ssize_t pwrite64(int f, const void *b, size_t n, off64_t o) { return fails_file("write", f) ? -1 : NEXT(pwrite64)(f, b, n, o); }
int fsync(int f) { return fails_file("sync", f) ? -1 : NEXT(fsync)(f); }
int fdatasync(int f) { return fails_file("sync", f) ? -1 : NEXT(fdatasync)(f); }
int ftruncate(int f, off_t n) { return fails_file("truncate", f) ? -1 : NEXT(ftruncate)(f, n); }
int ftruncate64(int f, off64_t n) { return fails_file("truncate", f) ? -1 : NEXT(ftruncate64)(f, n); }
int renameat(int d, const char *a, int e, const char *b) { return fails("rename", b) ? -1 : NEXT(renameat)(d, a, e, b); }
int renameat2(int d, const char *a, int e, const char *b, unsigned f) { return fails("rename", b) ? -1 : NEXT(renameat2)(d, a, e, b, f); }
int open64(const char *p, int flags, ...)
{
	__builtin_va_list more;
	__builtin_va_start(more, flags);
	const int mode = __builtin_va_arg(more, int);
	__builtin_va_end(more);
	return flags & O_CREAT && fails("create", p) ? -1 : NEXT(open64)(p, flags, mode);
}
int openat(int d, const char *p, int flags, ...)
{
	__builtin_va_list more;
	__builtin_va_start(more, flags);
	const int mode = __builtin_va_arg(more, int);
	__builtin_va_end(more);
	return flags & O_CREAT && fails("create", p) ? -1 : NEXT(openat)(d, p, flags, mode);
}
int open(const char *p, int flags, ...)
{
	__builtin_va_list more;
	__builtin_va_start(more, flags);
	const int mode = __builtin_va_arg(more, int);
	__builtin_va_end(more);
	return flags & O_CREAT && fails("create", p) ? -1 : NEXT(open)(p, flags, mode);
}
END
cc -shared -fPIC -O1 -o failing.so failing.c -ldl 2>cc.err || { echo "what fails can't be compiled: $(tail -n 1 cc.err)"; exit 77; }

cat >s.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81}, frame_rate = 100 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 19 do sphere { radius = 0.1, position = {0.3 * i, 0, 0.5 + 0.1 * i}, velocity = {0, i, i}, material = m } end
state.frames = 0
on_frame(function()
	state.frames = state.frames + 1
	local x = 0
	for i = 1, 6e4 do x = x + i end
end)
expect("every frame was seen once", function() return state.frames == 101 end)
END
exits 0 s.lua -q -o whole.h5

# judge WHAT: what has become of r.h5, whose run ended with $got
judge()
{
	case $got in
	0) ;;
	73 | 74)
		[ -s err ] || fail "$1: exit status $got without a word"
		rm -f kept
		for file in r.h5.checkpoint r.h5.checkpoint~; do if [ -f $file ]; then : >kept; fi; done
		if [ -f r.h5 ]; then
			exits 0 info r.h5
			# what is there is right
			"$RBSIM" diff whole.h5 r.h5 >out 2>&1
			grep -Eq '^the same (to the bit|as far as both go)|no frames|has 0 frames' out || fail "$1: frames differ"
		fi
		# from the checkpoint before, not from the beginning
		exits 0 s.lua -o r.h5 --resume
		[ ! -f kept ] || ! grep -q 'from the beginning' err || fail "$1: the checkpoint before is lost"
		;;
	*) fail "$1: exit status $got" ;;
	esac
	exits 0 diff whole.h5 r.h5
	exits 0 info r.h5
	says out 'status *complete'
	[ -z "$(find . -name 'r.h5?*')" ] || fail "$1: left behind: $(ls r.h5?*)"
	rm -f r.h5
}

tries=0 lost=0 told=0
for call in write sync truncate rename create; do
	for name in r.h5 r.h5.checkpoint r.h5.checkpoint~ 'r.h5.partial-*' 'r.h5.checkpoint.partial-*'; do
		for most in 1 1000000; do
			for at in 1 2 4 8 16 32 64; do
				rm -f failed r.h5*
				FAIL_CALL=$call FAIL_NAME="$name" FAIL_AT=$at FAIL_FOR=$most LD_PRELOAD=$PWD/failing.so \
					"$RBSIM" s.lua -o r.h5 --checkpoint-every 0.01 >out 2>err
				got=$?
				[ -f failed ] || break # there are not so many calls
				tries=$((tries + 1))
				[ $got -eq 0 ] || lost=$((lost + 1))
				# a checkpoint that can't be written is told, and costs nothing else
				case $name in *checkpoint*)
					[ $got -eq 0 ] || fail "$call of $name, call $at: exit status $got"
					warnings=$(grep -c 'warning: cannot .*checkpoint' err)
					# the last one may fail without anybody left to ask
					[ $most -eq 1 ] || [ "$warnings" -le 1 ] || fail "$call of $name, call $at: $warnings warnings"
					[ $most$at = 10000001 ] && told=$((told + warnings))
					;;
				esac
				judge "$call of $name, call $at, $most times"
			done
			rm -f r.h5*
		done
	done
done
[ $tries -ge 20 ] || fail "only $tries calls have failed"
[ $lost -ge 3 ] || fail "only $lost recordings could not be written"
[ $told -ge 2 ] || fail "only $told checkpoints that could not be written were told"
echo "$tries failing calls, $lost of which ended the run"

# A signal while no checkpoint can be written: 143, and why; where there is an earlier one, 75, and it is what is gone on from.
sed 's/duration = 1/duration = 50/; s/== 101/== 5001/' s.lua >long.lua
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
for at in 1 3; do
	rm -f failed r.h5*
	FAIL_CALL=create FAIL_NAME='r.h5.checkpoint.partial-*' FAIL_AT=$at FAIL_FOR=1000000 LD_PRELOAD=$PWD/failing.so \
		"$RBSIM" long.lua -o r.h5 --checkpoint-every 0.05 >out 2>err &
	pid=$!
	until_true [ -f failed ]
	kill -TERM $pid
	wait $pid
	got=$?
	pid=
	if [ $at -eq 1 ]; then
		[ $got -eq 143 ] || fail "no checkpoint: exit status $got"
		says err "without a checkpoint: cannot create 'r.h5.checkpoint': No space left"
	else
		[ $got -eq 75 ] || fail "an earlier checkpoint: exit status $got"
		kept=$(sed -n 's/.*goes on from frame \([0-9]*\)$/\1/p' err)
		made=$(sed -n 's/.*frames *\([0-9]*\) of.*/\1/p' err)
		[ "$kept" -gt 0 ] && [ "$kept" -lt $((made - 1)) ] || fail "it goes on from frame $kept of $made"
		exits 0 long.lua -o r.h5 --resume
		! grep -q 'from the beginning' err || fail "the earlier checkpoint is lost"
	fi
done
rm -f r.h5*

# a file system of its own that is full before the end: what was kept until then is gone on from when there is room again
sed 's/duration = 1/duration = 14/; s/6e4/1e4/; s/== 101/== 1401/' s.lua >large.lua
echo 'record { ledger = false }' >>large.lua
exits 0 large.lua -q -o large.h5
cat >full.sh <<'END'
mount -t tmpfs -o size=3m none disk || exit 77
head -c 1000000 /dev/zero >disk/filler
"$RBSIM" large.lua -o disk/r.h5 --checkpoint-every 0.005 >out 2>err
[ $? -eq 74 ] || { echo "the disk was not full: $(cat err)"; exit 1; }
grep -q "cannot .*'disk/r.h5.*No space left on device" err || { cat err; exit 1; }
[ -s disk/r.h5.checkpoint ] || { echo "no checkpoint"; exit 1; }
"$RBSIM" large.lua -o disk/r.h5 --resume >out 2>err
[ $? -eq 74 ] || { echo "it is still full: $(cat err)"; exit 1; }
rm disk/filler
mount -o remount,size=16m disk
"$RBSIM" large.lua -o disk/r.h5 --resume >out 2>err || { echo "with room again: $(cat err)"; exit 1; }
! grep -q 'from the beginning' err || { cat err; exit 1; }
"$RBSIM" diff large.h5 disk/r.h5
END
mkdir disk
unshare -rm true 2>/dev/null || { echo "no file system of its own for a test that fills it"; exit 0; }
unshare -rm sh full.sh >full.out 2>&1
got=$?
[ $got -eq 77 ] || [ $got -eq 0 ] || fail "a disk that fills: $(cat full.out)"
