"""Registers the garments and fabrics, the segmenters, the agents and the standard tasks."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_garments(register):
    """Register the kinds of garment."""
    register("square", "polyfold_standard.garments.square:Square", "square cloth, one layer")
    register("rectangle", "polyfold_standard.garments.rectangle:Rectangle", "rectangular cloth, one layer")
    register("tshirt", "polyfold_standard.garments.tshirt:TShirt", "t-shirt, two layers")
    register("pants", "polyfold_standard.garments.pants:Pants", "pants, two layers")


@hookimpl
def register_fabrics(register):
    """Register the fabrics."""
    register("jersey", "polyfold_standard.fabrics.jersey:Jersey", "knitted cotton, limp: t-shirts")
    register("poplin", "polyfold_standard.fabrics.poplin:Poplin", "plain-woven cotton: shirts, napkins, tea towels")
    register("denim", "polyfold_standard.fabrics.denim:Denim", "cotton twill, stiff: jeans")
    register("terry", "polyfold_standard.fabrics.terry:Terry", "looped cotton, thick and soft: bath towels")
    register("felt", "polyfold_standard.fabrics.felt:Felt", "pressed wool, thick, alike in all directions")


@hookimpl
def register_simulators(register):
    """Register the fault injector."""
    register("faulty", "polyfold_standard.faults:FaultySimulator", "another simulator with missed grasps and slips")


@hookimpl
def register_segmenters(register):
    """Register the segmenters of plain and of photographed tables, and the one that spoils masks."""
    register("colour", "polyfold_standard.segmenters.colour:ColourThreshold", "colour distance from the table")
    register(
        "photo",
        "polyfold_standard.segmenters.photo:PhotoSegmenter",
        "one garment on a plain, textured or shadowed table, the default for photos",
    )
    register(
        "background",
        "polyfold_standard.segmenters.background:BackgroundDifference",
        "difference from a picture of the empty table",
    )
    register("grabcut", "polyfold_standard.segmenters.grabcut:GrabCut", "GrabCut from a box, strokes, or by itself")
    register(
        "sam",
        "polyfold_standard.segmenters.promptable:PromptableSegmenter",
        "a promptable network of your own, as an ONNX file",
    )
    register(
        "noisy",
        "polyfold_standard.segmenters.noisy:NoisySegmenter",
        "another segmenter whose edge wavers, tears or is coarse",
    )


@hookimpl
def register_agents(register):
    """Register the oracle, the policies' ablation, and the two baselines that every result is compared with."""
    register(
        "oracle",
        "polyfold_standard.agents.oracle:Oracle",
        "true fold lines, picks that come near the ideal (privileged)",
    )
    register(
        "fold-lines", "polyfold_standard.agents.fold_lines:FoldLines", "true fold lines, picks by policy (privileged)"
    )
    register("noop", "polyfold_standard.agents.baselines:Noop", "does nothing")
    register(
        "random",
        "polyfold_standard.agents.baselines:Random",
        "random picks on the cloth, places mirrored across a random line",
    )


@hookimpl
def register_metrics(register):
    """Register the metrics."""
    register("mppe", "polyfold_standard.metrics:MPPE", "mean particle position error [mm]")
    register("miou", "polyfold_standard.metrics:IoU", "IoU of the silhouettes")
    register("moved-part", "polyfold_standard.metrics:MovedPartError", "mean error of what the reference moved [mm]")
    register("quality", "polyfold_standard.quality:Quality", "edges, area, flatness and creases, 0 to 100")


@hookimpl
def register_criteria(register):
    """Register the success criteria."""
    register("lenient", "polyfold_standard.criteria:Lenient", "MPPE <= 30 mm, IoU >= 0.80, moved part <= 40 mm")
    register("strict", "polyfold_standard.criteria:Strict", "MPPE <= 12.5 mm, IoU >= 0.90, moved part <= 20 mm")


@hookimpl
def register_tasks(register):
    """Register the suites."""
    register("polyfold70", "polyfold_standard:tasks/polyfold70.toml", "the 70 tasks of the paper's Table I")
    register("ambiguous", "polyfold_standard:tasks/ambiguous.toml", "46 goals that leave the folds to the planner")
