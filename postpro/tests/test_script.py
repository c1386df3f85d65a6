"""Scripts of LMGC90 that are read and not run."""

import math

import pytest
from splitgrain_postpro.convert.calls import keys_of
from splitgrain_postpro.convert.script import read_script
from splitgrain_postpro.errors import ScriptError

SOLVE = "chipy.ExSolver('Stored_Delassus_Loops         ', 'QM/16', tol=1e-4, relax=0.9, gs_it1=50, gs_it2=10)\n"


def keys(tmp_path, text):
    """Keys of a script, and its warnings as sentences."""
    path = tmp_path / "command.py"
    path.write_text(text)
    found = keys_of(read_script(path))
    return {key: value for key, (value, _) in found.values.items()}, [str(warning) for warning in found.warnings]


@pytest.mark.parametrize(("loop", "steps"), [
    ("for k in range(1, nb + 1):\n", 40), ("for k in range(nb):\n", 40), ("for k in range(0, nb, 2):\n", 20),
    ("k = 0\nwhile k < nb:\n    k += 1\n", 40), ("k = 1\nwhile k <= nb:\n    k = k + 1\n", 40),
    ("while chipy.TimeEvolution_GetTime() < t_end:\n", 250), ("for part in [1, 2, 3]:\n", 3),
    ("for j in range(5):\n  for k in range(nb):\n    pass\n", 5),
])  # fmt: skip
def test_steps_are_passes_of_the_loop(tmp_path, loop, steps):
    found, warnings = keys(tmp_path, f"nb, t_end = 4 * 10, 0.25\nchipy.SetTimeStep(1e-3)\n{loop}    IncrementStep()\n" if "pass" not in loop
                           else f"nb = 40\n{loop}  IncrementStep()\n")
    assert (found["time.steps"], warnings) == (str(steps), [])


def test_nested_loops_multiply(tmp_path):
    found, _ = keys(tmp_path, "for i in range(3):\n  for k in range(10):\n    one_step('x', 'Quad ', 1e-4, 1.0, 5, 6, 1, 20)\n")
    assert found == {"time.steps": "30", "solver.criterion": '"quad"', "solver.method": '"nlgs"', "solver.tolerance": "0.0001",
                     "solver.relaxation": "1.0", "solver.check_every": "5", "solver.maximum_sweeps": "30", "output.every": "20"}


def test_names_arithmetic_and_functions(tmp_path):
    found, warnings = keys(tmp_path, f"""
import math, numpy as np
a, b = 2., [1., math.pi]
def setup(h, lx=3 * b[0], *rest):
    Integrator_InitTheta(0.5 + 0.1 * int(a > 1))
    TimeEvolution_SetTimeStep(h / a)
    SetPeriodicCondition(xperiod=lx, yperiod=round(b[1], 2))
    {SOLVE}
if __name__ == '__main__':
    SetDimension(3)
    bulk_behav_SetGravity(np.array([0., 0., -9.81]))
    setup(2e-3)
else:
    setup(5e-3)
""")
    assert warnings == []
    assert found["time.step"] == "0.001" and found["time.theta"] == "0.6"
    assert (found["scene.period_x"], found["scene.period_y"], found["scene.gravity"]) == ("3.0", "3.14", "[0.0, 0.0, -9.81]")
    assert (found["solver.tolerance"], found["solver.relaxation"], found["solver.maximum_sweeps"]) == ("0.0001", "0.9", "500")


def test_gravity_of_the_plane_has_two_components(tmp_path):
    assert keys(tmp_path, "SetDimension(2)\nbulk_behav_SetGravity([0., -1, 0.])\n")[0]["scene.gravity"] == "[0.0, -1.0]"


@pytest.mark.parametrize(("text", "sentence"), [
    ("TimeEvolution_SetTimeStep(float(input()))", "time.step cannot be worked out"),
    ("import sys\nh = 1e-3\nif len(sys.argv) > 1:\n    h = 2e-3\nSetTimeStep(h)", "time.step cannot be worked out"),
    ("SetTimeStep(1e-3)\nSetTimeStep(2e-3)", "time.step changes here from 0.001 to 0.002"),
    ("h = 1.0\nwhile h > 0.1:\n    h = h / 2\nSetTimeStep(h)", "time.step cannot be worked out"),
    ("SetTimeStep(10**10**10)", "time.step cannot be worked out"),
    ("SetTimeStep(1 / 0)", "time.step cannot be worked out"),
    ("for k in range(9):\n    IncrementStep()\n    if k > input():\n        break", "a condition may end the loop"),
    ("while True:\n    IncrementStep()", "time.steps cannot be worked out"),
    ("for k in range(2):\n    IncrementStep()\nfor k in range(3):\n    IncrementStep()", "more than one loop makes steps"),
    ("Integrator_InitGear()", "theta scheme alone"), ("RBDY3_FatalDamping()", "FatalDamping is not carried over"),
    ("chipy.RBDY3_PutBodyVector('Fext_', 2, f)", "see [[drive]]"), ("mecaMAILx_ComputeMass()", "deformable bodies"),
    ("ExSolver('x', 'QuaN ', 1e-4, 1.0, 1, 2)", 'the criterion "QuaN " has no counterpart'), ("pass", "no call of LMGC90"),
    ("def f():\n    f()\n    SetTimeStep(x)\nf()", "time.step cannot be worked out"),
])  # fmt: skip
def test_what_is_not_known_is_warned_of(tmp_path, text, sentence):
    assert sentence in " ".join(keys(tmp_path, text)[1])


def test_a_loop_of_the_solver_that_is_written_out(tmp_path):
    found, warnings = keys(tmp_path, """
for k in range(7):
    IncrementStep()
    nlgs_3D_SetCheckType('Quad ', 1e-3, 1.0)
    for i in range(10):
        nlgs_3D_ExIter(25)
        if nlgs_3D_AfterIterCheck() == 0:
            break
""")
    assert warnings == [] and (found["time.steps"], found["solver.check_every"], found["solver.criterion"]) == ("7", "25", '"quad"')


def test_mistakes_have_a_caret(tmp_path):
    with pytest.raises(ScriptError) as raised:
        keys(tmp_path, "a = 1\nprint 'Python 2'\n")
    lines = raised.value.report().splitlines()
    assert lines[0].startswith(f"{tmp_path}/command.py:2:1: error: this is not Python 3") and lines[1:] == ["  print 'Python 2'", "  ^"]
    with pytest.raises(ScriptError, match="cannot read"):
        read_script(tmp_path / "no.py")
    assert math.isnan(read_script_passes(tmp_path))


def read_script_passes(tmp_path):
    """Passes around a call in a loop whose end is not known."""
    (tmp_path / "loop.py").write_text("for x in things:\n    call()\n")
    return read_script(tmp_path / "loop.py").calls[0].passes
