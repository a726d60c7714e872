"""The language of geometry put plainly: vertices, bisectors, reflections, coincidence and *respectively*.

Each rule keeps what a sentence says about a fold and drops only what follows from it: that an altitude halves a
triangle, or that a half that is reflected across the axis beside it comes to lie on the other half.
"""

from __future__ import annotations

import re

from polyfold_rules.words.geometric_terms import (
    ACROSS,
    AXIS,
    BORDER,
    FINITE,
    FOLDED,
    LINE,
    MIDPOINTS,
    NOUN,
    SIDE,
    SIDES,
    plain_terms,
)

_OF_EDGE = re.compile(
    r"\b(?:both |the |two |both the )*corners (?:of|delimiting|bounding|adjacent to|incident to|lying on|"
    rf"at|on|along|at the ends of) the "
    rf"(?P<side>{SIDE}) "
    r"(?:edge|side|border)\b"
)
_NAMELY = re.compile(rf"\bthe corners [^,.;]*, namely (?P<which>{SIDES}(?:,? and (?:the )?{SIDES})),")
_MIDLINE = re.compile(
    rf"\b(?:(?:the|a) {LINE} )?(?P<begin>{MIDPOINTS})"
    rf"(?P<which>(?:{SIDE}) and (?:the )?(?:{SIDE})|lateral|vertical|horizontal) {BORDER}\b"
)
_BISECTOR = re.compile(
    rf"\b(?:perpendicular )?bisector of (?:the |both |its )"
    rf"(?P<which>{SIDE}(?: and (?:the )?{SIDE})?|lateral) {BORDER}"
)
_ENDS = {frozenset(("left", "right")): "horizontal", frozenset(("top", "bottom")): "vertical"}
_LATERAL = {"lateral": "horizontal", "vertical": "horizontal", "horizontal": "vertical"}
_SAME = {"upper": "top", "lower": "bottom", "left-hand": "left", "right-hand": "right"}

_CUT_CORNER = re.compile(
    rf"\b(?:the (?:cloth|fabric|square|napkin) {FINITE} )?(?:fold|folded|crease|creased)(?: it| the cloth)? along the "
    rf"{LINE} {MIDPOINTS}(?P<first>{SIDE}) and (?:the )?(?P<second>{SIDE}) {BORDER}"
    r"(?:, the corner (?:thereby )?(?:coming to (?:rest|lie)|landing) (?:on|at|in) the cent(?:re|er))?"
)
_REFLECTED = re.compile(
    rf"\b(?P<verb>reflect|mirror)(?P<form>ed)?\b(?P<between>[^.;,]*?) {ACROSS} (?:the |its )"
    rf"(?P<way>(?:vertical|horizontal) )?{AXIS}"
    r"(?: of (?:the|its) (?:cloth|shirt|garment|rectangle|square|trousers|pants))?"
    r"(?= ?[.,;]| so that| such that| and| until|$)"
)
_NEXT = re.compile(
    r"[.,;]|\b(?:then|subsequently|thereafter|afterwards|next)\b|(?<=axis) and\b|(?<=line) and\b|(?<=symmetry) and\b"
)
"""Where the next step of a sentence begins."""
_KNOWN_END = re.compile(r"\b(?:hem|waist|waistband|cuffs|leg ends)\b")
_ACROSS_DIAGONAL = re.compile(
    rf"\b(?P<verb>reflect|mirror)(?P<form>ed)? (?P<between>[^.;,]*?){ACROSS} (?:the|its)(?: opposite| other)? diagonal"
    r"(?: (?:joining|connecting|that joins|that connects) the other two (?:[a-z]+ )?corners)?"
    r"(?= ?[.,;]| so that| such that|$)"
)
_BY_REFLECTION = re.compile(rf"\bby (?:a )?(?:reflection|mirroring) {ACROSS} [^,;.]*, ")
_ABSOLUTE = re.compile(
    rf"\b(?P<head>(?:(?:and )?the resulting [a-z]+ {FINITE} (?:then |subsequently |thereafter |now "
    r")?(?:halved|bisected))"
    r"|the (?:cloth|fabric|square|napkin) [a-z ]*? (?:about|across|along) (?:the|its) (?:rising "
    r"|falling |other )?diagonal)"
    rf", (?P<part>(?:the|its) {SIDES} {NOUN}) (?:thereby |thus )?"
    rf"(?:being {FOLDED}|landing|coming to (?:rest|lie)) (?P<place>(?:to|onto|on|upon|over) )"
)
_BEING = re.compile(
    rf"\b(?P<head>(?:halved|bisected|folded|creased)\b[^.,;]*), (?P<part>(?:the|its|both) [a-z ]{{3,30}}?) being "
    rf"(?P<does>{FOLDED} (?:to|onto|on|upon|over)\b)"
)
"""*Bisected, the right half being laid on the left half*: how the fold before it is meant."""
_CREASE_THEN = re.compile(
    rf"\b(?:crease|fold) (?P<line>(?:along|through|from|at|across|about) [^.;,]*?)"
    rf"(?:,? and fold| ?, with|,) (?P<part>the {SIDES} sleeve)(?: being folded)? ?"
    r"(?:over|inward|inwards|in)?(?=[.;,]|$)"
)
_CREASE_HALF = re.compile(
    rf"\b(?:crease|fold) (?:along|through|about|at|across) [^.;,]*midline[^.;,]*, (?P<part>the {SIDE} half) "
    rf"being {FOLDED} (?P<place>(?:to|onto|on|upon|over) the {SIDE})(?: half)?(?=[.;,]|$)"
)
_BOTH = rf"the (?P<{{}}>{SIDES})(?: {NOUN})? and (?:the )?(?P<{{}}>{SIDES}) (?P<{{}}>{NOUN})s?"
_RESPECTIVELY = re.compile(
    rf"\b{_BOTH.format('a', 'b', 'noun')} (?P<does>[^.,;]*?)(?:onto|on|to|upon|with) "
    rf"{_BOTH.format('c', 'd', 'place')},? "
    r"respectively(?:,? (?:and )?in (?:that order|this order|the order(?: (?:stated|given|named))?))?"
)
_GAPPED = re.compile(
    rf",? and (?P<part>the {SIDES} {NOUN}) (?:then|thereafter|subsequently|afterwards|next),? "
    r"(?:with|onto|to|on|upon) (?=the )"
)
_HAVING = re.compile(
    rf"\bhaving been (?:folded|creased) (?:such that|so that) its (?P<part>{SIDES} {NOUN}) "
    rf"(?:coincides with|meets|lies on) its (?P<place>{SIDES} {NOUN}), the [a-z]+ {FINITE} (?:folded|creased) "
    rf"(?:such that|so that) its (?P<then>{SIDES} {NOUN}) (?:coincides with|meets|lies on) "
    rf"its (?P<there>{SIDES} {NOUN})"
)
_THIRDS = re.compile(
    rf"(?:,? and the (?:result|resulting [a-z]+) {FINITE},? |,? and )?"
    rf"(?:then |subsequently |thereafter )?(?:to be )?folded (?:into|in) (?:three|thirds), "
    r"(?:first|firstly) (?:the )?(?P<first>cuffs|hems|leg ends|waist|waistband|top|bottom) "
    r"(?P<way>up|down)(?:wards?)?,? "
    r"(?:and )?(?:then|next|thereafter|subsequently) (?:the )?[a-z ]+? (?:up|down)(?:wards?)?\b"
)
_ITS_TIP = re.compile(r"\b(?P<verb>folded)[;,] its tip (?:shall|is to|should|must|will|then)\b")


def without_geometry(text: str) -> str:
    """The same instruction without the terms of geometry; lower case is expected."""
    text = plain_terms(text)
    text = _CUT_CORNER.sub(_cut_corner, text)
    text = _MIDLINE.sub(_midline, text)
    text = _BISECTOR.sub(_bisector, text)
    text = _OF_EDGE.sub(r"the two \g<side> corners", text)
    text = _NAMELY.sub(r"the \g<which> corners", text)
    text = _BY_REFLECTION.sub("", text)
    text = re.sub(r"\bonto its opposite(?= ?[.,;]|$)", "onto the opposite corner", text)
    text = _REFLECTED.sub(_reflected, text)
    text = _ACROSS_DIAGONAL.sub(_across_diagonal, text)
    text = _ABSOLUTE.sub(r"then \g<part> is folded \g<place>", text)
    text = _CREASE_HALF.sub(r"fold \g<part> \g<place> half", text)
    text = _CREASE_THEN.sub(r"fold \g<part> \g<line>", text)
    text = _BEING.sub(r"\g<head> so that \g<part> is \g<does>", text)
    text = _RESPECTIVELY.sub(_respectively, text)
    text = _GAPPED.sub(r", then fold \g<part> onto ", text)
    text = _HAVING.sub(r"fold the \g<part> onto the \g<place>, then fold the \g<then> onto the \g<there>", text)
    text = _THIRDS.sub(_thirds, text)
    return _ITS_TIP.sub(r"\g<verb> so that its tip is to", text)


def _axis_across(which: str) -> str | None:
    """The midline through the middles of two edges: *left and right* gives the horizontal one."""
    if which in _LATERAL:
        return _LATERAL[which]
    return _ENDS.get(frozenset(_plain_side(side) for side in which.replace(" the ", " ").split(" and ")))


def _plain_side(side: str) -> str:
    return _SAME.get(side, side.removesuffix("-hand"))


def _midline(found: re.Match[str]) -> str:
    way = _axis_across(found["which"])
    if way is None:
        return found.group(0)
    bare = found.group(0).startswith(found["begin"])
    return f"{'along ' if bare else ''}the {way} midline"


def _bisector(found: re.Match[str]) -> str:
    """The perpendicular bisector of an edge runs between the edges beside it."""
    sides = {_plain_side(side) for side in re.findall(SIDE, found["which"])}
    if len(sides & {"left", "right"}) and len(sides & {"top", "bottom"}):
        return found.group(0)
    return "vertical midline" if sides & {"top", "bottom"} else "horizontal midline"


def _cut_corner(found: re.Match[str]) -> str:
    """A crease between the middles of two edges that meet lays their corner on the centre."""
    sides = {_plain_side(found["first"]), _plain_side(found["second"])}
    upright, across = sides & {"top", "bottom"}, sides & {"left", "right"}
    if not (upright and across):
        return found.group(0)
    return f"fold the {upright.pop()} {across.pop()} corner to the centre"


def _reflected(found: re.Match[str]) -> str:
    """*The left half is reflected across the vertical axis*: it comes to lie on the opposite half.

    What no single fold does, such as the left half across the horizontal axis, stays a word that is not understood.
    """
    before = found.string[: found.start()] if found["form"] else ""
    clause = _NEXT.split(before)[-1] + found["between"]
    if re.search(r"\bonto\b", clause):
        return found.group(0)
    sides = re.findall(r"\b(?:top|bottom|upper|lower|left|right)\b", clause)
    named = sides or _KNOWN_END.search(clause)
    if not named:
        return found.group(0)
    way = "vertical" if sides and sides[0] in ("left", "right") else "horizontal"
    other = found["way"] and found["way"].strip() != way
    if other or len(sides) > 1 or re.search(r"\b(?:corner|quarter|third|sleeve)s?\b", clause):
        return f"by reflection {found['between']}"
    return f"fold{found['form'] or ''}{found['between']} onto the opposite side"


def _across_diagonal(found: re.Match[str]) -> str:
    clause = re.split(r"[.,;]", found.string[: found.start()])[-1] + found["between"]
    if " corner" not in clause:
        return found.group(0)
    return f"fold{found['form'] or ''} {found['between']}onto the opposite corner"


def _respectively(found: re.Match[str]) -> str:
    noun = found["noun"]
    pairs = [[{_plain_side(side) for side in re.findall(SIDE, found[name])} for name in pair] for pair in ("ac", "bd")]
    edge = pairs[0][0] & pairs[1][0]
    if noun == "corner" and len(edge) == 1 and all(start - place == edge for start, place in pairs):
        return f"fold the {edge.pop()} edge onto the opposite edge"
    first = f"fold the {found['a']} {noun} onto the {found['c']} {noun}"
    return f"{first}, then fold the {found['b']} {noun} onto the {found['d']} {noun}"


def _thirds(found: re.Match[str]) -> str:
    """*Into thirds, first the cuffs up, then the waist down*: one third after the other."""
    rises = found["way"] == "up"
    if found.group(0).startswith("folded") or rises == (found["first"] in ("waist", "waistband", "top")):
        return found.group(0)
    first, second = ("bottom", "top") if rises else ("top", "bottom")
    return f", then fold the {first} third {found['way']}, then fold the {second} third over it"
