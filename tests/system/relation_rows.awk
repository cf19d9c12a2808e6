# awk -v change=CHANGE -v is_close=COUNT -f relation_rows.awk MAP CSV CHANGED: rows of the results of a deck (CSV) and of the
# deck changed by relation_deck.awk (CHANGED, with its MAP) that differ by more than both tell of their errors, and rows flagged
# in one alone; rows and cells that one of them has and the other has not; a deck of which no number is compared. An error is
# known to a small factor only, and a row's numbers are rounded; an error that is not told is none. Of assemblies
# none is told: they are the same, and in the same order, to `of_assembly` of their numbers but for full turns. `is_close`: the
# listing of the deck changed says of a limit or change point that it is too close to tell.
BEGIN { FS = ","; factor = 30; rounding = 1e-14; of_assembly = 1e-11 }
function size(x) { return x < 0 ? -x : x }

# The number of the instant in the deck; that of an instant between two of TIME is no whole one. AT cards come after TIME.
function step_there() {
   if (change !~ /^[37]$/) return start[$1] + way[$1]*$2
   return $2 <= change*steps[$1] ? $2/change : $2 - (change - 1)*steps[$1]
}
# A row of the deck for which the deck changed has one.
function is_due(  k) {
   if ($4 ~ / ASSEMBLY / && change ~ /^(middle|back|beside)$/) return 0
   return way[$1]*($2 - start[$1]) >= 0
}
# The row at hand of a link whose axes are others: its own origin is not at (xi, eta, turn) of the old ones but there.
function to_old_axes(  key, phi, x, y, s, c, w, reach, e, ew) {
   key = $1 " " $5
   there[8] -= turn[key]; phi = there[8]*unit
   x = xi[key]*cos(phi) - eta[key]*sin(phi); y = xi[key]*sin(phi) + eta[key]*cos(phi)
   # A rounding of the angle moves what is so far away.
   reach = size(x) + size(y); e = there[18]*unit + 1e-16*(1 + size(phi))
   there[6] -= x; there[7] -= y; there[16] += reach*e; there[17] += reach*e
   if (!has[11]) return
   w = there[11]*unit; ew = there[21]*unit
   there[9] += w*y; there[10] -= w*x
   there[19] += reach*(ew + size(w)*e); there[20] += reach*(ew + size(w)*e)
   if (!has[14]) return
   there[12] += there[14]*unit*y + w*w*x; there[13] += w*w*y - there[14]*unit*x
   e = reach*(there[24]*unit + size(there[14]*unit)*e + 2*size(w)*ew + w*w*e)
   there[22] += e; there[23] += e
}
# The row at hand of an assembly has the errors that are allowed, and the full turns of the deck's.
function compare_assembly(  c, turns) {
   for (c = 6; c <= 8; c++) {
      if (!has[c]) continue
      there[c + 10] = a[c + 10] = of_assembly*(size(a[c]) + 1)/(2*factor)
      if (c == 8 || kind == "PAIR" && !(($1 " " $5) in slides)) {
         turns = (a[c] - there[c])*unit/(2*atan2(0, -1))
         there[c] += int(turns + (turns < 0 ? -0.5 : 0.5))*2*atan2(0, -1)/unit
      }
   }
}
# The row at hand as it would be in the deck: its columns `there`, and whether it `has` a number in them. (A field of the row that
# is assigned to, and a number that is compared with a text, are printed each time.)
function back_to_deck(  c, f) {
   for (c = 6; c <= 14; c++) {
      has[c] = $c != ""
      there[c] = $c; there[c + 10] = $(c + 10)
      if (!has[c] || change !~ /^(units|mirrored|moved)$/) continue
      f = 1
      if (change == "units") f = (kind == "PAIR" && !(($1 " " $5) in slides) || (c - 6) % 3 == 2 ? 1 : 25.4)/60^int((c - 6)/3)
      there[c] /= f; there[c + 10] = there[c + 10]/f
      # A relative angle is turned round, a slide is not.
      if (change == "mirrored" && (kind == "PAIR" ? !(($1 " " $5) in slides) : (c - 6) % 3 > 0)) there[c] = -there[c]
      if (change == "moved" && kind != "PAIR" && c < 8) there[c] -= c == 6 ? 3 : -2
   }
   if (change == "axes" && kind == "LINK" && has[6]) to_old_axes()
   if (change == "axes" && kind == "PAIR" && has[6]) there[6] -= pair_turn[$1 " " $5]
}

FILENAME != file { file = FILENAME; n_files++ }
n_files == 1 { split($0, f, " ") }
n_files == 1 && f[1] == "start" { start[f[2]] = f[3]; way[f[2]] = f[4] }
n_files == 1 && f[1] == "steps" { steps[f[2]] = f[3] }
n_files == 1 && f[1] == "link" { xi[f[2] " " f[3]] = f[4]; eta[f[2] " " f[3]] = f[5]; turn[f[2] " " f[3]] = f[6] }
n_files == 1 && f[1] == "pair" { pair_turn[f[2] " " f[3]] = f[4] }
n_files == 1 && f[1] == "slide" { slides[f[2] " " f[3]] = 1 }
n_files == 1 && f[1] == "degrees" { degrees[f[2]] = 1 }
n_files == 1 && f[1] == "matrix" { matrix[f[2]] = 1 }
n_files == 1 && f[1] == "closing" { closing[f[2]] = 1 }
n_files == 1 || /^set,/ { next }
n_files == 2 { if (is_due()) row[$1 "," $2 "," $4 "," $5] = $0; if ($15 == "NO-POSITION") lost[$1 " " $2] = 1; next }
{
   step = step_there()
   if (step != int(step) || change == "beside" && $5 ~ /^Q-/) next
   key = $1 "," step "," $4 "," $5
   if (!(key in row)) { print "one more: " key; next }
   split(row[key], a, ",")
   delete row[key]
   if (size(a[3] - $3/(change == "units" ? 60 : 1)) > 1e-9*size(a[3])) print "time: " key " " a[3] " " $3
   # Whether the iteration of METHOD MATRIX converges is a matter of steps and axes; and where others have no position, whether
   # a link is reached by links alone that drives move is one of the order of cards. Other axes round all coordinates anew: a
   # parallelogram far smaller than the links it joins is none from then on, and may not be told from one. In rounded
   # coordinates, whether equations still close near a change point is a matter of rounding.
   if (a[15] != $15 && a[15] $15 != "UNKNOWN") {
      if (($1 in closing) && a[15] $15 ~ /OPEN/) { excused = 1; next }
      if (!($1 in matrix || change == "turned" && ($1 " " $2) in lost || change == "axes" && is_close && $15 == "NO-POSITION")) \
         print "flag " key " " a[15] " " $15
      next
   }
   unit = ($1 in degrees) ? atan2(0, -1)/180 : 1
   kind = $4; sub(/ .*/, "", kind)
   back_to_deck()
   if ($4 ~ / ASSEMBLY /) compare_assembly()
   for (c = 6; c <= 14; c++) {
      if (!has[c] && a[c] == "") continue
      # A row may say that numbers have no digit. Those that differ from 0 by few times their error may have one.
      if ((!has[c] || a[c] == "") && !(a[15] $15 ~ /UNKNOWN/ && size(there[c] + a[c]) <= factor*(a[c + 10] + there[c + 10]))) \
         print "blank: " key " column " c ": " a[c] " " there[c]
      if (!has[c] || a[c] == "") continue
      numbers++
      if (size(there[c] - a[c]) > factor*(a[c + 10] + there[c + 10]) + rounding*(size(there[c]) + (change == "moved" && c < 8 ? 5 : 0))) \
         print key " column " c ": " a[c] " " there[c] " " a[c + 10] " " there[c + 10]
   }
}
END {
   for (key in row) print "missing: " key
   if (!numbers && !excused) print "no number is compared"
}
