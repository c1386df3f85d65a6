"""A script of LMGC90, read with Python's `ast` and never run: its calls in order, with the values of their arguments."""

import ast
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import ScriptError
from .values import UnknownError, name_of, value_of

TIME_STEPS = ("TimeEvolution_SetTimeStep", "SetTimeStep", "overall_SetTimeStep")
STEPS = {"IncrementStep", "one_step", "TimeEvolution_IncrementStep"}
"""Calls that stand in the loop over the steps"""


@dataclass
class Call:
    """A call of a function that the script does not define."""

    name: str
    """Function, without the module before it"""
    arguments: list[Any]
    """Values by their places; None where only a run would give them"""
    keywords: dict[str, Any]
    """Values by their names"""
    line: int
    column: int
    """Place in the script, from 1"""
    passes: float
    """How many times the loops around it do it; not a number where that is not known"""
    loop: int
    """Line of the outermost loop around it; 0 for none"""


@dataclass
class Script:
    """A script: its lines and its calls."""

    path: Path
    lines: list[str]
    calls: list[Call] = field(default_factory=list)
    left_early: set[int] = field(default_factory=set)
    """Lines of loops over steps that a `break` may leave"""
    _functions: dict[str, ast.FunctionDef] = field(default_factory=dict)

    def _walk(self, body, names, passes, loop, inside):
        """Follow statements in their order; `names` holds values of names and changes, `inside` the functions that called them."""
        for node in body:
            match node:
                case ast.FunctionDef():
                    self._functions[node.name] = node
                case ast.ClassDef() | ast.Import() | ast.ImportFrom():
                    pass
                case ast.If():
                    self._branch(node, names, passes, loop, inside)
                case ast.For() | ast.While():
                    self._repeat(node, names, passes, loop, inside)
                case ast.With() | ast.Try():
                    for item in getattr(node, "items", ()):
                        self._calls_of(item.context_expr, names, passes, loop, inside)
                    self._walk(node.body + getattr(node, "orelse", []) + getattr(node, "finalbody", []), names, passes, loop, inside)
                case _:
                    self._calls_of(node, names, passes, loop, inside)
                    _assign(node, names)

    def _branch(self, node, names, passes, loop, inside):
        """The branch that is taken, or both, where that is not known."""
        self._calls_of(node.test, names, passes, loop, inside)
        try:
            branch = node.body if value_of(node.test, names) else node.orelse
        except UnknownError:
            other = dict(names)
            self._walk(node.body, names, passes, loop, inside)
            self._walk(node.orelse, other, passes, loop, inside)
            for name in [name for name in names if name not in other or other[name] != names[name]]:
                del names[name]
            return
        self._walk(branch, names, passes, loop, inside)

    def _repeat(self, node, names, passes, loop, inside):
        """A loop: its body once, without the values of names that it changes."""
        inner = passes * self._passes(node, names)
        first = len(self.calls)
        for name in _changed(node):
            names.pop(name, None)
        self._walk(node.body + node.orelse, names, inner, loop or node.lineno, inside)
        if _has_break(node.body) and any(call.name in STEPS for call in self.calls[first:]):
            self.left_early.add(loop or node.lineno)
        for name in _changed(node):
            names.pop(name, None)

    def _passes(self, node, names):
        """How many times a loop does its body; not a number where that is not known."""
        try:
            match node:
                case ast.While(test=ast.Compare(left=ast.Call() as call, ops=[ast.Lt() | ast.LtE()], comparators=[last])) \
                        if name_of(call) == "TimeEvolution_GetTime":
                    steps = [item for item in self.calls if item.name in TIME_STEPS and item.arguments]
                    return math.ceil(value_of(last, names) / steps[-1].arguments[0] - 1e-9)
                case ast.While():
                    return _passes_of_while(node, names)
                case ast.For(iter=ast.Call(func=ast.Name(id="range" | "xrange"), args=arguments)):
                    return len(range(*(int(value_of(argument, names)) for argument in arguments)))
            return len(value_of(node.iter, names))
        except (UnknownError, ArithmeticError, LookupError, TypeError, ValueError):
            return math.nan

    def _calls_of(self, node, names, passes, loop, inside):
        """Note the calls within a statement, those in arguments before those that take them; follow functions of the script."""
        for call in _calls(node):
            name = name_of(call)
            if isinstance(call.func, ast.Name) and name in self._functions and name not in inside:
                function = self._functions[name]
                self._walk(function.body, names | _bound(function, call, names), passes, loop, (*inside, name))
                continue
            self.calls.append(Call(name, [_or_none(value, names) for value in call.args],
                                   {item.arg: _or_none(item.value, names) for item in call.keywords if item.arg},
                                   call.lineno, call.col_offset + 1, passes, loop))  # fmt: skip


def read_script(path: Path) -> Script:
    """Read a script."""
    try:
        text = path.read_text(errors="replace")
    except OSError as error:
        raise ScriptError(f"cannot read the file: {error.strerror}", path) from error
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        raise ScriptError(f"this is not Python 3: {error.msg}", path, error.lineno or 1, error.offset or 1, text.splitlines()) from error
    except (ValueError, RecursionError) as error:
        raise ScriptError("this is not Python 3", path) from error
    script = Script(path, text.splitlines())
    script._walk(tree.body, {"__name__": "__main__"}, 1, 0, ())
    return script


def _calls(node) -> Iterator[ast.Call]:
    """Calls within a node, inner ones first."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.Lambda):
            yield from _calls(child)
    if isinstance(node, ast.Call):
        yield node


def _or_none(node, names):
    """A value, or None."""
    try:
        return value_of(node, names)
    except UnknownError:
        return None


def _assign(node, names):
    """Give names their values, or take those away that are not known."""
    match node:
        case ast.Assign(targets=targets, value=value):
            pairs = [(target, value) for target in targets]
        case ast.AnnAssign(target=target, value=value) if value is not None:
            pairs = [(target, value)]
        case ast.AugAssign(target=ast.Name(id=name)):
            pairs = [(node.target, ast.BinOp(ast.Name(name, ast.Load()), node.op, node.value))]
        case _:
            return
    for target, value in pairs:
        match target, value:
            case ast.Name(id=name), _:
                _set(name, value, names)
            case ast.Tuple(elts=several), ast.Tuple(elts=values) if len(several) == len(values):
                for one, its in zip(several, values, strict=True):
                    _assign(ast.Assign([one], its), names)
            case _:
                for name in _stored(target):
                    names.pop(name, None)


def _set(name, value, names):
    """Give a name a value, or none."""
    try:
        names[name] = value_of(value, names)
    except UnknownError:
        names.pop(name, None)


def _bound(function, call, names):
    """Values of the arguments of a function of the script."""
    parameters = [argument.arg for argument in function.args.args]
    given = dict(zip(parameters, call.args, strict=False)) | {item.arg: item.value for item in call.keywords if item.arg}
    defaults = dict(zip(reversed(parameters), reversed(function.args.defaults), strict=False))
    return {name: _or_none(value, names) for name, value in (defaults | given).items()}


def _stored(node):
    """Names that a node gives values to."""
    return {name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)}


def _changed(node):
    """Names that a loop changes, other than those that it gives one constant."""
    changed = _stored(node)
    once = [item for item in ast.walk(node) if isinstance(item, ast.Assign) and isinstance(item.value, ast.Constant)]
    constants = {target.id for item in once for target in item.targets if isinstance(target, ast.Name)}
    stores = [name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)]
    return {name for name in changed if name not in constants or stores.count(name) > 1}


def _has_break(body):
    """Does a `break` or `return` leave the loop of these statements?"""
    for node in body:
        if isinstance(node, ast.Break | ast.Return):
            return True
        inner = [getattr(node, part, []) for part in ("body", "orelse", "finalbody")] if isinstance(node, ast.If | ast.With | ast.Try) else []
        if any(map(_has_break, inner)):
            return True
    return False


def _passes_of_while(node, names):
    """Passes of `while name < last` whose body has `name += step` once, at its top level."""
    match node.test:
        case ast.Compare(left=ast.Name(id=name), ops=[ast.Lt() | ast.LtE() as sign], comparators=[last]):
            steps = [item for item in node.body if isinstance(item, ast.AugAssign | ast.Assign) and name in _stored(item)]
            stores = [item.id for item in ast.walk(node) if isinstance(item, ast.Name) and isinstance(item.ctx, ast.Store)]
            if len(steps) != 1 or stores.count(name) != 1:
                raise UnknownError
            step, first = _step_of(steps[0], name, names), value_of(ast.Name(name, ast.Load()), names)
            end = value_of(last, names)
            if step <= 0 or not all(isinstance(number, int) for number in (first, end, step)):
                raise UnknownError
            return len(range(first, end + isinstance(sign, ast.LtE), step))
    raise UnknownError


def _step_of(statement, name, names):
    """The step of `name += step` or `name = name + step`."""
    match statement:
        case ast.AugAssign(op=ast.Add(), value=value) | ast.Assign(value=ast.BinOp(left=ast.Name(), op=ast.Add(), right=value)):
            return value_of(value, names)
    raise UnknownError
