"""What backends of language models are held to. None is asked anything that would cost money."""

from __future__ import annotations

from polyfold.errors import LLMError
from polyfold.plugins._traits import TakesArgument
from polyfold.testing._checks import checks
from polyfold.testing._materials import TriedNetworkError, without_network
from polyfold.testing._subjects import Subject

QUESTION = [{"role": "system", "content": "Answer in one word."}, {"role": "user", "content": "Is a towel cloth?"}]


@checks("llms", "without a network it answers, or ends in an LLMError")
def _offline(subject: Subject) -> None:
    if isinstance(subject.cls(), TakesArgument) and ":" not in subject.name:
        return  # without a model's name there is nothing to ask
    with without_network() as asked:
        try:
            reply = subject.make().complete(QUESTION, {"timeout_s": 1.0, "attempts": 1})
        except LLMError:
            return
        except TriedNetworkError as error:
            subject.require(False, "complete", str(error), "turn what the transport raises into an LLMError")
            return
    subject.require(
        not asked, "complete", "no connection could be made, and it answers", "raise an LLMError that says what to do"
    )
    subject.require(isinstance(reply.text, str), "complete", "reply.text is no text", "give '' where there is none")
    counts = [count for count in reply.usage.values() if not isinstance(count, int) or count < 0]
    subject.require(not counts, "complete", f"usage holds {counts}", "token counts are whole; leave out unknown ones")
    subject.require(
        reply.cost is None or reply.cost > 0 or reply.cost_source == "free", "complete",
        "the cost is 0, which says that it was free", "cost=None where it is unknown; say cost_source='free' if it is",
    )  # fmt: skip
