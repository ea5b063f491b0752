#!/bin/sh
# SPDX-License-Identifier: MIT
# The recorder's speed into the page cache, against a plain H5Dwrite of the same bytes (bench_recorder.c).
. "$(dirname "$0")/functions"

build=$(dirname "$RBSIM")
hdf5=$(pkg-config --exists hdf5-serial && echo hdf5-serial || echo hdf5)
# shellcheck disable=SC2046 # flags are several words
${CC:-cc} -std=c17 -O2 -D_GNU_SOURCE -I"$TOP/include" -I"$TOP/src" -I"$TOP/tests" $(pkg-config --cflags "$hdf5") \
	-o bench "$TOP/tests/bench/bench_recorder.c" "$build"/src/sink/h5*.o "$build"/src/sink/recorder.o \
	"$build"/src/sink/reader.o "$build/librbsim-internal.a" $(pkg-config --libs "$hdf5") -lm -pthread
./bench "$WORK" >lines

# field NAME: of the object in $line
field()
{
	printf '%s\n' "$line" | sed -n 's/.*"'"$1"'": \([^,}]*\).*/\1/p'
}
while read -r line; do
	case="$(field bodies) bodies, $(field frames) frames, compression $(field compression)"
	result "$case" "speed" "$(field MB_s)" MB/s "" more
	result "$case" "per frame" "$(field us_frame)" us
	result "$case" "bytes of the file over bytes of data" "$(field file_of_data)" ""
	[ -z "$(field against_plain)" ] || result "$case" "speed over plain H5Dwrite" "$(field against_plain)" "" "" more
done <lines
