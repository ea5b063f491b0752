# SPDX-License-Identifier: MIT
"""
A console in a terminal of 120 x 40 cells in true colour whose bytes go through a link of so many a second:

    terminal.py LINK SECONDS KEY COMMAND... [--run COMMAND...]

Runs the command behind --run first, waits until its socket (the last word but for options) is there, and watches it until it has
ended; without --run, types KEY and watches for SECONDS. Then asks `status`, and types q. Prints one line of numbers: wall and processor
seconds of the run, processor seconds of its threads but the simulator's, processor seconds of the console, bytes, seconds watched, pictures drawn,
and ms of the mean lateness, of its 99th percentile, and of drift in a second. LINK 0: no console at all, and the first two numbers.
"""
import fcntl, os, pty, re, select, signal, struct, subprocess, sys, termios, time

words = sys.argv[1:]
link, seconds, key = float(words[0]), float(words[1]), words[2]
split = words.index("--run") if "--run" in words else len(words)
console, run = words[3:split], words[split + 1:]


class Terminal:
    def __init__(self, command):
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.environ.update(TERM="xterm-256color", COLORTERM="truecolor", LC_ALL="C.UTF-8")
            os.execv(command[0], command)
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
        self.size, self.begin, self.tail = 0, time.monotonic(), b""

    # What the link lets through by now; a tenth of a second's worth may wait in it.
    def take(self, wait):
        room = int(min(link * (time.monotonic() - self.begin) - self.size, 0.1 * link))
        if room <= 0 or not select.select([self.fd], [], [], wait)[0]:
            time.sleep(0.001)
            return b""
        try:
            data = os.read(self.fd, min(room, 65536))
        except OSError:
            data = b""
        self.size += len(data)
        self.tail = (self.tail + data)[-200000:]
        return data

    def watch(self, until):
        while not until():
            self.take(0.01)

    def type(self, text):
        os.write(self.fd, text.encode())

    # The screen anew, so that what is looked for stands there in one piece.
    def ask(self, pattern):
        self.type(":status\r")
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            self.tail = b""
            self.type("\f")
            end = time.monotonic() + 1
            while time.monotonic() < end:
                self.take(0.05)
            plain = re.sub(rb"\x1b\[[0-9;?]*[A-Za-z]", b" ", self.tail)
            found = re.search(pattern, plain, re.S)
            if found:
                return [float(text) for text in found.groups()]
        sys.exit("no answer to 'status': %r" % plain[-2000:])

    def end(self):
        self.type("q")
        while True:
            self.take(0.01)
            pid, _, used = os.wait4(self.pid, os.WNOHANG)
            if pid:
                return used.ru_utime + used.ru_stime


# Processor seconds of a process's threads but its first one.
def others(pid):
    total = 0
    try:
        for task in os.listdir("/proc/%d/task" % pid):
            if int(task) != pid:
                total += int(open("/proc/%d/task/%s/schedstat" % (pid, task)).read().split()[0])
    except OSError:
        return 0
    return 1e-9 * total


def main():
    wall = used = 0
    apart = [0, 0]
    ended = [time.monotonic() + seconds]
    if run:
        began = time.monotonic()
        child = subprocess.Popen(run, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        usage = []

        def over():
            pid, status, u = (0, 0, None) if usage else os.wait4(child.pid, os.WNOHANG)
            if not usage and time.monotonic() > apart[1]:
                apart[:] = max(apart[0], others(child.pid)), time.monotonic() + 0.1
            if pid:
                if status:
                    sys.exit("the run: status %d" % status)
                usage.append((time.monotonic() - began, u.ru_utime + u.ru_stime))
            return bool(usage)
        if not console or link == 0:
            while not over():
                time.sleep(0.001)
            print("%.6f %.6f" % usage[0])
            return
        while not os.path.exists(console[-1]):
            time.sleep(0.001)
    else:
        def over():
            return time.monotonic() > ended[0]
    terminal = Terminal(console)
    terminal.type(key)
    terminal.watch(over)
    watched, size = time.monotonic() - terminal.begin, terminal.size
    if run:
        wall, used = usage[0]
    answer = terminal.ask(rb"(\d+) pictures\s+drawn.*?late ([0-9.]+) ms on average, 99 % within ([0-9.]+) ms, drift (-?[0-9.]+) ms/s")
    own = terminal.end()
    print("%.6f %.6f %.6f %.6f %d %.3f %d %g %g %g" % ((wall, used, apart[0], own, size, watched) + tuple(answer)))


main()
