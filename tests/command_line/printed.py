"""Printed output beside that of a page: which words and numbers have to agree, and how closely.

Words agree. A number with an error agrees within that error and the one that the page states; errors agree up to a
factor, and what is below rounding is no error. A number without one agrees to the digits that are printed. Times,
memory, commit and machine may be any. A line `...` of the page stands for any lines, and ` ...` at the end of a line for its rest.
"""

import dataclasses
import difflib
import re

GAP = "..."
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
PART = re.compile(rf"\+-|[(\[]+|{NUMBER.pattern}(?=[)\],;:.%]*(\s|$))|[)\],;:]+(?=\s|$)"
                  r"|[^\s(\[]\S*?(?=[)\],;:]*(\s|$))")  # +-, brackets, numbers, punctuation after them, words
FREE_COLUMNS = {"MB", "megabytes", "assembly", "analysis", "factor", "factorization", "solve", "total", "s", "seconds"}
ERROR_COLUMNS = {"error", "relative", "largest"}
UNITS_OF_COST = {"s", "ms", "us", "ns", "min", "h", "kB", "MB", "GB"}
ANYTHING_AFTER = {"commit", "machine", "host"}
FACTOR = 5        # between error estimates of the same value: differences of results, which move with rounding
ROUNDING = 1e-12  # of a value of the size of 1


@dataclasses.dataclass
class Token:
    """A word or a number of a line; `role` is word, plain, value, error or free, `error` the place of a value's."""

    text: str
    end: int
    role: str = "word"
    error: int | None = None

    @property
    def number(self):
        return float(self.text) if self.role != "word" else None

    @property
    def rounding(self):
        """Half of what the last printed digit counts; 0 of whole numbers."""
        digits, _, exponent = self.text.lower().partition("e")
        whole = "." not in digits and not exponent
        return 0 if whole else 0.5 * 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def tokens_of(line):
    return [Token(found.group(0), found.end(), "plain" if NUMBER.fullmatch(found.group(0)) else "word")
            for found in PART.finditer(line)]


def parsed(lines):
    """The tokens of each line of an output, with their roles."""
    header, found = [], []
    for line in lines:
        tokens = tokens_of(line)
        found.append(tokens)
        aligned, words = "  " in line.strip(), [token.text for token in tokens]
        if "=" in words:  # parameters, not a row
            header = []
        if aligned and len(tokens) > 2 and "=" not in words and not any(
                token.role == "plain" and after != "%" for token, after in zip(tokens, [*words[1:], ""])):
            header = tokens
        elif aligned and header:
            by_columns(tokens, header)
        else:
            by_words(tokens)
    return found


def by_columns(tokens, header):
    """Roles in a row of a table: of results in their order, in all others by the column that ends where they do."""
    names = [token.text for token in header]
    places = [n for n, token in enumerate(tokens) if token.role == "plain"]
    if names[:3] == ["quantity", "value", "error"]:
        value = places[1:] if tokens[0].role == "plain" else places  # an array begins with its argument
        if len(value) > 1:
            tokens[value[0]].role, tokens[value[0]].error = "value", value[1]
        for place in value[1:]:
            tokens[place].role = "error"
        return
    columns = [min(range(len(header)), key=lambda n: abs(header[n].end - tokens[place].end)) for place in places]
    for n, (place, column) in enumerate(zip(places, columns)):
        if names[column] in FREE_COLUMNS:
            tokens[place].role = "free"
        elif names[column] in ERROR_COLUMNS:
            tokens[place].role = "error"
        elif n + 1 < len(places) and names[columns[n + 1]] == "error" and columns[n + 1] == column + 1:
            tokens[place].role, tokens[place].error = "value", places[n + 1]


def by_words(tokens):
    """Roles in a sentence, by the words around a number."""
    words = [token.text for token in tokens]
    for n, token in enumerate(tokens):
        if ANYTHING_AFTER & set(words[:n]):
            token.role = "free"
        elif token.role != "plain":
            continue
        elif words[n + 1:n + 2] and words[n + 1] in UNITS_OF_COST or words[n + 1:n + 4] == ["times", "the", "time"]:
            token.role = "free"
        elif words[n + 1:n + 2] == ["+-"] and n + 2 < len(tokens):
            token.role, token.error = "value", n + 2
        elif n and words[n - 1] == "+-":
            token.role = "error"


def disagreement(page, output, exactly=False):
    """What a line of a page has otherwise than the tokens of a line of output, in words; empty if it agrees.

    With `exactly`, nothing but what is free may differ.
    """
    found = tokens_of(page)
    if found and page.endswith(f" {GAP}"):
        found, output = found[:-1], output[:len(found) - 1]
    if len(found) != len(output):
        return f"{len(output)} words and numbers, not {len(found)}"
    for here, there in zip(found, output):
        if there.role == "free" or here.text == there.text:
            continue
        if exactly or there.role == "word" or here.role == "word":
            return f"{there.text}, not {here.text}"
        close = errors_agree if there.role == "error" else numbers_agree
        if not close(here, there, found, output):
            return f"{there.text}, not {here.text}"
    return ""


def errors_agree(here, there, _, output):
    low, high = sorted((here.number, there.number))
    value = next((abs(token.number) for token in output
                  if token.error is not None and output[token.error] is there), 0)
    return high <= FACTOR * max(low, ROUNDING * max(1, value))


def numbers_agree(here, there, found, output):
    stated = 0
    if there.error is not None:
        stated = sum(line[there.error].number or 0 for line in (found, output) if there.error < len(line))
    return abs(here.number - there.number) <= 1.001 * (stated + here.rounding + there.rounding)


def segments_of(lines):
    """The lines between the gaps of a page."""
    segments = [[]]
    for line in lines:
        if line.strip() == GAP:
            segments.append([])
        else:
            segments[-1].append(line)
    return segments


def distance(page, line, tokens):
    """0 for lines that agree, up to 2 for lines that have nothing in common."""
    if not disagreement(page, tokens):
        return 0
    ours, theirs = (["#" if token.role != "word" else token.text for token in part]
                    for part in (tokens_of(page), tokens))
    return 2 - difflib.SequenceMatcher(None, ours, theirs).ratio()


def placed(segments, lines, tokens):
    """Where each segment begins in the output: the first at its beginning, the last at its end, others where they fit
    best. Segments that do not fit reach beyond an end."""
    places, begin = [], 0
    for n, segment in enumerate(segments):
        last = len(lines) - len(segment)
        if n == 0 or not segment:
            place = begin
        elif n == len(segments) - 1:
            place = max(begin, last)
        else:
            place = min(range(begin, max(begin, last) + 1), key=lambda at: sum(
                distance(page, *pair) for page, pair in zip(segment, zip(lines[at:], tokens[at:]))))
        places.append(place)
        begin = place + len(segment)
    return places


def trimmed(text):
    return [line.rstrip() for line in text.strip("\n").split("\n")] if text.strip() else []


def differences(page, output):
    """What a block of a page has otherwise than the output of its commands: a sentence for each line."""
    lines, segments = trimmed(output), segments_of(trimmed(page))
    tokens, found = parsed(lines), []
    for segment, place in zip(segments, placed(segments, lines, tokens)):
        for n, line in enumerate(segment, place):
            what = disagreement(line, tokens[n]) if n < len(lines) else "is not printed"
            if what:
                found.append(f"{line.strip() or 'an empty line'}: {what}")
    if len(segments) == 1 and len(lines) > len(segments[0]):
        found.append(f"{lines[len(segments[0])].strip() or 'an empty line'}: is printed, and not on the page")
    return found


def renewed(page, output):
    """The block of a page with the lines of the output in their places, cut where they were cut. A block that differs
    in times alone stays."""
    lines, segments = trimmed(output), segments_of(trimmed(page))
    tokens, parts, same = parsed(lines), [], True
    for n, (segment, place) in enumerate(zip(segments, placed(segments, lines, tokens))):
        whole = len(segments) == 1
        new = lines if whole else lines[place:place + len(segment)]
        same = same and len(new) == len(segment) and not any(
            disagreement(line, other, exactly=True) for line, other in zip(segment, tokens[place:]))
        parts.append("\n".join(cut(line, old) for line, old in zip(new, [*segment, *[""] * len(new)])))
    return page if same else f"\n{GAP}\n".join(parts).strip("\n") + "\n"


def cut(line, old):
    """A line, cut between words where the old one was."""
    if not old.endswith(f" {GAP}"):
        return line
    ends = [token.end for token in tokens_of(line) if token.end <= len(old) - len(GAP) - 1]
    return f"{line[:ends[-1]]} {GAP}" if ends else line
