"""On a terminal `twincell new` asks. A wrong answer is asked for again; an empty one stays open.

usage: new_on_terminal_test.py TWINCELL SOURCE_FOLDER SCRATCH_FOLDER
"""
import os
import pathlib
import pty
import subprocess
import sys
import tempfile
import threading

program, source, scratch = map(os.path.abspath, sys.argv[1:4])
stack = pathlib.Path(source, "data_samples/demo/gamma-0.9")

with tempfile.TemporaryDirectory(dir=scratch) as folder:
    home = pathlib.Path(folder)

    def asked(name, answers):
        master, slave = pty.openpty()
        heard = []

        def listen():
            try:
                while True:
                    heard.append(os.read(master, 1000))
            except OSError:  # the last writer has closed the terminal
                pass

        listener = threading.Thread(target=listen)
        process = subprocess.Popen([program, "new", stack, "-o", name], cwd=folder, stdin=slave,
                                   stderr=slave, stdout=subprocess.PIPE, text=True)
        os.close(slave)
        listener.start()
        os.write(master, answers)
        out = process.communicate(timeout=200)[0]
        listener.join()
        os.close(master)
        assert process.returncode == 0, out
        return b"".join(heard).decode(), out, (home / name).read_text()

    heard, out, text = asked("asked.toml", b"two\n2\n11,15\n")
    assert "Diameter of a bead in mm" in heard and "Frequency of the shaker in Hz" in heard, heard
    assert "A number above 0 is needed" in heard, heard
    assert "FILL IN" not in text and "sigma_mm = 2 " in text and "frequency_hz = 11.15" in text, text
    heard, out, text = asked("open.toml", b"\n\n")
    assert "Gamma" in heard and "2 values are still needed" in out, heard + out
    assert 'sigma_mm = "FILL IN: ' in text, text
