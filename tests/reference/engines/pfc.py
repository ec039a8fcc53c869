"""A stand-in for the console program of PFC, for tests: it reads a command file as the manuals say one is written, refuses
what is in none of them, and answers with closed forms in the place of a simulation.

The grammar below was written down from the public manuals: docs.itascacg.com/pfc600, /pfc700, /itasca900 (command
references, "Generating a Bonded Assembly", "Rock Testing", "Sleeved Triaxial Test of a Bonded Material"), and for version 5
from the command lists of published data files. It knows the commands that the templates use and no others.
"""
import re
import sys

NUMBER = r"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
VALUE = rf"(?:{NUMBER}|\[[^\]]+\]|@\w+)"
NAME = r"'\w+'"
CORNER = rf"\({VALUE},{VALUE},{VALUE}\)"
RANGE = rf"(?: range (?:name {NAME}|contact type 'ball-ball'))?"
BOX = rf"box(?: {VALUE} {VALUE}){{2,3}}"

SHARED = [
    rf"contact model (?:linear|linearcbond|linearpbond){RANGE}",
    rf"contact method bond gap {VALUE}{RANGE}",
    rf"contact method (?:pb_)?deformability emod {VALUE} kratio {VALUE}{RANGE}",
    rf"contact method cb_strength tensile {VALUE} shear {VALUE}{RANGE}",
    rf"contact property(?: (?:fric|lin_mode|pb_ten|pb_coh|pb_fa|pb_rmul) {VALUE}| lin_force {VALUE} {VALUE}(?: {VALUE})?)+{RANGE}",
    rf"wall create name {NAME} vertices(?: {VALUE}){{4}}",
    rf"wall delete{RANGE}",
    rf"ball distribute porosity {VALUE} radius {VALUE} {VALUE} {BOX}",
    rf"ball attribute density {VALUE} damp {VALUE}",
    rf"ball attribute damp {VALUE}",
    rf"ball attribute displacement multiply {VALUE}",
]
CMAT = rf"cmat default model linear method deformability emod {VALUE} kratio {VALUE} proximity {VALUE}"
SIX = SHARED + [
    r"model new",
    rf"program log-file {NAME[:-1]}\.log'",
    r"program log (?:on|off)",
    r"program quit",
    r"model random \d+",
    r"model large-strain on",
    rf"model domain extent(?: {VALUE} {VALUE}){{2,3}} condition destroy",
    r"contact " + CMAT,
    rf"wall generate name {NAME} polygon(?: {CORNER}){{4}}",
    rf"wall attribute velocity-[xyz] {VALUE}{RANGE}",
    rf"ball attribute force-contact multiply {VALUE} moment-contact multiply {VALUE}",
    r"model cycle \d+(?: calm \d+)?",
    r"model calm",
    rf"model solve ratio-average {NUMBER}",
    r"model solve fish-halt \w+",
    r"fish history \w+",
    r"\[.+\]",
]
FIVE = SHARED + [
    r"new",
    r"set logfile \w+\.log",
    r"set log (?:on|off)",
    r"set random \d+",
    rf"domain extent(?: {VALUE} {VALUE}){{2}} condition destroy",
    CMAT,
    rf"wall attribute [xyz]velocity {VALUE}{RANGE}",
    rf"ball attribute contactforce multiply {VALUE} contactmoment multiply {VALUE}",
    r"cycle \d+(?: calm \d+)?",
    r"calm",
    rf"solve aratio {NUMBER}",
    r"solve fishhalt @\w+",
    r"history @\w+",
    r"@\w+",
    r"exit",
]
STATEMENT = [
    r"(?:local )?\w+ = .+",
    r"if .+",
    r"endif",
    r"loop foreach local \w+ ball\.list",
    r"endloop",
    r"end",
]
INTRINSICS = """math.abs comp.x comp.y comp.z wall.find wall.force.contact wall.pos ball.pos ball.disp ball.list string
io.out""".split()


def lines(path):
    """The commands, without comments, continued lines joined, single spaces."""
    text = open(path).read()
    text = re.sub(r"\.\.\.[ \t]*\n", " ", text)
    for number, line in enumerate(text.split("\n"), 1):
        line = re.sub(r"\s+", " ", line.split(";")[0]).strip()
        if line:
            yield number, line


def fault(number, line, why):
    sys.exit(f"*** line {number}: {why}: {line}")


def check(path):
    """Refuses what is no command; gives the numbers that the file sets by name, and the name of its log."""
    found = list(lines(path))
    five = found[0][1] == "new"
    grammar, opening = (FIVE, "define ") if five else (SIX, "fish define ")
    inside, constants, log = False, {}, None
    for number, line in found:
        if "{" in line:
            fault(number, line, "a name that was not filled")
        for word in re.findall(r"[a-z]+(?:\.[a-z]+)+(?=\()|\bball\.list\b", line):
            if word not in INTRINSICS:
                fault(number, line, f"no intrinsic `{word}`")
        if line.count("(") != line.count(")") or line.count("[") != line.count("]"):
            fault(number, line, "unbalanced brackets")
        if line.startswith(opening):
            inside = True
            continue
        forms = STATEMENT if inside else grammar
        if not any(re.fullmatch(form, line) for form in forms):
            fault(number, line, "bad command")
        inside = inside and line != "end"
        value = re.fullmatch(rf"\[?(\w+) = ({NUMBER}(?:\*{NUMBER})*)\]?", line)
        if value:
            product = 1.0
            for factor in value[2].split("*"):
                product *= float(factor)
            constants[value[1]] = product
        log = log or (re.search(r"log-?file '?(\w+\.log)", line) or [None, None])[1]
    last = found[-1][1]
    if last not in ("exit", "program quit"):
        fault(found[-1][0], last, "the console program would wait for more commands")
    return constants, log


def main():
    constants, log = check(sys.argv[1])
    three = "3d" in sys.argv[1]
    kappa, emod = constants["kratio"], constants["emod"]
    # What bonded discs and balls show, by formulas: enough to see that every parameter arrives.
    modulus = emod * (0.79 - 0.169 * (kappa - 1) / (kappa + 1) * 2) * (1.2 if three else 1.0)
    strength = 1.2 * min(constants["tension"], constants["shear"]) * constants["rmax"] / constants["rmin"] / 1.66
    with open(log, "w", encoding="utf-16") as out:
        print("PFC stand-in\nUCS = 1.0D0", file=out)
        print(f"UCS = {strength:.17e}".replace("e", "D"), file=out)
        print(f"peak_strain = {strength / modulus:.17e}\nE = {modulus:.17e}", file=out)
        print(f"nu = {0.147 + 0.167 * (kappa - 1) / (kappa + 1) * 2:.17e}", file=out)


main()
