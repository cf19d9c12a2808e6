#!/bin/sh
# Cards and options in pairs: every two of these cards in one deck, in a build with run-time checks; what has a CSV or a summary
# alone, in the other build. The run ends well, or says
# which card needs METHOD NEWTON; what else is asked for changes no byte of the listing, of the CSV or of the summary, and
# variants of which rows alone are asked have those rows.
. tests/counting.sh

# What stands below a point of the crank, below one of the coupler, or at the end of the set.
features='vary tolerances branch extremes extremes_of_pairs assembly circuits range prove dense matrix polish at second pole'
crank() { [ "$1" = vary ] && card VARY R1 3 '' 0.5 1.9; }
coupler() { [ "$1" = tolerances ] && card TOLER '' '' '' 0.01; }
others() {
   case $1 in
   branch) card BRANCH '' '' '' 3.0;;
   extremes) card EXTREMES POINTS C;;
   extremes_of_pairs) card EXTREMES PAIRS;;
   assembly) card ASSEMBLY;;
   circuits) card CIRCUITS;;
   range) card RANGE;;
   prove) card PROVE;;
   dense) card METHOD DENSE;;
   matrix) card METHOD MATRIX;;
   polish) card LANG PL;;
   at) card AT '' '' '' 0.5 2.25;;
   pole) card POLE BASE COUPLER;;
   second) card LINK ARM '' '' 9.0 0.0 10.0; card POINT Q ARM; card POINT Q0 BASE '' 9.0; card REVOLUTE Q Q0 PAIR-Q
      card DRIVE ANGLE ARM '' 10.0 5.0;;
   esac
}
# deck A B CARD...: a four-bar with both, and these cards
deck() {
   a=$1 b=$2
   shift 2
   moving_four_bar "$(crank "$a"; crank "$b")" "$(coupler "$a"; coupler "$b"; card POINT C COUPLER '' 1.0 1.0)" '' '' \
      "$(card TIME 8 '' '' 0.0 4.0; others "$a"; others "$b")" "$@"
}
# run BUILD NAME OPTION...: the status and, of standard error, the sentences of errors and crashes
run() {
   build=$1 name=$2
   shift 2
   "$build" "$w/deck" --jobs 1 "$@" > "$w/$name.out" 2> "$w/$name.err"
   status=$?
   if [ -s "$w/$name.err" ]; then
      echo "$status $(sed -nE '/^( [*]{3}|At line|Fortran|Program)/s/.*REQUIRES METHOD NEWTON$/needs NEWTON/; /^(needs| [*]{3}|At line|Fortran|Program)/p' "$w/$name.err")"
   else
      echo "$status "
   fi
}

rest=$features
for a in $features; do
   rest=${rest#* }
   for b in $rest; do
      [ "$b" = "$a" ] && continue
      deck "$a" "$b" "$(card PRINT ALL)" > "$w/deck"
      said=$(run "$debug" plain -o "$w/plain.lst")
      case $said in
      0\ |2\ ) pass;;
      '1 needs NEWTON') pass; continue;;
      *) [ "$a $b" = "dense matrix" ] || miss "$a, $b: $said"; continue;;
      esac
      rm -f "$w"/*.csv "$w"/*.sum
      # A picture computes hundreds of instants: it is asked for with the cards that it draws.
      case "$a $b" in *pole*|*second*) picture="--svg $w/svg";; *) picture=;; esac
      equal "$a, $b, all outputs" "$said" \
         "$(run "$debug" all -o "$w/all.lst" --errors --csv "$w/all.csv" --log "$w/log" $picture --summary "$w/all.sum")"
      same "$a, $b: listing beside other outputs" "$w/plain.lst" "$w/all.lst"
      equal "$a, $b, no listing" "$said" "$(run "$kinmat" none --no-listing --errors --csv "$w/none.csv" --summary "$w/none.sum")"
      same "$a, $b: CSV without a listing" "$w/all.csv" "$w/none.csv"
      equal "$a, $b, summary alone" "$said" "$(run "$kinmat" summary --no-listing --summary "$w/summary.sum")"
      deck "$a" "$b" > "$w/deck"
      equal "$a, $b, rows alone" "$said" "$(run "$debug" rows --no-listing --summary "$w/rows.sum")"
      for file in none summary rows; do same "$a, $b: summary, $file" "$w/all.sum" "$w/$file.sum"; done
   done
done
conclude
