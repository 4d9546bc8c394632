"""Functions in the language of the kernel, one per construct; test_translate runs them in both ways.

Each takes two floats, an int of at least 1 and a record, and returns a float.
"""

import math

RECORD = ("first", "second", ("row", 4), ("inner", ("left", "right")), ("several", ("left", "right"), 3))
FACTOR = 2.5
NEGATIVE = -0.75
COUNT = 3
TABLE = (0.1, 0.25, 1e-3, 7.0)
PLACES = (3, 0, 2)


def arithmetic(a, b, n, x):
    """Operators with their precedence, also with an int."""
    return (a + b) * (a - b) / (1.0 + b * b) - -a * n + a - (b - 1.0) - b / (a / 3.0) / 2.0


def integer_division(a, b, n, x):
    """`/` of two ints is a float; `//` and `%` round down, also of negative ints."""
    negative = -7 * n
    return n / 2 + negative // 3 + 10 * (negative % 3) + 100 * (7 // n)


def modulo(a, b, n, x):
    """`%` of floats has the sign of the divisor, also where the remainder is 0."""
    return a % b + 10.0 * (-a % b) + 100.0 * (a % -b) + math.copysign(1.0, 0.0 % -b)


def power(a, b, n, x):
    """A power that does not become a product."""
    return math.pow(abs(a), b / 3.0)


def bit_and(a, b, n, x):
    """Bits of two ints."""
    return 1.0 * (13 & (n + 8)) + (n & 1)


def comparisons(a, b, n, x):
    """All comparisons, alone and in a chain."""
    count = 0
    count += a < b
    count += a <= b
    count += 2 * (a > b)
    count += 4 * (a >= b)
    count += 8 * (a == b) + 16 * (a != b)
    if 0.0 <= a < b <= 10.0 * n:
        count += 32
    return count


def truth(a, b, n, x):
    """`and`, `or` and `not` with their precedence."""
    both = (a > 0.0 and b > 0.0) or n == 2
    neither = not (a > 0.0 or b > 0.0)
    return 1.0 if both and not neither else -1.0


def conditional(a, b, n, x):
    """Conditional expressions, nested and of records."""
    record = x.inner if a > b else x.several[0]
    record.left += 1.0
    return (a if a > b else b if n > 2 else -a) + record.left


def builtins(a, b, n, x):
    """Functions of Python: `max` and `min` return the first of equal arguments, also of 0.0 and -0.0."""
    signs = math.copysign(1.0, max(0.0, -0.0)) + 10.0 * math.copysign(1.0, min(-0.0, 0.0))
    large = max(a, b, 0.5) + min(n, 2) + min(a, float(n))
    return signs + large + abs(a) + int(a) + int(-abs(b)) + len(TABLE) + len(x.row) + len(x.numbers)


def mathematics(a, b, n, x):
    """Functions of `math`, and its infinity."""
    result = math.sqrt(abs(a)) + math.sin(a) + math.cos(b) + math.exp(-abs(a)) + math.expm1(b / 9.0)
    result += math.atan2(a, b) + math.floor(a) + math.ceil(b) + math.copysign(a, b) + math.log1p(abs(b))
    return result if math.isfinite(result) and result < math.inf else -1.0


def constants(a, b, n, x):
    """Constants and tables of the module."""
    return FACTOR * a + NEGATIVE * b + COUNT * TABLE[PLACES[n % COUNT]]


def records(a, b, n, x):
    """Fields, arrays, inner records and all numbers of a record."""
    x.first = a
    x.row[n % 4] += b
    x.inner.right = x.first - 1.0
    x.several[n % 3] = x.inner
    row = x.row
    row[0] -= 2.0
    last = x.several[n % 3]
    last.left *= 2.0
    return x.numbers[n] + x.numbers[len(x.numbers) - 1]


def branches(a, b, n, x):
    """`if`, `elif` and `else`."""
    if a > b:
        result = 1.0
    elif a == b:
        result = 2.0
    elif n > 2:
        if b > 0.0:
            result = 3.0
        else:
            result = 4.0
    else:
        result = 5.0
    return result


def loops(a, b, n, x):
    """`for` with one, two and three bounds, `while`, `break` and `continue`."""
    total = 0.0
    for i in range(n):
        total += i * a
    for i in range(1, n + 2):
        if i == 2:
            continue
        total -= i
    for _ in range(0, 9, 4):
        total += 1.0
    while total > -50.0:
        total -= 7.0
        if total < b:
            break
    return total


def loop_variable(a, b, n, x):
    """A loop variable keeps its value after the loop; a change within the loop lasts for one turn."""
    i = -1
    for i in range(n + 3):
        if i * a > 4.0:
            break
    total = 1.0 * i
    for k in range(3):
        total += k
        k += 10
        total += k
    return total


def loop_bound(a, b, n, x):
    """The bound of a loop is evaluated once."""
    x.first = n
    count = n
    total = 0.0
    for i in range(count):
        count += 1
        total += i
    for i in range(int(x.first)):
        x.first = 100.0
        total += i
    return total + count


def mixed_types(a, b, n, x):
    """A variable that holds an int first and a float later is a float."""
    total = 0
    for i in range(n):
        total = total + i * a
    both = 1
    if a > b:
        both = 0.5
    return total + both


def pair(a, b):
    """Return two numbers."""
    if a > b:
        return a, 1.0
    return b, 0.5


def tuples(a, b, n, x):
    """Several results and several assignments in a statement."""
    larger, share = pair(a, b)
    first, (_) = larger, share
    x.first, x.row[1] = pair(b, a)
    low = high = x.second = first
    return low + high + share + pair(a, 2.0)[1]


def increase(record, step):
    """Write to a record; return nothing."""
    record.left += step
    if step > 1.0:
        return
    record.right += 1.0


def total_of(numbers):
    """Sum of an array of any length."""
    total = 0.0
    for n in range(len(numbers)):
        total += numbers[n]
    return total


def calls(a, b, n, x):
    """Calls with records, arrays and tables; of one function with several types."""
    increase(x.inner, a)
    increase(x.several[1], b)
    first = total_of(x.row)
    return first + total_of(x.numbers) + total_of(TABLE) + x.inner.left + x.several[1].right


def reserved(a, b, n, x):
    """Names of variables that mean something else in C."""
    double, switch, exp = a, b, 1.0
    for register in range(n):
        exp += math.exp(0.1 * register)
    return double + switch + exp


FUNCTIONS = [
    *(arithmetic, integer_division, modulo, power, bit_and, comparisons, truth, conditional, builtins),
    *(mathematics, constants, records, branches, loops, loop_variable, loop_bound, mixed_types, tuples),
    *(calls, reserved),
]
