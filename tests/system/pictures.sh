#!/bin/sh
# Pictures: of every deck of input/ one that is well-formed XML, with the joints where the CSV has them; what is refused.
BUILD=${BUILD:-build}
. tests/counting.sh

kinmat=$BUILD/kinmat
w=$BUILD/pictures
rm -rf "$w" && mkdir -p "$w" || exit 3

# tags FILE: what is wrong with its tags and characters
tags() { awk '
   { text = text $0 "\n"; if ($0 ~ /[^ -~]/) print FILENAME ":" FNR ": not printable ASCII" }
   END {
      while (match(text, /<[^>]*>/)) {
         between = substr(text, 1, RSTART - 1)
         tag = substr(text, RSTART + 1, RLENGTH - 2)
         text = substr(text, RSTART + RLENGTH)
         gsub(/&(amp|lt|gt|quot);/, "", between)
         if (between ~ /[&<>]/) print FILENAME ": text: " between
         if (tag ~ /^[?]/) continue
         name = tag
         sub(/[ \/].*/, "", name)
         if (tag ~ /^\//) {
            if (depth < 1 || open[depth] != substr(tag, 2)) print FILENAME ": closes " tag
            depth--
            continue
         }
         rest = substr(tag, length(name) + 1)
         sub(/\/$/, "", rest)
         gsub(/ [a-zA-Z0-9-]+="[^"<]*"/, "", rest)
         if (rest != "") print FILENAME ": attributes: " tag
         if (depth == 0 && roots++) print FILENAME ": a second root"
         if (tag !~ /\/$/) open[++depth] = name
      }
      if (depth != 0 || roots != 1) print FILENAME ": " depth " open, " roots " roots"
   }' "$1"; }
printf '<svg><g a="1"><text>x &amp; y</text></svg>\n' > "$w/bad.svg"
equal 'a tag that is not closed is found' yes "$([ -n "$(tags "$w/bad.svg")" ] && echo yes)"

# joints DECK CSV SVG: the joints of the picture that are not where the CSV has their points; then how many there are.
# A picture shows all links, those that no table asks for as well.
joints() { awk -F, '
   function value(line, name) { sub(".* " name "=\"", "", line); sub(/".*/, "", line); return line }
   FILENAME == ARGV[1] {
      if ($0 ~ /^REVOLUTE/) { pair = substr($0, 25, 8); first = substr($0, 9, 8); gsub(/ /, "", pair); gsub(/ /, "", first)
         point[set + 1, pair] = first }
      if ($0 ~ /^END/) set++
      next
   }
   FILENAME == ARGV[2] { if ($4 == "POINT") { x[$1, $3, $5] = $6; y[$1, $3, $5] = $7 } ; next }
   /class="set"/ { number = value($0, "data-set"); scale = value($0, "data-scale"); t = value($0, "data-t")
      dx = value($0, "data-x"); dy = value($0, "data-y"); split(value($0, "data-origin"), origin, " ") }
   /class="joint"/ {
      found++
      key = number SUBSEP t SUBSEP point[number, value($0, "data-pair")]
      if (!(key in x)) { print "no row: " $0; next }
      if (x[key] == "") { found--; next }
      a = dx + scale*(x[key] - origin[1]) - value($0, "cx")
      b = dy - scale*(y[key] - origin[2]) - value($0, "cy")
      if (a*a + b*b > 0.0001) print "set " number ": " $0 " is off by " a ", " b
   }
   END { print found + 0 }' "$1" "$2" "$3"; }

for deck in input/*.deck; do
   name=$(basename "$deck" .deck)
   sed -e '/^PRINT/d' -e 's/^END.*/PRINT   ALL\n&/' "$deck" > "$w/$name.deck"
   "$kinmat" "$deck" --svg "$w/$name.svg" > "$w/$name.lst" 2> "$w/$name.err"
   same "$name: the listing is as it was" "expected/$name.lst" "$w/$name.lst"
   equal "$name: well-formed" '' "$(tags "$w/$name.svg")"
   equal "$name: a picture of each set" "$(grep -c '^END' "$deck")" "$(grep -c '<g class="set"' "$w/$name.svg")"
   equal "$name: neither script nor reference" '' "$(grep -nE '<script|href|url[(]|<image|on[a-z]+=' "$w/$name.svg")"
   equal "$name: numbers" '' "$(grep -niE '[" ,](nan|inf)|[*]{3}' "$w/$name.svg" | grep -v '<style\|{')"
   equal "$name: flagged instants in words" "$(grep -c ' \*\*\* ' "expected/$name.lst" | awk '{ print ($1 > 0) }')" \
      "$(grep -c 'class="flag"' "$w/$name.svg" | awk '{ print ($1 > 0) }')"
   "$kinmat" "$w/$name.deck" --svg "$w/$name.all.svg" --csv "$w/$name.csv" > "$w/$name.lst" 2> "$w/$name.err"
   for svg in "$w/$name.svg" "$w/$name.all.svg"; do
      equal "$svg: joints, and how many" "$(grep -c '^REVOLUTE' "$deck")" "$(joints "$w/$name.deck" "$w/$name.csv" "$svg")"
      equal "$svg: blocks on guides" "$(grep -c '^PRISM' "$deck")" "$(grep -c 'class="block"' "$svg")"
   done
done

# What has no position is not drawn: of this four-bar the crank alone.
sed -e '/^END/q' -e 's/^\(POINT   B-RO    ROCKER  \).*/\1        0.1/' input/four_bar.deck > "$w/none.deck"
"$kinmat" "$w/none.deck" --svg "$w/none.svg" > "$w/out" 2> "$w/err"
equal 'no position: status' 2 $?
equal 'no position: well-formed' '' "$(tags "$w/none.svg")"
equal 'no position: the words' yes "$(grep -q 'class="flag".*NO POSITION FOUND' "$w/none.svg" && echo yes)"
equal 'no position: the crank alone' 1 "$(grep -cE 'class="(bar|body)"' "$w/none.svg")"

# A name that PRINT asks for stands before a shorter one, at one place.
sed -e '/^END/q' -e '/^PRINT/d' input/crank_slider.deck | sed 's/^END/PRINT   POINTS  A-ROD\n&/' > "$w/printed.deck"
"$kinmat" "$w/printed.deck" --svg "$w/printed.svg" > "$w/out" 2> "$w/err"
equal 'the printed name' 'A-ROD' "$(sed -n 's/.*class="name">\(A-[CR][A-Z]*\)<.*/\1/p' "$w/printed.svg")"

# Five flagged instants, one by one: three are drawn, and all are counted.
sed -e 's/^TIME.*/TIME    90                      0.0             90.0/' input/parallelogram_at.deck > "$w/many.deck"
"$kinmat" "$w/many.deck" --svg "$w/many.svg" > "$w/out" 2> "$w/err"
equal 'flagged instants drawn' 3 "$(grep -c '<g class="flagged"' "$w/many.svg")"
equal 'flagged instants in all' "$(grep -c ' \*\*\* ' "$w/out")" "$(sed -n 's/.*>FLAGGED INSTANTS IN ALL: \([0-9]*\)<.*/\1/p' "$w/many.svg")"

# A title and names that XML does not take as they are.
sed -e '/^END/q' -e 's/^TITLE.*/TITLE   A < B \& "C"/' input/four_bar.deck > "$w/title.deck"
"$kinmat" "$w/title.deck" --svg "$w/title.svg" > "$w/out" 2> "$w/err"
equal 'a title with characters of XML' '' "$(tags "$w/title.svg")"
equal 'a title with characters of XML: text' 2 "$(grep -c 'A &lt; B &amp; &quot;C&quot;' "$w/title.svg")"

# The words of the command.
refused() { expected=$2; want=$3; name=$1; shift 3; "$kinmat" "$@" > "$w/out" 2> "$w/err"
   equal "$name: status" "$expected" $?; equal "$name: sentence" "$want" "$(cat "$w/err")"; equal "$name: no listing" '' "$(cat "$w/out")"; }
cp input/four_bar.deck "$w/own.deck"
refused '--svg without a file' 1 ' *** OPTION --svg NEEDS A FILE NAME' "$w/own.deck" --svg
refused '--svg twice' 1 ' *** OPTION --svg IS GIVEN TWICE' "$w/own.deck" --svg "$w/a" --svg "$w/b"
refused '--svg and --check' 1 ' *** OPTION --check COMPUTES NO MOTION, WHICH --svg NEEDS' "$w/own.deck" --svg "$w/a" --check
refused '--svg and --study' 1 ' *** OPTION --study GOES WITH NO OTHER OPTION BUT -o' "$w/own.deck" --svg "$w/a" --study
refused '--svg to the file of the CSV' 1 ' *** ONE FILE IS NAMED FOR TWO OUTPUTS' "$w/own.deck" --csv "$w/a" --svg "$w/./a"
refused '--svg to the file of the listing' 1 ' *** ONE FILE IS NAMED FOR TWO OUTPUTS' "$w/own.deck" -o "$w/a" --svg "$w/a"
refused '--svg to the deck' 1 " *** THE DECK $w/own.deck WOULD BE OVERWRITTEN" "$w/own.deck" --svg "$w/own.deck"
same '--svg to the deck: it is as it was' input/four_bar.deck "$w/own.deck"
refused '--svg to a file that cannot be' 3 ' *** FILE /nonexistent/x CANNOT BE OPENED FOR WRITING (NO SUCH FILE OR DIRECTORY)' \
   "$w/own.deck" --svg /nonexistent/x
equal 'no file is made by what is refused' '' "$(ls "$w/a" 2> /dev/null)"
if [ -w /dev/full ]; then
   "$kinmat" "$w/own.deck" --svg /dev/full > "$w/out" 2> "$w/err"
   equal '--svg, disk full: status' 3 $?
   equal '--svg, disk full: sentence' ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)' "$(cat "$w/err")"
fi
# More shares than sets: a picture of nothing is still one.
"$kinmat" "$w/own.deck" --sets 1/9 --svg "$w/share.svg" > "$w/out" 2> "$w/err"
equal 'a share without sets' '' "$(tags "$w/share.svg")"
equal 'a share without sets: none' 0 "$(grep -c '<g class="set"' "$w/share.svg")"
conclude
