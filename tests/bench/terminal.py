# SPDX-License-Identifier: MIT
"""
A console in a terminal of 120 x 40 cells in true colour whose bytes go through a link of so many a second.

    terminal.py play LINK SECONDS CONSOLE...

types 1 (true time), watches for SECONDS and prints what `status` then says.

    terminal.py watch LINK SECONDS SOCKET CONSOLE... --run RUN...

starts a run that listens on SOCKET, and watches it; for SECONDS the console is stopped and continued each second. Prints a line for
each of these seconds: 0 or 1 (watched), and what a simulated second took of wall time, of the run's processor time and of that of the simulator's thread
alone; then the last line.

    terminal.py none 0 0 --run RUN...

prints wall and processor seconds of a run.

The last line: processor seconds of the console, bytes, seconds watched, pictures drawn, ms of the mean lateness of frames, of its 99th
percentile, and of drift in a second.
"""
import fcntl, os, pty, re, select, signal, socket, struct, subprocess, sys, termios, time

words = sys.argv[1:]
mode, link, seconds = words[0], float(words[1]), float(words[2])
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
            plain = re.sub(rb"\x1b\[[0-9;:?]*[A-Za-z]", b" ", self.tail)
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


    def report(self, began):
        watched, sent = time.monotonic() - began, self.size
        answer = self.ask(rb"(\d+) pictures\s+drawn.*?late ([0-9.]+) ms on average, 99 % within ([0-9.]+) ms, drift (-?[0-9.]+) ms/s")
        print("%.6f %d %.3f %d %g %g %g" % ((self.end(), sent, watched) + tuple(answer)))


# Processor seconds of a process, and of its first thread alone.
def used(pid):
    total = first = 0
    for task in os.listdir("/proc/%d/task" % pid):
        spent = 1e-9 * int(open("/proc/%d/task/%s/schedstat" % (pid, task)).read().split()[0])
        total += spent
        first += spent if int(task) == pid else 0
    return total, first


class Asker:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rw", newline="\n")
        self.lines.readline()

    # Simulated seconds so far.
    def time(self):
        self.lines.write("status\n")
        self.lines.flush()
        found = 0.0
        for line in self.lines:
            if not line.startswith(" "):
                return found
            if line.startswith(" time "):
                found = float(line.split()[1])


def play():
    terminal = Terminal(console)
    terminal.type("1")
    end = terminal.begin + seconds
    terminal.watch(lambda: time.monotonic() > end)
    terminal.report(terminal.begin)


def watch():
    path, command = console[0], console[1:]
    child = subprocess.Popen(run, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not os.path.exists(path):
        time.sleep(0.01)
    asker = Asker(path)
    terminal = Terminal(command)
    begin = time.monotonic()
    terminal.watch(lambda: time.monotonic() > begin + 2)  # it has opened its screen by then
    on, pictures = True, 0.0
    for _ in range(int(seconds)):
        on = not on
        os.kill(terminal.pid, signal.SIGCONT if on else signal.SIGSTOP)
        before = time.monotonic(), asker.time(), used(child.pid)
        terminal.watch(lambda: time.monotonic() > before[0] + 1)
        after = time.monotonic(), asker.time(), used(child.pid)
        pictures += after[0] - before[0] if on else 0
        made = after[1] - before[1]
        print("%d %.6f %.6f %.6f" % (on, (after[0] - before[0]) / made, (after[2][0] - before[2][0]) / made,
                                     (after[2][1] - before[2][1]) / made))
    os.kill(terminal.pid, signal.SIGCONT)
    child.terminate()
    child.wait()
    terminal.report(time.monotonic() - pictures - 2)


def none():
    began = time.monotonic()
    child = subprocess.Popen(run, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    _, status, u = os.wait4(child.pid, 0)
    if status:
        sys.exit("the run: status %d" % status)
    print("%.6f %.6f" % (time.monotonic() - began, u.ru_utime + u.ru_stime))


{"play": play, "watch": watch, "none": none}[mode]()
