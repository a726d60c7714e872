"""How metrics of plugins are shown: by what they say of themselves, each left out by itself."""

from typing import ClassVar

import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import PluginError
from polyfold.evaluation._criteria import criteria
from polyfold.studies._run import metric_records


class Bare:
    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    def score(self, result, references):
        return 0.0


class Labelled(Bare):
    label: ClassVar[str] = "Worst corner"


class Rounded(Bare):
    digits: ClassVar[int] = 3


@pytest.mark.parametrize(
    ("metric", "label", "digits"), [(Bare, "mine", 1), (Labelled, "Worst corner", 1), (Rounded, "mine", 3)]
)
def test_what_a_metric_leaves_out_has_a_default(metric, label, digits):
    polyfold.register("metrics", "mine", metric, "a test's metric")
    try:
        shown = metric_records(criteria(["lenient"])["lenient"])["mine"]
    finally:
        plugins.unregister("metrics", "mine")
    assert (shown.label, shown.digits, shown.unit, shown.summary) == (label, digits, "mm", "a test's metric")


class Failing(Bare):
    def score(self, result, references):
        return 1 / 0


def test_a_metric_that_fails_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    polyfold.register("metrics", "mine", Failing)
    study = polyfold.Study(name="f", tasks=("square-corner-top_left",), first_seed=2000, edge_length=0.03)
    try:
        with pytest.raises(PluginError, match=r"the metric 'mine' .* failed in score: ZeroDivisionError"):
            polyfold.run(study, tmp_path / "run", progress=False)
    finally:
        plugins.unregister("metrics", "mine")
