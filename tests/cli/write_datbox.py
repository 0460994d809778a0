#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the beginning of a run as a DATBOX of LMGC90, by its formats and with its seven digits.

Usage: write_datbox.py RUN.h5 FOLDER. Free disks are bodies of one disk DISKx, disks of a boundary are one driven body
(a cluster of DISKb), and walls are planks JONCx. Of motions it knows velocities that are constant or rise from rest.
"""
import math
import os
import sys
import tomllib

import h5py
import numpy as np

DENSITY = 2000.0
HALF_LENGTH, HALF_THICKNESS = 50.0, 0.125


def number(x):
    """Fortran's D14.7."""
    if x == 0:
        return " 0.0000000D+00"
    exponent = math.floor(math.log10(abs(x))) + 1
    digits = f"{x / 10.0 ** exponent:10.7f}"
    if digits in (" 1.0000000", "-1.0000000"):
        exponent += 1
        digits = f"{x / 10.0 ** exponent:10.7f}"
    return f"{digits}D{exponent:+03d}"


def named(*pairs):
    return "".join(f"  {name}{number(value)}" for name, value in pairs)


def body(index, average, gyration, place, contactors):
    lines = ["$bdyty", f" RBDY2{index:7d}", "$blmty"]
    lines.append(" PLAIN      1  behav  STONE" + named(("avrd=", average), ("gyrd=", gyration)))
    coordinates = zip(("coo1=", "coo2=", "coo3="), place)
    lines += ["$nodty", " NO3xx      1              " + named(*coordinates), "$tacty", *contactors, "$$$$$$", "      "]
    return "\n".join(lines) + "\n"


def drives(motion):
    """Rows of DRV_DOF.DAT: constant, or rising from rest until the second time."""
    times = [row[0] for row in motion]
    velocity = motion[-1][1:]
    ramp = (0.0, 1.0 / times[1]) if len(motion) == 2 else (1.0, 0.0)
    assert len(motion) == 1 or (times[0] == 0 and motion[0][1:] == [0, 0, 0])
    rows = []
    for k, value in enumerate(velocity):
        values = (value, 0.0, 0.0, 0.0, *ramp)
        rows.append(f" vlocy  {k + 1:5d}" + "".join(" " + number(v) for v in values))
    return rows


def motion_of(boundary):
    if "motion" in boundary:
        return boundary["motion"]
    return [[0, *boundary.get("velocity", [0, 0]), boundary.get("spin", 0)]]


def main(run, folder):
    with h5py.File(run) as file:
        case = tomllib.loads(file["case"][()].decode())
        system = {name: file["system"][name][:] for name in ("radius", "mass", "driven_by")}
        walls = {name: array[:] for name, array in file["system/walls"].items()}
        start = {name: file["steps"][name][0] for name in ("x", "y", "velocity_x", "velocity_y")}
    os.makedirs(folder)
    free = np.flatnonzero(system["driven_by"] < 0)
    bodies, initial, driven = [], [], []
    for i in free:
        radius = system["radius"][i]
        average = math.sqrt(system["mass"][i] / (DENSITY * math.pi))
        disk = " DISKx      1  color  BLUEx" + named(("byrd=", radius))
        bodies.append(body(len(bodies) + 1, average, radius / math.sqrt(2), (start["x"][i], start["y"][i], 0), [disk]))
        velocity = (start["velocity_x"][i], start["velocity_y"][i], 0)
        initial += ["$bdyty", f" RBDY2  {len(bodies):7d}", "$nodty"]
        initial.append(" NO3xx      1              " + named(*zip(("X(1)=", "X(2)=", "X(3)="), (0, 0, 0))))
        initial.append(" " * 27 + named(*zip(("V(1)=", "V(2)=", "V(3)="), velocity)))
        initial += ["$$$$$$", "      "]
    for b, boundary in enumerate(case.get("boundary", [])):
        if boundary["shape"] == "wall":
            wall = list(walls["boundary"]).index(b)
            normal = (walls["normal_x"][wall], walls["normal_y"][wall])
            place = [walls[f"point_{axis}"][wall] - HALF_THICKNESS * normal[k] for k, axis in enumerate("xy")]
            place.append(math.atan2(-normal[0], normal[1]))
            contactors = [" JONCx      1  color  REDxx" + named(("ax1 =", HALF_LENGTH), ("ax2 =", HALF_THICKNESS))]
        else:
            place = [*boundary.get("centre", [0, 0]), 0]
            contactors = []
            for i in np.flatnonzero(system["driven_by"] == b):
                contactors.append(f" DISKb  {len(contactors) // 2 + 1:5d}  color  REDxx"
                                  + named(("byrd=", system["radius"][i])))
                shift = (start["x"][i] - place[0], start["y"][i] - place[1])
                contactors.append(" " * 27 + named(("coo1=", shift[0]), ("coo2=", shift[1])))
        bodies.append(body(len(bodies) + 1, 1, 1, place, contactors))
        driven += ["$bdyty", f" RBDY2  {len(bodies):7d}", "$nodty", " NO3xx      1", "$dofty  numbr [CT ...]"]
        driven += [*drives(motion_of(boundary)), "$$$$$$", "      "]
    write(folder, "BODIES.DAT", "".join(bodies))
    write(folder, "DOF.INI", "$steps      0                time= 0.0000000D+00\n\n" + "\n".join(initial) + "\n")
    write(folder, "DRV_DOF.DAT", "\n".join(driven) + "\n")
    write_laws(folder, case)


def write_laws(folder, case):
    interaction = case["interaction"]
    gravity = case["dynamics"].get("gravity", [0, -9.81])
    text = "$gravy\n" + " " * 17 + named(("grv1=", gravity[0]), ("grv2=", gravity[1]), ("grv3=", 0)) + "\n\n"
    text += f"$behav  lawty\n STONE  {'RIGID':30}" + named(("Umas=", DENSITY)) + "\n"
    write(folder, "BULK_BEHAV.DAT", text)
    friction = interaction["friction"]
    restitution = interaction.get("restitution", 0)
    text = ""
    at_boundaries = interaction.get("boundary_friction", -1)
    for name, value in (("grain", friction), ("borde", friction if at_boundaries < 0 else at_boundaries)):
        if restitution > 0:
            tangential = interaction.get("tangential_restitution", 0)
            text += f"$behav  lawty\n {name}  {'RST_CLB':30}" + named(("rstn=", restitution), ("rstt=", tangential))
            text += "\n" + " " * 38 + named(("fric=", value)) + "\n\n"
        else:
            text += f"$behav  lawty\n {name}  {'IQS_CLB':30}" + named(("fric=", value)) + "\n\n"
    pairs = (("grain", "DISKx", "BLUEx"), ("borde", "DISKx", "REDxx"), ("borde", "JONCx", "REDxx"))
    for law, contactor, colour in pairs:
        text += "$seety\n cdbdy  cdtac  cdcol  behav  anbdy  antac  ancol       alert\n"
        text += f" RBDY2  DISKx  BLUEx  {law}  RBDY2  {contactor}  {colour}      {number(0.01)}\n\n"
    write(folder, "TACT_BEHAV.DAT", text)


def write(folder, name, text):
    with open(os.path.join(folder, name), "w", encoding="ascii") as file:
        file.write("! a remark\n" + text)


main(*sys.argv[1:])
