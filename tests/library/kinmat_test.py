"""kinmat.py against the tables of the command: kinmat_test.py KINMAT DECK... prints what is wrong; nothing if all is right."""
import math
import struct
import subprocess
import sys
import tempfile
import threading

if '--lists' in sys.argv:
    sys.argv.remove('--lists')
    sys.modules['numpy'] = None
sys.path.insert(0, 'contrib')
import kinmat

command, decks = sys.argv[1], sys.argv[2:]


def bits(row):
    return [None if math.isnan(x) else struct.pack('d', x) for x in row]


def check(what, is_right):
    if not is_right:
        print(what)


def rejected(what, words, call):
    try:
        call()
        print(what, 'is not rejected')
    except kinmat.Rejected as error:
        check('%s: %s' % (what, error), words in str(error))


check('version', kinmat.version() == 'KINMAT 2.0')
texts = [open(deck).read() for deck in decks]
tables = []
for deck, text in zip(decks, texts):
    with tempfile.TemporaryDirectory() as place:
        subprocess.run([command, '--no-listing', '--quiet', '--table', place + '/table', deck])
        lines = open(place + '/table').read().splitlines()
    names, rows = kinmat.run(text)
    check(deck + ': names', names == lines[0].split(','))
    tables.append([bits(map(float, line.split(','))) for line in lines[1:]])
    check(deck + ': rows', [bits(row) for row in rows] == tables[-1])
    if kinmat.numpy:
        check(deck + ': an array', rows.shape == (len(lines) - 1, len(names)))
    else:
        check(deck + ': lists', isinstance(rows, list) and isinstance(rows[0], list))

# A row that is kept stays as it is.
k = kinmat.Kinmat(texts[0])
first = k.advance(k.instants[0])
kept = bits(first)
k.advance(k.instants[-1])
check('a row that is kept', bits(first) == kept)
rejected('an earlier time', 'BEFORE', lambda: k.advance(k.instants[0]))
rejected('no time', 'FINITE', lambda: k.advance(float('nan')))
rejected('no deck', 'E001', lambda: kinmat.Kinmat(''))
rejected('a null', 'CARD 1  COLUMN 4', lambda: kinmat.Kinmat('LIN\0K\nEND\n'))
rejected('a letter', 'E016', lambda: kinmat.Kinmat(b'LINK    \xc5\nEND\n'))
rejected('no such set', 'SET', lambda: kinmat.Kinmat(texts[0], 2))
check('bytes', bits(kinmat.Kinmat(texts[0].encode()).advance(0.0)) == bits(kinmat.Kinmat(texts[0]).advance(0.0)))

# A sweep changes the text: the crank of length r reaches from r to -r.
deck = """GROUND  BASE
LINK    CRANK
POINT   O       BASE
POINT   P       CRANK
POINT   TIP     CRANK           %.12f
REVOLUTEO       P       PIVOT
DRIVE   ANGLE   CRANK                           1.0
TIME    2                       0.0             3.14159265
PRINT   POINTS  TIP
END
"""
for i in range(1, 20):
    names, rows = kinmat.run(deck % (i/8))
    x = names.index('TIP.x')
    check('a sweep', rows[0][x] == i/8 and abs(rows[2][x] + i/8) < 1e-8)

# A deck that runs backwards goes on so only while every call is for its next instant.
k = kinmat.Kinmat(deck.replace('0.0             3.14159265', '2.0             0.0       ') % 1.0)
k.advance(2.0)
k.advance(1.0)
check('backwards', abs(k.advance(0.0)[k.columns.index('TIP.x')] - 1.0) < 1e-12)
k = kinmat.Kinmat(deck.replace('0.0             3.14159265', '2.0             0.0       ') % 1.0)
k.advance(2.0)
k.advance(3.0)
rejected('backwards after another time', 'BEFORE', lambda: k.advance(0.0))

# A rocker that is driven beyond its limit: flagged, and NaN.
k = kinmat.Kinmat("""GROUND  BASE
LINK    CRANK
LINK    COUPLER
LINK    ROCKER
JOINT   A0      BASE    CRANK   0.0             0.0
JOINT   A       CRANK   COUPLER 1.2             1.6
JOINT   B       COUPLER ROCKER  2.4             2.5
JOINT   B0      ROCKER  BASE    4.0             0.0
DRIVE   ANGLE   CRANK                           -1.0
TIME    2                       0.0             3.0
PRINT   LINKS   ROCKER
END
""")
x = k.columns.index('ROCKER.phi')
check('before the limit', not math.isnan(k.advance(0.0)[x]) and not k.flagged)
check('beyond the limit', math.isnan(k.advance(3.0)[x]) and k.flagged)

# Threads with a handle each.
differ = []


def work(n):
    for i in range(3*len(decks)):
        j = (i + n) % len(decks)
        if [bits(row) for row in kinmat.run(texts[j])[1]] != tables[j]:
            differ.append(decks[j])


threads = [threading.Thread(target=work, args=(n,)) for n in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
check('threads: %s' % differ, not differ)
