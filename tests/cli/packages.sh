#!/bin/sh
# SPDX-License-Identifier: MIT
# debian/ fits the tree: one version everywhere, each installed file in one package, the symbols of rbsim.h.
. tests/cli/functions

command -v make >/dev/null || { echo "no make here"; exit 77; }
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "sanitizers change nothing of what is installed"; exit 77 ;;
esac
build=${RBSIM%/*}
for file in "$build"/rbsim-film.so "$build"/rbsim-console.so "$build"/librbsim.a; do
	[ -f "$file" ] || { echo "a build that lacks ${file##*/}"; exit 77; }
done

version=$("$RBSIM" --version | sed -n 's/^rbsim //p')
for file in debian/changelog:'rbsim \(([0-9.]+)\)' tools/python/pyproject.toml:'version = "([0-9.]+)"' \
	CITATION.cff:'version: ([0-9.]+)' include/rbsim.h:'#define RBSIM_VERSION "([0-9.]+)"'; do
	there=$(sed -nE "s/^${file#*:}.*/\\1/p" "$TOP/${file%%:*}" | head -n 1)
	[ "$there" = "$version" ] || fail "${file%%:*} has version '$there', the program $version"
done

make -C "$TOP" --no-print-directory -o all BUILD="$build" MODE="${RBSIM_MODE:-release}" DESTDIR="$PWD/root" prefix=/usr \
	libdir=/usr/lib/triplet zshdir=/usr/share/zsh/vendor-completions install >out 2>err || fail "make install failed"
cat "$TOP"/debian/*.install | sort >patterns
(cd root && find . -type f -o -type l) | sed 's|^\./||' | sort >files
while read -r file; do
	count=0
	while read -r pattern; do
		# shellcheck disable=SC2254 # it is a pattern
		case $file in $pattern | $pattern/*) count=$((count + 1)) ;; esac
	done <patterns
	[ $count -eq 1 ] || fail "$file is in $count packages"
done <files
while read -r pattern; do
	case $pattern in usr/lib/python3*) continue ;; esac # setuptools installs it
	# shellcheck disable=SC2086
	(cd root && ls -d $pattern >/dev/null 2>&1) || fail "nothing is installed as $pattern"
done <patterns

sed -n 's/^.*[ *]\(rbsim_[a-z_]*\)(.*/\1/p' "$TOP/include/rbsim.h" | sort -u >declared
sed -n 's/^ \(rbsim_[a-z_]*\)@.*/\1/p' "$TOP/debian/librbsim0.symbols" | sort -u | diff declared - >err ||
	fail "debian/librbsim0.symbols has other names than rbsim.h"
