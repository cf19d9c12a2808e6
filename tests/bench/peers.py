"""make bench-peers: time and true error of other programs that solve planar kinematics, beside this one.

    peers.py BUILD      prints the rows of docs/evidence.md; exit status 1 if an error exceeds its bound

All run in turn within each repeat, and the least of three times counts. Each starts from the initial estimate of the
deck and gives position, velocity and acceleration of the same joints at steps of 0.1 deg. tests/bench/peers.sh calls it.
"""
import cmath
import csv
import math
import os
import shutil
import statistics
import subprocess
import sys
import time
import warnings

BUILD = sys.argv[1]
WORK = BUILD + '/peers/work'
shutil.rmtree(WORK, ignore_errors=True)
os.makedirs(WORK)
os.environ.update(MPLBACKEND='Agg', NUMBA_CACHE_DIR=WORK)    # numba compiles anew in each run
import casadi as ca
import kimech
import mechanism as vectors
import numpy as np
from pylinkage.actuators import Crank
from pylinkage.components import Ground
from pylinkage.dyads import FixedDyad, RRPDyad, RRRDyad
from pylinkage.simulation import Linkage
from peers_scenes import STEP, exact, four_bar, four_bar_out_of_reach, windows, yoke

REPEATS = int(os.environ.get('REPEATS', 7))
SLOW = 0.2          # s: a slower peer is timed over fewer steps in all repeats but the first


# Each peer: a function of the scene that makes ready and returns turn(n), which returns the seconds of n steps and
# position, velocity, acceleration (steps, joints) as complex numbers.

def kinmat(scene):
    """This program: the results of the whole command; the time of a step is measured by tests/bench/bench.f90."""
    def turn(n):
        deck, table = WORK + '/peer.deck', WORK + '/peer.csv'
        with open(deck, 'w') as file:
            for line in scene.deck:
                if line.startswith('TIME'):
                    line = 'TIME    %d\n*       %-24s%.16E' % (n, '0.0', n*STEP/scene.rate)
                if line.startswith('END'):
                    file.writelines('PRINT   POINTS  %s\n' % p for p in scene.points)
                if not line.startswith(('AT', 'PRINT')):
                    file.write(line + '\n')
        status = subprocess.run([BUILD + '/kinmat', '--quiet', '--no-listing', '--csv', table, deck]).returncode
        if status not in (0, 2):    # 2: an instant is flagged
            raise RuntimeError('kinmat ends with status %d' % status)
        number = lambda text: float(text or 'nan')
        with open(table) as file:
            rows = [r for r in csv.DictReader(file) if r['kind'] == 'POINT']
        of = lambda x, y: np.array([complex(number(r[x]), number(r[y])) for r in rows]).reshape(n + 1, -1)[:n]
        return 0.0, of('x', 'y'), of('vx', 'vy'), of('ax', 'ay')
    return turn


def pylinkage_linkage(scene):
    """The linkage of pylinkage, its crank one step before the start."""
    crank = Crank(Ground(scene.pivot.real, scene.pivot.imag), scene.radius, angular_velocity=scene.rate,
                  initial_angle=float(scene.start) - STEP)
    part, grounds = {'A': crank}, [crank.anchor]

    def of(p):
        if isinstance(p, str):
            return part[p]
        grounds.append(Ground(complex(p).real, complex(p).imag))
        return grounds[-1]

    for name, kind, p, *rest in scene.joints:
        e = scene.estimate.get(name, 0j)
        if kind == 'meet':
            part[name] = RRRDyad(of(p), of(rest[0]), rest[1], rest[2], x=e.real, y=e.imag)
        elif kind == 'fixed':
            part[name] = FixedDyad(of(p), of(rest[0]), abs(rest[1]), cmath.phase(rest[1]))
        else:
            part[name] = RRPDyad(of(p), of(rest[1]*1j), of(1 + rest[1]*1j), rest[0], x=e.real, y=e.imag)
    linkage = Linkage(grounds + list(part.values()))
    linkage.set_input_velocity(crank, scene.rate)
    linkage.compile()
    return linkage, len(grounds)


def pylinkage_compiled(scene):
    """Its loop over all steps, compiled by numba."""
    def turn(n):
        linkage, first = pylinkage_linkage(scene)
        begun = time.perf_counter()
        found = linkage.step_fast_with_kinematics(n, STEP/scene.rate)
        seconds = time.perf_counter() - begun
        return (seconds, *(q[:, first:, 0] + 1j*q[:, first:, 1] for q in found))
    turn(2)
    return turn


def pylinkage_python(scene):
    """Its loop step by step in Python."""
    def turn(n):
        linkage, first = pylinkage_linkage(scene)
        begun = time.perf_counter()
        found = list(linkage.step_with_derivatives(n, STEP/scene.rate))
        seconds = time.perf_counter() - begun
        q = np.array([[row[first:] for row in step] for step in found], dtype=float)
        return (seconds, *np.moveaxis(q[..., 0] + 1j*q[..., 1], 1, 0))
    turn(2)
    return turn


def casadi_step(scene, method):
    """Newton's method joint by joint from the step before, rates by derivatives: (before, phi) to (unknown, p, v, a).
    Of joint and rates: x, v; of those that it follows from: q, qd, qdd; equations: g."""
    two = lambda z: ca.vertcat(complex(z).real, complex(z).imag)
    before, phi = ca.MX.sym('before', 2*len(scene.unknown)), ca.MX.sym('phi')
    e = ca.vertcat(ca.cos(phi), ca.sin(phi))*scene.radius
    z = {'A': (two(scene.pivot) + e, scene.rate*ca.vertcat(-e[1], e[0]), -scene.rate**2*e)}
    x, v = ca.SX.sym('x', 2), ca.SX.sym('v', 2)
    q, qd, qdd = (ca.SX.sym(name, 4) for name in ('q', 'qd', 'qdd'))    # of p and s
    for name, kind, p, *rest in scene.joints:
        s = 0 if kind == 'slide' else rest[0]
        given = [ca.vertcat(a, b) for a, b in
                 zip(*(z[i] if isinstance(i, str) else (two(i), ca.DM.zeros(2), ca.DM.zeros(2)) for i in (p, s)))]
        rate = lambda f: ca.jtimes(f, q, qd) + ca.jtimes(f, qd, qdd)
        if kind == 'fixed':
            d = q[2:] - q[:2]
            f = q[:2] + ca.mtimes(ca.horzcat(d, ca.vertcat(-d[1], d[0])), two(rest[1]))/ca.norm_2(d)
            z[name] = ca.Function('f', [q, qd, qdd], [f, rate(f), rate(rate(f))])(*given)
            continue
        square = lambda d, r: ca.dot(d, d) - r**2
        if kind == 'meet':
            g = ca.vertcat(square(x - q[:2], rest[1]), square(x - q[2:], rest[2]))
        else:
            g = ca.vertcat(square(x - q[:2], rest[0]), x[1] - rest[1])
        root = ca.rootfinder('root', method, {'x': x, 'p': q, 'g': g}, {'abstol': 1e-14})
        jacobian, drift = ca.jacobian(g, x), ca.jtimes(g, q, qd)
        first = ca.Function('first', [x, q, qd], [ca.solve(jacobian, -drift)])
        drift = ca.mtimes(jacobian, v) + drift
        drift = ca.jtimes(drift, x, v) + rate(drift)
        second = ca.Function('second', [x, v, q, qd, qdd], [ca.solve(jacobian, -drift)])
        i = 2*scene.unknown.index(name)
        at = root(before[i:i + 2], given[0])
        moving = first(at, *given[:2])
        z[name] = (at, moving, second(at, moving, *given))
    every = [ca.vertcat(*(z[name][k] for name in scene.names)) for k in range(3)]
    return ca.Function('step', [before, phi], [ca.vertcat(*(z[name][0] for name in scene.unknown)), *every])


def casadi_peer(scene, method, finish):
    """finish(f): what makes the function of all steps ready."""
    step, made = casadi_step(scene, method), {}
    begin = np.array([[scene.estimate[name].real, scene.estimate[name].imag] for name in scene.unknown]).ravel()

    def turn(n):
        if n not in made:
            made[n] = finish(step.mapaccum('turn_%s_%d' % (''.join(filter(str.isalnum, scene.title)), n), n))
        angles = ca.DM(scene.angles(n)).T
        begun = time.perf_counter()
        found = made[n](begin, angles)[1:]
        seconds = time.perf_counter() - begun
        return (seconds, *(q[0::2].T + 1j*q[1::2].T for q in map(np.array, found)))
    turn(scene.steps)
    return turn


def casadi_compiled(scene):
    """C of the whole turn, compiled with -O2."""
    def finish(f):
        f.generate(f.name() + '.c', {'with_header': False})
        os.replace(f.name() + '.c', WORK + '/' + f.name() + '.c')
        library = os.path.abspath(WORK + '/' + f.name() + '.so')
        subprocess.run(['cc', '-O2', '-fPIC', '-shared', '-o', library, f.name() + '.c', '-lm'], cwd=WORK, check=True)
        return ca.external(f.name(), library)
    return casadi_peer(scene, 'fast_newton', finish)


def casadi_interpreted(scene):
    return casadi_peer(scene, 'newton', lambda f: f)


def kimech_peer(scene):
    """The model as the deck has it: its links, points, pairs and estimates."""
    cards = [(line[:8].strip(), line[8:16].strip(), line[16:24].strip(), [float(x) for x in line[32:].split()])
             for line in scene.deck if line.startswith(('GROUND', 'LINK', 'POINT', 'REVOLUTE', 'PRISM'))]
    angle = math.pi/180 if any(line.startswith('UNITS') and 'DEG' in line for line in scene.deck) else 1.0
    m = kimech.Mechanism()
    body, point, guess, driven = {}, {}, {}, None
    for card, a, b, x in cards:
        if card == 'GROUND':
            body[a] = m.ground
        elif card == 'LINK':
            body[a] = m.add_link(a)
            guess[body[a]] = (x[0], x[1], angle*x[2])
        elif card == 'POINT':
            point[a] = body[b].add_point(a, (x + [0.0, 0.0])[:2])
        elif card == 'REVOLUTE':
            joint = m.revolute(point[a], point[b])
            driven = driven or joint
        elif card == 'PRISM':
            guide = point[a].body.add_point(a + '-GUIDE', point[a].local + np.array([0.0, -x[1]]))
            m.prismatic(guide, point[b], axis_a=(1.0, 0.0), axis_b=(1.0, 0.0))

    def turn(n):
        driver = kimech.KinematicDriver(driven, position=scene.angles(n), velocity=scene.rate, acceleration=0.0)
        begun = time.perf_counter()
        found = kimech.solve(m, drivers=driver, initial_guess=guess)
        seconds = time.perf_counter() - begun
        of = lambda f: np.array([f(point[p])@(1, 1j) for p in scene.points]).T
        return seconds, of(found.point_positions), of(found.point_velocities), of(found.point_accelerations)
    return turn


def mechanism_peer(scene):
    """Loops of vectors, solved by fsolve of scipy."""
    def turn(n):
        loops, used, guess, joints = LOOPS[scene.title](scene)
        m = vectors.Mechanism(vectors=used, origin=used[0].joints[0], loops=loops, pos=scene.angles(n),
                              vel=np.full(n, scene.rate), acc=np.zeros(n), guess=(guess, 0*guess, 0*guess))
        begun = time.perf_counter()
        m.iterate()
        seconds = time.perf_counter() - begun
        of = lambda x, y: np.array([getattr(j, x) + 1j*getattr(j, y) for j in joints]).T
        return (seconds, of('x_positions', 'y_positions'), of('x_velocities', 'y_velocities'),
                of('x_accelerations', 'y_accelerations'))
    return turn


# The loops of vectors for the package mechanism: the function, the vectors, the guess and the joints in order.

def four_bar_loops(scene):
    o, a, b, c, p = (vectors.Joint(name) for name in 'OABCP')
    e = scene.estimate['B'] - scene.radius*cmath.exp(1j*float(scene.start))
    at_c, turned = scene.joints[1][4], cmath.phase(e)
    crank, coupler = vectors.Vector((o, a), r=scene.radius), vectors.Vector((a, b), r=3.5)
    rocker = vectors.Vector((p, b), r=3)
    base, one = vectors.Vector((o, p), r=4, theta=0), vectors.Vector((a, c), r=abs(at_c))
    other = vectors.Vector((c, b), r=abs(3.5 - at_c))

    def loops(x, i):
        return np.array([crank(i) + coupler(x[0]) - rocker(x[1]) - base(),
                         one(x[2]) + other(x[3]) - coupler(x[0])]).ravel()
    guess = np.array([turned, cmath.phase(scene.estimate['B'] - 4), turned + cmath.phase(at_c),
                      turned + cmath.phase(3.5 - at_c)])
    return loops, [crank, coupler, rocker, base, one, other], guess, [a, b, c]


def yoke_loops(scene):
    o, c, a, t, r, h = (vectors.Joint(name) for name in 'OCATRH')
    pivot, crank = vectors.Vector((o, c), r=2, theta=math.pi/2), vectors.Vector((c, a), r=1)
    slot, lever, rod = vectors.Vector((o, a)), vectors.Vector((o, t), r=4), vectors.Vector((t, r), r=2)
    height, guide = vectors.Vector((o, h), r=5, theta=math.pi/2), vectors.Vector((h, r), theta=0)

    def loops(x, i):
        return np.array([pivot() + crank(i) - slot(x[0], x[1]),
                         lever(x[1]) + rod(x[2]) - guide(x[3]) - height()]).ravel()
    guess = np.array([abs(1 + 2j), math.radians(65), math.radians(45), 3.2])
    return loops, [pivot, crank, slot, lever, rod, height, guide], guess, [a, t, r]


def windows_loops(scene):
    n = len(scene.joints)
    pivots, tips = ([vectors.Joint(name + str(k)) for k in range(n + 1)] for name in 'GT')
    rods = [vectors.Vector((g, t), r=1) for g, t in zip(pivots, tips)]
    bases = [vectors.Vector((pivots[0], g), r=k + 1, theta=0) for k, g in enumerate(pivots[1:])]
    couplers = [vectors.Vector(pair, r=1) for pair in zip(tips, tips[1:])]

    def loops(x, i):
        tip = [rods[0](i)] + [base() + rod(angle) for base, rod, angle in zip(bases, rods[1:], x[n:])]
        return np.array([a + coupler(angle) - b for a, coupler, angle, b in zip(tip, couplers, x[:n], tip[1:])]).ravel()
    return loops, rods + bases + couplers, np.array([0.0]*n + [1.0]*n), tips


LOOPS = {'four-bar': four_bar_loops, 'out of reach': four_bar_loops, 'yoke': yoke_loops, '10 windows': windows_loops}

BY_HAND = 'equations (the user writes them), condition, check of the branch'
# Name, function, bound of its errors, what it does not give.
PEERS = [('KINMAT', kinmat, 1e-13, ''),
         ('pylinkage, compiled', pylinkage_compiled, 1e-11, 'angles, condition, check of the branch'),
         ('pylinkage, Python', pylinkage_python, 1e-11, 'angles, condition, check of the branch'),
         ('CasADi, compiled', casadi_compiled, 1e-11, BY_HAND),
         ('CasADi, interpreted', casadi_interpreted, 1e-11, BY_HAND),
         ('kimech', kimech_peer, 1e-9, 'check of the branch'),
         ('mechanism', mechanism_peer, 1e-9, BY_HAND)]


def when_out_of_reach(make):
    """What a peer says of positions that do not exist."""
    scene = four_bar_out_of_reach()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter('always')
        try:
            p = make(scene)(scene.steps)[1][161:]
        except Exception as fault:
            return 'error ' + type(fault).__name__
    if np.isnan(p).any(axis=1).all():
        return 'flagged' if make is kinmat else 'NaN'
    return 'wrong numbers, with a warning' if warned else 'wrong numbers, without a word'


def first_turn(scene, make, true, length, rate):
    """Seconds until ready, the turn, its seconds, errors, and whether the peer gave a warning."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter('always')
        begun = time.perf_counter()
        turn = make(scene)
        ready = time.perf_counter() - begun
        seconds, *found = turn(scene.steps)
    errors = [np.max(np.abs(f - e))/(length*rate**k) for k, (f, e) in enumerate(zip(found, true))]
    return ready, turn, seconds, errors, any(issubclass(w.category, RuntimeWarning) for w in warned)


def figure(x):
    """Three digits."""
    return '%.3g' % x if x < 99.95 else '{:,.0f}'.format(float('%.3g' % x))


def measure(scene):
    """Prints the rows of one scene; whether every error of which its program does not warn is within its bound."""
    def ours():
        command = [BUILD + '/timed/bench', 'scene', *scene.bench]
        return map(float, subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())

    true = exact(scene)
    *_, length, rate = ours()
    first = [first_turn(scene, make, true, length, rate) for _, make, _, _ in PEERS]
    steps = [max(20, min(scene.steps, int(SLOW/(seconds + 1e-9)*scene.steps))) for _, _, seconds, _, _ in first]
    times, closed = [[] for _ in PEERS], []
    for _ in range(REPEATS):
        one, blocks, *_ = ours()
        closed.append(one)
        times[0].append(blocks)
        for i in range(1, len(PEERS)):
            with warnings.catch_warnings():
                warnings.simplefilter('ignore')
                times[i].append(1e9*min(first[i][1](steps[i])[0] for _ in range(3))/steps[i])
    good = True
    for (name, _, bound, _), (ready, _, _, errors, warned), own in zip(PEERS, first, times):
        ratio = lambda other: figure(statistics.median(a/b for a, b in zip(own, other)))
        print('| %s | %s | %s | %s | %s | %s%s | %s |' % (
            scene.title, name, figure(statistics.median(own)), ratio(times[0]), ratio(closed),
            ', '.join('%.0E' % e for e in errors), ' (warned)' if warned else '',
            '%.1f' % ready if ready > 0.05 else ''), flush=True)
        good = good and (warned or all(e <= bound for e in errors))
    return good


def starts():
    """Prints the time of whole processes."""
    commands = [('`kinmat input/four_bar.deck`', [BUILD + '/kinmat', 'input/four_bar.deck'])] + [
        ("`python -c 'import %s'`" % name, [sys.executable, '-c', 'import ' + name])
        for name in ('pylinkage', 'casadi', 'kimech', 'mechanism')]
    times = [[] for _ in commands]
    for _ in range(REPEATS):
        for (_, command), own in zip(commands, times):
            begun = time.perf_counter()
            subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
            own.append(1e3*(time.perf_counter() - begun))
    print('\n| process | ms |\n|---|---|')
    for (name, _), own in zip(commands, times):
        print('| %s | %s |' % (name, figure(statistics.median(own))))


def main():
    print('| mechanism | program | ns a step | KINMAT = 1 | closed form = 1 |'
          ' errors of position, velocity, acceleration | ready, s |')
    print('|---|---|---|---|---|---|---|')
    good = [measure(scene) for scene in (four_bar(), yoke(), windows(10, WORK))]
    print('\n| program | position out of reach | does not give |\n|---|---|---|')
    for name, make, _, lacks in PEERS:
        print('| %s | %s | %s |' % (name, when_out_of_reach(make), lacks), flush=True)
    starts()
    sys.exit(0 if all(good) else 1)


if __name__ == '__main__':
    main()
