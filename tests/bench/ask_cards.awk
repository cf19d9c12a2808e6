# awk -v seed=N -f ask_cards.awk DECK: the deck, its last set with more cards by the dice of `seed`: every card that asks
# something of a motion, another method, joints of a drawing, the mechanism a second time, a pair twice. Runs stay short.
# Comments `$ SEVERAL` and `$ DOUBLED` say so. The dice are the same in every awk.
function chance(p) { return dice() < p }
function dice() { state = (state*16807) % 2147483647; return state/2147483647 }
function throw(n) { return int(dice()*n) + 1 }
function between(a, b) { return a + (b - a)*dice() }
function padded(text) { return substr(text "        ", 1, 8) }
function card(i) { return substr(line[i], 1, 8) }
function label(i, k,  text) { text = substr(line[i], 8*k + 1, 8); sub(/ +$/, "", text); return text }
function has_star(i) { return i < n && substr(line[i + 1], 1, 1) == "*" }
function real(i, k) { return (has_star(i) ? substr(line[i + 1], 24*k - 15, 24) : substr(line[i], 16*k + 17, 16)) + 0 }
function behind(i) { return i + has_star(i) }
# Card i has no number in its field k.
function blank(i, k) {
   line[i] = without(line[i], 16*k + 17, 16)
   if (has_star(i)) line[i + 1] = without(line[i + 1], 24*k - 15, 24)
}
function without(text, first, width) {
   text = sprintf("%-80s", text)
   return substr(text, 1, first - 1) substr(sprintf("%80s", ""), 1, width) substr(text, first + width)
}
function star(a, b) { return sprintf("*       %-24.16E%-24.16E", a, b) }
# One of the cards of these names, from `first` on: its line; 0: none.
function pick(names,  i, m, found) {
   m = 0
   for (i = first; i <= n; i++) if (index(" " names " ", " " name_of(i) " ")) found[++m] = i
   return m ? found[throw(m)] : 0
}
function name_of(i,  text) { text = card(i); sub(/ +$/, "", text); return text }
function count(name,  i, m) { m = 0; for (i = first; i <= n; i++) if (name_of(i) == name) m++; return m }
function add_behind(i, text) { i = behind(i); more[i] = more[i] text "\n" }
function add_last(text) { last_cards = last_cards text "\n" }

# The revolute pairs, or most of them, as joints of the drawing that the estimates are.
function draw(  i, p, k, link, x, y, phi, unit) {
   for (i = first; i <= n; i++) {
      if (card(i) ~ /^(LINK|GROUND) /) place[label(i, 1)] = i
      if (card(i) ~ /^POINT /) point[label(i, 1)] = i
      if (card(i) ~ /^UNITS/) unit = label(i, 2) == "RAD" ? 1 : atan2(0, -1)/180
   }
   for (i = first; i <= n; i++) {
      if (card(i) != "REVOLUTE" || chance(0.2) || has_star(i) || label(i, 3) in point) continue
      p = point[label(i, 1)]
      k = point[label(i, 2)]
      link = label(p, 2)
      if (!p || !k || !(link in place)) continue
      phi = unit*real(place[link], 3)
      x = real(place[link], 1) + cos(phi)*real(p, 1) - sin(phi)*real(p, 2)
      y = real(place[link], 2) + sin(phi)*real(p, 1) + cos(phi)*real(p, 2)
      line[i] = "JOINT   " padded(label(i, 3)) padded(link) padded(label(k, 2)) "\n" star(x, y)
      drawn = 1
   }
   if (!drawn) return
   for (i = first; i <= n; i++) {
      if (card(i) ~ /^DRIVE/ && chance(0.3)) blank(i, 1)
      if (card(i) ~ /^PRISM/ && chance(0.3)) blank(i, throw(2) + 1)
   }
}
# The number of a name of a kind (L: link, P: point, K: pair) in the second mechanism.
function other(kind, name) {
   if (name == "") return name
   if (!((kind, name) in others)) others[kind, name] = "9" kind (++taken)
   return others[kind, name]
}
# The mechanism once more, on the same ground or on its own, with slower drives.
function double_mechanism(  i, is_shared, text, kind, more_text) {
   is_shared = chance(0.5)
   for (i = first; i <= n; i++)
      if (is_shared && card(i) ~ /^GROUND/) others["L", label(i, 1)] = label(i, 1)
   for (i = first; i <= n; i++) {
      kind = name_of(i)
      text = ""
      if (kind == "GROUND" && is_shared) continue
      if (kind == "GROUND" || kind == "LINK") text = padded(other("L", label(i, 1))) substr(line[i], 17)
      else if (kind == "POINT") text = padded(other("P", label(i, 1))) padded(other("L", label(i, 2))) substr(line[i], 25)
      else if (kind == "REVOLUTE" || kind == "PRISM" || kind == "CYLINDER")
         text = padded(other("P", label(i, 1))) padded(other("P", label(i, 2))) padded(other("K", label(i, 3))) \
            substr(line[i], 33)
      else if (kind == "DRIVE") {
         kind = label(i, 1)
         kind = kind == "SLIDE" ? "K" : kind == "X" || kind == "Y" ? "P" : "L"
         text = padded(label(i, 1)) padded(other(kind, label(i, 2)))
         if (label(i, 1) == "RELANGLE") text = text padded(other("L", label(i, 3)))
         else text = text padded(label(i, 3))
         text = text "\n" star(real(i, 1), 0.7*real(i, 2)) sprintf("%-24.16E", 0.7*real(i, 3))
         more_text = more_text "DRIVE   " text "\n"
         continue
      } else if (kind == "ADD" || kind == "RISE") text = substr(line[i], 9)
      else continue
      more_text = more_text card(i) text "\n"
      if (has_star(i)) more_text = more_text line[i + 1] "\n"
   }
   last_cards = last_cards more_text
}

{ sub(/\r$/, ""); line[++n] = $0 }
END {
   state = (seed*7919 + 12345) % 2147483646 + 1
   for (i = 1; i <= 20; i++) dice()
   first = 1
   last = 0
   for (i = 1; i <= n; i++) if (card(i) ~ /^END *$/) { if (last) first = last + 1; last = i }
   if (!last) last = n + 1
   links = count("LINK")
   has_joints = count("JOINT") + count("CYLINDER") > 0
   if (!has_joints && links <= 6 && chance(0.12)) { double_mechanism(); note = note "$ SEVERAL\n" }
   else if (!has_joints && chance(0.2)) draw()
   varies = chance(0.2)
   rows_only = varies && chance(0.6)
   method = count("METHOD") > 0
   plain = !method && chance(0.12)
   if (plain) add_last("METHOD  " (chance(0.5) ? "DENSE" : "MATRIX"))
   if (!method && !plain && chance(0.1) && (i = pick("REVOLUTE PRISM"))) {
      add_behind(i, substr(line[i], 1, 24) "9RR     " substr(line[i], 33) (has_star(i) ? "\n" line[i + 1] : ""))
      note = note "$ DOUBLED\n"
   }
   for (k = 1; k <= 3; k++) if (chance(0.12) && (i = pick("POINT PRISM DRIVE" (drawn ? "" : " GROUND")))) {
      if (i in toler) continue
      toler[i] = 1
      size_of = 0.01*(real(i, 1) < 0 ? -real(i, 1) : real(i, 1))
      if (size_of == 0) size_of = 0.001
      if (size_of < 1e30) add_behind(i, sprintf("TOLER%27s%-16.4E%-16.4E", "", size_of, chance(0.5) ? size_of : 0))
   }
   if (varies) for (k = throw(2); k >= 1; k--) {
      i = pick("POINT POINT POINT DRIVE PRISM TIME LINK RISE")
      if (!i || i in toler) continue
      toler[i] = 1
      field = card(i) ~ /^POINT/ && chance(0.7) ? 1 : throw(2)
      x = real(i, field)
      off = between(0, 0.15)*(x < 0 ? -x : x)
      if (off == 0) off = 0.1
      if (off > 1e30) continue
      tie = chance(0.3) ? "TIE" : ""
      values = chance(0.25) ? "LIST" : tie != "" ? 5 : throw(rows_only ? 30 : 4) + 1
      add_behind(i, sprintf("VARY    R%d      %-8s%-8s%-16.8E%-16.8E", field, values, tie, x - off, x + off))
   }
   if (chance(0.25)) {
      kind = substr("ALL     LINKS   POINTS  PAIRS   ", 8*throw(4) - 7, 8)
      add_last("EXTREMES" kind (chance(0.3) ? sprintf("%16s%-16.4E%-16.4E", "", between(0, 1), between(0, 9)) : ""))
   }
   if (chance(0.2)) add_last("RANGE")
   if (chance(0.2)) add_last("ASSEMBLY")
   if (chance(0.12) && !method && !plain) add_last("PROVE")
   if (chance(0.3) && links <= 5) add_last("CIRCUITS")
   if (chance(0.12) && !method && !plain) {
      i = chance(0.5) ? pick("LINK") : 0
      add_last(sprintf("BRANCH  %-8s%16s%-16.8E", i ? label(i, 1) : "", "", (i = pick("TIME AT")) ? real(i, 1) : 0))
   }
   if (chance(0.2) && (i = pick("GROUND LINK")) && (k = pick("LINK")) && i != k)
      add_last("POLE    " padded(label(i, 1)) padded(label(k, 1)))
   if (chance(0.2) && (i = pick("POINT"))) {
      k = chance(0.4) ? pick("LINK") : 0
      add_last("CURVE   " padded(label(i, 1)) (k ? padded(label(k, 1)) : ""))
   }
   if (chance(0.5)) {
      for (i = first; i <= n; i++) if (card(i) ~ /^PRINT/) dropped[i] = 1
      if (!rows_only) add_last("PRINT   ALL")
   } else if (rows_only) for (i = first; i <= n; i++) if (card(i) ~ /^(PRINT|POLE|CURVE) /) dropped[i] = 1
   if (rows_only) { gsub(/(POLE|CURVE|PROVE) [^\n]*\n|PROVE\n/, "", last_cards) }
   printf "%s", note
   for (i = 1; i <= n; i++) {
      if (i == last) printf "%s", last_cards
      if (!dropped[i]) print line[i]
      printf "%s", more[i]
   }
   if (last > n) printf "%s", last_cards
}
