"""Malformed input of every kind: a clear line for each, and each line as reviewed in ``messages.txt``."""

from malformed import PINNED, cases, report, table


def test_every_malformed_input_is_answered_with_a_clear_line_and_the_lines_are_those_reviewed(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)
    text, counts = report()
    assert len(cases()) >= 200
    assert {verdict for _, verdict in counts} == {"clear"}, table(counts)
    for line in text.splitlines():
        assert "Traceback" not in line
        assert "[Errno" not in line
        assert "pydantic" not in line
    pinned = PINNED.read_text("utf-8")
    if pinned.partition("\n")[0] == text.partition("\n")[0]:  # Python's own parsers word theirs anew in each version
        assert text.split("\n") == pinned.split("\n"), "review with: python tests/cli/malformed.py --write"
