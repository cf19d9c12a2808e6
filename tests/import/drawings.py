"""drawings.py DIR: every drawing in a directory, through kinmat-import and KINMAT, against DIR/TRUTH.tsv.

A row of TRUTH.tsv: file, time, id of a pin, x, y; or file, REFUSED, why. A file agrees if all its pins are within 1E-9 of the
size of the drawing at all times; a redundant one within 1E-6. A last line counts."""
import importlib.machinery
import importlib.util
import math
import os
import sys

sys.path.insert(0, 'contrib')
import kinmat

sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader('kinmat_import', 'contrib/kinmat-import')
importer = importlib.util.module_from_spec(importlib.util.spec_from_loader('kinmat_import', loader))
loader.exec_module(importer)

# Of the size of a drawing: an independent solver and KINMAT each have some 1E-12.
AGREES = 1e-9
# A redundant drawing: rounded coordinates do not close, and a solver of points finds parallel slots as a double root, whose
# error is the root of its rounding error.
AGREES_REDUNDANT = 1e-6


def truth_of(path):
    truth, refused = {}, {}
    for line in open(path):
        cells = line.rstrip('\n').split('\t')
        if cells[1] == 'REFUSED':
            refused[cells[0]] = cells[2]
        else:
            truth.setdefault(cells[0], {}).setdefault(float(cells[1]), {})[cells[2]] = (float(cells[3]), float(cells[4]))
    return truth, refused


def error_of(path, instants):
    """The largest error over the size, and what there is to say."""
    deck, labels = importer.convert(importer.decoded(open(path, 'rb').read()), os.path.basename(path))
    k = kinmat.Kinmat(deck)
    size = importer.size_of(p for pins in instants.values() for p in pins.values())
    worst, words = 0.0, ''
    for t in sorted(instants):
        row = k.advance(t)
        if k.flagged:
            return math.inf, 'FLAGGED AT %g' % t
        for key, place in instants[t].items():
            if key not in labels or labels[key] + '.x' not in k.columns:
                return math.inf, 'PIN %s IS MISSING' % key
            at = k.columns.index(labels[key] + '.x')
            error = math.dist((row[at], row[at + 1]), place)/size
            if error > worst:
                worst, words = error, 'PIN %s AT %g' % (key, t)
    return worst, words


def is_redundant(path):
    """Whether the deck lacks a parallel slot of the drawing, or is out of reach without its closing tolerance."""
    deck, _ = importer.convert(importer.decoded(open(path, 'rb').read()))
    k = kinmat.Kinmat(''.join(line for line in deck.splitlines(True) if not line.startswith('METHOD')))
    k.advance(0.0)
    return k.flagged or 'SLIDES IN A PARALLEL ONE' in deck.replace('\n$', '')


def main(directory):
    truth, refused = truth_of(os.path.join(directory, 'TRUTH.tsv'))
    files = sorted(os.path.join(place, name) for place, _, names in os.walk(directory) for name in names
                   if name in truth or name in refused)
    agree, redundant, both, differ, largest = 0, 0, 0, 0, 0.0
    for path in files:
        name = os.path.basename(path)
        try:
            error, words = error_of(path, truth.get(name, {}))
        except (importer.Refused, kinmat.Rejected) as fault:
            error, words = math.nan, 'REFUSED: ' + str(fault).replace('\n', ' ')
        if name in refused:
            both += 1
            words = 'REFUSED THERE (%s); %s' % (refused[name], words or 'RUNS HERE')
        elif error <= AGREES:
            agree += 1
            largest = max(largest, error)
        elif error <= AGREES_REDUNDANT and is_redundant(path):
            redundant += 1
            words += ', REDUNDANT'
        else:
            differ += 1
            words = '*** ' + words
        print('%-34s %9.1e  %s' % (name, error, words))
    print('%d drawings: %d agree within %.0e of their size (largest %.1e), %d redundant within %.0e, %d have no truth, %d differ'
          % (len(files), agree, AGREES, largest, redundant, AGREES_REDUNDANT, both, differ))
    return 1 if differ or not files else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1]))
