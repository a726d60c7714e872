"""Garments beyond the paper's are seen, spoken of and folded with nothing else changed."""

import pytest

import polyfold
from polyfold import plugins
from polyfold.testing import conformance

test_conformance = conformance("wardrobe")

COARSE = 0.025


@pytest.mark.parametrize(
    ("kind", "sentence", "task"),
    [
        ("skirt", "Fold the skirt in half from the hem up to the waist.", "skirt-half-hem"),
        ("skirt", "bring the left side over to the right side", "skirt-half-left"),
        ("shorts", "fold the left leg of the shorts onto the right leg", "shorts-half-left"),
        ("tanktop", "Bring the hem up to the straps.", "tanktop-half-hem"),
        ("longsleeve", "Fold the bottom third of the shirt up, then fold the top third down.", "longsleeve-thirds"),
        ("towel", "fold the towel in half from the bottom up", "towel-half-up"),
    ],
)
def test_a_sentence_folds_it(kind, sentence, task):
    episode = polyfold.fold(sentence, garment=plugins.generate_garment(kind, 300, COARSE), seed=300, task=task)
    assert episode.failure is None
    assert episode.fidelity.iou > 0.88
    assert episode.fidelity.moved_part_error_mm < 40.0


def test_what_it_does_not_have_is_refused_by_its_name():
    with pytest.raises(polyfold.RefusedError, match="it names a part that a skirt does not have"):
        polyfold.fold("fold both sleeves of the skirt in", garment="skirt", seed=0)


def test_people_s_other_names_lead_to_it():
    with pytest.raises(polyfold.PolyfoldError, match="did you mean 'longsleeve'"):
        polyfold.fold("fold it in half", garment="sweatshirt")
