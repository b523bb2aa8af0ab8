# /// script
# dependencies = ["kinopt[plot]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""Reachable, proven unreachable and undecided targets of a Panda in a vertical slice. Writes reach-slice.png."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

import kinopt

STEP = 0.06  # metres
MAX_BOXES = 1000
COLOURS = ListedColormap(["tab:blue", "lightgrey", "tab:red"])  # reachable, proven unreachable, undecided
arm = kinopt.Arm(kinopt.models.panda(), "base", "flange")
along = np.arange(-0.3, 1.0, STEP)
heights = np.arange(-0.5, 1.3, STEP)
orientations = {"pointing down": [np.pi, 0, 0], "pointing ahead": [0, np.pi / 2, 0], "pointing back": [0, -np.pi / 2, 0]}
figure, panels = plt.subplots(1, 3, figsize=(11, 5), layout="constrained", sharey=True)
for panel, (name, rpy) in zip(panels, orientations.items(), strict=True):
    targets = [kinopt.placement([x, 0, z], rpy=rpy) for z in heights for x in along]
    found = arm.solve_goals(np.array(targets), np.eye(4)[None])
    classes = np.zeros(len(targets))
    for index in np.flatnonzero(~found.reached[0]):
        answer = arm.reachability(targets[index], max_boxes=MAX_BOXES)
        classes[index] = {True: 0, False: 1, None: 2}[answer.reachable]
    counts = [int((classes == kind).sum()) for kind in range(3)]
    print(f"{name}: {counts[0]} reachable, {counts[1]} proven unreachable, {counts[2]} undecided")
    panel.pcolormesh(along, heights, classes.reshape(len(heights), -1), cmap=COLOURS, vmin=0, vmax=2)
    panel.plot(0, 0, "k+")
    panel.set(title=f"flange {name}", xlabel="x, m", aspect="equal")
panels[0].set_ylabel("z, m")
figure.savefig("reach-slice.png", dpi=100)
