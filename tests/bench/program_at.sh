# Sourced: program_at COMMIT PLACE builds the program of COMMIT below PLACE, once for each commit. `at` is its path.
program_at() {
   commit=$(git rev-parse --short "$1^{commit}") || exit 3
   at=$2/$commit/build/kinmat
   [ -x "$at" ] && return
   mkdir -p "$2/$commit" || exit 3
   git archive "$commit" | tar -xf - -C "$2/$commit" || exit 3
   env -u MAKEFLAGS -u MAKELEVEL make -C "$2/$commit" build/kinmat > "$2/$commit.txt" 2>&1 || { tail -n 5 "$2/$commit.txt"; exit 3; }
}
