# awk -f nearest.awk DECK LISTING CSV LISTING2 CSV2: whether the first instants of LISTING2 and CSV2 are the nearest of the assemblies
# that LISTING and CSV have with card ASSEMBLY, for the sets of a deck in rad whose numbers stand on * cards. DISTANCE is calculated
# from the cards. A line for each set that begins in another one and does not say that a nearer one may exist; then one of counts:
# sets that were compared, that begin in another one, and that say so needlessly.
function size(x) { return x < 0 ? -x : x }
function number(k) { return substr($0, 24*k - 15, 24) + 0 }
function extent(l, u, v) {
   if (u < low[l, 1]) low[l, 1] = u; if (u > high[l, 1]) high[l, 1] = u
   if (v < low[l, 2]) low[l, 2] = v; if (v > high[l, 2]) high[l, 2] = v
   if (high[l, 1] - low[l, 1] > span[n]) span[n] = high[l, 1] - low[l, 1]
   if (high[l, 2] - low[l, 2] > span[n]) span[n] = high[l, 2] - low[l, 2]
}
# The characteristic length: the extent of a link between its points and its origin; all ground links are one; the offset of a guide.
# A point of a link that is declared after it waits for the link.
function close_set(  k, f, g) {
   split("", low); split("", high)
   for (k = 1; k <= points; k++) {
      split(point[k], f, " ")
      if (f[1] in ground) {
         split(ground[f[1]], g, " ")
         f[4] = g[1] + f[2]*cos(g[3]) - f[3]*sin(g[3]); f[3] = g[2] + f[2]*sin(g[3]) + f[3]*cos(g[3]); f[2] = f[4]; f[1] = ""
         if (!(("", 1) in low)) { low["", 1] = high["", 1] = f[2]; low["", 2] = high["", 2] = f[3] }
      }
      extent(f[1], f[2], f[3])
   }
   for (k in offset) if (size(offset[k]) > span[n]) span[n] = size(offset[k])
   points = offsets = 0
   split("", ground); split("", offset)
}
function square(s, l, at,  p, g, d, e) {
   split(at, p, " "); split(guess[s, l], g, " ")
   d = (p[3] - g[3])/turn
   d = turn*(d - int(d + (d < 0 ? -0.5 : 0.5)))
   e = sqrt((p[1] - g[1])^2 + (p[2] - g[2])^2)/span[s]
   return d^2 + (e < 0.25 ? e : 0.25)^2
}
BEGIN { turn = 8*atan2(1, 1); n = 1 }
FNR == 1 { file++; split("", f) }
file == 1 && /^\*/ {
   if (kind == "LINK") guess[n, name] = number(1) " " number(2) " " number(3)
   if (kind == "GROUND") ground[name] = number(1) " " number(2) " " number(3)
   if (kind == "POINT") point[++points] = of " " number(1) " " number(2)
   if (kind == "PRISM") offset[++offsets] = number(2)
}
file == 1 && !/^\*/ {
   kind = $1; name = $2; of = $3
   if (kind == "LINK") links[n] = links[n] " " name
   if (kind == "END") { close_set(); n++ }
}
file == 2 || file == 4 {
   if (/^ SET OF COMPUTATIONS/) set = $5
   if (/MAY BE MISSING|TOO MANY UNKNOWNS|THERE ARE MORE|NON-ISOLATED/) missing[set] = 1
   if (file == 4 && /A NEARER ASSEMBLY MAY EXIST/) remarked[set] = 1
}
file == 3 || file == 5 {
   split($0, f, ",")
   if (f[2] != "0" || f[4] !~ /^LINK/ || f[8] == "") next
   k = f[4]; sub(/^LINK */, "", k); sub(/.* /, "", k)
   if ((k == "") != (file == 5)) next
   if (file == 5) k = 0
   sum[f[1], k] += square(f[1], f[5], f[6] " " f[7] " " f[8])
   seen[f[1], k]++
   if (k > last[f[1]]) last[f[1]] = k + 0
}
END {
   for (s = 1; s < n; s++) {
      m = split(links[s], l, " ")
      if (missing[s] || seen[s, 0] < m) continue
      least = -1
      for (k = 1; k <= last[s]; k++) if (seen[s, k] == m && (least < 0 || sum[s, k] < least)) least = sum[s, k]
      if (least < 0) continue
      compared++
      # Half of all digits is known near a dead point.
      is_further = sqrt(sum[s, 0]) > sqrt(least)*(1 + 1e-5) + 1e-7
      further += is_further
      needless += !is_further && remarked[s]
      if (is_further && !remarked[s]) print "set " s ": DISTANCE " sqrt(sum[s, 0]) ", least " sqrt(least)
   }
   print compared + 0, further + 0, needless + 0
}
