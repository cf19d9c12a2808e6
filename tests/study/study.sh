#!/bin/sh
# make study: --study of the three kinds of reals for six scenes, and with 16 times the steps. Its tables go to standard output
# and to $BUILD/study/, with the time of the default method in times of the closed form where there is one; then the pictures.
# Error and time of every trial: $BUILD/study/speed.txt, a scene a block of blocks, read by tests/study/study.gp.
BUILD=${BUILD:-build}
out=$BUILD/study
mkdir -p "$out" docs || exit 3
OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}
export OPENBLAS_NUM_THREADS

# least FILE: the least time of a step by the default method. Whatever else the machine does makes a time longer.
least() { awk '/^ NEWTON  OWN .* ROUNDING / { print substr($0, 40, 10) + 0; exit }' "$1"; }
# series METHOD FILE UNIT: error and time of the trials of that method, in steps of so many microseconds, and whether it is the
# default tolerance
series() {
   [ -e "$2" ] && awk -v method="$1" -v unit="$3" '
      $1 == method && $2 == "OWN" && !/NOT SOLVED/ {
         e = 0
         for (k = 75; k <= 97; k += 11) { x = substr($0, k, 11) + 0; if (x > e) e = x }
         if (e == 0) e = 1e-30
         print e, substr($0, 40, 10)/unit, ($3 == "ROUNDING")
      }' "$2"
   # Empty blocks would not be counted: a point outside of the picture.
   printf '\n1e9 1e9 0\n\n\n'
}
# study PROGRAM DECK FILE: its tables, which are printed too
study() { rm -f "$3"; "$BUILD/$1" --study -o "$3" "$2" && cat "$3" && echo; }

tests/make_deck windows 1000 > "$out/windows_1000.deck" || exit 3
: > "$out/speed.txt"
: > "$out/scenes.txt"
for name in yoke four_bar andrews jansen dead_point_6 windows_1000; do
   deck=input/$name.deck
   if [ $name = windows_1000 ]; then
      deck=$out/$name.deck
      ratio=$("$BUILD/timed/study_ratio" $name "$out") || exit 3
   else
      # One set of computations is enough for a picture.
      awk '{ print } /^END/ { exit }' "$deck" > "$out/$name.deck"
      deck=$out/$name.deck
      ratio=$("$BUILD/timed/study_ratio" $name) || exit 3
   fi
   study kinmat "$deck" "$out/$name.txt" || exit 3
   study kinmat-single "$deck" "$out/$name.single.txt"
   study kinmat-quad "$deck" "$out/$name.quad.txt"
   steps=$(awk '/^TIME/ { print $2; exit }' "$deck")
   # 16 times the steps, if they are not too many for a study.
   rm -f "$out/$name.finer.txt"
   if [ "$steps" -lt 1000 ]; then
      awk -v steps="$((16*steps))" '/^TIME/ { $0 = sprintf("%-8s%-16s", "TIME", steps) substr($0, 25) } { print }' "$deck" > "$out/finer.deck"
      study kinmat "$out/finer.deck" "$out/$name.finer.txt"
   fi
   if [ "$ratio" = 0 ]; then
      echo ' There is no closed form of this scene that is written for speed.'
      factor=1
   else
      echo " The default (RATIO 1) takes $ratio times the time of the closed form at these steps, the least times of 25."
      factor=$ratio
   fi
   echo
   echo "$name $steps 0 $ratio" >> "$out/scenes.txt"
   unit=$(least "$out/$name.txt" | awk -v factor="$factor" '{ print $1/factor }')
   for way in 'NEWTON .txt' 'DENSE .txt' 'MATRIX .txt' 'NEWTON .single.txt' 'NEWTON .quad.txt' 'NEWTON .finer.txt'; do
      series "${way% *}" "$out/$name${way#* }" "$unit" >> "$out/speed.txt"
   done
done
draw() {
   gnuplot -e "form='$1'; numbers='$out/speed.txt'; scenes='$out/scenes.txt'; picture='$2'" tests/study/study.gp || exit 3
}
draw png docs/speed_against_error.png
draw svg "$out/speed.svg"
# Half of what gnuplot writes: without empty groups and attributes that say what is so anyway.
awk '/^<g .*>$/ { if (held != "") print held; held = $0; next }
   /^<\/g>/ && held != "" { held = ""; next }
   { if (held != "") print held; held = ""; sub(/^\t+/, ""); print }' "$out/speed.svg" \
   | sed 's/ stroke-linecap="butt" stroke-linejoin="miter"//' > docs/speed_against_error.svg
