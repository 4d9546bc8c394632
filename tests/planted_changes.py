"""Do the tests notice? Single changes are planted in copies of the kernel, and tests run with each.

    python tests/planted_changes.py -n 2                     all changes, each with the selection below
    python tests/planted_changes.py -k search tests/unit/test_crossings.py

Prints for each change the first test that failed, or "survived". Nothing is translated: the tests run with
INERTIA_MODULE_KERNEL=plain and few examples each, so choose tests of the kernel itself, tests/unit, not of
built FMUs.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "fmu_src" / "inertia_module"
TIME_LIMIT = 400  # s a change: an endless run is noticed too
QUIETLY = {"capture_output": True, "text": True}
# tests that are quick in plain Python, in tests/unit, what notices most first; by the file that is changed
# (maps of fidelity averaged take no time in the planar layout, minutes in the bevel one under a torque)
CHECK_VALUES = """
    test_reference.py::test_reference_scene_has_its_check_values
    test_reference.py::test_planar_scene_has_its_check_values
    test_reference.py::test_elastic_scene_has_its_check_values
"""
MEANS = """
    test_loads.py::test_input_goes_on_as_over_the_last_step_where_it_is_held_so
    test_loads.py::test_means_and_peak_are_those_of_the_torques_at_each_instant[bevel-speed-rigid-ideal]
    test_loads.py::test_means_and_peak_are_those_of_the_torques_at_each_instant[planar-speed-kinematic-friction]
    test_loads.py::test_means_and_peak_are_those_of_the_torques_at_each_instant[planar-torque-elastic-friction]
"""
LOADS = """
    test_loads.py::test_moment_about_the_axis_is_what_link_1_and_link_2_are_given
    test_multibody.py::test_torques_imbalance_mount_and_energy_are_those_of_the_multibody_engine
    test_loads.py::test_peak_on_the_bearing_is_that_of_all_instants
    test_loads.py::test_peak_of_a_pulse_is_not_that_of_the_step_beyond_its_end
"""
REFERENCE = "test_reference.py::test_motion_and_losses_are_those_of_the_reference"
PLAYS = f"""
    test_play.py::test_a_shaft_that_is_slowed_meets_a_coasting_link_2_and_shares_its_momentum
    test_reference.py::test_jumps_of_the_input_speed_meet_freewheels_within_their_play
    {REFERENCE}[planar-speed-elastic-play-output-alone] {REFERENCE}[bevel-torque-rigid-play-held]
    {REFERENCE}[planar-torque-rigid-play-and-all] {REFERENCE}[bevel-torque-elastic-play-and-all]
"""
SELECTION = {
    "averaged/": """
        test_averaged_map.py::test_mean_power_of_link_1_goes_to_the_output_or_into_its_energy_or_is_lost
        test_averaged_map.py::test_accelerations_of_the_mean_motion_are_the_rates_of_its_speeds
        test_averaged_map.py::test_a_step_of_the_mean_motion_is_of_its_order
        test_averaged_map.py::test_slopes_of_the_table_are_those_of_scipy
        test_averaged_map.py::test_table_of_two_knots_is_a_straight_line
        test_averaged_map.py::test_momentum_while_link_2_is_held_changes_by_what_holds_it
        test_motions.py::test_error_follows_the_tolerance[planar-speed-averaged-ideal]
        test_averaged_map.py::test_steady_motion_under_a_torque_ends_a_period_as_it_began
        test_averaged.py::test_input_passes_through_zero_and_back[0-planar]
        test_averaged_map.py::test_means_ripple_and_peak_are_those_of_the_pulses_at_held_output_speed[0.31-100.0-planar]
        test_averaged.py::test_behind_an_engine_of_great_inertia_the_motion_is_that_at_its_speed[planar-10.0]
        test_averaged_losses.py::test_locked_to_link_1_friction_and_drag_alone_are_lost
    """,
    "driven_shaft/": "test_driven_shaft.py",
    "rosenbrock": """
        test_elastic.py::test_slowest_rate_is_that_of_the_slowest_eigenvalue
        test_elastic.py::test_the_twist_of_a_shaft_pulled_by_its_load_follows_tolerance[0.1-400.0-overdamped]
        test_elastic.py::test_a_stiff_step_is_of_its_order_in_all_that_is_followed
    """,
    "kinematic": f"""
        {CHECK_VALUES} test_methods.py
        test_losses.py::test_prescribed_motion_has_the_efficiency_of_planetary_gears
        test_losses.py::test_prescribed_motion_pays_for_each_loss_and_nothing_else[mesh-0.5-bevel]
        {MEANS}
    """,
    "equations/|events/|tableau|^links": f"""
        {CHECK_VALUES} test_methods.py test_rates.py
        test_elastic.py::test_slowest_rate_is_that_of_the_slowest_eigenvalue
        test_reference.py::test_losses_of_several_satellites_follow_the_tolerance
        test_reference.py::test_impulse_of_the_input_is_that_of_the_momentum_though_it_does_no_work
        {PLAYS} test_losses.py::test_ramp_from_rest_breaks_friction_loose[mesh-0.01]
        test_losses.py::test_prescribed_motion_has_the_efficiency_of_planetary_gears
        test_losses.py::test_prescribed_motion_pays_for_each_loss_and_nothing_else[gravity-0.5-planar]
        test_reference.py::test_loads_that_change
        test_reference.py::test_motion_and_losses_are_those_of_the_reference
        test_reference.py::test_links_part_at_the_same_instant_at_any_tolerance
        test_reference.py::test_accounts_are_held_to_the_tolerance_whatever_the_steps
        test_freewheels.py {MEANS}
    """,
    "fixed_steps": f"""
        {PLAYS.split(maxsplit=1)[0]}
        test_play.py::test_fixed_steps_come_to_what_events_say_at_first_order[planar-speed-timestepping-play]
        test_timestepping.py::test_error_of_fixed_steps_falls_with_the_square_where_nothing_switches
        test_timestepping.py::test_fixed_steps_come_to_what_events_say
        test_timestepping.py::test_no_random_run_makes_energy
    """,
    "^step": f"""
        test_audit.py {MEANS} {PLAYS}
    """,
    "^outputs": f"""
        test_audit.py test_reference.py::test_motion_is_that_of_the_reference {MEANS}
    """,
    "^(inertia|layout|derive|sine|accumulate)": f"""
        {CHECK_VALUES} {PLAYS} test_clearance.py test_rates.py test_multibody.py
        test_angles.py::test_both_are_within_one_and_a_half_units_all_around
        test_angles.py::test_a_sum_keeps_what_rounding_has_lost
        test_angles.py::test_wrapped_angles_are_within_one_turn
        test_timestepping.py::test_fixed_steps_come_to_what_events_say[bevel-speed-timestepping-ideal]
    """,
    "": f"""
        {CHECK_VALUES} test_reference.py::test_motion_is_that_of_the_reference {LOADS} test_methods.py
        {MEANS} test_multibody.py
        test_elastic.py::test_the_work_of_the_balancer_is_in_the_audit
        test_rates.py::test_rates_of_the_outputs test_freewheels.py {PLAYS}
        test_reference.py::test_speeds_and_impulses_after_a_jump_solve_the_complementarity_problem
        test_tunable.py::test_jump_of_the_prescribed_ratio_is_an_impulse
        test_motions.py::test_torque_with_a_rate_counts_by_its_mean_over_the_step
        test_motions.py::test_energies_balance_and_freewheels_only_push[bevel-speed-kinematic-ideal]
        test_motions.py::test_many_steps_are_one[bevel-speed-timestepping-ideal]
        test_angles.py::test_link_2_held_by_its_freewheel_keeps_the_same_angles
    """,
}
# file of the kernel, and a place in it that is there once: {what stands there|what is planted}
CHANGES = Path(__file__).with_suffix(".txt").read_text(encoding="utf-8").splitlines()


def planted(folder, change):
    """Copy the package into a folder with this change made. Returns the folder."""
    path, place = change.encode().decode("unicode_escape").split(": ", 1)
    old, new = (re.sub(r"{(.*?)\|(.*?)}", part, place) for part in (r"\1", r"\2"))
    package = shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    source = (package / "kernel" / path).read_text()
    assert source.count(old) == 1, f"{path} has {old!r} {source.count(old)} times, must have it once"
    (package / "kernel" / path).write_text(source.replace(old, new))
    return folder


def tests_of(change):
    """The tests selected for a change, by the file that is changed."""
    file = change.partition(":")[0]
    names = next(names for part, names in SELECTION.items() if re.search(part, file))
    return [f"tests/unit/{name}" for name in names.split()]


def noticed_by(change, selection):
    """First test that fails with a change (without any, if it is empty), or "survived"."""
    with tempfile.TemporaryDirectory() as folder:
        place = planted(Path(folder), change) if change else PACKAGE.parent
        environment = os.environ | {"INERTIA_MODULE_KERNEL": "plain", "PYTHONPATH": str(place)}
        options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-profile=few"]
        command = [sys.executable, "-m", "pytest", *options, *selection]
        try:
            done = subprocess.run(
                command, cwd=ROOT, env=environment, timeout=TIME_LIMIT, check=False, **QUIETLY
            )
        except subprocess.TimeoutExpired:
            return f"no end within {TIME_LIMIT} s"
    if done.returncode == 0:
        return "survived"
    first = re.search(r"^(?:FAILED|ERROR) (?:tests/)?(\S.*?)(?: - |$)", done.stdout, re.M)
    if first:
        return first[1]
    return f"no test, but status {done.returncode}: {(done.stdout + done.stderr)[-300:]}"


def main():
    """Run the tests without a change, then with each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tests", nargs="*", help="in place of the selection")
    parser.add_argument("-n", type=int, default=1, help="changes at a time")
    parser.add_argument("-k", default="", help="only changes of files whose name contains this")
    arguments = parser.parse_args()
    changes = [change for change in CHANGES if arguments.k in change.partition(":")[0]]
    chosen = [arguments.tests or tests_of(change) for change in changes]
    survivors = 0
    with ThreadPoolExecutor(arguments.n) as pool:
        for before in pool.map(lambda tests: noticed_by("", tests), {tuple(tests) for tests in chosen}):
            if before != "survived":
                sys.exit(f"without a change fails {before}")
        for change, found in zip(changes, pool.map(noticed_by, changes, chosen), strict=True):
            print(f"{change:<70} {found}", flush=True)
            survivors += found == "survived"
    print(f"{len(changes) - survivors} of {len(changes)} noticed")


if __name__ == "__main__":
    main()
