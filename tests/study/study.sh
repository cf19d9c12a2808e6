#!/bin/sh
# make study: kinmat --study for six scenes, its tables on standard output and in $BUILD/study/, each with the time of the
# default method beside the closed form where there is one; then the pictures. Error and time of every trial:
# $BUILD/study/speed.txt, a scene a block of blocks, read by tests/study/study.gp.
BUILD=${BUILD:-build}
out=$BUILD/study
mkdir -p "$out" docs || exit 3
OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}
export OPENBLAS_NUM_THREADS

# series WAY LAST FILE FACTOR: error and time of the rows of section 1 or 4 of that way, of LAST steps; of times the least,
# over the least of the default: what else the machine does makes it longer, never shorter
series() {
   awk -v way="$1" -v last="$2" -v factor="$4" -v unit="$(awk '/^ 4  /  { on = 1 } on && /^ BLOCKS  .* ROUND/ { print substr($0, 44, 8); exit }' "$3")" '
      /^ [1-4]  [A-Z]/ { section = $1 }
      /^ CHEAPEST/ { exit }
      section != 1 && section != 4 { next }
      /^ (BLOCKS|DENSE|MATRIX)/ {
         name = substr($0, 2, 12); sub(/ *$/, "", name)
         if (name != way || substr($0, 30, 6) + 0 != last || (section == 4 && way !~ /P$/)) next
         ratio = substr($0, 44, 8)/unit
         e = 0
         for (k = 73; k <= 105; k += 16) { x = substr($0, k, 8); gsub(/[ <]/, "", x); if (x + 0 > e) e = x + 0 }
         if (ratio > 0 && e > 0) print e, ratio*factor, (substr($0, 20, 10) ~ /ROUNDING/)
      }' "$3"
   # Empty blocks would not be counted: a point outside of the picture.
   printf '\n1e9 1e9 0\n\n\n'
}

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
   "$BUILD/kinmat" --study -o "$out/$name.txt" "$deck" || exit 3
   cat "$out/$name.txt"
   if [ "$ratio" = 0 ]; then
      echo ' There is no closed form of this scene that is written for speed.'
      factor=1
   else
      echo " The default (RATIO 1) takes $ratio times the time of the closed form at these steps, the least times of 25."
      factor=$ratio
   fi
   echo
   steps=$(awk '/STEPS, .* LINKS/ { print $1; exit }' "$out/$name.txt")
   finest=$(awk '/^ 1  TOL/ { on = 1 } /^ 2  / { exit } on && /^ BLOCKS/ { if (substr($0, 30, 6) + 0 > n) n = substr($0, 30, 6) + 0 }
      END { print n }' "$out/$name.txt")
   echo "$name $steps $finest $ratio" >> "$out/scenes.txt"
   for way in 'BLOCKS' 'DENSE' 'MATRIX' 'MATRIX FIXED' 'BLOCKS SP' 'BLOCKS QP'; do
      series "$way" "$steps" "$out/$name.txt" "$factor" >> "$out/speed.txt"
   done
   [ "$finest" = "$steps" ] && finest=-1
   series BLOCKS "$finest" "$out/$name.txt" "$factor" >> "$out/speed.txt"
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
