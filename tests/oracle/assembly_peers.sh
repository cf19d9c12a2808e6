#!/bin/sh
# Counts of the assemblies of blocks made by chance by PHCpack (the command phc of Debian's package phcpack): a line for
# each, of seed, links, isolated solutions, and those of them that are real. make assembly-peers writes them to
# tests/validation/assemblies.txt, which tests/system/assemblies.sh reads.
# usage: assembly_peers.sh NUMBER
w=$BUILD/assembly_peers
mkdir -p "$w" || exit 3
for seed in $(seq 1 "$1"); do
   "$BUILD/release/random_blocks" "$seed" deck > "$w/deck"
   "$BUILD/release/random_blocks" "$seed" system > "$w/system"
   rm -f "$w/out"
   # In double-double arithmetic: in double precision it loses some.
   phc -b2 "$w/system" "$w/out" > "$w/log" 2>&1
   # The list refined at the end; a solution is real where x and y are conjugate.
   awk -v seed="$seed" -v links="$(grep -c '^LINK' "$w/deck")" '
      /^THE SOLUTIONS/ { regular = 0; real = 0 }
      /^the solution for t/ { delete re; delete im; next }
      / [xy][0-9]* :/ { re[$1] = $3; im[$1] = $4 }
      /^== err .* regular ==/ {
         regular++
         off = 0
         for (v in re) if (v ~ /^x/) {
            u = v; sub(/x/, "y", u)
            d = (re[v] - re[u])^2 + (im[v] + im[u])^2
            if (d > 1e-12*(1 + re[v]^2 + im[v]^2)) off = 1
         }
         if (!off) real++
      }
      END { print seed, links, regular, real }' "$w/out"
done
