"""What is given in place of what was meant gets an answer that says what to give."""

import pytest
from polyfold_interchange import write_dataset

import polyfold
from polyfold.errors import PolyfoldError


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: polyfold.fold(None), "no sentence; say in words"),
        (lambda: polyfold.fold("fold it in half", garment=3), "3 is no garment; give a kind"),
        (lambda: polyfold.garment(None), "no garment is called None; the known ones are"),
        (lambda: polyfold.describe(3), "no component is called 3"),
        (lambda: polyfold.load(None), "None is no path"),
        (lambda: polyfold.run("study.toml", "out"), "no study; give a polyfold.Study, or the file by polyfold.load"),
        (lambda: polyfold.open(None), "None is no folder; give the --out"),
        (lambda: polyfold.table("runs/main"), "give what polyfold.run returned, or polyfold.open"),
        (lambda: polyfold.compare(None), "None is no results"),
        (lambda: write_dataset(None, "out"), "None is no episode; give what polyfold.fold returned"),
        (lambda: write_dataset([1], "out"), "1 is no episode"),
    ],
)
def test_it_is_told_what_to_give(call, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(PolyfoldError) as caught:
        call()
    assert told in str(caught.value)
    assert not list(tmp_path.iterdir()), "nothing is made for it"
