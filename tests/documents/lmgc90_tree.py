# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders of LMGC90's public tree, where its repository has them, for the tutorial that starts from $LMGC90."""
import os
import tarfile
from pathlib import Path

# Place in the tree: name of the folder in $NSCDD_LMGC90, or in its archive datbox.tar.xz (tests/lmgc90).
FOLDERS = {"examples/RIGID_2D/1024DK_BoxJC": "RIGID_2D_1024DK_BoxJC", "src/Sandbox/Ddm/exemple1": "Ddm_exemple1"}


def needed(text):
    """Whether a document starts from the tree."""
    return "$LMGC90/" in text


def find_tree(source, folder):
    """$LMGC90, or a tree made in FOLDER of the folders that there are; None without them."""
    if "LMGC90" in os.environ:
        return os.environ["LMGC90"]
    home = Path(os.environ.get("NSCDD_LMGC90") or Path(source).parent / "shared" / "lmgc90")
    if (home / "datbox.tar.xz").is_file():
        with tarfile.open(home / "datbox.tar.xz") as packed:
            packed.extractall(folder, [one for one in packed if set(Path(one.name).parts) & set(FOLDERS.values())])
        home = Path(folder, "corpus")
    if not all((home / name).is_dir() for name in FOLDERS.values()):
        return None
    for place, name in FOLDERS.items():
        Path(folder, "tree", place).mkdir(parents=True)
        os.symlink(home / name, Path(folder, "tree", place, "DATBOX"))
    return str(Path(folder, "tree"))
