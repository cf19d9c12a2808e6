"""The scenes of make bench-peers, and their true motion in 60 digits."""
import cmath
import math
import subprocess

import mpmath as mp
import numpy as np

STEP = 2*math.pi/3600
mp.mp.dps = 60


class Scene:
    """A crank and the joints that follow from it one by one. A joint is a tuple: name, kind, and
    meet: p, s, r1, r2     at the distances r1, r2 from p and s, to the left of the way from p to s
    fixed: p, s, c         in axes with the origin p, whose first points to s, at c
    slide: p, r, y         on the line at the height y, at the distance r from p, to the right of it
    where p and s are names or places in the ground."""

    def __init__(self, title, deck, points, crank, joints, estimate, bench, rate=mp.pi/6, start=0, steps=3600):
        """deck: the cards of its set; points: the joints' names there; crank: pivot and radius; estimate: places of
        joints; bench: the scene's arguments of tests/bench/bench.f90; rate, start: of the crank's angle, in rad."""
        self.title, self.deck, self.points = title, deck, points
        self.pivot, self.radius = crank
        self.joints, self.estimate, self.bench = joints, estimate, bench
        self.names = ['A'] + [j[0] for j in joints]
        self.unknown = [j[0] for j in joints if j[1] != 'fixed']
        self.exact_rate, self.rate, self.start, self.steps = rate, float(rate), start, steps

    def angles(self, n):
        """Of the crank, at the first n steps."""
        return float(self.start) + STEP*np.arange(n)


def place(z, p):
    """The place of a joint of z, or in the ground."""
    return z[p] if isinstance(p, str) else mp.mpc(p)


def closed_form(scene, phi):
    """The places of the joints at the crank's angle phi, in 60 digits."""
    z = {'A': mp.mpc(scene.pivot) + scene.radius*mp.expj(phi)}
    for name, kind, p, *rest in scene.joints:
        if kind == 'slide':
            r, y = rest
            z[name] = mp.mpc(z[p].real + mp.sqrt(r**2 - (y - z[p].imag)**2), y)
            continue
        p, s = place(z, p), place(z, rest[0])
        d = abs(s - p)
        if kind == 'meet':
            r1, r2 = (mp.mpf(r) for r in rest[1:])
            u = (d**2 + r1**2 - r2**2)/(2*d)
            z[name] = p + (s - p)/d*mp.mpc(u, mp.sqrt(r1**2 - u**2))
        else:
            z[name] = p + (s - p)/d*mp.mpc(rest[1])
    return [z[name] for name in scene.names]


def exact(scene):
    """Position, velocity, acceleration (steps, joints): rates by central differences of error 1E-29."""
    h = mp.mpf(10)**-15
    rows = []
    for k in range(scene.steps):
        phi = scene.start + k*mp.pi/1800
        low, mid, high = (closed_form(scene, phi + d) for d in (-h, 0, h))
        rows.append([[complex(b), complex((c - a)/(2*h)*scene.exact_rate),
                      complex((c - 2*b + a)/h**2*scene.exact_rate**2)] for a, b, c in zip(low, mid, high)])
    return np.moveaxis(np.array(rows), 2, 0)


def cards_of(text):
    """The first set of a deck."""
    lines = [line for line in text.splitlines() if not line.startswith('$')]
    return lines[:next(i for i, line in enumerate(lines) if line.startswith('END')) + 1]


def four_bar():
    with open('input/four_bar.deck') as file:
        deck = cards_of(file.read())
    joints = [('B', 'meet', 'A', 4, 3.5, 3), ('C', 'fixed', 'A', 'B', 1.75 + 1.25j)]
    return Scene('four-bar', deck, ['A-CR', 'B-CO', 'C'], (0j, 1), joints,
                 {'B': 1 + cmath.rect(3.5, math.radians(55))}, ['four_bar'])


def four_bar_out_of_reach():
    """Crank 3 from 120 deg on: the rocker's end is out of reach from 135.95 deg on, after 160 steps."""
    s = four_bar()
    s.title, s.radius, s.start, s.steps = 'out of reach', 3, 2*mp.pi/3, 300
    s.estimate = {'B': complex(closed_form(s, s.start)[1])}
    a = cmath.rect(3, 2*math.pi/3)
    estimate = {'CRANK': (0j, 120.0), 'COUPLER': (a, math.degrees(cmath.phase(s.estimate['B'] - a))),
                'ROCKER': (4 + 0j, math.degrees(cmath.phase(s.estimate['B'] - 4)))}
    for i, line in enumerate(s.deck):
        if line.startswith('LINK'):
            z, turned = estimate[line.split()[1]]
            s.deck[i] = '%-32s%-16.6f%-16.6f%.6f' % (line[:32], z.real, z.imag, turned)
        elif line.startswith('POINT   A-CR'):
            s.deck[i] = line.replace('1.0', '3.0', 1)
        elif line.startswith('DRIVE'):
            s.deck[i] = '%-32s%-16s%s' % (line[:32], '120.0', '30.0')
    return s


def yoke():
    with open('input/yoke.deck') as file:
        deck = cards_of(file.read())
    # The block is at the pin A; the lever from 0 passes through it.
    joints = [('TIP', 'fixed', 0j, 'A', 4 + 0j), ('RAM', 'slide', 'TIP', 2, 5)]
    return Scene('yoke', deck, ['PIN', 'TIP', 'R'], (2j, 1), joints, {'RAM': 3.2 + 5j}, ['yoke'])


def windows(n, directory):
    """The chain of tests/make_deck for a tenth of a turn; its deck is left in the directory."""
    text = subprocess.run(['tests/make_deck', 'windows', str(n)], capture_output=True, text=True, check=True).stdout
    with open('%s/windows_%d.deck' % (directory, n), 'w') as file:
        file.write(text)
    names = ['A'] + ['T%d' % k for k in range(1, n + 1)]
    joints = [(names[k], 'meet', names[k - 1], k, 1, 1) for k in range(1, n + 1)]
    return Scene('%d windows' % n, cards_of(text), ['B%d' % (k + 1) for k in range(n + 1)], (0j, 1), joints,
                 {names[k]: k + cmath.rect(1, 1) for k in range(1, n + 1)}, ['windows', str(n), directory],
                 mp.mpf(1), 1, 360)
