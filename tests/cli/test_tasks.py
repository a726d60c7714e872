def test_suites_and_their_tasks_are_listed(polyfold):
    suites = polyfold("tasks")
    assert suites.status == 0
    assert "70 tasks" in suites.out
    assert "46 goals" in suites.out
    pants = polyfold("tasks", "polyfold70", "--garment", "pants").out
    assert "pants-block-left-thirds  [P-Block, seen]" in pants
    assert "fold leg outer left onto waist left and leg outer right onto waist right" in pants
    assert "tshirt" not in pants
    assert polyfold("tasks", "ambiguous", "--garment", "tshirt").out.count("[goal]") >= 7


def test_an_unknown_suite_is_answered_with_the_nearest(polyfold):
    answer = polyfold("tasks", "polyfld70")
    assert answer.status == 1
    assert "did you mean 'polyfold70'" in answer.err


def test_a_suite_that_cannot_be_read_hides_no_other(polyfold):
    import polyfold as library

    library.register("tasks", "torn", "polyfold_standard:no-such-file.toml")
    try:
        answer = polyfold("tasks")
    finally:
        library.plugins.unregister("tasks", "torn")
    assert answer.status == 0
    assert "torn             ! " in answer.out
    assert "70 tasks" in answer.out


def test_tasks_are_told_in_sentences_and_drawn(polyfold, tmp_path):
    told = polyfold("tasks", "wardrobe", "--garment", "skirt", "--out", tmp_path / "new" / "skirt.png")
    assert told.status == 0
    assert "“Fold the skirt in half from the hem up to the waist.” and 1 more" in told.out
    assert "1. fold hem left onto the point two thirds of the way from hem left to waist left and" in told.out
    assert (tmp_path / "new" / "skirt.png").read_bytes().startswith(b"\x89PNG")


def test_a_kind_without_tasks_and_a_picture_of_no_suite_say_what_to_do(polyfold, tmp_path):
    answer = polyfold("tasks", "polyfold70", "--garment", "trousers")
    assert answer.status == 1
    assert "nothing for a 'trousers'; the known ones are pants" in answer.err
    answer = polyfold("tasks", "--out", tmp_path / "all.png")
    assert answer.status == 1
    assert "name it: ambiguous, polyfold70" in answer.err
    assert not (tmp_path / "all.png").exists()
