"""Transport: which faults are worth another try, how long to wait for it, and how many calls may be under way.

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
200, no content, no refusal                     an empty answer: back to the model with the reason (repair loop)
200, ``length``                                 an answer that was cut off: repair loop
200, a refusal                                  final: RefusedError, nothing is folded
200 or 400, ``content_filter``                  final: RefusedError
200, NaN, infinity, outside the image           an invalid answer: repair loop
==============================================  ===============================================================

A wait is what ``Retry-After`` says, at most 60 s; else it doubles from 1 s, with jitter. Meanwhile no slot is held.
"""

from __future__ import annotations

import random
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from typing import Any, Generic, TypeVar

from polyfold.errors import LLMAccessError, LLMError

__all__ = ["Answer", "Patience", "TransportError", "call", "header", "slot"]

Result = TypeVar("Result")

AGAIN = frozenset({408, 409, 425, 429})
ACCESS = frozenset({401, 402, 403, 404})
NO_CREDIT = ("insufficient_quota", "exceeded your current quota", "insufficient credits", "credit balance is too low")


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
    def access(self) -> bool:
        """Whether no call can succeed until a person acts."""
        no_credit = self.status in (402, 403, 429) and any(word in self.text.lower() for word in NO_CREDIT)
        return no_credit or self.status in ACCESS

    @property
    def again(self) -> bool:
        """Whether another try may help."""
        if self.access:
            return False
        return self.status is None or self.status < 400 or self.status >= 500 or self.status in AGAIN


@dataclass(frozen=True)
class Patience:
    """How often to try and how long to wait [s]."""

    tries: int = 4
    first_wait: float = 1.0
    longest_wait: float = 60.0

    def wait(self, failed: int, fault: TransportError) -> float:
        """Seconds to wait after the ``failed``-th failed try."""
        asked = _seconds(fault.retry_after)
        if asked is None:
            asked = self.first_wait * 2 ** (failed - 1) * random.uniform(0.5, 1.5)
        return min(asked, self.longest_wait)


@dataclass(frozen=True)
class Answer(Generic[Result]):
    """What a call brought: the result, tries, seconds of the successful one and of all, and a line per fault."""

    result: Result
    tries: int
    latency_s: float
    wall_s: float
    faults: tuple[str, ...]


def call(
    attempt: Callable[[], Result],
    patience: Patience,
    what: str,
    place: Callable[[], AbstractContextManager[None]] = nullcontext,
    sleep: Callable[[float], None] = time.sleep,
) -> Answer[Result]:
    """Make a call, again where that may help.

    Args:
        attempt: makes one try; raises TransportError.
        patience: how often and how long.
        what: names the model in errors.
        place: is held during a try; waiting for it counts as waiting, not as latency.
        sleep: waits.

    Raises:
        LLMAccessError: if a person must act first.
        LLMError: if no try brought an answer.
    """
    began = time.perf_counter()
    faults: list[str] = []
    while True:
        fault = None
        with place():
            clock = time.perf_counter()
            try:
                result = attempt()
            except TransportError as caught:
                fault = caught
            now = time.perf_counter()
        if fault is None:
            return Answer(result, len(faults) + 1, now - clock, now - began, tuple(faults))
        faults.append(fault.text)
        # Raised here and not in the handler, so that no error holds what the provider sent.
        if fault.access:
            raise LLMAccessError(f"{what} can't be used: {fault.text}; {_remedy(fault)}")
        if not fault.again:
            raise LLMError(f"{what} refused the request: {fault.text}; change the prompt, its parameters or the model")
        if len(faults) >= patience.tries:
            raise LLMError(
                f"{what} gave no answer in {len(faults)} tries: {_in_short(faults)}; check the server and the network, "
                "try again later, or choose another model"
            )
        pause = patience.wait(len(faults), fault)
        faults[-1] += f" (waited {pause:.2g} s)"
        sleep(pause)


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


def _seconds(header: str | None) -> float | None:
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


_slots: dict[tuple[str, int], threading.BoundedSemaphore] = {}
_slots_lock = threading.Lock()


@contextmanager
def slot(server: str, limit: int) -> Iterator[None]:
    """One of ``limit`` places for calls to a server, shared by everything in this process."""
    with _slots_lock:
        places = _slots.setdefault((server, limit), threading.BoundedSemaphore(limit))
    with places:
        yield


def header(headers: Mapping[str, Any] | None, name: str) -> str | None:
    """A header's value, whatever the case of its name."""
    found = {str(key).lower(): str(value) for key, value in (headers or {}).items()}
    return found.get(name.lower())
