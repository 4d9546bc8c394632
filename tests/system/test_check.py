"""Test the check of foreign FMUs: crashes, hangs, floods of output, malicious archives, correct FMUs."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest

from inertia_module.common.errors import FmuError
from inertia_module.fmi import check, copies
from inertia_module.fmi.check import check_fmu
from inertia_module.fmi.examination import examine
from inertia_module.fmi.report import Journal
from tests.system.foreign import DESCRIPTION, description, foreign_fmu, packed, references
from tests.system.programs import assert_one_line_error, command

# Time limits for checks that end and for checks that hang, s.
ENOUGH, LITTLE = 60.0, 3.0
ALLOWED = ". Set a longer one with --timeout."
SECRET = "a line of a file outside the FMU"


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """Return an empty folder of copies."""
    monkeypatch.setenv("INERTIA_MODULE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(copies, "_checked", set())
    return tmp_path / "cache" / "unpacked"


@pytest.fixture
def fmu(tmp_path, cache):
    """Return a function that makes an FMU whose steps run C code."""
    return lambda *code, **more: foreign_fmu(tmp_path, *code, **more)


def examined(path):
    """Return the report of an FMU that may run in this process."""
    return examine(path, Journal())


# --- FMUs that damage their process ---

STAGE = "simulation to 1 s"
# C code of a step, and the problem that it causes.
HARM = {
    "exits": ("exit(0)", f"{STAGE}: the FMU exits the process of its host with code 0"),
    "exits with a code": ("_exit(3)", f"{STAGE}: the FMU exits the process of its host with code 3"),
    "crashes": ("*(volatile int *)8 = 1", f"{STAGE}: the FMU crashes (SIGSEGV)"),
    "aborts": ("abort()", f"{STAGE}: the FMU crashes (SIGABRT)"),
    "kills itself": ("kill(getpid(), SIGKILL)", f"{STAGE}: the FMU crashes (SIGKILL)"),
    "prints": ('puts("{\\"a\\": 1}")', "the FMU prints to standard output: '{\"a\": 1}'"),
    "discards": ("return 2", f"{STAGE} failed: at time 0 s: fmi2DoStep failed with status 2 (discard)."),
    "fails": ("return 3", f"{STAGE} failed: at time 0 s: fmi2DoStep failed with status 3 (error)."),
}
ENDLESS = {
    "loops": "for (;;) ;",
    "ignores signals": "signal(SIGTERM, SIG_IGN); signal(SIGINT, SIG_IGN); for (;;) ;",
    "sleeps": "sleep(1000)",
    "waits for input": "char c; while (read(0, &c, 1) >= 0) ;",
    "has children": "fork(); for (;;) ;",
}


@pytest.mark.parametrize("harm", HARM)
def test_crash_of_an_fmu_is_a_problem(fmu, tmp_path, harm):
    code, problem = HARM[harm]
    done = command("check", fmu(code), "--json")
    assert (done.exit_code, done.stderr) == (1, "")
    assert json.loads(done.stdout)["problems"] == [problem]


@pytest.mark.parametrize("harm", ENDLESS)
def test_an_fmu_without_end_is_killed_with_its_children(fmu, harm):
    begin = time.monotonic()
    report = check_fmu(fmu(ENDLESS[harm]), LITTLE)
    assert report.problems == [f"{STAGE}: time limit of 3 s exceeded{ALLOWED}"]
    assert time.monotonic() - begin < LITTLE + 5.0
    assert not processes_of("fmi.examination")


def test_a_flood_of_output_is_cut_off(fmu):
    report = check_fmu(fmu('for (;;) puts("a flood of words")'), LITTLE)
    assert report.problems[1:] == ["the FMU prints to standard output: 'a flood of words'"]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit the memory")
def test_fmu_that_allocates_too_much_memory_is_stopped(fmu):
    path = fmu("for (;;) memset(malloc(1 << 26), 1, 1 << 26)")
    (problem,) = check_fmu(path, ENOUGH, memory=1_500_000_000).problems
    assert problem == f"{STAGE}: the FMU crashes (SIGSEGV, out of memory: the limit is 1.5 GB)"


def test_error_output_is_a_warning_and_earlier_results_stay(fmu):
    report = check_fmu(fmu('if (time > 0.5) { fputs("help\\n", stderr); exit(1); }'))
    assert report.warnings == ["the FMU prints to standard error: 'help'"]
    assert report.facts["model"] == "foreign"


def test_control_characters_of_an_fmu_do_not_reach_the_terminal(fmu):
    path = fmu('puts("\\x1b[2Kno problems found\\rno problems found")')
    (problem,) = check_fmu(path).problems
    assert problem.isprintable()
    assert "\n" not in problem


def test_problem_of_a_slow_fmu_states_the_reached_time(fmu):
    shares = []
    report = check_fmu(fmu("usleep(50000)", times='stopTime="1e3"'), 4.0, shares.append)
    (problem,) = report.problems
    reached = float(re.match(r".*: time limit of 4 s exceeded \(simulation time (\S+) s\)", problem)[1])
    assert 50.0 < reached < 900.0
    assert shares == sorted(shares)
    assert 0.0 < shares[-1] < 1.0


def processes_of(words):
    """Return processes with these words in their command and the mark of this test in their environment."""
    processes = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if (
                words.encode() in (folder / "cmdline").read_bytes()
                and MARK in (folder / "environ").read_bytes()
            ):
                processes.append(folder.name)
    return processes


MARK = f"TEST_OF_CHECK={os.getpid()}".encode()


@pytest.fixture(autouse=True)
def mark(monkeypatch):
    monkeypatch.setenv(*MARK.decode().split("="))


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked for in /proc")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_signal_ends_the_check_and_its_process(fmu, tmp_path, monkeypatch, name):
    path = fmu('FILE *f = fopen("/proc/self/cwd/../begun", "w"); fclose(f); for (;;) ;')
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    program = [sys.executable, "-m", "inertia_module", "check", path.name]
    with subprocess.Popen(
        program, cwd=tmp_path, stderr=subprocess.PIPE, env=os.environ | {"TMPDIR": str(temporary)}
    ) as running:
        while not list(temporary.glob("*/begun")):
            assert running.poll() is None
            time.sleep(0.05)
        assert len(processes_of("fmi.examination")) == 1
        running.send_signal(getattr(signal, name))
    deadline = time.monotonic() + 10.0
    while processes_of("fmi.examination"):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert running.returncode != 0
    if name != "SIGKILL":
        assert list(temporary.iterdir()) == []


# --- correct foreign FMUs ---


def test_a_correct_fmu_has_no_problems(fmu):
    report = examined(fmu())
    assert (report.problems, report.warnings) == ([], [])
    assert report.facts["simulated"] == "1 s in 100 steps"
    assert report.outputs == {"y": 0.0, "flag": 1.0, "text": "late", "count": 100.0}


# Times of the default experiment, flag for a shorter last step, number of steps, final time.
DEFAULTS = {
    "start": ('startTime="2" stopTime="4"', "true", 100, 4.0),
    "its own step": ('startTime="1" stopTime="2" stepSize="0.25"', "false", 4, 2.0),
    "a remainder is stepped": ('stopTime="1" stepSize="0.3"', "true", 4, 1.0),
    "a remainder is left out": ('stopTime="1" stepSize="0.3"', "false", 3, 0.9),
    "start without stop": ('startTime="5"', "true", 100, 6.0),
    "seconds of an epoch": ('startTime="1.7e9" stopTime="1700000001" stepSize="0.1"', "true", 10, 1.7e9),
    "a long one": ('stopTime="1e9"', "true", 100, 1e9),
}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("case", DEFAULTS)
def test_default_experiment_has_the_steps_of_the_fmu(fmu, fmi, case):
    times, variable, steps, end = DEFAULTS[case]
    code = "return fabs(time - model.time) > 1e-6 ? 3 : 0"
    report = examined(fmu(code, fmi=fmi, times=times, variable=variable))
    assert (report.problems, report.warnings) == ([], [])
    assert report.facts["simulated"] == f"{end:g} s in {steps} steps"


def test_internal_step_of_an_fmu_is_its_step(fmu):
    report = examined(fmu(fmi=3, times='stopTime="10"', more='fixedInternalStepSize="1"'))
    assert report.facts["simulated"] == "10 s in 10 steps"


def test_only_the_beginning_of_a_default_experiment_without_end_is_stepped(fmu):
    report = examined(fmu(times='stopTime="1e8" stepSize="1e-3"'))
    assert report.problems == []
    assert report.facts["simulated"] == "100 s in 100000 steps"
    assert report.warnings == [
        "only 100000 of 1e+11 steps of the default experiment are simulated (0 s to 1e+08 s by 0.001 s)"
    ]


@pytest.mark.parametrize(
    "times",
    ['stopTime="INF"', 'stopTime="-1"', 'startTime="NaN"', 'stopTime="1" stepSize="0"', 'stopTime="0"'],
)
def test_invalid_times_of_an_experiment_are_a_problem(fmu, times):
    (problem,) = examined(fmu(times=times)).problems
    assert (
        "times of an experiment must be finite, the stop time after the start time and the step positive"
        in problem
    )


@pytest.mark.parametrize("fmi", [2, 3])
def test_fmu_that_ends_the_simulation_is_correct(fmu, fmi):
    code = "if (time > 0.5) { model.count = -1; return " + ("2; }" if fmi == 2 else "0; }")
    report = examined(fmu(code, fmi=fmi))
    assert report.problems == []
    assert report.facts["simulated"] == "0.51 s in 51 steps; the FMU ends the simulation"


EARLY = "if ({}) {{ is_early = true; early_time = time + step / 2; }}"


def test_event_mode_and_early_returns_are_tried_too(fmu):
    code = EARLY.format("early_allowed && step > 0.009")
    report = examined(fmu(code, fmi=3, more='hasEventMode="true"'))
    assert report.problems == []
    assert report.facts["simulated"] == "1 s in 100 steps"
    assert report.facts["simulated with event mode"] == "1 s in 200 steps"
    assert report.outputs["count"] == 200.0


def test_early_return_without_permission_is_a_problem(fmu):
    (problem,) = examined(fmu(EARLY.format("time > 0.5"), fmi=3)).problems
    assert problem.endswith("the step returns early, but early return is not allowed")


def test_model_exchange_is_stepped_and_its_references_are_not_replayed(fmu):
    files = references("time,y\n0,5\n")
    report = examined(fmu(fmi=3, interface="ModelExchange", files=files, times='startTime="1" stopTime="3"'))
    assert report.problems == []
    assert report.warnings == ["reference results are not checked: this requires co-simulation"]
    assert report.facts["simulated"] == "3 s in 100 steps"
    assert report.outputs["ramps"] == pytest.approx([3.0, 6.0, 9.0])


def test_non_finite_outputs_are_problems_and_null_in_json(fmu):
    done = command("check", fmu("model.u = time > 0.5 ? NAN : 0"), "--json")
    printed = json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert printed["problems"] == ["output y is not finite at t = 0.52 s"]
    assert printed["outputs"]["y"] is None


def test_fmu_that_changes_the_working_folder_is_checked(fmu, tmp_path, monkeypatch):
    files = references("time,y\n0,0\n1,0\n")
    path = fmu('if (chdir("/")) return 3', files=files)
    monkeypatch.chdir(tmp_path)
    assert check_fmu(Path(path.name)).problems == []
    done = command("check", path.name)
    assert done.exit_code == 0, done.output


def test_an_fmu_for_scheduled_execution_alone_is_correct_and_not_stepped(fmu):
    report = examined(fmu(fmi=3, interface="ScheduledExecution"))
    assert report.problems == []
    assert report.facts["FMI"] == "3.0, scheduled execution"
    assert report.warnings == ["the FMU is not simulated: it supports scheduled execution only"]


def test_all_platforms_of_fmi_2_and_3_are_listed(fmu):
    names = ("aarch64-linux", "aarch64-darwin", "wasm32-wasip2", "x86-windows", "riscv64-linux")
    files = {f"binaries/{name}/foreign.bin": "" for name in names} | {"sources/foreign.c": ""}
    platforms = examined(fmu(fmi=3, files=files)).facts["platforms"].split(", ")
    assert set(platforms) >= {*names, "c-code"}


def test_missing_library_of_this_platform_is_named(tmp_path, cache):
    (problem,) = examined(packed(tmp_path / "other.fmu", [])).problems
    assert re.match(r"the FMU cannot be simulated on this machine: no binaries/\w+/foreign\.\w+$", problem)


# --- references of foreign FMUs ---

# Results of FMUs with y = u = 0, or with the inputs below. All are correct.
INPUTS = "time,u\n0,0\n0.5,0\n0.5,2\n1,4\n"
CORRECT = {
    "numbers": (2, "time,y,count\n0,0,0\n0.5,0,2\n1,0,4\n", None),
    "booleans": (2, "time,flag\n0,false\n0.25,false\n0.5,true\n1,true\n", None),
    "booleans as numbers": (2, "time,flag\n0,0\n0.5,1\n1,1\n", None),
    "texts": (2, "time,text\n0,early\n0.25,early\n0.5,late\n1,late\n", None),
    "binary data": (3, "time,data\n0,666f6f\n1,666f6f\n", None),
    "an array": (3, "time,ramps\n0,0 0 0\n0.5,0.5 1 1.5\n1,1 2 3\n", None),
    "elements of an array": (3, "time,ramps[1],ramps[3]\n0,0,0\n0.5,0.5,1.5\n1,1,3\n", None),
    "between the steps": (3, "time,ramps[1],flag\n0.1,0.1,false\n0.4,0.4,true\n0.4,0.4,false\n", None),
    "ends of lines and spaces": (2, "time , y    , flag  ,\n0 , 0 , false ,\n1    , 0 , true ,\n", None),
    "semicolons and quotes": (2, '"time";"y"\n0;0\n1;0\n', None),
    "an event in the inputs": (2, "time,y\n0,0\n0.5,0\n0.5,2\n0.75,2\n1,3\n", INPUTS),
    "all of a reference": (3, "time,y,flag,text,count,ramps,data\n1,0,true,late,4,1 2 3,666f6f\n", None),
}


@pytest.mark.parametrize("case", CORRECT)
def test_correct_results_of_all_types_have_no_problems(fmu, case):
    fmi, results, inputs = CORRECT[case]
    report = examined(fmu(fmi=fmi, files=references(results, inputs=inputs)))
    assert (report.problems, report.warnings) == ([], [])
    assert report.references


WRONG = {
    "a number": (
        2,
        "time,count\n0,0\n1,5\n",
        "test: count deviates from its reference by 1 at t = 1 s (tolerance 0.05)",
    ),
    "a boolean": (
        2,
        "time,flag\n0,true\n1,true\n",
        "test: flag deviates from its reference by 1 at t = 0 s (tolerance 0.01)",
    ),
    "a text": (
        2,
        "time,text\n0,early\n1,early\n",
        "test: text deviates from its reference by 1 at t = 1 s (tolerance 0)",
    ),
    "data": (
        3,
        "time,data\n0,666f6f\n1,66\n",
        "test: data deviates from its reference by 1 at t = 1 s (tolerance 0)",
    ),
    "an element": (
        3,
        "time,ramps\n0,0 0 0\n1,1 2 4\n",
        "test: ramps deviates from its reference by 1 at t = 1 s (tolerance 0.04)",
    ),
    "a name": (2, "time,x\n0,0\n", "experiment test failed: unknown variable 'x'; did you mean '"),
    "an element that is not there": (
        3,
        "time,ramps[4]\n0,0\n",
        "experiment test failed: ramps[4] must be an element of ramps (shape (3,))",
    ),
    "a word for a number": (
        2,
        "time,y\n0,a\n",
        "experiment test failed: y in row 1 must be numbers (got 'a')",
    ),
    "too few numbers": (
        3,
        "time,ramps\n0,1 2\n",
        "experiment test failed: ramps in row 1 must be 3 numbers (got '1 2')",
    ),
    "a short row": (
        2,
        "time,y\n0\n",
        "experiment test failed: cannot read results.csv: number of cells in row 1 must be 2 (got 1)",
    ),
    "no rows": (
        2,
        "time,y\n",
        "experiment test failed: cannot read results.csv: number of rows must be at least 2, with the",
    ),
    "times that go back": (
        2,
        "time,y\n1,0\n0,0\n",
        "experiment test failed: cannot read results.csv: times must be finite and must not decrease",
    ),
    "no text": (
        2,
        b"time,y\n0,\xff\n",
        "experiment test failed: cannot read results.csv: invalid CSV: 'utf-8' codec",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_results_are_a_problem(fmu, case):
    fmi, results, problem = WRONG[case]
    (result,) = examined(fmu(fmi=fmi, files=references(results))).problems
    assert result.startswith(problem)


def test_start_of_an_experiment_is_its_own(fmu):
    files = references("time,ramps\n2,2 4 6\n3,3 6 9\n", times='startTime="2" stopTime="3" stepSize="0.5"')
    assert examined(fmu(fmi=3, files=files)).problems == []


def test_texts_are_set_too(fmu):
    files = references("time,y\n0,0\n1,0\n", inputs="time,in_text\n0,first\n0.5,second\n")
    code = 'return model.text[0] && strcmp(model.text, time < 0.49 ? "first" : "second") ? 3 : 0'
    assert examined(fmu(code, fmi=3, files=files)).problems == []


ABSURD = {
    "a stop": (
        'startTime="0" stopTime="1e9" stepSize="1e-3"',
        "number of steps of an experiment must be at most 1000000 (got 1e+12: 0 s to 1e+09 s",
    ),
    "a step": (
        'startTime="0" stopTime="1" stepSize="1e-12"',
        "number of steps of an experiment must be at most 1000000 (got 1e+12: 0 s to 1 s",
    ),
    "no number": ('startTime="0" stopTime="a"', "could not convert string to float: 'a'"),
    "no end": ('startTime="0" stopTime="inf"', "times of an experiment must be finite"),
}


@pytest.mark.parametrize("case", ABSURD)
def test_absurd_times_of_an_experiment_are_a_problem(fmu, case):
    times, words = ABSURD[case]
    (problem,) = examined(fmu(files=references("time,y\n0,0\n1,0\n", times=times))).problems
    assert problem.startswith("experiment test failed: ")
    assert words in problem


# --- files outside the FMU ---


@pytest.mark.parametrize(
    "place", ["absolute", "relative", "/dev/zero", "/dev/stdin", "a pipe", "a link", "a folder"]
)
def test_files_outside_the_fmu_are_not_read(fmu, tmp_path, cache, place):
    secret, pipe = tmp_path / "secret.csv", tmp_path / "pipe"
    secret.write_text(f"{SECRET}\ntime,y\n0,0\n")
    os.mkfifo(pipe)
    source = {
        "absolute": secret,
        "relative": "../" * 20 + str(secret),
        "a pipe": pipe,
        "a link": "linked.csv",
        "a folder": ".",
    }.get(place, place)
    path = fmu(files=references("time,y\n0,0\n1,0\n", source=source))
    if place == "a link":  # The FMU may create a link when it runs.
        examined(path)
        (folder,) = cache.glob("*/extra/*")
        (folder / "linked.csv").symlink_to(secret)
    report = examined(path)
    (problem,) = report.problems
    assert problem.startswith("experiment test failed: ")
    assert re.search("cannot read .*: (not inside|no such file in) the FMU$", problem)
    assert SECRET not in str(report)


# --- archives ---


# Paths of entries outside the folder of the FMU, or not portable.
OUTSIDE = ["/etc/evil", "C:evil", "resources\\evil", "..\\..\\evil", "../evil", "a/../../evil"]


@pytest.mark.parametrize("name", OUTSIDE)
def test_entry_outside_its_folder_is_a_problem(tmp_path, cache, name):
    path = packed(tmp_path / "a.fmu", [(name, "text")])
    words = (
        f"the path of an entry must be a relative path with forward slashes and without '..' (got {name!r})"
    )
    assert examined(path).problems == [words]
    assert not cache.exists()


def bomb(path, files):
    """Write an archive with 150 MB of zeros in each of some files."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as made:
        made.writestr(DESCRIPTION, description())
        for number in range(files):
            with made.open(f"resources/{number}", "w") as stream:
                for _ in range(150):
                    stream.write(bytes(1_000_000))
    return path


def test_archive_of_more_than_a_gigabyte_is_rejected_before_unpacking(tmp_path, cache):
    path = bomb(tmp_path / "a.fmu", 7)
    (problem,) = examined(path).problems
    assert problem == "unpacked size must be at most 1 GB (got 1.05 GB)"
    assert not cache.exists()


def test_entry_larger_than_its_declared_size_is_rejected(tmp_path, cache):
    path = bomb(tmp_path / "a.fmu", 1)
    content = path.read_bytes().replace((150_000_000).to_bytes(4, "little"), (1000).to_bytes(4, "little"))
    path.write_bytes(content)
    (problem,) = examined(path).problems
    assert problem.startswith("the archive cannot be unpacked: ")
    assert list(cache.iterdir()) == []


def test_damaged_entry_is_a_problem_and_leaves_no_files(tmp_path, cache):
    path = packed(tmp_path / "a.fmu", [("resources/a", os.urandom(10_000))])
    content = bytearray(path.read_bytes())
    content[content.index(b"resources/a") + 500] ^= 255
    path.write_bytes(content)
    (problem,) = examined(path).problems
    assert problem.startswith("the archive cannot be unpacked: Bad CRC-32 for file 'resources/a'")
    assert list(cache.iterdir()) == []


@pytest.mark.slow
def test_invalid_fmu_is_an_error_in_a_line(tmp_path, cache):
    pipe, text, empty, plain = (tmp_path / name for name in ("pipe", "text", "empty.fmu", "plain.fmu"))
    os.mkfifo(pipe)
    text.write_text("text")
    empty.write_bytes(b"")
    with zipfile.ZipFile(plain, "w") as made:
        made.writestr("readme.txt", "no FMU")
    cases = {
        pipe: "cannot read {}: not a regular file (a device or a pipe)",
        tmp_path: "cannot read {}: is a directory",
        tmp_path / "nothing": "cannot read {}: no such file or directory",
        text / "a": "cannot read {}: not a directory",
        text: "cannot read {}: not a zip archive: File is not a zip file",
        empty: "cannot read {}: not a zip archive: File is not a zip file",
        plain: "cannot read {}: no modelDescription.xml at the top level of the archive",
    }
    for path, words in cases.items():
        assert_one_line_error(command("check", path), f"error: {words.format(path)}")


def test_time_limit_is_a_quantity(tmp_path):
    for text in ("0", "-1 s", "a", "1 m", "inf"):
        assert_one_line_error(
            command("check", "a.fmu", "--timeout", text), "--timeout must be a number above 0 in s"
        )
    with pytest.raises(FmuError, match=r"timeout must be a positive number of seconds \(got nan\)"):
        check_fmu(tmp_path, float("nan"))
    done = command("check", "-h")
    assert "Time limit of the process that runs the FMU, e.g. '5 min'." in " ".join(done.output.split())


def test_failed_start_of_a_process_is_an_error_in_a_line(tmp_path, cache, monkeypatch):
    monkeypatch.setattr(check, "__package__", "no_package")
    assert_one_line_error(
        command("check", packed(tmp_path / "a.fmu", [])), "cannot start the process of the check: "
    )
