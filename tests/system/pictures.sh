#!/bin/sh
# Pictures and animations: of every deck of input/, well-formed XML, with the joints where the CSV has them; what is refused.
. tests/counting.sh

# tags FILE: what is wrong with its tags, characters, references and numbers
tags() { awk -v file="$1" '
   BEGIN { RS = "<" }
   { gsub(/\n/, " ") }
   /[^ -~]/ { print file ": not printable ASCII: <" $0 }
   /^(script|image)|href|url[(]|on[a-z]+=/ { print file ": a script or a reference: <" $0 }
   !/^style/ && (tolower($0) ~ /[" ,;(][-+]?(nan|inf)/ || /[*][*][*]/) { print file ": a number: <" $0 }
   NR == 1 { if (/[&>]/) print file ": text: " $0; next }
   {
      end = index($0, ">")
      between = substr($0, end + 1)
      tag = substr($0, 1, end - 1)
      if (!end) { print file ": not closed: " $0; next }
      if (between ~ /[&>]/) { gsub(/&(amp|lt|gt|quot);/, "", between); if (between ~ /[&>]/) print file ": text: " between }
      if (tag ~ /^[?]/) next
      name = tag
      sub(/[ \/].*/, "", name)
      if (tag ~ /^\//) {
         if (depth < 1 || open[depth] != substr(tag, 2)) print file ": closes " tag
         depth--
         next
      }
      rest = substr(tag, length(name) + 1)
      sub(/\/$/, "", rest)
      gsub(/ [a-zA-Z0-9-]+="[^"<]*"/, "", rest)
      if (rest != "") print file ": attributes: " tag
      if (depth == 0 && roots++) print file ": a second root"
      if (tag !~ /\/$/) open[++depth] = name
   }
   END { if (depth != 0 || roots != 1) print file ": " depth " open, " roots " roots" }' "$1"; }
# xml FILE: the same by xmllint, where that is installed
xml() { [ -z "$xmllint" ] || equal "$1: by xmllint" '' "$(xmllint --noout "$1" 2>&1)"; }
xmllint=$(command -v xmllint)
[ -n "$xmllint" ] || echo 'skipped: xmllint (not installed)'
printf '<svg><g a="1"><text>x &amp; y</text></svg>\n' > "$w/bad.svg"
equal 'a tag that is not closed is found' yes "$([ -n "$(tags "$w/bad.svg")" ] && echo yes)"
for bad in '<g a="-nan"/>' '<g a="1,Infinity"/>' '<g a="***"/>' '<a href="x"/>' '<g onload="x"/>' '<script/>' '<text>\t</text>'; do
   printf "<svg>$bad</svg>\n" > "$w/bad.svg"
   equal "a picture with $bad is found" yes "$([ -n "$(tags "$w/bad.svg")" ] && echo yes)"
done

# Awk: the value of an attribute of an element.
value='function value(line, name) { sub(".* " name "=\"", "", line); sub(/".*/, "", line); return line }'
# Awk: point[set, pair], the point of each joint, from a deck that is the first file.
points='
   function label(column,   text) { text = substr($0, column, 8); gsub(/ /, "", text); return text }
   FILENAME == ARGV[1] {
      if (/^REVOLUTE/) point[set + 1, label(25)] = label(9)
      if (/^JOINT/) point[set + 1, label(9)] = label(9)
      if (/^SLOT/) point[set + 1, label(25)] = label(17)
      if (/^END/) set++
      next
   }'
# joints DECK CSV SVG: the joints of the picture that are not where the CSV has their points; then how many there are, how many
# blocks on guides, and how many cylinders.
# A picture shows all links, those that no table asks for as well.
joints() { awk -F, "$value $points"'
   FILENAME == ARGV[2] { if ($4 == "POINT") { x[$1, $3, $5] = $6; y[$1, $3, $5] = $7 } ; next }
   { blocks += /class="block"/; barrels += /class="barrel"/ }
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
   END { print found + 0, blocks + 0, barrels + 0 }' "$1" "$2" "$3"; }

# moving DECK CSV SVG: the joints of the animation that are not where the CSV has their points at its instants, by the
# values of the animation's own lists; links that turn by half a turn at once; then how many joints and blocks there are, and
# whether there are instants.
moving() { awk -F, "$value $points"'
   function inner(line) { sub(/.*[(]/, "", line); sub(/[)].*/, "", line); return line }
   function joint(line,   i, k, f, c, s, a, b, key) {
      joints++
      for (i = 1; i <= instants[number]; i++) {
         f = end == start ? 0 : (time[number, i] - start)/(end - start)*(frames - 1)
         k = int(f + 0.5)
         if (f - k > 1e-6 || k - f > 1e-6 || k < 0 || k >= frames) continue
         key = number SUBSEP time[number, i] SUBSEP point[number, value(line, "data-pair")]
         if (x[key] == "") continue
         if (places < 2) k = 0
         split(place[k + 1], p, " ")
         c = cos(angle[k + 1]*atan2(0, -1)/180); s = sin(angle[k + 1]*atan2(0, -1)/180)
         a = p[1] + c*value(line, "cx") - s*value(line, "cy") - dx - scale*(x[key] - origin[1])
         b = p[2] + s*value(line, "cx") + c*value(line, "cy") - dy + scale*(y[key] - origin[2])
         checked++
         if (a*a + b*b > 0.01) { print "set " number " t " time[number, i] ": " line " is off by " a ", " b; return }
      }
   }
   FILENAME == ARGV[2] {
      if ($4 == "POINT") { x[$1, $3, $5] = $6; y[$1, $3, $5] = $7 }
      if ($4 == "POINT" && !(($1, $3) in seen)) { seen[$1, $3]; time[$1, ++instants[$1]] = $3 }
      next
   }
   /class="set"/ { number = value($0, "data-set"); scale = value($0, "data-scale"); start = value($0, "data-t")
      dx = value($0, "data-x"); dy = value($0, "data-y"); split(value($0, "data-origin"), origin, " ") }
   { blocks += /class="block"/ }
   /class="film"/ { frames = value($0, "data-frames"); end = value($0, "data-end") }
   /class="link"/ { place[1] = inner($0); places = 1 }
   /^<g transform="rotate/ { angle[1] = inner($0) }
   /^<animateTransform.*type="translate"/ { places = split(value($0, "values"), place, ";") }
   /^<animateTransform.*type="rotate"/ { n = split(value($0, "values"), angle, ";")
      for (k = 2; k <= n; k++) if (angle[k] - angle[k - 1] > 180 || angle[k] - angle[k - 1] < -180) print "set " number ": a jump" }
   /class="joint"/ { joint($0) }
   END { print joints + 0, blocks + 0, (checked > 0) }' "$1" "$2" "$3"; }

for deck in $(grep -L '^VARY' input/*.deck); do
   name=${deck#input/}
   name=${name%.deck}
   sed -e '/^PRINT/d' -e 's/^END.*/PRINT   ALL\n&/' "$deck" > "$w/$name.deck"
   # How many sets, joints, blocks on guides and cylinders the deck has; whether circuits are asked for.
   set -- $(awk '/^END/ { sets++ } /^(REVOLUTE|JOINT|SLOT)/ { joints++ } /^PRISM/ { blocks++ } /^CYLINDER/ { barrels++ } /^CIRCUITS/ { circuits = "circuits" }
      END { print sets + 0, joints + 0, blocks + 0, barrels + 0, circuits }' "$deck")
   "$kinmat" "$deck" --svg "$w/$name.svg" --animate "$w/$name.moving.svg" ${5:+--circuits "$w/$name.circuits.svg"} > "$w/$name.lst" 2> "$w/$name.err"
   same "$name: the listing is as it was" "expected/$name.lst" "$w/$name.lst"
   equal "$name: well-formed" '' "$(tags "$w/$name.svg")"
   xml "$w/$name.svg"
   equal "$name: a picture of each set, flagged instants in words" "$1 $(grep -q ' \*\*\* ' "expected/$name.lst" && echo flagged)" \
      "$(awk '/<g class="set"/ { sets++ } /class="flag"/ { flag = "flagged" } END { print sets, flag }' "$w/$name.svg")"
   "$kinmat" "$w/$name.deck" --no-listing --svg "$w/$name.all.svg" --csv "$w/$name.csv" 2> "$w/$name.err"
   for svg in "$w/$name.svg" "$w/$name.all.svg"; do
      equal "$svg: joints, and how many, with blocks on guides and cylinders" "$2 $3 $4" "$(joints "$w/$name.deck" "$w/$name.csv" "$svg")"
   done
   svg=$w/$name.moving.svg
   equal "$svg: well-formed" '' "$(tags "$svg")"
   xml "$svg"
   # Of a deck without joints nothing is compared.
   equal "$svg: joints in motion, blocks on guides" "$2 $3 $([ "$2" -gt 0 ] && echo 1 || echo 0)" \
      "$(moving "$w/$name.deck" "$w/$name.csv" "$svg")"
   equal "$svg: at most 2 MB" yes "$([ "$(wc -c < "$svg")" -le 2000000 ] && echo yes)"
done

# centrodes SVG: of each centrode its width in units of length, its lines, and whether it goes through the ring of its instant
# centre; of the first set.
centrodes() { awk "$value"'
   function away(x, y, a, b, c, d,   s) {
      s = (c - a)*(c - a) + (d - b)*(d - b)
      s = s > 0 ? ((x - a)*(c - a) + (y - b)*(d - b))/s : 0
      if (s < 0) s = 0
      if (s > 1) s = 1
      return sqrt((a + s*(c - a) - x)^2 + (b + s*(d - b) - y)^2)
   }
   /class="set"/ && sets++ { exit }
   /class="set"/ { scale = value($0, "data-scale") }
   /class="centrode"/ {
      own = value($0, "data-centrode") " " value($0, "data-link")
      if (own != before) { name[++g] = value($0, "data-centrode"); low[g] = 1e9; high[g] = -1e9; lines[g] = 0; points[g] = 0 }
      before = own
      lines[g]++
      n = split(value($0, "points"), place, " ")
      for (k = 1; k <= n; k++) {
         split(place[k], p, ",")
         if (p[1] < low[g]) low[g] = p[1]
         if (p[1] > high[g]) high[g] = p[1]
         x[g, ++points[g]] = p[1]; y[g, points[g]] = p[2]; first[g, points[g]] = (k == 1)
      }
   }
   /class="centre"/ { rings++; rx[rings] = value($0, "cx"); ry[rings] = value($0, "cy") }
   END { for (k = 1; k <= g; k++) {
      r = int((k + 1)/2); least = 1e9
      for (i = 2; i <= points[k]; i++) if (!first[k, i]) {
         d = away(rx[r], ry[r], x[k, i - 1], y[k, i - 1], x[k, i], y[k, i])
         if (d < least) least = d
      }
      printf "%s %.2f %d %s\n", name[k], (high[k] - low[k])/scale, lines[k], least < 0.5 ? "through" : "beside"
   } }' "$1"; }
# The circles of Cardan have the diameters 6 and 3: the bar turns once, its centre twice round the smaller one, drawn once.
# Those of the shoes, which are at infinity, are not there.
sed -e '/^POLE    BASE    SHOE/d' -e '/^POLE    SHOE/d' input/cardan.deck > "$w/cardan.deck"
"$kinmat" "$w/cardan.deck" --no-listing --svg "$w/cardan.svg"
equal "Cardan's circles" 'BASE-BAR 6.00 1 through
BASE-BAR 3.00 1 through' "$(centrodes "$w/cardan.svg")"
# Those of a coupler run twice to infinity: three lines each, in a window; those of crank and rocker are closed.
equal 'centrodes of a four-bar' '2 3 through
2 3 through
1 1 through
1 1 through' "$(centrodes "$w/poles.svg" | awk '{ print ($1 == "BASE-COUPLER") + 1, $3, $4 }')"
equal 'centrodes in a window' 6 "$(awk '/<svg x=/ { inside = 1 } /<.svg>/ { inside = 0 } inside' "$w/poles.svg" |
   grep -c 'class="centrode" data-centrode="BASE-COUPLER"')"
# A centrode that runs far away takes no room of the picture: its centre is a line. Without centrodes the ring remains.

cat > "$w/wishbone.deck" <<'DECK'
TITLE   DOUBLE WISHBONE
UNITS   MM      DEG     S
GROUND  BODY
LINK    UPPER
LINK    LOWER
LINK    UPRIGHT
JOINT   A       BODY    UPPER   420.0           510.0
JOINT   B       UPPER   UPRIGHT 650.0           540.0
JOINT   C       BODY    LOWER   340.0           220.0
JOINT   D       LOWER   UPRIGHT 690.0           195.0
POINT   PATCH   UPRIGHT         760.0           0.0
POINT   WHEEL   UPRIGHT         760.0           310.0
DRIVE   Y       WHEEL           310.0           20.0
TIME    4                       0.0             4.0
PRINT   POINTS  PATCH
POLE    BODY    UPRIGHT
END
DECK
"$kinmat" "$w/wishbone.deck" --no-listing --arrows --svg "$w/wishbone.svg" --table "$w/wishbone.csv" --animate "$w/moving.svg"
# By hand: the lines from (420, 510) to (650, 540) and from (340, 220) to (690, 195) meet there.
equal 'an instant centre outside' 'INSTANT CENTRE OUTSIDE: -1044.92, 318.923 (BODY-UPRIGHT)' \
   "$(sed -n 's/.*>\(INSTANT CENTRE OUTSIDE: .*\)<.*/\1/p' "$w/wishbone.svg")"
"$kinmat" input/poles.deck --no-listing --no-centrodes --svg "$w/rings.svg"
equal 'without centrodes' "0 $(grep -c 'class="centre"' "$w/poles.svg")" \
   "$(grep -c 'class="centrode"' "$w/rings.svg") $(grep -c 'class="centre"' "$w/rings.svg")"
equal 'an instant centre outside takes no room' yes "$(awk -F'"' '/class="set"/ { for (i = 1; i < NF; i++) if ($i ~ /data-scale=$/) print ($(i + 1) > 0.8 ? "yes" : "no") }' "$w/wishbone.svg")"
# An arrow has the length and direction of the velocity, in its scale; the caption has the value of the drive.
equal 'the arrow of a velocity' yes "$(awk -F, "$value"'
   FNR == NR { if (FNR == 2) { vx = $(NF - 3); vy = $(NF - 2) } ; next }
   /class="velocity"/ { scale = value($0, "data-scale"); on = 1 }
   on && /<polyline/ { split(value($0, "points"), from, "[ ,]") }
   on && /<polygon/ { split(value($0, "points"), tip, "[ ,]")
      x = (tip[1] - from[1])/scale - vx; y = (from[2] - tip[2])/scale - vy
      print (x*x + y*y < (0.02/scale)^2 ? "yes" : "no " x " " y); exit }' "$w/wishbone.csv" "$w/wishbone.svg")"
equal 'the bar of velocities is 20 below the bar of lengths' 20 "$(sed -nE 's/.*class="(scale|arrow)" points="[^,]*,([0-9.]*) .*/\1 \2/p' "$w/wishbone.svg" \
   | awk '{ level[$1] = $2 } END { print level["arrow"] - level["scale"] }')"
equal 'the caption' 'T = 0 S, Y WHEEL = 310 MM' "$(sed -n 's/.*class="time">\(T = .*\)<.*/\1/p' "$w/wishbone.svg")"
equal 'an animation has names and the value of the drive' '3 5 5' "$(grep -c 'class="link" style="fill' "$w/moving.svg") \
$(grep -cE '>[ABCD]<|>WHEEL<' "$w/moving.svg") $(grep -c 'T = .* S, Y WHEEL = .* MM<' "$w/moving.svg" | sed 's/^361$/5/')"
# A cylinder: nothing sticks out beyond a pin. The barrel begins at P and is shorter than the least length; faint too.
cat > "$w/gate.deck" <<'DECK'
TITLE   GATE
UNITS   M       DEG     S
GROUND  BASE
LINK    GATE
LINK    BARREL
LINK    ROD
JOINT   O       BASE    GATE    0.0             0.0
JOINT   F       BASE    BARREL  2.0             0.0
JOINT   E       ROD     GATE    1.2             1.6
CYLINDERF       E       CYL
DRIVE   SLIDE   CYL                             -0.1
TIME    4                       0.0             8.0
PRINT   PAIRS   CYL
END
DECK
"$kinmat" "$w/gate.deck" --no-listing --svg "$w/gate.svg" --table "$w/gate.csv"
# lengths CLASS: the lengths of the elements of a class in units of length: of a polygon its longest side
lengths() { awk -v class="$1" "$value"'
   /class="set"/ { scale = value($0, "data-scale") }
   $0 ~ "class=\"" class "\"" { n = split(value($0, "points"), p, "[ ,]"); most = 0
      for (i = 3; i < n; i += 2) { d = sqrt((p[i] - p[i - 2])^2 + (p[i + 1] - p[i - 1])^2); if (d > most) most = d }
      printf "%.3f\n", most/scale }' "$2"; }
least=$(awk -F, 'NR > 1 && (NR == 2 || $2 < least) { least = $2 } END { print least }' "$w/gate.csv")
for class in barrel piston; do
   equal "$class: shorter than the least length" yes "$(lengths $class "$w/gate.svg" |
      awk -v least="$least" '{ print ($1 > 0.8*least && $1 < least ? "yes" : "no " $1) }')"
done
equal 'faint positions show cylinders' yes "$(sed -n '/class="faint"/,/^<.g>/p' "$w/gate.svg" | grep -c 'polygon' |
   awk '{ print ($1 >= 2 ? "yes" : "no") }')"
# Twelve colours.
{ card UNITS M DEG S; card GROUND BASE; for i in 1 2 3 4 5 6 7 8 9 10 11 12; do card LINK L$i; done
   for i in 1 2 3 4 5 6 7 8 9 10 11 12; do card JOINT J$i BASE L$i $i.0; card POINT P$i L$i '' $i.0 1.0; card DRIVE ANGLE L$i '' '' 1.0; done
   card TIME 1 '' '' 0.0 1.0; card END; } > "$w/twelve.deck"
"$kinmat" "$w/twelve.deck" --no-listing --svg "$w/twelve.svg"
equal 'twelve colours' 12 "$(grep -o 'class="bar" style="stroke:[^"]*"' "$w/twelve.svg" | sort -u | wc -l)"
# Circuits that are equal in a diagram are dashed in turn; x before y.
cat > "$w/sewing.deck" <<'DECK'
UNITS   MM      DEG     S
GROUND  HEAD
LINK    SHAFT
LINK    ROD
LINK    NEEDLE
LINK    TAKEUP
LINK    GUIDE
JOINT   O       HEAD    SHAFT   0.0             0.0
JOINT   A       SHAFT   ROD     0.0             14.0
JOINT   N       NEEDLE  ROD     0.0             -32.0
POINT   TOP     HEAD
PRISM   TOP     N       BAR     90.0
JOINT   A2      SHAFT   TAKEUP  0.0             14.0
JOINT   B       TAKEUP  GUIDE   -20.0           26.0
JOINT   B0      GUIDE   HEAD    -22.0           6.0
POINT   EYE     TAKEUP          -40.0           60.0
DRIVE   ANGLE   SHAFT                           1200.0
TIME    12                      0.0             0.3
CIRCUITS
PRINT   POINTS  EYE
PRINT   PAIRS   BAR
END
DECK
"$kinmat" "$w/sewing.deck" --no-listing --circuits "$w/sewing.svg"
equal 'x before y' 'X EYE, MM Y EYE, MM BAR, MM' "$(sed -n 's/.*class="time">\([XYB].*\)<.*/\1/p' "$w/sewing.svg" | paste -s -d ' ')"
# A curve is drawn as often as it enters the window.
dashes() { grep -c "stroke-dasharray=\"9 9\" stroke-dashoffset=\"$1\"" "$w/sewing.svg"; }
equal 'each curve has dashes of its own' "$(grep -c '<polyline class="curve"' "$w/sewing.svg")" $(($(dashes 0) + $(dashes -9)))
equal 'dashes in turn' "$(dashes 0)" "$(dashes -9)"

# The drawing for CAD: each vertex of a path is the number of the table, rounded to 12 digits; layers; closed or open.
# Awk: the code of each group is in `code`, what it holds in the next line.
groups='{ sub(/\r$/, "") } FNR % 2 == 1 { code = $1 + 0; next }'
# vertices FILE LAYER: x and y of each, rounded
vertices() { awk -v layer="$2" "$groups"'
   code == 0 { if (on) printf "%.11e %.11e\n", x, y; on = 0; kind = $0 }
   code == 8 && kind == "VERTEX" && $0 == layer { on = 1 }
   code == 10 { x = $0 } code == 20 { y = $0 }' "$1"; }
# flags FILE LAYER: 1 for each closed line, 0 for each open one
flags() { awk -v layer="$2" "$groups"' code == 0 { kind = $0 } code == 8 { own = $0 }
   code == 70 && kind == "POLYLINE" && own == layer { print }' "$1"; }
# entities FILE: the numbers of entities by kind and layer
entities() { awk "$groups"' code == 0 { kind = $0 } code == 8 { print kind, $0 }' "$1" | sort | uniq -c | awk '{ print $2, $3, $1 }' | paste -s -d,; }
# of_table TABLE CLOSED: x and y of its points, one after another: the columns that have x and y and no phi
of_table() { awk -F, -v closed="$2" '
   NR == 1 { for (c = 1; c <= NF; c++) { name = $c; if (sub(/[.]x$/, "", name)) x[name] = c; name = $c; if (sub(/[.]phi$/, "", name)) angle[name] = 1 }
      for (name in x) if (!(name in angle)) list[x[name]] = 1; columns = NF; next }
   { for (c in list) { row[c, NR - 1] = sprintf("%.11e %.11e", $c, $(c + 1)) } ; rows = NR - 1 }
   END { for (c = 1; c <= columns; c++) if (c in list) for (k = 1; k <= rows - closed; k++) print row[c, k] }' "$1"; }
sed 's/^DRIVE.*/DRIVE   ANGLE   UPPER                           5.0/; s/^TIME .*/TIME    4                       0.0             4.0/' "$w/wishbone.deck" > "$w/two.deck"
{ sed -n '1,/^END/p' input/jansen.deck; cat "$w/two.deck"; } > "$w/cad.deck"
"$kinmat" "$w/cad.deck" --no-listing --dxf "$w/cad.dxf" --table "$w/cad.csv"
equal 'a drawing for CAD: status' 0 $?
for set in 1 2; do
   layer=$([ $set = 1 ] || echo 2-)PATHS
   of_table "$w/cad-$set.csv" "$(flags "$w/cad.dxf" $layer | head -n 1)" > "$w/of.table"
   vertices "$w/cad.dxf" $layer > "$w/of.dxf"
   equal "set $set: vertices as in the table" "$(wc -l < "$w/of.table") 0" "$(wc -l < "$w/of.dxf") $(cmp -s "$w/of.table" "$w/of.dxf"; echo $?)"
done
equal 'a motion that closes, and one that does not' '1 0' "$(flags "$w/cad.dxf" PATHS | sort -u) $(flags "$w/cad.dxf" 2-PATHS | sort -u)"
equal 'entities of the second set' 'CIRCLE 2-JOINTS 4,LINE 2-LINKS 6,POLYLINE 2-PATHS 1,SEQEND 2-PATHS 1,VERTEX 2-PATHS 5' \
   "$(entities "$w/cad.dxf" | tr , '\n' | grep ' 2-' | paste -s -d,)"
# Of the joints in the order of the deck, the first ones of Jansen's leg: the fixed pivot and the pin of the crank, 15 long, at the
# beginning, and the other fixed pivot, 38 beside the first and 7.8 below it.
equal 'circles at the joints' '0 0,15 0,-38 -7.8' "$(awk "$groups"' code == 0 { kind = $0 }
   kind == "CIRCLE" && code == 10 { x = $0 + 0 } kind == "CIRCLE" && code == 20 { if (!((x, $0 + 0) in seen)) print x, $0 + 0; seen[x, $0 + 0] = 1 }' "$w/cad.dxf" |
   sed -n '1,2p;4p' | paste -s -d,)"
# Instants of AT cards alone: no instant is a frame.
sed 's/^TIME .*/AT                              3.0             0.0             1.0/' "$w/two.deck" > "$w/at.deck"
"$kinmat" "$w/at.deck" --no-listing --dxf "$w/at.dxf" --table "$w/at.csv"
equal 'a set of AT cards alone: status' 0 $?
equal 'a set of AT cards alone: vertices as in the table' "3 $(of_table "$w/at.csv" 0)" \
   "$(vertices "$w/at.dxf" PATHS | wc -l) $(vertices "$w/at.dxf" PATHS)"
equal 'it begins and ends' 'SECTION ENTITIES ENDSEC EOF' "$(awk 'NR == 2 || NR == 4' "$w/cad.dxf" | paste -s -d ' ') $(tail -n 4 "$w/cad.dxf" | awk 'NR % 2 == 0' | paste -s -d ' ')"
if python3 -c 'import ezdxf' 2> /dev/null; then
   equal 'ezdxf reads it' '2' "$(python3 -c 'import ezdxf, sys; print(len({e.dxf.layer for e in ezdxf.readfile(sys.argv[1]).modelspace() if e.dxftype() == "POLYLINE"}))' "$w/cad.dxf" 2>&1)"
else
   echo 'skipped: ezdxf (not installed)'
fi

# Coarse instants make no coarse centrodes.
sed -e '/^END/q' -e 's/^TIME.*/TIME    4                       0.0             12.0/' input/poles.deck > "$w/coarse.deck"
"$kinmat" "$w/coarse.deck" --no-listing --svg "$w/coarse.svg"
equal 'centrodes of coarse instants' "$(centrodes "$w/poles.svg" | cut -d' ' -f3-)" "$(centrodes "$w/coarse.svg" | cut -d' ' -f3-)"
equal 'no centrodes without POLE' 0 "$(grep -c 'class="centrode"' "$w/four_bar.svg")"

# What has no position is not drawn: of this four-bar the crank alone.
sed -e '/^END/q' -e 's/^\(POINT   B-RO    ROCKER  \).*/\1        0.1/' input/four_bar.deck > "$w/none.deck"
sed 's/^TIME.*/TIME    3                       0.0             1.0/; /^AT/d' "$w/none.deck" > "$w/nowhere.deck"
ends 'no position' 2 "$w/nowhere.deck" --svg "$w/none.svg"
equal 'no position: well-formed' '' "$(tags "$w/none.svg")"
equal 'no position: the words' yes "$(grep -q 'class="flag".*NO POSITION FOUND' "$w/none.svg" && echo yes)"
equal 'no position: the crank alone' 1 "$(grep -cE 'class="(bar|body)"' "$w/none.svg")"

# A name that PRINT asks for stands before a shorter one, at one place.
sed -e '/^END/q' -e '/^PRINT/d' input/crank_slider.deck | sed 's/^END/PRINT   POINTS  A-ROD\n&/' > "$w/printed.deck"
"$kinmat" "$w/printed.deck" --svg "$w/printed.svg" > "$w/out" 2> "$w/err"
equal 'the printed name' 'A-ROD' "$(sed -n 's/.*class="name">\(A-[CR][A-Z]*\)<.*/\1/p' "$w/printed.svg")"

# Five flagged instants: the first has its words, and all are counted.
sed -e 's/^TIME.*/TIME    90                      0.0             90.0/' input/parallelogram_at.deck > "$w/many.deck"
"$kinmat" "$w/many.deck" --svg "$w/many.svg" > "$w/out" 2> "$w/err"
equal 'the first flagged instant' 1 "$(grep -c 'class="flag">T = [0-9]*: CHANGE POINT' "$w/many.svg")"
equal 'flagged instants in all' "$(grep -c ' \*\*\* ' "$w/out")" "$(sed -n 's/.*; FLAGGED INSTANTS IN ALL: \([0-9]*\)<.*/\1/p' "$w/many.svg")"

# The animation: a joint out of place is found; five instants in red.
sed 's/class="joint"/& r="0"/; s/cx="0"/cx="9"/' "$w/jansen.moving.svg" > "$w/wrong.svg"
equal 'a joint out of place is found' yes "$(moving "$w/jansen.deck" "$w/jansen.csv" "$w/wrong.svg" | grep -q 'off by' && echo yes)"
"$kinmat" "$w/many.deck" --animate "$w/many.svg" > "$w/out" 2> "$w/err"
equal 'five times in red' 5 "$(grep -c 'class="time flag".*CHANGE POINT' "$w/many.svg")"
equal 'flagged instants in all' yes "$(grep -q '; FLAGGED INSTANTS IN ALL: 5<' "$w/many.svg" && echo yes)"
# film SVG: frames
film() { sed -n 's/.*class="film" data-frames="\([0-9]*\)".*/\1/p' "$1"; }
equal 'frames' '361 353' "$(film "$w/jansen.moving.svg") $(film "$w/excavator.moving.svg")"
# A whole turn and more from frame to frame: no positions between them. One instant: no motion. No position: pale.
sed -e '/^END/q' -e 's/^TIME.*/TIME    360                     0.0             9000.0/' input/jansen.deck > "$w/fast.deck"
"$kinmat" "$w/fast.deck" --animate "$w/fast.svg" > "$w/out" 2> "$w/err"
equal 'fast: by leaps' ' calcMode="discrete"' "$(grep -o ' calcMode="[a-z]*"' "$w/fast.svg" | sort -u)"
sed -e '/^END/q' -e '/^AT/d' -e 's/^TIME.*/AT                              2.5/' input/four_bar.deck > "$w/one.deck"
"$kinmat" "$w/one.deck" --animate "$w/one.svg" > "$w/out" 2> "$w/err"
equal 'one instant: well-formed' '' "$(tags "$w/one.svg")"
equal 'one instant: no motion' '1 0' "$(film "$w/one.svg") $(grep -c '<animate' "$w/one.svg")"
"$kinmat" "$w/none.deck" --animate "$w/none.svg" > "$w/out" 2> "$w/err"
equal 'no position: well-formed' '' "$(tags "$w/none.svg")"
equal 'no position: pale' yes "$(grep -q '<animate attributeName="opacity" calcMode="discrete".*[";]0.2[";]' "$w/none.svg" && echo yes)"

# A title and names that XML does not take as they are.
sed -e '/^END/q' -e 's/^TITLE.*/TITLE   A < B \& "C"/' input/four_bar.deck > "$w/title.deck"
"$kinmat" "$w/title.deck" --svg "$w/title.svg" > "$w/out" 2> "$w/err"
equal 'a title with characters of XML' '' "$(tags "$w/title.svg")"
equal 'a title with characters of XML: text' 2 "$(grep -c 'A &lt; B &amp; &quot;C&quot;' "$w/title.svg")"
{ card TITLE "'<&>" '"'; card UNITS '<&' DEG '"&>'; card GROUND "'BASE"; card LINK '<&'; card LINK 'C"O'; card LINK '>RO&LT;'
   card JOINT '&A0' "'BASE" '<&' 0.0 0.0; card JOINT '<A' '<&' 'C"O' 0.0 1.0; card JOINT "B'>" 'C"O' '>RO&LT;' 3.0 2.5
   card JOINT '"B0' '>RO&LT;' "'BASE" 4.0; card POINT '"<C&>"' 'C"O' '' 1.0 2.0; card DRIVE ANGLE '<&' '' '' 30.0
   card TIME 3 '' '' 0.0 1.0; card PRINT LINKS; card PRINT POINTS; card PRINT PAIRS; card POLE "'BASE" 'C"O'; card CURVE '"<C&>"'
   card CIRCUITS; card END; } > "$w/names.deck"
"$kinmat" "$w/names.deck" --svg "$w/names.svg" --animate "$w/names.moving.svg" --circuits "$w/names.circuits.svg" > "$w/out" 2> "$w/err"
equal 'names with characters of XML: status' 0 $?
for svg in "$w/names.svg" "$w/names.moving.svg" "$w/names.circuits.svg"; do
   equal "$svg: names with characters of XML" '' "$(tags "$svg")"
   xml "$svg"
done
equal 'names with characters of XML: text' yes "$(grep -q 'data-drive="ANGLE &lt;&amp;"' "$w/names.circuits.svg" &&
   grep -q 'data-link="&gt;RO&amp;LT;"' "$w/names.moving.svg" && grep -q '>&quot;&lt;C&amp;&gt;&quot;<' "$w/names.svg" && echo yes)"

cp input/four_bar.deck "$w/own.deck"
for option in --svg --animate --dxf; do
   rejected "$option without a file" 1 " *** OPTION $option NEEDS A FILE NAME" "$w/own.deck" $option
   rejected "$option and --check" 1 " *** OPTION --check COMPUTES NO MOTION, WHICH $option NEEDS" "$w/own.deck" $option "$w/a" --check
   rejected "$option and --study" 1 ' *** OPTION --study CAN ONLY BE COMBINED WITH -o AND --quiet' "$w/own.deck" $option "$w/a" --study
   equal "$option: no file is made by what is refused" '' "$(ls "$w/a" 2> /dev/null)"
   if [ -w /dev/full ]; then
      says "$option, disk full" 3 ' *** WRITING /dev/full FAILED (NO SPACE LEFT ON DEVICE)' \
         "$w/own.deck" $option /dev/full
   fi
   # More shares than sets: a picture of nothing is still one.
   "$kinmat" "$w/own.deck" --sets 1/9 $option "$w/share.svg" > "$w/out" 2> "$w/err"
   [ $option = --dxf ] && { equal 'a share without sets' 8 "$(wc -l < "$w/share.svg")"; continue; }
   equal "$option, a share without sets" '' "$(tags "$w/share.svg")"
   equal "$option, a share without sets: none" 0 "$(grep -c '<g class="set"' "$w/share.svg")"
done
# Beyond the digits of a picture's coordinates a support has no width: it has no hatch.
sed '/^POINT   C  /s/0\.0   /1.0E16/' input/yoke_mirrored.deck > "$w/far.deck"
ends 'a support very far away' 2 --quiet "$w/far.deck" --svg "$w/far.svg"
equal 'a support very far away' '' "$(tags "$w/far.svg"; grep -iE 'nan|infinity' "$w/far.svg")"
rejected '--svg and --animate to one file' 1 ' *** ONE FILE IS NAMED FOR TWO OUTPUTS' "$w/own.deck" --animate "$w/a" --svg "$w/a"
conclude
