"""Environment and fixtures that all tests share."""

from fnmatch import fnmatchcase

import pytest


@pytest.fixture(scope="session", autouse=True)
def ranks_of_root():
    """Lets mpiexec start ranks where tests run as root: without these variables it refuses."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
            patch.setenv(name, "1")
        yield


@pytest.fixture
def render_only(monkeypatch):
    """A function that makes studies render only figures whose names match one of its patterns; others are built alone."""
    from splitgrain_postpro.study.report import Report

    render = Report.save

    def choose(*patterns):
        def save(report, figure, name, words):
            return render(report, figure, name, words) if any(fnmatchcase(name, pattern) for pattern in patterns) else ""

        monkeypatch.setattr(Report, "save", save)

    return choose


@pytest.fixture
def unarranged(monkeypatch):
    """Leaves out the layout of figures, half of the time of a figure, where a test makes no claim on the places of their parts."""
    monkeypatch.setattr("matplotlib.layout_engine.ConstrainedLayoutEngine.execute", lambda *_: None)
