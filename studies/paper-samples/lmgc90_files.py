# SPDX-License-Identifier: GPL-3.0-or-later
"""Input folders and outputs of LMGC90: where they are, what they hold, and how far two of them differ."""
import math
import re
import tarfile
from pathlib import Path

# Places in LMGC90's tree of what its archive of folders calls by one name.
PLACES = {"Ddm_exemple1": "src/Sandbox/Ddm/exemple1", "Ddm_exemple100000": "src/Sandbox/Ddm/exemple100000",
          "DDM_DDM_2d_rough_box": "examples/Ateliers/DDM/DDM_2d_rough_box"}


class Missing(Exception):
    """A folder that is not there, in words for the user."""


def unpacked(home, name, work):
    """Unpacks an archive of the folder HOME into WORK, once. Returns whether HOME has it."""
    archive, mark = (Path(home) / name).resolve(), Path(work) / f".{name}"
    if not archive.is_file():
        return False
    if not mark.exists() or mark.read_text() != str(archive):
        Path(work).mkdir(parents=True, exist_ok=True)
        with tarfile.open(archive) as packed:
            packed.extractall(work)
        mark.write_text(str(archive))
    return True


def datbox_of(home, name, work):
    """The folder with BODIES.DAT of the sample NAME. HOME is LMGC90's tree, a folder of folders (NAME/BODIES.DAT), or
    one with their archive datbox.tar.xz (corpus/NAME/BODIES.DAT), which is unpacked into WORK."""
    home, place = Path(home), PLACES[name]
    tried = [home / name, home / place, home / "external/lmgc90_dev-fortran_lib" / place]
    if unpacked(home, "datbox.tar.xz", work):
        tried.append(Path(work) / "corpus" / name)
    for folder in [one for path in tried for one in (path, path / "DATBOX")]:
        if (folder / "BODIES.DAT").is_file():
            return folder.resolve()
    raise Missing(f"{home}: expected LMGC90's tree with {place}, or a folder with {name}/BODIES.DAT or datbox.tar.xz, "
                  "met none of them")


def references_of(home, work):
    """The folder with runs of LMGC90, RUN/iterations.txt ..., or None."""
    if unpacked(home, "reference.tar.xz", work):
        return Path(work) / "reference"
    folder = Path(home) / "reference"
    return folder if folder.is_dir() else None


def number(text):
    return float(text.replace("D", "E"))


def velocities(*paths):
    """V(1) and V(2) of all bodies of files DOF, by the number of the body."""
    found = {}
    for path in paths:
        body = None
        for line in Path(path).read_text().splitlines():
            if match := re.match(r"\s*RBDY[23]\s+(\d+)", line):
                body = int(match.group(1))
            if match := re.search(r"V\(1\)=(.{14}).*V\(2\)=(.{14})", line):
                found[body] = [number(match.group(k)) for k in (1, 2)]
    return found


def reactions(*paths):
    """Forces (normal, tangential) of all contacts of files Vloc_Rloc, N, by the numbers of both bodies, ascending."""
    found = {}
    for path in paths:
        pair = None
        for line in Path(path).read_text().splitlines():
            if match := re.match(r"\s*RBDY2\s+(\d+)\s+\S+\s+\d+\s+\S+\s+RBDY2\s+(\d+)", line):
                pair = tuple(sorted(int(match.group(k)) for k in (1, 2)))
            if match := re.search(r"rlt/H(.{14})\s*rln/H(.{14})", line):
                found[pair] = [number(match.group(2)), number(match.group(1))]
    return found


def gaps(path):
    """Gaps of all contacts of a file Vloc_Rloc, m, by the numbers of both bodies, ascending."""
    found = {}
    pair = None
    for line in Path(path).read_text().splitlines():
        if match := re.match(r"\s*RBDY2\s+(\d+)\s.*RBDY2\s+(\d+)\s", line):
            pair = tuple(sorted(int(match.group(k)) for k in (1, 2)))
        if match := re.match(r"\s*gapTT(.{14})", line):
            found[pair] = number(match.group(1))
    return found


def distance(one, other):
    """|one - other| / |other| over the keys of OTHER and of ONE; what one of them lacks is 0."""
    keys = one.keys() | other.keys()
    zero = [0.0, 0.0]
    difference = math.hypot(*(a - b for k in keys for a, b in zip(one.get(k, zero), other.get(k, zero))))
    return difference / math.hypot(*(v for k in other for v in other[k]))
