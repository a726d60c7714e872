"""A server on this machine that speaks OpenAI's chat API and answers with any backend, by default ``offline``.

    with serve() as server:
        llm = create("llms", "litellm:openai/offline", {"api_base": server.address})

With it a whole run goes through litellm's real HTTP path without leaving the machine, for tests and benchmarks.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from polyfold.plugins.interfaces import LLM


@dataclass(frozen=True)
class Received:
    """A request as it came in."""

    path: str
    headers: Mapping[str, str]
    body: Mapping[str, Any]


@dataclass(frozen=True)
class Sent:
    """What to send: ``body`` as JSON or as it is; ``length`` claims another one; ``drop`` closes without a word."""

    body: Mapping[str, Any] | bytes = b""
    status: int = 200
    headers: Mapping[str, str] = field(default_factory=dict)
    content_type: str = "application/json"
    length: int | None = None
    drop: bool = False


Script = Callable[[Received], Sent]


class Server:
    """A running server: where it listens, and what it has seen."""

    def __init__(self, script: Script, latency_s: float) -> None:
        self.script = script
        self.latency_s = latency_s
        self.received: list[Received] = []
        self.under_way = 0
        self.most_at_once = 0
        self._lock = threading.Lock()
        self._http = _Threads(("127.0.0.1", 0), _handler(self))

    @property
    def address(self) -> str:
        """To be given as ``api_base``."""
        return f"http://127.0.0.1:{self._http.server_port}/v1"

    def answer(self, request: Received) -> Sent:
        """Follow the script after the latency, counting the calls under way."""
        with self._lock:
            self.received.append(request)
            self.under_way += 1
            self.most_at_once = max(self.most_at_once, self.under_way)
        try:
            time.sleep(self.latency_s)
            return self.script(request)
        finally:
            with self._lock:
                self.under_way -= 1

    def start(self) -> None:
        """Begin to listen."""
        threading.Thread(target=self._http.serve_forever, args=(0.05,), daemon=True).start()

    def stop(self) -> None:
        """Listen no more."""
        self._http.shutdown()
        self._http.server_close()


class _Threads(ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 256

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that gave up is what tests of time limits are about."""


def _handler(server: Server) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"
        # One write a reply, or the client's delayed acknowledgement adds 40 ms.
        wbufsize = -1

        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers.get("Content-Length", 0))) or b"{}")
            sent = server.answer(Received(self.path, dict(self.headers), body))
            if sent.drop:
                self.close_connection = True
                return
            content = sent.body if isinstance(sent.body, bytes) else json.dumps(sent.body).encode()
            self.send_response(sent.status)
            self.send_header("Content-Type", sent.content_type)
            self.send_header("Content-Length", str(len(content) if sent.length is None else sent.length))
            for name, value in sent.headers.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(content)
            self.close_connection = sent.length is not None

        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing."""

    return Handler


def completion(text: str | None, finish: str = "stop", model: str = "loopback", **message: Any) -> dict[str, Any]:
    """A chat completion as OpenAI's API returns it; a token is taken for four characters."""
    tokens = {"prompt_tokens": 10, "completion_tokens": max(1, len(text or "") // 4)}
    return {
        "id": "chatcmpl-loopback",
        "object": "chat.completion",
        "created": 0,
        "model": model,
        "choices": [
            {"index": 0, "finish_reason": finish, "message": {"role": "assistant", "content": text, **message}}
        ],
        "usage": {**tokens, "total_tokens": sum(tokens.values())},
    }


def answering(llm: LLM) -> Script:
    """A script that lets a backend answer."""

    def script(request: Received) -> Sent:
        reply = llm.complete(request.body["messages"], {})
        return Sent(completion(reply.text, model=reply.model_served or "loopback"))

    return script


@contextmanager
def serve(script: Script | None = None, latency_s: float = 0.0) -> Iterator[Server]:
    """Listen on a free port of 127.0.0.1 while the context lasts.

    Args:
        script: makes the answers; by default the backend ``offline`` does.
        latency_s: time that each answer takes at least [s].
    """
    if script is None:
        from polyfold_offline import OfflineLLM

        script = answering(OfflineLLM())
    server = Server(script, latency_s)
    server.start()
    try:
        yield server
    finally:
        server.stop()
