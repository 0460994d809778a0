#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the files of LMGC90 that a run of spheres was exported to: places, velocities and, from these files alone,
Newton's law.

Usage: check_outbox_in_space.py RUN.h5 FOLDER STEP. Over the step before STEP, for each free sphere,
m (V - V-) = h (m g + sum f) and I (w - w-) = h sum l x f, with the forces of Vloc_Rloc.OUT.STEP.
"""
import sys

import h5py
import numpy as np
from check_outbox import lines_of, numbers, numbers_at


def read_bodies(folder):
    density = next(numbers_at(line) for line in lines_of(folder, "BULK_BEHAV.OUT") if "Umas" in line)
    bodies = []
    lines = lines_of(folder, "BODIES.OUT")
    for k, line in enumerate(lines):
        if line.startswith(" RBDY3"):
            bodies.append({"number": int(line[8:15])})
        elif line.startswith(" PLAIN"):
            bodies[-1]["mass"] = density * 4 / 3 * np.pi * numbers(line, 1)[0]**3
            assert lines[k + 1][29:31] == "I1"
            bodies[-1]["inertia"] = density * numbers(lines[k + 1], 3)[0]
        elif line.startswith(" NO6xx"):
            bodies[-1]["place"] = np.array(numbers(line, 3))
        elif line.startswith((" SPHER", " PLANx")):
            bodies[-1]["kind"], bodies[-1]["color"] = line[1:6], line[22:27]
            bodies[-1]["radius"] = numbers(line, 1)[0]
            if line.startswith(" PLANx"):
                bodies[-1]["half"] = numbers(line, 3)
                assert lines[k + 1][29:39] == "localframe"
                bodies[-1]["frame"] = np.array([numbers(lines[k + 2 + j], 3) for j in range(3)]).T
    return bodies


def read_dof(folder, step):
    """Displacements, velocities, frames (columns) and spins along x, y and z."""
    lines = lines_of(folder, f"DOF.OUT.{step}")
    assert int(lines[0][6:15]) == step
    moved, velocity, spin, frame = [], [], [], []
    for k, line in enumerate(lines):
        if not line.startswith(" NO6xx"):
            continue
        assert numbers(lines[k + 1], 3) == [0, 0, 0]
        moved.append(numbers(line, 3))
        velocity.append(numbers(lines[k + 2], 3))
        axes = np.array([numbers(lines[k + 4 + j], 3) for j in range(3)]).T
        assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-6)
        frame.append(axes)
        spin.append(axes @ numbers(lines[k + 3], 3))  # V(4) to V(6) are along the axes of the body
    return np.array(moved), np.array(velocity), np.array(spin), np.array(frame)


def read_contacts(folder, step):
    lines = lines_of(folder, f"Vloc_Rloc.OUT.{step}")
    contacts = []
    for k, line in enumerate(lines):
        if not line.startswith("$icdan"):
            continue
        bodies = lines[k + 2]
        axes = [np.array(numbers(lines[k + 6 + j], 3)) for j in range(4)]
        contacts.append({
            "kind": line[8:13],
            "bodies": (int(bodies[8:13]) - 1, int(bodies[50:55]) - 1),
            "law": bodies[36:41],
            "contactors": (bodies[15:20], bodies[57:62]),
            "status": bodies[71:76],
            "force": numbers(lines[k + 3], 3),
            "velocity": numbers(lines[k + 4], 3),
            "gap": numbers(lines[k + 5], 1)[0],
            "axes": np.array(axes[:3]),  # s, t, n
            "point": axes[3],
        })
    return contacts


def main(run, folder, step):
    step = int(step)
    with h5py.File(run) as file:
        steps = file["steps"]
        h = float(steps["time"][1] - steps["time"][0])
        driven_by = file["system/driven_by"][:]
        at = list(steps["step"][:]).index(step)
        order = np.concatenate([np.flatnonzero(driven_by < 0), np.flatnonzero(driven_by >= 0)])
        free = int(np.sum(driven_by < 0))
        read = lambda *names: np.stack([steps[name][at][order] for name in names], axis=1)
        place, velocity = read("x", "y", "z"), read("velocity_x", "velocity_y", "velocity_z")
        spin, turn = read("spin_x", "spin_y", "spin_z"), read("turn_w", "turn_x", "turn_y", "turn_z")
        status = steps["contacts/status"][slice(*steps["contacts/rows"][at])]
    bodies = read_bodies(folder)
    assert [body["number"] for body in bodies] == list(range(1, len(bodies) + 1))
    moved, after, spinning, frame = read_dof(folder, step)
    _, before, spun, _ = read_dof(folder, step - 1)
    assert len(moved) == len(bodies) > len(order) > free
    start = np.array([body["place"] for body in bodies])
    now = start + moved
    assert np.allclose(now[: len(order)], place, rtol=0, atol=2e-6)
    assert np.allclose(after[:free], velocity[:free], rtol=1e-6, atol=1e-9)
    assert np.allclose(spinning[:free], spin[:free], rtol=1e-5, atol=2e-5)
    assert np.abs(spin[:free]).max() > 0.1
    w, axis = turn[:, :1], turn[:, 1:]
    x = np.array([1.0, 0, 0])
    cross = np.cross(axis, x)
    assert np.allclose(frame[: len(order), :, 0], x + 2 * (w * cross + np.cross(axis, cross)), atol=1e-6)

    contacts = read_contacts(folder, step)
    assert len(contacts) == len(status)
    force, moment = np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))
    pushing, met = 0, set()
    for contact in contacts:
        cd, an = contact["bodies"]
        wall = bodies[an]["kind"] == "PLANx"
        met.add((contact["kind"], contact["law"], contact["status"]))
        assert contact["kind"] == ("SPPLx" if wall else "SPSPx")
        assert contact["contactors"] == ("SPHER", bodies[an]["kind"])
        assert (contact["law"] == "CLB_B") == (bodies[an]["color"] == "BOUND" or bodies[cd]["color"] == "BOUND")
        s, t, n = contact["axes"]
        assert np.allclose(contact["axes"] @ contact["axes"].T, np.eye(3), atol=2e-6), contact
        assert np.allclose(np.cross(t, n), s, atol=1e-6)
        rs, rt, rn = contact["force"]
        assert (contact["status"] == "noctc") == (rn == 0)
        if wall:  # t and n are axes of the plank, when contacts were found: before the end of the step
            assert np.allclose(n, frame[an][:, 2], atol=1e-3) and np.allclose(t, frame[an][:, 0], atol=1e-3)
        # Velocities of the contact are those of the two bodies at their surfaces.
        levers = -bodies[cd]["radius"] * n, bodies[an]["radius"] * n
        if wall:
            levers = levers[0], contact["point"] - now[an]
        speeds = [after[b] + np.cross(spinning[b], lever) for b, lever in zip((cd, an), levers)]
        assert np.allclose(contact["axes"] @ (speeds[0] - speeds[1]), contact["velocity"], atol=5e-5)
        sliding = np.array(contact["velocity"][:2])
        if contact["status"] == "stick":
            assert np.abs(sliding).max() < 1e-5
        if contact["status"] == "slide" and np.linalg.norm(sliding) > 1e-4:  # friction is against it
            against = np.array([rs, rt]) @ sliding / (np.hypot(rs, rt) * np.linalg.norm(sliding))
            assert against < -0.999, against
        total = contact["force"] @ contact["axes"]
        for body, sign, lever in ((cd, 1, levers[0]), (an, -1, levers[1])):
            force[body] += sign * total
            moment[body] += sign * np.cross(lever, total)
        pushing += rn > 0
    assert pushing > free and {kind for kind, _, _ in met} == {"SPSPx", "SPPLx"}, met
    assert {status for _, _, status in met} >= {"stick", "slide"} and {law for _, law, _ in met} == {"CLB_G", "CLB_B"}
    line = next(line for line in lines_of(folder, "BULK_BEHAV.OUT") if "grv1" in line)
    gravity = np.array([float(line[24 + 21 * k:38 + 21 * k].replace("D", "E")) for k in range(3)])
    for body in range(free):
        mass, inertia = bodies[body]["mass"], bodies[body]["inertia"]
        scale = h * (mass * 9.81 + np.abs(force[body]).max())
        change = mass * (after - before)[body] - h * (mass * gravity + force[body])
        assert np.abs(change).max() < 1e-5 * scale, f"body {body + 1}"
        turning = inertia * (spinning - spun)[body] - h * moment[body]
        assert np.abs(turning).max() < 2e-5 * scale * bodies[body]["radius"], f"body {body + 1}: moment"
    # Planks: the face is where the walls are, and what is driven moves.
    assert np.abs(moved[len(order):]).max() > 1e-5 and np.abs(moved[free:len(order)]).max() > 1e-5
    for body, axes in zip(bodies[len(order):], frame[len(order):]):
        assert np.linalg.det(body["frame"]) > 0.999 and np.abs(axes - body["frame"]).max() < 0.1
    assert any(np.abs(axes - body["frame"]).max() > 1e-5
               for body, axes in zip(bodies[len(order):], frame[len(order):]))


if __name__ == "__main__":
    main(*sys.argv[1:])
