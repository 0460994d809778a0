# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours as people see them: simulated colour blindness, distances and contrast."""
import itertools

import numpy as np

# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, A physiologically-based model for simulation of color vision
# deficiency, IEEE Transactions on Visualization and Computer Graphics 15 (2009), severity 1.0, on linear RGB.
VISION = {
    "normal": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                            [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                              [-0.011820, 0.042940, 0.968881]]),
    "tritanopia": np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                            [0.004733, 0.691367, 0.303900]]),
}
# sRGB to XYZ, white D65.
XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                [0.0193339, 0.1191920, 0.9503041]])


def linear(rgb):
    """Linear RGB in [0, 1] of (r, g, b) in 0..255."""
    c = np.asarray(rgb, dtype=float) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def lab(linear_rgb):
    """CIE L*a*b*, of which equal distances look about equally far."""
    ratio = XYZ @ np.clip(linear_rgb, 0, 1) / (XYZ @ np.ones(3))
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def closest(colours):
    """For each kind of vision the smallest distance of two of the colours, and these two."""
    found = {}
    for name, matrix in VISION.items():
        seen = [lab(matrix @ linear(c)) for c in colours]
        found[name] = min((float(np.linalg.norm(seen[i] - seen[j])), (i, j))
                          for i, j in itertools.combinations(range(len(colours)), 2))
    return found


def contrast(first, second):
    """Contrast ratio of WCAG 2, between 1 and 21."""
    a, b = sorted((np.array([0.2126, 0.7152, 0.0722]) @ linear(c) + 0.05 for c in (first, second)), reverse=True)
    return float(a / b)
