#!/bin/sh
# The documents: every deck that README.md and docs/*.md print runs and gives the listing printed beside it; README.md is
# short; the manual has every card, option and message; every link leads somewhere.
#
# Blocks in the documents:
#    ```deck               a deck; it must run with exit status 0
#    ```listing [DECK]     what the deck above, or the file DECK, prints; a line ... stands for lines left out
#    ```refusal FILE SED   what the command says of FILE's first deck after it is changed by the sed expression
. tests/counting.sh

manual=docs/manual.md
documents='README.md docs/manual.md docs/method.md docs/evidence.md'

# in_order PRINTED FOUND: the lines of PRINTED stand in FOUND, next to one another but for `...`; tells the first that does not
in_order() {
   awk -v found="$2" '
      BEGIN { while ((getline line < found) > 0) text[++n] = line; at = 1 }
      /^[.][.][.]$/ { gap = 1; next }
      { if (gap) while (at <= n && text[at] != $0) at++
        gap = 0
        if (at > n || text[at] != $0) { print; exit }
        at++ }
      END { if (!gap && at <= n && text[at] != "") print "(the listing goes on)" }' "$1"
}

# The blocks of a document, each in a file of its own, and the words behind its three backquotes.
for document in $documents; do
   name=$(basename "$document" .md)
   awk -v base="$w/$name" '
      /^```/ && inside { inside = 0; close(file); next }
      /^```/ { inside = 1; file = sprintf("%s.%02d", base, ++n); print substr($0, 4) > (file ".head"); close(file ".head")
         printf "" > file; next }
      inside { print > file }
      END { if (inside) print "OPEN" > (base ".open") }' "$document"
   equal "$document: every block is closed" '' "$(cat "$w/$name.open" 2> /dev/null)"
done
for head in "$w"/*.head; do
   block=${head%.head}
   read -r kind words < "$head"
   place=$(basename "$block")
   case $kind in
   deck)
      deck=$block
      "$kinmat" "$block" > "$w/out" 2> "$w/err"
      equal "$place, deck: status" 0 $?
      equal "$place, deck: standard error" '' "$(cat "$w/err")" ;;
   listing)
      "$kinmat" "${words:-$deck}" > "$w/out" 2> "$w/err"
      equal "$place, listing" '' "$(in_order "$block" "$w/out")" ;;
   refusal)
      file=${words%% *}
      awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' "$file" | sed "${words#* }" > "$w/deck"
      "$kinmat" "$w/deck" > "$w/out" 2> "$w/err"
      equal "$place, refusal: status" 1 $?
      same "$place, refusal" "$block" "$w/err" ;;
   esac
done

# The numbers of the README are those of the closed forms: both of its decks have their listing in expected/.
for head in "$w"/README.*.head; do
   if grep -q '^listing' "$head"; then grep -hE '^ [A-Z0-9-]+ +-?[0-9]+[.][0-9]' "${head%.head}"; fi
done > "$w/rows"
equal 'README.md: rows are found' yes "$([ "$(wc -l < "$w/rows")" -ge 9 ] && echo yes)"
equal 'README.md: rows that no closed form has printed' '' "$(while IFS= read -r row; do
   grep -qxF -- "$row" expected/four_bar.lst expected/jarzmowy.lst || echo "$row"; done < "$w/rows")"

equal 'README.md: 150 lines at most' yes "$([ "$(wc -l < README.md)" -le 150 ] && echo yes)"
# The manual's contents, its first links, are all its chapters, in their order.
equal "$manual: its contents" "$(sed -n 's/^## //p' "$manual")" \
   "$(sed '/^Equation numbers/q' "$manual" | grep -o '\[[^]]*\](#' | sed 's/^.\(.*\).(#$/\1/')"
equal 'README.md: the first command' 1 "$(grep -cE '^ *(sudo )?apt-get .*make run' README.md)"

# The manual has every card and option, and every sentence that the sources can say.
has() { if grep -qF -- "$2" "$manual"; then pass; else miss "$manual lacks $1: $2"; fi; }
sources=$(find src -name '*.[fF]90')
sed -n "s/^ *form_t('[-LlWw]*', .*'\([A-Z]\{2,8\}\).*/\1/p" $sources | sort -u > "$w/cards"
equal 'cards are found' yes "$([ "$(wc -l < "$w/cards")" -ge 16 ] && echo yes)"
while read -r card; do has 'the card' "| $card |"; done < "$w/cards"
"$kinmat" --help | grep -oE '^ *-(-[a-z]+|o)' | tr -d ' ' > "$w/options"
while read -r option; do has 'the option' "\`$option"; done < "$w/options"
sed -n "s/.*code_t(\([0-9]*\), '\([^']*\)'.*/\1 \2/p" $sources > "$w/codes"
equal 'codes are found' yes "$([ "$(wc -l < "$w/codes")" -ge 70 ] && echo yes)"
while read -r number sentence; do has 'the code' "| E$(printf '%03d' "$number") | $sentence"; done < "$w/codes"
equal 'codes of the manual that no source has' '' "$(grep -oE '^[|] E0[0-9]+' "$manual" | tr -d '| E' | sed 's/^0*//' \
   | while read -r number; do grep -q "^$number " "$w/codes" || echo "$number"; done)"
grep -ohE "'E1[0-9][0-9]  " $sources | tr -d "' " | sort -u > "$w/faults"
equal 'faults are found' yes "$([ "$(wc -l < "$w/faults")" -ge 4 ] && echo yes)"
while read -r fault; do has 'the code' "| $fault |"; done < "$w/faults"
# The English of each phrase of the listing stands before its Polish.
sed -n "s/.*= phrase_t('\([^']*\)'.*/\1/p" $sources > "$w/phrases"
equal 'phrases are found' yes "$([ "$(wc -l < "$w/phrases")" -ge 60 ] && echo yes)"
while IFS= read -r phrase; do has 'the phrase' "$phrase"; done < "$w/phrases"
# Sentences of failures: the words in quotation marks behind `call fail`, those of two words and more.
awk '/call fail\(/ { on = 1 } on { n = split($0, part, "\047"); for (i = 2; i <= n; i += 2) print part[i] } !/&$/ { on = 0 }' $sources \
   | sed -e 's/^ *//' -e 's/["( ]*$//' | grep -E '^[-A-Za-z]+ .*[A-Z]' | grep -v '^[*]' | sort -u > "$w/sentences"
equal 'sentences are found' yes "$([ "$(wc -l < "$w/sentences")" -ge 20 ] && echo yes)"
while IFS= read -r sentence; do has 'the sentence' "$sentence"; done < "$w/sentences"

# Links: the file exists and, in a Markdown file, the heading.
for document in $documents; do
   grep -oE '(\]\([^)]*\)|src="[^"]*")' "$document" | sed -e 's/^](//' -e 's/)$//' -e 's/^src="//' -e 's/"$//' | sort -u \
      | while read -r link; do
         case $link in http*) continue ;; esac
         file=${link%%#*}
         target=$document
         [ -n "$file" ] && target=$(dirname "$document")/$file
         equal "$document: link $link" yes "$([ -s "$target" ] && echo yes)"
         case $link in *'#'*)
            equal "$document: heading of $link" yes "$(sed -n 's/^##* //p' "$target" | tr 'A-Z' 'a-z' | sed -e 's/[^a-z0-9 _-]//g' -e 's/ /-/g' \
               | grep -qxF -- "${link#*#}" && echo yes)" ;;
         esac
      done
done
# The example of the modules, against the angles of the rocker in the listing that closed forms have printed.
equal 'make example' "$(awk '/END OF SET/ { exit } /^ ROCKER / && $2 != "" && NF > 8 { x = $4*atan2(0, -1)/180
      if (!n++ || x < low) low = x
      if (n == 1 || x > high) high = x }
   END { printf "The rocker swings from %9.6f to %9.6f rad.", low, high }' expected/four_bar.lst)" "$("$BUILD/example")"
conclude
