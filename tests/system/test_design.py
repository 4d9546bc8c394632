"""Designs searched, checked and written, on workers of this machine."""

import csv

import pytest

from inertia_module import jobs
from inertia_module.figures.jobs import design_figure
from inertia_module.scene import SceneError, load_scene, run_scene

pytest.importorskip("distributed")
pytest.importorskip("pymoo")

SPEC = """
title = "A light module"
[mechanism]
layout = "planar"
[drive]
kind = "constant"
omega1 = "150 rad/s"
[load]
kind = "shaft"
inertia = "0.5 kg.m2"
[run]
stop_time = "0.5 s"
communication_step = "10 ms"
[free]
imbalance_mass = "log:200 g:3 kg"
satellites = "1:4"
eccentricity = "10 mm:30 mm"
[figures]
stall_torque = { speed = "150 rad/s", minimum = "20 N.m" }
torque_ripple = { speed = "150 rad/s", ratio = 0, goal = "least" }
total_imbalance_mass = { goal = "least" }
omega_out_final = { minimum = "100 rpm" }
[search]
population = 12
generations = 4
finalists = 3
margin = "5 %"
"""


@pytest.fixture(scope="module")
def spec(tmp_path_factory):
    path = tmp_path_factory.mktemp("spec") / "spec.toml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="module")
def found(spec, fmu, tmp_path_factory):
    return jobs.design(spec, output=tmp_path_factory.mktemp("one"), fmu=fmu, workers=1)


def told(rows):
    return [(row.point, row.figures, row.refused) for row in rows]


def test_designs_that_meet_all_limits_are_found_and_no_other_is_better(found):
    assert found.chosen == found.finalists
    assert len(found.chosen) == 3
    for row in found.front:
        assert found.judge.meets(row)
        mass, ripple = row.figures["total_imbalance_mass"], row.figures["torque_ripple"]
        for other in found.rows:
            if found.judge.meets(other, 0.05):
                lighter = other.figures["total_imbalance_mass"] <= mass
                assert not (lighter and other.figures["torque_ripple"] < ripple)
    assert found.verdict().startswith("3 of 3 checked designs meet all limits; nearest to its limit")


def test_the_same_seed_gives_the_same_whatever_the_number_of_workers(found, spec, fmu, cluster, tmp_path):
    two = jobs.design(spec, output=tmp_path, fmu=fmu, scheduler=cluster.address)
    assert told(two.rows) == told(found.rows)
    assert told(one.checked for one in two.finalists) == told(one.checked for one in found.finalists)


def test_a_chosen_design_is_a_scene_with_units_that_runs_and_gives_its_figures(found, fmu):
    for number, one in enumerate(found.finalists, 1):
        read, text = load_scene(one.file), one.file.read_text()
        assert read.tables == one.scene.tables
        assert read.mechanism.fidelity == 2.0
        assert run_scene(read, fmu).summary["omega_out_final"] == one.checked.figures["omega_out_final"]
        assert 'layout = "planar"' in text
        assert f'title = "A light module: design {number}"' in text
        point = one.searched.point
        assert f'eccentricity = "{point["mechanism.eccentricity"]!r} m"' in text
        assert f"satellites = {int(point['mechanism.satellites'])}\n" in text
        assert 'stop_time = "0.5 s"' in text
        assert "outputs" not in text


def test_table_and_picture_of_a_design_have_whole_numbers_and_units(found):
    for row in csv.DictReader(found.files["checked csv"].open()):
        assert (row["mechanism.satellites"] + row["contact_switches"]).isdecimal()
    picture = design_figure(found)
    assert picture.get_suptitle() == "A light module"
    (panel,) = picture.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("torque ripple [N.m]", "total imbalance mass [kg]")
    picture.draw_without_rendering()
    assert not any("$" in label.get_text() for label in panel.get_xticklabels(which="both"))


def test_another_search_of_the_same_scene_takes_what_is_there(found, spec, fmu, cluster):
    harder = spec.with_name("harder.toml")
    harder.write_text(SPEC.replace('150 rad/s", minimum = "20 N.m"', '150 rad/s", minimum = "2 kN.m"'))
    folder = found.files["checked csv"].parent
    stopped = jobs.design(harder, output=folder, fmu=fmu, scheduler=cluster.address)
    assert 0 < stopped.new < len(stopped.rows)
    assert stopped.chosen == []
    assert "no design of" in stopped.verdict()
    assert "stall_torque is" in stopped.verdict()
    assert "must be at least 2000 N.m" in stopped.verdict()


def test_a_figure_that_no_run_has_is_refused(spec, fmu, cluster, tmp_path):
    wrong = spec.with_name("wrong.toml")
    wrong.write_text(SPEC.replace("omega_out_final", "omega_out_last"))
    with pytest.raises(SceneError, match=r"figures.omega_out_last must be .* .did you mean omega_out_final"):
        jobs.design(wrong, output=tmp_path, fmu=fmu, scheduler=cluster.address)
