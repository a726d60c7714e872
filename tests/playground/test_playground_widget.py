"""What the browser sends to the kernel, and what the kernel answers."""

import pytest

import polyfold

pytest.importorskip("anywidget")


@pytest.fixture
def table():
    """A playground, and a function that sends a message to its widget and returns the widget."""
    with polyfold.play(polyfold.garment("square", 0, edge_length=0.04)) as playground:
        assert "application/vnd.jupyter.widget-view+json" in playground._repr_mimebundle_()
        widget = playground.widget

        def send(what, **more):
            widget._received(widget, {"do": what, **more}, [])
            return widget

        yield playground, send


def test_a_drawn_line_shows_its_picks_and_folds(table):
    playground, send = table
    empty = playground.widget.picture
    widget = send("line", start=[80, 200], end=[320, 200])
    assert widget.planned
    assert widget.picture != empty
    assert playground.steps == ()
    assert send("fold").turns == ["a fold line: two arms"]
    assert not widget.planned
    assert len(playground.steps) == 1
    assert send("undo").turns == []
    assert widget.picture == empty


def test_flip_lifts_the_other_side(table):
    playground, send = table
    send("line", start=[80, 200], end=[320, 200])
    send("flip")
    send("fold")
    (step,) = playground.steps
    assert (step.action.picks[:, 1] > 200).all()


def test_dragged_picks_are_folded_as_they_are(table):
    playground, send = table
    send("picks", arrows=[[[130, 130], [200, 250]], [[270, 130], [210, 250]]])
    send("fold")
    (step,) = playground.steps
    assert step.action.picks.tolist() == [[130, 130], [270, 130]]


def test_a_sentence_is_folded_and_a_refusal_is_shown(table):
    playground, send = table
    assert "instruction" in send("say", sentence="make me a coffee").status
    assert playground.steps == ()
    assert len(send("say", sentence="fold it in half").turns) == 1
    assert not playground.widget.busy


def test_a_click_or_a_line_beside_the_cloth_is_told(table):
    _, send = table
    assert "drag" in send("line", start=[80, 200], end=[80, 200]).status
    widget = send("line", start=[0, 3], end=[399, 3])
    assert "misses the cloth" in widget.status
    assert not widget.planned


def test_what_was_done_can_be_taken_home(table, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, send = table
    assert "nothing was folded yet" in send("task", name="mine").status
    send("say", sentence="fold it in half")
    assert 'id = "mine"' in send("task", name="mine").text
    assert "playground.fold('fold it in half')" in send("code").text
    send("save", name="mine")
    assert (tmp_path / "mine" / "episode.json").exists()


def test_the_cloth_is_shown_while_it_moves(table):
    playground, send = table
    sent = []
    playground.widget.send = lambda content, buffers=None: sent.append((content["do"], buffers))
    send("line", start=[80, 200], end=[320, 200])
    send("fold")
    frames = [buffers for what, buffers in sent if what == "frame"]
    assert len(frames) > 3
    assert all(picture.startswith(b"\x89PNG") for (picture,) in frames)


def test_what_cannot_be_read_is_answered_all_the_same(table):
    playground, send = table
    sent = []
    playground.widget.send = lambda content, buffers=None: sent.append(content["do"])
    for what, more in (("line", {}), ("nothing", {}), ("picks", {"arrows": []}), ("line", {"start": "x", "end": 2})):
        assert "can't be" in send(what, **more).status
    assert sent == ["answered"] * 4
    send("line", start=[-1e9, 200], end=[1e9, 200])
    assert playground.widget.planned


def test_what_is_folded_from_code_is_shown_too(table):
    playground, _ = table
    flat = playground.widget.picture
    playground.fold("fold it in half")
    assert len(playground.widget.turns) == 1
    assert playground.widget.picture != flat
    playground.undo()
    assert playground.widget.turns == []
    assert playground.widget.picture == flat
    playground.close()
    assert "closed" in playground.widget.status


def test_what_can_not_be_shown_is_said_and_a_fold_with_how_near_it_came(table):
    playground, send = table
    playground.widget.values = True
    assert "csam+caso is one that does" in playground.widget.status
    assert "type what to fold first" in send("say", sentence="  ").status
    send("line", start=[80, 200], end=[320, 200])
    assert "beside the ideal: IoU 0.9" in send("fold").status
