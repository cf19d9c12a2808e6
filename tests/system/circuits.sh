#!/bin/sh
# The card CIRCUITS: circuits, branches and ranges of four-bars and crank-sliders by Grashof's condition and the law of
# cosines, to ten digits; change points; what has no circuits.
. tests/counting.sh

# circuits: the lines of the answer for $w/deck, which is run once
circuits() {
   cmp -s "$w/deck" "$w/run.deck" || { cp "$w/deck" "$w/run.deck"; "$kinmat" "$w/deck" > "$w/run.lst" 2>&1; }
   awk '/^ (CIRCUITS AND|OBWODY I) / { on = 1 } /^ (CONTINUATION|KONTYNUACJA|LARGEST )/ && on { exit } on && NF > 0' "$w/run.lst"
}
# limits: the same, its ranges as MIN, number, unit, MAX, number, unit
limits() { circuits | awk '/ RANGE OF / { unit = $NF } { sub(/ [-0-9.]+ [.][.] [-0-9.]+/, " MIN& " unit); sub(/ [.][.] /, " " unit " MAX "); sub(/   M(IN|AX): .*/, "") } 1'; }
# found NAME EXPECTED: these lines
found() { equal "$1" "$2" "$(circuits)"; }

# four_bar, as still_four_bar: with CIRCUITS
four_bar() { still_four_bar "$@" CIRCUITS; }
# heading SUBJECT UNIT
heading() { echo " CIRCUIT BRANCH  ASSEMBLY NO.  RANGE OF ANGLE $1, ${2:-DEG}"; }
turns='TURNS FULLY, CLOSES AFTER 1 TURN'

# Grashof: 1 + 4 < 3.5 + 3, the shortest link turns fully, in either of two circuits.
four_bar 1.0 3.5 3.0 4.0 CRANK 0.0 55.0 110.0 0.0 > "$w/deck"
found 'a crank' " CIRCUITS AND BRANCHES, DRIVE ANGLE CRANK
$(heading CRANK)
 1       1       1             $turns
 2       2       2             $turns"

# 1.5 + 4 > 2 + 3: no link turns fully, and there is one circuit; in Polish.
four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0 | sed "s/^CIRCUITS/&\n$(card LANG PL)/" > "$w/deck"
found 'a triple rocker, in Polish' " OBWODY I GALEZIE, NAPED ANGLE CRANK
 OBWOD   GALAZ   MONTAZ NR     ZAKRES ANGLE CRANK, DEG
 1       1       2             -$(limit "$(angle 2 4 4.5)") .. $(limit "$(angle 2 4 4.5)")
 1       2       1             -$(limit "$(angle 2 4 4.5)") .. $(limit "$(angle 2 4 4.5)")
 PUNKTY MARTWE
   GALEZIE 1 I 2 SPOTYKAJA SIE PRZY $(limit "$(angle 2 4 4.5)") DEG, OGNIWA COUPLER, ROCKER NA KRESIE RUCHU, WSPOLLINIOWE
   GALEZIE 1 I 2 SPOTYKAJA SIE PRZY -$(limit "$(angle 2 4 4.5)") DEG, OGNIWA COUPLER, ROCKER NA KRESIE RUCHU, WSPOLLINIOWE"

# A parallelogram and its antiparallelogram meet, also where the first instant is the change point.
for deck in parallelogram parallelogram_at; do
   with $deck "$(card CIRCUITS)" > "$w/deck"
   equal "$deck" "$(printf '1 1\n2 2')" "$(circuits | awk '/CLOSES AFTER 1 TURN$/ { print $1, $2 }')"
   equal "$deck: change points" '   CIRCUITS 1 AND 2 MEET AT 0.00000 DEG
   CIRCUITS 1 AND 2 MEET AT 180.000 DEG' "$(circuits | awk '/^   CIRCUIT/' | sort)"
done

# A kite whose crank is as long as the base: a circuit on which it rests.
four_bar 4.0 2.0 2.0 4.0 CRANK 30.0 -20.0 -110.0 30.0 > "$w/deck"
equal 'a drive at rest' ' 2       3                     AT REST 0.000000000 DEG' "$(circuits | grep 'AT REST')"

# Two bars of one length, driven by the height of the joint between them: both are singular where they are in line, so that the
# circuits meet at their dead points. Also where the first instant is there.
bars() {
   card UNITS M DEG S; card GROUND G; card LINK A; card LINK B; card LINK SL; card JOINT O G A 0.0 0.0
   card JOINT M A B "$1" "$2"; card JOINT W SL B "$3" 0.0; card POINT Z G; card PRISM Z W WAY
   card DRIVE Y M '' 0.05; card AT '' '' '' 0.0; card CIRCUITS; card END
}
for place in '0.8 0.6 1.6' '0.0 1.0 0.0'; do
   bars $place > "$w/deck"
   equal "two dead points at one height: $place" '1 1 2 2, 1 2 3 4, -1.000000000 .. 1.000000000' "$(circuits | awk '/ [.][.] / {
      circuits = circuits " " $1; assembly[$3]; range = $4 " " $5 " " $6 }
      END { sub(/ /, "", circuits); printf "%s,", circuits; for (i = 1; i in assembly; i++) printf " %d", i; print ", " range }')"
done

# Dyads at their limits together. rows DECK LINES: of each table the range, one for all branches, by the law of cosines for
# the dyads; branches, circuits, and assemblies, each of which is on a branch of its own.
rows() {
   with "$1" "$(card CIRCUITS)" "$(card ASSEMBLY)" > "$w/$1.deck"
   "$kinmat" "$w/$1.deck" > "$w/$1.lst" 2>&1
   equal "dyads at one limit: $1" "$2" "$(awk '
      / RANGE OF / { t++ }
      /^ [0-9]+ +[0-9]+ .* [.][.] / {
         rows[t]++; circuits[t] += !seen[t, 1, $1]++; assemblies[t] += !seen[t, 3, $3]++
         if (!seen[t, 0, $4, $6]++) range[t] = range[t] $4 " .. " $6
      }
      END { for (i = 1; i <= t; i++) print range[i], rows[i], circuits[i], assemblies[i] }' "$w/$1.lst")"
}
arccosine() { awk -v x="$1" 'BEGIN { printf "%.12f", 360/atan2(0, -1)*atan2(sqrt(1 - x^2), x) }'; }
end=$(limit "$(arccosine 0.4)")
rows hart "-$end .. $end 4 2 4"
end=$(limit "$(arccosine 0.75)")
rows peaucellier "-$end .. $end 4 2 4"
# Arm and rod, 1 each, reach 2: the place of the other drive is 0.4 + 0.25 sin 0.5 or 1.2, and 0.75 or 1 in the second set.
rows pantograph "$(for place in "$(awk 'BEGIN { printf "%.15f", 0.4 + 0.25*sin(0.5) }')" 1.2 0.75 1.0; do
   end=$(limit "$(awk -v y="$place" 'BEGIN { printf "%.15f", sqrt(4 - y^2) }')")
   echo "-$end .. $end 4 2 4"
done)"
# Three stages and the platform, each assembled in two ways; all bars are in line at both ends.
rows scissor '-2.000000000 .. 2.000000000 16 8 16'

# The assembly in which the run begins has a row in every table of circuits; the decks left out take seconds.
for deck in $(cd input && ls ./*.deck | sed 's/^..//; s/[.]deck$//' | grep -vE '^(excavator|ten_plates|jansen|andrews)$'); do
   [ -e "$w/$deck.lst" ] || { with "$deck" "$(card CIRCUITS)" "$(card ASSEMBLY)" > "$w/deck"; "$kinmat" "$w/deck" > "$w/$deck.lst" 2>&1; }
   awk -v deck="$deck" '
      /^ SET OF COMPUTATIONS/ { own = 0; parts = 0 }
      /^ ASSEMBLIES/ { parts++ }
      /^ ASSEMBLY [0-9].* CHOSEN/ { own = $2 }
      # Several independent mechanisms have an assembly each.
      /^ CIRCUITS AND/ { wait = parts == 1 ? own : 0 }
      /REDUNDANT EQUATIONS/ { wait = 0 }
      wait && /^ [0-9]+ +[0-9]+ +[0-9]/ { n = split(substr($0, 17, 14), number, /[ ,]+/); for (i = 1; i <= n; i++) if (number[i] == own) { wait = 0; print "own" } }
      /^ (DEAD POINTS|CHANGE POINTS|CONTINUATION)/ && wait { print deck; wait = 0 }' "$w/$deck.lst"
done > "$w/own"
equal 'no table without the own row' '' "$(grep -v '^own$' "$w/own")"
equal 'tables with the own row' yes "$([ "$(grep -c '^own$' "$w/own")" -ge 60 ] && echo yes)"

# The five-bar has a table for each drive that moves.
with five_bar "$(card CIRCUITS)" > "$w/deck"
equal 'two drives' ' CIRCUITS AND BRANCHES, DRIVE ANGLE LEFT
 CIRCUITS AND BRANCHES, DRIVE RELANGLE LEFT RIGHT' "$(circuits | grep DRIVE)"

# A slide as the drive; both senses of the cylinder close, as assemblies do.
with cylinder "$(card CIRCUITS)" > "$w/deck"
equal 'a cylinder' 'MIN 0.5882158401 M MAX 3.427499398 M
MIN -3.427499398 M MAX -0.5882158401 M' "$(limits | awk '/MIN/ { sub(/.*MIN/, "MIN"); $1 = $1; print }' | uniq)"

# Redundant equations are refused.
with parallel_cranks "$(card CIRCUITS)" > "$w/deck"
found 'redundant equations' ' CIRCUITS AND BRANCHES, DRIVE ANGLE CRANK-1
 *** REDUNDANT EQUATIONS: CIRCUITS ARE NOT FOLLOWED'

# Published limits of linkages whose driven link rocks, in degrees from the place drawn (PMKS-Web): Stephenson III goes from -58
# to 41 in steps of 1, and no step farther (MATLAB, PMKS_Verification, case stephenson_iii_example_2), its Watt I from -5 to 5;
# an eight-bar with one block of six links goes through more than a turn, from -435.1 to 8.9 (PMKSWeb, wideSwingRockerFixture).
# linkage JOINTS: as drawn, each joint with its links and its place; the second link of the first joint is driven
linkage() {
   card UNITS M DEG S; card GROUND BASE
   echo "$1" | tr ';' '\n' | awk '{ for (i = 2; i < 4; i++) if ($i != "BASE" && !seen[$i]++) printf "%-8s%s\n", "LINK", $i }'
   echo "$1" | tr ';' '\n' | awk '{ printf "%-8s%-8s%-8s%-8s%-16s%s\n", "JOINT", $1, $2, $3, $4, $5 }'
   card DRIVE ANGLE "$(echo "$1" | awk '{ print $3; exit }')"; card AT '' '' '' 0.0; card CIRCUITS; card END
}
# swing FORMAT LESS: the limits of the branch with assembly 1, that which is drawn, less so many degrees
swing() {
   limits | awk -v format="$1 $1" -v less="$2" '/ MIN / { has = 0; for (i = 3; $i != "MIN"; i++) has = has || $i == 1
      if (has) printf format, $(i + 1) - less, $(i + 4) - less }'
}
linkage 'A BASE AB 7.0 4.0;B AB BCE 5.0 16.0;C BCE CD 25.0 25.0;D CD BASE 23.0 10.0;E BCE EF 18.0 35.0;F EF FG 43.0 32.0;G FG BASE 45.0 17.0' > "$w/deck"
equal 'Stephenson III, published' '-58 41' "$(swing %d 0)"
linkage 'A BASE AB -3.74 -2.41;B AB BCD -2.72 0.91;C BCD CFG 1.58 0.43;D BCD DE -0.24 4.01;E DE EF 5.08 5.31;F EF CFG 8.14 3.35;G CFG BASE 7.32 -3.51' > "$w/deck"
equal 'Watt I, published' '-5 5' "$(swing %d 0)"
linkage 'A BASE ACD -0.154 0.528;B BASE BFJ 6.17 0.0;C ACD CE 0.97 2.123;D ACD DHI 0.841 0.28;E CE EFG 2.641 3.107;F EFG BFJ 6.17 3.107;G EFG GH 4.665 2.031;H DHI GH 3.141 1.303;I DHI IJ 3.954 -0.407;J BFJ IJ 3.881 1.886' > "$w/deck"
equal 'an eight-bar, published, a turn farther' '-435.1 8.9' "$(swing %.1f 360)"

# Watt II, whose limits are those of two four-bars one behind the other, by the law of cosines; the lengths are those of a position
# analysis over a whole turn (D. Ziolkowski, Watt Type II sixbar linkage, MATLAB): crank 70, coupler 100, rocker 90, base 110;
# 150 from the rocker's pivot 30 degrees behind, 120, 160, and 150 from the crank's pivot to the other. The crank turns fully: 70 +
# 110 < 100 + 90. The rocker then swings between the two positions with crank and coupler in line, and the last link, which could
# turn fully by itself, between its angles there.
crank='A BASE AB 0.0 0.0'
last='F BASE FG 140.953893118 -51.303021499'
others='B AB BC 70.0 0.0;C BC CDE 113.75 89.921841062;D CDE BASE 110.0 0.0;E CDE EG 190.347526325 126.665997858;G EG FG 272.743118176 39.425144793'
linkage "$crank;$others;$last" > "$w/deck"
equal 'Watt II, a crank' 4 "$(circuits | grep -c 'CLOSES AFTER 1 TURN$')"
linkage "$last;$others;$crank" > "$w/deck"
limits=$(awk 'function root(x) { return sqrt(x) } function acos(x) { return atan2(root(1 - x*x), x) }
   # The angle of the last link where crank and coupler together reach so far; which side of its four-bar each dyad is on.
   function angle_at(reach, rocker, dyad,   t, ex, ey, dx, dy, l, x, y) {
      t = pi - rocker*acos((90^2 + 110^2 - reach^2)/(2*90*110)) - pi/6
      ex = 110 + 150*cos(t); ey = 150*sin(t); dx = fx - ex; dy = fy - ey; l = root(dx*dx + dy*dy)
      x = (l*l + 120^2 - 160^2)/(2*l); y = dyad*root(120^2 - x*x)
      return atan2(ey + (x*dy + y*dx)/l - fy, ex + (x*dx - y*dy)/l - fx)*180/pi - drawn }
   BEGIN { pi = 4*atan2(1, 1); fx = 150*cos(pi/9); fy = -150*sin(pi/9)
      drawn = atan2(39.425144793 - fy, 272.743118176 - fx)*180/pi
      for (rocker = -1; rocker < 2; rocker += 2) for (dyad = -1; dyad < 2; dyad += 2) for (reach = 30; reach < 200; reach += 140)
         printf "%.5f\n", (angle_at(reach, rocker, dyad) + 720) % 360 }' | sort -n | xargs)
equal 'Watt II, the last link' "$limits" "$(limits | awk '/ MIN / { for (i = 1; i <= NF; i++) if ($i == "MIN" || $i == "MAX")
   printf "%.5f\n", ($(i + 1) + 720) % 360 }' | sort -n | uniq | xargs)"
equal 'Watt II, its branches' '1 1 2 2 3 3 4 4' "$(limits | awk '/ MIN / { print $1 }' | xargs)"

# Two mechanisms, each with a crank that turns: the crank-rocker 1, 3.5, 3, 4 is one of Grashof's, and the crank 1.5 is
# shorter than its rod 4. Their assemblies are counted each by themselves.
both() {
   printf ' CIRCUITS AND BRANCHES, DRIVE ANGLE %s\n%s\n' "$1" "$(heading "$1" RAD)"
   printf ' 1       1       1             %s\n 2       2       2             %s\n' "$turns" "$turns"
}
with two_loops "$(card CIRCUITS)" > "$w/deck"
found 'independent mechanisms' "$(both CRANK-1; both CRANK-2)"
# A crank alone has nothing to be assembled.
{ card GROUND BASE; card LINK CRANK '' '' 0.0 0.0 10.0; card POINT A0 BASE; card POINT A0C CRANK; card REVOLUTE A0 A0C P
  card DRIVE ANGLE CRANK '' 10.0 36.0; card TIME 2 '' '' 0.0 2.0; card CIRCUITS; card END; } > "$w/deck"
equal 'no unknown' " 1       1       1             $turns" "$(circuits | sed '1,2d')"
# Sets of one deck: a triple rocker after them.
{ with two_loops "$(card CIRCUITS)"; four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0; } > "$w/deck"
equal 'several sets' '4 2' "$("$kinmat" "$w/deck" | awk '/ AFTER 1 TURN$/ { turn++ } / [.][.] / { limit++ } END { print turn, limit }')"

# Slides to infinity, where a guide comes to be parallel to another. On a crank at the angle p a block in a slot 0.3 beside the
# origin, and on the line x = 1: y = (sin p + 0.3)/cos p. One circuit on either side of the poles at -90 and 90, each followed until
# y is 100 lengths: 100 cos p -+ sin p = +-0.3.
poles=$(awk 'function acos(x) { return atan2(sqrt(1 - x*x), x) }
   BEGIN { far = sqrt(10001); phi = atan2(1, 100); degree = atan2(1, 1)/45
      printf "%#.10g %#.10g %#.10g %#.10g", (phi - acos(-0.3/far))/degree, (acos(0.3/far) - phi)/degree,
         (phi + acos(-0.3/far))/degree - 360, -(acos(0.3/far) + phi)/degree }')
tangent 0.3 0.0 90.0 "$(card AT '' '' '' 0.0)" CIRCUITS > "$w/deck"
equal 'a slide to infinity' "1 1 $(echo $poles | cut -d' ' -f1,2) 2 2 $(echo $poles | cut -d' ' -f3,4)" "$(limits |
   awk '/ MIN / { printf "%s%s %s ", sep, $1, $2 } / MIN / { for (i = 3; $i != "MIN"; i++); printf "%s %s", $(i + 1), $(i + 4); sep = " " }')"
# Where the first instant is beyond 100 lengths, its circuit is followed to twice as far.
tangent 0.0 89.9 90.0 "$(card AT '' '' '' 0.0)" CIRCUITS > "$w/deck"
far=$(awk 'BEGIN { d = atan2(1, 1)/45; t = sin(89.9*d)/cos(89.9*d); printf "%#.10g", atan2(2*t, 1)/d }')
equal 'an assembly far away' "1 -$far $far" "$(limits | awk '$3 == 1 { n = $3; x = $(NF - 1) } n && / MAX / { print n, $4 == "MIN" ? $5 : "", $(NF - 1); exit }')"

# A slotted rocker of a four-bar 1, 3.5, 3, 4 moves a ram on a guide at 110 degrees: its slide is infinite where the rocker is
# parallel to that, in one of the two assemblies of the four-bar twice a turn. Each assembly is on one circuit.
{ four_bar 1.0 3.5 3.0 4.0 CRANK 0.0 55.0 110.0 0.0 | grep -v '^\(AT\|CIRCUITS\|END\)'
  card LINK BLOCK; card LINK RAM; card POINT K ROCKER; card POINT KB BLOCK; card POINT G BASE '' 0.0 5.0; card POINT R1 RAM
  card REVOLUTE KB R1 PIN; card PRISM K KB SLOT; card PRISM G R1 GUIDE 110.0; card AT '' '' '' 0.0; card CIRCUITS; card END; } > "$w/deck"
equal 'a ram to infinity' '1 2' "$(limits | awk '/ (MIN|TURNS) / { for (i = 3; $i ~ /^[0-9]+$/; i++) print $i }' | sort -n | xargs)"
equal 'a ram to infinity: circuits' '3 0' "$(limits | awk '/ (MIN|TURNS) / { n++ } /NOT FOLLOWED/ { lost++ } END { print n, lost + 0 }')"
# Two slides at once, in a drawing of five links: never lost.
{ card UNITS M DEG S; card GROUND BASE; for i in 0 1 2 3 4; do card LINK L$i; done
  card JOINT J0 BASE L0 2.0 1.0; card JOINT J1 L0 L1 1.0 0.0; card JOINT J2 BASE L2 0.0 1.0; card POINT P3 L1 '' 3.0 3.0
  card POINT Q3 L3 '' 0.0 3.0; card PRISM P3 Q3 S3 180.0 0.0 0.0; card JOINT J4 L3 L4 3.0 3.0; card POINT P5 L0 '' 2.0 2.0
  card POINT Q5 L4 '' 1.0 3.0; card PRISM P5 Q5 S5 135.0 0.0 0.0; card POINT P6 L1 '' 2.0 2.0; card POINT Q6 L2 '' 2.0 3.0
  card PRISM P6 Q6 S6 90.0 0.0 0.0; card DRIVE ANGLE L0 '' 0.0 10.0; card AT '' '' '' 0.0; card CIRCUITS; card RANGE; card END; } > "$w/deck"
equal 'two slides to infinity' '0 8' "$(circuits | awk '/NOT FOLLOWED/ { lost++ } { n += gsub(/NO LIMIT FOUND/, "") } END { print lost + 0, n + 0 }')"
equal 'two slides to infinity: RANGE' 105.0000000 "$("$kinmat" "$w/deck" | awk '/^   MAX/ { print $2 }')"

# A parallelogram beside a four-bar on the same crank has its change points.
{ with parallelogram CIRCUITS | grep -v '^\(CIRCUITS\|END\)'; card LINK C9 '' '' 2.0; card LINK R9 '' '' 0.0 4.0
  card POINT P9 BASE '' 0.0 4.0; card POINT Q9 CRANK '' 2.0; card POINT S9 C9; card POINT T9 C9 '' 5.0; card POINT U9 R9
  card POINT V9 R9 '' 4.5; card REVOLUTE Q9 S9 X9; card REVOLUTE T9 V9 Y9; card REVOLUTE P9 U9 Z9; card CIRCUITS; card END; } > "$w/deck"
equal 'a parallelogram and a four-bar on one crank' '4 4' "$(circuits | awk '/ CLOSES AFTER / { n++ } /^   CIRCUITS / { meet++ } END { print n + 0, meet + 0 }')"

# No position.
four_bar 1.0 1.0 1.0 4.0 CRANK 0.0 0.0 0.0 0.0 > "$w/deck"
found 'no position anywhere' ' CIRCUITS AND BRANCHES, DRIVE ANGLE CRANK
   NONE'
# No position at the first instant, and a circuit elsewhere: the triple rocker beyond its limit.
four_bar 2.0 1.5 3.0 4.0 CRANK 120.0 20.0 105.0 120.0 > "$w/deck"
equal 'no position at the first instant' ' 1       1                     -90.89528299 .. 90.89528299
 1       2                     -90.89528299 .. 90.89528299' "$(circuits | grep ' [.][.] ')"
# Diagrams: of the coupler and the rocker of a parallelogram, each with two circuits that meet twice; of the crank itself none.
with parallelogram "$(card CIRCUITS)" > "$w/deck"
"$kinmat" --no-listing --circuits "$w/svg" "$w/deck"
equal 'diagrams' 2 "$(grep -c '<g class="circuits" data-drive="ANGLE CRANK">' "$w/svg")"
equal 'their circuits' '1 2 1 2' "$(sed -n 's/.*data-circuit="\([0-9]*\)".*/\1/p' "$w/svg" | xargs)"
equal 'their change points' 8 "$(grep -c 'class="change"' "$w/svg")"
equal 'as many ends as beginnings' "$(grep -cE '<(g|svg|text)[ >]' "$w/svg")" "$(grep -cE '</(g|svg|text)>' "$w/svg")"
equal 'numbers' '' "$(grep -niE '[" ,](nan|inf)|[*]{3}' "$w/svg" | grep -v '{')"
# A triple rocker has dots at both dead points, in the diagrams of its coupler and its rocker.
four_bar 2.0 1.5 3.0 4.0 CRANK 57.0 20.0 105.0 57.0 > "$w/deck"
"$kinmat" --circuits "$w/svg" "$w/deck" > "$w/listing"
equal 'dead points' 4 "$(grep -c 'class="dead"' "$w/svg")"
"$kinmat" "$w/deck" | cmp -s - "$w/listing"
equal 'the listing with diagrams' 0 $?
"$kinmat" --circuits "$w/svg" input/four_bar.deck > "$w/listing" 2>&1
equal 'no card: status' 1 $?
equal 'no card' ' *** OPTION --circuits NEEDS A SET WITH A CIRCUITS CARD' "$(cat "$w/listing")"
four_bar 1.0 1.0 1.0 4.0 CRANK 0.0 0.0 0.0 0.0 > "$w/deck"
sed 's/^CIRCUITS/&CRANK/' "$w/deck" |
   refused 'a field' 'E019 CARD 20 COLUMN 9 FIELD LABEL-A: "CRANK" IS IN A FIELD THAT THIS CARD DOES NOT USE'
# A hundred of Dixon's, for minutes: a signal ends them within seconds.
for k in $(seq 100); do with dixon "$(card CIRCUITS)"; done > "$w/deck"
timeout -k 15 1 env --default-signal=TERM "$kinmat" --jobs 1 -o "$w/listing" "$w/deck" > /dev/null 2>&1
equal 'a signal' 124 $?
conclude
