# SPDX-License-Identifier: GPL-3.0-or-later
"""What the figures share: journal look, reading of tables, limits on log axes, saving."""
import argparse
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

MM = 1 / 25.4  # widths are given in mm, matplotlib counts inches
COLUMN, COLUMN_AND_HALF, FULL = 88 * MM, 140 * MM, 190 * MM

# Flexibilities epsilon and eta as the program's tables declare them; one place, so that all labels agree.
FLEXIBILITY = r"\mathrm{(1/kg)}"
EPSILON_LABEL = rf"flexibility of the law, $\varepsilon$ ${FLEXIBILITY}$"
ETA_LABEL = rf"flexibility of Stage 2, $\eta$ ${FLEXIBILITY}$"

GREY, LIGHT = "0.5", "0.75"
# The line styles of the paper (dot, dash, solid) carry the meaning; colours only help on a screen.
STYLES = {
    4: {"color": "#b03a2e", "linestyle": (0, (1, 1.3)), "linewidth": 1.5},
    8: {"color": "#1f5f99", "linestyle": (0, (4.5, 1.8))},
    12: {"color": "black", "linestyle": "-"},
}
OTHER_STYLE = {"color": "#3d7a3d", "linestyle": (0, (5, 1.5, 1, 1.5))}
FORMATS = ("svg", "png", "pdf")
BAND = "curve_low curve_high"  # columns of `nscdd sweep --curve`

plt.rcParams.update({
    "font.family": "STIXGeneral",  # shipped with matplotlib, so the same on every machine
    "mathtext.fontset": "stix",
    "font.size": 9,
    "axes.labelsize": 9,
    "axes.titlesize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "legend.labelspacing": 0.35,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "savefig.dpi": 200,
    "svg.fonttype": "path",  # glyphs as outlines: no font needed to view the file
    "svg.hashsalt": "nscdd",  # reproducible ids
    "pdf.fonttype": 42,
})


class DataError(Exception):
    """A table that is missing or does not hold what a figure needs."""


class NoTable(DataError):
    """A table that is not there."""


class NoRows(DataError):
    """A table that holds its line of names alone."""


def _number(text):
    return float(text)


def _flag(text):
    return {"true": True, "false": False}[text]


def read_table(results, name, numbers="", flags="", texts="", if_there=""):
    """Rows of RESULTS/NAME as dictionaries of the named columns (space-separated lists). IF_THERE: columns of numbers
    that a table may lack."""
    path = os.path.join(results, name)
    wanted = {c: _number for c in numbers.split()}
    wanted.update({c: _flag for c in flags.split()})
    wanted.update({c: str for c in texts.split()})
    kinds = {_number: "a number", _flag: "true or false"}
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file, strict=True)
            wanted.update({c: _number for c in if_there.split() if c in (reader.fieldnames or [])})
            missing = [c for c in wanted if c not in (reader.fieldnames or [])]
            if missing:
                raise DataError(f"{path}: no column '{missing[0]}'")
            rows, unconverged = [], 0
            for raw in reader:
                at = f"{path}: line {reader.line_num}"
                if None in raw:
                    raise DataError(f"{at}: more cells than columns, after column '{reader.fieldnames[-1]}'")
                cut = next((c for c in reader.fieldnames if raw[c] is None), None)
                if cut:
                    raise DataError(f"{at}, column '{cut}': the row ends before it")
                row = {}
                for column, convert in wanted.items():
                    try:
                        row[column] = convert(raw[column])
                    except (ValueError, KeyError):
                        raise DataError(f"{at}, column '{column}': '{raw[column]}' is not "
                                        f"{kinds[convert]}") from None
                rows.append(row)
                unconverged += raw.get("converged") == "false"
    except FileNotFoundError as error:
        raise NoTable(f"{path}: {error.strerror}") from None
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}") from None
    except (csv.Error, UnicodeDecodeError) as error:
        raise DataError(f"{path}: not a CSV table ({error})") from None
    if not rows:
        raise NoRows(f"{path}: no rows")
    if unconverged:
        print(f"{path}: {unconverged} of {len(rows)} rows did not converge", file=sys.stderr)
    return rows


def read_radii(results, name, swept, others=""):
    """A table of spectral radii: its rows, and the smallest and largest positive finite value of the column
    SWEPT. OTHERS: further columns of numbers."""
    rows = read_table(results, name, texts="case", numbers=f"grains spectral_radius {swept} {others}", if_there=BAND)
    values = column(finite(rows, swept), swept)
    if not len(values):
        raise DataError(f"{os.path.join(results, name)}: column '{swept}' has no positive finite value")
    return rows, (values.min(), values.max())


def by_case(rows):
    """(number of disks, rows) of every case, in the order of the table."""
    cases = {}
    for row in rows:
        cases.setdefault(row["case"], []).append(row)
    return [(int(some[0]["grains"]), some) for some in cases.values()]


def where(rows, **values):
    return [row for row in rows if all(row[c] == v for c, v in values.items())]


def need(results, name, rows, **values):
    """The rows of these values, of which there must be some."""
    found = where(rows, **values)
    if not found:
        wanted = " and ".join(f"{v} in column '{c}'" for c, v in values.items())
        raise DataError(f"{os.path.join(results, name)}: no row with {wanted}")
    return found


def column(rows, name):
    return np.array([row[name] for row in rows])


def finite(rows, parameter):
    """Rows of a sweep at positive finite values of PARAMETER, in increasing order."""
    return sorted((r for r in rows if 0 < r[parameter] < np.inf), key=lambda r: r[parameter])


def curve(rows, parameter, value="spectral_radius"):
    """Abscissae and ordinates of a sweep at positive finite values of PARAMETER."""
    some = finite(rows, parameter)
    return column(some, parameter), column(some, value)


def band(axes, rows, parameter, disks, floor=-np.inf):
    """Fills the band that a table of `nscdd sweep --curve` proves the curve to lie in; draws nothing where the table has
    no such columns. Its edges are straight over the logarithm of PARAMETER from row to row."""
    some = finite(rows, parameter)
    if not some or any(name not in row for row in some for name in BAND.split()):
        return
    x = np.log(column(some, parameter))
    between = np.union1d(x, np.linspace(x[0], x[-1], 2000))  # on a log axis of the radius the edges are curved
    low, high = (np.maximum(np.interp(between, x, column(some, name)), floor) for name in BAND.split())
    axes.fill_between(np.exp(between), low, high, color=colour(disks), alpha=0.35, linewidth=0, zorder=1.5)


def radii(rows, **values):
    """Radii of the rows of these values."""
    return column(where(rows, **values), "spectral_radius")


def iterations(rows, accuracy=1e-6, radius="subdominant_radius"):
    """Iterations that the radius predicts for a reduction of the error by ACCURACY, ln(accuracy)/ln(rho); inf
    where rho >= 1. Unit eigenvalues (forces that the rigid networks carry either way) are left out."""
    rho = column(rows, radius)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rho < 1, np.log(accuracy) / np.log(rho), np.inf)


def slope(x, y):
    """Exponent of the power law fitted to Y against X by least squares in logarithms."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def case_style(disks):
    return {"label": f"{disks} disks", "dash_capstyle": "butt", **STYLES.get(disks, OTHER_STYLE)}


def colour(disks):
    return STYLES.get(disks, OTHER_STYLE)["color"]


def decade(exponent):
    return {0: "1", 1: "10"}.get(exponent, f"$10^{{{exponent}}}$")


def log_axis(axis, low, high, limit=None, end=None, every=1):
    """Log axis from LOW to HIGH, decades labelled EVERY so many. LIMIT, "0" or "∞", adds a tick for that value,
    which a log axis cannot hold, beyond a break at END, "low" or "high". Returns the position of that tick."""
    axes, horizontal = axis.axes, axis.axis_name == "x"
    axes.set(**{f"{axis.axis_name}scale": "log"})
    exponents = range(int(np.ceil(np.log10(low) - 1e-9)), int(np.floor(np.log10(high) + 1e-9)) + 1)
    ticks = {10.0**e: decade(e) for e in exponents if e % every == 0}
    minor = [10.0**e for e in exponents if e % every]
    if every == 1:
        minor = [m * 10.0**e for e in range(exponents[0] - 1, exponents[-1] + 1) for m in range(2, 10)]
        minor = [m for m in minor if low <= m <= high]
    position = None
    if limit:
        step = (high / low)**0.11
        position, low, high = ((low / step, low / step**1.5, high) if end == "low" else
                               (high * step, low, high * step**1.5))
        ticks[position] = f"${limit}$" if limit != "∞" else r"$\infty$"
        # break sign: the spines end and go on
        gap = position * step**(0.5 if end == "low" else -0.5)
        for side in (0, 1):
            point = ([gap], [side]) if horizontal else ([side], [gap])
            transform = axes.get_xaxis_transform() if horizontal else axes.get_yaxis_transform()
            strokes = ("s", 3, "white"), ([(-2, -3), (0, 3)], 4, "black"), ([(0, -3), (2, 3)], 4, "black")
            for marker, size, edge in strokes:
                axes.plot(*point, marker=marker, markersize=size, color="white", markeredgecolor=edge,
                          markeredgewidth=0.6, linestyle="none", transform=transform, clip_on=False, zorder=5)
    getattr(axes, f"set_{axis.axis_name}lim")(low, high)
    axis.set_ticks(list(ticks), labels=list(ticks.values()))
    axis.set_ticks(minor, labels=[""] * len(minor), minor=True)
    return position


def points(axes, x, y, disks):
    """Dots that stand out of the curve they lie on."""
    axes.plot(x, y, "o", color=colour(disks), markersize=4.6, markeredgecolor="white", markeredgewidth=0.5,
              zorder=6)


def limit_points(axes, position, values, disks, size=4):
    """Open circles at the limit tick of a log axis."""
    if not len(values):
        return
    axes.plot(np.full(len(values), position), values, "o", color=colour(disks), markersize=size,
              markerfacecolor="white", markeredgewidth=0.9 if size >= 4 else 0.6, clip_on=False, zorder=6)


def convergence_limit(axes):
    """The line rho = 1: above it the algorithm diverges."""
    axes.axhline(1, color=GREY, linewidth=0.6, zorder=0.5)


def panel(axes, letter, text=""):
    axes.set_title(f"({letter}) {text}".rstrip(), loc="left", pad=4)


def figure(width, height_mm, rows=1, columns=1, **options):
    fig, axes = plt.subplots(rows, columns, figsize=(width, height_mm * MM), layout="constrained", **options)
    fig.get_layout_engine().set(w_pad=2 * MM, h_pad=1.5 * MM)
    return fig, axes


def legend_above(fig, handles, labels, columns, **options):
    """Legend of a figure of several panels, in a strip of its own at the top."""
    strip = 5.5 * -(-len(handles) // columns) * MM / fig.get_figheight()
    fig.get_layout_engine().set(rect=(0, 0, 1, 1 - strip))
    fig.legend(handles, labels, loc="upper center", ncol=columns, columnspacing=1.6, borderaxespad=0.3,
               **options)


def save(fig, output, name, formats):
    """Writes OUTPUT/NAME.FORMAT, the same bytes for the same data; returns the paths."""
    paths = []
    for kind in formats:
        # No date and no version: a figure changes only with its data.
        metadata = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None},
                    "pdf": {"CreationDate": None, "Creator": None, "Producer": None}}[kind]
        paths.append(os.path.join(output, f"{name}.{kind}"))
        fig.savefig(paths[-1], metadata=metadata)
    plt.close(fig)
    return paths


def formats_of(text):
    kinds = text.split(",")
    for kind in kinds:
        if kind not in FORMATS:
            raise argparse.ArgumentTypeError(f"'{kind}' is none of {', '.join(FORMATS)}")
    return kinds


def arguments(description):
    """The command line that all scripts of figures share."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("results", metavar="RESULTS", help="folder of the tables, RESULTS/STUDY/TABLE.csv")
    parser.add_argument("output", metavar="OUTPUT", help="folder for the figures, made if missing")
    parser.add_argument("--format", type=formats_of, default=["svg", "png"], metavar="LIST",
                        help="comma-separated list of svg, png, pdf (default svg,png)")
    return parser


def draw_each(draws, options):
    """Calls DRAW(results, output, formats), which returns the files written, and prints their names as soon as they
    are there. A figure that cannot be drawn does not stop the others; the status is then 2."""
    status = 0
    for draw in draws:
        try:
            os.makedirs(options.output, exist_ok=True)
            for path in draw(options.results, options.output, options.format):
                print(path, flush=True)
        except DataError as error:
            print(f"error: {error}", file=sys.stderr)
            status = 2
        except OSError as error:
            print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
            status = 2
    return status


def run(description, *draws):
    """Command line of a script that draws one figure or a few."""
    return draw_each(draws, arguments(description).parse_args())
