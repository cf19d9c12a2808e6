# awk -f shown_digits.awk EXPECTED LISTING: every number of LISTING against the one in its place in EXPECTED, by the digits that it
# shows. It may differ by one unit of the last of them, since it is rounded to it. Lines of remarks are passed over. Prints what is
# wrong, then how many numbers were compared.
# A sensitivity is a difference of rows, and 24 bits leave more of it open. Rows are off by about 20 roundings of 6E-8. The
# shortest of its steps is 0.0106 to either side, of which it has 4096/2835: so it is off by 20*6E-8/0.0212*1.44 = 8E-5 of
# the largest. One with a share of 0.1 % is a thirtieth of that, so that 2.5E-3 of it are open.
function is_number(text) { return text ~ /^-?[0-9?]+[.][0-9?]*(E[+-][0-9]+)?$/ }
# The worth of the last digit of `text` that is shown: 0.01 of 12.34????, 10 of 5?.???
function last_digit(text, shown) {
   if (text ~ /E/) return last_digit(substr(text, 1, index(text, "E") - 1))*10^substr(text, index(text, "E") + 1)
   shown = text
   sub(/[?.]*$/, "", shown)
   if (shown ~ /[.]/) return 10^(index(shown, ".") - length(shown))
   sub(/[.].*/, "", text)
   return 10^(length(text) - length(shown))
}
function size(text) { gsub(/[?]/, "0", text); return text + 0 }
# The cards of assemblies are estimates, whose digits are those of a card. The largest gap is rounding.
/^ ---/ || /^ LARGEST/ || /^ ?LINK .*[.].*[.].*[.]/ || NF == 0 { next }
# Heads with their units stand again after a remark, and remarks are not the same.
/^          / || /^ (LINK|POINT|PAIR|MEASURE|OGNIWO|PUNKT|PARA|WIELKOSC|POLE|CURVE|BIEGUN|TOR)  +(X|PHI|FI|SLIDE|LENGTH|ANGLE|PRZESUW|DLUGOSC|KAT) / { next }
FNR == NR { line[++lines] = $0; next }
{
   count = split(line[++n], wanted)
   if ($1 != wanted[1] && !is_number($1)) print "line " n ": " $1 ", not " wanted[1]
   for (i = 1; i <= NF && i <= count; i++) {
      if (!is_number($i) || !is_number(wanted[i]) || $i !~ /[0-9]/) continue
      compared++
      off = size($i) - size(wanted[i])
      if (off < 0) off = -off
      allowed = 1.001*(last_digit($i) + (wanted[i] ~ /[?]/ ? last_digit(wanted[i]) : 0))
      if (i > 2 && $(i - 1) == "=" && $(i - 2) ~ /^(S|RSS|WORST|NAJGOR[.])$/) allowed += 2.5e-3*(size($i) < 0 ? -size($i) : size($i))
      if (off > allowed) print $1 ": " $i ", not " wanted[i]
   }
}
END { if (n != lines) print "lines: " n ", not " lines; print compared + 0 }
