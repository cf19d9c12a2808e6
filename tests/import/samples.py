"""samples.py DIR: small drawings of both formats, and DIR/TRUTH.tsv with the positions of their pins by closed forms."""
import math
import os
import sys

sys.path.insert(0, 'tests/import')
from drawings import importer

DIGITS = '0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-'
SLIDER, INPUT, GROUND, WELDED = 1, 2, 4, 8
TIMES = (0.0, 0.3, 0.7, 1.1)


def whole(n):
    text = ''
    while True:
        n, digit = divmod(n, 64) if n >= 0 else (-n, None)
        if digit is None:
            return '0' + whole(n)
        text = DIGITS[digit] + text
        if n == 0:
            return text


def decimal(x):
    return whole(round(1000*x))


def pmks(joints, links, clockwise=True, rpm=10, speed=None, unit=1, digest=True, name='%s', forces=''):
    """A link of PMKS+: joints (flags, id, x, y, angle, further fields); links (kind, id, joints, parts)."""
    text = ('2v' if clockwise else '2u') + '.' + decimal(0.7) + (',' + decimal(speed) if speed else '') + '.' + whole(rpm) + ',0.%d011.' % unit
    for flags, key, x, y, angle, *more in joints:
        text += ','.join([DIGITS[flags] + key, name % key, decimal(x), decimal(y), decimal(angle)] + list(more)) + '.'
    text += '.'
    for kind, key, pins, *parts in links:
        text += ','.join([kind + key, name % key, '0', '0', '0', '0', 'c5cae9'] + list(pins) + [''] + list(parts or [''])) + '.'
    text += '.' + forces + '.N_'
    text += DIGITS[len(text) % 62]
    return 'https://app.pmksplus.com/?' + text + ('*' + importer.digest(text) if digest else '')


def linkage(pins, links, program='units="Millimeters" scalefactor="1"'):
    """A file of Linkage: pins (id, x, y, attributes, limits); links (id, pins, attributes)."""
    text = '<linkage2>\n\t<program zoom="1"xoffset="81" %s/>\n' % program
    for key, x, y, attributes, *limits in pins:
        text += '\t<connector %s x="%r" y="%r"id="%s">' % (attributes, x, y, key)
        text += ''.join('<slidelimit id="%s"/>' % e for e in limits) + '</connector>\n'
    for key, own, attributes in links:
        text += '\t<Link id="%s" %s>%s</Link>\n' % (key, attributes, ''.join('<connector id="%s"/>' % p for p in own))
    return text + '</linkage2>\n'


def turned(p, centre, angle):
    c, s = math.cos(angle), math.sin(angle)
    x, y = p[0] - centre[0], p[1] - centre[1]
    return centre[0] + c*x - s*y, centre[1] + s*x + c*y


def meet(p, a, q, b, near):
    """The point at a from p and b from q, on the side of the line pq on which `near` was drawn (p0, q0, point)."""
    d = math.dist(p, q)
    along = (d*d + a*a - b*b)/(2*d)
    side = math.copysign(math.sqrt(a*a - along*along), near)
    ux, uy = (q[0] - p[0])/d, (q[1] - p[1])/d
    return p[0] + along*ux - side*uy, p[1] + along*uy + side*ux


def side(p, q, r):
    return (q[0] - p[0])*(r[1] - p[1]) - (q[1] - p[1])*(r[0] - p[0])


def carried(p, before, after):
    """A point of a body that has moved from two points `before` to `after`."""
    angle = math.atan2(after[1][1] - after[0][1], after[1][0] - after[0][0]) - \
        math.atan2(before[1][1] - before[0][1], before[1][0] - before[0][0])
    x, y = turned(p, before[0], angle)
    return x + after[0][0] - before[0][0], y + after[0][1] - before[0][1]


A, B, C, D, E = (0.0, 0.0), (0.0, 1.0), (3.0, 2.5), (4.0, 0.0), (1.5, 3.5)


def four_bar(angle, a=A, b=B, c=C, d=D, e=E):
    b1 = turned(b, a, angle)
    c1 = meet(b1, math.dist(b, c), d, math.dist(c, d), side(b, d, c))
    return {'B': b1, 'C': c1, 'E': carried(e, (b, c), (b1, c1))}


def slider_crank(angle, a, b, c, direction):
    """Pin c on a line through its drawn place; at the distance bc from b."""
    b1 = turned(b, a, angle)
    ux, uy = math.cos(direction), math.sin(direction)
    along = (b1[0] - c[0])*ux + (b1[1] - c[1])*uy
    off = -(b1[0] - c[0])*uy + (b1[1] - c[1])*ux
    before = (b[0] - c[0])*ux + (b[1] - c[1])*uy
    s = along - math.copysign(math.sqrt(math.dist(b, c)**2 - off**2), before)
    return {'B': b1, 'C': (c[0] + s*ux, c[1] + s*uy)}


def swing(b, pivot, angle, a, tip):
    """A slot through `pivot` in the link whose tip is drawn, led by the pin b of a crank about a."""
    b1 = turned(b, a, angle)
    turn = math.atan2(b1[1] - pivot[1], b1[0] - pivot[0]) - math.atan2(b[1] - pivot[1], b[0] - pivot[0])
    return b1, turned(tip, pivot, turn)


def rate(rpm, clockwise=True):
    return (-1 if clockwise else 1)*rpm*math.pi/30


def samples():
    ab = [(GROUND | INPUT, 'A', *A, 0), (0, 'B', *B, 0)]
    cd = [(0, 'C', *C, 0), (16, 'E', *E, 0), (GROUND, 'D', *D, 0)]
    bars = [('YR', 'AB', 'AB'), ('AR', 'BCE', 'BCE', 'BC', 'CE'), ('NR', 'BC', 'BC'), ('aR', 'CE', 'CE'), ('0R', 'CD', 'CD')]
    yield 'four_bar.pmks', pmks(ab + cd, bars), lambda t: four_bar(rate(10)*t)
    yield 'blanks.pmks', pmks(ab + cd, bars, False, 7, unit=0, digest=False, name='pin %s').replace(' ', '%20'), \
        lambda t: four_bar(rate(7, False)*t)
    own = [(GROUND | INPUT, 'A', *A, 0, '', '', '', decimal(-3))]
    yield 'own_speed.pmks', pmks(own + ab[1:] + cd, bars), lambda t: four_bar(rate(3)*t)
    # An input between two links: two bars, of which one turns about A and the end of the other slides.
    knee = [(GROUND, 'A', 0, 0, 0), (INPUT, 'B', 2, 1.5, 0), (0, 'C', 4, 0, 0), (SLIDER | GROUND, 'P', 4, 0, 0)]
    yield 'knee.pmks', pmks(knee, [('YR', 'AB', 'AB'), ('YR', 'BC', 'BC'), ('YP', 'CP', 'CP')], rpm=2), lambda t: bent(t, rate(2))
    # A crank and a slider, in the three ways in which they are drawn.
    crank = [(GROUND | INPUT, 'A', 0, 0, 0), (0, 'B', 0, 1.2, 0), (0, 'C', 0.3, -3.4, 0)]
    rods = [('YR', 'AB', 'AB'), ('YR', 'BC', 'BC')]
    guide = [(SLIDER | GROUND, 'P', 0.3, -3.4, 1.571)]

    def on_guide(t):
        return slider_crank(rate(10)*t, (0, 0), (0, 1.2), (0.3, -3.4), math.pi/2)
    yield 'block.pmks', pmks(crank + guide, rods + [('YP', 'CP', 'CP')]), on_guide
    yield 'rider.pmks', pmks(crank[:2] + [(SLIDER | GROUND, 'C', 0.3, -3.4, 1.571)], rods), on_guide
    # A yoke that does not turn, led by a crank pin in its slot.
    yoke = [(GROUND | INPUT, 'A', 0, 0, 0), (0, 'B', 1, 0, 0), (WELDED, 'C', 1, -2, 0), (0, 'F', 1, 2, 0),
            (SLIDER, 'Q', 1, 0, 0, 'CF', 'C', 'F'), (SLIDER | GROUND, 'P', 1, -2, 0)]
    yield 'yoke.pmks', pmks(yoke, [('YR', 'AB', 'AB'), ('YR', 'CF', 'CF'), ('YP', 'BQ', 'BQ'), ('YP', 'CP', 'CP')]), \
        lambda t: {'B': turned((1, 0), (0, 0), rate(10)*t), 'C': (math.cos(rate(10)*t), -2), 'F': (math.cos(rate(10)*t), 2)}
    # A plate with pins in two parallel slots, lifted by a crank and a rod.
    plate = [(GROUND | INPUT, 'A', 0, 0, 0), (0, 'B', 0, 1.2, 0), (0, 'C', 0.3, -3.4, 0), (0, 'E', 2.3, -3.4, 0),
             (SLIDER | GROUND, 'P', 0.3, -3.4, 1.571), (SLIDER | GROUND, 'Q', 2.3, -3.4, 1.571)]

    def plate_at(t):
        places = on_guide(t)
        return {**places, 'E': (2.3, places['C'][1])}
    yield 'plate.pmks', pmks(plate, rods + [('YR', 'CE', 'CE'), ('YP', 'CP', 'CP'), ('YP', 'EQ', 'EQ')]), plate_at
    # A slot in a rocker, with a rider that has no block; two machines, each with its input.
    whitworth = [(GROUND | INPUT, 'A', 0, 0, 0), (SLIDER, 'B', 0, 1, 0, 'PT', 'P', 'T'), (GROUND, 'P', 0.25, -2, 0), (0, 'T', 0.1, 2, 0),
                 (GROUND | INPUT, 'G', 10, 0, 0, '', '', '', decimal(4)), (0, 'H', 11, 0, 0)]

    def rocker(t):
        b, tip = swing((0, 1), (0.25, -2), rate(10)*t, (0, 0), (0.1, 2))
        # The slot is beside the pivot: by as much as the drawn pin is off the line PT.
        d = side((0.25, -2), (0.1, 2), (0, 1))/math.dist((0.25, -2), (0.1, 2))
        length = math.dist(b, (0.25, -2))
        turn = math.atan2(b[1] + 2, b[0] - 0.25) - math.asin(d/length) - math.atan2(4, -0.15)
        return {'B': b, 'T': turned((0.1, 2), (0.25, -2), turn), 'H': turned((11, 0), (10, 0), rate(4, False)*t)}
    yield 'whitworth.pmks', pmks(whitworth, [('YR', 'AB', 'AB'), ('YR', 'PT', 'PBT'), ('YR', 'GH', 'GH')]), rocker
    # A cylinder: its rod slides in the barrel at 0.25 a second, and lifts a boom about D.
    ram = [(GROUND, 'F', 1, -1, 0), (0, 'G', 1.6, -0.2, 0), (WELDED, 'C', 1.3, -0.6, 0), (0, 'R', 2.2, 0.6, 0), (GROUND, 'D', 0, 0, 0),
           (0, 'T', 4, 1, 0), (SLIDER | INPUT | 32, 'S', 1.3, -0.6, 0, 'FG', 'F', 'G')]
    yield 'ram.pmks', pmks(ram, [('YR', 'FG', 'FG'), ('YR', 'CR', 'CR'), ('YR', 'DRT', 'DRT'), ('YP', 'CS', 'CS')], speed=0.25), \
        lambda t: lifted(t, (1, -1), (2.2, 0.6), (0, 0), (4, 1), 0.25)

    # Linkage: coordinates are 96 to the inch, y is upwards, positive turns are clockwise.
    k = 96/25.4
    pins = [('0', *(k*x for x in A), 'anchor="true"input="true"rpm="15"'), ('1', *(k*x for x in B), ''), ('2', *(k*x for x in C), ''),
            ('3', *(k*x for x in D), 'anchor="true" layer="16"'), ('4', *(k*x for x in E), 'draw="true" fastenlink="1"'),
            ('8', 5.0, 5.0, 'layer="1"'), ('9', 7.0, 5.0, 'layer="1"')]
    links = [('0', '01', ''), ('1', '12', ''), ('2', '23', ''), ('3', '03', ''), ('4', '89', 'layer="1"'), ('5', '2', ''), ('6', '12', '')]

    def by_id(places, ids):
        return {ids[p]: places[p] for p in ids if p in places}
    yield 'four_bar.linkage2', linkage(pins, links), lambda t: by_id(four_bar(rate(15)*t), {'B': '1', 'C': '2', 'E': '4'})
    yield 'inches.linkage2', linkage([(key, x*25.4/4, y*25.4/4, a) for key, x, y, a in pins], links, 'units="Inches" scalefactor="4"'), \
        lambda t: by_id(four_bar(rate(15)*t), {'B': '1', 'C': '2', 'E': '4'})
    line = [('0', 0.0, 0.0, 'anchor="true" input="true"'), ('1', 0.0, 1.2*k, ''), ('2', 0.3*k, -3.4*k, 'slider="true"', '5', '6'),
            ('5', 0.3*k, -3*k, 'anchor="true"'), ('6', 0.3*k, -4*k, 'anchor="true"')]
    yield 'line.linkage2', linkage(line, [('0', '01', ''), ('1', '12', '')]), \
        lambda t: by_id(slider_crank(rate(15)*t, (0, 0), (0, 1.2), (0.3, -3.4), math.pi/2), {'B': '1', 'C': '2'})
    # An arc: C of the four-bar on a circle about D, from centre to centre of which no pin is drawn.
    arc = pins[:2] + [('2', *(k*x for x in C), 'slider="true" slideradius="%r"' % (k*math.dist(C, D)), '5', '6')] + \
        [(key, k*x, k*y, 'anchor="true"') for key, (x, y) in (('5', turned(C, D, 0.5)), ('6', turned(C, D, -0.4)))]
    yield 'arc.linkage2', linkage(arc, [('0', '01', ''), ('1', '12', '')]), \
        lambda t: {**by_id(four_bar(rate(15)*t), {'B': '1', 'C': '2'}), 'O2': D}
    # A pin on ground in the slot of a link that a crank leads.
    through = [('0', 0.0, 0.0, 'anchor="true" input="true" rpm="-12"'), ('1', 0.0, k, ''), ('2', 2*k, -3*k, ''),
               ('3', k, -k, 'anchor="true" slider="true"', '1', '2')]
    yield 'through.linkage2', linkage(through, [('0', '01', ''), ('1', '12', '')]), \
        lambda t: by_id(guided(rate(12, False)*t), {'B': '1', 'T': '2'})
    lift = [('0', k, -k, 'anchor="true"'), ('1', 2.2*k, 0.6*k, ''), ('2', 0.0, 0.0, 'anchor="true"'), ('3', 4*k, k, '')]
    yield 'actuator.linkage2', linkage(lift, [('0', '01', 'actuator="true" throw="%r" cpm="15"' % (0.5*k)), ('1', '213', '')]), \
        lambda t: by_id(lifted(t, (1, -1), (2.2, 0.6), (0, 0), (4, 1), 2*0.5*15/60), {'R': '1', 'T': '3'})
    # A bracket that slides without turning over two pins on ground; two bars turn about one of these pins.
    bracket = [('0', 0.0, 0.0, ''), ('1', 4*k, 0.0, ''), ('2', k, 0.0, 'anchor="true" slider="true"', '0', '1'),
               ('3', 3*k, 0.0, 'anchor="true" slider="true"', '0', '1'), ('4', -2*k, 0.0, 'anchor="true"'), ('5', k, 2*k, ''), ('6', k, -2*k, '')]
    yield 'bracket.linkage2', linkage(bracket, [('0', '01', ''), ('1', '40', 'actuator="true" throw="%r" cpm="15"' % (0.5*k)), ('2', '25', ''),
                                                ('3', '26', ''), ('4', '50', ''), ('5', '60', '')]), \
        lambda t: pushed(0.25*t)


def pushed(x):
    """The bracket at x; a bar of 2 about (1, 0), and a bar of the root of 5 from it to the bracket."""
    bx, by = meet((1, 0), 2, (x, 0), math.sqrt(5), side((1, 0), (0, 0), (1, 2)))
    return {'0': (x, 0.0), '1': (4 + x, 0.0), '5': (bx, by), '6': (bx, -by)}


def guided(angle):
    b, p = turned((0, 1), (0, 0), angle), (1, -1)
    d = math.dist(b, p)
    length = math.hypot(2, 4)
    return {'B': b, 'T': (b[0] + (p[0] - b[0])*length/d, b[1] + (p[1] - b[1])*length/d)}


def bent(t, speed):
    """Two bars of 2.5: the angle between them grows by speed t, and C stays on the x axis."""
    half = math.atan2(1.5, 2) - speed*t/2
    return {'B': (2.5*math.cos(half), 2.5*math.sin(half)), 'C': (5*math.cos(half), 0.0)}


def lifted(t, foot, rod, pivot, tip, speed):
    r = meet(foot, math.dist(foot, rod) + speed*t, pivot, math.dist(rod, pivot), side(foot, pivot, rod))
    return {'R': r, 'T': carried(tip, (pivot, rod), (pivot, r))}


def main(place):
    os.makedirs(place, exist_ok=True)
    with open(os.path.join(place, 'TRUTH.tsv'), 'w') as truth:
        for name, text, places in samples():
            with open(os.path.join(place, name), 'w') as file:
                file.write(text)
            for t in TIMES:
                for key, (x, y) in places(t).items():
                    truth.write('%s\t%r\t%s\t%.17g\t%.17g\n' % (name, t, key, x, y))


if __name__ == '__main__':
    main(sys.argv[1])
