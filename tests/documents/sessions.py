# SPDX-License-Identifier: GPL-3.0-or-later
"""A document as a session: its commands are run in order, and what they print is compared with what it shows.

  - A block of console has commands, each behind "$ ", and below each what it prints. A line that ends with a backslash
    goes on in the next one. Where a command shows no output it must print nothing.
  - A block of any language whose first line is a comment with a file name, such as "# radius.py" or "// law.cpp", is a
    file. It is written before the commands below it.
  - "…" stands for what is left out: by itself on a line for any lines, within a line for any text. All else must be
    printed as shown, but for blanks and for numbers. An integer must be the same integer. Other numbers may differ by
    10^-6 of their size, by one unit of the last digit shown, or by 10^-11. A number below 10^-11 is what rounding
    leaves, and differs between processors: what is printed may be anything up to a hundred times its size.
  - A picture ../figures/tutorial-NAME must be made by the session as NAME.
"""
import os
import re
import shutil
import subprocess
from pathlib import Path

PICTURE = re.compile(r"\]\(\.\./figures/tutorial-([\w.-]+)\)")
# "…" matches any text; so does a number right before it, as far as its digits go.
TOKEN = re.compile(r"(?P<number>(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w]))|(?P<rest>…)|(?P<blank>\s+)")
NUMBER = r"([-+]?(?:\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|inf|nan))"
INTEGER = re.compile(r"[-+]?\d+")
RELATIVE, ABSOLUTE, ROUNDING = 1e-6, 1e-11, 100
TIME_LIMIT = 500  # seconds for a session: against a hang, not a measurement
# mpirun as root, and with more processes than cores: what docs/machines.md says.
PROCESSES = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
             "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
             "OMPI_MCA_hwloc_base_binding_policy": "none"}


def file_name(code):
    """The name in the first line of a block that is a file, or None."""
    first = re.match(r"(?:#|//) ([\w/.-]+\.\w+)\n", code)
    return first.group(1) if first else None


def commands_of(line, code):
    """[line number, command, [lines shown below it]] of a block of console."""
    found, goes_on = [], False
    for number, text in enumerate(code.splitlines(), line):
        if goes_on:
            found[-1][1] += "\n" + text
        elif text.startswith("$ "):
            found.append([number, text[2:], []])
        elif found:
            found[-1][2].append(text)
        else:
            raise ValueError(f"line {number}: expected a command behind '$ ', met '{text}'")
        goes_on = (goes_on or text.startswith("$ ")) and text.endswith("\\")
    return found


def last_digit(number):
    """One unit of the last digit of a number as it is written; 0 for one without a decimal or an exponent."""
    mantissa, _, exponent = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals) if decimals or exponent else 0.0


def same_number(shown, printed):
    """Whether a number that is printed may stand where another one is shown."""
    if INTEGER.fullmatch(shown) and INTEGER.fullmatch(printed):
        return int(shown) == int(printed)
    value, met = float(shown), float(printed)
    if abs(value) < ABSOLUTE:
        return abs(met) <= max(ROUNDING * abs(value), 1.001 * last_digit(shown))
    return abs(value - met) <= max(RELATIVE * abs(value), ABSOLUTE, 1.001 * last_digit(shown))


def same_line(shown, printed):
    pattern, numbers, end = "", [], 0
    for token in TOKEN.finditer(shown):
        pattern += re.escape(shown[end:token.start()])
        end = token.end()
        if token["number"]:
            numbers.append(token["number"])
            pattern += NUMBER
        else:
            pattern += r"\s+" if token["blank"] else ".*"
    met = re.fullmatch(pattern + re.escape(shown[end:]), printed.rstrip())
    return bool(met) and all(same_number(*pair) for pair in zip(numbers, met.groups()))


def same_lines(shown, printed):
    """Whether the lines printed are those shown; a line "…" stands for any number of them."""
    reached = {0}  # how many of the lines printed the lines shown so far can stand for
    for line in shown:
        if line.strip() == "…":
            reached = set(range(min(reached, default=len(printed) + 1), len(printed) + 1))
        else:
            reached = {k + 1 for k in reached if k < len(printed) and same_line(line.rstrip(), printed[k])}
    return len(printed) in reached


def script_of(k, step, outputs):
    """Step k as a line of bash: what its command prints goes to OUTPUTS/k, its exit code beside."""
    kind, _, content, _ = step
    if kind == "file":
        return f'mkdir -p "$(dirname \'{content}\')" && cp "{outputs}/file-{k}" \'{content}\'\n'
    return f'{{ {content}\n}} >"{outputs}/{k}" 2>&1 </dev/null; echo $? >"{outputs}/{k}.status"\n'


def steps_of(blocks):
    """(kind, line, command or file name, lines shown or content) of the files and commands among (line, language, code)
    of a document."""
    steps = []
    for line, language, code in blocks:
        if language == "console":
            steps += [("command", *command) for command in commands_of(line, code)]
        elif file_name(code):
            steps.append(("file", line, file_name(code), code))
    return steps


def judge(document, step, outputs, k):
    """Prints how a command went; True where it did what the document shows."""
    _, line, command, shown = step
    printed = Path(outputs, str(k)).read_text(encoding="utf-8").splitlines()
    status = int(Path(outputs, f"{k}.status").read_text(encoding="utf-8"))
    well = status == 0 and same_lines(shown, printed)
    print(f"{document}:{line}: {'ok' if well else 'FAILED'}: {command}")
    if not well:
        print(f"exit code {status}; shown:", *shown, "printed:", *printed[:100], sep="\n    ")
    return well


def link_tree(folder, build):
    """The source tree by links, with the build that is tested as its build/release, where documents have it."""
    os.makedirs(os.path.join(folder, "build"))
    os.symlink(build, os.path.join(folder, "build", "release"))
    for name in os.listdir(os.environ["NSCDD_SOURCE"]):
        if name != "build":
            os.symlink(os.path.join(os.environ["NSCDD_SOURCE"], name), os.path.join(folder, name))


def run(document, text, blocks, folder, figures=None):
    """Runs the session of a document in the empty folder FOLDER. Returns (commands that did what is shown, others).
    FIGURES: a folder where its pictures are put."""
    steps = steps_of(blocks)
    if not any(kind == "command" for kind, *_ in steps):
        return 0, 0
    place, outputs, tree = (os.path.join(folder, name) for name in ("session", "outputs", "tree"))
    os.makedirs(os.path.join(place, "build"))
    os.makedirs(outputs)
    build = os.path.dirname(os.environ["NSCDD_PROGRAM"])
    link_tree(tree, build)
    os.symlink(build, os.path.join(place, "build", "release"))  # the README stands in the tree
    for k, (kind, _, _, content) in enumerate(steps):
        if kind == "file":
            Path(outputs, f"file-{k}").write_text(content, encoding="utf-8")
    environment = dict(os.environ, **PROCESSES, PATH=f"{build}:/usr/bin:{os.environ['PATH']}", MPLBACKEND="Agg",
                       LC_ALL="C.UTF-8", NSCDD_SOURCE=tree)
    script = "".join(script_of(k, step, outputs) for k, step in enumerate(steps))
    subprocess.run(["bash", "-c", script], cwd=place, env=environment, check=True, timeout=TIME_LIMIT)
    well = [judge(document, step, outputs, k) for k, step in enumerate(steps) if step[0] == "command"]
    for picture in PICTURE.findall(text):
        made = os.path.join(place, picture)
        well.append(os.path.exists(made))
        if not well[-1]:
            print(f"{document}: FAILED: the session makes no {picture}")
        elif figures:
            shutil.copy(made, os.path.join(figures, f"tutorial-{picture}"))
    return well.count(True), well.count(False)
