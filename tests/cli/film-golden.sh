#!/bin/sh
# SPDX-License-Identifier: MIT
# Pictures are those in tests/scenes/film, as far as another renderer of the same kind may differ; a wrong texture,
# light, shadow or turn, or a flipped picture, is told apart. UPDATE_GOLDEN=1 writes them anew.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
golden=$TOP/tests/scenes/film

# picture VARIANT CAMERA NAME
picture()
{
	exits 0 "$golden/looks.lua" --param variant="$1" -o looks.h5 --force --quiet
	exits 0 render looks.h5 --camera "$2" --frame 2 -o "$3" --force --quiet
}

# decibels A B [FILTER]: how much of two pictures is the same, 100 where nothing differs
decibels()
{
	ffmpeg -v info -i "$1" -i "$2" -lavfi "[0]${3:-null}[a];[a][1]psnr" -f null - </dev/null 2>&1 |
		sed -n 's/.*PSNR.*average:\([0-9.inf]*\).*/\1/p' | sed 's/inf/100/' | tail -n 1
}

alike()
{
	awk -v found="$(decibels "$@")" 'BEGIN { print "found " found " dB" > "/dev/stderr"; exit !(found >= 33) }' 2>told
}

for camera in front lamps wire; do
	picture "" $camera $camera.png
	[ -z "${UPDATE_GOLDEN-}" ] || cp $camera.png "$golden/$camera.png"
	alike $camera.png "$golden/$camera.png" || fail "camera '$camera': $(cat told)"
	if alike $camera.png "$golden/$camera.png" hflip; then fail "a picture that is flipped passes"; fi
	if alike $camera.png "$golden/$camera.png" vflip; then fail "a picture upside down passes"; fi
done
for variant in texture light shadows turn; do
	picture $variant front wrong.png
	if alike wrong.png "$golden/front.png"; then fail "a picture with another $variant passes: $(cat told)"; fi
done
for variant in light shadows; do
	picture $variant lamps wrong.png
	if alike wrong.png "$golden/lamps.png"; then fail "lamps: a picture with another $variant passes: $(cat told)"; fi
done

# Every shape, alone and in unions, with patterns, shadows and as wires.
exits 0 "$TOP/scenes/shapes.lua" -o shapes.h5 --force --quiet --no-render --duration 4
for camera in main wires; do
	exits 0 render shapes.h5 --camera $camera --frame 40 --size 320x180 -o $camera.png --force --quiet
	[ -z "${UPDATE_GOLDEN-}" ] || cp $camera.png "$golden/shapes-$camera.png"
	alike $camera.png "$golden/shapes-$camera.png" || fail "shapes, camera '$camera': $(cat told)"
	exits 0 render shapes.h5 --camera $camera --frame 48 --size 320x180 -o later.png --force --quiet
	if alike later.png "$golden/shapes-$camera.png"; then fail "shapes that turned a little further pass: $(cat told)"; fi
done
