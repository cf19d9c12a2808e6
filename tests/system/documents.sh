#!/bin/sh
# The documents, README.md and all of docs/: every deck runs and gives the listing printed beside it, every command and every
# message is what the program prints; the cards, options and messages of the sources all stand there; every link lives.
#
# Blocks in the documents:
#    ```deck [FILE [STATUS]]  a deck; it must run with this exit status, 0 unless given. FILE is its name in the commands below it
#    ```layout CARD           the fields of a card as --ruler prints them, and a filled card that stands in a deck of the document
#    ```listing [DECK]        what the deck above, or the file DECK, prints; a line ... stands for lines left out
#    ```refusal FILE SED      what the command says of FILE's first deck after it is changed by the sed expression
#    ```sh [STATUS]           commands, run in a directory with the decks of the document; many_sets.sh runs those of many_sets.md
#    ```python [MODULE...]    a program, run in that directory if python3 has the modules, pandas unless given
#    ```output                what the commands or the program above print, as a listing
. tests/counting.sh

documents=$(find README.md docs -name '*.md' | LC_ALL=C sort)
PATH=$BUILD:$PWD/contrib:$PATH
PYTHONPATH=$PWD/contrib
LIBKINMAT=$BUILD/libkinmat.so.2
PYTHONDONTWRITEBYTECODE=1
export PATH PYTHONPATH LIBKINMAT PYTHONDONTWRITEBYTECODE
"${MAKE:-make}" --no-print-directory BUILD="$BUILD" shared > "$w/out" 2>&1
equal 'the library that the documents use' 0 $?
missing=$(python3 -c 'import importlib.util
for name in "numpy", "pandas", "scipy":
   if not importlib.util.find_spec(name): print(end=" " + name)')
[ -z "$missing" ] || echo "skipped: programs in the documents with what python3 has not:$missing"

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

# The blocks of a document, each in a file of its own in a directory of the document, and the words behind its three backquotes.
for document in $documents; do
   place=$w/$(echo "${document%.md}" | tr / _)
   mkdir -p "$place/run"
   awk -v base="$place/block" '
      /^```/ && inside { inside = 0; close(file); next }
      /^```/ { inside = 1; file = sprintf("%s.%03d", base, ++n); print substr($0, 4) > (file ".head"); close(file ".head")
         printf "" > file; next }
      inside { print > file }
      END { if (inside) print "OPEN" > (base ".open") }' "$document"
   equal "$document: every block is closed" '' "$(cat "$place/block.open" 2> /dev/null)"
   for head in "$place"/*.head; do
      [ -e "$head" ] || continue
      block=${head%.head}
      read -r kind words < "$head"
      name="$document, block ${block##*.}, $kind"
      case $kind in
      deck)
         deck=$block
         file=${words%% *} status=${words#* }
         [ "$status" = "$words" ] && status=0
         [ -n "$file" ] && cp "$block" "$place/run/$file"
         ends "$name" "$status" "$block"
         equal "$name: standard error" '' "$(cat "$w/err")" ;;
      layout)
         "$kinmat" --ruler "$words" | head -n 2 > "$w/out"
         equal "$name: as --ruler prints it" "$(cat "$w/out")" "$(head -n 2 "$block")"
         equal "$name: the filled card stands in a deck" '' "$(tail -n +3 "$block" | while IFS= read -r line; do
            grep -qxF -- "$line" $(grep -l '^deck' "$place"/*.head | sed 's/[.]head$//') || echo "$line"; done)" ;;
      listing)
         "$kinmat" "${words:-$deck}" > "$w/out" 2> "$w/err"
         equal "$name" '' "$(in_order "$block" "$w/out")" ;;
      refusal)
         awk '/^```deck/ { on = 1; next } /^```/ && on { exit } on' "${words%% *}" | sed "${words#* }" > "$w/deck"
         ends "$name" 1 "$w/deck"
         same "$name" "$block" "$w/err" ;;
      sh)
         [ "$document" = docs/many_sets.md ] && continue
         (cd "$place/run" && sh "$block") > "$w/printed" 2> "$w/err"
         equal "$name: status" "${words:-0}" $?
         equal "$name: standard error" '' "$(cat "$w/err")" ;;
      python)
         is_run=yes
         for module in ${words:-pandas}; do case "$missing " in *" $module "*) is_run= ;; esac; done
         if [ -n "$is_run" ]; then
            (cd "$place/run" && python3 "$block") > "$w/printed" 2> "$w/err"
            equal "$name: status" 0 $?
            cat "$w/err"
         fi ;;
      output)
         [ "$last" = python ] && [ -z "$is_run" ] || equal "$name" '' "$(in_order "$block" "$w/printed")" ;;
      text | '') ;;
      *) miss "$name: no such kind of block" ;;
      esac
      last=$kind
   done
done

# The numbers of the README are those of the closed forms: its mechanisms have their listings in expected/.
for head in "$w"/README/*.head; do
   if grep -q '^listing' "$head"; then grep -hE '^ [A-Z0-9-]+ +-?[0-9]+[.][0-9]' "${head%.head}"; fi
done > "$w/rows"
equal 'README.md: rows are found' yes "$([ "$(wc -l < "$w/rows")" -ge 6 ] && echo yes)"
equal 'README.md: rows that no closed form has printed' '' "$(while IFS= read -r row; do
   grep -qxF -- "$row" expected/drawing.lst expected/jarzmowy.lst || echo "$row"; done < "$w/rows")"

# The contents of a document, its links to itself before the first chapter, are all its chapters, in their order.
for document in docs/outputs.md docs/messages.md docs/evidence.md docs/developing.md; do
   equal "$document: its contents" "$(sed -n 's/^## //p' "$document")" \
      "$(sed '/^## /q' "$document" | tr '\n' ' ' | grep -o '\[[^]]*\](#' | sed 's/^.\(.*\).(#$/\1/')"
done
equal 'CITATION.cff: the version' "$("$kinmat" --version | sed 's/^KINMAT //; s/,.*//')" "$(sed -n 's/^version: "\(.*\)"$/\1/p' CITATION.cff)"
equal 'README.md: the first command' 1 "$(grep -cE '^ *(sudo )?apt-get .*make run' README.md)"

# Every card, option and message that the sources have. has FILE WHAT: each line of standard input stands in FILE.
cat docs/cards.md docs/outputs.md docs/messages.md docs/limits.md docs/glossary.md | tr '\n' ' ' | tr -s ' ' > "$w/reference"
has() {
   awk -v counts="$counts" 'NR == FNR { text = $0; next } index(text, $0) { print "passed" >> counts; next } 1' RS='\001' "$1" RS='\n' - > "$w/lacking"
   while IFS= read -r line; do miss "${1#"$w"/} lacks $2: $line"; done < "$w/lacking"
}
sources=$(find src -name '*.[fF]90')
sed -n "s/^ *form_t('[-LlWw]*', .*'\([A-Z]\{2,8\}\).*/\1/p" $sources | sort -u > "$w/cards"
equal 'cards are found' yes "$([ "$(wc -l < "$w/cards")" -ge 16 ] && echo yes)"
equal 'docs/cards.md: the ruler' yes "$(grep -qxF -- "$("$kinmat" --ruler | head -n 1)" docs/cards.md && echo yes)"
# The section of a card: its layout, a deck that has it or a link to one, and what to see also.
sed 's/^/## /' "$w/cards" | has docs/cards.md 'the section of the card'
while read -r card; do
   awk -v card="$card" '/^## / { on = $2 == card } on' docs/cards.md > "$w/section"
   equal "docs/cards.md, $card: its layout" 1 "$(grep -cxF -- "\`\`\`layout $card" "$w/section")"
   equal "docs/cards.md, $card: a row for each of its fields" "$("$kinmat" --ruler "$card" | awk -v card="$card" '
      NR == 2 && card != "TITLE" { split("9 17 25 33 49 65 81", from, " "); split("LABEL-A LABEL-B LABEL-C REAL-1 REAL-2 REAL-3", name, " ")
         for (i = 1; i <= 6; i++) if (substr($0, from[i], from[i + 1] - from[i]) ~ /[^ ]/) printf "%s ", name[i] }')" \
      "$(awk '/^[|] Field / { on = 1 } !/^[|]/ { on = 0 } on && /^[|] (LABEL|REAL)-/ { printf "%s ", $2 }' "$w/section")"
   equal "docs/cards.md, $card: an example" yes "$(grep -qE '^Example: |^```deck' "$w/section" && echo yes)"
   equal "docs/cards.md, $card: see also" yes "$(tr '\n' ' ' < "$w/section" | grep -q 'See also' && echo yes)"
   equal "docs/cards.md, $card: six remarks at most" '' "$(grep '^7[.] ' "$w/section")"
   equal "docs/cards.md, $card: a deck that the tests run" yes "$(awk '/^```deck/ { on = 1; next } /^```/ { on = 0 } on' docs/cards.md \
      | cut -c 1-8 | sed 's/ *$//' | grep -qxF -- "$card" && echo yes)"
done < "$w/cards"
for kind in ANGLE X Y RELANGLE SLIDE; do
   equal "docs/cards.md, DRIVE $kind: a deck" yes "$(awk '/^```deck/ { on = 1; next } /^```/ { on = 0 } on' docs/cards.md \
      | cut -c 1-16 | sed 's/ *$//' | grep -qxF "DRIVE   $kind" && echo yes)"
done
"$kinmat" --help | grep -oE '^ *-(-[a-z]+|o)' | tr -d ' ' > "$w/options"
sed 's/^/| `/' "$w/options" | has docs/command.md 'the option'
sed -n "s/.*code_t(\([0-9]*\), '\([^']*\)'.*/\1 \2/p" $sources > "$w/codes"
equal 'codes are found' yes "$([ "$(wc -l < "$w/codes")" -ge 55 ] && echo yes)"
awk '{ number = $1; sub(/^[0-9]+ /, ""); printf "| E%03d | %s\n", number, $0 }' "$w/codes" | has docs/messages.md 'the code'
equal 'codes of docs/messages.md that no source has' '' "$(grep -oE '^[|] E0[0-9]+' docs/messages.md | tr -d '| E' | sed 's/^0*//' \
   | while read -r number; do grep -q "^$number " "$w/codes" || echo "$number"; done)"
grep -ohE "'E1[0-9][0-9]  " $sources | tr -d "' " | sort -u > "$w/faults"
equal 'faults are found' yes "$([ "$(wc -l < "$w/faults")" -ge 4 ] && echo yes)"
sed 's/.*/| & |/' "$w/faults" | has docs/messages.md 'the code'
# The English of each phrase of the listing stands before its Polish.
sed -n "s/.*= phrase_t('\([^']*\)'.*/\1/p" $sources > "$w/phrases"
equal 'phrases are found' yes "$([ "$(wc -l < "$w/phrases")" -ge 60 ] && echo yes)"
has "$w/reference" 'the phrase' < "$w/phrases"
# So do the heads of columns and the words of cells; a head with the name of a link ends with -I or -J.
grep -oE "(row_column|cell_word)_t[(]'[^']+'" src/mechanism/columns.f90 | cut -d "'" -f 2 | sort -u > "$w/heads"
equal 'heads of columns are found' yes "$([ "$(wc -l < "$w/heads")" -ge 20 ] && echo yes)"
has "$w/reference" 'the head' < "$w/heads"
# Sentences of failures: the words in quotation marks behind `call fail` and `call reject`, those of two words and more.
awk '/call (fail|reject)\(/ { on = 1 } on { n = split($0, part, "\047"); for (i = 2; i <= n; i += 2) print part[i] } !/&$/ { on = 0 }' $sources \
   | sed -e 's/^ *//' -e 's/["( ]*$//' | grep -E '^[-A-Za-z]+ .*[A-Z]' | grep -v '^[*]' | sort -u > "$w/sentences"
equal 'sentences are found' yes "$([ "$(wc -l < "$w/sentences")" -ge 20 ] && echo yes)"
has docs/messages.md 'the sentence' < "$w/sentences"

# Each how-to has a deck, a command that runs, and a picture.
for document in docs/howto/*.md; do
   for block in '```deck' '```sh' '!['; do equal "$document: $block" yes "$(grep -qF "$block" "$document" && echo yes)"; done
done

# Tables: each row is one line with the cells of its head, and each error has a cause and a cure.
for document in $documents CHANGELOG.md src/README.md; do
   equal "$document: rows of tables with other cells than their heads" '' "$(awk '
      /^[|]/ { line = $0; gsub(/\\[|]/, "", line); gsub(/`[^`]*`/, "x", line); n = gsub(/[|]/, "", line)
         if (!cells) cells = n
         if (n != cells || !/[|]$/) print FNR
         next }
      /^```/ { fenced = !fenced }
      cells && !fenced && NF { print FNR }
      { cells = 0 }
      # Rows of a table are no text with a gap in it for each column.
      !fenced && /^    / && !/=/ && gsub(/[^ ]   +[^ ]/, "") > 3 { print FNR }' "$document")"
done
equal 'docs/messages.md: errors without cause or cure' '' "$(grep -E '^[|] E[0-9]+ ' docs/messages.md | grep -E '[|] *[|]')"

# Links: the file exists and, in a Markdown file, the heading. They are relative, so that they live where they are installed. Of each
# link a row: its document, itself, the file, the heading.
grep -oHE '(\]\([^)]*\)|src="[^"]*")' $documents src/README.md | sed -e 's/:](/ /' -e 's/)$//' -e 's/:src="/ /' -e 's/"$//' | sort -u | awk '
   $2 ~ /^http/ { next }
   {
      file = $2; sub(/#.*/, "", file); heading = index($2, "#") ? substr($2, index($2, "#") + 1) : "-"
      folder = $1; if (!sub(/[^\/]*$/, "", folder)) folder = ""
      file = file == "" ? $1 : folder file
      while (sub(/[^\/.]+\/[.][.]\//, "", file)) continue
      print $1, $2, file, heading
   }' > "$w/links"
equal 'links are found' yes "$([ "$(wc -l < "$w/links")" -ge 300 ] && echo yes)"
while read -r document link file heading; do
   if [ -s "$file" ]; then pass; else miss "$document: link $link"; fi
done < "$w/links"
awk 'NR == FNR { if ($4 != "-") asked[$3]; next } FILENAME in asked && /^##* / { sub(/^#* /, ""); $0 = tolower($0); gsub(/[^a-z0-9 _-]/, ""); gsub(/ /, "-"); print FILENAME, $0 }' \
   "$w/links" $documents src/README.md > "$w/headings"
awk -v counts="$counts" 'NR == FNR { has[$0]; next } $4 != "-" { if (($3 " " $4) in has) print "passed" >> counts; else print $1 ": heading of " $2 }' \
   "$w/headings" "$w/links" > "$w/lacking"
while IFS= read -r line; do miss "$line"; done < "$w/lacking"

# Every document is reached from the README by links alone.
awk '$3 ~ /[.]md$/ && $2 !~ /^#/ { n++; from[n] = $1; to[n] = $3 }
   END { reached["README.md"]; do { more = 0; for (i = 1; i <= n; i++) if (from[i] in reached && !(to[i] in reached)) { reached[to[i]]; more = 1 } } while (more)
      for (file in reached) print file }' "$w/links" > "$w/reached"
for document in $documents; do
   if grep -qxF -- "$document" "$w/reached"; then pass; else miss "$document: reached from README.md"; fi
done

# The example of the modules, against the angles of the rocker in the listing that closed forms have printed.
equal 'make example' "$(awk '/END OF SET/ { exit } /^ ROCKER / && $2 != "" && NF > 8 { x = $4*atan2(0, -1)/180
      if (!n++ || x < low) low = x
      if (n == 1 || x > high) high = x }
   END { printf "The rocker swings from %9.6f to %9.6f rad.", low, high }' expected/four_bar.lst)" "$("$BUILD/example")"
# The program of src/README.md, against the rocker's row of the first instant there.
awk '/^```fortran/ { on = 1; next } /^```/ { on = 0 } on' src/README.md > "$w/ten_lines.f90"
"${FC:-gfortran}" -fno-lto -fno-use-linker-plugin -I"$BUILD/release" -J"$w" -o "$w/ten_lines" "$w/ten_lines.f90" "$BUILD/release/libkinmat.a" \
   -lklu -llapack -lblas > "$w/out" 2>&1
equal 'the program of src/README.md: compiled' 0 $?
equal 'the program of src/README.md' "$(awk '/^ ROCKER / && $4 != "" && NF > 8 { printf "%10.6f%10.6f%10.6f", $2, $3, $4*atan2(0, -1)/180; exit }' \
   expected/four_bar.lst)" "$("$w/ten_lines")"
conclude
