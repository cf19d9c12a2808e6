# awk -v mode=MODE -f assembly_rows.awk LISTING CSV LISTING2 CSV2: assemblies of one set at its one instant, by the LISTING and
# the CSV of a run with card ASSEMBLY. A line for each independent mechanism or assembly that has something to say:
#    mode=first     the first instant of CSV2 is none of the assemblies, and no line of LISTING says that some are missing
#    mode=taken     the first instant of CSV2 is not assembly `k` of mechanism `c`
#    mode=among     an assembly is none of LISTING2; nor, with `all`, the other way round
# A place may be off by `level` of the largest coordinate, an angle by `level` rad. LISTING2 is used by `among` alone.
function size(x) { return x < 0 ? -x : x }
function apart(a, b) {
   a -= b
   if (a == "" || a != a + 0) return 1e9
   return size(a)
}
# By how much the links of mechanism c differ, of assembly i of the first files and j of the second; j = 0: the instant.
function distance(c, i, j,  l, n, d, x, y, far, k) {
   n = split(links[c], l, " ")
   for (k = 1; k <= n; k++) {
      x = place[1, l[k], i]; y = place[2, l[k], j]
      if (x == "" || y == "" || y == "  ") return 1e9
      split(x, a, " "); split(y, b, " ")
      if (b[3] == "") return 1e9
      d = apart(a[1], b[1])/largest; if (d > far) far = d
      d = apart(a[2], b[2])/largest; if (d > far) far = d
      d = (a[3] - b[3])/turn; d = size(d - int(d + (d < 0 ? -0.5 : 0.5)))*2*atan2(0, -1); if (d > far) far = d
   }
   return far
}
FNR == 1 { file++; set = file <= 2 ? 1 : 2; if (file % 2) mechanism = 1 }
file % 2 == 1 {
   if (/^ UNITS .* DEG /) degrees = 1
   if (/MAY BE MISSING|TOO MANY UNKNOWNS|THERE ARE MORE|NOT ALL SOLUTIONS ARE SEPARATE/) missing[set] = 1
   if (/^ INDEPENDENT MECHANISM/) mechanism = $3
   if (/^ ASSEMBLIES/) { on = 1; if (set == 1) mechanisms = 1 }
   if (/^ CONTINUATION:/) on = 0
   if (set == 1 && on && mechanism > mechanisms) mechanisms = mechanism
   if (on && /^ ASSEMBLY /) { number = $2; count[set, mechanism] = number }
   if (set == 1 && on && /^LINK/ && number == 1) links[mechanism] = links[mechanism] " " $2
   next
}
{
   n = split($0, f, ",")
   if (f[2] != "0" || f[4] !~ /^(LINK|POINT)/) next
   if (size(f[6]) > largest) largest = size(f[6])
   if (size(f[7]) > largest) largest = size(f[7])
   if (f[4] !~ /^LINK/) next
   k = 0
   if (f[4] ~ /ASSEMBLY/) { k = f[4]; sub(/.* /, "", k) }
   place[set, f[5], k] = f[6] " " f[7] " " f[8]
   if (k == 0 && set == 2) { any_link = 1; if (f[8] == "") unknown = 1 }
}
END {
   turn = degrees ? 360 : 2*atan2(0, -1)
   for (c = 1; c <= mechanisms; c++) {
      if (mode == "first" && !missing[1] && !unknown && any_link) {
         least = 1e9
         for (i = 1; i <= count[1, c]; i++) { d = distance(c, i, 0); if (d < least) least = d }
         if (!(least <= level)) print "mechanism " c ": the first instant is off the " count[1, c] + 0 " assemblies by " least
      }
      if (mode == "taken" && c == mechanism_taken) {
         d = distance(c, k_taken, 0)
         if (!(d <= level)) print "mechanism " c ": assembly " k_taken " is off by " d
      }
      if (mode == "among" && !missing[1] && !missing[2]) {
         if (all && count[1, c] != count[2, c]) print "mechanism " c ": assemblies " count[1, c] " " count[2, c]
         for (i = 1; i <= count[1, c]; i++) {
            least = 1e9
            for (j = 1; j <= count[2, c]; j++) { d = distance(c, i, j); if (d < least) least = d }
            if (!(least <= level)) print "mechanism " c ": assembly " i " is none of the others, off by " least
         }
      }
   }
}
