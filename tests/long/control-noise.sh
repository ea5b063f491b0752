#!/bin/sh
# SPDX-License-Identifier: MIT
# A thousand connects and disconnects, then ten minutes of random bytes (or NOISE_SECONDS) on the socket of a run that is
# stepped all the while: no leak, no lost frame, the bits of a run without.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to speak to a socket with"; exit 77; }

cat >s.lua <<'END'
world { duration = 2000, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 0.99, density = 1000, friction = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 10 do
	sphere { radius = 0.1, position = {0.25 * i, 0, 0.5 + 0.05 * i}, velocity = {math.sin(i), 0, 0}, material = m }
end
END
cat >noise.py <<'END'
import random, socket, sys, time
path, seconds = sys.argv[1], float(sys.argv[2])
def connect():
    s = socket.socket(socket.AF_UNIX)
    s.connect(path)  # with a time-out it would not wait for a place in the queue
    s.settimeout(20)
    return s
def ask(line):
    s = connect()
    f = s.makefile("rw", newline="\n")
    f.readline()
    f.write(line + "\n")
    f.flush()
    lines = []
    while not lines or lines[-1].startswith(" "):
        lines.append(f.readline())
    s.close()
    return lines
random.seed(2)
for k in range(1000):
    s = connect()
    if k % 2:
        s.recv(100)
    s.close()
words = [b"step", b"seek", b"frame", b"newer", b"scene", b"status", b"help", b"body", b"set", b"\n", b"\n", b" ", b'"', b"#1", b"all",
         b"\xc3\xa9", b"\x1b", b"\0", b"events", b"hello", b"stop at collision off", b"18446744073709551616"]
words.remove(b"step")  # the only one of these that would move a run that stands
end, steps, sent = time.time() + seconds, 0, 0
while time.time() < end:
    s = connect()
    s.setblocking(False)
    for _ in range(random.randrange(1, 20)):
        data = random.randbytes(random.randrange(4000)) if random.random() < 0.5 else \
            b"".join(random.choice(words) + random.choice([b" ", b"\n", b""]) for _ in range(200))
        try:
            sent += s.send(data)
            s.recv(65536)
        except (BlockingIOError, ConnectionError):
            pass
    s.close()
    if random.random() < 0.1 and steps < 100000:
        assert ask("step 7")[-1] == "ok\n"
        steps += 7
deadline = time.time() + 60
while True:
    lines = ask("status")
    if " state paused\n" in lines or time.time() > deadline:
        break
assert " frame %d\n" % steps in lines, (steps, lines)
print("%d bytes, %d steps" % (sent, steps))
END
exits 0 s.lua -o plain.h5 --json
hash=$(value state_hash)
echo pause >commands
"$RBSIM" s.lua -o noisy.h5 --listen s --commands commands --json >out 2>err &
pid=$!
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
until_true [ -S s ]
memory()
{
	sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' /proc/$pid/status
}
python3 noise.py s 5 || fail "the noise was too much"
before=$(memory) files=$(ls /proc/$pid/fd | wc -l)
[ -n "$before" ] || fail "the run has ended"
"$RBSIM" ctl s restart >/dev/null || fail "restart was refused"
python3 noise.py s "${NOISE_SECONDS:-600}" || fail "the noise was too much"
after=$(memory)
[ "$(ls /proc/$pid/fd | wc -l)" -le $((files + 2)) ] || fail "open files: $files, then $(ls /proc/$pid/fd | wc -l)"
[ $((after - before)) -lt 30000 ] || fail "memory grew from $before to $after kB"
"$RBSIM" ctl s play >/dev/null || fail "play was refused"
ended 0 "the run"
[ "$(value state_hash)" = "$hash" ] || fail "another state hash"
exits 0 diff plain.h5 noisy.h5
echo "memory $before kB, then $after kB"
