"""What this plugin registers."""

from polyfold import hookimpl


@hookimpl
def register_garments(register):
    """Kinds of garment beyond the paper's."""
    register("skirt", "polyfold_wardrobe.skirt:Skirt", "a skirt, straight to flared")
    register("shorts", "polyfold_wardrobe.shorts:Shorts", "shorts, knee-long at most")
    register("tanktop", "polyfold_wardrobe.tanktop:TankTop", "a tank top with straps")
    register("longsleeve", "polyfold_wardrobe.longsleeve:LongSleeve", "a long-sleeved shirt, sleeves beside the body")
    register("towel", "polyfold_wardrobe.towel:Towel", "a bath or beach towel, up to three times as long as wide")


@hookimpl
def register_tasks(register):
    """Halves, thirds and packets of these garments."""
    register("wardrobe", "polyfold_wardrobe:tasks.toml", "halves, thirds and packets of five more kinds of garment")


@hookimpl
def register_metrics(register):
    """What pairs of keypoints tell."""
    register("keypoint-pairs", "polyfold_wardrobe.keypoints:KeypointPairs", "keypoints as far apart as the ideal's [%]")


@hookimpl
def register_criteria(register):
    """Success as the LeHome Challenge has it."""
    register("lehome", "polyfold_wardrobe.keypoints:AsLeHome", "every pair of keypoints as the ideal has it")
