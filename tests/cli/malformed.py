"""Malformed input of every kind that the command line takes, and what is answered.

    python tests/cli/malformed.py              # every message, and a table by kind
    python tests/cli/malformed.py --write      # the same into tests/cli/messages.txt, which the test compares

A case is a file, or files, and the command that is given them.
"""

import contextlib
import io
import json
import sys
import tempfile
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
PINNED = HERE / "messages.txt"

FILE = "FILE"
"""Stands for the file of a case in its command, and for where it lies in a message."""


@dataclass(frozen=True)
class Case:
    """One malformed input.

    Attributes:
        kind: of the input.
        content: of the file, or of several by name.
        command: with ``FILE`` in the place of the file, and ``DIR`` in that of its folder.
        about: what is wrong, where the content does not show it.
    """

    kind: str
    content: object
    command: tuple[str, ...]
    about: str = ""
    name: str = "file"
    beside: dict = field(default_factory=dict)

    def write(self, folder):
        """Put the files where the command finds them."""
        for name, content in {self.name: self.content, **self.beside}.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, Image.Image):
                content.save(path)
            elif isinstance(content, bytes):
                path.write_bytes(content)
            else:
                path.write_text(content if isinstance(content, str) else json.dumps(content), "utf-8")


FOLD = ("fold", "fold it in half", "--garment", "square", "--edge-length", "0.03")


def _experiments():
    for text in (
        "policy = [",
        "policy = affordance-pair",
        "policy = 3",
        "policy = []",
        "policy = true",
        'polcy = "affordance-pair"',
        'policy = "casso"',
        "[policy]",
        "[policy]\ngamma = 1.0",
        '[policy]\nname = "affordance-pair"\ngamma = "much"',
        '[policy]\nname = "affordance-pair"\ngamma = -1',
        '[policy]\nname = "affordance-pair"\ngamma = nan',
        '[policy]\nname = "affordance-pair"\ngamma = true',
        '[policy]\nname = "affordance-pair"\ngama = 0.1',
        'policy = "caso:x"',
        'policy = ""',
        'fabric = "demin"',
        "[fabric]\nthickness = 1.0",
        '[fabric]\nthickness = "thick"',
        "[fabric]\nthickness = inf",
        'simulator = "xpdb"',
        'guidance = "maybe"',
        'llm = "gpt"',
        'llm = "litellm"',
        'llm = "litellm:gpt-4"',
        'llm = "replay:nowhere.jsonl"',
        '[llm]\nname = "replay"\ncassette = "C:\\new\\tape.jsonl"',
        "[a]\n[a]",
        "\x00",
    ):
        yield Case("experiment", text, (*FOLD, "--config", FILE))
    yield Case("experiment", b"\xff\xfe\x00", (*FOLD, "--config", FILE), "UTF-16")
    yield Case("experiment", "a." * 5000 + "b = 1", (*FOLD, "--config", FILE), "5,000 nested tables")


def _studies():
    for text in (
        "garments = 0",
        "garments = 2.5",
        "garments = true",
        'garments = "two"',
        "garmnts = 2",
        "tasks = []",
        'tasks = "all"',
        'tasks = ["tshrt-*"]',
        'suite = "polyfld70"',
        'instructions = "some"',
        "edge_length = 0",
        "edge_length = nan",
        "first_seed = -1",
        "sizes = { square = true }",
        "sizes = { poncho = 0.5 }",
        'base = { simulator = { name = "real-cell", camera = "realsense", robot = "pybullet" } }',
        'split = "both"',
        'steps = "many"',
        'reference = "real"',
        "criteria = []",
        'criteria = ["lenint"]',
        "variants = {}",
        "variants = []",
        'variants = { a = { polcy = "affordance-pair" } }',
        'variants = { a = { "policy.gama" = 1 } }',
        'base = { policy = "casso" }',
        "metrics = { miuo = {} }",
        "metrics = { mppe = { alin = true } }",
        'name = "a/b"',
        'split = "seen"\ntasks = ["goal-*"]\nsuite = "ambiguous"',
        "= 3",
    ):
        yield Case("study", text, ("evaluate", FILE, "--out", "DIR/run"))
    yield Case("study", "x", ("evaluate", FILE, "--out", "DIR/run", "--variants", "none"))


TASK = '[[task]]\nid = "square-a"\ngarment = "square"\ntype = "S"\n'


def _suites():
    head = 'schema_version = 1\nname = "own"\n'
    for text in (
        "",
        'name = "own"\n' + TASK,
        'schema_version = 9\nname = "own"\n' + TASK,
        head,
        head + "[[task]]\n",
        head + TASK,
        head + TASK + "steps = []",
        head + TASK + "steps = [{}]",
        head + TASK + 'steps = [{ pairs = [["top_lft", "bottom_right"]] }]',
        head + TASK + 'steps = [{ pairs = [["top_left"]] }]',
        head + TASK + 'steps = [{ crease = ["top_left", "bottom_right"] }]',
        head + TASK + 'steps = [{ pairs = [["top_left", { bottom_right = 0.3 }]] }]',
        head + 2 * (TASK + 'steps = [{ pairs = [["top_left", "bottom_right"]] }]\n'),
        head + '[[goal]]\nid = "g"\n',
        "schema_version = [",
    ):
        yield Case("suite", text, ("tasks", "malformed"))


SQUARE = "v 0 0 0\nv 0 .4 0\nv .4 .4 0\nv .4 0 0\n"
CORNERS = {"bottom_left": 0, "top_left": 1, "top_right": 2, "bottom_right": 3}


def _meshes():
    mesh = (*FOLD, "--mesh", FILE, "--keypoints", "DIR/keypoints.json")
    for text in (
        "",
        "\n\n#nothing\n",
        "v 1 2\n",
        "v a b c\n",
        "v nan 0 0\nf 1 1 1\n",
        "v 1e999 0 0\n" + SQUARE + "f 1 2 3\n",
        SQUARE,
        SQUARE + "f 0 1 2\n",
        SQUARE + "f 1 2\n",
        SQUARE + "f 1 2 99\n",
        SQUARE + "f -9 1 2\n",
        SQUARE + "f a b c\n",
        SQUARE + "f 1 1 1 1\n",
        SQUARE + "f 1.5 2 3\n",
        SQUARE + "f 1 2 3\nf 1 3 4\nf 1 3 2\nf 1 4 3\nf 2 3 4\n",
        SQUARE.replace(".4", "4e-8") + "f 1 2 3 4\n",
        SQUARE.replace(".4", "400") + "f 1 2 3 4\n",
        SQUARE + "v .2 .2 .3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
        SQUARE.replace(".4", "0") + "f 1 2 3 4\n",
        "v 0 0 0\nv 0 .4 0\nv 0 .8 0\nv 0 1.2 0\nf 1 2 3 4\n",
        SQUARE + "v 2 0 0\nv 2 .4 0\nv 2.4 .4 0\nv 2.4 0 0\nf 1 2 3 4\nf 5 6 7 8\n",
    ):
        yield Case("mesh", text, mesh, beside={"keypoints.json": CORNERS})
    yield Case("mesh", b"\x89PNG\r\n\x1a\n" + bytes(200), mesh, "a PNG", beside={"keypoints.json": CORNERS})
    for content in (
        "",
        "{",
        "[]",
        "{}",
        "7",
        "null",
        "[" * 100_000,
        {**CORNERS, "top_left": 99},
        {**CORNERS, "top_left": -1},
        {**CORNERS, "top_left": "one"},
        {**CORNERS, "top_left": 1.5},
        {**CORNERS, "top_left": True},
        {"top_left": 1},
        {**CORNERS, "hem_left": 1},
        dict.fromkeys(CORNERS, 1),
    ):
        command = (*FOLD, "--keypoints", FILE, "--mesh", "DIR/mesh.obj")
        yield Case("keypoints", content, command, beside={"mesh.obj": SQUARE + "f 1 2 3 4\n"})


def _outlines():
    for content in (
        "",
        "{",
        "[]",
        "7",
        "null",
        '"a"',
        [[1, 2], [3, 4]],
        [["a", 1], [2, 3], [4, 5]],
        [[1, 2], [3]],
        "[[1, 2], [3, NaN], [4, 5]]",
        "[[1, 2], [3, Infinity], [4, 5]]",
        [[1, 2, 3], [3, 4, 5], [4, 5, 6]],
        [[1, 1], [1, 1], [1, 1]],
        [[0, 0], [1, 1], [2, 2]],
        [[0, 0], [100, 100], [100, 0], [0, 100]],
        {"shapes": []},
        {"shapes": [{"points": [[1, 1]]}]},
        {"annotations": []},
        {"annotations": [{"image_id": 1}, {"image_id": 2}]},
        {"annotations": [{"segmentation": {"counts": "x"}}]},
        {"annotations": [{"segmentation": [[1, 2, 3]]}]},
        "[" * 100_000,
    ):
        yield Case("outline", content, ("ground", FILE, "--garment", "square", "--out", "DIR/p.png"), name="file.json")


def _square(mode, inside, outside, size=(120, 120)):
    picture = Image.new(mode, size, outside)
    picture.paste(inside, (30, 30, 90, 90))
    return picture


def _pictures():
    for content, about in (
        (b"", "empty"),
        (b"hello", "a text"),
        (b"\x89PNG\r\n\x1a\n", "a PNG's head"),
        (b"\xff\xd8\xff\xe0", "a JPEG's head"),
        (b"%PDF-1.4", "a PDF"),
        (b"GIF89a\x01\x00\x01\x00", "a GIF's head"),
        (Image.new("L", (60, 60), 0), "all black"),
        (Image.new("L", (60, 60), 255), "all white"),
        (_square("L", 0, 255), "inverted"),
        (Image.new("RGBA", (60, 60), (9, 9, 9, 0)), "all transparent"),
        (Image.new("L", (1, 1), 255), "one pixel"),
        (_square("L", 255, 0, (4, 4)), "four pixels"),
    ):
        name = "file.png"
        yield Case("mask", content, (*FOLD, "--mask", FILE), about, name)
    for content, about in (
        (b"", "empty"),
        (b"hello", "a text"),
        (Image.new("RGB", (60, 60), (90, 90, 90)), "plain grey"),
        (Image.new("RGB", (1, 1)), "one pixel"),
        (Image.effect_noise((120, 120), 90), "noise"),
    ):
        command = ("ground", FILE, "--garment", "tshirt", "--out", "DIR/p.png")
        yield Case("photo", content, command, about, "file.png")


def _sheets():
    shirt = Image.new("RGB", (300, 200), (150, 115, 80))
    shirt.paste((60, 80, 150), (80, 40, 220, 160))
    command = ("ground", FILE, "--garment", "square", "--out", "DIR/p.png")
    for sheet in ("a4", "a6", "charuco", "charuco:7x5:30:40", "charuco:7x5:40:30", "charuco:7x5:40:30:DICT_9X9"):
        yield Case("photo", shirt, (*command, "--sheet", sheet), "no sheet beside it", "file.png")
    for segmenter in (
        ("--segmenter", "background"),
        ("--segmenter", "background:nowhere.png"),
        ("--segmenter", "sam:nowhere.onnx"),
        ("--segmenter", "grabcut", "--set", "segmenter.box=[10, 20, 300, 200]"),
        ("--segmenter", "grabcut", "--set", "segmenter.box=[0, 0, 1, 1]"),
        ("--segmenter", "grabbcut"),
    ):
        yield Case("photo", shirt, (*command, *segmenter), "a shirt on a table", "file.png")


def _cassettes():
    for content in (
        "[]\n",
        "7\n",
        "{}\n",
        '{"kind": "request"}\n',
        '{"schema_version": 99}\n',
        '{"schema_version": 1}\n{"a": 1}\n',
        b"\xff\xfe\n",
        "[" * 100_000 + "\n",
    ):
        yield Case("cassette", content, ("cassette", "show", FILE), name="file.jsonl")
        yield Case("cassette", content, (*FOLD, "--llm", "replay:FILE"), name="file.jsonl")


def _calibrations():
    cell = ("--simulator", "real-cell", "--set", "simulator.camera=realsense", "--set", "simulator.robot=pybullet")
    for content in ("{", "{}", '{"intrinsics": 1, "pose": [[1]]}', b"\xff\xfe", '{"intrinsics": [[]], "pose": null}'):
        yield Case("calibration", content, (*FOLD, *cell, "--set", "simulator.calibration=FILE"))


def _cells():
    for content in ("", "[simulator", 'simulator = "xpbd"', 'simulator = "real-cell"', 'camera = "realsense"'):
        yield Case("cell", content, ("cell", "park", "--config", "FILE"), name="file.toml")


def _plugins():
    for command in (
        ("check", "nothing-like-it"),
        ("check", "caso", "--params", "{"),
        ("check", "caso", "--params", "[1]"),
        ("check", "caso", "--params", '{"policy other": {}}'),
        ("plugins", "show"),
        ("plugins", "show", "cazo"),
        ("new-plugin", "Upper", "--kind", "policy", "--out", "DIR"),
        ("new-plugin", "../out", "--kind", "policy", "--out", "DIR"),
        ("new-plugin", "mine", "--kind", "polcy", "--out", "DIR"),
        ("new-plugin", "mine", "--kind", "policy", "--out", FILE),
    ):
        yield Case("plugin", "", command)


def _weights():
    for content, about in (
        (b"", "empty"),
        (b"hello", "a text"),
        (b"\x08\x00\x00\x00\x00\x00\x00\x00{}      ", "no tensor"),
        (b"\xff" * 64, "a header too long"),
        (b"\x80\x04K\x07.", "a pickle"),
        (b"PK\x03\x04" + bytes(60), "torch's zip"),
    ):
        for policy in ("csam+caso", "1sam"):
            command = (*FOLD, "--policy", policy, "--set", "policy.weights=FILE")
            yield Case("weights", content, command, about, "file.safetensors")


def _data():
    for content in ("", "{", "[]", "{}", '{"schema_version": 1}', '{"schema_version": 99}', b"\xff"):
        yield Case("data set", content, ("collect", "--describe", "DIR"), name="dataset.json")
        beside = {"config.toml": 'data = ["DIR"]\n'}
        yield Case(
            "data set", content, ("train", "DIR/config.toml", "--out", "DIR/out"), name="dataset.json", beside=beside
        )
    for text in (
        "",
        "data = []",
        'data = "x"',
        'data = ["nowhere"]',
        'data = ["a"]\nepochs = 0',
        'data = ["a"]\nepoch = 3',
    ):
        yield Case("training", text, ("train", FILE, "--out", "DIR/out"))


def _runs():
    for content in (
        "",
        "{",
        "[]",
        "7",
        "{}",
        '{"schema_version": 2}',
        '{"schema_version": 99}',
        b"\xff",
        "[" * 100_000,
    ):
        for verb in ("table", "report"):
            yield Case("run", content, (verb, "DIR"), name="run.json")
        yield Case("run", content, ("evaluate", "experiments/smoke.toml", "--out", "DIR"), name="run.json")
    yield Case("run", '{"key": "a"}\n', ("evaluate", "experiments/smoke.toml", "--out", "DIR"), name="episodes.jsonl")


def _options():
    for options in (
        ("fold",),
        ("fold", "a", "b"),
        ("fold", "it", "--seed", "x"),
        ("fold", "it", "--garment", "poncho"),
        ("fold", "it", "--size", "0.004"),
        ("fold", "it", "--mask", "a.png", "--image", "b.png"),
        ("fold", "it", "--keypoints", "a.json"),
        ("fold", "it", "--edge-length", "9"),
        ("fold", "it", "--edge-length", "1e-9"),
        ("fold", "it", "--task", "tshirt-haf-hem"),
        ("fold", "it", "--set", "policy"),
        ("fold", "it", "--set", "polcy.gamma=1"),
        ("fold", "it", "--set", "policy.gamma=[1"),
        ("fold", "it", "--colour", "red"),
        ("fold", "it", "--guidance", "none"),
        ("foldd", "it"),
        ("table",),
        ("table", "a", "--by", "colour"),
        ("evaluate", "a.toml"),
        ("garments", "--count", "0"),
        ("prompt", "show", "poem", "--garment", "square"),
        ("cassette",),
        ("collect",),
        ("collect", "--out", "DIR/d", "--seeds", "9-1"),
        ("collect", "--out", "DIR/d", "--mix", "some=many"),
        ("maps", "--policy", "casso"),
    ):
        yield Case("options", "", options)


def cases():
    """All of them."""
    makers = (
        _experiments, _studies, _suites, _meshes, _outlines, _pictures, _sheets, _cassettes,
        _calibrations, _cells, _plugins, _weights,
        _data, _runs, _options,
    )  # fmt: skip
    return [case for maker in makers for case in maker()]


def answer(case, folder):
    """What the command line answers: exit status and both outputs, the folder's name taken out."""
    import polyfold as library
    from polyfold.cli import main

    case.write(folder)
    for path in folder.rglob("*.toml"):
        path.write_text(path.read_text("utf-8").replace("DIR", str(folder)), "utf-8")
    if case.kind == "suite":
        library.register("tasks", "malformed", str(folder / case.name))
    place = str(folder / case.name)
    command = [word.replace(FILE, place).replace("DIR", str(folder)) for word in case.command]
    out, err = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
            warnings.simplefilter("always")
            try:
                status = main(command)
            except SystemExit as stop:
                status = stop.code
    finally:
        if case.kind == "suite":
            library.plugins.unregister("tasks", "malformed")
    return status, *(text.getvalue().replace(place, FILE).replace(str(folder), "DIR") for text in (out, err))


def shown(case):
    """The content of a case on one line."""
    told = case.about or (case.content if isinstance(case.content, str) else json.dumps(str(case.content)))
    told = " / ".join(line.strip() for line in told.splitlines() if line.strip())
    told = "".join(character if character.isprintable() else f"\\x{ord(character):02x}" for character in told)
    return told if len(told) <= 90 else f"{told[:60]}... ({len(told)} characters)"


def report():
    """Every message as a text that a reviewer can read, and the counts by kind."""
    lines, counts = [f"Python {sys.version_info[0]}.{sys.version_info[1]}", ""], Counter()
    for case in cases():
        with tempfile.TemporaryDirectory() as folder:
            try:
                status, _, err = answer(case, Path(folder))
                verdict = "clear" if status in (1, 2, 3) and err.startswith("polyfold") else "accepted"
            except Exception as error:
                status, err, verdict = "traceback", f"{type(error).__name__}: {error}\n", "traceback"
        counts[case.kind, verdict] += 1
        lines += [
            f"# {case.kind}: {shown(case)}",
            f"$ polyfold {' '.join(case.command)}",
            f"[{status}] {err.rstrip()}",
            "",
        ]
    return "\n".join(lines), counts


def table(counts):
    """Counts by kind as Markdown."""
    kinds = list(dict.fromkeys(kind for kind, _ in counts))
    rows = ["| input | n | clear error | traceback | accepted |", "|---|---|---|---|---|"]
    verdicts = ("clear", "traceback", "accepted")
    for kind in [*kinds, None]:
        found = [sum(n for (k, v), n in counts.items() if kind in (k, None) and v == verdict) for verdict in verdicts]
        rows.append(f"| {kind or 'all'} | {sum(found)} | {' | '.join(map(str, found))} |")
    return "\n".join(rows)


if __name__ == "__main__":
    text, found = report()
    if "--write" in sys.argv:
        PINNED.write_text(text, "utf-8")
    else:
        print(text)
    print(table(found))
