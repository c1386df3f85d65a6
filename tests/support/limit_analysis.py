"""Limit analysis of plane masonry: the largest multiplier of a load for which forces in all joints are in equilibrium.

Blocks are rigid; a joint bears no pull, presses at its two ends, and slides along at a friction coefficient [Heyman1966].
The static theorem makes it a linear programme, solved by a simplex tableau with Bland's rule."""


def largest(objective, equations, values):
    """Largest objective . x with equations x = values, x >= 0; None where no x fits. Dense, for some hundred unknowns."""
    rows, n = len(equations), len(objective)
    table = []
    for i, (row, value) in enumerate(zip(equations, values, strict=True)):
        sign = -1.0 if value < 0 else 1.0
        table.append([sign * x for x in row] + [float(i == j) for j in range(rows)] + [sign * value])
    basis = list(range(n, n + rows))
    artificial = [0.0] * n + [-1.0] * rows
    pivot_until_best(table, basis, artificial, n + rows)
    scale = max(abs(value) for value in values)
    if sum(row[-1] for row, place in zip(table, basis, strict=True) if place >= n) > 1e-9 * scale:
        return None
    pivot_until_best(table, basis, list(objective) + [0.0] * rows, n)
    return sum(objective[place] * row[-1] for row, place in zip(table, basis, strict=True) if place < n)


def pivot_until_best(table, basis, cost, n):
    """Pivot until no column of the first n improves the cost."""
    while True:
        enters = None
        for j in range(n):
            if j not in basis and cost[j] - sum(cost[b] * row[j] for b, row in zip(basis, table, strict=True)) > 1e-9:
                enters = j
                break
        if enters is None:
            return
        ratios = [(row[-1] / row[enters], basis[i], i) for i, row in enumerate(table) if row[enters] > 1e-9]
        if not ratios:
            raise ValueError("the load has no bound")
        leaves = min(ratios)[2]
        pivot = table[leaves][enters]
        table[leaves] = [x / pivot for x in table[leaves]]
        for i, row in enumerate(table):
            if i != leaves and row[enters] != 0:
                table[i] = [x - row[enters] * y for x, y in zip(row, table[leaves], strict=True)]
        basis[leaves] = enters


def centre_and_area(polygon):
    """Centre and area of a polygon."""
    area = x = y = 0.0
    for (x1, y1), (x2, y2) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        cross = x1 * y2 - x2 * y1
        area, x, y = area + cross / 2, x + (x1 + x2) * cross / 6, y + (y1 + y2) * cross / 6
    return (x / area, y / area), abs(area)


def load_multiplier(blocks, joints, friction, dead=(0.0, -1.0), live=(1.0, 0.0)):
    """Largest multiplier of the live acceleration on top of the dead one.

    `blocks` are polygons; `joints` are (candidate, antagonist, end, end, normal): the normal points into the candidate, and the
    number of a block that is fixed is None. Loads are accelerations, of blocks of density 1."""
    n = 5 * len(joints) + 1
    equations = [[0.0] * n for _ in range(3 * len(blocks) + len(joints))]
    values = [0.0] * len(equations)
    for b, polygon in enumerate(blocks):
        (x, y), mass = centre_and_area(polygon)
        for row, load in ((3 * b, 0), (3 * b + 1, 1)):
            equations[row][-1], values[row] = mass * live[load], -mass * dead[load]
        equations[3 * b + 2][-1] = mass * (x * live[1] - y * live[0])
        values[3 * b + 2] = -mass * (x * dead[1] - y * dead[0])
    for k, (candidate, antagonist, first, second, (nx, ny)) in enumerate(joints):
        forces = ((first, nx, ny), (second, nx, ny), (first, -ny, nx), (first, ny, -nx))
        for b, sign in ((candidate, 1.0), (antagonist, -1.0)):
            if b is None:
                continue
            for c, ((x, y), fx, fy) in enumerate(forces):
                for row, part in ((3 * b, fx), (3 * b + 1, fy), (3 * b + 2, x * fy - y * fx)):
                    equations[row][5 * k + c] += sign * part
        # Slide: friction (n1 + n2) - t+ - t- - slack = 0
        equations[3 * len(blocks) + k][5 * k:5 * k + 5] = [friction, friction, -1.0, -1.0, -1.0]
    return largest([0.0] * (n - 1) + [1.0], equations, values)
