"""Telegraph noise X = +-1 at rate kappa, mu_s = 1, mu_d = 1/2, bias 0.3: closed forms for any drag b on v > 0."""

import numpy

P, Q = 0.8, 1.2  # the net force on v > 0 is p + b(v) or b(v) - q
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(200)


def along(b, y):
    """v = v* (1 - exp(-y)) and dv/dy, v* the terminal velocity, where p + b = 0: smooth in y."""
    low, high = 0, 2 * P
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if P + b(middle) > 0 else (low, middle)
    return low * -numpy.expm1(-y), low * numpy.exp(-y), low


def densities(kappa, b, v):
    """f+ and f- on v > 0 per unit of P_stick: (p + b) f+ = (q - b) f- = F, F(0) = kappa P_stick and
    F'/F = kappa (1/(q - b) - 1/(p + b))."""
    y = -numpy.log1p(-v / along(b, 0)[2])
    between, slope, _ = along(b, y[:, None] * (NODES + 1) / 2)
    rate = slope * kappa * (1 / (Q - b(between)) - 1 / (P + b(between)))
    flow = kappa * numpy.exp(y / 2 * (rate @ WEIGHTS))
    return flow / (P + b(v)), flow / (Q - b(v))


def integrals(kappa, b):
    """P_stick and E_V by quadrature of the densities."""
    v, slope, _ = along(b, 13 * (NODES + 1))
    f = 13 * WEIGHTS * slope * sum(densities(kappa, b, v))
    return {"P_stick": 1 / (1 + f.sum()), "E_V": f @ v / (1 + f.sum())}
