"""Manners in turns of phrase that are read only once the grammar of folds has given up, and remarks on the side.

They may use words of folding (*fold it any way you like*) without taking a sentence from that grammar.
"""

from __future__ import annotations

import re

from polyfold_rules.wishes.readers import Reader, nothing, shortened, stacked, tidy
from polyfold_rules.wishes.wish import Bound, Wish

RELATIVE = r"(?:mum|mom|mother|dad|father|gran|grandma|grandmother|nan|granny|wife|husband|aunt|partner|sister|brother)"


def _filed(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("pile")
    wish.bounds.append(Bound("area", high=0.36))


def _hung(wish: Wish, match: re.Match[str]) -> None:
    wish.purposes.append("hang")


def _in_three(wish: Wish, match: re.Match[str]) -> None:
    wish.looks.append("letter")


MANNERS: list[tuple[str, Reader]] = [
    (r"(?:looks?|looking|lies?|lying|sits?|fits?|stays?|rests?) (?:\w+ )?(?:on|onto) (?:the|my|our|a|his"
     r"|her)", nothing),
    (r"fancy|elegant(?:ly)?|pretty|prettily|beautiful(?:ly)?|decorative(?:ly)?|festive(?:ly)?|smart(?:ly)?|posh"
     r"|classy|"
     r"stylish(?:ly)?|professional(?:ly)?|crisp(?:ly)?|like new|well", tidy),
    (r"(?:like |the way |as |just like )?(?:marie )?kondo(?: (?:would|does|do|did|style|method|way|folds?|it|them))*|"
     r"kon ?mari(?: (?:style|method|way|fold|it))*|(?:file|filed|filing) (?:fold(?:ed)? )?(?:it|them)?(?: ?upright)?|"
     r"(?:stands?|standing|stood|stand) (?:it |them )?(?:up|upright|on (?:its|their) own|alone)(?: (?:in"
     r"|by itself|by "
     r"themselves|on (?:its|their) own))?", _filed),
    (r"(?:stack(?:able|ed|s|ing)?|pil(?:e|ed|es|ing)(?: up)?) ?(?:well|nicely|easily|it|them)?", stacked),
    (r"(?:(?:together )?with|on top of|on|onto|among|between|next to|beside|to|like) (?:all )?(?:of )?(?:the "
     r"|my |our |his "
     r"|her |their |your )?(?:other|others|rest(?: of (?:the|my|our|his|her|your))?)(?: \w+)?(?= ?[.,;!?]|$| on| in)",
     stacked),
    (r"(?:like|as|the way)(?: (?:that|in which))? (?:they|you|people|we|shops?|stores?|hotels?|staff"
     r"|sellers)?(?: (?:do|does"
     r"|did|have|see|would|fold|get|find|sell|is done|are folded|usually|always|normally))*(?: (?:it|them|this"
     r"|that))? ?(?:in|"
     r"at) (?:the |a |an )?(?:\w+ ){0,2}(?:shops?|stores?|hotels?|spas?|boutiques?|malls?|outlets?|gap|uniqlo"
     r"|levi|zara|"
     r"h ?& ?m|department stores?)", stacked),
    (rf"(?:like|as|the way) (?:my |your |a |his |her )?{RELATIVE} (?:does|did|do|used to|would|always did"
     rf"|always does|taught "
     r"me|folds)(?: (?:do|fold))?(?: (?:it|them|that))?", tidy),
    (r"(?:nice|nicely|tidy|tidily|neat|neatly|orderly|clean|cleanly|proper|properly|presentable|respectable"
     r"|spick and span"
     r"|in order|not messy|not a mess|less messy)", tidy),
    (r"(?:hangs?|hung|hanging|drapes?|draped|goes|go|fits?|slung) (?:it |them |this )?(?:neatly |nicely "
     r"|well )?(?:over|on|onto|from|across|off|to) (?:the |a |my |our |its )*(?:\w+ )?(?:towel |clothes |coat "
     r"|curtain )?(?:rail|rack|"
     r"hanger|hook|line|rod|bar|peg|chair|railing|banister|radiator|airer)", _hung),
    (r"(?:with |in |of |into |has |have |having )*(?:three|3) (?:equal )?(?:panels?|panes?|columns?|segments?"
     r"|leaves)|tri ?fold"
     r"(?:ed)?(?: (?:brochure|flyer|leaflet))?", _in_three),
    (r"(?:a )?crop(?:ped)?(?: length| top)?|knee ?length|short legs|hot ?pants|cut ?offs", shortened),
]  # fmt: skip

ASIDES: list[tuple[str, Reader]] = [
    (r"i (?:really )?(?:hope|think|believe|guess|suppose|bet|trust|know)(?: that)?(?: (?:you|it)(?: can| could"
     r"| will)?)?",
     nothing),
    (r"i (?:do not|would not|never) (?:like|want) (?:it|them|that|this)(?: to)? (?:stick|hang|dangle|flap"
     r"|drag)(?:ing)?"
     r"(?: out| around| down| about)?", nothing),
    (r"(?:i|we|it|that)(?: really| honestly)? (?:do|does) not (?:care|mind|matter)(?: much"
     r"| at all)?(?: (?:to me|about))?"
     r"(?: (?:which|how|what|where|who|in which way|whether))?(?: (?:one|ones|way|side|sleeve|leg|corner|half"
     r"|edge|direction|"
     r"you (?:do|take|choose|pick|fold|get there|go about|manage))(?: it| that)?)*", tidy),
    (r"(?:any|either)(?: (?:one|way|side|which way|method))?(?: (?:will|would|is|you) (?:do|ok|okay|fine|like"
     r"|want|please))?"
     r"(?: really)?(?= ?[.,;!?]|$| as )", tidy),
    (r"(?:do |in |fold it |fold them |fold this )?(?:whatever|however|whichever|any|anyhow|as|how"
     r"|what)(?: way)? (?:you|works|"
     r"it takes)(?: (?:want|like|please|wish|prefer|think(?: is)?|feel|see fit|choose|best|fit|fancy|can"
     r"|think best))*"
     r"(?: (?:with|to) (?:it|them|this))?", tidy),
    (r"(?:i )?(?:will |shall )?(?:leave|leaving) (?:it|that|the \w+)(?: all)? (?:up )?to you|(?:it is "
     r"|that is )?(?:all )?up to "
     r"you|your (?:choice|call|decision)|you (?:choose|decide|pick)|no preference|surprise me|be creative|feel free|"
     r"somehow|no matter (?:how|which|what)(?: way)?|regardless how|in (?:some|any|whatever) way", tidy),
    (r"(?:as|so) long as|provided(?: that)?|on condition that|the main thing is(?: that)?|all (?:that matters"
     r"|i (?:want|ask|need)"
     r")(?: is(?: that)?)?|what matters is(?: that)?|the important thing is(?: that)?|if at all possible"
     r"|if possible|if you can",
     nothing),
    (r"(?:i )?(?:was |am )?(?:just )?wondering (?:if|whether) (?:you|it)(?: could| can| might| would)*|(?:is"
     r"|would) it be possible"
     r"(?: to| that you)?|(?:is|would) (?:there|it be)(?: any)? (?:way|chance|possibility)(?: (?:to|you could"
     r"|you can|of))?|any "
     r"chance(?: (?:you could|you can|of))?|do me a favou?r(?: and)?|be so (?:kind|good)(?: as to| and)?"
     r"|how about|what about|"
     r"go ahead(?: and)?|(?:i )?would (?:really )?(?:appreciate|be (?:glad|grateful|happy"
     r"|great))(?: it)?(?: if)?|see (?:if|whether)"
     r" you can|try (?:to|and)|would you mind", nothing),
    (r"(?:like (?:this|that)|as (?:it|they) (?:is|are|was|were)|the way (?:it|they) (?:is|are)|right now"
     r"|at the moment|at "
     r"present|currently|nowadays|than that|than this)", nothing),
]  # fmt: skip
