#!/bin/sh
# SPDX-License-Identifier: MIT
# kill -9 at any moment: all that was flushed is there and right, for rbsim itself and for h5py.
set -eu
python=
for p in ${RBSIM_PYTHON:-} /usr/bin/python3 python3; do
	"$p" -c 'import h5py' 2>/dev/null && { python=$p; break; }
done
cd "$TMPDIR"

# Free flight in closed form, so that every frame can be checked; far too long to end by itself.
cat >long.lua <<'END'
world { duration = 5e3, frame_rate = 1000, time_step = 1e-3, gravity = {0, 0, 0} }
for i = 0, 19 do
	sphere { radius = 0.1, position = {0, 0, i}, velocity = {0, i, 0} }
end
END

cat >check.py <<'END'
import h5py, numpy as np, sys
f = h5py.File("run.h5", "r", swmr=True)
b = f["particles/bodies"]
n = min(len(d) for d in (b["position/step"], b["position/time"], b["position/value"], b["velocity/value"]))
assert n >= int(sys.argv[1]), (n, sys.argv[1])
assert np.array_equal(b["position/step"][:n], np.arange(n))
t = b["position/time"][:n]
p = b["position/value"][:n]
i = np.arange(20.0)
assert np.array_equal(t, np.arange(n) / 1000)
assert np.array_equal(p[:, :, 2], np.broadcast_to(i, (n, 20)))
assert np.allclose(p[:, :, 1], t[:, None] * i[None, :], rtol=1e-9, atol=1e-9)
print(n, "frames for h5py")
END

# while it is made, and so long after it was there
for delay in 0.3 0.6 +0 +0.37 +1.1 +0.8; do
	rm -f run.h5*
	"$RBSIM" long.lua -o run.h5 --quiet &
	pid=$!
	[ "${delay#+}" = "$delay" ] || until [ -f run.h5 ]; do sleep 0.01; done
	sleep "${delay#+}"
	# a look at the recording while it grows: what is there now must be there afterwards, too
	before=0
	if [ -f run.h5 ]; then
		before=$("$RBSIM" info --json run.h5 | sed -n 's/.*"frames": *\([0-9]*\).*/\1/p' | head -n 1)
	fi
	kill -9 $pid
	wait $pid 2>/dev/null || true
	[ -f run.h5 ] || { echo "killed after $delay s: no recording yet"; continue; }
	"$RBSIM" info --json run.h5 >info.json
	after=$(sed -n 's/.*"frames": *\([0-9]*\).*/\1/p' info.json | head -n 1)
	echo "killed after $delay s: $before frames before, $after after"
	[ "${after:-0}" -ge "${before:-0}" ] && [ "${after:-0}" -ge 1 ]
	grep -q '"running"' info.json
	[ -z "$python" ] || "$python" check.py "$after"
done
