"""Every fault that a provider is known to commit, as scripts for the loopback server."""

from __future__ import annotations

import time

from polyfold_offline.loopback import Sent, completion

ROUTES = ("openai/gpt-4o", "openrouter/openai/gpt-4o")
FAKE_KEY = "sk-or-v1-0badc0ffee0badc0ffee0badc0ffee"
GOOD = 'One fold.\n\n```json\n{"subgoals": ["fold the bottom edge upward to the top edge"]}\n```'


def line(start, end):
    """An answer with a fold line; coordinates may be any JSON text."""
    ends = [f'"{name}": {{"x": {x}, "y": {y}}}' for name, (x, y) in (("start", start), ("end", end))]
    return "A line.\n\n```json\n" + '{"fold_line": {' + ", ".join(ends) + "}}\n```"


def error(status, message="something went wrong", code=None, headers=None):
    return Sent({"error": {"message": message, "type": "error", "code": code or status}}, status, headers or {})


def said(text, finish="stop", **message):
    return Sent(completion(text, finish, **message))


def without_choices():
    return Sent({**completion(""), "choices": []})


def failing_midway():
    body = completion("")
    body["choices"][0] |= {"finish_reason": "error", "error": {"code": 502, "message": "upstream gave up"}}
    return Sent(body)


def hanging(seconds):
    time.sleep(seconds)
    return said(GOOD)


FAULTS = {
    "429": lambda: error(429, "slow down"),
    "429 with Retry-After": lambda: error(429, "slow down", headers={"Retry-After": "0.02"}),
    "500": lambda: error(500),
    "502": lambda: error(502),
    "503": lambda: error(503),
    "529": lambda: error(529, "overloaded"),
    "408": lambda: error(408),
    "hang": lambda: hanging(0.4),
    "dropped connection": lambda: Sent(drop=True),
    "short body": lambda: Sent(b'{"id": "x", "choices": [', length=5000),
    "broken JSON": lambda: Sent(b'{"id": "x", "choices": ['),
    "HTML with 200": lambda: Sent(b"<html>Please log in</html>", content_type="text/html"),
    "error object with 200": lambda: Sent({"error": {"message": "upstream gave up", "code": 502}}),
    "no choices": without_choices,
    "error in the choice": failing_midway,
}
"""Worth another try."""

REFUSED_REQUESTS = {"400": 400, "413": 413, "422": 422}

ACCESS = {
    "401": lambda: error(401, "no such key"),
    "402": lambda: error(402, "insufficient credits"),
    "403": lambda: error(403, "not allowed"),
    "404": lambda: error(404, "no such model"),
    "429 without credit": lambda: error(429, "You exceeded your current quota", "insufficient_quota"),
    "402 in an error object with 200": lambda: Sent({"error": {"message": "add credits", "code": 402}}),
}


class Script:
    """Answers with the given in turn; the last again and again."""

    def __init__(self, *answers):
        self.answers = list(answers)

    def __call__(self, request):
        answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
        return answer() if callable(answer) else answer
