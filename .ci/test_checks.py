"""The source checks can fail: each rule is broken once in a small project."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from rooms import MOST_NAMES

HERE = Path(__file__).parent
GOOD = """!> Why this module exists.
module sg_{name}
  {use}
  implicit none
  private
  public :: work

contains

  !> Do the work.
  subroutine work()
    {code}
  end subroutine work
end module sg_{name}
"""


def run(check, *arguments):
    result = subprocess.run([sys.executable, HERE / check, *arguments], capture_output=True, text=True)
    return result.returncode, result.stdout


def write(top, place, use="", code="", text=GOOD):
    path = top / place
    path.parent.mkdir(parents=True, exist_ok=True)
    filled = text.format(name=path.stem, use=use, code=code)
    path.write_text("\n".join(line.rstrip() for line in filled.splitlines()) + "\n")
    return path


@pytest.fixture
def project(tmp_path):
    write(tmp_path, "src/base/text.f90", code="print *, 'mpi_init h5open_f' ! hid_t")
    write(tmp_path, "src/base/system/alarm.f90", use="use sg_text, only: work")
    write(tmp_path, "src/scene/scene.f90", use="use sg_text, only: work", code="call mapping('use mpi')")
    write(tmp_path, "src/parallel/comm.f90", use="use mpi_f08, only: mpi_init", code="call mpi_init()")
    write(tmp_path, "src/output/files.f90", use="use sg_scene, only: work")
    return tmp_path


@pytest.mark.parametrize("check", ["check_layers", "check_style"])
def test_good_project_passes(project, check):
    code, printed = run(check, project)
    assert code == 0, printed


@pytest.mark.parametrize("check", ["check_layers", "check_style"])
def test_empty_project_fails(tmp_path, check):
    assert run(check, tmp_path)[0] == 1


@pytest.mark.parametrize("place, use, code, finding", [
    ("src/base/lists.f90", "use sg_scene, only: work", "", "base uses sg_scene of the later room scene"),
    ("src/scene/plan.f90", "use, non_intrinsic :: sg_files, only: work", "", "scene uses sg_files of the later room output"),
    ("src/scene/plan.f90", "use mpi_f08, only: mpi_send", "", "mpi_f08 outside src/parallel"),
    ("src/scene/plan.f90", "", "call MPI_Send()", "mpi_send outside src/parallel"),
    ("src/output/files.f90", "use hdf5, only: hid_t", "", "outside a file *_with_hdf5.f90"),
    ("src/partition/graph_split.f90", "", "call METIS_PartGraphKway()", "outside a file *_with_metis.f90"),
    ("src/base/fourier_with_metis.f90", "", "call fftw_destroy_plan(plan)", "outside a file *_with_fftw.f90"),
    ("src/base/sparse_factor.f90", "", "call umfpack_di_free_numeric(numeric)", "outside a file *_with_suitesparse.f90"),
    ("src/base/convex_hull.f90", "", "code = splitgrain_hull(n, points)", "outside a file *_with_qhull.f90"),
    ("src/base/eigenvalues.f90", "", "call dgeev(job, job, n)", "outside a file *_with_lapack.f90"),
    ("src/unheard/plan.f90", "", "", "'unheard' is not in the order"),
    ("src/input/kitchen/plan.f90", "", "", "'input/kitchen' is not in the order"),
    ("src/base/system.f90", "use sg_alarm, only: work", "", "base uses sg_alarm of the later room base/system"),
])  # fmt: skip
def test_layers(project, place, use, code, finding):
    write(project, place, use, code)
    status, printed = run("check_layers", project)
    assert status == 1 and finding in printed


def test_rooms_stay_small(project):
    for number in range(MOST_NAMES):
        write(project, f"src/base/more_{number}.f90")
    status, printed = run("check_layers", project)
    assert status == 1 and f"{MOST_NAMES + 1} files" in printed


def test_tables_of_rooms(project):
    page = project / "doc/guide/architecture.md"
    page.parent.mkdir(parents=True)
    page.write_text("head\n<!-- rooms -->\nstale words\n<!-- end -->\n<!-- uses -->\n\n<!-- end -->\ntail\n")
    assert run("draw_rooms", "--check", project)[0] == 1
    assert run("draw_rooms", project)[0] == 0 and run("draw_rooms", "--check", project)[0] == 0
    drawn = page.read_text()
    assert drawn.startswith("head\n") and drawn.endswith("<!-- end -->\ntail\n") and "stale" not in drawn
    assert "| `src/base/system` | 1 |" in drawn
    # One module of scene and the one of base/system use one of base.
    assert re.search(r"^base +1( +\.)*$", drawn, re.M) and re.search(r"^scene +1( +\.)*$", drawn, re.M)


STEP = """module sg_advance
  use sg_motion, only: predict
  use sg_scene, only: &
    work
contains
  subroutine advance(sim, error)
    call timed(move, sim, phase_predict, error)
    call timed(solve, sim, phase_solve, error)
  end subroutine advance
  subroutine move(sim, error)
    call look(sim)
    call predict(sim)
    ! call work(sim)
  end subroutine move
  pure logical function look(sim)
    look = work(sim)
  end function look
  subroutine solve(sim, error)
    call sim%ranks%sum(sim%step)
  end subroutine solve
end module sg_advance
"""
OWNER = """module sg_simulation
  use sg_ranks, only: ranks_t
  type :: simulation_t
    type(ranks_t) :: ranks
    integer :: step = 0
  end type simulation_t
end module sg_simulation
"""
RANKS = """module sg_ranks
  type :: ranks_t
  contains
    generic :: sum => sum_integer, sum_real
  end type ranks_t
end module sg_ranks
"""
DRAWN = """<!-- step -->
```
predict     move
              look
                work                        scene/scene
              predict                       run/motion
                work                        scene/scene
solve       solve
              ranks%sum                     parallel/ranks
```
<!-- end -->
"""


def test_drawing_of_a_step(project):
    page = project / "doc/guide/architecture.md"
    page.parent.mkdir(parents=True)
    page.write_text("<!-- step -->\n\n<!-- end -->\n")
    motion = GOOD.replace("subroutine work", "subroutine predict")
    write(project, "src/run/motion.f90", use="use sg_scene, only: work", code="call work()", text=motion)
    for place, text in (("run/advance", STEP), ("run/simulation", OWNER), ("parallel/ranks", RANKS)):
        write(project, f"src/{place}.f90", text=text)
    assert run("draw_rooms", project)[0] == 0 and page.read_text() == DRAWN
    write(project, "src/run/advance.f90", text=STEP.replace("call look(sim)", "call other(sim)"))
    assert run("draw_rooms", "--check", project)[0] == 1


@pytest.mark.parametrize("old, new, finding", [
    ("", "", ""),
    ("arm_law = 16", "arm_law = 17", "record of arm_frictional is not filled"),
    ("arm_bias_t = 8", "arm_bias_t = 7", "record of arm_frictional is not filled"),
    ("ball_spin_z = 6", "ball_spin_z = 9", "body of ball_frictional is not filled"),
    ("arm_law, ball_frictionless_inverse_wnn", "arm_wtt, ball_frictionless_inverse_wnn", "record of arm_frictional is not"),
    ("arm_cohesion = 13", "arm_swaying = 13", "no symbol for 'swaying'"),
    ("round_bias_n = 3, round_bias_t = 4", "round_bias_n = 4, round_bias_t = 3", "out of date"),
])  # fmt: skip
def test_tables_of_records(tmp_path, old, new, finding):
    for place in ("src/scene/plan.f90", "src/problem/records.f90", "doc/theory/contact_problem.md"):
        (tmp_path / place).parent.mkdir(parents=True)
        (tmp_path / place).write_text((HERE.parent / place).read_text())
    layout = tmp_path / "src/problem/records.f90"
    assert old in layout.read_text()
    layout.write_text(layout.read_text().replace(old, new))
    status, printed = run("draw_records", "--check", tmp_path)
    assert (status, finding in printed) == (int(bool(finding)), True)


DECKS_CSV = "deck,cpu_seconds,from,ranks,expect,follows,picture\nball.toml,0.02,run,1,It bounces.,closed form,ball.png\n"


@pytest.mark.parametrize("place, text, finding", [
    ("decks.csv", DECKS_CSV, ""),
    ("new/late.toml", "# A late deck.\n", "input_decks/new/late.toml:1: no row in input_decks/decks.csv"),
    ("ball.toml", "[time]\n", "input_decks/ball.toml:1: no comment at the top"),
    ("ball.toml", "# Another ball. It falls.\n", "input_decks/README.md:1: not what .ci/draw_decks writes"),
    ("decks.csv", DECKS_CSV + "gone.toml,,,1,Nothing.,none,\n", "input_decks/decks.csv:3: no deck gone.toml"),
    ("decks.csv", DECKS_CSV.replace("It bounces.", ""), "input_decks/decks.csv:2: ball.toml has no expect"),
    ("decks.csv", DECKS_CSV.replace("ball.png", "box.png"), "input_decks/decks.csv:2: no picture doc/images/box.png"),
    ("decks.csv", DECKS_CSV.replace(",run,", ",guide/none.md,"), "input_decks/decks.csv:2: no page doc/guide/none.md"),
])  # fmt: skip
def test_page_of_decks(tmp_path, place, text, finding):
    for name, content in (("input_decks/ball.toml", "# A ball of 0.1 m (A. Dyskin) falls. It bounces.\n[time]\n"),
                          ("input_decks/decks.csv", DECKS_CSV), ("doc/images/ball.png", ""), (f"input_decks/{place}", None)):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if content is not None:
            (tmp_path / name).write_text(content)
    assert run("draw_decks", tmp_path)[0] == 0
    page = (tmp_path / "input_decks/README.md").read_text()
    assert "| A ball of 0.1 m (A. Dyskin) falls. | 0.02 | It bounces. |" in page
    (tmp_path / "input_decks" / place).write_text(text)
    status, printed = run("draw_decks", "--check", tmp_path)
    assert (status, finding in printed) == (int(bool(finding)), True), printed


@pytest.mark.parametrize("place, old, new, finding", [
    ("bodies/bodies.f90", "", "", "2 files, 0 findings"),
    ("bodies/bodies.f90", "mass(:)\n", "mass(:)\n    real(wp), allocatable :: heat(:), salt(:, :)\n", "salt of bodies_t is visited 0"),
    ("bodies/bodies.f90", "self%area)", "self%mass)", "mass of bodies_t is visited 2 times"),
    ("bodies/bodies.f90", "field_t('force'", "field_t('forces'", "force is visited as 'forces'"),
    ("detection/contacts.f90", "    call visitor%visit(field_t('gap'", "    ! call visitor%visit(field_t('gap'", "gap of contacts_t is visited 0"),
])  # fmt: skip
def test_lists_of_fields(tmp_path, place, old, new, finding):
    for name in ("bodies/bodies.f90", "detection/contacts.f90"):
        (tmp_path / "src" / name).parent.mkdir(parents=True)
        (tmp_path / "src" / name).write_text((HERE.parent / "src" / name).read_text())
    changed = tmp_path / "src" / place
    assert old in changed.read_text()
    changed.write_text(changed.read_text().replace(old, new, 1))
    status, printed = run("check_fields", tmp_path)
    assert (status, finding in printed) == (int("0 findings" not in finding), True), printed


@pytest.mark.parametrize("old, new, finding", [
    ("module sg_{name}", "module {name}", "should hold one module sg_plan"),
    ("  implicit none", "", "no 'implicit none'"),
    ("  private\n", "", "no 'private'"),
    ("  !> Do the work.\n", "", "work has no '!>' line"),
    ("  !> Do", "\t!> Do", "tab"),
    ("{code}", "x = 1" + 70 * " + 1", "columns, more than 132"),
    ("{code}", 80 * "\n", "work has 83 lines"),
    ("{code}", 490 * "\n", "lines, more than 500"),
])  # fmt: skip
def test_style(project, old, new, finding):
    write(project, "src/base/plan.f90", text=GOOD.replace(old, new))
    status, printed = run("check_style", project)
    assert status == 1 and finding in printed


@pytest.mark.parametrize("lines, status", [(79, 0), (80, 1)])
def test_drivers_are_short(project, lines, status):
    text = GOOD.format(name="run", use="", code="print *, 1")
    write(project, "drivers/run.f90", text=text + (lines - text.count("\n")) * "!\n")
    assert run("check_style", project)[0] == status


def test_drivers_have_docstrings(project):
    write(project, "drivers/run.f90", text=GOOD.replace("  !> Do the work.\n", ""))
    assert "work has no '!>' line" in run("check_style", project)[1]


def test_trailing_blank(project):
    path = write(project, "src/base/plan.f90")
    path.write_text(path.read_text() + " \n")
    assert "trailing blanks" in run("check_style", project)[1]


@pytest.mark.parametrize("sentence", [
    "Contacts whom sweeps update.", "A split made anew.", "The same but for rounding.", "343 bytes a grain, twenty sweeps a step.",
    "What the solver said.",
])  # fmt: skip
def test_words(project, sentence):
    assert run("check_words", project)[0] == 0
    path = write(project, "src/base/plan.f90", code=f"! {sentence}")
    place = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if sentence in line)
    status, printed = run("check_words", project)
    assert status == 1 and f"plan.f90:{place}: " in printed


def test_references(project):
    write(project, "src/base/plan.f90", code="! After [Jean1999].")
    assert "[Jean1999] has no entry" in run("check_words", project)[1]
    page = project / "doc/references.md"
    page.parent.mkdir(exist_ok=True)
    page.write_text("- **[Jean1999]** M. Jean\n")
    assert run("check_words", project)[0] == 0
    page.write_text("- **[Jean1999]** M. Jean\n- **[Moreau1988]** J. J. Moreau\n")
    status, printed = run("check_words", project)
    assert status == 1 and "references.md:2: no file cites [Moreau1988]" in printed


PAGE = """# The page

## How `work` works

The step `work` of `text.f90` (`src/base/text.f90`, [here](#how-work-works), [there](other.md#the-page)), and
`src/<room>/text.f90`; `sim%step` and `PTPT2_LoadNetwork`.

<!-- where -->
| thing | file | names |
|---|---|---|
| the work | `src/base/text.f90` | `work` |
<!-- end -->

```
src/base/text  calls any_thing of `the_kind`
```
"""


@pytest.mark.parametrize("old, new, finding", [
    ("", "", ""),
    ("# The page", "# The page\n" + 60 * "so " + "on", "page.md:2: 182 columns, more than 120"),
    ("# The page", "# The page\n| " + 60 * "so " + "|", ""),
    ("calls any_thing", "calls any_thing" + 110 * " " + "on", ""),
    ("The step `work`", "The step `works`", "page.md:5: no source holds the name works"),
    ("`text.f90` (", "`texts.f90` (", "page.md:5: no file texts.f90"),
    ("(`src/base/text.f90`", "(`src/base/texts.f90`", "page.md:5: no file src/base/texts.f90"),
    ("`src/<room>/text", "`src/<room>/step/text", "page.md:6: no file src/<room>/step/text.f90"),
    ("other.md", "others.md", "page.md:5: no file others.md"),
    ("(#how-work-works)", "(#how-it-works)", "page.md:5: no heading #how-it-works"),
    ("#the-page", "#no-page", "page.md:5: no heading #no-page in other.md"),
    ("[there]", "[Jean1999]]", "page.md:5: no second bracket before [Jean1999]]("),
    ("sim%step", "simulation%step", "page.md:6: no source holds the name simulation%step"),
    ("| `work` |", "| `sim` |", "page.md:11: src/base/text.f90 does not define sim"),
    ("src/base/text  calls", "src/base/no_text  calls", "page.md:15: no file src/base/no_text"),
])  # fmt: skip
def test_pages(project, old, new, finding):
    write(project, "src/base/text.f90", code="sim%step = 1 ! works")
    for name in ("page", "other"):
        (project / "doc").mkdir(exist_ok=True)
        (project / "doc" / f"{name}.md").write_text(PAGE)
    page = project / "doc/page.md"
    assert old in PAGE
    page.write_text(PAGE.replace(old, new, 1) if old else PAGE)
    status, printed = run("check_docs", project)
    assert (status, finding in printed) == (int(bool(finding)), True), printed
    write(project, "src/base/text.f90", code="sim%step = 1 ! doc/page.md, doc/theory/pages.md")
    assert "src/base/text.f90:12: no file doc/theory/pages.md" in run("check_docs", project)[1]


@pytest.mark.parametrize("line, finding", [
    ("def plot(ax: int, *, size: int = 1) -> None: ...", ""),
    ("def _plot(ax): ...", ""),
    ("def plot(ax, size: int = 1) -> None: ...", "page.py:1: plot has no hint for ax"),
    ("def plot(ax: int, *sizes) -> None: ...", "page.py:1: plot has no hint for sizes"),
    ("def plot(ax: int): ...", "page.py:1: plot has no hint for its result"),
    ("class Page:\n  def __init__(self, ax): ...", "page.py:2: __init__ has no hint for ax"),
    ("class Page:\n  def plot(self, ax: int) -> None: ...", ""),
    ("class _Page:\n  def plot(self, ax): ...", ""),
])  # fmt: skip
def test_hints(tmp_path, line, finding):
    page = tmp_path / "postpro/splitgrain_postpro/study/page.py"
    page.parent.mkdir(parents=True)
    page.write_text(line + "\n")
    status, printed = run("check_hints", tmp_path)
    assert (status, finding in printed) == (int(bool(finding)), True), printed
