"""Wishes in turns of phrase that are read only once the grammar of folds has given up: comparisons, manners, remarks.

They may use words of folding (*fold it twice, any way you like*) without taking a sentence from that grammar.
"""

from __future__ import annotations

import re

from polyfold_rules.wishes.wish import Bound, Wish
from polyfold_rules.wishes.wish_parts import SIDE
from polyfold_rules.wishes.wish_sizes import CLOTH, COUNTS, DIM, FRACTION, FRACTIONS, OF, QUANTITY, A, Reader, about

LESS = {
    "area": "smaller littler tinier",
    "width": "narrower slimmer thinner skinnier",
    "height": "lower flatter",
    "length": "shorter",
}
LESSER = {word: name for name, words in LESS.items() for word in words.split()}
MUCH = r"(?P<much>a lot |lots |much |way |far |considerably |significantly |clearly |a good deal |quite a bit )?"
SLIGHT = r"(?P<slight>a bit |a little(?: bit)? |slightly |somewhat |a touch |a tad |a shade |just a bit |some )?"
IT = r"(?:it|them|this|these|that|those|(?:the|my|our|his|her|your) \w+)"
WANT = r"(?:want|need|like|wish|would like|have|care for)"
TIMES = rf"(?P<times>once|twice|thrice|(?:\d+|{'|'.join(COUNTS)}) (?:times|x))"
PALM = (
    r"(?:smart ?phone|phone|mobile|palm|hand|wallet|playing card|credit card|bar of soap|soap|passport|coaster"
    r"|cup|mug"
    r"|fist|matchbox|deck of cards|beer mat|saucer|purse|post ?card|cd|sandwich)"
)
BOOKISH = (
    r"(?:book|paperback|magazine|laptop|tablet|pillow|shoe ?box|sheet of paper|piece of paper|page|a4(?: sheet"
    r"| page)?"
    r"|folder|dinner plate|plate|pizza box|brick|newspaper|cushion|lunch ?box)"
)
RELATIVE = r"(?:mum|mom|mother|dad|father|gran|grandma|grandmother|nan|granny|wife|husband|aunt|partner|sister|brother)"


def _lesser(quantity: str, match: re.Match[str]) -> Bound:
    """Less of a quantity, without a measure: about half, and a quarter off if it is to be slight."""
    said = match.groupdict()
    if said.get("slight"):
        return Bound(quantity, 0.55, 0.93, 0.75)
    return Bound(quantity, 0.1, 0.56, 0.5) if said.get("much") else Bound(quantity, 0.3, 0.85, 0.5)


def _less(wish: Wish, match: re.Match[str]) -> None:
    quantity = LESSER[match.group("less")]
    if quantity == "area" and not match.group("slight"):
        wish.small = True
    else:
        wish.bounds.append(_lesser(quantity, match))


def _not_so(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(_lesser(QUANTITY[match.group("dim")], match))


def _not_so_big(wish: Wish, match: re.Match[str]) -> None:
    wish.small = True


def _short(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(Bound("length", 0.3, 0.85, 0.5))


def _count(said: str) -> int:
    number = said.split()[0]
    return {"once": 1, "twice": 2, "thrice": 3}.get(number) or (int(number) if number.isdigit() else COUNTS[number])


def _times_less(wish: Wish, match: re.Match[str]) -> None:
    quantity = QUANTITY.get(match.groupdict().get("dim") or "", "area")
    wish.bounds.append(about(quantity, 1 / max(_count(match.group("times")), 1)))


def _folded_times(wish: Wish, match: re.Match[str]) -> None:
    times = _count(match.group("times"))
    loose = re.search(r"most|more|up to|max", match.group(0))
    wish.steps = (1 if loose else times, times)


def _more_than_once(wish: Wish, match: re.Match[str]) -> None:
    wish.steps = (2, 9)


def _parts_of(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", FRACTIONS[{"halves": "half"}.get(match.group("part"), match.group("part")[:-1])]))


def _equal_parts(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", 1 / max(_count(match.group("times")), 1)))


def _share(wish: Wish, match: re.Match[str]) -> None:
    said = match.group("share")
    share = int(said[:2]) / 100 if said[0].isdigit() else FRACTIONS[said]
    wish.bounds.append(about(QUANTITY.get(match.groupdict().get("dim") or "", "area"), share))


def _no_more(wish: Wish, match: re.Match[str]) -> None:
    said = match.group("share")
    share = int(said[:2]) / 100 if said[0].isdigit() else FRACTIONS[said]
    wish.bounds.append(Bound(QUANTITY.get(match.groupdict().get("dim") or "", "area"), high=share * 1.15))


def _share_halved(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about(QUANTITY[match.group("dim")], 1 / 2))


def _doubled(wish: Wish, match: re.Match[str]) -> None:
    wish.bounds.append(about("area", 1 / 2))


def _proportioned(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("rectangle")
    wish.bounds.append(about("slim", 1 / max(_count(match.group("times")), 1)))


def _even_sided(wish: Wish, match: re.Match[str]) -> None:
    wish.shapes.append("square")


def _hides(wish: Wish, match: re.Match[str]) -> None:
    side = match.groupdict().get("side")
    wish.hidden |= {side} if side else {"left", "right"}


def _one_sleeve(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("onesleeve")


def _one_corner(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("dogear")


def _pointed(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("arrow")
    wish.points = {"upper": "top", "lower": "bottom"}.get(match.group("side"), match.group("side"))


def _stacked(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("pile")


def _filed(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("pile")
    wish.bounds.append(Bound("area", high=0.36))


def _tidy(wish: Wish, match: re.Match[str]) -> None:
    wish.tidy = True


def _hand_sized(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("pocket")


def _hung(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("hang")


def _in_three(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("letter")


def _shortened(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("shorts")


def _legs_together(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("oneleg")


def _indifferent(wish: Wish, match: re.Match[str]) -> None:
    wish.tidy = True


def _smallest(wish: Wish, match: re.Match[str]) -> None:
    wish.small = wish.least = True


def _nothing(wish: Wish, match: re.Match[str]) -> None:
    """Words that make no difference to the end."""


SIZE_IDIOMS: list[tuple[str, Reader]] = [
    (rf"^(?:just |only |to |by |about )*{FRACTION}(?: size| the size)?(?=(?:,? please)?[ .!?]*$)", _share),
    (rf"(?:cut|cutting|bring|brought|chop|divide|slash)(?: down)? {OF}{DIM} (?:down )?(?:in|by|into) (?:half|two)",
     _share_halved),
    (r"not (?:take up|takes up|fill|cover|occupy|need|use|hog|clutter)(?: up)? (?:(?:the|an|so|my|our|your|as"
     r"|too|that|a) )*"
     r"(?:entire|whole|full|all of|all|much|half)(?: of)?(?: (?:the|my|our))?(?: \w+)?", _not_so_big),
    (rf"{MUCH}{SLIGHT}(?P<less>{'|'.join(LESSER)})(?: than (?:before|now|it (?:is|was)|they (?:are|were)|that|this)"
     r"(?: now)?)?", _less),
    (rf"{MUCH}{SLIGHT}less (?P<dim>wide|broad|high|tall|long)", _not_so),
    (r"(?:much |a lot |far )?less (?:big|large|bulky|space|room)", _not_so_big),
    (r"(?:not|never|no)(?: be)? (?:(?:quite )?(?:so|as|that|too)|very) (?P<dim>wide|broad|high|tall|long)", _not_so),
    (r"(?:not|never|no)(?: be)? (?:(?:quite )?(?:so|as|that|too)|very) (?:big|large|bulky|huge|much (?:space|room))",
     _not_so_big),
    (rf"(?P<much>far |way |much )?{SLIGHT}too (?P<dim>wide|broad|high|tall|long)(?: (?:for|as) (?:it"
     rf"|they) (?:is|are))?",
     _not_so),
    (r"(?:far |way |much |a bit |a little |slightly )?too (?:big|large|bulky|huge|much (?:space|room))", _not_so_big),
    (r"(?:short(?:en(?:ed)?)?|low)(?: in length)?", _short),
    (rf"{TIMES} (?:as (?=small|narrow|short|compact|slim)|less )(?P<dim>small|narrow|short|compact|slim|long"
     rf"|wide|big|large)"
     r"(?: as (?:before|now|it (?:is|was)|they (?:are|were)))?", _times_less),
    (rf"(?:by )?a factor of (?P<times>\d+|{'|'.join(COUNTS)})", _times_less),
    (r"(?:in|into|to) (?P<part>halves|thirds|quarters|fourths|fifths|sixths|eighths|ninths|sixteenths)", _parts_of),
    (rf"(?:in|into|of) (?P<times>\d+|{'|'.join(COUNTS)})(?: (?:equal|even|same sized|identical|equally large))?"
     r"(?: (?:parts?|pieces|portions|sections|fields))?(?= ?[.,;!?]|$)", _equal_parts),
    (rf"(?:fold(?:ed|ing)? (?:{IT} )?(?:up |over )?|not (?:want to )?fold {IT} )?(?:only |just |exactly |precisely |"
     rf"more than |at most |no more than |not more than |up to |maximum )*{TIMES}(?! more| again)(?: (?:over|only"
     rf"|at (?:the )?most|max|"
     r"folded))?", _folded_times),
    (r"(?:smaller )?(?:one )?than (?:(?:you|one|we|i) (?:get|have|has|make|would get|gets) )?(?:in|with|after"
     r"|by|from) "
     r"(?:only |just |a |one |single )*fold(?:ing)?(?: once)?", _more_than_once),
    (r"more than (?:once|one fold|a single fold)|several (?:times|folds)|a (?:few|couple of) (?:times|folds)",
     _more_than_once),
    (rf"not (?:{WANT} )?(?:{IT} )?(?:to )?(?:be |get |cover |take up |show |see |occupy )?(?:any )?"
     rf"(?:more|larger|bigger|wider|longer|higher|taller) than {A}{FRACTION}(?: of)?(?: ?{OF}{DIM})?"
     rf"(?: ?{OF}{CLOTH})?", _no_more),
    (rf"(?:cover|covers|covering|fill|fills|take up|takes up|occupy|occupies|use|uses)(?: only| just| about)* "
     rf"{A}{FRACTION}(?: of)?(?: (?:the|my|our|its|a) (?:table|bed|tray|sofa|couch|bench|window|box|basket"
     rf"|mattress|shelf|drawer|counter|space|room|place"
     rf"|worktop|desk)"
     r"(?: top| it (?:does|has|takes)(?: now)?)?)?", _share),
    (rf"{A}{FRACTION} of (?:its|their|the) (?:{OF})?{DIM}(?: {CLOTH})?", _share),
    (r"(?:folded )?(?:double|doubled)(?: over| up| layered)?|two ply|in two", _doubled),
    (rf"{TIMES} as (?:long|tall|high|wide|broad) as (?:it is |they are )?(?:wide|broad|high|tall|long|deep)",
     _proportioned),
    (r"as (?:wide|broad|long|high|tall) as (?:it is )?(?:wide|broad|long|high|tall)|(?:all (?:four )?)?(?:its |the )?"
     r"sides (?:are |should be |all )*(?:equal|equally long|the same|the same length|of equal length)|equal sides|"
     r"equal sided", _even_sided),
    (rf"(?:about |roughly |around |no (?:bigger|larger) than |not (?:bigger|larger) than |smaller than "
     rf"|as (?:small|big|"
     rf"large) as |(?:the |of )*size of |into )+(?:a |an |my |your |his |her |the )(?:\w+ )?{PALM}|(?:{PALM}"
     rf"|pocket|palm|"
     r"hand|wallet) sized?", _hand_sized),
    (rf"(?:about |roughly |around |no (?:bigger|larger) than |not (?:bigger|larger) than |smaller than "
     rf"|as (?:small|big|"
     rf"large) as |(?:the |of )*size of )+(?:a |an |my |your |his |her |the )(?:\w+ )?{BOOKISH}|{BOOKISH} sized?",
     _stacked),
    (r"(?:as|the) (?:small|tiny|compact|little|dense|tight)(?:est|ly)?(?: and \w+)? (?:as"
     r"|that)? ?(?:ever )?(?:you can|"
     r"can be|possible|it (?:gets|goes|can be|will go)|they (?:get|go|can be|will go)|you (?:get|manage|are able to))"
     r"(?: (?:make it|make them|get it|get them|manage|go|be))?|(?:maximally|extremely|super|ultra) (?:small"
     r"|compact)",
     _smallest),
]  # fmt: skip

PART_IDIOMS: list[tuple[str, Reader]] = [
    (r"(?:the |its |both |those |these |my |no )*(?:(?P<side>left|right) )?(?:sleeves?|arms?) (?:do|does|will"
     r"|would|may|can"
     r"|should|must) (?:not |no longer )(?:be )?(?:show|shown|showing|seen|visible|stick out|appear|hang out"
     r"|poke out|peek out)"
     r"(?: out)?", _hides),
    (r"(?:the |its |their |both )*(?:trouser |pant )?legs? (?:should |must |to |be |are |is |have |need |a bit "
     r"|a lot |much |"
     r"way |far |too |half (?:as )?)*(?:shorter|shortened|short|too long|long)", _shortened),
    (r"(?:(?:nobody|no one|noone|none) (?:should |must |may |can |will |is to |has to |needs to |wants to |would )*"
     r"(?:see|notice|spot|look at|be able to see)|(?:conceal|concealing|cover up|covering up|put away|tuck away"
     r"|clear away|"
     r"do away with|not have|not want|not need|not like|away with|minus|free of|rid of)) (?:the |its |any "
     r"|both |of |my |"
     r"those |these |her |his )*(?:(?P<side>left|right) )?(?:sleeves?|arms?)(?: any ?more| anywhere| at all"
     r"| hanging out|"
     r" sticking out| dangling)*(?! (?:to be |be )?(?:folded|tucked|moved|touched|turned|bent|creased|in)\b)",
     _hides),
    (r"(?:the |its |both |those |these |my )*(?:(?P<side>left|right) )?(?:sleeves?|arms?) (?:should |must |may "
     r"|can |are |"
     r"is |be |to |get |have |has |need |needs |want |only |just )*(?:not stick(?:ing)? out|in the way|annoying"
     r"|concealed|"
     r"covered(?: up)?|nowhere to be seen|not (?:hang|dangle|flap)(?:ing)?(?: out| about| around)?|put away|inside)",
     _hides),
    (r"(?:just |only |exactly |simply )*(?:one|a single|either|any one|any)(?: of the| of its)? (?:sleeves?|arms?) "
     r"(?:folded |tucked |turned |put |to be |should be |should |must |be |to |go |is )*(?:in|away|inside|gone"
     r"|hidden|over|"
     r"missing|off)", _one_sleeve),
    (r"(?:just |only |exactly |simply )*(?:one|a single|any one|any|a)(?: of the"
     r"| of its)?(?: four)? corners? (?:folded |"
     r"tucked |turned |put |to be |should be |should |must |be |to |go |is |bent )*(?:in|away|inside|gone"
     r"|hidden|missing|"
     r"off|down|cut off|snipped off)|dog ?eared?(?: page)?", _one_corner),
    (rf"(?:the |its |at the |a )*(?P<side>{SIDE})(?: of it| of the \w+| end| edge| side| part)? (?:should "
     rf"|must |is to |to "
     r"|ought to |can |be |look |looks |looking |like |come |comes |end |ends |run |runs |have |has |form "
     r"|forms |in |into |a "
     r"|an |the )+(?:roof(?: of a (?:house|barn|hut))?|pointy|pointed|point|tip|gable|arrow(?:head)?|peak"
     r"|spike)", _pointed),
    (r"(?:one|either) leg (?:lying |laid |should be |should lie |is |placed )*(?:on top of|over|onto|on"
     r"|covering) the other"
     r"|(?:the |both )*legs (?:lying |should |lie |be |are |go |laid )*(?:together|on top of (?:each other"
     r"|one another))",
     _legs_together),
    (r"(?:the |their |its |both )*(?:legs?|cuffs?|hems?|bottoms?|ends?) (?:are |is |should |must |may |can |do "
     r"|does |would |"
     r"not |keep |always |just )*(?:drag|drags|dragging|trail|trails|trailing|touch|touching|on|reach|hanging"
     r"|hang)(?: on| "
     r"along| over| down to| in)? the (?:floor|ground|carpet|mud|dirt)", _nothing),
]  # fmt: skip

MANNERS: list[tuple[str, Reader]] = [
    (r"(?:looks?|looking|lies?|lying|sits?|fits?|stays?|rests?) (?:\w+ )?(?:on|onto) (?:the|my|our|a|his"
     r"|her)", _nothing),
    (r"fancy|elegant(?:ly)?|pretty|prettily|beautiful(?:ly)?|decorative(?:ly)?|festive(?:ly)?|smart(?:ly)?|posh"
     r"|classy|"
     r"stylish(?:ly)?|professional(?:ly)?|crisp(?:ly)?|like new|well", _tidy),
    (r"(?:like |the way |as |just like )?(?:marie )?kondo(?: (?:would|does|do|did|style|method|way|folds?|it|them))*|"
     r"kon ?mari(?: (?:style|method|way|fold|it))*|(?:file|filed|filing) (?:fold(?:ed)? )?(?:it|them)?(?: ?upright)?|"
     r"(?:stands?|standing|stood|stand) (?:it |them )?(?:up|upright|on (?:its|their) own|alone)(?: (?:in"
     r"|by itself|by "
     r"themselves|on (?:its|their) own))?", _filed),
    (r"(?:stack(?:able|ed|s|ing)?|pil(?:e|ed|es|ing)(?: up)?) ?(?:well|nicely|easily|it|them)?", _stacked),
    (r"(?:(?:together )?with|on top of|on|onto|among|between|next to|beside|to|like) (?:all )?(?:of )?(?:the "
     r"|my |our |his "
     r"|her |their |your )?(?:other|others|rest(?: of (?:the|my|our|his|her|your))?)(?: \w+)?(?= ?[.,;!?]|$| on| in)",
     _stacked),
    (r"(?:like|as|the way)(?: (?:that|in which))? (?:they|you|people|we|shops?|stores?|hotels?|staff"
     r"|sellers)?(?: (?:do|does"
     r"|did|have|see|would|fold|get|find|sell|is done|are folded|usually|always|normally))*(?: (?:it|them|this"
     r"|that))? ?(?:in|"
     r"at) (?:the |a |an )?(?:\w+ ){0,2}(?:shops?|stores?|hotels?|spas?|boutiques?|malls?|outlets?|gap|uniqlo"
     r"|levi|zara|"
     r"h ?& ?m|department stores?)", _stacked),
    (rf"(?:like|as|the way) (?:my |your |a |his |her )?{RELATIVE} (?:does|did|do|used to|would|always did"
     rf"|always does|taught "
     r"me|folds)(?: (?:do|fold))?(?: (?:it|them|that))?", _tidy),
    (r"(?:nice|nicely|tidy|tidily|neat|neatly|orderly|clean|cleanly|proper|properly|presentable|respectable"
     r"|spick and span"
     r"|in order|not messy|not a mess|less messy)", _tidy),
    (r"(?:hangs?|hung|hanging|drapes?|draped|goes|go|fits?|slung) (?:it |them |this )?(?:neatly |nicely "
     r"|well )?(?:over|on|onto|from|across|off|to) (?:the |a |my |our |its )*(?:\w+ )?(?:towel |clothes |coat "
     r"|curtain )?(?:rail|rack|"
     r"hanger|hook|line|rod|bar|peg|chair|railing|banister|radiator|airer)", _hung),
    (r"(?:with |in |of |into |has |have |having )*(?:three|3) (?:equal )?(?:panels?|panes?|columns?|segments?"
     r"|leaves)|tri ?fold"
     r"(?:ed)?(?: (?:brochure|flyer|leaflet))?", _in_three),
    (r"(?:a )?crop(?:ped)?(?: length| top)?|knee ?length|short legs|hot ?pants|cut ?offs", _shortened),
]  # fmt: skip

ASIDES: list[tuple[str, Reader]] = [
    (r"i (?:really )?(?:hope|think|believe|guess|suppose|bet|trust|know)(?: that)?(?: (?:you|it)(?: can| could"
     r"| will)?)?",
     _nothing),
    (r"i (?:do not|would not|never) (?:like|want) (?:it|them|that|this)(?: to)? (?:stick|hang|dangle|flap"
     r"|drag)(?:ing)?"
     r"(?: out| around| down| about)?", _nothing),
    (r"(?:i|we|it|that)(?: really| honestly)? (?:do|does) not (?:care|mind|matter)(?: much"
     r"| at all)?(?: (?:to me|about))?"
     r"(?: (?:which|how|what|where|who|in which way|whether))?(?: (?:one|ones|way|side|sleeve|leg|corner|half"
     r"|edge|direction|"
     r"you (?:do|take|choose|pick|fold|get there|go about|manage))(?: it| that)?)*", _indifferent),
    (r"(?:any|either)(?: (?:one|way|side|which way|method))?(?: (?:will|would|is|you) (?:do|ok|okay|fine|like"
     r"|want|please))?"
     r"(?: really)?(?= ?[.,;!?]|$| as )", _indifferent),
    (r"(?:do |in |fold it |fold them |fold this )?(?:whatever|however|whichever|any|anyhow|as|how"
     r"|what)(?: way)? (?:you|works|"
     r"it takes)(?: (?:want|like|please|wish|prefer|think(?: is)?|feel|see fit|choose|best|fit|fancy|can"
     r"|think best))*"
     r"(?: (?:with|to) (?:it|them|this))?", _indifferent),
    (r"(?:i )?(?:will |shall )?(?:leave|leaving) (?:it|that|the \w+)(?: all)? (?:up )?to you|(?:it is "
     r"|that is )?(?:all )?up to "
     r"you|your (?:choice|call|decision)|you (?:choose|decide|pick)|no preference|surprise me|be creative|feel free|"
     r"somehow|no matter (?:how|which|what)(?: way)?|regardless how|in (?:some|any|whatever) way", _indifferent),
    (r"(?:as|so) long as|provided(?: that)?|on condition that|the main thing is(?: that)?|all (?:that matters"
     r"|i (?:want|ask|need)"
     r")(?: is(?: that)?)?|what matters is(?: that)?|the important thing is(?: that)?|if at all possible"
     r"|if possible|if you can",
     _nothing),
    (r"(?:i )?(?:was |am )?(?:just )?wondering (?:if|whether) (?:you|it)(?: could| can| might| would)*|(?:is"
     r"|would) it be possible"
     r"(?: to| that you)?|(?:is|would) (?:there|it be)(?: any)? (?:way|chance|possibility)(?: (?:to|you could"
     r"|you can|of))?|any "
     r"chance(?: (?:you could|you can|of))?|do me a favou?r(?: and)?|be so (?:kind|good)(?: as to| and)?"
     r"|how about|what about|"
     r"go ahead(?: and)?|(?:i )?would (?:really )?(?:appreciate|be (?:glad|grateful|happy"
     r"|great))(?: it)?(?: if)?|see (?:if|whether)"
     r" you can|try (?:to|and)|would you mind", _nothing),
    (r"(?:like (?:this|that)|as (?:it|they) (?:is|are|was|were)|the way (?:it|they) (?:is|are)|right now"
     r"|at the moment|at "
     r"present|currently|nowadays|than that|than this)", _nothing),
]  # fmt: skip

IDIOMS: list[tuple[str, Reader]] = SIZE_IDIOMS + PART_IDIOMS + MANNERS + ASIDES
