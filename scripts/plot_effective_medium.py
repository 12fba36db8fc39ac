#!/usr/bin/python3
"""Draws results/effective_medium: what each scheme says about wet clay, from `argil probe effective_medium`.

    scripts/plot_effective_medium.py [--argil build/bin/argil] [--output results/effective_medium]
"""
import argparse
import json
import subprocess
from pathlib import Path

import numpy as np

from argil_plot import COLOURS, GREY, MILLIMETRES, plt, save
from argil.plot.style import entries_of

SCHEMES = ("dilute", "dilute_strain", "mori_tanaka", "self_consistent", "differential", "hs_lower", "hs_upper")
NAMES = {"dilute": "dilute (eq. 6)", "dilute_strain": "dilute in strain", "mori_tanaka": "Mori–Tanaka",
         "self_consistent": "self-consistent", "differential": "differential", "hs_lower": "Hashin–Shtrikman −",
         "hs_upper": "Hashin–Shtrikman +"}
STYLE = {"dilute": (COLOURS[0], "-"), "dilute_strain": (COLOURS[4], (0, (5, 1.5))), "mori_tanaka": (COLOURS[1], "-"),
         "self_consistent": (COLOURS[2], (0, (5, 1.5, 1.5, 1.5))), "differential": (COLOURS[3], "-"),
         "hs_lower": (GREY, (0, (1.5, 1.5))), "hs_upper": (GREY, (0, (8, 2)))}
FAILURE = {"above_voigt": "#F4B183", "not_positive_definite": "#C00000"}
POISSON = (0.25, 0.30, 0.35, 0.40, 0.45)
YOUNG = 1e5  # [Pa]
WATER = 2.2e9  # [Pa]
PHI = np.linspace(0.0, 0.7, 281)
PHI_REACHED = 0.4  # porosity by default


def probe(argil, cases):
    text = subprocess.run([argil, "probe", "effective_medium"], input=json.dumps({"cases": cases}), text=True,
                          check=True, capture_output=True).stdout
    return json.loads(text)["results"]


def curve(argil, nu, fluid, scheme):
    """K, G, E, ν and status against PHI, and the first φ of each failure."""
    def ask(places):
        return probe(argil, [dict(youngs_modulus_Pa=YOUNG, poissons_ratio=nu, fluid_bulk_modulus_Pa=fluid,
                                  phi=float(phi), scheme=scheme) for phi in places])
    results = ask(PHI)
    K = np.array([r["bulk_modulus_Pa"] for r in results])
    G = np.array([r["shear_modulus_Pa"] for r in results])
    with np.errstate(divide="ignore", invalid="ignore"):
        E = 9 * K * G / (3 * K + G)
        ratio = (3 * K - 2 * G) / (2 * (3 * K + G))
    status = [r["status"] for r in results]
    return {"K": K, "G": G, "E": E, "nu": ratio, "status": status,
            **{name: find_first(ask, status, name) for name in FAILURE}}


def find_first(ask, status, wanted):
    """First φ of a status (a worse one counts as well where it comes at once), to 1e-8; None without."""
    rank = {"ok": 0, "above_voigt": 1, "not_positive_definite": 2}
    if wanted not in status:
        return None
    i = status.index(wanted)
    low, high = PHI[max(i - 1, 0)], PHI[i]
    for _ in range(3):  # a 64th of the interval each time: to 1e-8
        places = np.linspace(low, high, 65)
        found = [rank[r["status"]] >= rank[wanted] for r in ask(places[1:])].index(True)
        low, high = places[found], places[found + 1]
    return high


def at_porosity(data, key):
    """Value at the default porosity; None where it is no stiffness there."""
    i = np.searchsorted(PHI, PHI_REACHED - 1e-9)
    return None if data["status"][i] == "not_positive_definite" else data[key][i]


def put_legend(figure, handles, labels, columns, height):
    """Legend in a strip of its own below the axes."""
    figure.get_layout_engine().set(rect=(0, height, 1, 1 - height))
    figure.legend(handles, labels, loc="lower center", ncols=columns)


def shade(axes, data):
    """Where the paper's scheme leaves the bounds, and where it is no stiffness any more; whether it comes to that."""
    above, broken = data["above_voigt"], data["not_positive_definite"]
    if above is not None:
        axes.axvspan(above, broken if broken is not None else PHI[-1], color=FAILURE["above_voigt"], alpha=0.3, lw=0)
    if broken is not None:
        axes.axvspan(broken, PHI[-1], color=FAILURE["not_positive_definite"], alpha=0.25, lw=0)
    return broken is not None


def break_at_pole(values):
    """A curve in its pieces: nothing joins the two sides of a pole, where the sign changes from one point to the next."""
    is_past = np.concatenate([[False], values[1:] * values[:-1] < 0.0])
    return np.where(is_past, np.nan, values)


def mark_ends(axes, data, values, colour):
    """On a curve: a circle where it leaves the Voigt bound, a cross where it stops being a stiffness; at the edge of the axes
    where the curve has left them before."""
    for status, marker, size in (("above_voigt", "o", 4), ("not_positive_definite", "x", 6)):
        if data[status] is not None:
            good = np.isfinite(values) & (PHI <= data[status])
            value = np.clip(np.interp(data[status], PHI[good], values[good]), *axes.get_ylim())
            axes.plot(data[status], value, marker=marker, color=colour, ms=size, mfc="white", mew=1.3, ls="", zorder=5, clip_on=False)


def set_heights(axes, key, nu, fluid):
    if key == "nu":
        axes.set_ylim(min(0.1, nu - 0.1), 0.52)
    elif key == "K" and fluid > 0:
        axes.set_yscale("symlog", linthresh=1.0)
        axes.set_ylim(-300, 300)
    else:
        axes.set_ylim(-0.1, 1.05)


def draw_moduli(argil, nu, output):
    figure, rows = plt.subplots(2, 4, figsize=(240 * MILLIMETRES, 122 * MILLIMETRES), sharex=True)
    table, is_broken = [], False
    for axes, (water, fluid) in zip(rows, (("drained", 0.0), ("undrained", WATER))):
        data = {scheme: curve(argil, nu, fluid, scheme) for scheme in SCHEMES + ("voigt", "reuss")}
        dry = {key: data["voigt"][key][0] for key in ("K", "G", "E")}
        for ax, key in zip(axes, ("K", "G", "E", "nu")):
            unit = 1.0 if key == "nu" else dry[key]
            set_heights(ax, key, nu, fluid)
            is_broken |= shade(ax, data["dilute"])
            if key != "nu":
                ax.fill_between(PHI, data["reuss"][key] / unit, data["voigt"][key] / unit, color="#DDE6EE", lw=0)
            for scheme in SCHEMES:
                values = data[scheme][key] / unit
                bad = np.array([s == "not_positive_definite" for s in data[scheme]["status"]])
                # What is no stiffness has no moduli; eq. 6's alone are shown, for its E looks healthy there.
                if key == "nu" or scheme != "dilute":
                    values = np.where(bad, np.nan, values)
                colour, dash = STYLE[scheme]
                ax.plot(PHI, break_at_pole(values), color=colour, ls=dash,
                        label=NAMES[scheme] if np.isfinite(values[1:]).any() else None)
                if scheme in SCHEMES[:5]:
                    mark_ends(ax, data[scheme], values, colour)
            ax.axvline(PHI_REACHED, color=GREY, lw=0.7, ls=":")
            ax.set_title(f"{water}: " + ("ν [–]" if key == "nu" else f"{key} over dry [–]"), loc="left")
            ax.set_xlim(0, PHI[-1])
        for scheme in SCHEMES[:5]:
            table.append((nu, water, scheme, data[scheme]["above_voigt"], data[scheme]["not_positive_definite"],
                          *(at_porosity(data[scheme], k) for k in ("E", "nu"))))
    for ax in rows[1]:
        ax.set_xlabel("volume fraction of water φ [–]")
    handles, labels = entries_of(*rows.flat)
    handles += [plt.Rectangle((0, 0), 1, 1, color="#DDE6EE"),
                plt.Rectangle((0, 0), 1, 1, color=FAILURE["above_voigt"], alpha=0.3),
                plt.Rectangle((0, 0), 1, 1, color=FAILURE["not_positive_definite"], alpha=0.25)]
    labels += ["Reuss to Voigt", "eq. 6 above Voigt", "eq. 6 not positive definite"]
    if not is_broken:
        handles, labels = handles[:-1], labels[:-1]
    handles += [plt.Line2D([], [], color="black", marker=m, mfc="white", ls="") for m in ("o", "x")]
    labels += ["a curve leaves Voigt", "a curve is no stiffness past here"]
    put_legend(figure, handles, labels, 4, 0.13)
    figure.suptitle(f"Spherical pores in clay of ν = {nu:.2f}; dotted: φ of saturated clay at porosity 0.4", fontsize=10)
    save(figure, output / f"moduli_nu{round(100 * nu)}")
    return table


def draw_polar(argil, output):
    """E along every direction of a plane through the pores' axis: 1/E = nnᵀ : S : nnᵀ."""
    figure, axes = plt.subplots(1, 2, figsize=(150 * MILLIMETRES, 82 * MILLIMETRES), subplot_kw={"projection": "polar"})
    angle = np.linspace(0, 2 * np.pi, 361)
    n = np.stack([np.sin(angle), 0 * angle, np.cos(angle)])
    m = np.stack([n[0]**2, n[1]**2, n[2]**2, np.sqrt(2) * n[1] * n[2], np.sqrt(2) * n[0] * n[2],
                  np.sqrt(2) * n[0] * n[1]])
    for ax, (water, fluid) in zip(axes, (("drained", 0.0), ("undrained", WATER))):
        for aspect, colour, dash in ((0.1, COLOURS[0], "-"), (1.0, GREY, (0, (5, 1.5))), (10.0, COLOURS[1], "-")):
            result = probe(argil, [dict(youngs_modulus_Pa=YOUNG, poissons_ratio=0.3, fluid_bulk_modulus_Pa=fluid,
                                        phi=0.2, scheme="mori_tanaka", aspect=aspect, orientation="aligned")])[0]
            S = np.linalg.inv(np.array(result["stiffness_mandel"]))
            E = 1.0 / np.einsum("ia,ij,ja->a", m, S, m)
            ax.plot(angle, E / YOUNG, color=colour, ls=dash, label=f"aspect {aspect:g}")
        ax.set_theta_zero_location("N")
        ax.set_theta_direction(-1)
        ax.set_ylim(0, 1)
        ax.set_yticks([0.25, 0.5, 0.75, 1.0])
        for label in ax.get_yticklabels():  # readable on the curves
            label.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6})
        ax.set_title(water)
    put_legend(figure, *axes[0].get_legend_handles_labels(), 3, 0.08)
    figure.suptitle("E over dry [–] along each direction; aligned pores, axis at 0°, φ = 0.2, ν = 0.3\n", fontsize=9)
    save(figure, output / "anisotropy")


def draw_hertz(argil, output):
    """Force of a rigid sphere at a fixed depth, F = (4/3) E/(1−ν²) √R d^{3/2}: dry over wet is that of E/(1−ν²)."""
    figure, axes = plt.subplots(1, 2, figsize=(180 * MILLIMETRES, 80 * MILLIMETRES), sharey=True)
    rows = []
    for ax, (water, fluid) in zip(axes, (("drained", 0.0), ("undrained", WATER))):
        for scheme in ("dilute", "dilute_strain", "mori_tanaka", "self_consistent", "differential"):
            data = curve(argil, 0.3, fluid, scheme)
            good = np.array([s != "not_positive_definite" for s in data["status"]])
            modulus = np.where(good, data["E"] / (1 - data["nu"]**2), np.nan)
            colour, dash = STYLE[scheme]
            ax.set_ylim(0, 1.02)
            # Past the Voigt bound the curve is no clay's any more: thin, and marked where that begins.
            within = np.where(PHI <= (data["above_voigt"] or PHI[-1]), modulus, np.nan)
            ax.plot(PHI, modulus / modulus[0], color=colour, ls=":", lw=0.8)
            ax.plot(PHI, within / modulus[0], color=colour, ls=dash, label=NAMES[scheme])
            mark_ends(ax, data, modulus / modulus[0], colour)
            rows.append((water, scheme, *(modulus[np.searchsorted(PHI, phi - 1e-9)] / modulus[0]
                                          for phi in (0.1, 0.2, 0.3, 0.4))))
        # Measured clay: 35-fold from plastic to liquid limit [Vardanega2014]; S = φ/n, limits at S = 0 and 1.
        ax.plot(PHI[PHI <= 0.4], 35.0**(-PHI[PHI <= 0.4] / 0.4), color="black", lw=1.0, ls=":",
                label="measured clay, 35-fold")
        ax.set_title(water, loc="left")
        ax.set_xlabel("volume fraction of water φ [–]")
        ax.set_xlim(0, PHI[-1])
        ax.axvline(PHI_REACHED, color=GREY, lw=0.7, ls=":")
    axes[0].set_ylabel("Hertz force, wet over dry [–]")
    handles, labels = axes[0].get_legend_handles_labels()
    handles += [plt.Line2D([], [], color="black", marker=m, mfc="white", ls=s) for m, s in (("o", ":"), ("x", ""))]
    labels += ["stiffer than Voigt from here", "no stiffness past here"]
    put_legend(figure, handles, labels, 3, 0.18)
    save(figure, output / "hertz_force")
    return rows


def show(value):
    return "" if value is None or np.isnan(value) else f"{value:.4g}"


def write_tables(output, moduli, hertz):
    with open(output / "limits.csv", "w", encoding="utf-8") as file:
        file.write("poissons_ratio,water,scheme,first_phi_above_voigt,first_phi_not_positive_definite,"
                   "E_at_0.4_Pa,nu_at_0.4\n")
        for row in moduli:
            file.write(",".join(show(v) if not isinstance(v, str) else v for v in row) + "\n")
    with open(output / "hertz_force.csv", "w", encoding="utf-8") as file:
        file.write("water,scheme,phi_0.1,phi_0.2,phi_0.3,phi_0.4\n")
        for row in hertz:
            file.write(",".join(show(v) if not isinstance(v, str) else v for v in row) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    root = Path(__file__).resolve().parent.parent
    parser.add_argument("--argil", default=str(root / "build/bin/argil"))
    parser.add_argument("--output", type=Path, default=root / "results/effective_medium")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    moduli = [row for nu in POISSON for row in draw_moduli(options.argil, nu, options.output)]
    draw_polar(options.argil, options.output)
    write_tables(options.output, moduli, draw_hertz(options.argil, options.output))


if __name__ == "__main__":
    main()
