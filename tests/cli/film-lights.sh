#!/bin/sh
# SPDX-License-Identifier: MIT
# Kinds of lights: in the run's pictures and in those from the recording, and what is refused.
. tests/cli/functions

cat >s.lua <<'EOF'
world { duration = 0.1, frame_rate = 10 }
plane { }
sphere { radius = 0.3, position = {0, 0, 0.6} }
camera { name = "main", position = {3, -4, 3}, look_at = {0, 0, 0}, size = {96, 64}, png = "live/%d.png", lights = {
	{kind = "spot", position = {1, -1, 3}, look_at = {0, 0, 0}, angle = deg(20), softness = 0.5, intensity = 1.5},
	{kind = "ambient", color = {0.5, 0.6, 1}, intensity = 0.1},
	{kind = "sun", direction = {-1, 0, 1}, intensity = 0.1}, {kind = "lamp", position = {0, 3, 2}, intensity = 0.1} } }
EOF
exits 0 s.lua
mkdir alone
mv s.h5 alone
(
	cd alone || exit 1
	exits 0 render s.h5
) || exit 1
diff -r live alone/live >/dev/null || fail "the pictures from the recording differ from those of the run"

# refused LIGHT MESSAGE
refused()
{
	printf 'world { duration = 1 }\nsphere { radius = 1 }\ncamera { position = {0, 0, 5}, lights = {%s} }\n' "$1" >bad.lua
	exits 65 bad.lua
	grep -qF "bad.lua:3: camera: lights[1]: $2" err || fail "not told: $2: $(cat err)"
}
refused '{}' "needs a 'kind', or one of 'position' and 'direction'"
refused '{kind = "spot", position = {0, 0, 1}}' "a spot needs 'look_at'"
refused '{kind = "spot", position = {0, 0, 1}, look_at = {0, 0, 1}}' "'look_at' is where the spot is"
refused '{kind = "spot", look_at = {0, 0, 1}}' "a spot needs 'position'"
refused '{kind = "sun", position = {0, 0, 1}}' "a sun has no 'position'"
refused '{kind = "sun"}' "a sun needs 'direction'"
refused '{kind = "lamp", position = {0, 0, 1}, angle = 0.5}' "a lamp has no 'angle'"
refused '{kind = "ambient", direction = {0, 0, 1}}' "an ambient light has no 'direction'"
refused '{kind = "moon"}' "'kind' must be one of lamp, sun, spot, ambient (got 'moon')"
refused '{position = {0, 0, 1}, softness = 0.5}' "a lamp has no 'softness'"

# What stands still throws the same shadow wherever bodies move: a bar far from a small ball, which is near it only at the end.
command -v ffmpeg >/dev/null || exit 0
cat >bar.lua <<'END'
world { duration = 1, frame_rate = 2 }
plane { texture = "none" }
box { static = true, size = {6, 0.3, 0.5}, position = {0, 0.5, 0.25} }
box { static = true, size = {400, 400, 1}, position = {0, 0, -0.6} }
sphere { radius = 0.1, position = {3, -1, 0.1}, velocity = {-6, 0, 0}, material = material { friction = 0 } }
for _, light in ipairs {{"sun", {{direction = {0, 1, 1}}}}, {"lamp", {{position = {0, 20, 20}}}}} do
	camera { name = light[1], projection = "orthographic", position = {0, 0, 9}, up = {0, 1, 0}, look_at = {0, 0, 0}, height = 4.2,
		size = {640, 384}, lights = light[2], png = light[1] .. "/%d.png" }
end
END
exits 0 bar.lua -q --no-record
for light in sun lamp; do
	for k in 0 1 2; do
		# beside the bar, where its shadow is, but for its ends, away from the ball
		ffmpeg -v error -i "$light/$k.png" -vf crop=480:5:80:170 -f rawvideo -pix_fmt gray - </dev/null >"$light$k"
	done
	od -An -v -tu1 -w480 "$light"0 "$light"1 "$light"2 | awk -v light="$light" '
		{ for (i = 1; i <= NF; i++) if ($i > most) most = $i }
		END { if (NR != 15 || most > 90) { print light ": a pixel of " most " in the shadow"; exit 1 } }' >told ||
		fail "a shadow is cut: $(cat told)"
done
