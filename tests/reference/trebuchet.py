#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The numbers of scenes/verify/J11_trebuchet.lua: Lagrange's equations of a beam with a counterweight and a taut sling, by
Taylor series of 30 digits (mpmath), then a parabola. Prints place and velocity at the release, time and range of the impact,
the least tension of the sling and the share of the energy that the integration has lost."""
from mpmath import cos, mp, mpf, odefun, pi, sin, sqrt

mp.dps = 30
g, height = mpf("9.81"), mpf(4)
long_arm, sling = mpf(4), mpf(3)                  # m
beam, center = mpf(20), mpf(1)                    # kg; m from the pivot, on the long arm
inertia_beam = mpf(60)                            # kg m^2 about its centre
weight, short_arm = mpf(900), mpf(1)              # kg, m
inertia_weight = mpf(40)                          # kg m^2 about its centre: it is fixed to the beam
ball = mpf(10)                                    # kg
release = mpf("0.625")                            # s
J = inertia_beam + beam * center**2 + inertia_weight + weight * short_arm**2
S = beam * center - weight * short_arm


def accelerations(a, b, v, w):
    """Of the beam's angle a and of the sling's b, with rates v and w."""
    m11, m12, m22 = J + ball * long_arm**2, ball * long_arm * sling * cos(a - b), ball * sling**2
    r1 = -ball * long_arm * sling * sin(a - b) * w**2 - (S + ball * long_arm) * g * cos(a)
    r2 = ball * long_arm * sling * sin(a - b) * v**2 - ball * g * sling * cos(b)
    d = m11 * m22 - m12**2
    return (m22 * r1 - m12 * r2) / d, (m11 * r2 - m12 * r1) / d


def place(a, b):
    return long_arm * cos(a) + sling * cos(b), height + long_arm * sin(a) + sling * sin(b)


def velocity(a, b, v, w):
    return -long_arm * sin(a) * v - sling * sin(b) * w, long_arm * cos(a) * v + sling * cos(b) * w


def energy(a, b, v, w):
    x, z = velocity(a, b, v, w)
    return J * v**2 / 2 + S * g * sin(a) + ball * (x**2 + z**2) / 2 + ball * g * place(a, b)[1]


def tension(a, b, v, w):
    """Along the sling, on the ball: m (acceleration of the ball + g) along its direction, towards the tip."""
    p, _ = accelerations(a, b, v, w)
    # of the tip, along the sling, and of the circle about it
    tip = (-long_arm * sin(a) * p - long_arm * cos(a) * v**2, long_arm * cos(a) * p - long_arm * sin(a) * v**2)
    along = tip[0] * cos(b) + (tip[1] + g) * sin(b)
    return ball * (sling * w**2 - along)


start = [-pi / 4, pi, mpf(0), mpf(0)]
flow = odefun(lambda t, y: [y[2], y[3], *accelerations(*y)], 0, start)
least = min(tension(*flow(release * k / 20)) for k in range(21))
end = flow(release)
x, z = place(*end[:2])
u, w = velocity(*end)
fall = (w + sqrt(w**2 + 2 * g * z)) / g
print("place at release", mp.nstr(x, 20), mp.nstr(z, 20))
print("velocity", mp.nstr(u, 20), mp.nstr(w, 20))
print("lands at", mp.nstr(release + fall, 20), "s, range", mp.nstr(x + u * fall, 20), "m")
print("least tension", mp.nstr(least, 6), "N; energy lost, of what fell",
      mp.nstr((energy(*end) - energy(*start)) / (weight * g), 3))
print("angles", [mp.nstr(q, 8) for q in end])
