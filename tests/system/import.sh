#!/bin/sh
# kinmat-import: small drawings against closed forms, drawings that are refused, and damaged ones.
. tests/counting.sh

"${MAKE:-make}" --no-print-directory BUILD="$BUILD" shared > "$w/out" 2>&1
LIBKINMAT=$BUILD/libkinmat.so.2
PYTHONDONTWRITEBYTECODE=1
export LIBKINMAT PYTHONDONTWRITEBYTECODE
import=contrib/kinmat-import

# Positions, with 1E-9 of the size as the most.
python3 tests/import/samples.py "$w/samples" > "$w/out" 2>&1
equal 'the samples: status' 0 $?
python3 tests/import/drawings.py "$w/samples" > "$w/found" 2>&1
equal 'the samples agree' 0 $?
grep -E '[*][*][*]|Error' "$w/found"
equal 'samples' "$(ls "$w/samples" | grep -c '[.]')" "$(($(sed -n '$s/ .*//p' "$w/found") + 1))"
# The test sees what it is there for.
mkdir "$w/wrong" && cp "$w/samples/four_bar.pmks" "$w/wrong" &&
   sed -n '/^four_bar.pmks\t0.7\tC/s/\t0*-*[0-9]*[.]/&00000001/; /^four_bar.pmks/p' "$w/samples/TRUTH.tsv" > "$w/wrong/TRUTH.tsv"
python3 tests/import/drawings.py "$w/wrong" > "$w/found" 2>&1
equal 'a wrong position is found' 1 $?

# The deck as it is printed, from a file, a URL and standard input; --table has the pins by their labels.
python3 "$import" "$w/samples/blanks.pmks" > "$w/deck"
equal 'a drawing: status' 0 $?
cat > "$w/expected" <<'EOF'
$ PINS BY THEIR IDS: A = PIN-A, B = PIN-B, C = PIN-C, E = PIN-E, D = PIN-D
$NAME---LABEL-A|LABEL-B|LABEL-C|REAL-1---------|REAL-2---------|REAL-3---------|
TITLE   blanks
UNITS   IN      DEG     S
METHOD  NEWTON                                  1.0E-3
GROUND  BASE
LINK    PIN-AB
LINK    PIN-BCE
LINK    PIN-CD
JOINT   PIN-A   BASE    PIN-AB  0.0             0.0
JOINT   PIN-B   PIN-AB  PIN-BCE 0.0             1.0
JOINT   PIN-C   PIN-BCE PIN-CD  3.0             2.5
POINT   PIN-E   PIN-BCE         1.5             3.5
JOINT   PIN-D   BASE    PIN-CD  4.0             0.0
DRIVE   ANGLE   PIN-AB  RPM                     7.0
TIME    72                      0.0             8.57142857143
PRINT   POINTS
RANGE
END
EOF
same 'a drawing: its deck' "$w/expected" "$w/deck"
python3 "$import" "$(cat "$w/samples/blanks.pmks")" | grep -v '^TITLE' > "$w/found"
grep -v '^TITLE' "$w/deck" > "$w/expected"
same 'a URL: its deck' "$w/expected" "$w/found"
python3 "$import" - < "$w/samples/blanks.pmks" | grep -v '^TITLE' > "$w/found"
same 'standard input: its deck' "$w/expected" "$w/found"
"$kinmat" --no-listing --quiet --table "$w/table" "$w/deck"
equal 'the deck runs' 0 $?
equal 'its table' 't,ANGLE.PIN-AB,PIN-A.x,PIN-A.y,PIN-B.x,PIN-B.y' "$(head -n 1 "$w/table" | cut -d , -f 1-6)"

# no NAME SENTENCE: what is on standard input is refused by this sentence.
no() {
   python3 "$import" - > "$w/out" 2> "$w/err"
   equal "$1: status" 1 $?
   equal "$1: sentence" " *** $2" "$(cat "$w/err")"
   equal "$1: no deck" '' "$(cat "$w/out")"
}
link() { printf '<linkage2><program units="Millimeters"/>%s</linkage2>\n' "$*"; }
anchor='<connector id="0" x="0" y="0" anchor="true" input="true"/><connector id="1" x="9" y="0"/>'
bar='<Link id="0"><connector id="0"/><connector id="1"/></Link>'
echo 'https://www.pmksplus.com/?j=A,1,2&l=AB' | no 'PMKS before 2023' 'LINKS OF PMKS BEFORE 2023 (?j=...&l=...) ARE NOT READ: OPEN IT IN PMKS+ AND COPY ITS LINK'
echo 'https://app.pmksplus.com/?editor=native&document=pmks2%3Ab6e8627d.eyJh' | no 'a native document' 'NATIVE BODY DOCUMENTS OF PMKS+ (pmks2:) ARE NOT READ'
sed 's/,3t,/,3u,/; s/CD,CD/CD,CE/' "$w/samples/four_bar.pmks" | no 'a wrong digest' 'THE LINK OF PMKS+ IS DAMAGED: ITS LENGTH OR ITS DIGEST IS WRONG'
cut -c 1-100 "$w/samples/four_bar.pmks" | no 'a link that is cut' 'THE LINK OF PMKS+ IS DAMAGED: ITS LENGTH OR ITS DIGEST IS WRONG'
echo 'Dear colleague' | no 'a letter' 'THIS IS NEITHER A LINK OF PMKS+ NOR A FILE OF LINKAGE'
: | no 'nothing' 'THIS IS NEITHER A LINK OF PMKS+ NOR A FILE OF LINKAGE'
link "$anchor" '<Link id="0" gear="true"><connector id="0"/><connector id="1"/></Link>' | no 'a gear' 'GEARS AND CHAINS ARE NOT COVERED'
link '<connector id="0" x="0" y="0" anchor="true"/><connector id="1" x="9" y="0"/>' "$bar" | no 'no input' 'THE DRAWING HAS NO INPUT'
link '<connector id="0" x="0" y="0" anchor="true"/>' | no 'no link' 'NO LINK MOVES'
link '<connector id="0" x="0" y="zero"/>' | no 'no number' '"zero" IS NO NUMBER: y'
link "$anchor" '<connector id="2" slider="true" x="1" y="1"/>' "$bar" | no 'a slider without ends' 'PIN P2 SLIDES BETWEEN PINS THAT ARE MISSING'
link "$anchor" '<connector id="1" x="3" y="3"/>' | no 'an id twice' 'TWO PINS HAVE THE ID 1'
printf '<svg/>' | no 'another file' 'THE FILE HAS <svg>, NOT <linkage2>'
python3 "$import" "$w/none" > "$w/out" 2> "$w/err"
equal 'no such file: status' 3 $?
equal 'no such file' " *** $w/none CANNOT BE READ (NO SUCH FILE OR DIRECTORY)" "$(cat "$w/err")"
python3 "$import" > "$w/out" 2> "$w/err"
equal 'no argument: status' 1 $?

# Two hundred damaged drawings: a deck or one sentence.
python3 tests/import/damaged.py 200 1 "$w"/samples/*.pmks "$w"/samples/*.linkage2 > "$w/found" 2>&1
equal 'damaged drawings' 0 $?
grep -v '^[0-9]* damaged' "$w/found" | head -n 20
conclude
