"""The surface that a net is laid on, met along circles and vertical lines: kernels on a gridded distance field.

The surface lies `offset` over the tool and the platform it stands on. With a = d - offset, b = z - offset, d the
tool's signed distance and z the height over the platform [mm], it is where min(a, b) = 0, but along the tool's foot
(a < r, b < r) where r - sqrt((r - a)^2 + (r - b)^2) = 0: a hollow of radius r where the foot is at right angles.
A net's chords would cut a sharp foot short by up to half a spacing, by chance of where its nodes fall.
field = (values, origin, spacing, offset, r).
"""

from __future__ import annotations

from math import cos, nan, pi, sin, sqrt

from numba import njit

from ddf.contact.field import sample

SCAN = pi / 60.0  # between two looks along a circle [rad]
REACH = 0.5 * pi  # how far from the direction of least bending a circle is followed [rad]
FINE = 1.0e-10  # mm
FALL = 0.5  # between two looks down a vertical line, in grid spacings


@njit(cache=True)
def clearance(field, x, y, z):
    """Height over the surface [mm] of a point near it; negative below."""
    values, origin, spacing, offset, r = field
    d, _, _, _ = sample(values, origin, spacing, x, y, z)
    a, b = d - offset, z - offset
    if a < r and b < r:
        return r - sqrt((r - a) ** 2 + (r - b) ** 2)
    return min(a, b)


@njit(cache=True)
def normal(field, p):
    """Unit normal of the surface at a point p of it."""
    values, origin, spacing, offset, r = field
    d, nx, ny, nz = sample(values, origin, spacing, p[0], p[1], p[2])
    a, b = d - offset, p[2] - offset
    if a < r and b < r:
        return unit((r - a) * nx, (r - a) * ny, (r - a) * nz + r - b)
    if b < a:
        return 0.0, 0.0, 1.0
    return nx, ny, nz


@njit(cache=True)
def meet_circle(field, centre, e, f, radius):
    """Angle [rad] nearest to 0 at which c + r (e cos t + f sin t) is on the surface; NaN if none in +-REACH."""
    first = _around(field, centre, e, f, radius, 0.0)
    last = (first, first)
    for k in range(1, int(REACH / SCAN) + 1):
        ahead = _around(field, centre, e, f, radius, k * SCAN)
        behind = _around(field, centre, e, f, radius, -k * SCAN)
        if (ahead > 0.0) != (last[0] > 0.0):
            return _narrow(field, centre, e, f, radius, (k - 1) * SCAN, k * SCAN, last[0], ahead)
        if (behind > 0.0) != (last[1] > 0.0):
            return _narrow(field, centre, e, f, radius, -(k - 1) * SCAN, -k * SCAN, last[1], behind)
        last = (ahead, behind)
    return nan


@njit(cache=True)
def meet_vertical(field, x, y):
    """Height z [mm] of the highest point of the surface over (x, y)."""
    _, origin, spacing, offset, _ = field
    step = FALL * spacing
    high = origin[2] + spacing * field[0].shape[2] + step
    low = high - step
    while low > offset and clearance(field, x, y, low) > 0.0:
        high, low = low, low - step
    low = max(low, offset)
    while high - low > FINE:
        middle = 0.5 * (high + low)
        if clearance(field, x, y, middle) > 0.0:
            high = middle
        else:
            low = middle
    return 0.5 * (high + low)


@njit(cache=True)
def _around(field, centre, e, f, radius, t):
    c, s = radius * cos(t), radius * sin(t)
    return clearance(
        field, centre[0] + c * e[0] + s * f[0], centre[1] + c * e[1] + s * f[1], centre[2] + c * e[2] + s * f[2]
    )


@njit(cache=True)
def _narrow(field, centre, e, f, radius, a, b, at_a, at_b):
    """The root between angles a and b of opposite sign: false position, the end that stays halved (Illinois)."""
    for _ in range(60):
        t = b - at_b * (b - a) / (at_b - at_a)
        value = _around(field, centre, e, f, radius, t)
        if abs(value) < FINE:
            return t
        if (value > 0.0) != (at_b > 0.0):
            a, at_a = b, at_b
        else:
            at_a *= 0.5
        b, at_b = t, value
    return b


@njit(cache=True)
def unit(x, y, z):
    """The vector at length 1; zero stays zero."""
    size = sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return 0.0, 0.0, 0.0
    return x / size, y / size, z / size


@njit(cache=True)
def cross(a, b):
    """The vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def dot(a, b):
    """The scalar product a.b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
