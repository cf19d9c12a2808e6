"""damaged.py N SEED FILE...: N files that are damaged at random end in a deck or in one sentence.

Half of the links of PMKS+ get the right length and digest again. The deck of a damaged file may lack a drive, or be out of
reach; its cards have no error of their own (E001 to E099)."""
import os
import random
import re
import sys
import traceback

sys.path.insert(0, 'tests/import')
from drawings import importer, kinmat


def sealed(link):
    """A link of PMKS+ whose length and digest are right."""
    head, _, payload = link.partition('?')
    body = payload.partition('*')[0][:-1]
    body += importer.DIGITS[len(body) % 62]
    return head + '?' + body + '*' + importer.digest(body)


def damaged(text, dice):
    for _ in range(dice.choice((1, 1, 2, 3, 8))):
        kind, at = dice.randrange(7), dice.randrange(len(text) + 1)
        other = at + dice.choice((1, 1, 2, 5, 40))
        if kind == 0:
            text = text[:at] + dice.choice('0123456789AZaz,.-_"<>/= \n\0\xe9*?&') + text[at + 1:]
        elif kind == 1:
            text = text[:at] + text[other:]
        elif kind == 2:
            text = text[:at] + text[at:other]*2 + text[other:]
        elif kind == 3:
            text = text[:at]
        elif kind == 4:
            pieces = re.split(r'([.,\n"])', text)
            i, j = dice.randrange(len(pieces)), dice.randrange(len(pieces))
            pieces[i], pieces[j] = pieces[j], pieces[i]
            text = ''.join(pieces)
        elif kind == 5:
            text = re.sub(r'-?\d+\.?\d*', lambda m: dice.choice((m[0], m[0], m[0], '0', '-1', '1e400', '1e20', 'nan', '9'*40)), text,
                          count=dice.randrange(1, 40))
        else:
            text = re.sub(dice.choice(('anchor', 'slider', 'id', 'Link', 'connector', 'true', 'x=', 'rpm')), dice.choice(('', 'id', 'q')),
                          text, count=dice.randrange(1, 4))
        if not text:
            break
    return text


def main(count, seed, paths):
    dice = random.Random(seed)
    texts = [importer.decoded(open(path, 'rb').read()).strip() for path in paths]
    decks = sentences = solved = wrong = 0
    for n in range(count):
        which = dice.randrange(len(texts))
        text = damaged(texts[which], dice)
        if '?' in text and not text.startswith('<') and dice.random() < 0.5:
            text = sealed(text)
        what = '%s, damage %d of seed %d' % (os.path.basename(paths[which]), n, seed)
        try:
            deck, _ = importer.convert(text)
        except importer.Refused as refusal:
            sentences += 1
            if '\n' in str(refusal) or not str(refusal):
                wrong += 1
                print(what + ': not one line: ' + repr(str(refusal)))
            continue
        except Exception:
            wrong += 1
            print(what + ':\n' + traceback.format_exc())
            continue
        decks += 1
        try:
            kinmat.Kinmat(deck)
            solved += 1
        except kinmat.Rejected as error:
            faults = re.findall(r'E0\d\d.*', str(error))
            if faults:
                wrong += 1
                print(what + ': ' + faults[0])
    print('%d damaged drawings: %d sentences, %d decks, of which KINMAT takes %d; %d wrong' % (count, sentences, decks, solved, wrong))
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]))
