"""What components read besides their source is part of the fingerprint that guards a resumed run."""

import pytest

from polyfold import Experiment
from polyfold.errors import ConfigError
from polyfold.logs._dependencies import fingerprint


def test_the_weights_of_a_learned_policy_count():
    assert set(fingerprint([Experiment.of(policy="pair+caso")]).files) == {"polyfold_fgpnp: pair.safetensors"}
    assert set(fingerprint([Experiment.of(policy="1sam")]).files) == {"polyfold_fgpnp: 1sam.safetensors"}
    assert not fingerprint([Experiment.of(policy="caso")]).files


def test_weights_that_are_not_there_are_named():
    with pytest.raises(ConfigError, match="no weights 'mine'"):
        fingerprint([Experiment.of(policy={"name": "1sam", "weights": "mine"})])


@pytest.mark.parametrize("backend", ["record", "replay"])
def test_a_cassette_is_filled_while_a_run_goes_on_and_does_not_count(tmp_path, backend):
    (tmp_path / "said.jsonl").write_text("")
    assert not fingerprint([Experiment.of(llm=f"{backend}:{tmp_path / 'said.jsonl'}")]).files


@pytest.mark.parametrize(
    ("planner", "asks"),
    [
        ("hierarchical", {"subgoals@v2", "fold_line@v2", "fold_line@image-v2"}),
        ("direct-1arm", {"subgoals@v2", "direct_1arm@v2", "direct_1arm@keypoints-v2"}),
        ("direct-2arm", {"subgoals@v2", "direct_2arm@v2", "direct_2arm@keypoints-v2"}),
        ("zero-shot-vlm", {"zero_shot@v2"}),
    ],
)
def test_the_prompts_of_planners_count(planner, asks):
    assert asks <= set(fingerprint([Experiment.of(planner=planner)]).prompts)
