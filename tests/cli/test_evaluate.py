import pytest


@pytest.mark.parametrize("count", ["0", "-1", "many"])
def test_a_wrong_number_of_garments_is_answered_with_what_is_wanted(polyfold, tmp_path, count):
    result = polyfold("evaluate", "experiments/smoke.toml", "--out", tmp_path, f"--garments={count}")
    assert result.status == 2
    assert "is not a whole number from 1" in result.err


def test_only_variants_of_the_study_can_be_chosen(polyfold, tmp_path):
    study = tmp_path / "study.toml"
    study.write_text('tasks = ["square-corner-top_left"]\nvariants = { near = {}, far = { policy = "farthest" } }\n')
    result = polyfold("evaluate", study, "--out", tmp_path / "run", "--variants", "fra")
    assert result.status == 1
    assert "did you mean 'far'" in result.err
