#!/bin/sh
# SPDX-License-Identifier: MIT
# A system that takes only part of what it is given to write, again and again: recordings and checkpoints are whole all the same.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
asan | tsan) echo "what is put before the C library gets in a sanitizer's way"; exit 77 ;;
esac
command -v cc >/dev/null || { echo "no compiler for what writes little"; exit 77; }

cat >short.c <<'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <unistd.h>
#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
static size_t less(size_t n) { return n > 100 ? 100 : n; }
ssize_t write(int f, const void *b, size_t n) { return NEXT(write)(f, b, less(n)); }
ssize_t pwrite(int f, const void *b, size_t n, off_t o) { return NEXT(pwrite)(f, b, less(n), o); }
ssize_t pwrite64(int f, const void *b, size_t n, off64_t o) { return NEXT(pwrite64)(f, b, less(n), o); }
END
cc -shared -fPIC -o short.so short.c -ldl || { echo "the compiler makes no library"; exit 77; }

small_scene >s.lua
exits 0 s.lua -q -o whole.h5
LD_PRELOAD=$PWD/short.so "$RBSIM" s.lua -q -o short.h5 2>err || fail "a run that writes little fails"
exits 0 diff whole.h5 short.h5

# a run that is stopped in its middle and goes on from its checkpoint
printf 'at 0.2 checkpoint\nat 0.3 quit\n' >commands
LD_PRELOAD=$PWD/short.so "$RBSIM" s.lua -q -o parted.h5 --commands commands 2>err
[ -s parted.h5.checkpoint ] || fail "there is no checkpoint"
exits 0 s.lua -q -o parted.h5 --resume
exits 0 diff whole.h5 parted.h5
LD_PRELOAD=$PWD/short.so "$RBSIM" s.lua -q --duration 0.2 -o parted.h5 --force 2>err || fail "a recording is not replaced"
exits 1 diff whole.h5 parted.h5
says out 'the same as far as both go'
