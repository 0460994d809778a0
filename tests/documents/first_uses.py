#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Three first uses as a newcomer has them, on a machine with Debian alone: tools/first-uses calls this.

usage: first_uses.py script USE ROOT    writes the session of a use into the root: /root/session, run by bash
       first_uses.py judge USE ROOT FOLDER    compares what happened there; adds a row to FOLDER/first-uses.csv, and
                                        copies the pictures to FOLDER
       first_uses.py table FOLDER       prints FOLDER/first-uses.csv as a table of Markdown
       first_uses.py uses               their names

The commands are those of the site: the block "sh" of the section of docs/start.md that installs packages, then the
tutorial of the use, as a session (sessions.py). A use passes where every command ends well and prints what the tutorial
shows, where its key number is among what was printed, and where its pictures are there and show something.
"""
import csv
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

import lmgc90_tree
import sessions
import snippets

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
INSTALL = "Or install packages"  # the heading in docs/start.md
# Use: what it leads from and to, its tutorial, and the text on a line of output that has its key number.
USES = {
    "grains": ("a CSV of grains to a curve and its best η", "radius.md", "best_eta"),
    "datbox": ("folders of LMGC90 to runs, their convergence and a network", "lmgc90.md", "step 10: velocities"),
    "arrays": ("NumPy arrays to a radius, a mode and a plot", "python.md", "SpectralRadius(value="),
}
COLUMNS = ("first_use", "commands_to_figure", "minutes_to_figure", "minutes_to_install", "commands", "minutes",
           "key_number")


def text_of(name):
    return Path(SOURCE, "docs", name).read_text(encoding="utf-8")


def install_commands():
    """The commands of the section that installs packages, one a line."""
    section = re.search(rf"^### {INSTALL}$(.*?)(?=^#|\Z)", text_of("start.md"), re.MULTILINE | re.DOTALL)
    if not section:
        sys.exit(f"docs/start.md: expected the heading '{INSTALL}'")
    code = snippets.blocks(section.group(1), "docs/start.md", "sh")[0][1]
    lines = code.replace("\\\n", " ").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def steps_of(use):
    """The session of a use: the commands that install come first, and may print what they like."""
    install = [("command", 0, command, ["…"]) for command in install_commands()]
    name = f"tutorials/{USES[use][1]}"
    return install, install + sessions.steps_of(snippets.all_blocks(text_of(name), name))


def write_script(use, root):
    """Beside what a session writes: the moment at which a command ended, and the pictures that are there then."""
    install, steps = steps_of(use)
    folder = os.path.join(root, "root", "session")
    os.makedirs(folder)
    text = "mkdir /root/work\ncd /packages\ndate +%s.%N >/root/session/began\n"
    if lmgc90_tree.needed(text_of(f"tutorials/{USES[use][1]}")):
        with tempfile.TemporaryDirectory() as unpacked:
            tree = lmgc90_tree.find_tree(SOURCE, unpacked)
            if tree is None:
                sys.exit(f"first use '{use}': expected folders of LMGC90 in $LMGC90 or $NSCDD_LMGC90, met none")
            for place in lmgc90_tree.FOLDERS:
                shutil.copytree(os.path.join(tree, place), os.path.join(root, "root", "lmgc90", place))
        text += "export LMGC90=/root/lmgc90\n"
    for k, step in enumerate(steps):
        if k == len(install):
            text += "cd /root/work\n"
        if step[0] == "file":
            Path(folder, f"file-{k}").write_text(step[3], encoding="utf-8")
        text += sessions.script_of(k, step, "/root/session")
        text += f"date +%s.%N >/root/session/{k}.moment; ls *.png >/root/session/{k}.pictures 2>/dev/null\n"
    Path(folder, "session.sh").write_text(text, encoding="utf-8")


def moment(folder, name):
    return float(Path(folder, name).read_text(encoding="utf-8"))


def printed_lines(folder, commands, key):
    """The lines with the text KEY among what the commands of these numbers printed."""
    lines = []
    for k in commands:
        with open(os.path.join(folder, str(k)), encoding="utf-8") as stream:
            lines += [line for line in stream.read().splitlines() if key in line]
    return lines


def shows_something(path):
    """A picture is there, and is not one colour."""
    import matplotlib.image
    return os.path.exists(path) and float(matplotlib.image.imread(path)[..., :3].std()) > 0.02


def judge(use, root, out):
    title, tutorial, key = USES[use]
    install, steps = steps_of(use)
    folder, work = os.path.join(root, "root", "session"), os.path.join(root, "root", "work")
    commands = [k for k, step in enumerate(steps) if step[0] == "command"]
    well = [sessions.judge("start.md" if k < len(install) else tutorial, steps[k], folder, k) for k in commands]
    pictures = sessions.PICTURE.findall(text_of(f"tutorials/{tutorial}"))
    for picture in pictures:
        well.append(shows_something(os.path.join(work, picture)))
        if not well[-1]:
            print(f"{tutorial}: FAILED: no picture {picture}, or an empty one")
        else:
            shutil.copy(os.path.join(work, picture), os.path.join(out, f"{use}-{picture}"))
    numbers = printed_lines(folder, [k for k in commands if any(key in line for line in steps[k][3])], key)
    if not all(well) or not numbers or not pictures:
        sys.exit(f"first use '{use}': {well.count(False)} of {len(well)} checks failed")
    first = next(k for k in range(len(steps)) if os.path.getsize(os.path.join(folder, f"{k}.pictures")) > 0)
    began = moment(folder, "began")
    minutes = [(moment(folder, f"{k}.moment") - began) / 60 for k in (first, len(install) - 1, len(steps) - 1)]
    row = (title, sum(k <= first for k in commands), f"{minutes[0]:.1f}", f"{minutes[1]:.1f}", len(commands),
           f"{minutes[2]:.1f}", " ".join(numbers[0].split()))
    table = os.path.join(out, "first-uses.csv")
    new = not os.path.exists(table)
    with open(table, "a", encoding="utf-8", newline="") as stream:
        csv.writer(stream).writerows(([COLUMNS] if new else []) + [row])


def print_table(folder):
    with open(os.path.join(folder, "first-uses.csv"), encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    print("| from … to … | commands to the first figure | minutes | of these to install | commands in all "
          "| minutes |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row[name] for name in COLUMNS[:-1]) + " |")
    print("\n" + "\n".join(f"{row['first_use']}: {row['key_number']}" for row in rows))


def main():
    match sys.argv[1:]:
        case ["script", use, root] if use in USES:
            write_script(use, root)
        case ["judge", use, root, out] if use in USES:
            judge(use, root, out)
        case ["table", folder]:
            print_table(folder)
        case ["uses"]:
            print("\n".join(USES))
        case _:
            sys.exit("usage: first_uses.py script USE ROOT | judge USE ROOT FOLDER | table FOLDER | uses")


if __name__ == "__main__":
    main()
