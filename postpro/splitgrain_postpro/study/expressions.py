"""Closed forms in study files: arithmetic of numbers, constants and the time t, and nothing else.

All numbers are floats, so that each operation takes the same short time whatever its operands: 9**9**9**9 overflows at once.
"""

import ast
import math
import operator

FUNCTIONS = {name: getattr(math, name) for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "atan", "floor", "ceil")}
FUNCTIONS |= {"abs": abs, "min": min, "max": max}
OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
    ast.Mod: operator.mod, ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip
LONGEST = 2000
"""Characters of an expression at most: its parse takes time and memory"""


def evaluate(text: str | float, names: dict[str, float]) -> float:
    """The value of an expression with these names; ValueError has what is wrong with it."""
    if len(str(text)) > LONGEST:
        raise ValueError(f"an expression has {LONGEST} characters at most, not {len(str(text))}")
    try:
        return float(_value(ast.parse(str(text).strip(), mode="eval").body, {"pi": math.pi} | names))
    except SyntaxError as error:
        raise ValueError(f"'{text}' is no expression") from error
    except (ArithmeticError, TypeError, RecursionError, MemoryError) as error:
        raise ValueError(f"'{text}' has no value: {error}") from error


def _value(node, names):
    """The value of a part of an expression."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return float(node.value)
    if isinstance(node, ast.Name):
        if node.id not in names:
            raise ValueError(f"'{node.id}' is unknown; there are {', '.join(sorted(names))}")
        return float(names[node.id])
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](_value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](_value(node.operand, names))
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in OPERATORS:
        return OPERATORS[type(node.ops[0])](_value(node.left, names), _value(node.comparators[0], names))
    if isinstance(node, ast.IfExp):
        return _value(node.body if _value(node.test, names) else node.orelse, names)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in FUNCTIONS:
            raise ValueError(f"there is no function {node.func.id}; there are {', '.join(sorted(FUNCTIONS))}")
        return FUNCTIONS[node.func.id](*(_value(argument, names) for argument in node.args))
    raise ValueError(f"'{ast.unparse(node)}' is not allowed: numbers, names, + - * / ** %, comparisons, if/else, functions")
