#!/bin/sh
# Counts of the assemblies of blocks made by chance by PHCpack (the command phc of Debian's package phcpack): a line for
# each, of seed, links, isolated solutions, and those of them that are real. make assembly-peers writes them to
# tests/validation/assemblies.txt, which tests/system/assemblies.sh reads. One run of phc -b loses some solutions of one
# block in twenty, and not always the same: those of five runs are put together.
# usage: assembly_peers.sh FIRST LAST
w=$BUILD/assembly_peers
mkdir -p "$w" || exit 3
for seed in $(seq "$1" "$2"); do
   "$BUILD/release/random_blocks" "$seed" deck > "$w/deck"
   "$BUILD/release/random_blocks" "$seed" system > "$w/system"
   rm -f "$w"/out.*
   for run in 1 2 3 4 5; do phc -b2 -0"$seed$run" "$w/system" "$w/out.$run" > "$w/log" 2>&1; done
   # The list refined at the end of each run; a solution is real where x and y are conjugate.
   awk -v seed="$seed" -v links="$(grep -c '^LINK' "$w/deck")" '
      function is_near(a, b, c, d) { return (a - c)^2 + (b - d)^2 <= 1e-12*(1 + a*a + b*b) }
      /^the solution for t/ { delete re; delete im; next }
      / [xy][0-9]* :/ { re[$1] = $3; im[$1] = $4 }
      /^== err .* regular ==/ {
         for (k = 1; k <= regular; k++) {
            same = 1
            for (v in re) if (!is_near(re[v], im[v], re_of[k, v], im_of[k, v])) same = 0
            if (same) next
         }
         regular++
         off = 0
         for (v in re) {
            re_of[regular, v] = re[v]
            im_of[regular, v] = im[v]
            u = v
            if (sub(/x/, "y", u) && !is_near(re[v], im[v], re[u], -im[u])) off = 1
         }
         if (!off) real++
      }
      END { print seed, links, regular + 0, real + 0 }' "$w"/out.*
done
