"""Formulas within plain text, set in MathML for pages: `mu_d = 1/4`, `P(|X| <= mu_s)`, `E[V^2]`, `10^-300`.

Texts of the report are written as they are printed on a terminal. html_of() finds the formulas in them by a grammar:
symbols (Greek names, single letters, letters with an index), numbers, brackets and operators. Words end a formula.
What has an underscore and is no formula is a key of results, what begins with a minus sign is an option; both are set
as code.
"""

import html
import re

GREEK = {"gamma": "γ", "delta": "δ", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "pi": "π", "sigma": "σ",
         "tau": "τ", "omega": "ω", "zeta": "ζ"}
FUNCTIONS = {"exp": "exp", "Var": "Var", "int": "∫", "ds": "ds"}
KEYS = {"E_V": "E[V]", "E_V2": "E[V^2]", "E_absV": "E[|V|]", "E_XV": "E[X V]", "E_X2": "E[X^2]",
        "P_X_le_mu_s": "P(|X| <= mu_s)", "f_stick_0": "f_stick(0+)"}  # results whose name is a formula
RELATIONS = {"<=": "≤", ">=": "≥", "->": "→", "=": "=", "<": "&lt;", ">": "&gt;"}
SIGNS = {"+-": "±", "+": "+", "-": "−", "*": "·", "/": "/"}
CLOSING = {"(": ")", "[": "]", "|": "|"}

NUMBER = re.compile(r"(\d+(?:\.\d+)?)(?:e([+-]?\d+))?(?![\w.]*\w)")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
START = re.compile(r"(?<![^\s(\[,\"])(?<!\w[(\[])(?=[A-Za-z0-9(|\[])")
END = re.compile(r"$|[\s),\]\"%]|[.;:!?](?=\s|$)|'s\b|-(?=[a-z])")
CODE = re.compile(r"(?<![\w-])(?:-[a-z]\w+|[A-Za-z]\w*_\w+(?:\[\d+\])?)")


def symbol(name):
    """MathML of a name, and None where it is a word."""
    if name in KEYS:
        return Formula(KEYS[name]).relation()
    if name in FUNCTIONS:
        return f"<mi>{FUNCTIONS[name]}</mi>"
    if name in GREEK or len(name) == 1:
        return f"<mi>{GREEK.get(name, name)}</mi>"
    if derivative := re.fullmatch(r"d([A-Za-z]\w*?_\w+?)_d(\w+)", name):
        above, below = (symbol(part) or f"<mtext>{part}</mtext>" for part in derivative.groups())
        return f"<mrow><mi>∂</mi>{above}</mrow><mo>/</mo><mrow><mi>∂</mi>{below}</mrow>"
    if name.endswith("_minus"):
        above = symbol(name.removesuffix("_minus"))
        return above and f"<msup><mrow>{above}</mrow><mo>−</mo></msup>"
    base, _, index = name.partition("_")
    if not index or "_" in index or len(base) > 1 and not (base in GREEK and len(index) == 1):
        return None
    kind = "mn" if index.isdigit() else "mi" if len(index) == 1 else "mtext"
    return f"<msub>{symbol(base)}<{kind}>{index}</{kind}></msub>"


class Formula:
    """The longest formula that begins at a place of a text. Each method reads one rule of the grammar: it returns
    MathML and moves `at` behind what it has read, or returns None and leaves `at` where it is."""

    def __init__(self, text, at=0):
        self.text, self.at = text, at
        self.letters = 0  # names seen
        self.certain = False  # whether it holds more than numbers and words of one letter

    def taken(self, pattern):
        found = re.compile(pattern).match(self.text, self.at)
        self.at = found.end() if found else self.at
        return found

    def after(self, pattern, rule):
        """Operator and what follows it; None where either is missing."""
        before = self.at, self.letters, self.certain
        operator = self.taken(pattern)
        right = operator and rule()
        if not right:
            self.at, self.letters, self.certain = before
            return None
        return operator[1], right

    def relation(self):
        left = self.sum()
        while left and (pair := self.after(r"\s*(<=|>=|->|=|<|>)(?!=)\s*", self.sum)):
            left += f"<mo>{RELATIONS[pair[0]]}</mo>{pair[1]}"
            self.certain |= self.letters > 0
        return left

    def sum(self):
        start, sign = self.at, self.taken(r"\+-|[+-]")
        left = self.product()
        if not left:
            self.at = start
            return None
        if sign:
            left = f'<mo form="prefix">{SIGNS[sign[0]]}</mo>{left}'
        while pair := (self.after(r"\s+(\+-|[+-])\s+", self.product)
                       or self.after(r"([+-])(?=[\w(])", self.product)):
            left += f"<mo>{SIGNS[pair[0]]}</mo>{pair[1]}"
        return left

    def product(self):
        left = self.power()
        while left:
            if pair := self.after(r"\s*([*/])\s*", self.power):
                left += f"<mo>{SIGNS[pair[0]]}</mo>{pair[1]}"
            elif pair := self.after(r"( )(?=[A-Za-z(|])(?![aAIs]\b)", self.power):
                left += f'<mspace width="0.17em"/>{pair[1]}'
            else:
                break
            self.certain |= self.letters > 0
        return left

    def power(self):
        left = self.atom()
        if left and (pair := self.after(r"(\^)", self.exponent)):
            self.certain = True
            return f"<msup><mrow>{left}</mrow><mrow>{pair[1]}</mrow></msup>"
        if left and (sign := self.taken(r"[+-](?=[\s),;:\]]|$)")):
            self.certain |= self.letters > 0
            return f"<msup><mrow>{left}</mrow><mo>{SIGNS[sign[0]]}</mo></msup>"
        return left

    def exponent(self):
        start, sign = self.at, self.taken("[+-]")
        if value := self.bracket(fences=False) or self.atom():
            return (f'<mo form="prefix">{SIGNS[sign[0]]}</mo>' if sign else "") + value
        self.at = start
        return None

    def atom(self):
        if number := self.taken(NUMBER):
            self.certain |= bool(number[2])
            return scientific(*number.groups())
        return self.bracket() or self.name()

    def name(self):
        start, name = self.at, self.taken(NAME)
        found = name and symbol(name[0])
        if found and self.text[self.at:self.at + 1] in ("(", "["):
            argument = self.bracket()
            found = argument and found + argument
            self.certain = True
        if not found:
            self.at = start
            return None
        self.letters += 1
        self.certain |= len(name[0]) > 1
        return found

    def bracket(self, fences=True):
        start, opening = self.at, self.taken(r"[(\[|]")
        inner = opening and self.relation()
        while inner and (pair := self.after(r"(,) ?", self.relation)):
            inner += f"<mo>,</mo>{pair[1]}"
        if not inner or not self.taken(re.escape(CLOSING[opening[0]])):
            self.at = start
            return None
        self.certain |= opening[0] == "|"
        if fences:
            inner = f'<mo form="prefix">{opening[0]}</mo>{inner}<mo form="postfix">{CLOSING[opening[0]]}</mo>'
        return f"<mrow>{inner}</mrow>"


def scientific(digits, exponent):
    """A number; one with an exponent as a multiple of a power of ten."""
    if exponent is None:
        return f"<mn>{digits}</mn>"
    power = f"<msup><mn>10</mn><mn>{int(exponent)}</mn></msup>".replace("-", "−")
    return power if digits == "1" else f"<mn>{digits}</mn><mo>·</mo>{power}"


def formula_at(text, at):
    """MathML of the formula that begins at `at`, and its end; None where there is none."""
    formula = Formula(text, at)
    found = formula.relation()
    if not found or not END.match(text, formula.at):
        return None
    words = text[at:formula.at]
    if len(words) == 1:  # the article, and the unit of time
        seconds = words == "s" and re.search(r"\d $", text[:at])
        formula.certain = words.isalpha() and words not in "aAI" and not seconds
    return (found, formula.at) if formula.certain else None


def plain_html(text):
    """Escaped, with keys and options as code."""
    return CODE.sub(lambda found: f"<code>{found[0]}</code>", html.escape(text, quote=False))


def html_of(text):
    """HTML of a text, its formulas as MathML. A number and a command stay as they are."""
    if text.startswith("stickslip -"):
        return f"<code>{html.escape(text, quote=False)}</code>"
    parts, done, at = [], 0, 0
    while not NUMBER.fullmatch(text) and (start := START.search(text, at)):
        begin = start.start()
        if found := formula_at(text, begin):
            formula, at = found
            hyphen = "-" * text.startswith("-", at)  # lambda-problem: what follows is no option
            joined = "\u2060" * bool(re.match(r"[^\s(\[]", text[at:]))  # no line begins with a comma
            parts += [plain_html(text[done:begin]), f"<math>{formula}</math>{joined}{hyphen}"]
            done = at = at + len(hyphen)
        else:
            at = begin + 1
    return "".join(parts) + plain_html(text[done:])
