#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the files of LMGC90 that a run was exported to: places, velocities and, from these files alone, Newton's law.

Usage: check_outbox.py RUN.h5 FOLDER STEP. Over the step before STEP, for each free disk,
m (V - V-) = h (m g + sum f) and I (w - w-) = h sum R f_t, with the forces of Vloc_Rloc.OUT.STEP.
"""
import os
import sys

import h5py
import numpy as np


def lines_of(folder, name):
    with open(os.path.join(folder, name), encoding="ascii") as file:
        return [line.rstrip("\n") for line in file if line.strip() and line[0] != "!"]


def numbers(line, count):
    """Fields D14.7 in columns 35, 56 and 77."""
    return [float(line[34 + 21 * k : 48 + 21 * k].replace("D", "E")) for k in range(count)]


def read_bodies(folder):
    density = next(numbers_at(line) for line in lines_of(folder, "BULK_BEHAV.OUT") if "Umas" in line)
    bodies = []
    for line in lines_of(folder, "BODIES.OUT"):
        if line.startswith(" RBDY2"):
            bodies.append({"disks": 0})
        elif line.startswith(" PLAIN"):
            average, gyration = numbers(line, 2)
            bodies[-1]["mass"] = density * np.pi * average**2
            bodies[-1]["inertia"] = bodies[-1]["mass"] * gyration**2
        elif line.startswith(" NO3xx"):
            bodies[-1]["place"] = np.array(numbers(line, 3))
        elif line.startswith((" DISKx", " DISKb")):
            bodies[-1]["radius"] = numbers(line, 1)[0]
            bodies[-1]["disks"] += 1
    return bodies


def numbers_at(line):
    return float(line[45:59].replace("D", "E"))


def gravity_of(folder):
    line = next(line for line in lines_of(folder, "BULK_BEHAV.OUT") if "grv1" in line)
    return np.array([float(line[24 + 21 * k : 38 + 21 * k].replace("D", "E")) for k in range(2)])


def read_dof(folder, step):
    lines = lines_of(folder, f"DOF.OUT.{step}")
    assert int(lines[0][6:15]) == step
    moved = [numbers(line, 3) for line in lines if line.startswith(" NO3xx")]
    velocity = [numbers(line, 3) for line in lines if line.startswith(" " * 29 + "V(1)=")]
    return np.array(moved), np.array(velocity)


def read_contacts(folder, step):
    lines = lines_of(folder, f"Vloc_Rloc.OUT.{step}")
    contacts = []
    for k, line in enumerate(lines):
        if not line.startswith("$icdan"):
            continue
        bodies = lines[k + 2]
        contacts.append({
            "kind": line[8:13],
            "bodies": (int(bodies[8:13]) - 1, int(bodies[43:48]) - 1),
            "status": bodies[64:69],
            "force": numbers(lines[k + 3], 2),
            "velocity": numbers(lines[k + 4], 2),
            "gap": numbers(lines[k + 5], 1)[0],
            "normal": np.array(numbers(lines[k + 6], 2)),
            "point": np.array(numbers(lines[k + 7], 2)),
        })
    return contacts


def main(run, folder, step):
    step = int(step)
    with h5py.File(run) as file:
        h = float(file["steps/time"][1] - file["steps/time"][0])
        free = np.flatnonzero(file["system/driven_by"][:] < 0)
        at = list(file["steps/step"][:]).index(step)
        place = np.stack([file["steps"][name][at][free] for name in ("x", "y", "angle")], axis=1)
        velocity = np.stack([file["steps"][name][at][free] for name in ("velocity_x", "velocity_y", "spin")], axis=1)
        status = file["steps/contacts/status"][slice(*file["steps/contacts/rows"][at])]
    bodies = read_bodies(folder)
    moved, after = read_dof(folder, step)
    _, before = read_dof(folder, step - 1)
    assert len(moved) == len(after) == len(bodies)
    start = np.array([body["place"] for body in bodies])
    assert np.allclose((start + moved)[: len(free)], place, rtol=0, atol=2e-6)
    assert np.allclose(after[: len(free)], velocity, rtol=1e-6, atol=1e-9)

    contacts = read_contacts(folder, step)
    assert len(contacts) == len(status)
    total = np.zeros((len(bodies), 3))
    pushing = 0
    for contact in contacts:
        cd, an = contact["bodies"]
        rt, rn = contact["force"]
        normal = contact["normal"]
        tangent = np.array([normal[1], -normal[0]])
        assert abs(normal @ normal - 1) < 1e-6
        assert (contact["kind"] == "DKJCx") == (bodies[an]["disks"] == 0)
        assert (contact["status"] == "noctc") == (rn == 0)
        if contact["status"] == "stick":
            assert abs(contact["velocity"][0]) < 1e-5
        if contact["status"] in ("slifw", "slibw"):
            assert (rt < 0) == (contact["status"] == "slifw")
            assert contact["velocity"][0] * rt < 1e-9
        force = rt * tangent + rn * normal
        for body, sign in ((cd, 1), (an, -1)):
            if body < len(free):
                total[body, :2] += sign * force
                total[body, 2] += bodies[body]["radius"] * rt
        pushing += rn > 0
    assert pushing > len(free)
    gravity = gravity_of(folder)
    for body in range(len(free)):
        mass, inertia = bodies[body]["mass"], bodies[body]["inertia"]
        change = (after - before)[body] * [mass, mass, inertia]
        weight = np.array([*(mass * gravity), 0])
        scale = h * (np.abs(weight).max() + np.abs(total[body]).max())
        assert np.abs(change - h * (weight + total[body])).max() < 1e-5 * scale, f"body {body + 1}"
    # What is driven moves with its boundary: the side turns, the wall is pushed in.
    assert np.abs(moved[len(free) :]).max() > 1e-5


if __name__ == "__main__":
    main(*sys.argv[1:])
