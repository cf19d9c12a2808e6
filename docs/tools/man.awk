# The man page of kinmat, of the text that `kinmat --help` prints. A line that ends with a colon begins a section, whose
# items have their names in columns 3 to 22 and their text from column 24 on. version: for the foot of the page.
# `make install` puts its PREFIX in the place of @PREFIX@.
function plain(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); return text }
# bold(words): words in bold, those in capitals, which stand for something else, in italics
function bold(words,   n, i, word, text) {
   n = split(plain(words), word, " ")
   for (i = 1; i <= n; i++) text = text (i > 1 ? " " : "") (word[i] ~ /^[][A-Z\/]+$/ ? "\\fI" : "\\fB") word[i] "\\fR"
   return text
}
BEGIN {
   print ".TH KINMAT 1 \"\" \"" version "\" \"User Commands\""
   print ".SH NAME\nkinmat \\- kinematics of planar mechanisms"
   print ".SH SYNOPSIS\n.B kinmat\n[\\fIoptions\\fR] [\\fIDECK\\fR]"
   print ".SH DESCRIPTION"
}
/^Usage: / { next }
/^[A-Z][a-z ]*:$/ { section = toupper($0); sub(/:$/, "", section); print ".SH " section; if (section == "EXAMPLES") print ".nf"; next }
/^  / && section == "EXAMPLES" { sub(/^ */, ""); print "\\fB" plain($0) "\\fR"; next }
/^  -/ { print ".TP\n" bold(substr($0, 1, 23)) "\n" plain(substr($0, 24)); next }
/^  [0-9]/ { print ".TP\n" $1 "\n" plain(substr($0, 24)); next }
/^FILE / { print ".PP" }
/^ / { print plain(substr($0, 24)); next }
/^Documents: / { print ".fi\n.SH SEE ALSO\nThe documents, with all cards, messages and formats:\n\\fI@PREFIX@/share/doc/kinmat/README.md\\fR."; exit }
{ print plain($0) }
