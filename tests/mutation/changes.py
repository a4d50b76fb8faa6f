"""The small changes that can be planted into a source that is formatted as ours are."""

import re
from dataclasses import dataclass

# Operators stand between spaces or at the end of a line; brackets of templates do not.
OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
    "+": "-", "-": "+", "+=": "-=", "-=": "+=",
}
OPERATOR = re.compile(r"(?<=[ ])(<=|>=|==|!=|&&|\|\||\+=|-=|<|>|\+|-)(?=[ \n])")
# After a bracket, a comma, an operator or `return`, before what it is the sign of.
UNARY_MINUS = re.compile(r"(?:(?<=[(\[{,?:=<>+*/ ])|(?<=return ))-(?=[A-Za-z_(\d])")
NOT = re.compile(r"(?<![\w)])!(?=[A-Za-z_(])")
STEP = re.compile(r"\+\+|--(?!>)")
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9a-fA-F]+|\d[\d']*(?:\.\d+)?)([uUlL]*)(?![\w.'])")
TRUTH = re.compile(r"\b(true|false)\b")
CONDITION = re.compile(r"\b(?:if|while) \(")
# A call, an assignment or a step that is a statement of its own, on one line.
STATEMENT = re.compile(
    r"(?m)^[ ]+((?:\+\+|--)?[\w.:>\[\]-]+(?:\(.*\)|(?:\(.*\))?[\w.>\[\]-]* [-+*|&^<>]*= .*|\+\+|--)?;)$")
NO_STATEMENT = re.compile(r"(?:return|break|continue|using|namespace|public:|private:|else)\b")
# What stops a program, and what is computed when it is compiled.
STOPS = re.compile(r"\b(?:ETCM_CHECK|ETCM_VERIFY_THAT|static_assert|demand)\(|^\s*#|\bdefined\(")
COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|(?<!\d)'(?:\\.|[^'\\\n])'", re.S)


@dataclass(frozen=True)
class Change:
    file: str
    line: int
    begin: int
    end: int
    instead: str
    before: str  # the line, as it is
    after: str

    @property
    def title(self):
        return f"{self.before.strip()} => {self.after.strip()}"

    def applied(self, text):
        return text[:self.begin] + self.instead + text[self.end:]

    def __str__(self):
        return f"{self.file}:{self.line}\n- {self.before.strip()}\n+ {self.after.strip()}"


def blanked(text):
    """The text without comments and literals, each character where it was."""
    return COMMENT_OR_TEXT.sub(lambda match: re.sub(r"[^\n]", "`", match.group(0)), text)


def closing(code, opening):
    """Where the bracket ends that opens there."""
    depth = 0
    for place in range(opening, len(code)):
        depth += (code[place] == "(") - (code[place] == ")")
        if depth == 0:
            return place
    return len(code) - 1


def greater(number):
    digits = number.replace("'", "")
    if "." in digits:
        return str(float(digits) + 1)
    return hex(int(digits, 16) + 1) if digits.startswith("0x") else str(int(digits) + 1)


def edits(code, text):
    """(begin, end, what stands there instead) of each change."""
    for match in OPERATOR.finditer(code):
        yield *match.span(), OPERATORS[match.group(1)]
    for match in [*UNARY_MINUS.finditer(code), *NOT.finditer(code)]:
        yield *match.span(), ""
    for match in STEP.finditer(code):
        yield *match.span(), "--" if match.group(0) == "++" else "++"
    for match in NUMBER.finditer(code):
        yield *match.span(1), greater(match.group(1))
    for match in TRUTH.finditer(code):
        yield *match.span(), "false" if match.group(0) == "true" else "true"
    for match in CONDITION.finditer(code):
        begin, end = match.end(), closing(code, match.end() - 1)
        # What is declared there has a semicolon behind it.
        begin += len(code[begin:end].rpartition("; ")[0] + "; ") if "; " in code[begin:end] else 0
        yield begin, end, f"!({text[begin:end]})"
    for match in STATEMENT.finditer(code):
        if not NO_STATEMENT.match(match.group(1)):
            yield *match.span(1), ";"


def changes_of(file, text):
    """The changes of a file, in order."""
    found = []
    for begin, end, instead in sorted(set(edits(blanked(text), text))):
        start = text.rfind("\n", 0, begin) + 1
        before = text[start:].split("\n", 1)[0]
        after = (text[start:begin] + instead + text[end:]).split("\n", 1)[0]
        if not STOPS.search(before):
            found.append(Change(file, text.count("\n", 0, begin) + 1, begin, end, instead, before, after))
    return found
