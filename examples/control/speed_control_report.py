"""Tables and figure of speed_control.py."""

import control as ct
import numpy as np

from inertia_module.common.colours import BLACK, BLUE, VERMILION, Picture, styled


def report(rows):
    """Print the margins as a table."""
    print("\ncontroller      plant       gain margin         phase margin, deg   delay margin, s   crossover")
    print("                            predicted measured  predicted measured  predicted measured  rad/s")
    for name, kind, predicted, measured in rows:
        print(
            f"{name:15s} {kind:10s} {predicted.gain:8.2f} {measured.gain:9.2f} {predicted.phase:10.1f}"
            f" {measured.phase:8.1f} {predicted.delay:11.3f} {measured.delay:8.3f} {predicted.crossover:9.2f}"
        )


def step_numbers(table, plants):
    """Print overshoot and settling time after the reference step, and the speed dip after the hill step."""
    print("\ncontroller      plant       overshoot  rise time  settling time  dip on the hill")
    step = table.time[1]
    rows = slice(round(1.0 / step), round(7.0 / step))
    for name in ("PI", "state feedback"):
        for kind in plants:
            speed = table[f"measured {name} {kind}"]
            start = table["reference"][0]
            time = step * np.arange(rows.stop - rows.start)
            info = ct.step_info(
                speed[rows] - start,
                time,
                final_output=table["reference"][-1] - start,
                SettlingTimeThreshold=0.1,
            )
            dip = table["reference"][-1] - speed[rows.stop :].min()
            print(
                f"{name:15s} {kind:10s} {info['Overshoot']:8.1f} % {info['RiseTime']:8.2f} s"
                f" {info['SettlingTime']:12.2f} s {dip:10.2f} rad/s"
            )


@styled()
def figure_of(table, plants, curves, pulse_rate):
    """Draw the Bode plot of the loop with the PI controller (left) and the responses (right)."""
    figure = Picture(figsize=(12.0, 8.0), dpi=100, layout="constrained")
    figure.suptitle("Car on a hill: designed on the averaged module, run on the FMUs")
    axes = figure.subplots(2, 2)
    for label, (frequency, loop), style in curves:
        axes[0, 0].loglog(frequency, np.abs(loop), style, label=label)
        axes[1, 0].semilogx(frequency, np.degrees(np.unwrap(np.angle(loop))), style, label=label)
    axes[0, 0].set_ylabel("gain of the PI loop [1]")
    axes[1, 0].set_ylabel("phase [deg]")
    axes[1, 0].set_xlabel("frequency [Hz]")
    for axis in axes[:, 0]:
        axis.axvline(0.1 * pulse_rate, color=BLACK, linewidth=0.8, linestyle=":")
    axes[0, 0].axhline(1.0, color=BLACK, linewidth=0.8)
    axes[1, 0].axhline(-180.0, color=BLACK, linewidth=0.8)
    for axis, name in zip(axes[:, 1], ("PI", "state feedback"), strict=True):
        for kind, colour in zip(plants, (BLACK, BLUE, VERMILION), strict=True):
            axis.plot(table.time, table[f"omega_out {name} {kind}"], color=colour, linewidth=1.2, label=kind)
        axis.plot(table.time, table["reference"], color=BLACK, linewidth=0.8, linestyle="--")
        axis.set_ylabel(f"{name}: output speed [rad/s]")
    axes[1, 1].set_xlabel("time [s]")
    for axis in (axes[0, 0], axes[0, 1]):
        axis.legend()
    return figure
