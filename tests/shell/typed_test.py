"""Types command lines with Tab into the shells themselves, on a terminal: typed_test.py MOMA SHELL.

Ends with 77 (skipped) where the shell is not installed.
"""

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time

STARTS = {
    "bash": ["bash", "--norc", "--noprofile", "-i"],
    "zsh": ["zsh", "-f", "-i"],
    "fish": ["fish", "--no-config", "-i"],
}
LOADS = {
    "bash": "source <(moma completion bash)",
    "zsh": "autoload -Uz compinit; compinit -u -d ./zcompdump; source <(moma completion bash)",
    "fish": "moma completion fish | source",
}
# What is typed, and how the line then goes on.
CASES = [
    ("moma repla", "y"),
    ("moma run --thre", "ads"),
    ("moma help repla", "y"),
    ("moma --vers", "ion"),
    ("moma query store.d", "b"),
]


class Terminal:
    """A shell on a pseudo-terminal; what it shows, without what only moves the cursor or sets colours."""

    def __init__(self, shell, folder, path):
        self.shown = ""
        pid, self.fd = pty.fork()
        if pid == 0:
            os.chdir(folder)
            environment = {"PATH": path, "TERM": "dumb" if shell == "bash" else "xterm", "HOME": folder, "LC_ALL": "C.UTF-8"}
            os.execvpe(STARTS[shell][0], STARTS[shell], environment)
        self.pid = pid

    def type(self, text):
        os.write(self.fd, text.encode())

    def wait_for(self, text, seconds=30):
        end = time.monotonic() + seconds
        while text not in self.plain():
            ready, _, _ = select.select([self.fd], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                return False
            try:
                self.shown += os.read(self.fd, 65536).decode(errors="replace")
            except OSError:
                return text in self.plain()
        return True

    def plain(self):
        text = re.sub(r"\x1b\][^\x07\x1b]*(\x07|\x1b\\)|\x1b[\[(][0-9;?]*[A-Za-z]|\x1b[=>]|[\r\x08\x0f]", "", self.shown)
        return text

    def close(self):
        os.kill(self.pid, 9)
        os.waitpid(self.pid, 0)
        os.close(self.fd)


def main():
    moma, shell = os.path.realpath(sys.argv[1]), sys.argv[2]
    if shutil.which(shell) is None:
        print(f"{shell} is not installed")
        return 77
    script = subprocess.run([moma, "completion", "fish" if shell == "fish" else "bash"],
                            capture_output=True, text=True, check=True).stdout
    checked = subprocess.run([shell, "-n"] if shell != "fish" else [shell, "--no-execute", "/dev/stdin"],
                             input=script, capture_output=True, text=True)
    if checked.returncode != 0:
        print(f"{shell} does not read its completion:\n{checked.stderr}")
        return 1
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        os.mkdir(os.path.join(folder, "bin"))
        os.symlink(moma, os.path.join(folder, "bin", "moma"))
        open(os.path.join(folder, "store.db"), "w").close()
        open(os.path.join(folder, "store.txt"), "w").close()
        path = os.path.join(folder, "bin") + ":" + os.environ["PATH"]
        for typed, rest in CASES:
            terminal = Terminal(shell, folder, path)
            terminal.type(LOADS[shell] + "; echo rea''dy\n")
            if not terminal.wait_for("\nready"):
                print(f"{shell} does not come up:\n{terminal.plain()!r}")
                failed = 1
            else:
                terminal.type(typed + "\t")
                if not terminal.wait_for(typed + rest):
                    print(f"{shell}: '{typed}' and Tab do not give '{typed + rest}', but:\n{terminal.plain()!r}")
                    failed = 1
            terminal.close()
    return failed


if __name__ == "__main__":
    sys.exit(main())
