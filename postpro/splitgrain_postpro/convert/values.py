"""Values of expressions of a script that is read and not run: numbers, strings, lists and names that were given such values."""

import ast
import math
import operator
from typing import Any

OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod, ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_,
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq, ast.NotEq: operator.ne,
}  # fmt: skip
FUNCTIONS = {"int": int, "float": float, "round": round, "abs": abs, "min": min, "max": max, "len": len,
             **{name: getattr(math, name) for name in ("sqrt", "sin", "cos", "tan", "radians", "degrees", "floor", "ceil", "exp", "log")}}
CONSTANTS = {"pi": math.pi, "e": math.e}


class UnknownError(Exception):
    """A value that only a run of the script would give."""


def value_of(node: ast.expr, names: dict[str, Any]) -> Any:
    """The value of an expression; UnknownError where it cannot be worked out from constants and names."""
    try:
        return _value(node, names)
    except (ArithmeticError, TypeError, ValueError, LookupError, RecursionError) as error:
        raise UnknownError from error


def _value(node, names):
    """The same, with the errors of the operations."""
    match node:
        case ast.Constant():
            return node.value
        case ast.Name() if node.id in names:
            return names[node.id]
        case ast.Attribute() if node.attr in CONSTANTS and isinstance(node.value, ast.Name):
            return CONSTANTS[node.attr]
        case ast.List() | ast.Tuple():
            return [_value(item, names) for item in node.elts]
        case ast.UnaryOp() if type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](_value(node.operand, names))
        case ast.BinOp(op=ast.Pow()):
            base, power = _value(node.left, names), _value(node.right, names)
            return math.pow(base, power) if isinstance(base, float) or isinstance(power, float) or abs(power) > 64 else base**power
        case ast.BinOp() if type(node.op) in OPERATORS:
            left, right = _value(node.left, names), _value(node.right, names)
            if not all(isinstance(side, int | float) for side in (left, right)):
                raise UnknownError
            return OPERATORS[type(node.op)](left, right)
        case ast.Compare(ops=[op], comparators=[other]) if type(op) in OPERATORS:
            return OPERATORS[type(op)](_value(node.left, names), _value(other, names))
        case ast.Subscript():
            return _value(node.value, names)[_value(node.slice, names)]
        case ast.Call(keywords=[]) if name_of(node) in FUNCTIONS:
            return FUNCTIONS[name_of(node)](*(_value(argument, names) for argument in node.args))
        case ast.Call(args=[items], keywords=[]) if name_of(node) in ("array", "asarray"):
            return _value(items, names)
    raise UnknownError


def name_of(call: ast.Call) -> str:
    """Name of the function that is called, without the module before it."""
    match call.func:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
    return ""
