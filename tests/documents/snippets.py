#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every ```python block and every command of a ```console block of the Markdown files given, as a reader would
who copies it. Checks that the commands in ```sh and ```console blocks and in code spans have verbs and options that the
program knows.

usage: snippets.py [--figures FOLDER] FILE.md...

The commands of a document run in order in an empty folder, and must print what it shows (sessions.py). --figures puts
the pictures that they draw into FOLDER, which is how those of the tutorials in docs/figures/ are made.

A block of Python that is no file of such a session runs by itself with /usr/bin/python3 in a folder where the results
exist that the text speaks of:
results/figure-5/ (nscdd run figure-5), sweep.csv and sweep.h5 (nscdd sweep disks4), bed.h5 (nscdd generate deposit),
run.h5 (three steps of nscdd simulate settle-1k), run.vtkhdf (its export), operators/ (nscdd export disks8), report.html
(nscdd report disks4), and the folder cases/ of the source tree. `import nscdd` finds the package that was built, by
$PYTHONPATH.
A document that starts from $LMGC90 is skipped, with exit code 77, where there are no folders of LMGC90.
A block that raises is a failure, and so is a call that finds no block in any file. The program is $NSCDD_PROGRAM, the
source tree $NSCDD_SOURCE.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import lmgc90_tree
import sessions

PREPARATION = [
    ["run", "figure-5"],
    ["sweep", "disks4", "--epsilon", "0,1e-2:1e2:5", "--eta", "0.3,inf", "--csv", "sweep.csv", "--hdf5", "sweep.h5"],
    ["generate", "deposit", "--set", "packing.grains=200", "-o", "bed.h5"],
    ["simulate", "settle-1k", "--steps", "3", "-o", "run.h5"],
    ["export", "disks8", "--epsilon", "1", "--eta", "0.3", "--operators", "operators"],
    ["export", "run.h5", "--vtkhdf", "run.vtkhdf"],
    ["report", "disks4", "--epsilon", "0,1", "--eta", "1,inf", "-o", "report.html"],
]
TIME_LIMIT = 120  # seconds per command: against a hang, not a measurement


def all_blocks(text, document):
    """(line number, language, code) of every fenced block; fences may be indented, as in a list."""
    found, start, indent, language, lines = [], None, "", "", []
    for number, line in enumerate(text.splitlines(), 1):
        if start is None:
            fence = re.fullmatch(r"(\s*)```+\s*(\w*).*", line)
            if fence:
                start, indent, language, lines = number + 1, fence.group(1), fence.group(2), []
        elif re.fullmatch(r"\s*```+\s*", line):
            found.append((start, language, "\n".join(lines) + "\n"))
            start = None
        else:
            lines.append(line[len(indent):] if line.startswith(indent) else line)
    if start is not None:
        sys.exit(f"{document}: a block that starts at line {start} has no end")
    return found


def blocks(text, document, language="python"):
    """(line number, code) of every fenced block of a language."""
    return [(line, code) for line, name, code in all_blocks(text, document) if name == language]


def prepare(folder):
    environment = dict(os.environ, NSCDD_DATA=os.environ["NSCDD_SOURCE"])
    for arguments in PREPARATION:
        subprocess.run([os.environ["NSCDD_PROGRAM"], *arguments], cwd=folder, env=environment, check=True,
                       stdout=subprocess.DEVNULL, timeout=TIME_LIMIT)
    os.symlink(os.path.join(os.environ["NSCDD_SOURCE"], "cases"), os.path.join(folder, "cases"))


def run_block(folder, document, line, code):
    """True where the block ran to its end."""
    # Blank lines in front make the line numbers of a traceback those of the document.
    path = os.path.join(folder, "snippet.py")
    Path(path).write_text("\n" * (line - 1) + code, encoding="utf-8")
    # No window: a block that draws is run without a screen.
    result = subprocess.run(["/usr/bin/python3", path], cwd=folder, env=dict(os.environ, MPLBACKEND="Agg"),
                            capture_output=True, text=True, timeout=TIME_LIMIT)
    print(f"{document}:{line}: {'ok' if result.returncode == 0 else 'FAILED'}")
    if result.returncode != 0:
        print(result.stdout + result.stderr.replace(path, document))
    return result.returncode == 0


def commands(code):
    """(verb, options) of every call of the program in lines of a shell."""
    for line in code.replace("\\\n", " ").splitlines():
        for part in re.split(r"[|;&]", re.sub(r"(^|\s)#.*", "", line)):
            words = re.sub(r"^\s*\$ ", "", part).split()
            if words and os.path.basename(words[0]) == "nscdd" and len(words) > 1 and not words[1].startswith("-"):
                yield words[1], [w.split("=")[0] for w in words[2:] if re.match(r"--?[a-z]", w)]


def shell_lines(text, document):
    """(line number, code) of the blocks of a shell, and of the spans of the text that call the program."""
    found = blocks(text, document, "sh") + blocks(text, document, "console")
    for number, line in enumerate(text.splitlines(), 1):
        found += [(number, span) for span in re.findall(r"`(nscdd [^`]+)`", line)]
    return found


def unknown_options(document, text, helps):
    """What the commands of the document ask for and the program does not know, in words."""
    for line, code in shell_lines(text, document):
        for verb, options in commands(code):
            if not re.fullmatch("[a-z]+", verb):
                continue  # nscdd VERB --help
            if verb not in helps:
                result = subprocess.run([os.environ["NSCDD_PROGRAM"], verb, "--help"], capture_output=True, text=True,
                                        timeout=TIME_LIMIT)
                helps[verb] = result.stdout if result.returncode == 0 else ""
            known = set(re.findall(r"(?<!\S)--?[a-z][a-z0-9-]*", helps[verb].replace(",", " ")))
            for option in [o for o in options if o not in known] if known else [""]:
                yield f"{document}: line {line}: the program does not know '{verb} {option}'".rstrip()


def run_python(found):
    """How many of (document, line, code) ran to their end, and how many did not."""
    if not found:
        return 0, 0
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder)
        passed = [run_block(folder, *block) for block in found]
    return passed.count(True), passed.count(False)


def run_session(document, text, figures):
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as lmgc90:
        if lmgc90_tree.needed(text):
            tree = lmgc90_tree.find_tree(os.environ["NSCDD_SOURCE"], lmgc90)
            if tree is None:
                print(f"{document}: skipped: it needs folders of LMGC90 ($LMGC90 or $NSCDD_LMGC90)")
                sys.exit(77)
            os.environ["LMGC90"] = tree
        return sessions.run(document, text, all_blocks(text, document), folder, figures)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figures", metavar="FOLDER", help="put the pictures that sessions draw there")
    parser.add_argument("documents", nargs="+", metavar="FILE.md")
    options = parser.parse_args()
    for name in ("NSCDD_PROGRAM", "NSCDD_SOURCE"):
        if name not in os.environ:
            sys.exit(f"snippets.py: the environment has no {name}")
    texts, unknown, helps = {}, [], {}
    for document in options.documents:
        texts[document] = Path(document).read_text(encoding="utf-8")
        unknown += unknown_options(document, texts[document], helps)
    if unknown:
        sys.exit("\n".join(unknown))
    if not helps and not any(blocks(text, document, "console") for document, text in texts.items()):
        sys.exit(f"expected a command in {', '.join(texts)}, met none")
    python = [(document, line, code) for document, text in texts.items() for line, code in blocks(text, document)
              if not sessions.file_name(code)]
    results = [run_python(python)]
    results += [run_session(document, text, options.figures) for document, text in texts.items()]
    passed, failed = (sum(counts) for counts in zip(*results))
    if failed:
        sys.exit(f"{failed} of {passed + failed} blocks of Python and commands failed")
    if not passed:
        sys.exit(f"expected a python block or a command in {', '.join(texts)}, met none")


if __name__ == "__main__":
    main()
