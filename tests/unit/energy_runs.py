"""Random runs in fixed steps, coarse and fine: how much more energy each ever had than it was given.

`python tests/unit/energy_runs.py 640` counts those that make energy, by freewheels, drive and output.
"""

import itertools
import math
import random
import sys

from scenes import FREEWHEELS

from inertia_module.memory import Module

# what rounding may make in a run, of the largest energy there was
ROUNDING = 1e-11
DRIVES = {"by speed": 0, "by torque": 1}
OUTPUTS = {"rigid": 2, "elastic": 3}
ENERGIES = ("energy_stored", "energy_in", "energy_out", "energy_lost")
COMBINATIONS = list(itertools.product(FREEWHEELS, DRIVES, OUTPUTS))


def exponential(dice, low, high):
    """A number between 10**low and 10**high."""
    return 10.0 ** dice.uniform(low, high)


def mechanism(dice):
    """Parameters of either layout, of any proportions that can be stepped."""
    return {
        "layout": dice.choice([0, 0, 1]),
        "satellites": dice.randint(1, 4),
        "modules": dice.randint(1, 3),
        "z17": dice.randint(15, 60),
        "shaft_angle": dice.uniform(0.5, 2.5),
        **{name: dice.choice([1.0, dice.uniform(0.2, 2.0)]) for name in "abc"},
        "epsilon": dice.uniform(-7.0, 7.0),
        "gamma": dice.uniform(-7.0, 7.0),
        "eccentricity": dice.uniform(0.001, 0.05),
        "imbalance_mass": exponential(dice, -1.0, 1.0),
        "drive_inertia": dice.choice([0.0, exponential(dice, -5.0, -2.0)]),
        "input_inertia": exponential(dice, -3.0, 1.0),
        "link2_inertia": exponential(dice, -3.0, -1.0),
        "output_inertia": exponential(dice, -3.0, 1.0),
        "driven_inertia": exponential(dice, -2.0, 1.0),
        "shaft_stiffness": exponential(dice, 1.0, 6.0),
        "shaft_damping": dice.choice([0.0, exponential(dice, -3.0, 1.0)]),
        "driven_friction": dice.choice([0.0, exponential(dice, -3.0, 0.0)]),
        "balancer": dice.choice([0.0, 0.0, dice.uniform(-0.5, 0.5)]),
        "drive_angle_start": dice.uniform(-7.0, 7.0),
    }


def losses(dice):
    """Losses by load and drag of any size, some of them absent, and gravity."""
    drawn = {
        "mesh_efficiency": dice.uniform(0.5, 1.0),
        "satellite_mesh_efficiency": dice.uniform(0.9, 1.0),
        "journal_friction": exponential(dice, -4.0, -1.0),
        "housing_drag": exponential(dice, -3.0, 1.0),
        "housing_drag_viscous": exponential(dice, -4.0, 0.0),
        "output_drag": exponential(dice, -3.0, 1.0),
        "output_drag_viscous": exponential(dice, -4.0, 0.0),
        "drive_friction": exponential(dice, -3.0, 0.0),
        "link2_friction": exponential(dice, -3.0, 0.0),
        "gravity": dice.choice([9.81, 1000.0]),
    }
    return {name: value for name, value in drawn.items() if dice.random() < 0.6}


def largest_gain(seed, combination, kernel="auto", lossy=False):
    """Largest energy that a step, or all of the run, made out of nothing, of the largest energy there was.

    Each step lets the drive turn by 0.03 to 30 rad at the first speed of link 1; speed, torque, load change.
    """
    freewheels, drive, output = combination
    dice = random.Random(seed)
    speed = exponential(dice, 0.0, 3.0)
    values = mechanism(dice) | {"method": 1, "fidelity": OUTPUTS[output], "drive": DRIVES[drive]}
    values |= {"input_hold": dice.choice([0, 1]), "omega1": dice.choice([-speed, speed])}
    if lossy:
        values |= losses(dice)
    module = Module(kernel).start(**values, **FREEWHEELS[freewheels])
    step = exponential(dice, -1.5, 1.5) / (float(module.derived.k) * speed)
    # what changes the speed of link 1, or of the output shaft, by up to three times that in a step
    torque = exponential(dice, -3.0, 0.5) * values["input_inertia"] * speed / step
    load = exponential(dice, -3.0, 0.5) * values["output_inertia"] * speed / step
    energy = module["energy_stored"]
    last = gain = 0.0
    for _ in range(20):
        module.set(
            omega1=dice.choice([module["omega1"], dice.uniform(-speed, speed)]),
            drive_torque=dice.uniform(-torque, torque),
            load_torque=dice.choice([0.0, dice.uniform(-load, load)]),
        )
        for _ in range(20):
            module.advance(step)
            energy = max(energy, *(abs(module[name]) for name in ENERGIES))
            residual = module["energy_residual"]
            gain = max(gain, last - residual, -residual)
            last = residual
    assert all(math.isfinite(value) for value in module.snapshot().values())
    return gain / energy


def main(count):
    """Print how many of so many runs make energy, and the worst of them."""
    gains = {combination: [] for combination in COMBINATIONS}
    for seed in range(count):
        combination = COMBINATIONS[seed % len(COMBINATIONS)]
        gains[combination].append(largest_gain(seed, combination))
    found = 0
    for combination, seen in gains.items():
        made = sum(gain > ROUNDING for gain in seen)
        found += made
        print(f"{', '.join(combination):42} {made:3} of {len(seen)} make energy, at most {max(seen):.0e}")
    print(f"{found} of {count} make energy")


if __name__ == "__main__":
    main(int(sys.argv[1]))
