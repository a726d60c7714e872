"""A stand-in for an IRC5 controller: Robot Web Services over HTTP, and programs that are read and run in step."""

from __future__ import annotations

import json
import struct
import threading
import time
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np

ABSENT = 9e9
PARAMETERS = {1: 12 + 4 + 7, 7: 0, 8: 0}
"""Numbers after the operation code: MoveAbsJ (target, speed, zone), SyncMoveOn, SyncMoveOff."""


class Reader:
    """Numbers of a binary program, one after the other."""

    def __init__(self, content):
        self.content, self.at = content, 0

    def number(self):
        (value,) = struct.unpack_from("<f", self.content, self.at)
        self.at += 4
        return value

    def numbers(self, count):
        return [self.number() for _ in range(count)]


class Irc5:
    """The controller.

    Attributes:
        joints: of each unit, in degrees as ABB orders them: six axes and the first external one.
        ran: programs that were run: for each task, rows of (target, speed, zone).
    """

    def __init__(self, joints):
        self.joints = {f"ROB_{arm + 1}": list(row) for arm, row in enumerate(joints)}
        self.files, self.signals, self.ran, self.log = {}, {}, [], []
        self.motors, self.running, self.seconds, self.fails, self.stopped = "motoron", False, 0.0, "", 0
        self.blocked, self.silent, self.started = {}, set(), 0
        self.on_upload = self.on_start = None
        self.entry(1, 0, "start")
        self._lock = threading.Lock()

    def entry(self, kind, code, *words):
        number = len(self.log) + 1
        self.log.insert(0, {
            "_title": f"/rw/elog/0/{number}", "msgtype": str(kind), "code": str(code),
            "tstamp": "2026-01-01 T  00:00:00", "title": "", "desc": "", "conseqs": "", "causes": "", "actions": "",
            "argc": str(len(words)), "argv": [{"value": word} for word in words],
        })  # fmt: skip

    def start(self):
        self.running, self.started = True, self.started + 1
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        programs = [commands(self.files[f"ramdisk/motion_program{arm}.bin"]) for arm in ("", 2)]
        until = time.monotonic() + self.seconds
        while self.running and time.monotonic() < until:
            time.sleep(0.005)
        if self.fails:
            self.entry(3, 80001, "motion program failed", self.fails, "", "", "")
        elif self.running:
            self.ran.append(programs)
            for arm, rows in enumerate(programs):
                if arm not in self.blocked:
                    self.joints[f"ROB_{arm + 1}"] = rows[-1][0][:7]
        texts = (struct.pack("<f", len(text)) + text for text in (b"2026-01-01", b"time"))
        self.files["ramdisk/log-1-1.bin"] = struct.pack("<f", 10011) + b"".join(texts) + struct.pack("<f", 0.0)
        self.entry(1, 80003, "motion program log file opened", "log-1-1.bin")
        self.entry(1, 80003, "motion program log file closed", "")
        self.running = False

    def answer(self, method, path, body):
        """What comes back for a request: an object, bytes or None."""
        path, _, query = path.partition("?")
        path = path.strip("/")
        if path.startswith("fileservice/"):
            name = path.removeprefix("fileservice/")
            if method == "PUT":
                self.files[name] = body
                if self.on_upload is not None:
                    self.on_upload()
                return {}
            return self.files.pop(name, b"") if method == "DELETE" else self.files[name]
        if path == "ctrl/$RAMDISK":
            return states({"_value": "ramdisk"})
        if path == "rw/rapid/execution":
            if "action=start" in query:
                if self.on_start is not None:
                    self.on_start()
                self.start()
            if "action=stop" in query:
                self.running, self.stopped = False, self.stopped + 1
            return states({"ctrlexecstate": "running" if self.running else "stopped", "cycle": "once"})
        if path == "rw/panel/ctrlstate":
            return states({"ctrlstate": self.motors})
        if path == "rw/elog/0":
            return states(*self.log)
        if path == "rw/rapid/tasks":
            tasks = [f"T_ROB{arm + 1}" for arm in range(len(self.joints))]
            return states(*(
                {"_title": name, "name": name, "type": "norm", "taskstate": "link", "excstate": "read",
                 "active": "On", "motiontask": "TRUE"} for name in tasks
            ))  # fmt: skip
        if path.startswith("rw/motionsystem/mechunits/"):
            return states(jointtarget(self.joints[path.split("/")[3]]))
        if path.startswith("rw/iosystem/signals/"):
            name = path.rpartition("/")[2]
            if method == "POST":
                self.signals[name] = body.decode().partition("lvalue=")[2]
            return states({"lvalue": self.signals.get(name, "0")})
        return {}


def commands(content):
    """Rows of (target, speed, zone) of a program that begins and ends in step."""
    from abb_motion_program_exec.abb_motion_program_exec_client import MotionProgram

    empty = len(MotionProgram(timestamp="2026-01-01-00-00-00-0000").get_program_bytes())
    reader = Reader(content)
    reader.at = empty
    codes, rows = [], []
    while reader.at < len(content):
        _, code = reader.numbers(2)
        codes.append(int(code))
        values = reader.numbers(PARAMETERS[int(code)])
        if int(code) == 1:
            rows.append((values[:12], values[12:16], values[16:]))
    assert codes[0] == 7
    assert codes[-1] == 8
    return rows


def states(*found):
    return {"_embedded": {"_state": list(found)}}


def jointtarget(joints):
    names = [*(f"rax_{n}" for n in range(1, 7)), *(f"eax_{n}" for n in "abcdef")]
    values = [*joints, *([ABSENT] * (12 - len(joints)))]
    return {"_type": "ms-jointtarget", **{name: str(value) for name, value in zip(names, values, strict=True)}}


@contextmanager
def serve(irc5):
    """The address at which it listens."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"
        wbufsize = -1

        def do_any(self):
            body = self.rfile.read(int(self.headers.get("Content-Length", 0) or 0))
            if self.command in irc5.silent:
                time.sleep(1.0)
                self.close_connection = True
                return
            found = irc5.answer(self.command, self.path, body)
            content = found if isinstance(found, bytes) else json.dumps(found).encode()
            self.send_response(200)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, format, *args):
            pass

    for verb in ("GET", "POST", "PUT", "DELETE"):
        setattr(Handler, f"do_{verb}", Handler.do_any)
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


def as_abb(joints):
    """Joint angles of a seven-axis arm [rad] as ABB orders them [deg]: the third from the base comes last."""
    degrees = np.degrees(joints)
    return [*np.delete(degrees, 2), degrees[2]]
