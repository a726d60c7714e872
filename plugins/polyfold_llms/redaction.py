"""Keys and other secrets: found in the environment, redacted from every text that leaves a backend.

Nothing here keeps a key: the environment is read when a text is redacted or a call is made.
"""

from __future__ import annotations

import logging
import os
import re
from typing import Any

HIDDEN = "[hidden]"

_NAMES = re.compile(r"(KEY|TOKEN|SECRET|PASSWORD|CREDENTIALS?)S?$", re.IGNORECASE)
_SHORTEST = 8
_PREFIX = 12
"""Providers may echo a key in part: what begins with this many characters of one is hidden too."""

_PATTERNS = re.compile(
    r"(?<![A-Za-z0-9])sk-[A-Za-z0-9_-]{16,}"  # OpenAI, OpenRouter, Anthropic, DeepSeek
    r"|(?<![A-Za-z0-9])AIza[A-Za-z0-9_-]{30,}"  # Google
    r"|(?<![A-Za-z0-9])(?:xai|gsk|hf|ghp|r8|pplx|fw|nvapi)[_-][A-Za-z0-9_-]{20,}"
    r"|(?<![A-Za-z0-9])AKIA[A-Z0-9]{16}"
    r"|(?<=Bearer )[A-Za-z0-9._~+/-]{16,}=*"
)


def redact(text: str) -> str:
    """The text without the secrets of this process's environment and without what looks like a key."""
    for secret in _secrets():
        text = text.replace(secret, HIDDEN)
        if len(secret) >= 2 * _PREFIX:
            text = re.sub(re.escape(secret[:_PREFIX]) + r"[\w*.…-]*", HIDDEN, text)
    return _PATTERNS.sub(HIDDEN, text)


def redacted(value: Any) -> Any:
    """Plain data with every string in it redacted, the keys of mappings too."""
    if isinstance(value, str):
        return redact(value)
    if isinstance(value, dict):
        return {redacted(key): redacted(content) for key, content in value.items()}
    if isinstance(value, (list, tuple)):
        return [redacted(content) for content in value]
    return value


def contains_secret(text: str) -> bool:
    """Whether a secret of the environment, or what looks like a key, stands in the text."""
    return redact(text) != text


def redact_logs(*names: str) -> None:
    """Scrub what the named loggers say."""
    for name in names:
        logger = logging.getLogger(name)
        if not any(isinstance(known, _Redactor) for known in logger.filters):
            logger.addFilter(_Redactor())


class _Redactor(logging.Filter):
    def filter(self, record: logging.LogRecord) -> bool:
        record.msg, record.args = redact(record.getMessage()), None
        # The traceback and the error's own text may hold what the provider echoed.
        record.exc_info = record.exc_text = record.stack_info = None
        return True


def _secrets() -> list[str]:
    """Secret values, the longest first, so that one that contains another is hidden whole."""
    found = {value for name, value in os.environ.items() if _NAMES.search(name) and len(value) >= _SHORTEST}
    return sorted((value for value in found if not value.isdigit()), key=len, reverse=True)
