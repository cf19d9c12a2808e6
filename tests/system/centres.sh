#!/bin/sh
# The cards POLE and CURVE: tables against closed forms in real128, by both methods; the theorems of Kennedy and of
# Euler and Savary, which know no velocities; the CSV. Other units: units.sh; errors: tests/unit/deck.
. tests/counting.sh

# cards DECK: poles of links that are joined and of some that are not, paths in the plane and in links that move
cards() {
   case $1 in
   five_bar) set -- BASE ROD-L LEFT RIGHT ROD-L ROD-R C E-ROD ;;
   crank_slider) set -- BASE ROD CRANK PISTON ROD PISTON B-ROD A-ROD ;;
   dixon) set -- BASE BAR-33 BAR-12 BAR-21 BAR-13 BAR-32 B3-33 A2-22 ;;
   *) set -- BASE COUPLER CRANK ROCKER COUPLER ROCKER B-CO A-CO ;;
   esac
   card POLE "$1" "$2"; card POLE "$3" "$4"; card POLE "$5" "$6" 3; card CURVE "$7"; card CURVE "$8" "$1" 2; card CURVE "$8" "$4"
}
# centres FILE: the tables of poles and curves, and the instants
centres() { awk '/^ (INSTANT|CHWILA|CONTINUATION:|KONTYNUACJA:)/ { on = 0; print } /^ (POLE|CURVE|BIEGUN|TOR)  +X/ { on = 1 } on' "$1"; }

# The same bytes as from closed forms. At the change points of the fourth deck there are no velocities.
for deck in four_bar five_bar dixon parallelogram_at crank_slider; do
   with $deck "$(cards $deck)" > "$w/$deck.deck"
   # The second set of this one, by METHOD MATRIX, has masked digits where the rod is at rest for a moment.
   [ $deck != crank_slider ] || sed -i '1,/^END/!d' "$w/$deck.deck"
   "$BUILD/release/print_expected" "$w/$deck.deck" > "$w/$deck.expected" 2>&1
   "$kinmat" "$w/$deck.deck" > "$w/$deck.listing" 2>&1
   same "$deck" "$w/$deck.expected" "$w/$deck.listing"
done
# By METHOD DENSE, which takes no redundant equations and passes no change points: those instants that it solves.
for deck in four_bar five_bar crank_slider parallelogram parallelogram_at; do
   with $deck "$(cards $deck)" | sed '/^END/q' > "$w/newton.deck"
   case $deck in parallelogram*) sed -i "s/^TIME.*/$(card TIME 6 '' '' 0.0 12.0)/" "$w/newton.deck" ;; esac
   "$kinmat" "$w/newton.deck" > "$w/listing" 2>&1
   centres "$w/listing" | grep -v '^ CONTINUATION' > "$w/newton"
   sed -e '/^METHOD/d' -e 's/^END/METHOD  DENSE\n&/' "$w/newton.deck" > "$w/dense.deck"
   "$kinmat" "$w/dense.deck" > "$w/listing" 2>&1
   centres "$w/listing" | grep -v '^ CONTINUATION' > "$w/dense"
   same "$deck, METHOD DENSE" "$w/newton" "$w/dense"
done
sed '/^END/q' input/poles.deck > "$w/first.deck"
"$kinmat" --no-listing --csv "$w/first.csv" "$w/first.deck"

# The crank-rocker 1, 3.5, 3 on the base 4, by geometry alone: Kennedy's theorem puts the centre of the coupler where the
# lines of crank and rocker meet, that of crank and rocker where the lines of base and coupler do. The inflection circle
# goes through the centre P and, on the lines PA and PB, through points whose distances from A and B are PA^2/A0A and
# PB^2/B0B; Euler and Savary's equation PX^2 = XXo XXw gives from it the centre of curvature Xo of C's path.
equal 'Kennedy; Euler and Savary' '86 numbers' "$(awk -F, '
   BEGIN { step = -1 }
   function meet(a, b, c, d, e, f, g, h,   t, D) {   # the lines (a, b) (c, d) and (e, f) (g, h)
      D = (c - a)*(h - f) - (d - b)*(g - e)
      t = ((e - a)*(h - f) - (f - b)*(g - e))/D
      X = a + t*(c - a); Y = b + t*(d - b)
   }
   function compare(k, wanted,   d) { n++; d = $k - wanted; if (d < 0) d = -d
      if (d > 1e-10*(1 + wanted*wanted)) print $2 " " $4 " " $5 ": " $k " is not " wanted }
   # The point W on the line from P to (x, y) with (X - W) (X - Xo) = PX^2, measured along the line.
   function inflection(x, y, xo, yo,   s) { s = ((x - px)^2 + (y - py)^2)/((x - xo)^2 + (y - yo)^2)
      WX = x + s*(xo - x); WY = y + s*(yo - y) }
   $1 != 1 || $2 == "step" { next }
   $2 != step {
      step = $2; deg = atan2(1, 1)/45
      ax = cos(30*step*deg); ay = sin(30*step*deg)
      r = sqrt((4 - ax)^2 + ay^2)
      u = (r*r + 3.5*3.5 - 9)/(2*r); v = sqrt(3.5*3.5 - u*u)
      ex = (4 - ax)/r; ey = -ay/r
      bx = ax + u*ex - v*ey; by = ay + u*ey + v*ex
      fx = (bx - ax)/3.5; fy = (by - ay)/3.5
      cx = ax + 1.75*fx - 1.25*fy; cy = ay + 1.75*fy + 1.25*fx
      # At 0 and 180 deg crank and base are one line: the centre is B0, and the pole of the two cranks A.
      if (step % 6 == 0) { px = 4; py = 0; qx = ax; qy = 0
         meet(0, 0, 4, 0, ax, ay, bx, by); qx = X; qy = Y }
      else { meet(0, 0, ax, ay, 4, 0, bx, by); px = X; py = Y; meet(0, 0, 4, 0, ax, ay, bx, by); qx = X; qy = Y }
   }
   $4 == "POLE" && $5 == "BASE COUPLER" { compare(6, px); compare(7, py) }
   $4 == "POLE-J" && $5 == "BASE COUPLER" { compare(6, (px - ax)*fx + (py - ay)*fy); compare(7, (py - ay)*fx - (px - ax)*fy) }
   $4 == "POLE" && $5 == "CRANK ROCKER" { compare(6, qx); compare(7, qy) }
   $4 == "CENTRE" && $5 == "C" && step % 6 != 0 {
      inflection(ax, ay, 0, 0); ix = WX; iy = WY
      inflection(bx, by, 4, 0); jx = WX; jy = WY
      # The circle through P, I and J: its centre has equal distances.
      D = 2*((ix - px)*(jy - py) - (iy - py)*(jx - px))
      s = (ix - px)^2 + (iy - py)^2; t = (jx - px)^2 + (jy - py)^2
      mx = ((jy - py)*s - (iy - py)*t)/D; my = ((ix - px)*t - (jx - px)*s)/D
      # The second point W of the circle on the line PC, and Xo from it.
      dx = cx - px; dy = cy - py
      k = 2*(mx*dx + my*dy)/(dx*dx + dy*dy)
      wx = px + k*dx; wy = py + k*dy
      s = ((cx - px)^2 + (cy - py)^2)/((cx - wx)^2 + (cy - wy)^2)
      compare(6, cx + s*(wx - cx)); compare(7, cy + s*(wy - cy))
   }
   END { print n " numbers" }' "$w/first.csv")"

# The listing has the numbers of the CSV, rounded. Rows of links, points and pairs are the same with the cards and without
# them, and so is the listing with --errors.
awk -F, 'FILENAME == ARGV[1] { if ($4 ~ /^(POLE|CURVE|CENTRE|RADIUS)/) { at = $2 " " $5
      if ($4 == "POLE") row[at] = sprintf("%.6f %.6f", $6, $7)
      if ($4 ~ /^POLE-/) row[at] = row[at] sprintf(" %.6f %.6f", $6, $7)
      if ($4 == "CURVE") row["c" at] = sprintf("%.6f %.6f %.6f", $6, $7, $8)
      if ($4 == "CENTRE") centre = sprintf(" %.6f %.6f", $6, $7)
      if ($4 == "RADIUS") row["c" at] = row["c" at] sprintf(" %.6f", $6) centre } ; next }
   /^ CONTINUATION/ { exit }
   /^ INSTANT/ { split($0, word, " "); step = word[2]; kind = "" }
   /^ (POLE|CURVE)  +X/ { kind = $0 ~ /POLE/ ? "p" : "c"; next }
   /^  / || /^$/ || kind == "" { next }
   { n = split($0, word, " "); text = ""; names = kind == "p" || n == 8 ? 2 : 1
     for (i = names + 1; i <= n; i++) text = text (i > names + 1 ? " " : "") word[i]
     key = (kind == "c" ? "c" : "") step " " word[1] (names == 2 ? " " word[2] : "")
     gsub(/-0[.]000000/, "0.000000", row[key])
     if (text != row[key]) print key ": " text " is not " row[key]; rows++ }
   END { print rows " rows" }' "$w/first.csv" expected/poles.lst > "$w/rows" 2>&1
equal 'the listing and the CSV' '40 rows' "$(cat "$w/rows")"
grep -v '^POLE\|^CURVE' input/poles.deck > "$w/without.deck"
"$kinmat" --quiet --no-listing --csv "$w/without.csv" "$w/without.deck"
"$kinmat" --no-listing --csv "$w/with.csv" input/poles.deck
grep -vE ',(POLE|POLE-I|POLE-J|CURVE|CENTRE|RADIUS),' "$w/with.csv" > "$w/others.csv"
same 'other rows of the CSV' "$w/without.csv" "$w/others.csv"
# The shoe A rests twice in 25 instants; the two shoes, asked for at seven of them, never do. Three rows each.
equal 'marks' 'AT-REST 6
INFINITE 90' "$("$kinmat" --no-listing --csv - input/cardan.deck | awk -F, 'NR > 1 && $15 != "" { n[$15]++ } END { for (m in n) print m, n[m] }' | sort)"

# Two mechanisms in one set: each has its poles by itself; one link of each is refused.
with two_loops "$(card POLE BASE COUPLER)" "$(card POLE PISTON BASE)" "$(card POLE CRANK-2 PISTON)" > "$w/two_loops.deck"
"$BUILD/release/print_expected" "$w/two_loops.deck" > "$w/expected" 2>&1
"$kinmat" "$w/two_loops.deck" > "$w/listing" 2>&1
same 'two mechanisms' "$w/expected" "$w/listing"

conclude
