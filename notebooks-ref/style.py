"""Figures for colour-blind readers: Okabe & Ito's colours, with markers."""

import matplotlib.pyplot as plt

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999", "#7A5195", "#B3A800"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*", "<", ">"]


def use():
    plt.rcParams.update({
        "figure.dpi": 90, "savefig.dpi": 90, "font.size": 10, "axes.grid": True, "grid.alpha": 0.3,
        "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False,
        "axes.prop_cycle": plt.cycler(color=COLOURS),
    })
