# awk -v first=N -v sets=COUNT [-v assembly=1] -f random_dyads.awk: a deck of COUNT sets, from seed N on: a crank that moves one to
# three dyads of all kinds, six of ten near their dead points. Sizes go over six orders, places over two more. The guess of a
# link is off by a part of its place and angle that the seed chooses; of one set in four angles are 0, any, or half a turn off.
function random() { state = (16807*state) % 2147483647; return state/2147483647 }
function between(a, b) { return a + (b - a)*random() }
function normal() { return sqrt(-2*log(random() + 1e-12))*cos(2*pi*random()) }
function power(a, b) { return exp(log(10)*between(a, b)) }
function star(a, b, c) { printf c == "" ? "*       %24.16E%24.16E\n" : "*       %24.16E%24.16E%24.16E\n", a, b, c }
# A point of link `l` at (u, v) of the plane.
function point(l, u, v,  c, s) {
   c = cos(phi[l]); s = sin(phi[l])
   printf "%-8s%-8s%s\n", "POINT", "P" ++points, name[l]
   star(c*(u - x[l]) + s*(v - y[l]), c*(v - y[l]) - s*(u - x[l]))
   return "P" points
}
function revolute(i, j, u, v,  a, b) {
   a = point(i, u, v); b = point(j, u, v)
   printf "%-8s%-8s%-8sJ%d\n", "REVOLUTE", a, b, ++pairs
}
# Link j slides along a guide of link i with the direction theta; either may be the one with the guide.
function prism(i, j, u, v, p, q, theta,  a, b) {
   if (random() < 0.5) { a = i; i = j; j = a; a = u; u = p; p = a; a = v; v = q; q = a }
   a = point(i, u, v); b = point(j, p, q)
   printf "%-8s%-8s%-8sJ%d\n", "PRISM", a, b, ++pairs
   star(theta - phi[i], -(u - p)*sin(theta) + (v - q)*cos(theta), phi[j] - phi[i])
}
function pair(kind, i, j, u, v, p, q, theta) { if (kind == "R") revolute(i, j, u, v); else prism(i, j, u, v, p, q, theta) }
function link(l, u, v, angle) { name[l] = l == 0 ? "G" : "L" l; x[l] = u; y[l] = v; phi[l] = angle }
# Two links between links i and j, at points A and D of these and M of one another.
function dyad(i, j,  kind, size, near, eps, t, ax, ay, dx, dy, mx, my, theta, k) {
   split("RRR RRR RPR RPR RPR RRP PRR PRP RPP PPR", kinds, " ")
   kind = kinds[1 + int(10*random())]
   size = scale*(random() < 0.5 ? 1 : power(-1.3, 0))
   t = between(0.2, 1.5)*scale
   ax = x[i] + t*cos(phi[i]); ay = y[i] + t*sin(phi[i])
   dx = ax + size*normal(); dy = ay + size*normal()
   near = random() < 0.6
   eps = near ? power(-5, -0.3) : between(-1, 1)
   t = between(-0.8, 1.8)
   mx = ax + size*normal(); my = ay + size*normal()
   if (kind == "RRR") { mx = ax + t*(dx - ax) - eps*(dy - ay); my = ay + t*(dy - ay) + eps*(dx - ax) }
   for (k = 1; k <= 3; k++) theta[k] = between(-pi, pi)
   if (near && kind == "RPR") theta[2] = atan2(dy - ay, dx - ax) + pi/2 + eps
   if (near && kind == "RRP") theta[3] = atan2(my - ay, mx - ax) + pi/2 + eps
   if (near && kind == "PRR") theta[1] = atan2(dy - my, dx - mx) + pi/2 + eps
   k = ++links
   link(k, ax, ay, between(-pi, pi))
   if (random() < 0.5) link(++links, dx, dy, random() < 0.5 ? phi[k] : between(-pi, pi)); else link(++links, mx, my, between(-pi, pi))
   pair(substr(kind, 1, 1), i, k, ax, ay, ax + size*normal(), ay + size*normal(), theta[1])
   if (kind == "RPR") prism(k, links, ax, ay, dx, dy, theta[2])
   else pair(substr(kind, 2, 1), k, links, mx, my, mx + size*normal(), my + size*normal(), theta[2])
   pair(substr(kind, 3, 1), links, j, dx, dy, dx + size*normal(), dy + size*normal(), theta[3])
}
# The card of link l with its guess.
function guess(l,  angle) {
   angle = phi[l] + off*normal()
   if (way < 0.10) angle = between(-pi, pi)
   else if (way < 0.15) angle = 0
   else if (way < 0.25) angle = phi[l] + (random() < 0.5 ? pi : 0) + 0.3*off*normal()
   if (l == 1) angle = phi[1]
   printf "%-8s%s\n", l == 0 ? "GROUND" : "LINK", name[l]
   if (l == 0) star(x[0], y[0], phi[0])
   else star(x[l] + far*scale*normal(), y[l] + far*scale*normal(), angle)
}
BEGIN {
   pi = atan2(0, -1)
   for (seed = first; seed < first + sets; seed++) {
      state = 7919*seed + 1
      for (k = 0; k < 5; k++) random()
      scale = power(-3, 3)
      t = random() < 0.5 ? 0 : power(0, 2)*scale
      links = 1; points = pairs = 0
      link(0, t*normal(), t*normal(), random() < 0.7 ? 0 : between(-pi, pi))
      link(1, x[0], y[0], between(-pi, pi))
      revolute(0, 1, x[0], y[0])
      for (k = int(1 + 2.5*random()^2); k > 0; k--) {
         i = int(1 + links*random()); j = int(links*random())
         dyad(i, i == j ? 0 : j)
      }
      off = power(-4, 0.2); far = power(-4, 0); way = random()
      for (l = 0; l <= links; l++) guess(l)
      printf "DRIVE   ANGLE   L1\n"
      star(phi[1], 1, 0)
      printf "AT                              0.0\nPRINT   LINKS\n%sEND\n", assembly ? "ASSEMBLY\n" : ""
   }
}
