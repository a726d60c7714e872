"""Running the checks: as tests of pytest's, or one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from polyfold.errors import PluginError
from polyfold.testing._checks import Check, checks_of
from polyfold.testing._subjects import ConformanceError, Subject, subjects


@dataclass(frozen=True)
class Found:
    """What came of one check.

    Attributes:
        component: for example ``policy middle``.
        says: what was looked at.
        fault: what is wrong; None where nothing is.
        untried: why it was not looked at; None where it was.
    """

    component: str
    says: str
    fault: str | None
    untried: str | None = None


def conformance(
    name: str,
    params: Mapping[str, Mapping[str, Any]] | None = None,
    expected_failures: Mapping[str, str] | None = None,
) -> Callable[..., None]:
    """A test for pytest that holds all components of a plugin to what their kinds promise, one test a check.

    Args:
        name: of the plugin, its distribution, or one component.
        params: parameters that a component can't be made without, ``{"policy mine": {"file": "weights.safetensors"}}``.
        expected_failures: reasons by test, ``{"policy mine: places are the picks, mirrored": "it carries less far"}``.
            Such a test fails if it passes.
    """
    import pytest

    reasons = dict(expected_failures or {})
    try:
        cases = _cases(name, params)
    except PluginError as error:
        broken = str(error)

        def refuse() -> None:
            pytest.fail(broken, pytrace=False)

        return refuse
    marked = []
    for subject, one in cases:
        label = f"{subject}: {one.says}"
        reason = reasons.pop(label, None)
        marks = [] if reason is None else [pytest.mark.xfail(reason=reason, strict=True, raises=pytest.fail.Exception)]
        marked.append(pytest.param(subject, one, id=label, marks=marks))
    if reasons:
        raise PluginError(
            f"{sorted(reasons)[0]!r} is expected to fail and no check of {name!r}; polyfold check {name} lists them"
        )

    @pytest.mark.parametrize(("subject", "check"), marked)
    def test(subject: Subject, check: Check) -> None:
        if lacking := subject.lacking():
            pytest.skip(lacking)
        try:
            check.run(subject)
        except (ConformanceError, PluginError) as error:
            pytest.fail(str(error), pytrace=False)

    return test


def check(name: str, params: Mapping[str, Mapping[str, Any]] | None = None) -> Iterator[Found]:
    """Look at all components of a plugin, check by check; see :func:`conformance`.

    Raises:
        PluginError: if there is no such plugin, it is broken, or it registers nothing.
    """
    for subject, one in _cases(name, params):
        lacking = subject.lacking()
        yield Found(str(subject), one.says, None if lacking else _fault(subject, one), lacking)


def _fault(subject: Subject, one: Check) -> str | None:
    try:
        one.run(subject)
    except (ConformanceError, PluginError) as error:
        return str(error)
    except Exception as error:
        return f"{type(error).__name__}: {' '.join(str(error).split())}"
    return None


def _cases(name: str, params: Mapping[str, Mapping[str, Any]] | None) -> list[tuple[Subject, Check]]:
    return [(subject, one) for subject in subjects(name, params) for one in checks_of(subject.kind)]
