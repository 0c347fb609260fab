"""Figures of the study of grasping force control: as Figs. 5.7, 5.9, 5.10 and 5.11."""

from __future__ import annotations

from typing import Any

import numpy as np

from krhpr.picture import STYLE
from krhpr.study.grasp_control import BEFORE, SETTLING, GraspControl
from krhpr.study.grasp_picture import COLOURS

BLUE, RED, GREEN, GREY, INK = "#1b4f72", "#b03a2e", "#1e8449", "#b8b8b8", "#333333"
MEASURED: dict[str, Any] = {"color": GREY, "linewidth": 0.5}
AT_REST: dict[str, Any] = {"color": BLUE, "linestyle": "", "marker": "o", "markersize": 5}
EASY: dict[str, Any] = {"color": GREEN, "linestyle": "", "marker": "D", "markersize": 4}
REFERENCE: dict[str, Any] = {"color": INK, "linestyle": "--", "linewidth": 1.0}


def grasp_control_figures(found: GraspControl) -> dict[str, Any]:
    """All of them, by name."""
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return {
            "grasp_control_indirect": _indirect(found),
            "grasp_control_step": _step(found),
            "grasp_control_along": _along(found),
        }


def _axes(columns: int, size: tuple[float, float], **options: Any) -> tuple[Any, Any]:
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, columns, figsize=size, layout="constrained", squeeze=False, **options)
    for ax in axes.flat:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(alpha=0.3)
        ax.set_axisbelow(True)
    return figure, axes[0]


def _indirect(found: GraspControl) -> Any:
    figure, (left, right) = _axes(2, (11.0, 4.2))
    _position(left, found)
    _feedforward(right, found)
    for ax in (left, right):
        ax.set_ylabel(r"grasping force $f_g$ (N)")
        ax.set_xlim(left=0)
        ax.set_ylim(bottom=-0.1)
        ax.legend(fontsize=8, frameon=False)
    return figure


def _position(ax: Any, found: GraspControl) -> None:
    """Fig. 5.7: forces over the angle error, with and without friction, and their lines."""
    grip, inputs = found.grip, np.degrees(found.position.inputs)
    fitted, ends = found.position.line, np.array([0.0, inputs.max()])
    sagging = np.array([np.degrees(grip.sag), inputs.max()])
    trace = found.position.trace
    told = np.degrees(np.abs(trace.wanted_angles[:, 0] - found.setup.phi))
    ax.plot(told, trace.measured_force, label="measured", **MEASURED)
    ax.plot(inputs, found.position.forces, label="at rest", **AT_REST)
    ax.plot(
        ends,
        fitted.offset + fitted.slope * np.radians(ends),
        color=BLUE,
        linewidth=1.2,
        label=f"line through them, {fitted.slope:.0f} N/rad",
    )
    ax.plot(inputs, found.easy_position.forces, label="at rest, without friction", **EASY)
    ax.plot(
        sagging,
        grip.stiffness() * (np.radians(sagging) - grip.sag),
        color=GREEN,
        linestyle="--",
        linewidth=1.2,
        label=f"closed form, {grip.stiffness():.0f} N/rad",
    )
    ax.set_xlabel(r"angle error $e_\phi$ (degrees)")
    ax.set_title("Scheme i: position control (Fig. 5.7)", fontsize=11)


def _feedforward(ax: Any, found: GraspControl) -> None:
    """Fig. 5.9: forces over what is wanted, with and without friction, and what friction allows."""
    wanted, friction = found.feedforward, found.control.friction
    top = float(wanted.inputs.max())
    steps, coulomb = np.linspace(0.0, top, 60), found.control.coulomb(found.setup.drive)
    least = [found.grip.band(x, coulomb, friction.load_share, friction.stiction)[0] for x in steps]
    ax.plot(wanted.trace.wanted_force, wanted.trace.measured_force, label="measured", **MEASURED)
    ax.plot(wanted.inputs, wanted.forces, label="at rest", **AT_REST)
    ax.plot(wanted.inputs, found.easy_feedforward.forces, label="at rest, without friction", **EASY)
    ax.plot([0, top], [0, top], label="reference", **REFERENCE)
    ax.plot(steps, least, color=RED, linewidth=1.0, label="least that friction lets through")
    ax.set_xlabel(r"wanted force $f_{g,d}$ (N)")
    ax.set_title("Scheme ii: static model without force feedback (Fig. 5.9)", fontsize=11)


def _step(found: GraspControl) -> Any:
    figure, (left, right) = _axes(2, (11.0, 3.8))
    trace = found.step
    shown = trace.between(0.0, BEFORE + 1.0)
    times = trace.times[shown] - BEFORE
    left.plot(times, trace.measured_force[shown], label="measured", **MEASURED)
    left.plot(times, trace.seen.grasp_force[shown], color=BLUE, linewidth=1.4, label="true")
    left.plot(times, trace.wanted_force[shown], label="reference", **REFERENCE)
    left.set_ylabel(r"grasping force $f_g$ (N)")
    left.set_title("Scheme iii: step response (Fig. 5.10)", fontsize=11)
    left.legend(fontsize=8, frameon=False, loc="lower right")
    for index, colour in enumerate(COLOURS):
        right.plot(
            times,
            1e3 * trace.torques[shown, index],
            color=colour,
            linewidth=1.0,
            label=rf"$\tau_{index + 1}$",
        )
    right.set_ylabel("motor torques (mN m)")
    right.set_title("What the motors do", fontsize=11)
    right.legend(fontsize=8, frameon=False, ncols=4, loc="upper right")
    right.margins(y=0.2)
    for ax in (left, right):
        ax.set_xlabel("time after the step (s)")
    return figure


def _along(found: GraspControl) -> Any:
    count = len(found.along)
    figure, axes = _axes(count, (4.0 * count, 3.6), sharey=True)
    for ax, one in zip(axes, found.along, strict=True):
        rows, trace = one.moving, one.trace
        times = trace.times[rows] - SETTLING
        ax.plot(times, trace.measured_force[rows], label="measured", **MEASURED)
        ax.plot(times, trace.seen.grasp_force[rows], color=BLUE, linewidth=0.7, label="true")
        ax.plot(times, trace.wanted_force[rows], label="reference", **REFERENCE)
        ax.set_title(one.motion.name, fontsize=11)
        ax.set_xlabel("time (s)")
        ax.margins(x=0)
    aim = found.setup.force
    axes[0].set_ylim(0.8 * aim, 1.2 * aim)
    axes[0].set_ylabel(r"grasping force $f_g$ (N)")
    axes[-1].legend(fontsize=8, frameon=False, ncols=3, loc="upper right")
    figure.suptitle("Scheme iii along the trajectories (Fig. 5.11)", fontsize=11)
    return figure
