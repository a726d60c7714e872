"""Retries: which faults are worth another try, how long to wait for it, and how many calls may be under way.

==============================================  ===============================================================
what comes back                                 what is done
==============================================  ===============================================================
408, 409, 425, 429, 5xx                         tried again, at most 4 tries; then LLMError
429 or 402 for want of credit                   never again; LLMAccessError, which ends a run
400, 413, 422 and other 4xx                     never again; LLMError, the episode ends as ``unanswered``
401, 402, 403, 404                              never again; LLMAccessError, which ends a run
no answer in time, connection dropped,          tried again, as a 5xx
body cut short
200 with HTML or broken JSON                    tried again, as a 5xx
200 with an error object                        by the code in the object, as if it were the status
200 without choices                             tried again, as a 5xx
200, nothing said, called or reasoned           an empty answer: back to the model with the reason (repair loop)
200, ``length``                                 an answer that was cut off: repair loop
200, a refusal                                  final: RefusedError, nothing is folded
200 or 400, ``content_filter``                  final: RefusedError
200, NaN, infinity, outside the image           an invalid answer: repair loop
==============================================  ===============================================================

A wait is what ``Retry-After`` says, at most 60 s; else it doubles from 1 s, with jitter. It holds no semaphore.
"""

from __future__ import annotations

import random
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from typing import Any, Generic, TypeVar

from polyfold.errors import LLMAccessError, LLMError

Result = TypeVar("Result")

_RETRYABLE = frozenset({408, 409, 425, 429})
_ACCESS = frozenset({401, 402, 403, 404})
_NO_CREDIT = ("insufficient_quota", "exceeded your current quota", "insufficient credits", "credit balance is too low")


class TransportError(Exception):
    """One try that brought no answer.

    Args:
        status: HTTP status, or the code in an error object; None if there was none.
        text: what happened, without secrets.
        retry_after: the header of that name, if any.
    """

    def __init__(self, status: int | None, text: str, retry_after: str | None = None) -> None:
        super().__init__(text)
        self.status = status
        self.text = text
        self.retry_after = retry_after

    @property
    def access_denied(self) -> bool:
        """Whether no call can succeed until a person acts."""
        no_credit = self.status in (402, 403, 429) and any(word in self.text.lower() for word in _NO_CREDIT)
        return no_credit or self.status in _ACCESS

    @property
    def retryable(self) -> bool:
        """Whether another try may help."""
        if self.access_denied:
            return False
        return self.status is None or self.status < 400 or self.status >= 500 or self.status in _RETRYABLE


@dataclass(frozen=True)
class RetryPolicy:
    """How often to try a call and how long to wait in between.

    Attributes:
        max_attempts: tries, the first one counted.
        first_wait_s: wait before the second try [s]; it doubles from there, with jitter.
        longest_wait_s: longest wait [s], those that a provider asks for included.
    """

    max_attempts: int = 4
    first_wait_s: float = 1.0
    longest_wait_s: float = 60.0

    def wait_s(self, failed: int, fault: TransportError) -> float:
        """How long to wait after the ``failed``-th failed try [s]."""
        asked = _retry_after_s(fault.retry_after)
        if asked is None:
            asked = self.first_wait_s * 2 ** (failed - 1) * random.uniform(0.5, 1.5)
        return min(asked, self.longest_wait_s)


@dataclass(frozen=True)
class CallResult(Generic[Result]):
    """What a call brought in the end.

    Attributes:
        result: what the successful try returned.
        attempts: tries, the successful one counted.
        latency_s: duration of the successful try [s].
        wall_s: duration of all, waits included [s].
        faults: a line for each failed try.
    """

    result: Result
    attempts: int
    latency_s: float
    wall_s: float
    faults: tuple[str, ...]


def call_with_retries(
    attempt: Callable[[], Result],
    policy: RetryPolicy,
    what: str,
    semaphore: threading.Semaphore | None = None,
    sleep: Callable[[float], None] = time.sleep,
) -> CallResult[Result]:
    """Make a call, again where that may help.

    Args:
        attempt: makes one try; raises TransportError.
        policy: how often and how long.
        what: names the model in errors.
        semaphore: is held during a try; waiting for it counts as waiting, not as latency.
        sleep: waits [s].

    Raises:
        LLMAccessError: if a person must act first.
        LLMError: if no try brought an answer.
    """
    began = time.perf_counter()
    faults: list[str] = []
    while True:
        with semaphore or nullcontext():
            clock = time.perf_counter()
            result = _tried(attempt)
            now = time.perf_counter()
        if not isinstance(result, TransportError):
            return CallResult(result, len(faults) + 1, now - clock, now - began, tuple(faults))
        faults.append(result.text)
        # Raised here and not where it was caught, so that no error holds what the provider sent.
        if result.access_denied:
            raise LLMAccessError(f"{what} can't be used: {result.text}; {_remedy(result)}")
        if not result.retryable:
            raise LLMError(f"{what} refused the request: {result.text}; change the prompt, its parameters or the model")
        if len(faults) >= policy.max_attempts:
            raise LLMError(
                f"{what} gave no answer in {len(faults)} tries: {_in_short(faults)}; check the server and the network, "
                "try again later, or choose another model"
            )
        pause = policy.wait_s(len(faults), result)
        faults[-1] += f" (waited {pause:.2g} s)"
        sleep(pause)


def _tried(attempt: Callable[[], Result]) -> Result | TransportError:
    try:
        return attempt()
    except TransportError as fault:
        return fault


def _in_short(faults: Sequence[str]) -> str:
    """Each kind of fault once, with how often it happened."""
    counts = Counter(fault.partition(" (waited")[0] for fault in faults)
    return "; ".join(f"{fault} ({count} times)" if count > 1 else fault for fault, count in counts.items())


def _remedy(fault: TransportError) -> str:
    if fault.status == 401:
        return "check the key in the environment"
    if fault.status == 404:
        return "check the model's name and api_base"
    if fault.status == 403:
        return "the key lacks a right, or the provider bars the request; check both with the provider"
    return "check credit and limits with the provider"


def _retry_after_s(header: str | None) -> float | None:
    """A ``Retry-After`` header in seconds: a number or a date; None if there is none or it is neither."""
    if not header:
        return None
    try:
        return max(0.0, float(header))
    except ValueError:
        pass
    try:
        return max(0.0, parsedate_to_datetime(header).timestamp() - time.time())
    except ValueError:
        return None


_semaphores: dict[tuple[str, int], threading.BoundedSemaphore] = {}
_semaphores_lock = threading.Lock()


def server_semaphore(server: str, limit: int) -> threading.BoundedSemaphore:
    """The semaphore for calls to a server, one per process and limit.

    Args:
        server: address or provider.
        limit: calls that may be under way at once.
    """
    with _semaphores_lock:
        return _semaphores.setdefault((server, limit), threading.BoundedSemaphore(limit))


def header_value(headers: Mapping[str, Any] | None, name: str) -> str | None:
    """A header's value, whatever the case of its name."""
    found = {str(key).lower(): str(value) for key, value in (headers or {}).items()}
    return found.get(name.lower())
