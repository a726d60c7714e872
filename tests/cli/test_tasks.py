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
