# awk -v change=CHANGE [-v csv=FILE -v lst=FILE] -v map=FILE -f relation_deck.awk DECK: the deck, changed. CHANGE is
#    whole      all results are asked for, in English: to this deck come the others. A JOINT card becomes two POINT cards and a
#               REVOLUTE card, numbers that are as drawn are typed in, and a CYLINDER card becomes a PRISM card. Not so in a
#               drawing that only JOINT cards can give: with LENGTH cards, axes FROM and TO or strokes. It stays what it is.
#    3, 7       so many times the steps
#    turned     the cards of each set in the opposite order
#    moved      by (3, -2)
#    mirrored   in the x axis
#    units      lengths times 25.4, times times 60
#    axes       each link has another reference point, and axes that are turned
#    beside     a four-bar linkage of another size and speed is in each set
#    middle     begun in the middle: with the second half of the instants, from the positions at the first of these
#    back       with the instants in the opposite order, from the positions at the last one
# The last three take what they need from `csv`, results of the deck, and from `lst`, its listing; they have no ASSEMBLY card,
# since other assemblies are there. In a drawing the last two have AT cards for all instants. No change has CIRCUITS cards.
# `map` says what one must know to compare results: "start SET STEP WAY", the instant of the deck with which the changed one
# begins, and 1 or -1; "steps SET STEPS" of TIME; "link SET NAME XI ETA PHI", the new axes of a link in the old ones; "pair SET
# NAME PHI", by how much its angle is larger; "slide SET NAME", a prismatic pair; "degrees SET", "matrix SET", "closing SET", a
# set in degrees, by METHOD MATRIX, with a closing tolerance. The numbers of a card and of its * card go to one * card.

function trim(s) { gsub(/^ +| +$/, "", s); return s }
# A number as text, its exponent D as E.
function value(s) { s = toupper(trim(s)); sub(/D/, "E", s); return s + 0 }
function number(k,  x) {
   x = value(star == "" ? "" : substr(star, 24*k - 15, 24))
   return x == 0 ? value(substr(card, 16*k + 17, 16)) : x
}
function is_given(k) { return trim(substr(card, 16*k + 17, 16) (star == "" ? "" : substr(star, 24*k - 15, 24))) != "" }

# What belongs to a card stays below it.
function put(text) {
   # Instants, and what LENGTH moves, are in the order of their cards.
   if (change == "turned" && text ~ /^(AT|LENGTH)/) { in_order = in_order text "\n"; return }
   if (text ~ /^(ADD|RISE)/) out[n_out] = out[n_out] "\n" text
   else out[++n_out] = text
}
# A card with its first `n` numbers x, but for those that are `blank`.
function write_numbers(head, n,  k, line) {
   line = "*       "
   for (k = 1; k <= n; k++) line = line sprintf("%-24s", blank[k] ? "" : sprintf("%.16E", x[k]))
   sub(/ *$/, "", line); sub(/ *$/, "", head)
   put(line == "*" ? head : head "\n" line)
}
function write_card(name, a, b, c, n, x1, x2, x3) {
   x[1] = x1; x[2] = x2; x[3] = x3
   split("", blank)
   if (n) write_numbers(sprintf("%-8s%-8s%-8s%-8s", name, a, b, c), n)
   else put(sprintf("%-8s%-8s%-8s%s", name, a, b, c))
}

# The columns of the card in hand.
function take(k,  i) {
   card = cards[k]; star = stars[k]
   name = trim(substr(card, 1, 8))
   a = trim(substr(card, 9, 8)); b = trim(substr(card, 17, 8)); c = trim(substr(card, 25, 8))
   for (i = 1; i <= 3; i++) x[i] = number(i)
   # ADD and RISE cards have the units of the drive above them.
   if (name == "DRIVE") driven = a
}

# Where each link has its new axes: in its points' middle and beside it, turned by more from link to link.
function choose_axes(  k, i) {
   split("", n_points); split("", link_of); split("", xi); split("", eta); split("", turn); n_links = 0
   for (k = 1; k <= n_cards; k++) {
      take(k)
      # Axes along a bar stay.
      if ((name == "GROUND" || name == "LINK") && b == "") { links[++n_links] = a; turn[a] = (degrees ? 17 : 0.3)*n_links }
      if (name == "POINT") { n_points[b]++; xi[b] += x[1]; eta[b] += x[2]; link_of[a] = b }
      if (name == "JOINT") link_of[a] = rests[b] ? c : b
   }
   for (a in n_points) if (!(a in turn)) xi[a] = eta[a] = 0
   for (i = 1; i <= n_links; i++) {
      a = links[i]
      if (n_points[a]) { xi[a] /= n_points[a]; eta[a] /= n_points[a] }
      eta[a] += xi[a]/4; xi[a] -= eta[a]/2
      printf "link %d %s %.16E %.16E %.16E\n", set, a, xi[a], eta[a], turn[a] > map
   }
   for (k = 1; k <= n_cards; k++) {
      take(k)
      if (name == "JOINT") printf "pair %d %s %.16E\n", set, a, turn[c] - turn[b] > map
      if (name == "REVOLUTE") printf "pair %d %s %.16E\n", set, c, turn[link_of[b]] - turn[link_of[a]] > map
   }
}
function change_axes(  phi, dx, dy) {
   if (name == "GROUND" || name == "LINK") {
      phi = x[3]*unit
      x[1] += xi[a]*cos(phi) - eta[a]*sin(phi); x[2] += xi[a]*sin(phi) + eta[a]*cos(phi); x[3] += turn[a]
   }
   if (name == "POINT") {
      dx = x[1] - xi[b]; dy = x[2] - eta[b]; phi = turn[b]*unit
      x[1] = dx*cos(phi) + dy*sin(phi); x[2] = dy*cos(phi) - dx*sin(phi)
   }
   if (name == "PRISM" || name == "SLOT") { x[1] -= turn[link_of[a]]; x[3] += turn[link_of[b]] - turn[link_of[a]] }
   if (name == "DRIVE" && a == "ANGLE") x[1] += turn[b]
   if (name == "DRIVE" && a == "RELANGLE") x[1] += turn[c] - turn[b]
}

# Lengths times 25.4 and times times 60.
function change_units(  long) {
   long = driven ~ /ANGLE/ ? 1 : 25.4
   if (name ~ /^(GROUND|LINK|POINT|JOINT|CYLINDER|LENGTH)$/) { x[1] *= 25.4; x[2] *= 25.4 }
   if (name == "PRISM" || name == "SLOT") x[2] *= 25.4
   if (name == "DRIVE") { x[1] *= long; x[2] *= long/60; x[3] *= long/3600 }
   if (name == "ADD" && a == "HARMONIC") { x[1] *= long; x[2] /= 60 }
   if (name == "ADD" && a == "POWER") x[1] *= long/60^x[2]
   if (name == "ADD" && a == "TABLE") { x[1] *= 60; x[2] *= long }
   if (name == "RISE") { x[1] *= 60; x[2] *= 60; x[3] *= long }
   if (name ~ /^(TIME|AT|BRANCH)$/) { x[1] *= 60; x[2] *= b == "TURNS" ? 1 : 60; x[3] *= 60 }
}
function change_side(  turned) {
   turned = driven ~ /^(Y|ANGLE|RELANGLE)$/
   if (name ~ /^(GROUND|LINK|PRISM)$/ || name ~ /^(DRIVE|RISE)$/ && turned) x[3] = -x[3]
   if (name ~ /^(GROUND|LINK|POINT|JOINT|PRISM|SLOT)$/ || turned && (name == "DRIVE" || name == "ADD" && a == "TABLE")) x[2] = -x[2]
   if (name == "PRISM" || name == "SLOT" || turned && (name == "DRIVE" || name == "ADD" && a != "TABLE")) x[1] = -x[1]
}
function move() {
   if (name ~ /^(GROUND|LINK|JOINT)$/ || name == "DRIVE" && driven == "X") x[1] += 3
   if (name ~ /^(GROUND|LINK|JOINT)$/) x[2] -= 2
   if (name == "DRIVE" && driven == "Y") x[1] -= 2
}

# The results of the deck: time[set, step], place[set, step, link, 1 to 3], flagged[set, step], last[set].
function read_results(  line, f, k) {
   getline line < csv
   while ((getline line < csv) > 0) {
      split(line, f, ",")
      time[f[1], f[2]] = f[3]; last[f[1]] = f[2]
      if (f[15] != "") flagged[f[1], f[2]] = 1
      if (f[4] == "LINK") for (k = 1; k <= 3; k++) place[f[1], f[2], f[5], k] = f[5 + k]
   }
   # Where a BRANCH card has taken the other branch, and its link.
   while ((getline line < lst) > 0) {
      if (line ~ /^ SET OF COMPUTATIONS/) n_set++
      if (line !~ /CHANGE POINT AT T = .*PASSED TO THE OTHER BRANCH [(]CARD BRANCH[)]/) continue
      n_switch++; switch_set[n_switch] = n_set
      sub(/.* T = /, "", line); switch_time[n_switch] = line + 0
      sub(/.*LINKS? /, "", line); sub(/[ :,].*/, "", line); switch_link[n_switch] = line
   }
}
# The instants of the set in hand from `start` on, by `way` = 1 or -1, and BRANCH cards for the change points between them
# at which the deck takes the other branch.
function put_instants(  k, next_one, i, n) {
   for (k = start; k >= 0 && k <= last[set]; k = next_one) {
      next_one = k + way
      x[++n] = time[set, k]
      if (n == 3) { write_numbers("AT", n); n = 0 }
      for (i = 1; i <= n_switch; i++) {
         if (switch_set[i] != set || !((set, next_one) in time)) continue
         if ((time[set, k] - switch_time[i])*(time[set, next_one] - switch_time[i]) < 0) branches[i] = time[set, k]
      }
   }
   if (n) write_numbers("AT", n)
   for (i in branches) write_card("BRANCH", switch_link[i], "", "", 1, branches[i])
   split("", branches)
}
# A four-bar linkage, a thousandth as large as 1, that turns by 20 rad in the time of the set.
function put_companion(  rate, first) {
   first = time[set, 0]
   rate = time[set, last[set]] - first
   rate = 20/unit/(rate == 0 ? 1 : rate)
   write_card("GROUND", "Q-BASE", "", "", 3, 5, 7, 0.5/unit)
   write_card("LINK", "Q-CRANK", "", "", 3, 5, 7, 0.5/unit)
   write_card("LINK", "Q-COUP", "", "", 3, 5.0009, 7.0005, 1.4/unit)
   write_card("LINK", "Q-ROCK", "", "", 3, 5.0035, 7.0019, 2.4/unit)
   write_card("POINT", "Q-A0", "Q-BASE", "", 2, 0, 0); write_card("POINT", "Q-B0", "Q-BASE", "", 2, 0.004, 0)
   write_card("POINT", "Q-A0C", "Q-CRANK", "", 2, 0, 0); write_card("POINT", "Q-AC", "Q-CRANK", "", 2, 0.001, 0)
   write_card("POINT", "Q-A", "Q-COUP", "", 2, 0, 0); write_card("POINT", "Q-B", "Q-COUP", "", 2, 0.0035, 0)
   write_card("POINT", "Q-B0R", "Q-ROCK", "", 2, 0, 0); write_card("POINT", "Q-BR", "Q-ROCK", "", 2, 0.003, 0)
   write_card("REVOLUTE", "Q-A0", "Q-A0C", "Q-PA0"); write_card("REVOLUTE", "Q-AC", "Q-A", "Q-PA")
   write_card("REVOLUTE", "Q-B", "Q-BR", "Q-PB"); write_card("REVOLUTE", "Q-B0R", "Q-B0", "Q-PB0")
   write_card("DRIVE", "ANGLE", "Q-CRANK", "", 2, 0.5/unit - rate*first, rate)
}

# The position of the link in hand at the first instant.
function estimate(  k) {
   for (k = 1; k <= 3; k++) if (place[set, start, a, k] != "") x[k] = place[set, start, a, k]
}
# The JOINT card in hand: its points in the axes of their links, which stand where the cards of the links put them.
function put_joint_point(point, link,  dx, dy, phi) {
   dx = x[1] - drawn[link, 1]; dy = x[2] - drawn[link, 2]; phi = drawn[link, 3]*unit
   write_card("POINT", point, link, "", 2, dx*cos(phi) + dy*sin(phi), dy*cos(phi) - dx*sin(phi))
}
function put_joint(  first, second, x1, x2) {
   first = rests[b] ? substr(a, 1, 6) "-2" : a; second = rests[b] ? a : substr(a, 1, 6) "-2"
   x1 = x[1]; x2 = x[2]
   put_joint_point(first, b)
   x[1] = x1; x[2] = x2
   put_joint_point(second, c)
   write_card("REVOLUTE", first, second, a)
}

# The numbers of the PRISM, SLOT, CYLINDER or DRIVE card number k in hand that are as drawn: only in a set with JOINT cards. The place
# of each point in the drawing is in `where`, its link in `link_of`.
function find_places(  k, phi) {
   for (k = 1; k <= n_cards; k++) {
      take(k)
      if (name == "JOINT") { link_of[a] = rests[b] ? c : b; where[a, 1] = x[1]; where[a, 2] = x[2] }
      if (name != "POINT") continue
      link_of[a] = b; phi = drawn[b, 3]*unit
      where[a, 1] = drawn[b, 1] + x[1]*cos(phi) - x[2]*sin(phi); where[a, 2] = drawn[b, 2] + x[1]*sin(phi) + x[2]*cos(phi)
   }
   for (k = 1; k <= n_cards; k++) {
      take(k)
      if (name == "CYLINDER") {
         guide_p[c] = a; guide_q[c] = b
         theta[c] = atan2(where[b, 2] - where[a, 2], where[b, 1] - where[a, 1])
      }
      if (name == "PRISM" || name == "SLOT") { guide_p[c] = a; guide_q[c] = b; theta[c] = (drawn[link_of[a], 3] + x[1])*unit }
   }
}
# A table gives the values of the DRIVE card number k.
function has_table(k) {
   for (k++; cards[k] ~ /^(ADD|RISE|TOLER)/; k++) if (cards[k] ~ /^ADD     TABLE/) return 1
   return 0
}
function draw(k,  dx, dy) {
   if (name == "PRISM" || name == "SLOT" || name == "CYLINDER") {
      dx = where[b, 1] - where[a, 1]; dy = where[b, 2] - where[a, 2]
      if (name == "CYLINDER") x[1] = theta[c]/unit - drawn[link_of[a], 3]
      if (name != "CYLINDER" && !is_given(2)) x[2] = dx*sin(theta[c]) - dy*cos(theta[c])
      if (name == "CYLINDER" || !is_given(3)) x[3] = drawn[link_of[b], 3] - drawn[link_of[a], 3]
      if (name != "SLOT") { card = sprintf("%-8s%s", "PRISM", substr(card, 9)); name = "PRISM" }
   }
   if (name != "DRIVE" || is_given(1) || has_table(k)) return
   if (a == "ANGLE") x[1] = drawn[b, 3]
   if (a == "RELANGLE") x[1] = drawn[c, 3] - drawn[b, 3]
   if (a == "X" || a == "Y") x[1] = where[b, a == "X" ? 1 : 2]
   if (a == "SLIDE") x[1] = (where[guide_q[b], 1] - where[guide_p[b], 1])*cos(theta[b]) \
      + (where[guide_q[b], 2] - where[guide_p[b], 2])*sin(theta[b])
}

# The number i of the card number k in hand is as drawn, or that of FROM and TO, or that of no stroke.
function is_drawn(k, i) {
   return !is_given(i) && (name == "CYLINDER" || name == "LINK" && b != "" || (name == "PRISM" || name == "SLOT") && i > 1 \
      || name == "DRIVE" && i == 1 && !has_table(k))
}
# Whether the set has JOINT cards (`joints`), and whether they are to stay (`drawing`).
function find_drawing(  k) {
   joints = drawing = 0
   for (k = 1; k <= n_cards; k++) {
      take(k)
      if (name == "JOINT") joints = 1
      if (change != "whole" && name == "JOINT" || name == "LENGTH" || name == "LINK" && b != "" \
         || name == "CYLINDER" && (is_given(1) || is_given(2))) drawing = 1
   }
}
function change_card(k,  n, i) {
   if (change == "whole" && joints && !drawing && name ~ /^(PRISM|SLOT|CYLINDER|DRIVE)$/) draw(k)
   n = name ~ /^(POINT|JOINT|SLOT|CYLINDER|TIME)$/ || name == "ADD" && a != "HARMONIC" ? 2 : name ~ /^(LENGTH|BRANCH)$/ ? 1 : 3
   for (i = 1; i <= 3; i++) blank[i] = drawing && is_drawn(k, i)
   # The relations of measures stand in measures.sh.
   if (change == "whole" && name ~ /^(DISTANCE|LINE|ANGLE|XI|ETA|SUM)$/) return
   if (change == "whole" && name ~ /^(PRINT|LANG|EXTREMES|COLUMN|RANGE|TOLER|POLE|CURVE|PROVE|CIRCUITS)$/) return
   if (change == "whole" && name == "JOINT" && !drawing) { put_joint(); return }
   if (change ~ /^(middle|back)$/ && name ~ /^(TIME|AT|BRANCH)$/) return
   if (change ~ /^(middle|back|beside)$/ && name == "ASSEMBLY") return
   # Another drive that has a rate leaves no turns to count.
   if (name == "TIME" && change == "beside" && b == "TURNS") {
      card = sprintf("%-8s%-16s%s", "TIME", a, substr(card, 25)); x[2] = time[set, a]
   }
   if (name == "TIME" && change ~ /^[37]$/) card = sprintf("%-8s%-8s%s", "TIME", change*a, substr(card, 17))
   # A card of which nothing is known here is refused.
   if (name !~ /^(GROUND|LINK|POINT|JOINT|LENGTH|PRISM|SLOT|CYLINDER|DRIVE|ADD|RISE|TIME|AT|BRANCH)$/) {
      put((name ~ /^(TITLE|UNITS|LANG|METHOD|REVOLUTE|PRINT|ASSEMBLY)$/ ? "" : "?") card)
      return
   }
   if (name == "AT") while (n > 1 && !is_given(n)) n--
   if (change == "axes") change_axes()
   if (change == "units") change_units()
   if (change == "mirrored") change_side()
   if (change == "moved") move()
   if (name == "LINK" && change ~ /^(middle|back)$/ && !drawing) estimate()
   write_numbers(substr(card, 1, 32), n)
}

BEGIN { if (csv != "") read_results() }
/^[$]/ || /^ *$/ { next }
/^\*/ { stars[n_cards] = $0; next }
/^UNITS/ { degrees = substr($0, 17, 3) == "DEG" }
!/^END/ { cards[++n_cards] = sprintf("%-80s", $0); stars[n_cards] = ""; next }
{
   set++; n_out = 0
   unit = degrees ? atan2(0, -1)/180 : 1
   find_drawing()
   way = change == "back" && !drawing ? -1 : 1
   start = 0
   if (change ~ /^(middle|back)$/ && !drawing) {
      start = last[set]
      while ((set, start) in flagged) start--
      if (change == "middle" && start > 0) start = int((start + 1)/2)
      while (start < 0 || (set, start) in flagged) start++
   }
   # Where all is flagged, the deck stays as it is.
   if (start > last[set]) { start = 0; way = 1 }
   printf "start %d %d %d\n", set, start, way > map
   if (degrees) print "degrees", set > map
   for (i = 1; i <= n_cards; i++) {
      take(i)
      if (name == "TIME") print "steps", set, a > map
      if (name ~ /^(PRISM|SLOT|CYLINDER)$/) print "slide", set, c > map
      if (name == "METHOD" && a == "MATRIX") print "matrix", set > map
      if (name == "METHOD" && x[2] > 0) print "closing", set > map
      if (name ~ /^(GROUND|LINK)$/) { rests[a] = name == "GROUND"; for (k = 1; k <= 3; k++) drawn[a, k] = x[k] }
   }
   if (change == "axes") choose_axes()
   if (change == "whole") find_places()
   for (i = 1; i <= n_cards; i++) { take(i); change_card(i) }
   if (change == "beside") put_companion()
   if (change ~ /^(middle|back)$/) put_instants()
   if (change == "whole") put("PRINT   ALL")
   for (i = 1; i <= n_out; i++) {
      text = out[change == "turned" ? n_out + 1 - i : i]
      gsub(/ +\n/, "\n", text); sub(/ +$/, "", text); print text
   }
   printf "%sEND\n", in_order
   n_cards = 0; degrees = 0; in_order = ""
}
