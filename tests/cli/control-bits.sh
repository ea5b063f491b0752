#!/bin/sh
# SPDX-License-Identifier: MIT
# Whoever watches, and however badly, the recording has the same bits as without: many clients, one that never reads, some
# that are killed, random bytes; pauses and steps in between.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to speak to a socket with"; exit 77; }

cat >s.lua <<'END'
world { duration = 20, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 0.9, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 40 do
	sphere { radius = 0.1, position = {0.21 * (i % 7), 0.22 * (i // 7), 0.5 + 0.03 * i},
		velocity = {math.sin(i), math.cos(i), 0}, material = m }
end
END
exits 0 s.lua -o plain.h5 --json
hash=$(value state_hash)
[ -n "$hash" ] || fail "a run without a state hash"

cat >crowd.py <<'END'
import os, random, select, signal, socket, sys, time
path, seconds = sys.argv[1], float(sys.argv[2])
def connect():
    s = socket.socket(socket.AF_UNIX)
    s.connect(path)
    return s
random.seed(1)
end = time.time() + seconds
hung = connect()
hung.setblocking(False)
watching = [connect() for _ in range(64)]
files = [s.makefile("rw", newline="\n") for s in watching]
for f in files:
    assert f.readline().startswith("rbsim 1"), "no greeting"
frames = 0
try:
    while time.time() < end:
        try:
            while True:
                hung.send(b"frame all\nscene\n" * 100)
        except BlockingIOError:
            pass
        for k, f in enumerate(files):
            f.write(("status\n", "frame\n", "body #3\n", "timeline\n", "events\n")[k % 5])
            f.flush()
        for f in files:
            line = " "
            while line.startswith(" "):
                line = f.readline()
                frames += line.startswith(" frame ") and len(line) > 200
            if line in ("", "bye\n"):  # the run has ended
                raise BrokenPipeError
            assert line.startswith("ok") or "no frame yet" in line, line
        noisy = connect()
        noisy.send(random.randbytes(3000))
        noisy.close()
        child = os.fork()
        if child == 0:
            try:
                s = connect()
                while True:
                    s.send(b"frame\n")
            finally:
                os._exit(0)  # the rest is the parent's
        time.sleep(0.01)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
except (BrokenPipeError, ConnectionResetError):
    pass  # the run has ended
print(frames)
END
echo pause >commands
"$RBSIM" s.lua -o watched.h5 --listen s --commands commands --json >out 2>err &
pid=$!
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
until_true [ -S s ]
stands()
{
	"$RBSIM" ctl s status | grep -q '^state paused'
}
until_true stands
python3 crowd.py s 4 >crowd.out 2>crowd.err &
crowd=$!
for n in 1 7 100 3; do
	"$RBSIM" ctl s step $n >/dev/null || fail "the run does not take a step among the crowd"
	sleep 0.5
done
[ "$("$RBSIM" ctl s status | sed -n 's/^frame //p')" = 111 ] || fail "the steps do not add up to frame 111"
"$RBSIM" ctl s play >/dev/null || fail "the run does not play among the crowd"
ended 0 "the run"
wait $crowd || { cat crowd.err >&2; fail "the crowd has seen something wrong"; }
[ "$(cat crowd.out)" -gt 10 ] || fail "the crowd has seen $(cat crowd.out) frames"
[ "$(value state_hash)" = "$hash" ] || fail "the state hash is $(value state_hash), without a crowd $hash"
exits 0 diff plain.h5 watched.h5
[ ! -e s ] || fail "the socket is still there"
