"""Terms of geometry and the plain words for them: vertices, bisectors, coincidence, participles of proofs."""

from __future__ import annotations

import re

SIDE = r"(?:top|bottom|upper|lower|left|right)(?:-hand)?"
SIDES = rf"{SIDE}(?:[ -]{SIDE})?"
NOUN = r"(?:corner|edge|side|half|leg|sleeve|border)"
BORDER = r"(?:edge|side|border)s?"
FOLDED = r"(?:folded|brought|laid|placed|carried|raised|lowered|moved|superimposed|taken|turned|put|reflected|mirrored)"
FINITE = r"(?:shall be|is to be|are to be|is|are|shall|should be|must be|being)"
LINE = r"(?:line|segment|straight line|line segment|crease|fold line)"
_JOINING = r"(?:joining|connecting|linking|through|between|that joins|that connects|passing through|running through)"
MIDPOINTS = rf"(?:{_JOINING} )(?:the )?mid-?points of (?:the |its |both )?"
AXIS = (
    r"(?:central |middle )?(?:axis(?: of symmetry)?|line of symmetry|symmetry axis|midline|mid-line|"
    r"cent(?:re|er) ?line|middle line|middle)"
)
ACROSS = r"(?:across|about|over|in|along|through|around)"
_WHEREUPON = r"(?:whereupon|following which|following that|after which|subsequent to which|whereafter)"
_WHOLE = r"(?:it|the (?:cloth|fabric|garment|shirt|square|rectangle))"

_WORDS: tuple[tuple[str, str], ...] = (
    (r"\bvertices\b|\bapices\b|\bapexes\b", "corners"),
    (r"\b(its|their) (?:vertex|corner|corners|apex)\b(?! onto| to\b)", r"\1 tip"),
    (r"\b(?:vertex|apex)\b", "corner"),
    (r"\bcentre of symmetry\b|\bcenter of symmetry\b", "centre"),
    (r"\b(vertical|horizontal) (?:bisector|mid-?axis|symmetry axis)\b", r"\1 midline"),
    (r"\b(?:isosceles|right-angled|congruent (?=halves|parts|halfs))\b ?", ""),
    (rf"\b{_WHEREUPON},? (?=(?:it|they|both) )", "so that "),
    (rf",? ?\b{_WHEREUPON}\b,?", ", then"),
    (r",? (?:whereby|thereby|thus) (?:the [a-z]+|it) (?:is|being) (?:halved|bisected)(?=[.;]|$)", ""),
    (r",? \bwhereby\b", " so that"),
    (r"\byielding\b", "forming"),
    (r"\b(?:its|the) antipode\b|\bthe antipodal corner\b", "the opposite corner"),
    (
        rf"\b({NOUN}s?) (?:(?:that|which) (?:is|are) )?(?:situated|located|positioned|lying|found) "
        r"(?=(?:at|in|on) the )",
        r"\1 ",
    ),
    (r"\b(line|axis|segment) (?:(?:that|which) is )?(?:defined|determined|given|spanned) by\b", "line joining"),
    (r"\b(?:is|are) congruent (?:with|to)\b", "coincides with"),
    (r"\b(half|edge|side|corner|leg) (?:beneath|underneath|below)(?=[.,;]|$)", r"\1"),
    (r"\btranslated?\b (?=(?:the |both |each |to |onto |on |into |so |such |inward))", "move "),
    (r"\b(?:to be )?made to coincide with\b", "to be folded onto"),
    (r"\babut (?:along|at|on|upon)\b", "meet at"),
    (
        r"\b(?:the |that )?(?:point|place)? ?(?:where|at which|in which) both diagonals (?:intersect|meet|cross)\b",
        "the centre",
    ),
    (r"\bpoint of intersection of (?:the|its|both|the two|its two) diagonals\b", "centre"),
    (r",? \b(?:creasing|folding) the (?:cloth|fabric|garment) accordingly\b", ""),
    (rf",? (?:thereby |thus )?(?:bisecting|halving) {_WHOLE}(?=[.;]|$)", ""),
    (rf", (?:a|one) (?:quarter|half) of {_WHOLE} being folded (?:over|in|inward)(?=[.;]|$)", ""),
    (
        r", (?:each|the|both) creases? (?:joining|connecting) the mid-?points of "
        r"(?:two |the )?(?:neighbouring|adjacent) sides",
        "",
    ),
    (
        r"\b(?:halved|bisected) (?:along|about|across) its "
        r"(?:altitude|height|median|bisector|(?:axis|line) of symmetry)\b",
        "halved",
    ),
    (r"\bin the same (?:direction|sense) (once more|once again|again)\b", r"\1"),
    (
        r",? and (?:the|this) (?:result|strip|package|resulting [a-z]+) is (?:halved|folded in half) "
        r"(?:once more|once again|again)(?: in the same (?:direction|manner|sense|way))?",
        ". then fold it in half again",
    ),
    (
        r"\bis (?:treated|handled|folded) (?:symmetrically|likewise|correspondingly|analogously)\b",
        "is folded the same way",
    ),
)
_STEPS: tuple[tuple[str, str], ...] = (
    (r"\b(?:both |the |two )*(?:the )?horizontal (edges|sides|borders)\b", r"the top and bottom \1"),
    (r"\b(?:both |the |two )*(?:the )?(?:vertical|lateral) (edges|sides|borders)\b", r"the left and right \1"),
    (
        r"\bthe (?:two )?legs (?:are|shall be|are to be) (?:superimposed|folded|laid|placed)"
        r"(?: on each other| together)?, "
        r"the (left|right)(?: leg)? (?:upon|on|onto|over) the (?:left|right)\b",
        r"the \1 leg is folded onto the other leg",
    ),
    (r",? ?\b(?:in succession|successively)\b|\bsuccessive (?=[a-z]+ folds)", ""),
    (rf"\b(?:in|of|at) the ({SIDES}) quadrant\b", r"at the \1"),
    (r"\b(?:to be )?(?:made|rendered) coincident with\b", "to be folded onto"),
    (rf", the ({SIDES})(?: {NOUN})? preceding the {SIDES}(?: {NOUN})?(?=[.;]|$)", r", the \1 one first"),
    (
        rf"\bthe [a-z]+ {FINITE} (?:then |subsequently |thereafter )?(?:divided|folded) into thirds, "
        rf"(?=the {SIDE} third)",
        "then ",
    ),
    (r"\bthird being (?=folded)", "third is "),
)
_RULES = tuple((re.compile(pattern), plain) for pattern, plain in (*_WORDS, *_STEPS))


def plain_terms(text: str) -> str:
    """The same instruction with every such term replaced; lower case is expected."""
    for pattern, plain in _RULES:
        text = pattern.sub(plain, text)
    return text
