# extremes_check.awk LISTING CSV: no number of the CSV, a run in finer steps with --errors, lies beyond its extreme in the
# listing's table, by more than a unit of the last digit that the table knows and twice the CSV's own error. A line for each
# column that fails: how far it is off, in those units; then one of counts. Instants that the table says it does not cover
# are passed over, and so is a set without a position at its first instant: runs in other steps begin at other instants
# then, perhaps in other assemblies. What the table does not know at all (only question marks) is counted.
function unit_of(text,  mantissa, at, power, dot, last) {
   mantissa = text; power = 0; at = index(text, "E")
   if (at) { mantissa = substr(text, 1, at - 1); power = substr(text, at + 1) + 0 }
   sub(/^-/, "", mantissa)
   at = index(mantissa, "?")
   if (at == 1 || mantissa ~ /^0[.]?[?]/) return -1
   if (!at) at = length(mantissa) + 1
   dot = index(mantissa, ".")
   if (!dot) dot = length(mantissa) + 1
   # The last known digit is before `at`.
   last = at - 1
   if (last == dot) last--
   return (last < dot ? 10^(dot - 1 - last) : 10^(dot - last))*10^power
}
function value_of(text) { gsub(/[?]/, "0", text); return text + 0 }
# Column I of x, y, phi and their derivatives. In a table of pairs slides come first, angles behind them, in the places below;
# a slide counts as x, an angle as phi.
function field(i,  f, at) {
   at = kind == "PAIR" ? substr(has_slides ? "105260408" : "001002004", i, 1) + 0 : i
   if (at == 0) return ""
   f = substr($0, 10 + 12*(at - 1), 12); gsub(/ /, "", f); return f
}
# A power of ten behind the times holds for all of them.
function note_gaps(text,  list, n, i, ends, scale) {
   sub(/.*T = /, "", text)
   scale = 1
   if (match(text, / 1[.]E[-+][0-9]+/)) scale = 10^substr(text, RSTART + 4, RLENGTH - 4)
   n = split(text, list, ", ")
   for (i = 1; i <= n; i++) {
      split(list[i], ends, " ")
      gaps[set]++
      from[set, gaps[set]] = scale*value_of(ends[1])
      to[set, gaps[set]] = scale*value_of(ends[2] == ".." ? ends[3] : ends[1])
   }
   if (text ~ / MORE/) has_more[set] = 1
}
function is_covered(set, t,  i, low, high, open) {
   if (t in seen) return seen[t]
   for (i = 1; i <= gaps[set]; i++) {
      low = from[set, i]; high = to[set, i]
      if (low > high) { open = low; low = high; high = open }
      open = 1e-5*(high - low) + 1e-6*(low < 0 ? -low : low) + 1e-9
      if (t >= low - open && t <= high + open) return seen[t] = 0
   }
   return seen[t] = 1
}
FNR == 1 { file++ }
file == 1 && / SET OF COMPUTATIONS NO[.]/ { line = $0; sub(/.*NO[.] */, "", line); set = line + 0 }
file == 1 && /^ EXTREMES  / { on = 1; next }
file == 1 && /^ (CONTINUATION:|RANGES)/ { on = 0 }
file == 1 && !on { next }
file == 1 && /NOT SEARCHED|MAY BE MISSED/ { note_gaps($0); next }
file == 1 && /^ (LINK|POINT|PAIR)  / { kind = $1; has_slides = /SLIDE/; for (i = 1; i <= 9; i++) power[i] = 0; next }
file == 1 && /^ *1[.]E[-+]/ { for (i = 1; i <= 9; i++) { f = field(i); sub(/1[.]E/, "", f); power[i] = f + 0 } next }
file == 1 && /^ [^ -]/ && !/^ (DWELL|AT DRIVE)/ { if (substr($0, 10) ~ /^ *(DRIVE .*)?$/) name = $1; next }
file == 1 && /^  (MIN|MAX)  / {
   for (i = 1; i <= 9; i++) {
      f = field(i)
      if (f == "") continue
      key = set "," kind "," name "," i "," $1
      text[key] = f
      if (f == "NONE" || f ~ /^UNB/) continue
      unit[key] = unit_of(f)*10^power[i]
      value[key] = value_of(f)*10^power[i]
   }
   next
}
file == 1 || FNR == 1 { next }
{
   split($0, a, ",")
   if (a[1] != last_set) { split("", seen); last_set = a[1]; begins_later = 0 }
   if (a[2] == 0 && a[4] == "LINK" && a[6] == "") begins_later = 1
   covered = !begins_later && !(a[1] in has_more) && is_covered(a[1] + 0, a[3] + 0)
   for (i = 1; i <= 9; i++) {
      if (a[5 + i] == "") continue
      j = i
      if (a[4] == "PAIR" && !((a[1] ",PAIR," a[5] ",1,MIN") in text)) j = i + 2
      number = a[1] "," a[4] "," a[5] "," j
      if (!((number ",MIN") in text)) continue
      if (!covered) { passed_over++; continue }
      checked++
      for (side = 1; side <= 2; side++) {
         key = number "," (side == 1 ? "MIN" : "MAX")
         if (text[key] ~ /^UNB/) continue
         if (text[key] == "NONE") { bad[key] = 1e99; what[key] = "NONE"; continue }
         if (unit[key] < 0) { unknown[key] = text[key]; continue }
         beyond = (a[5 + i] - value[key])*(side == 1 ? -1 : 1) - 2*a[15 + i]
         if (beyond > unit[key]*1.001 && beyond/unit[key] > bad[key]) {
            bad[key] = beyond/unit[key]
            what[key] = text[key] " BUT " a[5 + i] " AT T = " a[3]
         }
      }
   }
}
END {
   for (key in bad) { misses++; printf "MISSED: %s %s: %.2G UNITS\n", key, what[key], bad[key] }
   for (key in unknown) { unknowns++; printf "UNKNOWN: %s %s\n", key, unknown[key] }
   printf "SUMS %d %d %d %d %d\n", checked, length(text), misses, unknowns, passed_over
}
