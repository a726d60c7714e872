"""What a wish says of parts that vanish or stay, places, directions and looks: patterns, and what each means."""

from __future__ import annotations

import re

from polyfold_rules.wishes.readers import Reader, hides, nothing, one_sleeve, shortened, stacked
from polyfold_rules.wishes.sizes import DIM, about
from polyfold_rules.wishes.wish import Wish

SIDE = r"(?:top|bottom|left|right|upper|lower)"
EDGES = {"upper": "top", "lower": "bottom", "waistband": "top", "waist": "top", "collar": "top", "neck": "top",
         "hem": "bottom", "shoulders": "top", "ankles": "bottom"}  # fmt: skip
KEPT = rf"(?P<kept>(?:{SIDE})(?: edge| side| border)?|waistband|waist|collar|hem|shoulders)"
GONE = (
    r"(?:not (?:be )?(?:seen|show|visible|shown|showing)|gone|disappear|vanish|hidden|invisible|tucked away|"
    r"out of (?:sight|the way|view))"
)
DAMAGED = r"(?:(?:is |has )?(?:torn|ripped|stained|dirty|frayed|spotted|worn out|damaged|faded|burnt|singed|marked))"
FLAW = r"(?:stain|spot|blot|hole|tear|mark|burn|patch|scorch mark|fault|flaw|rip)"
CORNER = r"(?P<corner>(?:top|bottom|upper|lower) (?:left|right))"
UNSEEN = r"(?:hide|hiding|lose|without|no|not want to see|not see|remove|get rid of|nothing of|rid of)"


def _body_wide(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden |= {"left", "right"}


def _gate(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("gate")


def _only_sleeve(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden |= {"left", "right"} - {match.group("one") or match.group("other")}


def _hides_corner(wish: Wish, match: re.Match[str]) -> None:
    wish.hidden.add("_".join(EDGES.get(word, word) for word in match.group("corner").split()[:2]))


def _keeps(wish: Wish, match: re.Match[str]) -> None:
    first = match.group("kept").split()[0]
    wish.kept.add(EDGES.get(first, first))


def _lies(wish: Wish, match: re.Match[str]) -> None:
    wish.lies |= {EDGES.get(word, word) for word in match.group("place").split()}


def _frees(wish: Wish, match: re.Match[str]) -> None:
    opposite = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}
    side = EDGES.get(match.group("place"), match.group("place"))
    wish.lies.add(opposite[side])
    wish.bounds.append(about("width" if side in ("left", "right") else "height", 1 / 2))


def _points(wish: Wish, match: re.Match[str]) -> None:
    word = match.group("place") or match.groupdict().get("at", "")
    wish.points = {
        "up": "top",
        "upwards": "top",
        "upward": "top",
        "down": "bottom",
        "downwards": "bottom",
        "downward": "bottom",
    }.get(word, EDGES.get(word, word))


def _shows(wish: Wish, match: re.Match[str]) -> None:
    """Only a part is seen: the cloth lies where that part was."""
    sides = [EDGES.get(word, word) for word in match.group("place").split()]
    wish.lies |= set(sides)
    across = "width" if sides[0] in ("left", "right") else "height"
    wish.bounds.append(about("area" if len(sides) > 1 else across, 1 / 2))


def _quarter_place(wish: Wish, match: re.Match[str]) -> None:
    _lies(wish, match)
    wish.bounds += [about("width", 1 / 2), about("height", 1 / 2)]


def _pulled_up(wish: Wish, match: re.Match[str]) -> None:
    wish.lies.add("top")
    wish.bounds.append(about("height", 1 / 2))


def _rectangular(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("rectangle")


def _three_cornered(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("triangle")


def _mirrored(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("mirrored")


def _print_inside(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("book")


def _hexagon(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("hexagon")


PARTS: list[tuple[str, Reader]] = [
    (r"(?:no|not) (?:wider|broader) than (?:its|the) (?:body|torso|trunk|chest)", _body_wide),
    (r"as (?:wide|narrow) as (?:its|the) (?:body|torso|trunk|chest)", _body_wide),
    (rf"{UNSEEN} (?:the |its |any |both |of )*(?:(?P<side>left|right) )?(?:sleeves?|arms?)(?: any ?more| showing| "
     rf"sticking out)*",
     hides),
    (rf"(?:the |its |both )*(?:(?P<side>left|right) )?(?:sleeves?|arms?) (?:{DAMAGED} (?:and |so |it )*|is |are |"
     rf"should |must |may |can |be |to |has |have )*{GONE}", hides),
    (r"(?:the )?(?P<one>left|right) sleeve only|(?:only|nothing but) (?:the |its |a )?"
     r"(?P<other>left|right) (?:sleeve|arm)", _only_sleeve),
    (rf"{UNSEEN} (?:the |its )?(?P<corner>(?:top|bottom|upper|lower) (?:left|right)) corner(?: any ?more)?",
     _hides_corner),
    (rf"(?:the )?(?P<corner>(?:top|bottom|upper|lower) (?:left|right)) corner (?:{DAMAGED} (?:and |so |it )*|is |"
     rf"should |must |may |can |be |to |has )*{GONE}",
     _hides_corner),
    (rf"(?:leave|leaving|keep|keeping) (?:the |its )?{KEPT}(?: where it (?:is|was)| in place| as it is| still"
     rf"| where they are)?", _keeps),
    (rf"(?:the |its )?{KEPT} (?:should |must |can |has to |to )*(?:stays?|staying|remains?)(?: where it is| in place"
     rf"| still| put| as it is)?", _keeps),
    (rf"(?:covers?|covering|fills?|on|occup(?:y|ies)|takes? up) (?:only |just )?the "
     rf"(?P<place>{SIDE}(?: {SIDE})?)(?: half| part| side)", _lies),
    (rf"(?:with |and )?(?:its |the |a )?right angle (?:should |to |must )?(?:be |is |lies |lie |sits )?"
     rf"(?:at|in|on) the (?P<place>{SIDE} {SIDE})(?: corner)?", _lies),
    (rf"(?:need|want|free|clear|use|have|get)(?: up)? the (?P<place>{SIDE}) half (?:of the table )?"
     rf"(?:back|free|empty|clear|for something else)", _frees),
    (rf"(?:that |which |it |is |the |tip |apex |should )*(?:points?|pointed|pointing|facing|faces) "
     rf"(?:to(?:wards?)? |at )?(?:the )?(?P<place>{SIDE}|up|down|upwards?|downwards?)", _points),
    (r"(?:that |which )?(?:meet|meets|meeting|touch|touching) (?:in|across|along|at|over) (?:the|its) (?:middle|"
     r"centre)"
     r"(?: of (?:a|the) window)?", _gate),
    (r"(?:the |its )?(?:collar|neck|print|logo|front) (?:on top|facing up|visible|showing|up)", nothing),
    (r"(?:all )?(?:four |the )*(?:points|corners|tips) (?:meet|meeting|meet up|touching)(?: in the (?:middle|"
     r"centre))?",
     nothing),
    (r"(?:leave |keep )?(?:all )?the (?:rest|others?) (?:as (?:it is|they are)|untouched|alone)", nothing),
    (r"(?:and )?(?:nothing else|no other fold)|the sleeves (?:may|can) stick out|as if (?:it|they) had", nothing),
    (r"i do not (?:mind|care) (?:how|which|where)|(?:no|does not|do not|never) (?:matter|mind) how", nothing),
    (rf"(?:however|no matter how|never mind how) {DIM}|across the (?:hips|seat|waist|chest|shoulders)", nothing),
    (rf"(?:there (?:is )?)?(?:an? )?(?:\w+ )?{FLAW} (?:is )?(?:in|on|at) the {CORNER} corner"
     r"(?: (?:that|which) (?:\w+ )?(?:must|should|may) not (?:see|be seen|show))?", _hides_corner),
    (rf"(?:a |the )?(?:page with a )?(?:dog ?ear|turned down corner) (?:at|in|on) the {CORNER}(?: "
     rf"corner)?", _hides_corner),
    (rf"(?:one|a) corner (?:is )?{DAMAGED},? (?:namely )?the {CORNER} one", _hides_corner),
    (rf"the {CORNER} corner (?:is )?{DAMAGED}", _hides_corner),
    (rf"(?:only|nothing but) the (?P<place>{SIDE}(?: {SIDE})?) (?:half|leg|side|part|triangle)(?: of (?:the|my|"
     rf"its|it|this) ?\w*)?"
     r"(?: (?:should|must|may|can|is to|to))?(?: (?:be|remain|stay))?(?: (?:seen|visible|showing|show|shown|"
     r"left))", _shows),
    (rf"(?:only |just )?(?:covers?|fills?|on|in|inside|within|occup(?:y|ies)|takes? up) (?:only |just )?(?:the |its )"
     rf"(?P<place>{SIDE} {SIDE}) quarter(?: of where it (?:lies|is)(?: now)?)?(?: and no more| "
     rf"only)?", _quarter_place),
    (rf"(?:only |just )?(?:covers?|covering|fills?|occup(?:y|ies)|takes? up) (?:only |just )?its (?P<place>{SIDE})"
     rf"(?: half| part| side)", _shows),
    (rf"the (?P<place>{SIDE}) (?:half|side|part) of (?:the|my|our) \w+ (?:must |should |has to |have to |needs to "
     rf"|is to |shall )*"
     r"(?:be |stay |remain |is )*(?:free|empty|clear|vacant|unoccupied)(?: of (?:\w+))?", _frees),
    (rf"nothing (?:of \w+ \w+ )?(?:should |must |may |is to )*(?:remain|be|stay|lie|be left)(?: left)? (?:in|on) "
     rf"the (?P<place>{SIDE}) "
     r"(?:half|side|part)(?: of (?:the|my) \w+)?", _frees),
    (rf"(?:the )?(?:space|room|place|side) (?:on|at) the (?P<place>{SIDE}) (?:is )?(?:taken|occupied|needed|"
     rf"used)", _frees),
    (rf"(?:without|with no) (?:moving )?(?:the |its ){KEPT}(?: (?:going anywhere|moving|being moved|leaving its "
     rf"place))?", _keeps),
    (r"(?:that |was |were )*(?:pulled|drawn|rolled|raised) up half ?(?:way)?", _pulled_up),
    (r"(?:the |its )?(?:longest|long) (?:side|edge) (?:facing|towards|at|on) the (?:(?:bottom|lower|top|upper) )?"
     r"(?:left|right)(?: corner)?"
     r"|(?:flat|straight) on one side|a tip on the other", nothing),
    (rf"(?:that |which )?(?:shows?|directs?) (?:to )?(?:the )?(?P<place>{SIDE})|(?:nose|tip|point|apex) (?:is )?"
     rf"(?:at|to) the (?P<at>{SIDE})", _points),
    (r"(?:the |its |their |all |with |square |have |has |only )*(?:right angles|right angled|square corners|"
     r"straight edges|four straight edges|straight sides)"
     r"(?: all (?:a?round|over))?", _rectangular),
    (r"(?:both )?(?:the |its )?sides (?:running |run |are |going )?straight(?: (?:down )?from (?:the )?shoulders? "
     r"to (?:the )?hem)?", nothing),
    (r"one (?:armed|sleeved)(?: \w+)?,? ?(?:never mind|no matter|i do not (?:care|mind)) which(?: \w+)?|one "
     r"(?:armed|sleeved)", one_sleeve),
    (r"(?:the )?(?:other|right|left) (?:one|sleeve|arm) (?:may|can)(?: (?:stay|show|remain|be seen))?", nothing),
    (r"(?:the |its |their |whose )*(?:cuffs|ankles|hems?|leg ends) (?:are to |should |that )*(?:reach|meet|touch|"
     r"at|on)(?:es|ing)? (?:the |their )?"
     r"(?:belt|waist|waistband|shoulders?)", shortened),
    (r"(?:bares?|shows?|baring|showing|reveals?) (?:the |my |your )?(?:midriff|belly|navel|tummy)|(?:just )?"
     r"(?:above|down to|to) the knees?"
     r"|knee length|knee long", shortened),
    (r"(?:their |its |the |both |two )*(?:mirrored|mirror|matching|symmetric|symmetrical) halves (?:belong |lie |"
     r"lying |should |be |are |placed )*"
     r"(?:on|onto|over) (?:one another|each other|one)|left and right (?:are |halves |lying |lie |placed )*(?:on|"
     r"over|onto) "
     r"(?:one another|each other|top of each other)|(?:a )?butterfly(?: that| which)?(?: has| with)? (?:closed|"
     r"folded|shut) (?:its )?wings", _mirrored),
    (r"(?:their |the |its )?handles (?:are )?(?:side by side|next to each other|touching)(?: (?:at|in|along) the "
     r"(?:centre|middle)(?: line)?)?", nothing),
    (r"without (?:any )?(?:scissors|cutting)(?: of course)?|(?:of course|that is all|no more no fewer|no more,? "
     r"no less|no more,? no fewer)", nothing),
    (r"(?:change|changing|fold|touch) as little as possible|(?:whichever|whatever|any) way(?: you like)?|as you "
     r"(?:like|please)", nothing),
    (r"(?:the )?(?:collar|neck|neckline|print|logo|front) (?:facing|towards|to) (?:the |its )?\w+", nothing),
    (r"(?:the )?(?:print|logo|picture|pattern)(?: on the (?:chest|front))? (?:should |must |had |better |has to |"
     r"is to |be |lie |lies )*"
     r"(?:inside|protected|covered)", _print_inside),
    (r"(?:stands?|standing) (?:it |them )?(?:upright|on edge|on (?:its|their) edge)(?: in)?", stacked),
    (r"(?:its |the |all )?(?:four )?(?:points|corners|tips) (?:are |lying |lie )?(?:at|on) the (?:middles|"
     r"midpoints|centres) of the "
     r"(?:old |former |original |four |flat )?(?:edges|sides)", nothing),
    (r"six (?:sides|sided|corners|cornered)|hexagon|hexagonal", _hexagon),
    (r"(?:three|3) (?:cornered|corners|sided|sides|points|pointed|angled)", _three_cornered),
]  # fmt: skip
"""Patterns of parts, places and directions."""
