"""Calls of an LMGC90 script as keys of a deck; those that have no counterpart, and change what a run computes, are warned of."""

import math
import re
from dataclasses import dataclass, field
from typing import Any

from ..errors import ScriptError
from .script import STEPS, TIME_STEPS, Call, Script

CRITERIA = {"Quad": "quad", "Maxm": "maxm", "QM/16": "qm16"}
PERIODS = re.compile(r"(?:RBDY2|DKDKx|PLPLx|DKPLx)_SetPeriodicCondition|(?:RBDY3|SPSPx|PRPRx|SPPRx|CDCDx|PTPT3)_Set([XY])PeriodicCondition")
SHRINK = {"PLPLx_ShrinkPolygFaces", "PRPRx_ShrinkPolyrFaces"}
OTHER_INTEGRATORS = re.compile(r"Integrator_Init(?:QS|CrankNickolson|Gear|Verlet|Beta2)")
# Calls that change the scene, the law or the scheme, and have no key, with what stands in their place where there is something.
NO_KEY = {
    re.compile(r"Set(?:Domain|\w*)Boundary|\w+_Set[XYZ](?:min|max)Boundary"): "see [[outlet]]",
    re.compile(r"RBDY[23]_(?:Set\w*Invisible|SetVisible|SetSourcePoint\w*|SetBodiesInvisible)"): "",
    re.compile(r"(?:RBDY[23]_)?FatalDamping"): "",
    re.compile(r"RBDY[23]_(?:PutBodyVector|SetVlocyDrivenDof|CompCoor\w*|AddDof\w*)"): "see [[drive]]",
    re.compile(r"(?:tact_behav_Set|nlgs_(?:3D_)?(?:UseRegularization|SetWith?Regul|CutOpenCZM|ManageInterpenetratedCZM))\w*"): "",
    re.compile(r"inter_handler_[23]D_(?:tset|set)\w*"): "",
    re.compile(r"SiconosNumerics_\w*"): "the deck has the solver",
    re.compile(r"Integrator_SetContactDetectionConfiguration"): "detection is at the middle of the step",
    re.compile(r"PTPT[23]_(?:UseCurrentNonuc0|SetExplicitLocalFrame|SetTolerance)"): "",
    re.compile(r"(?:bulk_behav_Set(?!Gravity)|MAILx|mecaMAILx|therMAILx|poroMAILx|mp_solver|CLALp|CLxxx|CSASp|DKALp)\w*"):
        "deformable bodies and other physics",
    re.compile(r"(?:postpro_Set|registerInterInternals)\w*"): "",
}  # fmt: skip


@dataclass
class Keys:
    """Keys found in a script, and what was noticed."""

    script: Script
    values: dict[str, tuple[str, int]] = field(default_factory=dict)
    """Value as TOML, and the line, by key"""
    warnings: list[ScriptError] = field(default_factory=list)

    def warn(self, sentence: str, call: Call) -> None:
        """Note a warning at a call; one per line and sentence."""
        warning = ScriptError(sentence, self.script.path, call.line, call.column, self.script.lines)
        if warning.report() not in [other.report() for other in self.warnings]:
            self.warnings.append(warning)

    def put(self, key: str, value: Any, call: Call) -> None:
        """Set a key, the first time; a value that only a run would give, and a second one, are warned of."""
        if value is None or isinstance(value, float) and not math.isfinite(value):
            self.warn(f"{key} cannot be worked out without running the script", call)
            return
        text = _toml(value)
        before = self.values.setdefault(key, (text, call.line))
        if before[0] != text:
            self.warn(f"{key} changes here from {before[0]} to {text}: the deck takes the first value", call)


def keys_of(script: Script) -> Keys:
    """Keys of the deck that repeats a script."""
    keys = Keys(script)
    for call in script.calls:
        _take(call, keys)
    _take_steps(script, keys)
    _take_checks(script, keys)
    if not keys.values:
        keys.warnings.append(ScriptError("no call of LMGC90 is found that a deck has a key for", script.path))
    return keys


def _take(call, keys):
    """Keys of one call."""
    match call.name:
        case name if name in TIME_STEPS:
            keys.put("time.step", _number(call, 0, "dt"), call)
        case "Integrator_InitTheta":
            keys.put("time.theta", _number(call, 0, "theta"), call)
        case "initialize" if len(call.arguments) + len(call.keywords) >= 3:
            keys.put("time.step", _number(call, 1, "dt"), call)
            keys.put("time.theta", _number(call, 2, "theta"), call)
        case "SetDimension" | "overall_DIME":
            keys.put("scene.dimension", _whole(call, 0, "dim"), call)
        case "ExSolver" | "nlgs_ExSolver" | "nlgs_3D_ExSolver" | "one_step":
            _take_solver(call, keys)
        case "nlgs_SetCheckType" | "nlgs_3D_SetCheckType":
            _take_criterion(call, 0, keys)
        case "bulk_behav_SetGravity":
            _take_gravity(call, keys)
        case "SetPeriodicCondition":
            for place, axis in enumerate("xy"):
                if len(call.arguments) > place or f"{axis}period" in call.keywords:
                    keys.put(f"scene.period_{axis}", _number(call, place, f"{axis}period"), call)
        case "WriteDisplayFiles" if call.loop:
            keys.put("output.every", _whole(call, 0, "freq"), call)
        case name if found := PERIODS.fullmatch(name):
            keys.put(f"scene.period_{(found[1] or 'x').lower()}", _number(call, 0, f"{(found[1] or 'x').lower()}period"), call)
        case name if name in SHRINK:
            keys.put("scene.shrink_faces", _number(call, 0, "shrink"), call)
        case name if OTHER_INTEGRATORS.fullmatch(name):
            keys.warn(f"{name}: runs here have the theta scheme alone", call)
        case _:
            _refuse(call, keys)


def _refuse(call, keys):
    """Warn of a call that changes what a run computes and has no key."""
    for pattern, hint in NO_KEY.items():
        if pattern.fullmatch(call.name):
            keys.warn(f"{call.name} is not carried over{': ' if hint else ''}{hint}", call)


def _take_solver(call, keys):
    """Keys of ExSolver(stype, norm, tol, relax, gs_it1, gs_it2): gs_it1 sweeps between two tests, gs_it2 times."""
    _take_criterion(call, 1, keys)
    between, times = _whole(call, 4, "gs_it1"), _whole(call, 5, "gs_it2")
    keys.put("solver.check_every", between, call)
    keys.put("solver.maximum_sweeps", None if between is None or times is None else between * times, call)
    if call.name == "one_step" and _argument(call, 7, "f_display") is not None:
        keys.put("output.every", _whole(call, 7, "f_display"), call)


def _take_criterion(call, first, keys):
    """Criterion, tolerance and relaxation, which follow each other."""
    norm = _argument(call, first, "norm")
    criterion = CRITERIA.get(norm.strip()) if isinstance(norm, str) else None
    if isinstance(norm, str) and criterion is None:
        keys.warn(f'the criterion "{norm}" has no counterpart: the deck stops by its own criterion', call)
    else:
        keys.put("solver.criterion", criterion, call)
    keys.put("solver.method", "nlgs", call)
    if criterion is not None:
        keys.put("solver.tolerance", _number(call, first + 1, "tol"), call)
    keys.put("solver.relaxation", _number(call, first + 2, "relax"), call)


def _take_gravity(call, keys):
    """The vector of gravity, of two components in the plane."""
    gravity = _argument(call, 0, "g")
    if not isinstance(gravity, list) or not all(isinstance(item, int | float) for item in gravity):
        gravity = None
    elif keys.values.get("scene.dimension", ("2",))[0] == "2":
        gravity = gravity[:2]
    keys.put("scene.gravity", gravity and [float(item) for item in gravity], call)


def _take_steps(script, keys):
    """The number of steps: passes of the loops that increment the step."""
    loops = {}
    for call in script.calls:
        if call.name in STEPS and call.loop:
            loops.setdefault(call.loop, call)
    if not loops:
        return
    last = list(loops.values())[-1]
    passes = sum(call.passes for call in loops.values())
    keys.put("time.steps", int(passes) if math.isfinite(passes) else None, last)
    if any(loop in script.left_early for loop in loops):
        keys.warn("a condition may end the loop over the steps: write it as [stop]", last)
    if len(loops) > 1:
        keys.warn("more than one loop makes steps: the deck has their sum; what changes between them is yours to write as [[stage]]", last)


def _take_checks(script, keys):
    """Sweeps of a solver loop that the script writes out: nlgs_ExIter(n) between two tests."""
    for call in script.calls:
        if call.name in ("nlgs_ExIter", "nlgs_3D_ExIter"):
            keys.put("solver.check_every", _whole(call, 0, "nb_iter"), call)


def _argument(call, place, name):
    """An argument by its place or its name; None where it is missing or not known."""
    return call.arguments[place] if place < len(call.arguments) else call.keywords.get(name)


def _number(call, place, name):
    """A number, or None."""
    value = _argument(call, place, name)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def _whole(call, place, name):
    """A whole number, or None."""
    value = _number(call, place, name)
    return int(value) if value is not None and math.isfinite(value) and value == int(value) else None


def _toml(value):
    """A value as TOML."""
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)
