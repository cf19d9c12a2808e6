# The changes that `make mutants` may make, one at a time, in Fortran sources:
#   awk -v seed=1 -v wanted=200 -f mutate.awk FILES | sort -n    a random choice, in the order in which to try them
#   awk -v all=1 -f mutate.awk FILES                             every change of every line
# A line of the output: rank, file, first and last line of the change, the old text, the new text; a tab between two.
# Comments, strings, use statements, headings and declarations stay; the value of a named constant does not.
# Every folder gets a share of `wanted` in proportion to its lines of code; what does not compile is made up for by those
# that follow.

# The line without its comment; a sign ~ for every character of a string. `quote` is the string that is open.
function mask(s,  i, c, out) {
   out = ""
   for (i = 1; i <= length(s); i++) {
      c = substr(s, i, 1)
      if (quote != "") { if (c == quote) quote = ""; out = out "~" }
      else if (c == "'" || c == "\"") { quote = c; out = out "~" }
      else if (c == "!") break
      else out = out c
   }
   sub(/[ ]+$/, "", out)
   return out
}

# One more change of line `at` of this file: the columns from..to become `text`.
function change(from, to, text) {
   offer(at, at, substr(line[at], 1, from - 1) text substr(line[at], to + 1))
}

function offer(first, last, text) {
   offers[++offered] = file "\t" first "\t" last "\t" tidy(line[first]) "\t" tidy(text)
   of_line[at] = of_line[at] " " offered
}

function tidy(s) { sub(/^ +/, "", s); return s }

# The character before or after column i that is no blank.
function before(s, i) { while (--i > 0 && substr(s, i, 1) == " "); return i > 0 ? substr(s, i, 1) : "" }

# Changes of operators, words and numbers in the columns of masked text s from column `start` on.
function change_tokens(s, start, inside,  i, c, n, p, word, rest) {
   for (i = start; i <= length(s); i++) {
      c = substr(s, i, 1); n = substr(s, i + 1, 1); p = before(s, i)
      rest = substr(s, i)
      if (match(rest, /^[A-Za-z_][A-Za-z0-9_]*/)) {
         word = tolower(substr(rest, 1, RLENGTH))
         if (word in twin && substr(rest, RLENGTH + 1, 1) == "(") change(i, i + RLENGTH - 1, twin[word])
         if (word == "exit" || word == "cycle") change(i, i + RLENGTH - 1, word == "exit" ? "cycle" : "exit")
         i += RLENGTH - 1
      } else if (match(rest, /^[0-9]+([.][0-9]*)?([eEdD][-+]?[0-9]+)?(_[A-Za-z0-9_]+)?/)) {
         change_number(i, substr(rest, 1, RLENGTH))
         i += RLENGTH - 1
      } else if (match(rest, /^[.][a-z]+[.]/)) {
         word = substr(rest, 1, RLENGTH)
         if (word == ".not.") change(i, i + RLENGTH, "")
         else if (word in twin) change(i, i + RLENGTH - 1, twin[word])
         i += RLENGTH - 1
      } else if (c n == "<=" || c n == ">=") {
         change(i, i + 1, c); change(i, i + 1, c == "<" ? ">" : "<"); i++
      } else if (c n == "==" || c n == "/=") {
         change(i, i + 1, c n == "==" ? "/=" : "=="); i++
      } else if (c n == "=>" || c n == "//" || c n == "**") i++
      else if (c == "<" || c == ">") {
         change(i, i, c "="); change(i, i, c == "<" ? ">=" : "<=")
      } else if (c == "+" || c == "-") {
         if (p ~ /[A-Za-z0-9_)\]~]/ || (p == "" && inside)) change(i, i, c == "+" ? "-" : "+")
         else if (c == "-") change(i, i, "")
      } else if ((c == "*" || c == "/") && p ~ /[A-Za-z0-9_)\]]/) change(i, i, c == "*" ? "/" : "*")
   }
}

function change_number(i, number) {
   if (substr(line[at], 1, i - 1) ~ /(epsilon|huge|tiny|kind|digits)[(]$/) return     # the kind alone counts
   if (number !~ /^[0-9]+$/) change(i, i + length(number) - 1, number + 0 == 0 ? "1" substr(number, 2) : "(2*" number ")")
   else {
      change(i, i + length(number) - 1, number + 1)
      if (number > 0) change(i, i + length(number) - 1, number - 1)
   }
}

# Where text s has the character c outside of parentheses, from column i on; 0: nowhere.
function outside(s, i, c,  depth, x) {
   for (; i <= length(s); i++) {
      x = substr(s, i, 1)
      if (depth == 0 && x == c && substr(s, i + 1, 1) !~ /[=>]/ && substr(s, i - 1, 1) !~ /[=<>\/]/) return i
      if (x ~ /[(\[]/) depth++
      if (x ~ /[)\]]/) depth--
   }
   return 0
}

# Where the parenthesis that opens in column i closes; 0: not in this text.
function closing(s, i,  depth, x) {
   for (; i <= length(s); i++) {
      x = substr(s, i, 1)
      if (x == "(") depth++
      if (x == ")" && --depth == 0) return i
   }
   return 0
}

# The bounds of a loop `do i = a, b`, a step shorter at either end.
function change_loop(s,  equal, comma, last) {
   if (!(equal = outside(s, 1, "=")) || !(comma = outside(s, equal + 1, ","))) return
   last = outside(s, comma + 1, ",")
   if (!last) last = length(s) + 1
   change(comma, comma - 1, " + 1")
   change(last, last - 1, " - 1")
}

# All changes of the statement in lines first..last; `whole` is its masked text.
function change_statement(first, last, whole,  i, start, close_at) {
   at = first
   if (whole ~ /^ *(use|implicit|module|submodule|program|contains|end|public|private|import|sequence|abstract|bind|format|#)/) return
   if (whole ~ /^ *((pure|elemental|recursive|impure) )*[a-z]*([(][^)]*[)]+)? *(subroutine|function) / ||
       whole ~ /^ *(pure |elemental |recursive |impure )/ || whole ~ /^ *(class|type) +is /) return
   if (whole ~ /^ *(type *[,:]|type +[a-z]|class *[(]|procedure|generic|final|character|select type|associate|block|else *$)/) return
   # A declaration: the value of a named constant alone.
   if (whole ~ /^ *(integer|real|complex|logical|type|enumerator).*::/) {
      if (whole !~ /parameter|enumerator/) return
      for (i = first; i <= last; i++) {
         at = i
         start = i == first ? outside(masked[i], index(masked[i], "::") + 2, "=") : 1
         if (start) change_tokens(masked[i], start + (i == first), i > first)
         else if (i == first) return
      }
      return
   }
   # What a fault there does to files outside is not for trying.
   if (whole ~ /execute_command_line|unlink/ || line[first] ~ /rm -rf/) return
   if (whole ~ /^ *(call|exit|cycle|return|deallocate|allocate)([ (]|$)/ || (whole ~ /^ *if *[(]/ && whole !~ /then *$/) ||
       (whole !~ /^ *([a-z_]+: *)?(if|else|do|case|select|where|forall|write|read|open|close|inquire)[ (]/ &&
        (outside(whole, 1, "=") || whole ~ /=>/))) offer(first, last, "")
   if (whole ~ /^ *([a-z_]+: *)?do +[a-z_0-9]+ *=/ && first == last) change_loop(masked[first])
   if (match(masked[first], /^ *(else )?if *[(]/) && (close_at = closing(masked[first], RLENGTH)))
      offer(first, first, substr(line[first], 1, RLENGTH) ".not. " substr(line[first], RLENGTH, close_at - RLENGTH) ")" substr(line[first], close_at))
   for (at = first; at <= last; at++) change_tokens(masked[at], 1, at > first)
}

# Offers the changes of the file that has been read.
function end_of_file(  i, first, whole, in_interface) {
   first = 0
   for (i = 1; i <= lines; i++) {
      if (masked[i] ~ /^ *$/) continue
      code++
      code_of[folder]++
      if (!first) { first = i; whole = masked[i] } else whole = whole " " tidy(masked[i])
      if (whole ~ /&$/) { sub(/ *&$/, "", whole); continue }
      if (whole ~ /^ *(abstract )?interface( |$)/) in_interface = 1
      if (!in_interface) change_statement(first, i, whole)
      if (whole ~ /^ *end interface/) in_interface = 0
      first = 0
   }
   for (i = 1; i <= lines; i++) if (i in of_line) {
      if (all) { n = split(of_line[i], list, " "); for (k = 1; k <= n; k++) print 0 "\t" offers[list[k]] }
      else { candidates[folder, ++candidate_count[folder]] = pick(of_line[i]) }
   }
   split("", of_line); split("", offers); split("", masked); split("", line)
   offered = 0; lines = 0; quote = ""
}

# The same numbers from every awk.
function random(n) { state = (16807*state) % 2147483647; return int(n*(state/2147483647)) + 1 }

# One of a line's changes.
function pick(numbers,  list, n) { n = split(numbers, list, " "); return offers[list[random(n)]] }

BEGIN {
   FS = "\n"
   state = seed*7919 % 2147483646 + 1
   for (i = 0; i < 5; i++) random(1)
   n = split("max min maxval minval maxloc minloc any all sin cos floor ceiling .and. .or. .true. .false. .eqv. .neqv.", words, " ")
   for (i = 1; i < n; i += 2) { twin[words[i]] = words[i + 1]; twin[words[i + 1]] = words[i] }
   split("", of_line)
}
FNR == 1 {
   if (file != "") end_of_file()
   file = FILENAME; folder = file; sub(/\/[^\/]*$/, "", folder)
   if (!(folder in code_of)) { folders[++folder_count] = folder; code_of[folder] = 0 }
}
{ line[++lines] = $0; masked[lines] = mask($0) }
END {
   end_of_file()
   if (all) exit
   for (f = 1; f <= folder_count; f++) {
      folder = folders[f]
      n = candidate_count[folder]
      share = wanted*code_of[folder]/code
      # The first of a shuffled list, twice as many as wanted.
      for (k = 1; k <= n && k <= 2*share + 5; k++) {
         j = k + random(n - k + 1) - 1
         swap = candidates[folder, j]; candidates[folder, j] = candidates[folder, k]; candidates[folder, k] = swap
         printf "%.6f\t%s\n", (k - 0.5)/share, swap
      }
   }
}
